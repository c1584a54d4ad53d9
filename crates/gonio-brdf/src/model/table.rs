//! A measured table (T19).

use crate::measured::Measured;
use crate::measured::adaptive::{self, Adaptive};
use crate::part::colour::{cast, mean, mul};
use crate::{Brdf, BrdfError, Declares, Kind, ModelInfo, ModelSpec, Number, ParameterInfo, Sample};
use gonio_num::{Real, Vec3};
use std::path::Path;

/// What the registry knows.
pub const INFO: ModelInfo = ModelInfo {
    name: "table",
    summary: "a measured table: a file of the MERL or the RGL database",
    paper: "Matusik et al. 2003, \"A Data-Driven Reflectance Model\"; Rusinkiewicz 1998 for the angles; Dupuy & Jakob 2018, \"An Adaptive Parameterization for Efficient Material Acquisition and Rendering\"",
    parameters: &[
        ParameterInfo {
            name: "file",
            kind: Kind::Path,
            meaning: "the file, in the MERL or the RGL format",
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
    declares,
};

/// A measurement promises nothing on energy. Half and difference angles make a table reciprocal and isotropic; that of the RGL database
/// is as reciprocal as the instrument was, and isotropic if one azimuth was measured.
fn declares(spec: &ModelSpec) -> Declares {
    let mut declares = Declares::physical(f64::INFINITY);
    if let Some(crate::Value::Path(file)) = spec.value("file") {
        // A file that can't be read declares nothing: building the model says what is wrong with it.
        if let Some(isotropic) = adaptive::isotropic_file(Path::new(&file)) {
            declares.reciprocal = false;
            declares.isotropic = isotropic;
        }
    }
    declares
}

/// f from a measurement times a colour.
///
/// Evaluated lane by lane, cells in double precision whatever R is; but [`batch`](crate::batch) evaluates an [`Adaptive`] over lanes.
#[derive(Debug, Clone)]
pub struct Table<R: Real, const N: usize> {
    /// The measurement, RGB; for N > 3 its last component repeats.
    pub data: Measured,
    /// What it is multiplied by.
    pub scale: [R; N],
}

impl<R: Number, const N: usize> Table<R, N> {
    /// A measurement in memory.
    pub fn new(data: impl Into<Measured>) -> Self {
        Self {
            data: data.into(),
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
            data: Measured::read(Path::new(&file))?,
            scale: spec.colour("scale")?,
        })
    }

    pub(crate) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> Table<S, N> {
        Table {
            data: self.data.clone(),
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

/// Six numbers of two vectors.
fn six<R: Real>(a: Vec3<R>, b: Vec3<R>) -> [R; 6] {
    [a.x, a.y, a.z, b.x, b.y, b.z]
}

impl<R: Number, const N: usize> Brdf<R, N> for Table<R, N> {
    fn eval(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        let rgb = match &self.data {
            Measured::Tabulated(table) => R::through(six(wi, wo), &|x| {
                let (wi, wo) = pair(x);
                table.eval(wi, wo)
            }),
            Measured::Adaptive(adaptive) => R::call(&adaptive::Eval(adaptive), six(wi, wo)),
        };
        mul(self.scale, super::components(rgb))
    }

    fn pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        let [density] = match &self.data {
            Measured::Tabulated(table) => R::through(six(wi, wo), &|x| {
                let (wi, wo) = pair(x);
                [table.pdf(wi, wo)]
            }),
            Measured::Adaptive(adaptive) => R::call(&adaptive::Pdf(adaptive), six(wi, wo)),
        };
        density
    }

    fn eval_and_pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> ([R; N], R) {
        let Measured::Adaptive(adaptive) = &self.data else {
            return (self.eval(wi, wo), self.pdf(wi, wo));
        };
        let [r, g, b, density] = R::call(&adaptive::EvalAndPdf(adaptive), six(wi, wo));
        (mul(self.scale, super::components([r, g, b])), density)
    }

    fn sample(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R, N> {
        let u = Vec3::new(u[0], u[1], u[2]);
        // Where nothing is drawn: a direction below the horizon, of density 0.
        let [x, y, z] = match &self.data {
            Measured::Tabulated(table) => R::through(six(wo, u), &|x| {
                let (wo, u) = pair(x);
                let down = Vec3::new(0.0, 0.0, -1.0);
                table.sample(wo, u.to_array()).unwrap_or(down).to_array()
            }),
            Measured::Adaptive(adaptive) => R::call(&adaptive::Draw(adaptive), six(wo, u)),
        };
        self.sample_of(Vec3::new(x, y, z), wo)
    }

    fn albedo_estimate(&self, wo: Vec3<R>) -> R {
        let albedo = match &self.data {
            Measured::Tabulated(table) => R::lit((table.mean() * std::f64::consts::PI).min(1.0)),
            Measured::Adaptive(adaptive) => Brdf::<R, 3>::albedo_estimate(&**adaptive, wo),
        };
        albedo * mean(self.scale)
    }
}

impl<const N: usize> Table<f32, N> {
    /// The measurement, if it has batches of its own for the colours that are asked for.
    pub(crate) fn batched(&self) -> Option<(&Adaptive, [f32; 3])> {
        match &self.data {
            Measured::Adaptive(adaptive) if N == 3 => {
                Some((adaptive, std::array::from_fn(|k| self.scale[k])))
            }
            _ => None,
        }
    }
}
