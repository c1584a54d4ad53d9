//! A reflection function written as a shader.

use super::Composite;
use crate::part::colour::only_where;
use crate::part::geometry::above;
use crate::{
    Brdf, BrdfError, Declares, Kind, Model, ModelInfo, ModelSpec, Number, ParameterInfo, Sample,
    Value, shader_file,
};
use gonio_num::{Real, Vec3};
use gonio_radiometry::warp::{cosine_hemisphere, cosine_hemisphere_density};
use gonio_shader::Language;
use gonio_verify::{Reflection, SubjectFailed, SubjectSample};
use std::marker::PhantomData;
use std::sync::Arc;

/// What the registry knows.
pub const INFO: ModelInfo = ModelInfo {
    name: "shader",
    summary: "a function in WGSL, GLSL or BRDF Explorer's format, with the parameters that it declares",
    paper: "Baker 2024, \"WebGPU Shading Language\", W3C; Kessenich, Baldwin & Rost 2017, \"The OpenGL Shading Language\", version 4.50; \
            Burley et al. 2012, Disney BRDF Explorer, for `.brdf` files",
    parameters: &[
        ParameterInfo {
            name: "file",
            kind: Kind::Path,
            meaning: "the shader; its extension tells the language, or else its content",
        },
        ParameterInfo {
            name: "entry",
            kind: Kind::Name,
            meaning: "the function to evaluate, or the x of x_eval, x_pdf and x_sample, of a file that has several",
        },
        ParameterInfo::number(
            "step_limit",
            "",
            (1.0, 1e12),
            Some(1e7),
            "operations that the loops of one evaluation may make before it is stopped",
        ),
    ],
    positional: Some("file"),
    aliases: &[],
    recordable: false,
    declares,
};

/// What a reflection function should have; a check shows whether it does.
fn declares(_spec: &ModelSpec) -> Declares {
    Declares::physical(1.0)
}

/// f(ωi, ωo) as a shader computes it, run without a GPU.
///
/// What the shader gives below the horizon is taken for 0, so that nothing shines through a surface; the check of a shader looks at it as
/// it is, but for BRDF Explorer's files, since that program asks them for directions above the surface only. A value that is negative or no number stays as it is, and a rendering counts and reports it.
///
/// A shader with `sample` and `pdf` draws directions itself. With neither, directions are drawn by the cosine; nor can one of the two
/// alone serve: a density that nothing is drawn by has no use, and a direction whose density elsewhere isn't known can't be combined with
/// other ways to find light. The check looks at whatever is there.
///
/// After an evaluation that didn't end within its steps the model is NaN everywhere.
#[derive(Debug, Clone)]
pub struct Shader<R: Real, const N: usize, P = Model<R, N>> {
    shader: Arc<gonio_shader::Shader>,
    /// For each parameter its name and where its first component is.
    names: Arc<[(&'static str, usize, usize)]>,
    /// Each component of each parameter.
    values: Vec<R>,
    /// A rough mean of its albedo.
    albedo: R,
    other: PhantomData<([R; N], P)>,
}

impl<R: Number, const N: usize> Shader<R, N> {
    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        let Some(loaded) = shader_file::load(spec)? else {
            return Err(spec.wrong("file", "a file's path"));
        };
        let (mut names, mut values) = (Vec::new(), Vec::new());
        for p in loaded.parameters {
            let first = values.len();
            match spec.value(p.name) {
                Some(Value::Number(x)) => values.push(x),
                Some(Value::Colour(c)) => values.extend(c),
                _ => return Err(spec.wrong(p.name, &p.expected())),
            }
            names.push((p.name, first, values.len() - first));
        }
        // Values that were set for another file.
        for key in spec.values.keys() {
            spec.parameter_exists(key)?;
        }
        let shader = Arc::new(loaded.shader.clone());
        let albedo = rough_albedo(&shader, &values)?;
        Ok(Self {
            shader,
            names: names.into(),
            values: values.into_iter().map(R::lit).collect(),
            albedo: R::lit(albedo),
            other: PhantomData,
        })
    }

    /// What a user should know of the shader.
    pub(crate) fn warnings(&self) -> Vec<String> {
        let mut lines = self.shader.warnings().to_vec();
        let unused = match (self.shader.has_sample(), self.shader.has_pdf()) {
            (true, false) => Some(("sample", "pdf")),
            (false, true) => Some(("pdf", "sample")),
            _ => None,
        };
        if let Some((there, missing)) = unused {
            lines.push(format!(
                "it has `{there}` but no `{missing}`: directions are drawn by the cosine"
            ));
        }
        let path = self.shader.path().display();
        lines.into_iter().map(|l| format!("{path}: {l}")).collect()
    }

    pub(crate) fn set(&mut self, parameter: &str, value: [R; 3]) {
        let found = self.names.iter().find(|(name, ..)| *name == parameter);
        if let Some(&(_, first, n)) = found {
            self.values[first..first + n].copy_from_slice(&value[..n]);
        }
    }
}

impl<R: Real, const N: usize, P> Shader<R, N, P> {
    /// The first evaluation that didn't end, if there was one.
    pub fn failure(&self) -> Option<&gonio_shader::ShaderError> {
        self.shader.failure()
    }

