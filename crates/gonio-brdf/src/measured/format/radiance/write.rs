//! Writing BSDF files.

use super::super::super::channel::Channel;
use super::super::super::klems::{Basis, Klems};
use super::super::super::measurement::{Data, Measurement, Side};
use super::super::super::output;
use super::super::super::tree::{Child, TensorTree};
use super::super::text::short;
use super::super::unsupported;
use crate::BrdfError;
use std::fs::File;
use std::io::{BufWriter, Result as IoResult, Write};
use std::path::Path;

type Out = BufWriter<File>;

/// A band of the file, and how it is made of the channels.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Band {
    Channel(usize),
    /// u′ or v′ of X, Y, Z.
    Chromaticity(usize),
}

/// Writes every side of a measurement by patches, or by tensor trees of one rank.
///
/// X, Y and Z, luminance, and bands can be written; red, green and blue and more than one wavelength cannot.
///
/// # Errors
/// If it is something else, or the file cannot be written.
pub fn write(path: &Path, measurement: &Measurement) -> Result<(), BrdfError> {
    measurement.check()?;
    let structure = structure(measurement)?;
    let bands = bands(measurement, structure != "Columns")?;
    output::write(path, |out| {
        let m = &measurement.metadata;
        writeln!(out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>")?;
        writeln!(
            out,
            "<WindowElement xmlns=\"http://windows.lbl.gov\" xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" \
             xsi:schemaLocation=\"http://windows.lbl.gov/BSDF-v1.4.xsd\">"
        )?;
        writeln!(out, "<WindowElementType>System</WindowElementType>")?;
        writeln!(out, "<FileType>BSDF</FileType>")?;
        writeln!(out, "<Optical>\n<Layer>\n<Material>")?;
        let name = if m.name.is_empty() {
            "unnamed"
        } else {
            &m.name
        };
        writeln!(out, "<Name>{}</Name>", escaped(name))?;
        writeln!(out, "<Manufacturer>{}</Manufacturer>", escaped(&m.author))?;
        writeln!(out, "<DeviceType>Other</DeviceType>\n</Material>")?;
        writeln!(out, "<DataDefinition>")?;
        writeln!(
            out,
            "<IncidentDataStructure>{structure}</IncidentDataStructure>"
        )?;
        let mut written: Vec<&Basis> = Vec::new();
        for component in &measurement.components {
            if let Data::Klems(klems) = &component.data {
                for basis in [klems.incoming(), klems.outgoing()] {
                    if !written.contains(&basis) {
                        write_basis(out, basis)?;
                        written.push(basis);
                    }
                }
            }
        }
        writeln!(out, "</DataDefinition>")?;
        for (name, band) in &bands {
            for component in &measurement.components {
                write_block(out, name, *band, component.side, &component.data)?;
            }
        }
        writeln!(out, "</Layer>\n</Optical>\n</WindowElement>")
    })
}

/// The word for the structure that all components have.
fn structure(measurement: &Measurement) -> Result<&'static str, BrdfError> {
    let mut all = measurement.components.iter().map(|c| match &c.data {
        Data::Klems(_) => Some("Columns"),
        Data::TensorTree(tree) if tree.rank() == 3 => Some("TensorTree3"),
        Data::TensorTree(_) => Some("TensorTree4"),
        Data::Grid(_) | Data::Adaptive(_) => None,
    });
    let first = all.next().flatten();
    match first {
        Some(word) if all.all(|other| other == Some(word)) => Ok(word),
        _ => Err(unsupported(
            "a BSDF file holds patches, or tensor trees of one rank, for all its sides",
        )),
    }
}

/// The bands that are written, by name.
fn bands(measurement: &Measurement, tree: bool) -> Result<Vec<(String, Band)>, BrdfError> {
    let mut bands = Vec::new();
    let channels = &measurement.channels;
    let place = |wanted: Channel| channels.iter().position(|c| *c == wanted);
    let colour = (place(Channel::X), place(Channel::Y), place(Channel::Z));
    if let (Some(0), Some(1), Some(2)) = colour {
        bands.push(("Visible".into(), Band::Channel(1)));
        if tree {
            bands.push(("CIE-u".into(), Band::Chromaticity(0)));
            bands.push(("CIE-v".into(), Band::Chromaticity(1)));
        } else {
            bands.push(("CIE-X".into(), Band::Channel(0)));
            bands.push(("CIE-Z".into(), Band::Channel(2)));
        }
    }
    for (k, channel) in channels.iter().enumerate() {
        let name = match channel {
            Channel::X | Channel::Y | Channel::Z if !bands.is_empty() => continue,
            Channel::Luminance | Channel::Y => "Visible".into(),
            Channel::Band(name) => {
                let mut letters = name.chars();
                letters
                    .next()
                    .map(|first| first.to_uppercase().chain(letters).collect())
                    .unwrap_or_default()
            }
            other => {
                return Err(unsupported(&format!(
                    "a BSDF file holds X, Y and Z, luminance, and bands, not {other}"
                )));
            }
        };
        if bands.iter().any(|(other, _)| *other == name) {
            return Err(unsupported(&format!("a BSDF file holds one band `{name}`")));
        }
        bands.push((name, Band::Channel(k)));
    }
    Ok(bands)
}

