//! The bands of a file put together: one component for each side, with a channel for each band.

use super::super::super::channel::{Channel, xyz};
use super::super::super::input::Input;
use super::super::super::klems::{Basis, Klems};
use super::super::super::measurement::{Component, Data, Measurement, Side};
use super::super::super::metadata::Metadata;
use super::super::super::tree::{Child, Growing, TensorTree};
use crate::BrdfError;

/// The table of one band and side.
#[derive(Debug)]
pub(super) enum Table {
    /// Incoming and outgoing basis; for each outgoing patch all incoming ones.
    Patches(Basis, Basis, Vec<f32>),
    /// One channel.
    Tree(TensorTree),
}

/// One block of data.
#[derive(Debug)]
pub(super) struct Block {
    pub band: String,
    pub side: Side,
    pub data: Table,
}

/// Names of the bands that make a colour with `Visible`.
const COLOURS: [[&str; 2]; 2] = [["CIE-X", "CIE-Z"], ["CIE-u", "CIE-v"]];

/// All blocks as one measurement. What some side lacks is left out and named in `unused`.
pub(super) fn combined(
    input: &Input<'_>,
    mut blocks: Vec<Block>,
    unused: &mut Vec<String>,
) -> Result<Measurement, BrdfError> {
    if blocks.is_empty() {
        return Err(input.error(
            "Layer",
            "no block of data",
            "WavelengthData with a WavelengthDataBlock",
        ));
    }
    // A block that comes again replaces the one before it.
    let mut k = 0;
    while k < blocks.len() {
        let again = blocks[k + 1..]
            .iter()
            .any(|b| b.side == blocks[k].side && b.band.eq_ignore_ascii_case(&blocks[k].band));
        if again {
            unused.push(format!(
                "{} {}, which comes twice",
                blocks[k].band,
                blocks[k].side.name()
            ));
            blocks.remove(k);
        } else {
            k += 1;
        }
    }
    let mut sides: Vec<Side> = blocks.iter().map(|b| b.side).collect();
    sides.sort();
    sides.dedup();
    let has = |side: Side, band: &str| {
        blocks
            .iter()
            .any(|b| b.side == side && b.band.eq_ignore_ascii_case(band))
    };
    let everywhere = |band: &str| sides.iter().all(|s| has(*s, band));
    let colour = COLOURS
        .into_iter()
        .find(|names| everywhere("Visible") && names.iter().all(|n| everywhere(n)));
    let mut bands: Vec<String> = Vec::new();
    let mut channels = Vec::new();
    if let Some([first, second]) = colour {
        bands.extend([first.to_owned(), "Visible".into(), second.to_owned()]);
        channels.extend(xyz());
    }
    let mut others: Vec<(Channel, String)> = Vec::new();
    for block in &blocks {
        let known = |b: &String| b.eq_ignore_ascii_case(&block.band);
        if bands.iter().any(known) || others.iter().any(|(_, b)| known(b)) {
            continue;
        }
        if everywhere(&block.band) {
            let channel = match block.band.to_ascii_lowercase().as_str() {
                "visible" => Channel::Luminance,
                _ => Channel::from_name(&block.band.to_ascii_lowercase()),
            };
            others.push((channel, block.band.clone()));
        } else {
            unused.push(format!("{} {}", block.band, block.side.name()));
        }
    }
    others.sort_by(|a, b| match (&a.0, &b.0) {
        (Channel::Wavelength(a), Channel::Wavelength(b)) => a.total_cmp(b),
        _ => std::cmp::Ordering::Equal,
    });
    for (channel, band) in others {
        channels.push(channel);
        bands.push(band);
    }
    if bands.is_empty() {
        let all: Vec<String> = blocks
            .iter()
            .map(|b| format!("{} {}", b.band, b.side.name()))
            .collect();
        return Err(input.error(
            "WavelengthData",
            all.join(", "),
            "a band that every side has",
        ));
    }
    let mut components = Vec::new();
    for side in sides {
        let tables: Vec<&Table> = bands
            .iter()
            .filter_map(|band| {
                let same = |b: &&Block| b.side == side && b.band.eq_ignore_ascii_case(band);
                blocks.iter().find(same).map(|b| &b.data)
            })
            .collect();
        let chromatic = colour.is_some_and(|c| c[0] == "CIE-u");
        components.push(Component {
            side,
            data: interleaved(input, &tables, chromatic)?,
            uncertainty: None,
        });
    }
    Measurement::new(components, channels, Metadata::default())
        .map_err(|e| input.error("WavelengthData", e.to_string(), "bands that agree"))
}

