//! BSDF files of Radiance and LBNL WINDOW (`.xml`): patches of a Klems basis, or tensor trees; reflection and transmission of
//! both sides.
//!
//! As Radiance does, the side that the file calls *back* is taken for the front (+z): these files call the outdoor side of a window
//! the front, and a surface's normal points indoors. So `Reflection Back` becomes `reflection-front`, `Transmission Back`
//! `transmission-front`.
//!
//! An incoming patch or square is named by the azimuth in which its light travels, so that the mirror direction has the same place.
//! Values are constant in a patch or a square. Band `Visible` is luminance; with `CIE-X` and `CIE-Z` (patches) or `CIE-u` and
//! `CIE-v` (trees) it is the Y of a colour, relative to equal energy. Other bands, such as `Solar`, are kept as channels of their
//! own.
//!
//! Source: Ward et al. 2012, "A Practical Framework for Sharing and Rendering Real-World Bidirectional Scattering Distribution
//! Functions"; Klems 1994; LBNL's schema BSDF 1.4.

mod bands;
mod tree;
mod write;

pub use write::write;

use super::super::input::Input;
use super::super::klems::Basis;
use super::super::measurement::{Measurement, Side};
use super::super::metadata::Metadata;
use super::text::{line_of, number};
use crate::BrdfError;
use bands::Block;
use roxmltree::{Document, Node, ParsingOptions};

/// Whether a file is XML that names this root element.
pub(super) fn detect(head: &[u8], _length: u64) -> bool {
    let name = b"WindowElement";
    super::is_text(head)
        && head
            .strip_prefix(b"\xef\xbb\xbf")
            .unwrap_or(head)
            .trim_ascii_start()
            .starts_with(b"<")
        && head.windows(name.len()).any(|w| w == name)
}

/// Elements that a file may have: a block of data is one.
const MOST_NODES: u32 = 200_000;

/// Reads a file.
///
/// # Errors
/// If it is no such XML, an element is missing or has another content than the schema says, or a table has another number of values
/// than its bases ask for.
pub fn parse(input: &Input<'_>) -> Result<Measurement, BrdfError> {
    let text = input.text()?;
    let options = ParsingOptions {
        nodes_limit: MOST_NODES,
        ..ParsingOptions::default()
    };
    let document = Document::parse_with_options(text, options).map_err(|e| {
        let place = format!("line {}", e.pos().row);
        input.error(place, format!("XML that is not well-formed: {e}"), "XML")
    })?;
    Reader { input, text }.measurement(document.root_element())
}

struct Reader<'a, 'b> {
    input: &'a Input<'b>,
    text: &'a str,
}

/// The elements of this name under a node.
fn children<'a, 'd>(node: Node<'a, 'd>, name: &str) -> impl Iterator<Item = Node<'a, 'd>> {
    let name = name.to_owned();
    node.children()
        .filter(move |n| n.is_element() && n.tag_name().name() == name)
}

/// The text of the first element of this name, trimmed; empty if there is none.
fn content<'a>(node: Node<'a, '_>, name: &str) -> &'a str {
    children(node, name)
        .next()
        .and_then(|n| n.text())
        .map_or("", str::trim)
}

/// How the tables are laid out.
#[derive(Clone, Copy, PartialEq)]
enum Structure {
    /// Patches; whether the columns are the incoming ones.
    Matrix(bool),
    /// A tensor tree of this rank.
    Tree(u32),
}

impl Reader<'_, '_> {
    fn line(&self, node: Node<'_, '_>) -> String {
        format!("line {}", line_of(self.text, node.range().start))
    }

    /// The first element of this name under a node.
    fn child<'a, 'd>(&self, node: Node<'a, 'd>, name: &str) -> Result<Node<'a, 'd>, BrdfError> {
        children(node, name).next().ok_or_else(|| {
            self.input.error(
                self.line(node),
                format!("`{}` without `{name}`", node.tag_name().name()),
                format!("an element `{name}` in it"),
            )
        })
    }

