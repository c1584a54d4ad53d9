//! The CIE 1931 standard observer.

use super::{Beyond, Regular, SpectralColumns, Spectrum};
use std::sync::{Arc, LazyLock};

/// Colour-matching functions of a standard observer.
#[derive(Debug, Clone)]
pub struct Observer {
    /// x̄(λ).
    pub x: Spectrum,
    /// ȳ(λ): in the CIE 1931 observer the photopic luminous efficiency V(λ).
    pub y: Spectrum,
    /// z̄(λ).
    pub z: Spectrum,
}

static CIE_1931: LazyLock<Observer> = LazyLock::new(|| {
    let columns = SpectralColumns::parse(
        include_str!("data/cie1931_2deg_1nm.csv"),
        "cie1931_2deg_1nm.csv",
    )
    .expect("invariant: the table in the source is well-formed");
    let [x, y, z] = [0, 1, 2].map(|k| {
        let values = columns.values[k].clone();
        let table = Regular::new(columns.lambda_nm[0], 1.0, values, Beyond::Zero)
            .expect("invariant: the table in the source is well-formed");
        Spectrum::Regular(Arc::new(table))
    });
    Observer { x, y, z }
});

impl Observer {
    /// The CIE 1931 standard colorimetric observer (2°), by 1 nm from 360 to 830 nm, linear between, 0 beyond.
    ///
    /// Source: ISO/CIE 11664-1.
    pub fn cie_1931() -> &'static Self {
        &CIE_1931
    }

    /// (x̄, ȳ, z̄) at `lambda_nm`.
    pub fn at(&self, lambda_nm: f64) -> [f64; 3] {
        [
            self.x.at(lambda_nm),
            self.y.at(lambda_nm),
            self.z.at(lambda_nm),
        ]
    }
}
