//! The project's own format (`.gonio`): a `tensor_file` container with everything that a [`Measurement`] has.
//!
//! Fields (texts are arrays of bytes in UTF-8; S stands for a side, such as `reflection-front`):
//!
//! | field | type, shape | meaning |
//! |---|---|---|
//! | `gonio.version` | uint8, 1 | 1 |
//! | `channels` | text | one name a line: `red`, `green`, `blue`, `x`, `y`, `z`, `luminance`, `550 nm`, or a band |
//! | `name`, `description`, `author`, `instrument`, `date`, `licence`, `quantity`, `unit`, `provenance` | text | each may be missing |
//! | `S.layout` | text | `half-difference`, `half-difference-anisotropic`, `spherical`, `spherical-anisotropic`, `klems`, `tensor-tree`, `adaptive` |
//! | `S.values` | float32, nodes of each axis × channels | of a grid; sr⁻¹, NaN where missing |
//! | `S.AXIS` | float64, nodes | of each axis of a grid (`theta_h`, `phi_i` …): radians, increasing |
//! | `S.AXIS.boundary` | text | `clamped`, `periodic` or `mirrored` |
//! | `S.AXIS.period` | float64, 1 | radians, unless clamped |
//! | `S.AXIS.scale` | text | `linear`, or `square-root`: linear in √angle |
//! | `S.incoming.edges_deg`, `S.outgoing.edges_deg` | float64, rings + 1 | of patches: elevations of the rings' edges |
//! | `S.incoming.counts`, `S.outgoing.counts` | float64, rings | patches of each ring |
//! | `S.incoming.name`, `S.outgoing.name` | text | the basis |
//! | `S.values` | float32, outgoing × incoming × channels | of patches |
//! | `S.children` | float64, branches × 2^rank | of a tree: a branch's number, or −1 − a leaf's |
//! | `S.values` | float32, leaves × channels | of a tree |
//! | `S.phi_i`, `S.theta_i`, `S.ndf`, `S.sigma`, `S.vndf`, `S.luminance`, `S.jacobian` | as in [`rgl`](super::rgl) | of an adaptive table |
//! | `S.values` | float32, φ × θ × channels × height × width | of an adaptive table |
//! | `S.uncertainty` | float32, as `S.values` | standard uncertainty in sr⁻¹; may be missing |
//!
//! Values are mapped into memory, not copied.

use super::super::adaptive::{Adaptive, Fields};
use super::super::channel::Channel;
use super::super::file::Fault;
use super::super::grid::{Axis, Boundary, Grid, Parameterization, Scale};
use super::super::input::{Input, MOST_VALUES};
use super::super::klems::{Basis, Klems};
use super::super::measurement::{Component, Data, Measurement, Side};
use super::super::metadata::Metadata;
use super::super::tensor_file::{self, Dtype, Field, TensorFile, TensorWriter};
use super::super::tree::{Child, DEEPEST, Growing, TensorTree};
use super::super::values::Values;
use crate::BrdfError;
use std::path::Path;

/// The version that is written.
const VERSION: u8 = 1;
/// Channels that are believed.
const MOST_CHANNELS: usize = 65_536;

/// Whether a file is a container that names this format in its header.
pub(super) fn detect(head: &[u8], _length: u64) -> bool {
    let name = b"gonio.version";
    head.starts_with(tensor_file::MAGIC) && head.windows(name.len()).any(|w| w == name)
}

struct Reader<'a, 'b> {
    input: &'a Input<'b>,
    file: TensorFile<'b>,
}

