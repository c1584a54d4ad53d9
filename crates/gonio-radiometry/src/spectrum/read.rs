//! Spectra in text files: a wavelength and one or more values a row.

use super::Spectrum;
use crate::RadiometryError;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// The largest file that is read \[bytes\]: a thousand columns by 1 nm stay well below it.
const MAX_BYTES: u64 = 16 << 20;

/// A table of spectra that share their wavelengths.
///
/// The text: one row a wavelength \[nm\], strictly increasing, then one value a column, separated by commas, semicolons,
/// tabs or spaces. "#" begins a comment; empty lines are skipped. If the first row doesn't begin with a number it names the
/// columns. This covers `.csv` and `.spd` files.
#[derive(Debug, Clone, PartialEq)]
pub struct SpectralColumns {
    /// Names of the columns; empty if the text has none.
    pub names: Vec<String>,
    /// The wavelengths \[nm\], positive and strictly increasing.
    pub lambda_nm: Vec<f64>,
    /// The values, column by column.
    pub values: Vec<Vec<f64>>,
}

impl SpectralColumns {
    /// Reads `text`; `file` is its name in errors.
    ///
    /// # Errors
    /// [`RadiometryError::SpectrumFile`] with the line, for: a field that isn't a finite number, a row with too few or too
    /// many fields, wavelengths that don't increase or aren't in nm, and text without any row.
    pub fn parse(text: &str, file: &str) -> Result<Self, RadiometryError> {
        let error = |line: usize, found: String, expected: &str| RadiometryError::SpectrumFile {
            file: file.to_owned(),
            line,
            found,
            expected: expected.to_owned(),
        };
        let mut columns = Self {
            names: Vec::new(),
            lambda_nm: Vec::new(),
            values: Vec::new(),
        };
        let mut last_line = 1;
        let mut header = None;
        // A mark of byte order is no part of the first field.
        for (i, raw) in text.trim_start_matches('\u{feff}').lines().enumerate() {
            let line = i + 1;
            last_line = line;
            let row = raw.split('#').next().unwrap_or_default().trim();
            if row.is_empty() {
                continue;
            }
            let fields = split(row);
            let first = columns.lambda_nm.is_empty();
            if first && header.is_none() && fields[0].parse::<f64>().is_err() {
                header = Some(fields.len().max(2));
                columns.names = fields[1..].iter().map(|&s| s.to_owned()).collect();
                continue;
            }
            let expected = match (header, first) {
                (Some(n), _) => n,
                (None, true) => fields.len().max(2),
                (None, false) => columns.values.len() + 1,
            };
            if fields.len() != expected {
                let wanted = format!("a wavelength and {} value(s)", expected - 1);
                return Err(error(line, format!("{} field(s)", fields.len()), &wanted));
            }
            if first {
                columns.values = vec![Vec::new(); fields.len() - 1];
            }
            let mut numbers = Vec::with_capacity(fields.len());
            for field in fields {
                let number = field.parse().ok().filter(|x: &f64| x.is_finite());
                numbers.push(number.ok_or_else(|| error(line, quoted(field), "a finite number"))?);
            }
            let lambda = numbers[0];
            let previous = columns.lambda_nm.last().copied().unwrap_or(0.0);
            if lambda <= previous {
                let found = format!("the wavelength {lambda} nm after {previous} nm");
                return Err(error(line, found, "positive, increasing wavelengths"));
            }
            columns.lambda_nm.push(lambda);
            for (column, &value) in columns.values.iter_mut().zip(&numbers[1..]) {
                column.push(value);
            }
        }
        match columns.lambda_nm.last() {
            None => Err(error(
                last_line,
                "no row of numbers".to_owned(),
                "rows of a wavelength [nm] and values",
            )),
            Some(&longest) if longest < 50.0 => Err(error(
                last_line,
                format!("wavelengths up to {longest}"),
                "wavelengths in nm (these look like µm)",
            )),
            Some(_) => Ok(columns),
        }
    }

    /// Reads the file at `path`, of up to 16 MiB.
    ///
    /// # Errors
    /// [`RadiometryError::Read`] if it can't be read, is larger, or isn't UTF-8 text; otherwise as [`SpectralColumns::parse`].
    pub fn read(path: &Path) -> Result<Self, RadiometryError> {
        let file = path.display().to_string();
        let text = read_limited(path, MAX_BYTES)?;
        let text = String::from_utf8(text).map_err(|e| RadiometryError::Read {
            file: file.clone(),
            message: format!(
                "it isn't text: byte {} isn't UTF-8",
                e.utf8_error().valid_up_to()
            ),
        })?;
        Self::parse(&text, &file)
    }

    /// Column `i` as a spectrum, linear between its points and held beyond; `None` if there is no such column.
    pub fn spectrum(&self, i: usize) -> Option<Spectrum> {
        let values = self.values.get(i)?.clone();
        Spectrum::irregular(self.lambda_nm.clone(), values).ok()
    }
}

impl Spectrum {
    /// Reads text with one value a row; `file` is its name in errors. See [`SpectralColumns`] for the form.
    ///
    /// # Errors
    /// As [`SpectralColumns::parse`], and if the rows have more than one value.
    pub fn parse(text: &str, file: &str) -> Result<Self, RadiometryError> {
        Self::single(&SpectralColumns::parse(text, file)?, file)
    }

    /// Reads the file at `path`, with one value a row.
    ///
    /// # Errors
    /// As [`SpectralColumns::read`], and if the rows have more than one value.
    pub fn read(path: &Path) -> Result<Self, RadiometryError> {
        Self::single(&SpectralColumns::read(path)?, &path.display().to_string())
    }

    fn single(columns: &SpectralColumns, file: &str) -> Result<Self, RadiometryError> {
        if columns.values.len() != 1 {
            return Err(RadiometryError::SpectrumFile {
                file: file.to_owned(),
                line: 1,
                found: format!("{} values a row", columns.values.len()),
                expected: "one spectrum: a wavelength and one value a row".to_owned(),
            });
        }
        Self::irregular(columns.lambda_nm.clone(), columns.values[0].clone())
    }
}

/// The fields of a row. Where there are commas or semicolons, an empty field between two is a field.
fn split(row: &str) -> Vec<&str> {
    if row.contains([',', ';']) {
        row.split([',', ';']).map(str::trim).collect()
    } else {
        row.split_whitespace().collect()
    }
}

fn quoted(field: &str) -> String {
    let short: String = field.chars().take(40).collect();
    format!("\"{short}\"")
}

/// The bytes of a file, refused beyond `max` without reading more.
pub(crate) fn read_limited(path: &Path, max: u64) -> Result<Vec<u8>, RadiometryError> {
    let error = |message: String| RadiometryError::Read {
        file: path.display().to_string(),
        message,
    };
    let file = File::open(path).map_err(|e| error(e.to_string()))?;
    let mut bytes = Vec::new();
    file.take(max + 1)
        .read_to_end(&mut bytes)
        .map_err(|e| error(e.to_string()))?;
    if bytes.len() as u64 > max {
        return Err(error(format!("it is larger than {max} bytes")));
    }
    Ok(bytes)
}