    fn measurement(&self, root: Node<'_, '_>) -> Result<Measurement, BrdfError> {
        if root.tag_name().name() != "WindowElement" {
            return Err(self.input.error(
                self.line(root),
                format!("the root `{}`", root.tag_name().name()),
                "`WindowElement`",
            ));
        }
        let optical = self.child(root, "Optical")?;
        let layer = self.child(optical, "Layer")?;
        let definition = self.child(layer, "DataDefinition")?;
        let structure = content(definition, "IncidentDataStructure");
        let structure = match structure.to_ascii_lowercase().as_str() {
            "columns" => Structure::Matrix(true),
            "rows" => Structure::Matrix(false),
            "tensortree3" => Structure::Tree(3),
            "tensortree4" => Structure::Tree(4),
            _ => {
                return Err(self.input.error(
                    self.line(definition),
                    format!("IncidentDataStructure `{structure}`"),
                    "Columns, Rows, TensorTree3 or TensorTree4",
                ));
            }
        };
        let bases = self.bases(definition)?;
        let mut blocks = Vec::new();
        let mut unused = Vec::new();
        for data in children(layer, "WavelengthData") {
            let band = self.band(data);
            for block in children(data, "WavelengthDataBlock") {
                let direction = content(block, "WavelengthDataDirection");
                let Some(side) = side_of(direction) else {
                    unused.push(format!("{band} {direction}"));
                    continue;
                };
                let values = self.child(block, "ScatteringData")?;
                let values = match structure {
                    Structure::Matrix(by_columns) => {
                        self.matrix(block, values, by_columns, &bases)?
                    }
                    Structure::Tree(rank) => {
                        let basis = content(block, "AngleBasis");
                        if !basis.eq_ignore_ascii_case("LBNL/Shirley-Chiu") {
                            return Err(self.input.error(
                                self.line(block),
                                format!("AngleBasis `{basis}`"),
                                "`LBNL/Shirley-Chiu`",
                            ));
                        }
                        tree::parse(self.input, self.text, values, rank)?
                    }
                };
                blocks.push(Block {
                    band: band.clone(),
                    side,
                    data: values,
                });
            }
        }
        if children(layer, "Geometry")
            .next()
            .is_some_and(|g| g.text().is_some_and(|t| !t.trim().is_empty()))
            || children(layer, "Material").any(|m| !content(m, "Geometry").is_empty())
        {
            unused.push("geometry (MGF)".into());
        }
        let mut metadata = Metadata::of_format("Radiance BSDF");
        if let Some(material) = children(layer, "Material").next() {
            metadata.name = content(material, "Name").into();
            metadata.author = content(material, "Manufacturer").into();
        }
        let mut measurement = bands::combined(self.input, blocks, &mut unused)?;
        measurement.metadata = metadata;
        measurement.unused = unused;
        Ok(measurement)
    }

    /// The name of the band of a block of data; a wavelength as `550 nm`.
    fn band(&self, data: Node<'_, '_>) -> String {
        let Some(wavelength) = children(data, "Wavelength").next() else {
            return "Visible".into();
        };
        let name = wavelength.text().map_or("", str::trim);
        let unit = wavelength.attribute("unit").unwrap_or_default();
        let per_unit = match unit.to_ascii_lowercase().as_str() {
            "nanometer" | "nm" => 1.0,
            "micrometer" | "micron" | "um" => 1000.0,
            _ => return name.into(),
        };
        name.parse::<f64>()
            .map_or(name.into(), |x| format!("{} nm", x * per_unit))
    }