/// Reads a measurement. Values stay in the file if it is mapped.
///
/// # Errors
/// If the container is broken, a field is missing, or one has another type, shape or content than the format says.
pub fn parse(input: &Input<'_>) -> Result<Measurement, BrdfError> {
    let file = TensorFile::parse(input.bytes(), input.path())?;
    let reader = Reader { input, file };
    let version = reader.field("gonio.version", Dtype::U8)?;
    match reader.file.bytes_of(version) {
        [VERSION] => {}
        other => {
            let found = format!("version {other:?}");
            return Err(input.error("field `gonio.version`", found, format!("[{VERSION}]")));
        }
    }
    let channels: Vec<Channel> = reader
        .text("channels")?
        .lines()
        .filter(|l| !l.trim().is_empty())
        .map(Channel::from_name)
        .collect();
    if channels.is_empty() || channels.len() > MOST_CHANNELS {
        let found = format!("{} channels", channels.len());
        return Err(input.error("field `channels`", found, format!("1 to {MOST_CHANNELS}")));
    }
    let mut components = Vec::new();
    for side in Side::ALL {
        if reader
            .file
            .find(&format!("{}.layout", side.name()))
            .is_some()
        {
            components.push(reader.component(side, channels.len())?);
        }
    }
    if components.is_empty() {
        let names: Vec<_> = Side::ALL.iter().map(|s| s.name()).collect();
        return Err(input.error(
            "fields",
            "no layout",
            format!("S.layout with S one of {}", names.join(", ")),
        ));
    }
    let optional = |name: &str| reader.text(name).unwrap_or_default();
    let metadata = Metadata {
        name: optional("name"),
        description: optional("description"),
        author: optional("author"),
        instrument: optional("instrument"),
        date: optional("date"),
        licence: optional("licence"),
        quantity: optional("quantity"),
        unit: optional("unit"),
        provenance: optional("provenance").lines().map(str::to_owned).collect(),
    };
    if !matches!(metadata.unit.as_str(), "" | "sr^-1" | "1/sr")
        && !metadata.unit.starts_with("sr^-1")
    {
        return Err(input.error("field `unit`", format!("`{}`", metadata.unit), "sr^-1"));
    }
    let measurement = Measurement::new(components, channels, metadata);
    measurement.map_err(|e| input.error("fields", e.to_string(), "fields that agree"))
}

impl Reader<'_, '_> {
    fn wrong(&self, name: &str, found: impl ToString, expected: impl ToString) -> BrdfError {
        let place = format!("field `{name}`");
        self.input
            .error(place, found.to_string(), expected.to_string())
    }

    fn field(&self, name: &str, dtype: Dtype) -> Result<&Field, BrdfError> {
        let Some(field) = self.file.find(name) else {
            return Err(self.wrong(name, "none", "such a field"));
        };
        if field.dtype != dtype {
            return Err(self.wrong(name, field.dtype.name(), dtype.name()));
        }
        Ok(field)
    }

    fn text(&self, name: &str) -> Result<String, BrdfError> {
        let field = self.field(name, Dtype::U8)?;
        Ok(String::from_utf8_lossy(self.file.bytes_of(field)).into_owned())
    }

    /// A list of numbers.
    fn list(&self, name: &str) -> Result<Vec<f64>, BrdfError> {
        let field = self.field(name, Dtype::F64)?;
        if field.shape.len() != 1 || field.count() == 0 {
            return Err(self.wrong(
                name,
                format!("{:?}", field.shape),
                "one dimension, not empty",
            ));
        }
        Ok(self.file.f64s(field).unwrap_or_default())
    }

    /// Numbers of this shape, where they are.
    fn values(&self, name: &str, shape: &[usize]) -> Result<Values, BrdfError> {
        let field = self.field(name, Dtype::F32)?;
        if field.shape != shape {
            return Err(self.wrong(
                name,
                format!("dimensions {:?}", field.shape),
                format!("{shape:?}"),
            ));
        }
        if field.count() as u64 > MOST_VALUES {
            let found = format!("{} values", field.count());
            return Err(self.wrong(name, found, format!("at most {MOST_VALUES}")));
        }
        Ok(self.input.values(field.range.clone()))
    }