    fn draws(&self) -> bool {
        self.shader.has_sample() && self.shader.has_pdf()
    }
}

impl<R: Real, const N: usize> Composite<R, N> for Shader<R, N> {
    type With<S: Number, P: Brdf<S, N>> = Shader<S, N, P>;

    fn with<'a, S: Number, P: Brdf<S, N>>(
        &'a self,
        number: &impl Fn(R) -> S,
        _part: &impl Fn(&'a Model<R, N>) -> P,
    ) -> Shader<S, N, P>
    where
        R: 'a,
    {
        Shader {
            shader: Arc::clone(&self.shader),
            names: Arc::clone(&self.names),
            values: self.values.iter().map(|&x| number(x)).collect(),
            albedo: number(self.albedo),
            other: PhantomData,
        }
    }
}

impl<R: Number, const N: usize, P> Brdf<R, N> for Shader<R, N, P> {
    fn eval(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        let f = self.shader.eval(&self.values, wi, wo);
        only_where(above(wi, wo), super::components(f))
    }

    fn pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        let own = match self.draws() {
            true => self.shader.pdf(&self.values, wi, wo),
            false => None,
        };
        let pdf = own.unwrap_or_else(|| cosine_hemisphere_density(wi));
        R::select(above(wi, wo), pdf, R::zero())
    }

    fn sample(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R, N> {
        let own = match self.draws() {
            true => self.shader.sample(&self.values, wo, u),
            false => None,
        };
        let Some(s) = own else {
            return self.sample_of(cosine_hemisphere([u[0], u[1]]), wo);
        };
        let valid = above(s.wi, wo) & s.pdf.gt(R::lit(1e-37));
        let drawn = Sample {
            wi: s.wi,
            weight: super::components(s.weight),
            pdf: s.pdf,
            delta: s.delta,
        };
        Sample::select(valid, drawn, Sample::none())
    }

    fn albedo_estimate(&self, _wo: Vec3<R>) -> R {
        self.albedo
    }
}

/// The mean of the directional albedos of three directions, from 64 directions to the light each; at least 0.05, so that it is chosen now
/// and then whatever it is, and at most 1. It is also the first evaluation: a shader that doesn't end is found here.
fn rough_albedo(shader: &gonio_shader::Shader, values: &[f64]) -> Result<f64, BrdfError> {
    const SIDE: usize = 8;
    let (mut wi, mut wo) = (Vec::new(), Vec::new());
    for cos in [0.95f64, 0.6, 0.3] {
        let viewer = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
        for k in 0..SIDE * SIDE {
            let at = |i: usize| (i as f64 + 0.5) / SIDE as f64;
            wi.push(cosine_hemisphere([at(k % SIDE), at(k / SIDE)]));
            wo.push(viewer);
        }
    }
    let mut f = vec![[0.0; 3]; wi.len()];
    shader.eval_many(values, &wi, &wo, &mut f)?;
    // Drawn by the cosine: each counts f·π.
    let sum: f64 = f.iter().map(|f| f.iter().sum::<f64>() / 3.0).sum();
    let mean = sum * std::f64::consts::PI / wi.len() as f64;
    Ok(mean.clamp(0.05, 1.0).max(0.05))
}

/// A shader as it is: what a check asks.
pub(crate) struct Raw<'a, R: Number>(pub &'a Shader<R, 3>);