    /// The bases that the file defines.
    fn bases(&self, definition: Node<'_, '_>) -> Result<Vec<Basis>, BrdfError> {
        let mut bases = Vec::new();
        for basis in children(definition, "AngleBasis") {
            let name = content(basis, "AngleBasisName");
            let mut rings = Vec::new();
            let mut before = 0.0;
            for block in children(basis, "AngleBasisBlock") {
                let line = line_of(self.text, block.range().start);
                let bounds = self.child(block, "ThetaBounds")?;
                let lower = content(bounds, "LowerTheta");
                let upper = number(self.input, content(bounds, "UpperTheta"), line)?;
                if !lower.is_empty() && !rings.is_empty() {
                    let lower = number(self.input, lower, line)?;
                    if f64::abs(lower - before) > 1e-3 {
                        return Err(self.input.error(
                            format!("line {line}"),
                            format!("a ring from {lower}° after one to {before}°"),
                            "rings without gaps",
                        ));
                    }
                }
                before = upper;
                let count = content(block, "nPhis");
                let count: u32 = count.parse().map_err(|_| {
                    let place = format!("line {line}");
                    self.input
                        .error(place, format!("nPhis `{count}`"), "a whole number")
                })?;
                rings.push((upper, count));
            }
            let basis = Basis::new(name, &rings).map_err(|found| {
                self.input
                    .error(self.line(basis), found, "rings of patches from 0° to 90°")
            })?;
            bases.push(basis);
        }
        Ok(bases)
    }

    fn basis(
        &self,
        block: Node<'_, '_>,
        element: &str,
        bases: &[Basis],
    ) -> Result<Basis, BrdfError> {
        let name = content(block, element);
        let defined = bases.iter().find(|b| b.name().eq_ignore_ascii_case(name));
        defined
            .cloned()
            .or_else(|| Basis::known(name))
            .ok_or_else(|| {
                self.input.error(
                    self.line(block),
                    format!("{element} `{name}`"),
                    "a basis that the file defines, or LBNL/Klems Full, Half or Quarter",
                )
            })
    }

    fn matrix(
        &self,
        block: Node<'_, '_>,
        values: Node<'_, '_>,
        by_columns: bool,
        bases: &[Basis],
    ) -> Result<bands::Table, BrdfError> {
        let columns = self.basis(block, "ColumnAngleBasis", bases)?;
        let rows = self.basis(block, "RowAngleBasis", bases)?;
        let (incoming, outgoing) = if by_columns {
            (columns, rows)
        } else {
            (rows, columns)
        };
        let numbers = self.numbers(values)?;
        let (i, o) = (incoming.len(), outgoing.len());
        if numbers.len() != i * o {
            return Err(self.input.error(
                self.line(values),
                format!("{} values", numbers.len()),
                format!("{}: {o} outgoing × {i} incoming patches", i * o),
            ));
        }
        let numbers = if by_columns {
            numbers
        } else {
            let transposed = |at: usize| numbers[at % i * o + at / i];
            (0..i * o).map(transposed).collect()
        };
        Ok(bands::Table::Patches(incoming, outgoing, numbers))
    }

    /// The numbers of an element, separated by white space or commas.
    fn numbers(&self, node: Node<'_, '_>) -> Result<Vec<f32>, BrdfError> {
        let text = node.text().unwrap_or_default();
        let mut numbers = Vec::new();
        for word in text.split(|c: char| c == ',' || c.is_whitespace()) {
            if word.is_empty() {
                continue;
            }
            match word.parse::<f32>() {
                Ok(x) if x.is_finite() => numbers.push(x),
                _ => {
                    let at = word.as_ptr() as usize - text.as_ptr() as usize;
                    let line = line_of(self.text, node.range().start) + line_of(text, at) - 1;
                    number(self.input, word, line)?;
                    let found = format!("`{word}`");
                    return Err(self.input.error(format!("line {line}"), found, "a number"));
                }
            }
        }
        Ok(numbers)
    }
}

/// The side that the file means, whose front is the other one.
fn side_of(direction: &str) -> Option<Side> {
    match direction.to_ascii_lowercase().as_str() {
        "reflection back" => Some(Side::ReflectionFront),
        "reflection front" => Some(Side::ReflectionBack),
        "transmission back" => Some(Side::TransmissionFront),
        "transmission front" => Some(Side::TransmissionBack),
        _ => None,
    }
}