    fn component(&self, side: Side, channels: usize) -> Result<Component, BrdfError> {
        let of = |rest: &str| format!("{}.{rest}", side.name());
        let layout = self.text(&of("layout"))?;
        let layout = layout.trim();
        let data = match layout {
            "klems" => self.klems(side, channels)?,
            "tensor-tree" => self.tree(side, channels)?,
            "adaptive" if side.transmits() => {
                let expected = "a layout by directions: light that passes has no half vector";
                return Err(self.wrong(&of("layout"), "`adaptive`", expected));
            }
            "adaptive" => self.adaptive(side, channels)?,
            name => match Parameterization::from_name(name) {
                Some(p) if p.is_half() && side.transmits() => {
                    let expected = "a layout by directions: light that passes has no half vector";
                    return Err(self.wrong(&of("layout"), format!("`{name}`"), expected));
                }
                Some(p) => self.grid(side, p, channels)?,
                None => {
                    let names = Parameterization::ALL.map(Parameterization::name);
                    return Err(self.wrong(
                        &of("layout"),
                        format!("`{name}`"),
                        format!("{}, klems, tensor-tree, adaptive", names.join(", ")),
                    ));
                }
            },
        };
        let uncertainty = of("uncertainty");
        let uncertainty = match self.file.find(&uncertainty) {
            None => None,
            Some(_) => {
                let like = self.field(&of("values"), Dtype::F32)?.shape.clone();
                Some(self.values(&uncertainty, &like)?)
            }
        };
        Ok(Component {
            side,
            data,
            uncertainty,
        })
    }

    fn adaptive(&self, side: Side, channels: usize) -> Result<Data, BrdfError> {
        let prefix = format!("{}.", side.name());
        let fields = Fields {
            input: self.input,
            file: &self.file,
            prefix: &prefix,
        };
        let at = |fault: Fault| fault.at(self.input.path());
        let tables = fields.tables().map_err(at)?;
        let shape = [
            tables.phi_i.len(),
            tables.theta_i.len(),
            channels,
            tables.luminance.height,
            tables.luminance.width,
        ];
        let values = self.values(&format!("{prefix}values"), &shape)?;
        let data = Adaptive::checked(tables, channels, values);
        Ok(Data::Adaptive(data.map_err(at)?))
    }

    fn axis(&self, name: &str) -> Result<Axis, BrdfError> {
        let nodes = self.list(name)?;
        let boundary = format!("{name}.boundary");
        let period = || -> Result<f64, BrdfError> {
            let period = format!("{name}.period");
            match self.list(&period)?[..] {
                [x] if x.is_finite() => Ok(x),
                ref other => Err(self.wrong(&period, format!("{other:?}"), "one number")),
            }
        };
        let boundary = match self.text(&boundary)?.trim() {
            "clamped" => Boundary::Clamped,
            "periodic" => Boundary::Periodic(period()?),
            "mirrored" => Boundary::Mirrored(period()?),
            other => {
                let expected = "clamped, periodic or mirrored";
                return Err(self.wrong(&boundary, format!("`{other}`"), expected));
            }
        };
        let scale = format!("{name}.scale");
        let scale = match self.text(&scale)?.trim() {
            "linear" => Scale::Linear,
            "square-root" => Scale::SquareRoot,
            other => {
                return Err(self.wrong(&scale, format!("`{other}`"), "linear or square-root"));
            }
        };
        Axis::new(nodes, boundary, scale)
            .map_err(|found| self.wrong(name, found, "nodes that increase"))
    }

    fn grid(&self, side: Side, p: Parameterization, channels: usize) -> Result<Data, BrdfError> {
        let mut axes = Vec::new();
        for name in p.axes() {
            axes.push(self.axis(&format!("{}.{name}", side.name()))?);
        }
        let mut shape: Vec<usize> = axes.iter().map(Axis::len).collect();
        shape.push(channels);
        let name = format!("{}.values", side.name());
        let values = self.values(&name, &shape)?;
        let grid = Grid::new(p, axes, channels, values);
        Ok(Data::Grid(grid.map_err(|(f, e)| self.wrong(&name, f, e))?))
    }