fn write_basis(out: &mut Out, basis: &Basis) -> IoResult<()> {
    writeln!(
        out,
        "<AngleBasis>\n<AngleBasisName>{}</AngleBasisName>",
        escaped(basis.name())
    )?;
    for (inner, outer, count) in basis.rings() {
        let theta = if inner == 0.0 {
            0.0
        } else {
            0.5 * (inner + outer)
        };
        writeln!(
            out,
            "<AngleBasisBlock><Theta>{theta}</Theta><nPhis>{count}</nPhis><ThetaBounds><LowerTheta>{inner}</LowerTheta>\
             <UpperTheta>{outer}</UpperTheta></ThetaBounds></AngleBasisBlock>"
        )?;
    }
    writeln!(out, "</AngleBasis>")
}

fn write_block(out: &mut Out, name: &str, band: Band, side: Side, data: &Data) -> IoResult<()> {
    let (direction, kind) = match side {
        Side::ReflectionFront => ("Reflection Back", "BRDF"),
        Side::ReflectionBack => ("Reflection Front", "BRDF"),
        Side::TransmissionFront => ("Transmission Back", "BTDF"),
        Side::TransmissionBack => ("Transmission Front", "BTDF"),
    };
    writeln!(out, "<WavelengthData>\n<LayerNumber>System</LayerNumber>")?;
    writeln!(
        out,
        "<Wavelength unit=\"Integral\">{}</Wavelength>",
        escaped(name)
    )?;
    writeln!(
        out,
        "<SourceSpectrum>CIE Illuminant D65 1nm.ssp</SourceSpectrum>"
    )?;
    writeln!(
        out,
        "<DetectorSpectrum>ASTM E308 1931 Y.dsp</DetectorSpectrum>"
    )?;
    writeln!(out, "<WavelengthDataBlock>")?;
    writeln!(
        out,
        "<WavelengthDataDirection>{direction}</WavelengthDataDirection>"
    )?;
    match data {
        Data::Klems(klems) => write_patches(out, klems, band, kind)?,
        Data::TensorTree(tree) => {
            writeln!(out, "<AngleBasis>LBNL/Shirley-Chiu</AngleBasis>")?;
            writeln!(
                out,
                "<ScatteringDataType>{kind}</ScatteringDataType>\n<ScatteringData>"
            )?;
            write_tree(out, tree, band, 0)?;
            writeln!(out)?;
        }
        Data::Grid(_) | Data::Adaptive(_) => {}
    }
    writeln!(
        out,
        "</ScatteringData>\n</WavelengthDataBlock>\n</WavelengthData>"
    )
}

fn write_patches(out: &mut Out, klems: &Klems, band: Band, kind: &str) -> IoResult<()> {
    let (i, o) = (
        escaped(klems.incoming().name()),
        escaped(klems.outgoing().name()),
    );
    writeln!(
        out,
        "<ColumnAngleBasis>{i}</ColumnAngleBasis>\n<RowAngleBasis>{o}</RowAngleBasis>"
    )?;
    writeln!(
        out,
        "<ScatteringDataType>{kind}</ScatteringDataType>\n<ScatteringData>"
    )?;
    let row = klems.incoming().len() * klems.channels();
    for row in klems.values().chunks_exact(row) {
        for cell in row.chunks_exact(klems.channels()) {
            write!(out, "{},\t", short(value(band, cell)))?;
        }
        writeln!(out)?;
    }
    Ok(())
}

fn write_tree(out: &mut Out, tree: &TensorTree, band: Band, branch: u32) -> IoResult<()> {
    let rank = tree.rank();
    let places = 1usize << rank;
    let leaf = |place: usize| match tree.child(branch, place) {
        Child::Leaf(l) => Some(value(band, tree.leaf(l))),
        Child::Branch(_) => None,
    };
    let leaves: Option<Vec<f32>> = (0..places).map(leaf).collect();
    write!(out, "{{")?;
    if let Some(leaves) = leaves {
        // A grid of two values along each side, the last coordinate fastest.
        for k in 0..places {
            let place = (0..rank).fold(0, |p, d| p | (k >> (rank - 1 - d) & 1) << d);
            write!(out, " {}", short(leaves[place]))?;
        }
    } else {
        for place in 0..places {
            match tree.child(branch, place) {
                Child::Leaf(l) => write!(out, "{{{}}}", short(value(band, tree.leaf(l))))?,
                Child::Branch(b) => {
                    writeln!(out)?;
                    write_tree(out, tree, band, b)?;
                }
            }
        }
    }
    write!(out, " }}")
}

/// What stands in the file for a cell.
fn value(band: Band, cell: &[f32]) -> f32 {
    match band {
        Band::Channel(k) => cell[k],
        Band::Chromaticity(k) => {
            let [x, y, z] = [0, 1, 2].map(|k| f64::from(cell[k]));
            let sum = x + 15.0 * y + 3.0 * z;
            let [u, v] = if sum > 0.0 {
                [4.0 * x / sum, 9.0 * y / sum]
            } else {
                // Of equal energy.
                [4.0 / 19.0, 9.0 / 19.0]
            };
            [u, v][k] as f32
        }
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}
