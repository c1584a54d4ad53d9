//! The format of the MERL database of measured isotropic reflectance (`.binary`).
//!
//! Three little-endian `i32` (cells along θh, θd, φd; the database has 90, 90, 180), then three planes of little-endian
//! `f64`: red, green, blue; φd varies fastest. Values times 1/1500, 1.15/1500 and 1.66/1500 are sr⁻¹.
//!
//! Source: Matusik et al. 2003, "A Data-Driven Reflectance Model", and the reading code published with it.

use super::{Axes, Tabulated};
use crate::BrdfError;
use std::fs::File;
use std::io::{BufReader, BufWriter, Read, Write};
use std::path::Path;

/// What a stored value is multiplied by to be in sr⁻¹.
const SCALE: [f64; 3] = [1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0];
/// The largest number of cells along an axis that is believed.
const LARGEST: i32 = 4096;

/// Reads a table. Negative values are set to 0 and counted ([`Tabulated::negative_values`]).
///
/// # Errors
/// If the file cannot be read, its header is not three numbers from 1 to 4096, its length is not what the header says, or a value
/// is not finite. Nothing is allocated before the length is known to match.
pub fn read(path: &Path) -> Result<Tabulated, BrdfError> {
    let io = |source| BrdfError::Io {
        path: path.into(),
        source,
    };
    let format = |place: String, found: String, expected: String| BrdfError::Format {
        path: path.into(),
        place,
        found,
        expected,
    };
    let file = File::open(path).map_err(io)?;
    let metadata = file.metadata().map_err(io)?;
    if !metadata.is_file() {
        return Err(format(
            "whole file".into(),
            "not a regular file".into(),
            "a MERL table".into(),
        ));
    }
    let length = metadata.len();
    if length < 12 {
        return Err(format(
            "header".into(),
            format!("{length} bytes"),
            "12 bytes of header, three 32-bit numbers".into(),
        ));
    }
    let mut reader = BufReader::with_capacity(1 << 16, file);
    let mut dims = [0usize; 3];
    for (k, dim) in dims.iter_mut().enumerate() {
        let mut bytes = [0; 4];
        reader.read_exact(&mut bytes).map_err(io)?;
        let n = i32::from_le_bytes(bytes);
        if !(1..=LARGEST).contains(&n) {
            return Err(format(
                format!("header, byte {}", 4 * k),
                format!("{n} cells"),
                format!("1 to {LARGEST} (the database has 90, 90, 180)"),
            ));
        }
        *dim = n as usize;
    }
    let cells = dims.iter().product::<usize>();
    // 4096³ cells of 24 bytes are far below 2⁶⁴.
    let expected = 12 + 24 * cells as u64;
    if length != expected {
        return Err(format(
            "whole file".into(),
            format!("{length} bytes"),
            format!(
                "{expected} bytes for {}×{}×{} cells",
                dims[0], dims[1], dims[2]
            ),
        ));
    }
    let mut values = vec![[0.0f32; 3]; cells];
    for (plane, scale) in SCALE.into_iter().enumerate() {
        for (cell, value) in values.iter_mut().enumerate() {
            let mut bytes = [0; 8];
            reader.read_exact(&mut bytes).map_err(io)?;
            let x = (f64::from_le_bytes(bytes) * scale) as f32;
            if !x.is_finite() {
                let at = 12 + 8 * (plane * cells + cell);
                return Err(format(
                    format!(
                        "{} plane, cell {cell}, byte {at}",
                        ["red", "green", "blue"][plane]
                    ),
                    f64::from_le_bytes(bytes).to_string(),
                    "a finite number".into(),
                ));
            }
            value[plane] = x;
        }
    }
    let [theta_h, theta_d, phi_d] = dims;
    Tabulated::new(
        Axes::HalfDifference {
            theta_h,
            theta_d,
            phi_d,
        },
        values,
    )
}

/// Writes a table of half and difference angles; to a temporary name in the same folder first, then renamed.
///
/// # Errors
/// If the table has other axes, or the file cannot be written.
pub fn write(path: &Path, table: &Tabulated) -> Result<(), BrdfError> {
    let Axes::HalfDifference {
        theta_h,
        theta_d,
        phi_d,
    } = table.axes()
    else {
        return Err(BrdfError::Unsupported {
            what: "a MERL file holds tables of half and difference angles only".into(),
        });
    };
    let mut temporary = path.as_os_str().to_owned();
    temporary.push(".partial");
    let temporary = Path::new(&temporary);
    let written = (|| {
        let mut out = BufWriter::new(File::create(temporary)?);
        for n in [theta_h, theta_d, phi_d] {
            out.write_all(&(n as i32).to_le_bytes())?;
        }
        for (plane, scale) in SCALE.into_iter().enumerate() {
            for value in table.values() {
                out.write_all(&(f64::from(value[plane]) / scale).to_le_bytes())?;
            }
        }
        out.into_inner().map_err(|e| e.into_error())?.sync_all()?;
        std::fs::rename(temporary, path)
    })();
    written.map_err(|source| {
        // What was written is of no use; that it can't be removed either adds nothing to the error.
        let _ = std::fs::remove_file(temporary);
        BrdfError::Io {
            path: path.into(),
            source,
        }
    })
}