    fn basis(&self, prefix: &str) -> Result<Basis, BrdfError> {
        let edges = self.list(&format!("{prefix}.edges_deg"))?;
        let counts = self.list(&format!("{prefix}.counts"))?;
        if edges.len() != counts.len() + 1 || edges[0] != 0.0 {
            let found = format!("{} edges from {}", edges.len(), edges[0]);
            let expected = format!("{} from 0", counts.len() + 1);
            return Err(self.wrong(&format!("{prefix}.edges_deg"), found, expected));
        }
        let rings: Vec<(f64, u32)> = edges[1..]
            .iter()
            .zip(&counts)
            .map(|(edge, count)| (*edge, *count as u32))
            .collect();
        let name = self.text(&format!("{prefix}.name")).unwrap_or_default();
        Basis::new(&name, &rings)
            .map_err(|found| self.wrong(&format!("{prefix}.counts"), found, "rings from 0° to 90°"))
    }

    fn klems(&self, side: Side, channels: usize) -> Result<Data, BrdfError> {
        let incoming = self.basis(&format!("{}.incoming", side.name()))?;
        let outgoing = self.basis(&format!("{}.outgoing", side.name()))?;
        let name = format!("{}.values", side.name());
        let values = self.values(&name, &[outgoing.len(), incoming.len(), channels])?;
        let klems = Klems::new(incoming, outgoing, channels, values);
        Ok(Data::Klems(
            klems.map_err(|(f, e)| self.wrong(&name, f, e))?,
        ))
    }

    fn tree(&self, side: Side, channels: usize) -> Result<Data, BrdfError> {
        let name = format!("{}.children", side.name());
        let field = self.field(&name, Dtype::F64)?;
        let rank = match field.shape[..] {
            [branches, 8] if branches > 0 => 3,
            [branches, 16] if branches > 0 => 4,
            _ => {
                let found = format!("dimensions {:?}", field.shape);
                return Err(self.wrong(&name, found, "branches × 8 or × 16"));
            }
        };
        let codes = self.file.f64s(field).unwrap_or_default();
        let values = format!("{}.values", side.name());
        let leaves = self.field(&values, Dtype::F32)?.shape.first().copied();
        let leaves = leaves.unwrap_or_default();
        let numbers = self.values(&values, &[leaves, channels])?;
        let tree = TensorTree::of_codes(rank, channels, &codes, leaves, numbers);
        Ok(Data::TensorTree(tree.map_err(|found| {
            self.wrong(
                &name,
                found,
                format!("a tree of at most {DEEPEST} levels, each branch and leaf in one place"),
            )
        })?))
    }
}

/// Writes everything that the measurement has.
///
/// # Errors
/// If the file cannot be written.
pub fn write(path: &Path, measurement: &Measurement) -> Result<(), BrdfError> {
    measurement.check()?;
    let mut file = TensorWriter::new();
    let text = |file: &mut TensorWriter, name: &str, text: &str| {
        file.bytes(name, &[text.len()], text.as_bytes());
    };
    file.bytes("gonio.version", &[1], &[VERSION]);
    let names: Vec<String> = measurement
        .channels
        .iter()
        .map(Channel::to_string)
        .collect();
    text(&mut file, "channels", &names.join("\n"));
    for (name, value) in measurement.metadata.entries() {
        if name == "provenance" {
            text(&mut file, name, &measurement.metadata.provenance.join("\n"));
        } else {
            text(&mut file, name, &value);
        }
    }
    for component in &measurement.components {
        let of = |rest: &str| format!("{}.{rest}", component.side.name());
        let shape = match &component.data {
            Data::Grid(grid) => {
                text(&mut file, &of("layout"), grid.parameterization().name());
                for (name, axis) in grid.parameterization().axes().iter().zip(grid.axes()) {
                    write_axis(&mut file, &of(name), axis);
                }
                let mut shape = grid.shape();
                shape.push(grid.channels());
                shape
            }
            Data::Klems(klems) => {
                text(&mut file, &of("layout"), "klems");
                for (which, basis) in [
                    ("incoming", klems.incoming()),
                    ("outgoing", klems.outgoing()),
                ] {
                    let mut edges = vec![0.0];
                    edges.extend(basis.rings().map(|(_, outer, _)| outer));
                    let counts: Vec<f64> = basis.rings().map(|(_, _, n)| f64::from(n)).collect();
                    file.f64s(&of(&format!("{which}.edges_deg")), &[edges.len()], &edges);
                    file.f64s(&of(&format!("{which}.counts")), &[counts.len()], &counts);
                    text(&mut file, &of(&format!("{which}.name")), basis.name());
                }
                vec![
                    klems.outgoing().len(),
                    klems.incoming().len(),
                    klems.channels(),
                ]
            }
            Data::TensorTree(tree) => {
                text(&mut file, &of("layout"), "tensor-tree");
                let codes = tree.codes();
                let n = 1 << tree.rank();
                file.f64s(&of("children"), &[codes.len() / n, n], &codes);
                vec![tree.leaves().len() / tree.channels(), tree.channels()]
            }
            Data::Adaptive(data) => {
                text(&mut file, &of("layout"), "adaptive");
                let tables = data.tables();
                tables.write(&mut file, &of(""));
                vec![
                    tables.phi_i.len(),
                    tables.theta_i.len(),
                    data.channels(),
                    tables.luminance.height,
                    tables.luminance.width,
                ]
            }
        };
        file.f32s(&of("values"), &shape, component.data.values());
        if let Some(uncertainty) = &component.uncertainty {
            file.f32s(&of("uncertainty"), &shape, uncertainty);
        }
    }
    file.write(path)
}

