//! A measured table (T19).

use crate::measured::{self, AdaptiveTable, LoadOptions, Measured, Missing, Repair, Select, Side};
use crate::part::colour::{cast, mean, mul};
use crate::{Brdf, BrdfError, Declares, Kind, ModelInfo, ModelSpec, Number, ParameterInfo, Sample};
use gonio_num::{Real, Vec3};
use std::path::Path;
use std::sync::Arc;

/// What the registry knows.
pub const INFO: ModelInfo = ModelInfo {
    name: "table",
    summary: "a measured table: a file in one of the formats of measured reflection",
    paper: "Matusik et al. 2003, \"A Data-Driven Reflectance Model\"; Rusinkiewicz 1998 for half and difference angles; \
            Klems 1994 for patches; Ward et al. 2012 for tensor trees; \
            Dupuy & Jakob 2018, \"An Adaptive Parameterization for Efficient Material Acquisition and Rendering\", for adaptive tables",
    parameters: &[
        ParameterInfo {
            name: "file",
            kind: Kind::Path,
            meaning: "the file; its format is told by its content",
        },
        ParameterInfo::colour(
            "scale",
            (0.0, 1000.0),
            Some([1.0; 3]),
            "what to multiply by",
        ),
        ParameterInfo::choice(
            "component",
            &[
                "reflection-front",
                "reflection-back",
                "transmission-front",
                "transmission-back",
                "all",
            ],
            None,
            "the side that is evaluated, of a file that has several; without it the reflection on the front, or the only one there is",
        ),
        ParameterInfo::choice(
            "negative",
            &["zero", "fill", "refuse"],
            Some("zero"),
            "what is done with negative values: counted as 0, filled from the cells around, or the file is refused",
        ),
        ParameterInfo::choice(
            "missing",
            &["fill", "zero", "refuse"],
            Some("fill"),
            "what is done with values that the file marks as missing",
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

/// What its layout makes it; a measurement promises nothing on energy. A file that can't be read declares what most do: the model
/// can't be built then.
fn declares(spec: &ModelSpec) -> Declares {
    let mut declares = Declares::physical(f64::INFINITY);
    if let Ok((path, options)) = source(spec)
        && let Ok(data) = measured::load(Path::new(&path), options)
    {
        declares.reciprocal = data.is_reciprocal();
        declares.isotropic = data.is_isotropic();
        declares.relative_ior = data.transmits().then_some([1.0; 3]);
    }
    declares
}

/// The file, and how it is to be read.
fn source(spec: &ModelSpec) -> Result<(String, LoadOptions), BrdfError> {
    let Some(crate::Value::Path(file)) = spec.value("file") else {
        return Err(spec.wrong("file", "a file's path"));
    };
    let repair = |key: &str| Repair::from_word(&spec.word(key)).unwrap_or_default();
    let options = LoadOptions {
        negative: repair("negative"),
        missing: Missing(repair("missing")),
        select: match spec.word("component").as_str() {
            "" => Select::Front,
            "all" => Select::All,
            side => Side::from_name(side).map_or(Select::Front, Select::One),
        },
    };
    Ok((file, options))
}

/// f(ωi, ωo) from a measured table, times a colour.
///
/// A grid of angles is interpolated linearly along every axis, constant beyond the outermost nodes and periodic in azimuth; patches and
/// tensor trees are constant within a cell; an adaptive table is linear over the square that visible microfacet normals are drawn from, and
/// in the viewer's angles. Colours are linear RGB: spectra are projected with the CIE 1931 observer under
/// D65, so that a flat reflectance is grey.
///
/// Sampling is exact for the interpolant: grids are drawn from by cells, of half vectors or of incoming directions, for the viewer's
/// directions around the one at hand; patches and trees in proportion to f·cosθi; adaptive tables by their luminance, then by visible
/// normals.
#[derive(Debug, Clone)]
pub struct Table<R: Real, const N: usize> {
    /// The table.
    pub data: Arc<Measured>,
    /// The file that it was read from; empty for a table in memory.
    pub file: Arc<str>,
    /// What it is multiplied by.
    pub scale: [R; N],
}

impl<R: Number, const N: usize> Table<R, N> {
    /// A table in memory. For N ≠ 3 its first colour component repeats, which is right for a grey one.
    pub fn new(data: Arc<Measured>) -> Self {
        Self {
            data,
            file: "".into(),
            scale: [R::one(); N],
        }
    }

    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        let (file, options) = source(spec)?;
        let data = measured::load(Path::new(&file), options)?;
        if N != 3 && !data.is_grey() {
            return Err(BrdfError::Unsupported {
                what: format!("{file} holds colours, and {N} components were asked for"),
            });
        }
        Ok(Self {
            data: Arc::new(data),
            file: file.into(),
            scale: spec.colour("scale")?,
        })
    }

    pub(crate) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> Table<S, N> {
        Table {
            data: Arc::clone(&self.data),
            file: Arc::clone(&self.file),
            scale: cast(self.scale, f),
        }
    }

    /// Lines about negative and missing values of the file.
    pub(crate) fn warnings(&self) -> Vec<String> {
        let lines = self.data.warnings();
        lines
            .into_iter()
            .map(|l| format!("{}: {l}", self.file))
            .collect()
    }

    pub(crate) fn set(&mut self, _parameter: &str, value: [R; 3]) {
        self.scale = super::components(value);
    }
}

impl<R: Number, const N: usize> Brdf<R, N> for Table<R, N> {
    #[inline(always)]
    fn eval(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        mul(self.scale, super::components(self.data.eval(wi, wo)))
    }

    #[inline(always)]
    fn pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        self.data.pdf(wi, wo)
    }

    #[inline(always)]
    fn eval_and_pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> ([R; N], R) {
        let (f, pdf) = self.data.eval_and_pdf(wi, wo);
        (mul(self.scale, super::components(f)), pdf)
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R, N> {
        self.sample_of(self.data.sample(wo, u), wo)
    }

    #[inline(always)]
    fn albedo_estimate(&self, wo: Vec3<R>) -> R {
        self.data.albedo(wo).min(R::one()) * mean(self.scale)
    }

    #[inline(always)]
    fn transmits(&self) -> bool {
        self.data.transmits()
    }
}

impl<const N: usize> Table<f32, N> {
    /// The table, if it has batches of its own for the colours that are asked for, and what it is multiplied by.
    pub(crate) fn batched(&self) -> Option<(&AdaptiveTable, [f32; 3])> {
        let all = self.data.adaptive_alone()?;
        Some((all, *self.scale.first_chunk().filter(|_| N == 3)?))
    }
}