/// The tables of one side as one with as many channels; `chromatic`: the first three are u′, Y, v′, which become X, Y, Z.
fn interleaved(input: &Input<'_>, tables: &[&Table], chromatic: bool) -> Result<Data, BrdfError> {
    let differ = |what: &str| {
        input.error(
            "WavelengthData",
            format!("bands with different {what}"),
            "the same for all bands of a side",
        )
    };
    let mut patches: Vec<&Vec<f32>> = Vec::new();
    let mut trees: Vec<&TensorTree> = Vec::new();
    let mut bases: Option<(&Basis, &Basis)> = None;
    for table in tables {
        match table {
            Table::Patches(i, o, values) => {
                if bases.is_some_and(|b| b != (i, o)) {
                    return Err(differ("bases"));
                }
                bases = Some((i, o));
                patches.push(values);
            }
            Table::Tree(tree) => trees.push(tree),
        }
    }
    if let Some((incoming, outgoing)) = bases {
        let cells = patches[0].len();
        let mut values = Vec::with_capacity(cells * patches.len());
        for cell in 0..cells {
            let mut all: Vec<f32> = patches.iter().map(|p| p[cell]).collect();
            if chromatic {
                to_xyz(&mut all);
            }
            values.extend(all);
        }
        let klems = Klems::new(incoming.clone(), outgoing.clone(), patches.len(), values);
        return klems
            .map(Data::Klems)
            .map_err(|(found, expected)| input.error("ScatteringData", found, expected));
    }
    let Some(first) = trees.first() else {
        return Err(differ("tables"));
    };
    if let ([only], false) = (&trees[..], chromatic) {
        return Ok(Data::TensorTree((*only).clone()));
    }
    let mut growing = Growing::new(first.rank() as u32, trees.len());
    let at: Vec<Child> = trees.iter().map(|_| Child::Branch(0)).collect();
    merge(&trees, &at, chromatic, &mut growing);
    Ok(Data::TensorTree(growing.done()))
}

/// The finest of the trees' divisions at these children, with the values of all.
fn merge(trees: &[&TensorTree], at: &[Child], chromatic: bool, growing: &mut Growing) -> Child {
    if at.iter().all(|c| matches!(c, Child::Leaf(_))) {
        let mut all: Vec<f32> = trees
            .iter()
            .zip(at)
            .map(|(tree, c)| match c {
                Child::Leaf(l) => tree.leaf(*l)[0],
                Child::Branch(_) => 0.0,
            })
            .collect();
        if chromatic {
            to_xyz(&mut all);
        }
        return growing.leaf(all);
    }
    let branch = growing.branch();
    for place in 0..1usize << trees[0].rank() {
        let below: Vec<Child> = trees
            .iter()
            .zip(at)
            .map(|(tree, c)| match c {
                Child::Branch(b) => tree.child(*b, place),
                leaf => *leaf,
            })
            .collect();
        let child = merge(trees, &below, chromatic, growing);
        growing.set(branch, place, child);
    }
    Child::Branch(branch)
}

/// u′, Y, v′ to X, Y, Z (CIE 1976); grey where the chromaticity has no meaning.
fn to_xyz(values: &mut [f32]) {
    let [u, y, v] = [0, 1, 2].map(|k| f64::from(values[k]));
    let over = 1.0 / (6.0 * u - 16.0 * v + 12.0);
    let (cx, cy) = (9.0 * u * over, 4.0 * v * over);
    let [x, z] = if cy > 1e-6 && cx.is_finite() {
        [cx / cy * y, (1.0 - cx - cy) / cy * y]
    } else {
        [y, y]
    };
    (values[0], values[2]) = (x as f32, z as f32);
}
