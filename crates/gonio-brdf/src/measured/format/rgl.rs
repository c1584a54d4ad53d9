//! Files of the RGL material database (`.bsdf`): the adaptive parameterization of Dupuy & Jakob in a `tensor_file`.
//!
//! | field | type, shape | meaning |
//! |---|---|---|
//! | `description` | text | what was measured |
//! | `phi_i`, `theta_i` | float32, n | azimuths and elevations of the viewer, in radians |
//! | `ndf`, `sigma` | float32, height × width | density D of microfacet normals, and their projected area σ |
//! | `vndf` | float32, φ × θ × height × width | density of visible normals |
//! | `luminance` | float32, φ × θ × height × width | luminance of the values |
//! | `rgb` | float32, φ × θ × 3 × height × width | values in linear Rec.709 |
//! | `wavelengths`, `spectra` | float32, n; φ × θ × n × height × width | values at wavelengths in nm |
//! | `jacobian` | uint8, 1 | 1: values are f·cosθi · 4σ/D, 0: f·cosθi |
//!
//! A file has `rgb` or `spectra`; of one that has both the spectra are taken. What axes are over is in [`Tables`]. Numbers are mapped, not
//! copied.
//!
//! Source: Dupuy & Jakob 2018, and the loader published with it.
//!
//! [`Tables`]: super::super::adaptive::Tables

use super::super::adaptive::{Adaptive, Fields, Nodes, check_finite};
use super::super::channel::{Channel, rgb, wavelengths};
use super::super::file::Fault;
use super::super::input::{Input, MOST_VALUES};
use super::super::measurement::{Component, Data, Measurement, Side};
use super::super::metadata::Metadata;
use super::super::tensor_file::{self, TensorFile, TensorWriter};
use super::unsupported;
use crate::BrdfError;
use std::path::Path;

/// Version of the fields, as the database's files have it.
const FIELDS_VERSION: [u8; 2] = [1, 0];
/// The fields that are read.
const READ: &[&str] = &[
    "version",
    "description",
    "phi_i",
    "theta_i",
    "sigma",
    "ndf",
    "vndf",
    "luminance",
    "rgb",
    "wavelengths",
    "spectra",
    "jacobian",
];

/// Whether a file is a container that names these fields in its header.
pub(super) fn detect(head: &[u8], _length: u64) -> bool {
    let names = |name: &[u8]| head.windows(name.len()).any(|w| w == name);
    head.starts_with(tensor_file::MAGIC) && names(b"theta_i") && names(b"vndf")
}

/// Reads a measurement.
///
/// # Errors
/// If the container is broken, a field is missing, or one has another type, shape or content than the format says.
pub fn parse(input: &Input<'_>) -> Result<Measurement, BrdfError> {
    let file = TensorFile::parse(input.bytes(), input.path())?;
    let fields = Fields {
        input,
        file: &file,
        prefix: "",
    };
    let (data, channels) = data(&fields).map_err(|fault| fault.at(input.path()))?;
    let mut metadata = Metadata::of_format("rgl");
    let description = file.find("description").and_then(|f| file.text(f));
    metadata.description = description.unwrap_or_default();
    let components = vec![Component::reflection(Data::Adaptive(data))];
    let mut measurement = Measurement::new(components, channels, metadata)
        .map_err(|e| input.error("fields", e.to_string(), "fields that agree"))?;
    let read =
        |name: &str| READ.contains(&name) && (name != "rgb" || file.find("spectra").is_none());
    let unused = file.fields().iter().filter(|f| !read(&f.name));
    measurement.unused = unused.map(|f| format!("field `{}`", f.name)).collect();
    Ok(measurement)
}

fn data(fields: &Fields<'_, '_>) -> Result<(Adaptive, Vec<Channel>), Fault> {
    let tables = fields.tables()?;
    let (name, channels) = if fields.file.find("spectra").is_some() {
        let nm = fields.list("wavelengths")?;
        check_finite("wavelengths", &nm)?;
        if let Some(first) = nm.first().filter(|nm| **nm <= 0.0) {
            let expected = "positive wavelengths in nanometres";
            return Err(Fault::new("field `wavelengths`", first, expected));
        }
        let channel = |nm: &f32| Channel::Wavelength(f64::from(*nm));
        ("spectra", nm.iter().map(channel).collect())
    } else {
        ("rgb", rgb())
    };
    let shape = [tables.phi_i.len(), tables.theta_i.len(), channels.len()];
    let Nodes {
        width,
        height,
        values,
    } = fields.functions(name, &shape)?;
    let like = &tables.luminance;
    if (width, height) != (like.width, like.height) {
        return Err(Fault::new(
            format!("field `{name}`"),
            format!("{height}×{width} nodes"),
            format!("{}×{}, as `luminance` has", like.height, like.width),
        ));
    }
    if values.len() as u64 > MOST_VALUES {
        let found = format!("{} values", values.len());
        let expected = format!("at most {MOST_VALUES}");
        return Err(Fault::new(format!("field `{name}`"), found, expected));
    }
    check_finite(name, &values)?;
    let count = channels.len();
    Ok((Adaptive::checked(tables, count, values)?, channels))
}

/// Writes an adaptive table of RGB or of wavelengths.
///
/// # Errors
/// If the measurement has another layout or other channels, or the file can't be written.
pub fn write(path: &Path, measurement: &Measurement) -> Result<(), BrdfError> {
    measurement.check()?;
    let data = match measurement
        .component(Side::ReflectionFront)
        .map(|c| &c.data)
    {
        Some(Data::Adaptive(data)) => data,
        Some(other) => {
            return Err(unsupported(&format!(
                "an RGL file holds an adaptive table, not a {}",
                other.name()
            )));
        }
        None => {
            return Err(unsupported(
                "an RGL file holds the reflection on the front, which this measurement lacks",
            ));
        }
    };
    let channels = &measurement.channels;
    let lambda: Vec<f32> = wavelengths(channels).iter().map(|nm| *nm as f32).collect();
    let name = if *channels == rgb() {
        "rgb"
    } else if lambda.len() == channels.len() {
        "spectra"
    } else {
        let names: Vec<String> = channels.iter().map(ToString::to_string).collect();
        return Err(unsupported(&format!(
            "an RGL file holds red, green and blue, or wavelengths, not {}",
            names.join(", ")
        )));
    };
    let mut file = TensorWriter::new();
    file.bytes("version", &[2], &FIELDS_VERSION);
    let metadata = &measurement.metadata;
    let description = match metadata.description.is_empty() {
        true => metadata.name.as_bytes(),
        false => metadata.description.as_bytes(),
    };
    file.bytes("description", &[description.len()], description);
    let tables = data.tables();
    tables.write(&mut file, "");
    if name == "spectra" {
        file.f32s("wavelengths", &[lambda.len()], &lambda);
    }
    let shape = [
        tables.phi_i.len(),
        tables.theta_i.len(),
        channels.len(),
        tables.luminance.height,
        tables.luminance.width,
    ];
    file.f32s(name, &shape, data.values());
    file.write(path)
}
