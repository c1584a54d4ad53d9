//! Writing `.bsdf` files of the RGL material database.

use super::tables::{Grid, Tables};
use crate::BrdfError;
use crate::measured::tensor_file::TensorWriter;
use std::path::Path;

/// Version of the fields, as the database's files have it.
const FIELDS_VERSION: [u8; 2] = [1, 0];

impl Tables {
    /// The bytes of a `.bsdf` file.
    ///
    /// # Errors
    /// As [`Adaptive::new`](super::Adaptive::new).
    pub fn to_bytes(&self) -> Result<Vec<u8>, BrdfError> {
        self.check().map_err(|fault| BrdfError::Parameter {
            model: "table".into(),
            parameter: fault.place,
            found: fault.found,
            expected: fault.expected,
        })?;
        let (phis, thetas) = (self.phi_i.len(), self.theta_i.len());
        let mut file = TensorWriter::new();
        file.bytes("version", &[2], &FIELDS_VERSION);
        let description = self.description.as_bytes();
        file.bytes("description", &[description.len()], description);
        file.f32s("phi_i", &[phis], &self.phi_i);
        file.f32s("theta_i", &[thetas], &self.theta_i);
        let mut grid = |name: &str, first: &[usize], grid: &Grid| {
            let shape = [first, &[grid.height, grid.width]].concat();
            file.f32s(name, &shape, &grid.values);
        };
        grid("sigma", &[], &self.sigma);
        grid("ndf", &[], &self.ndf);
        grid("vndf", &[phis, thetas], &self.vndf);
        grid("luminance", &[phis, thetas], &self.luminance);
        if let Some(rgb) = &self.rgb {
            grid("rgb", &[phis, thetas, 3], rgb);
        }
        if let Some(spectra) = &self.spectra {
            let count = spectra.lambda_nm.len();
            file.f32s("wavelengths", &[count], &spectra.lambda_nm);
            let shape = [phis, thetas, count, spectra.height, spectra.width];
            let values: Vec<f32> = spectra.values.slice(0, spectra.values.len()).collect();
            file.f32s("spectra", &shape, &values);
        }
        file.bytes("jacobian", &[1], &[u8::from(self.jacobian)]);
        Ok(file.to_bytes())
    }

    /// Writes a `.bsdf` file; to a temporary name in the same folder first, then renamed.
    ///
    /// # Errors
    /// As [`Adaptive::new`](super::Adaptive::new), or if the file can't be written.
    pub fn write(&self, path: &Path) -> Result<(), BrdfError> {
        crate::measured::file::write(path, &self.to_bytes()?)
    }
}
