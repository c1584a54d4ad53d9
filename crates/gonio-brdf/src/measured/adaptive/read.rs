//! Reading `.bsdf` files of the RGL material database.

use super::Adaptive;
use super::spectra::{Spectra, Values};
use super::tables::{Grid, Tables};
use crate::BrdfError;
use crate::measured::file::{self, Fault};
use crate::measured::tensor_file::{self, Dtype, Field, TensorFile, dimensions_of};
use memmap2::Mmap;
use std::path::Path;
use std::sync::Arc;

/// What the format is called in messages.
pub const WHAT: &str = "a measurement of the RGL database (`.bsdf`)";

impl Adaptive {
    /// Reads a file. It is mapped into memory; spectra stay there, and must not be overwritten or cut off while this is in use.
    ///
    /// # Errors
    /// As [`Tables::read`], and [`BrdfError::Format`] where [`Adaptive::new`] fails.
    pub fn read(path: &Path) -> Result<Self, BrdfError> {
        Self::of_tables(Tables::read(path)?, path)
    }

    /// From the bytes of a file, of which spectra are copied; `path` names it in errors.
    ///
    /// # Errors
    /// As [`Adaptive::read`], but for those of reading.
    pub fn from_bytes(bytes: &[u8], path: &Path) -> Result<Self, BrdfError> {
        let file = TensorFile::parse(bytes, path)?;
        Self::of_tables(Tables::from_file(&file, None, path)?, path)
    }

    fn of_tables(tables: Tables, path: &Path) -> Result<Self, BrdfError> {
        Self::from_tables(tables).map_err(|fault| fault.at(path))
    }
}

impl Tables {
    /// Whether a `tensor_file` is a measurement of this format, by its fields.
    pub fn are_in(file: &TensorFile<'_>) -> bool {
        file.find("vndf").is_some() && file.find("theta_i").is_some()
    }

    /// Reads a file. It is mapped into memory; spectra stay there, and must not be overwritten or cut off while this is in use.
    ///
    /// # Errors
    /// [`BrdfError::Io`] if it can't be read; [`BrdfError::Format`] if it is not a regular file or not of this format, or if a field is
    /// missing or of another type or size than its companions ask for.
    pub fn read(path: &Path) -> Result<Self, BrdfError> {
        let map = file::map(path, tensor_file::MAGIC, WHAT)?;
        let file = TensorFile::parse(&map, path)?;
        Self::from_file(&file, Some(&map), path)
    }

    /// From a file's header and bytes: `map` is the memory map that they are of, or nothing, to have spectra copied. `path`
    /// names the file in errors.
    ///
    /// # Errors
    /// As [`Tables::read`], but for those of reading.
    pub fn from_file(
        file: &TensorFile<'_>,
        map: Option<&Arc<Mmap>>,
        path: &Path,
    ) -> Result<Self, BrdfError> {
        tables(&Reader(file), map).map_err(|fault| fault.at(path))
    }
}

/// Whether a file of this format has one azimuth or two; `None` if it is no such file.
pub(crate) fn isotropic_file(path: &Path) -> Option<bool> {
    let map = file::map(path, tensor_file::MAGIC, WHAT).ok()?;
    let file = TensorFile::parse(&map, path).ok()?;
    Tables::are_in(&file).then_some(file.find("phi_i")?.count() <= 2)
}

fn tables(file: &Reader<'_, '_>, map: Option<&Arc<Mmap>>) -> Result<Tables, Fault> {
    let theta_i = file.list("theta_i")?;
    let phi_i = file.list("phi_i")?;
    let (phis, thetas) = (phi_i.len(), theta_i.len());
    let rgb = match file.0.find("rgb") {
        Some(_) => Some(file.grid("rgb", &[phis, thetas, 3])?),
        None => None,
    };
    let spectra = match file.0.find("spectra") {
        Some(_) => Some(file.spectra(phis, thetas, map)?),
        None => None,
    };
    let description = file.0.find("description").and_then(|f| file.0.text(f));
    Ok(Tables {
        description: description.unwrap_or_default(),
        ndf: file.grid("ndf", &[])?,
        sigma: file.grid("sigma", &[])?,
        vndf: file.grid("vndf", &[phis, thetas])?,
        luminance: file.grid("luminance", &[phis, thetas])?,
        rgb,
        spectra,
        jacobian: file.flag("jacobian")?,
        phi_i,
        theta_i,
    })
}

struct Reader<'a, 'b>(&'a TensorFile<'b>);

impl Reader<'_, '_> {
    fn field(&self, name: &str) -> Result<&Field, Fault> {
        self.0.find(name).ok_or_else(|| {
            let names: Vec<_> = self.0.fields().iter().map(|f| f.name.as_str()).collect();
            let found = match names.len() {
                0 => "no field".into(),
                _ => names.join(", "),
            };
            Fault::new("fields", found, format!("`{name}` among them"))
        })
    }

    /// A field of `f32` whose dimensions begin with `first`, where an empty `rest` may be any numbers.
    fn f32_field(&self, name: &str, first: &[usize], rest: usize) -> Result<&Field, Fault> {
        let field = self.field(name)?;
        let place = format!("field `{name}`");
        if field.dtype != Dtype::F32 {
            return Err(Fault::new(place, field.dtype.name(), Dtype::F32.name()));
        }
        if field.shape.len() != first.len() + rest || !field.shape.starts_with(first) {
            let mut expected: Vec<_> = first.iter().map(usize::to_string).collect();
            expected.extend(std::iter::repeat_n("n".to_owned(), rest));
            return Err(Fault::new(
                place,
                format!("dimensions {}", dimensions_of(&field.shape)),
                format!("dimensions {}", expected.join("×")),
            ));
        }
        Ok(field)
    }

    fn list(&self, name: &str) -> Result<Vec<f32>, Fault> {
        Ok(self.numbers(self.f32_field(name, &[], 1)?))
    }

    fn grid(&self, name: &str, first: &[usize]) -> Result<Grid, Fault> {
        let field = self.f32_field(name, first, 2)?;
        Ok(Grid {
            height: field.shape[first.len()],
            width: field.shape[first.len() + 1],
            values: self.numbers(field),
        })
    }

    fn spectra(
        &self,
        phis: usize,
        thetas: usize,
        map: Option<&Arc<Mmap>>,
    ) -> Result<Spectra, Fault> {
        let lambda_nm = self.list("wavelengths")?;
        let field = self.f32_field("spectra", &[phis, thetas, lambda_nm.len()], 2)?;
        Ok(Spectra {
            lambda_nm,
            height: field.shape[3],
            width: field.shape[4],
            values: match map {
                Some(map) => Values::Mapped(Arc::clone(map), field.range.clone()),
                None => Values::Owned(self.numbers(field)),
            },
        })
    }

    fn numbers(&self, field: &Field) -> Vec<f32> {
        self.0.f32s(field).expect("invariant: the type was checked")
    }

    fn flag(&self, name: &str) -> Result<bool, Fault> {
        let field = self.field(name)?;
        match (field.dtype, self.0.bytes_of(field)) {
            (Dtype::U8, [flag]) => Ok(*flag != 0),
            _ => Err(Fault::new(
                format!("field `{name}`"),
                format!(
                    "{} of dimensions {}",
                    field.dtype.name(),
                    dimensions_of(&field.shape)
                ),
                "one uint8",
            )),
        }
    }
}