fn failed(error: gonio_shader::ShaderError) -> SubjectFailed {
    SubjectFailed::new(error.to_string())
}

/// Directions rounded to another number.
fn rounded<R: Real>(all: &[Vec3<f64>]) -> Vec<Vec3<R>> {
    let one = |w: &Vec3<f64>| Vec3::new(R::lit(w.x), R::lit(w.y), R::lit(w.z));
    all.iter().map(one).collect()
}

impl<R: Number<Mask = bool> + Into<f64> + Sync> Reflection for Raw<'_, R> {
    fn eval(
        &self,
        wi: &[Vec3<f64>],
        wo: &[Vec3<f64>],
        f: &mut [[f64; 3]],
    ) -> Result<(), SubjectFailed> {
        let Self(Shader { shader, values, .. }) = self;
        let mut found = vec![[R::zero(); 3]; f.len()];
        shader
            .eval_many(values, &rounded(wi), &rounded(wo), &mut found)
            .map_err(failed)?;
        let asked_above_only = shader.language() == Language::Brdf;
        for (k, (f, found)) in f.iter_mut().zip(found).enumerate() {
            let below = !(wi[k].z > 0.0 && wo[k].z > 0.0);
            *f = match below && asked_above_only {
                true => [0.0; 3],
                false => found.map(Into::into),
            };
        }
        Ok(())
    }

    fn pdf(
        &self,
        wi: &[Vec3<f64>],
        wo: &[Vec3<f64>],
        pdf: &mut [f64],
    ) -> Result<(), SubjectFailed> {
        let Self(Shader { shader, values, .. }) = self;
        let mut found = vec![R::zero(); pdf.len()];
        shader
            .pdf_many(values, &rounded(wi), &rounded(wo), &mut found)
            .map_err(failed)?;
        for (pdf, found) in pdf.iter_mut().zip(found) {
            *pdf = found.into();
        }
        Ok(())
    }

    fn sample(
        &self,
        wo: &[Vec3<f64>],
        u: &[[f64; 3]],
        samples: &mut [Option<SubjectSample>],
    ) -> Result<(), SubjectFailed> {
        let Self(Shader { shader, values, .. }) = self;
        // A number just below 1 must not be rounded to 1.
        let below_one = |u: f64| match R::lit(u) {
            x if x.into() < 1.0 => x,
            _ => R::lit(1.0 - f64::from(f32::EPSILON) / 2.0),
        };
        let u: Vec<[R; 3]> = u.iter().map(|u| u.map(below_one)).collect();
        let drawn = shader
            .sample_many(values, &rounded(wo), &u)
            .map_err(failed)?;
        for (s, sample) in drawn.into_iter().zip(samples) {
            // A density of 0 is nothing; one that is negative or no number is for the check to see.
            *sample = (s.pdf.into() != 0.0).then(|| SubjectSample {
                wi: Vec3::new(s.wi.x.into(), s.wi.y.into(), s.wi.z.into()),
                weight: s.weight.map(Into::into),
                pdf: s.pdf.into(),
                delta: s.delta,
            });
        }
        Ok(())
    }

    fn has_pdf(&self) -> bool {
        self.0.shader.has_pdf()
    }

    fn has_sample(&self) -> bool {
        self.0.shader.has_sample()
    }
}