fn write_axis(file: &mut TensorWriter, name: &str, axis: &Axis) {
    file.f64s(name, &[axis.len()], axis.nodes());
    let (boundary, period) = match axis.boundary() {
        Boundary::Clamped => ("clamped", None),
        Boundary::Periodic(period) => ("periodic", Some(period)),
        Boundary::Mirrored(period) => ("mirrored", Some(period)),
    };
    let scale = match axis.scale() {
        Scale::Linear => "linear",
        Scale::SquareRoot => "square-root",
    };
    for (rest, text) in [("boundary", boundary), ("scale", scale)] {
        file.bytes(&format!("{name}.{rest}"), &[text.len()], text.as_bytes());
    }
    if let Some(period) = period {
        file.f64s(&format!("{name}.period"), &[1], &[period]);
    }
}

impl TensorTree {
    /// The children of all branches: a branch's number, or −1 − a leaf's.
    fn codes(&self) -> Vec<f64> {
        let places = 0..1usize << self.rank();
        (0..self.branches() as u32)
            .flat_map(|b| places.clone().map(move |place| (b, place)))
            .map(|(b, place)| match self.child(b, place) {
                Child::Branch(b) => f64::from(b),
                Child::Leaf(l) => -1.0 - f64::from(l),
            })
            .collect()
    }

    /// The inverse of `codes`. A branch comes after its parent, so there are no circles.
    fn of_codes(
        rank: u32,
        channels: usize,
        codes: &[f64],
        leaves: usize,
        values: Values,
    ) -> Result<Self, String> {
        let n = 1usize << rank;
        let branches = codes.len() / n;
        let mut level = vec![0u32; branches];
        level[0] = 1;
        let mut growing = Growing::new(rank, channels);
        for _ in 0..branches {
            growing.branch();
        }
        for (at, code) in codes.iter().enumerate() {
            let (branch, place) = (at / n, at % n);
            if level[branch] == 0 || level[branch] > DEEPEST {
                return Err(format!("branch {branch} on level {}", level[branch]));
            }
            let child = if *code >= 0.0 && *code < branches as f64 && code.fract() == 0.0 {
                let to = *code as usize;
                if to <= branch || level[to] != 0 {
                    return Err(format!("branch {to} under branch {branch}"));
                }
                level[to] = level[branch] + 1;
                Child::Branch(to as u32)
            } else if *code < 0.0 && -1.0 - code < leaves as f64 && code.fract() == 0.0 {
                Child::Leaf((-1.0 - code) as u32)
            } else {
                return Err(format!("{code} under branch {branch}"));
            };
            growing.set(branch as u32, place, child);
        }
        Ok(growing.with(values))
    }
}
