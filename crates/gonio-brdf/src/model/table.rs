//! A measured table (T19).

use crate::measured::{Tabulated, merl};
use crate::part::colour::{cast, mean, mul};
use crate::{Brdf, BrdfError, Declares, Kind, ModelInfo, ModelSpec, Number, ParameterInfo, Sample};
use gonio_num::{Real, Vec3};
use std::path::Path;
use std::sync::Arc;

/// What the registry knows.
pub const INFO: ModelInfo = ModelInfo {
    name: "table",
    summary: "a measured table: a file of the MERL database",
    paper: "Matusik et al. 2003, \"A Data-Driven Reflectance Model\"; Rusinkiewicz 1998 for the angles",
    parameters: &[
        ParameterInfo {
            name: "file",
            kind: Kind::Path,
            meaning: "the file, in the MERL format",
        },
        ParameterInfo::colour(
            "scale",
            (0.0, 1000.0),
            Some([1.0; 3]),
            "what to multiply by",
        ),
    ],
    positional: Some("file"),
    aliases: &[crate::Alias {
        name: "merl",
        preset: &[],
    }],
    recordable: false,
    // Half and difference angles make it reciprocal and isotropic; a measurement promises nothing on energy.
    declares: |_| Declares::physical(f64::INFINITY),
};

/// f from a [`Tabulated`] times a colour. Evaluated in double precision whatever R is.
#[derive(Debug, Clone)]
pub struct Table<R: Real, const N: usize> {
    /// The table, RGB; for N > 3 its last component repeats.
    pub data: Arc<Tabulated>,
    /// What it is multiplied by.
    pub scale: [R; N],
}

impl<R: Number, const N: usize> Table<R, N> {
    /// A table in memory.
    pub fn new(data: Arc<Tabulated>) -> Self {
        Self {
            data,
            scale: [R::one(); N],
        }
    }

    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        if N != 3 {
            return Err(BrdfError::Unsupported {
                what: format!("a table holds RGB values, and {N} components were asked for"),
            });
        }
        let Some(crate::Value::Path(file)) = spec.value("file") else {
            return Err(spec.wrong("file", "a file's path"));
        };
        Ok(Self {
            data: Arc::new(merl::read(Path::new(&file))?),
            scale: spec.colour("scale")?,
        })
    }

    pub(crate) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> Table<S, N> {
        Table {
            data: Arc::clone(&self.data),
            scale: cast(self.scale, f),
        }
    }

    pub(crate) fn set(&mut self, _parameter: &str, value: [R; 3]) {
        self.scale = super::components(value);
    }
}

/// Two vectors out of six numbers.
fn pair([a, b, c, d, e, f]: [f64; 6]) -> (Vec3<f64>, Vec3<f64>) {
    (Vec3::new(a, b, c), Vec3::new(d, e, f))
}

impl<R: Number, const N: usize> Brdf<R, N> for Table<R, N> {
    fn eval(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        let rgb = R::through([wi.x, wi.y, wi.z, wo.x, wo.y, wo.z], &|x| {
            let (wi, wo) = pair(x);
            self.data.eval(wi, wo)
        });
        mul(self.scale, super::components(rgb))
    }

    fn pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        let [density] = R::through([wi.x, wi.y, wi.z, wo.x, wo.y, wo.z], &|x| {
            let (wi, wo) = pair(x);
            [self.data.pdf(wi, wo)]
        });
        density
    }

    fn sample(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R, N> {
        let [x, y, z] = R::through([wo.x, wo.y, wo.z, u[0], u[1], u[2]], &|x| {
            let (wo, u) = pair(x);
            // Nothing is drawn: a direction below the horizon, of density 0.
            let down = Vec3::new(0.0, 0.0, -1.0);
            self.data
                .sample(wo, u.to_array())
                .unwrap_or(down)
                .to_array()
        });
        let wi = Vec3::new(x, y, z);
        self.sample_of(wi, wo)
    }

    fn albedo_estimate(&self, _wo: Vec3<R>) -> R {
        R::lit((self.data.mean() * std::f64::consts::PI).min(1.0)) * mean(self.scale)
    }
}
