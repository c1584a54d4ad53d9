//! [`Material`]: how a surface reflects, shines and hides what is behind it, and how textures vary that over it.

mod input;
mod shading;

pub use input::{Channels, TextureInput};
pub use shading::{Shading, facing_frame};

use crate::{SceneError, SurfacePoint, Texture};
use gonio_brdf::{Brdf, BrdfError, Kind, Model, ModelSpec, ParameterSlot, Value};
use gonio_num::Vec3;
use gonio_radiometry::sequence::{SampleStream, SamplerKind};
use std::borrow::Cow;

/// A surface's reflection function with the textures that drive its parameters, and its emission, opacity and normal map.
///
/// Both sides of a surface reflect, whatever [`Material::double_sided`] says: an open mesh seen from behind is not black, and
/// no light leaks through it. Single-sided materials *shine* on their front alone.
///
/// A reflection function that transmits makes the surface the boundary of a body, whose inner side lies behind the geometric normal; see
/// [`crate::Interior`] for what the body absorbs.
#[derive(Debug, Clone)]
pub struct Material {
    /// Its name in the scene, for replacing it and for messages.
    pub name: String,
    /// Bends the shading normal.
    pub normal_map: Option<NormalMap>,
    /// What it emits.
    pub emission: Emission,
    /// What it lets through.
    pub opacity: Opacity,
    /// Whether the back shines as the front does.
    pub double_sided: bool,
    /// Whether +y of the local frame is along the bitangent of the mesh, mirrored or not. Otherwise the local frame is right-handed.
    pub along_bitangent: bool,
    spec: ModelSpec,
    model: Model<f32, 3>,
    /// Whether `model` transmits, textures left out.
    model_transmits: bool,
    bindings: Vec<Binding>,
    second_normal: Option<SecondNormal>,
    albedo: [f32; 3],
    /// The binding whose value is the albedo, if one drives the model's colour.
    albedo_binding: Option<usize>,
}

/// A tangent-space normal map: red, green and blue are x, y and z of the normal, each mapped from \[0, 1] to \[−1, 1].
#[derive(Debug, Clone, PartialEq)]
pub struct NormalMap {
    /// The map, linear. +y points up in the picture.
    pub texture: Texture,
    /// Factor on x and y.
    pub scale: f32,
}

/// Emitted radiance \[W m⁻² sr⁻¹], the same in all directions of the side that shines.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Emission {
    /// Radiance, or factor on the texture.
    pub radiance: [f32; 3],
    /// Multiplies the radiance.
    pub texture: Option<Texture>,
    /// Whether the vertex colours multiply the radiance.
    pub vertex_colour: bool,
    /// The group of lights that surfaces of this material are in.
    pub group: Option<String>,
}

/// How much a surface hides.
#[derive(Debug, Clone, PartialEq)]
pub struct Opacity {
    /// What is done with alpha.
    pub mode: AlphaMode,
    /// Factor on alpha, in \[0, 1].
    pub factor: f32,
    /// Its alpha channel multiplies alpha.
    pub texture: Option<TextureInput>,
    /// Whether the alpha of the vertex colours multiplies alpha.
    pub vertex_alpha: bool,
}

/// What is done with alpha, as in glTF.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum AlphaMode {
    /// Nothing: the surface hides all.
    #[default]
    Opaque,
    /// Hides all where alpha ≥ the cutoff, nothing elsewhere.
    Mask(f32),
    /// Hides the share alpha.
    Blend,
}

/// A direction among the model's parameters, which is the normal of the mesh, bent by a map of its own or by none.
#[derive(Debug, Clone)]
struct SecondNormal {
    slot: ParameterSlot,
    map: Option<NormalMap>,
}

/// What drives one parameter of the model: `base` × texture × vertex colour.
#[derive(Debug, Clone)]
struct Binding {
    parameter: &'static str,
    slot: ParameterSlot,
    base: [f32; 3],
    texture: Option<TextureInput>,
    vertex_colour: bool,
}

impl Material {
    /// A material that reflects as `spec` says and nothing more.
    ///
    /// # Errors
    /// [`SceneError::Brdf`] if the model can't be built.
    pub fn new(name: impl Into<String>, spec: &ModelSpec) -> Result<Self, SceneError> {
        let model = spec.build()?;
        let albedo = normal_albedo(&model);
        Ok(Self {
            name: name.into(),
            normal_map: None,
            emission: Emission::default(),
            opacity: Opacity::default(),
            double_sided: false,
            along_bitangent: false,
            second_normal: None,
            spec: spec.clone(),
            model_transmits: model.transmits(),
            model,
            bindings: Vec::new(),
            albedo,
            albedo_binding: None,
        })
    }

    /// The first evaluation of a shader in it that didn't end: since then it reflects NaN. See [`Model::failure`].
    pub fn failure(&self) -> Option<BrdfError> {
        self.model.failure()
    }

    /// What a user should know of the measured files that the model was read from.
    pub fn warnings(&self) -> Vec<String> {
        self.model.warnings()
    }

    /// The description of the model, without its textures.
    pub fn spec(&self) -> &ModelSpec {
        &self.spec
    }

    /// Reflects as `spec` says from now on. Textures that drove the old model's parameters are dropped; emission, opacity,
    /// normal map and name stay.
    ///
    /// # Errors
    /// [`SceneError::Brdf`] if the model can't be built; the material is then unchanged.
    pub fn replace_model(&mut self, spec: &ModelSpec) -> Result<(), SceneError> {
        self.model = spec.build()?;
        self.model_transmits = self.model.transmits();
        self.spec = spec.clone();
        self.bindings.clear();
        self.second_normal = None;
        self.albedo = normal_albedo(&self.model);
        self.albedo_binding = None;
        Ok(())
    }

    /// Lets a texture drive a parameter: its value is the description's × the texture's. So the description's value is the
    /// factor; where the description leaves the parameter out, the factor is 1.
    ///
    /// # Errors
    /// [`SceneError::Brdf`] if the model has no such parameter, or it is no number or colour.
    pub fn bind_texture(&mut self, parameter: &str, input: TextureInput) -> Result<(), SceneError> {
        let binding = self.binding(parameter)?;
        binding.texture = Some(input);
        Ok(())
    }

    /// Lets the vertex colours multiply a parameter.
    ///
    /// # Errors
    /// As [`Material::bind_texture`].
    pub fn bind_vertex_colour(&mut self, parameter: &str) -> Result<(), SceneError> {
        let binding = self.binding(parameter)?;
        binding.vertex_colour = true;
        Ok(())
    }

    /// Lets the normal of the mesh drive a parameter that is a direction in the local frame, such as the normal of a coat: bent by
    /// `map`, not by [`Material::normal_map`].
    ///
    /// # Errors
    /// As [`Material::bind_texture`].
    pub fn bind_normal(
        &mut self,
        parameter: &str,
        map: Option<NormalMap>,
    ) -> Result<(), SceneError> {
        let slot = ParameterSlot::of(&self.spec, parameter)?;
        self.second_normal = Some(SecondNormal { slot, map });
        Ok(())
    }

    /// The set of texture coordinates that the mesh's tangents must follow: that of the first normal map, or the first one where
    /// +y of the local frame is along the bitangent.
    pub(crate) fn tangents_uv_set(&self) -> Option<u8> {
        let second = self.second_normal.as_ref().and_then(|n| n.map.as_ref());
        let map = self.normal_map.as_ref().or(second);
        map.map(|map| map.texture.uv_set)
            .or(self.along_bitangent.then_some(0))
    }

    /// The model with the textures all white: what is driven has its largest value.
    fn largest_model(&self) -> Cow<'_, Model<f32, 3>> {
        if self.bindings.is_empty() {
            return Cow::Borrowed(&self.model);
        }
        let mut model = self.model.clone();
        for binding in &self.bindings {
            model.set_parameter(binding.slot, binding.base);
        }
        Cow::Owned(model)
    }

    /// The reflection function if it is the same all over the surface, with the mesh's own normals, and the surface hides all that is
    /// behind it: then nothing but [`SurfacePoint::ns`] and [`SurfacePoint::tangent`] distinguishes its points.
    pub fn even_model(&self) -> Option<&Model<f32, 3>> {
        let even = self.bindings.is_empty()
            && self.normal_map.is_none()
            && self.second_normal.is_none()
            && !self.along_bitangent
            && self.opacity.is_opaque();
        even.then_some(&self.model)
    }

    /// About the share of light that it reflects, textures left out.
    pub fn albedo(&self) -> [f32; 3] {
        self.albedo
    }

    /// Whether light may pass through the surface somewhere.
    pub fn transmits(&self) -> bool {
        self.largest_model().transmits()
    }

    /// Whether it bounds a body that absorbs.
    pub fn absorbs(&self) -> bool {
        let model = self.largest_model();
        model.transmits() && model.absorption().iter().any(|&sigma| sigma > 0.0)
    }

    /// Whether it bounds a body, which a thin pane doesn't.
    pub(crate) fn is_boundary(&self) -> bool {
        bounds_a_body(&self.largest_model())
    }

    /// Whether all light that passes goes on in a single direction, so that no light without extent can be found through it.
    pub(crate) fn transmits_smoothly(&self) -> bool {
        let model = self.largest_model();
        model.transmits() && model.is_delta()
    }

    /// The names of the parameters that textures or vertex colours drive.
    pub fn driven_parameters(&self) -> impl Iterator<Item = &'static str> + '_ {
        self.bindings.iter().map(|b| b.parameter)
    }

    fn binding(&mut self, parameter: &str) -> Result<&mut Binding, SceneError> {
        if let Some(at) = self.bindings.iter().position(|b| b.parameter == parameter) {
            return Ok(&mut self.bindings[at]);
        }
        let slot = ParameterSlot::of(&self.spec, parameter)?;
        let declared = slot.parameter();
        let base = match self.spec.values.get(parameter) {
            Some(Value::Number(x)) => [*x as f32; 3],
            Some(Value::Colour(c)) => c.map(|x| x as f32),
            _ => [1.0; 3],
        };
        // A direction is no share of light, nor is a colour that may exceed 1, such as an absorption coefficient; one that is black
        // unless it is given is an addition to another.
        let is_share =
            matches!(declared.kind, Kind::Colour { low, high, .. } if low >= 0.0 && high <= 1.0);
        let is_addition = declared.default_value() == Some(Value::Colour([0.0; 3]));
        if is_share && !is_addition && self.albedo_binding.is_none() {
            self.albedo_binding = Some(self.bindings.len());
        }
        self.bindings.push(Binding {
            parameter: declared.name,
            slot,
            base,
            texture: None,
            vertex_colour: false,
        });
        Ok(self
            .bindings
            .last_mut()
            .expect("invariant: one was just pushed"))
    }

    /// The radiance \[W m⁻² sr⁻¹] that the surface emits towards `wo` (world, unit), before opacity: zero behind a
    /// single-sided surface, whose front is where the geometric normal points.
    pub fn emitted(&self, point: &SurfacePoint, wo: Vec3<f32>) -> [f32; 3] {
        if !self.emission.is_lit() || !(self.double_sided || point.ng.dot(wo) > 0.0) {
            return [0.0; 3];
        }
        self.emission.at(point)
    }
}

impl Emission {
    /// Whether anything is emitted anywhere.
    pub fn is_lit(&self) -> bool {
        self.radiance.iter().any(|&r| r > 0.0)
    }

    /// Whether it is the same all over the surface.
    pub fn is_even(&self) -> bool {
        self.texture.is_none() && !self.vertex_colour
    }

    /// The radiance \[W m⁻² sr⁻¹] at a point of a surface.
    pub fn at(&self, point: &SurfacePoint) -> [f32; 3] {
        let mut radiance = self.radiance;
        if let Some(texture) = &self.texture {
            let t = texture.lookup(point.uv, point.uv1);
            radiance = std::array::from_fn(|k| radiance[k] * t[k].max(0.0));
        }
        if self.vertex_colour {
            radiance = std::array::from_fn(|k| radiance[k] * point.colour[k].max(0.0));
        }
        radiance
    }

    /// The radiance's mean over the texture.
    pub fn mean(&self) -> [f32; 3] {
        match &self.texture {
            None => self.radiance,
            Some(texture) => {
                let t = texture.mean();
                std::array::from_fn(|k| self.radiance[k] * t[k].max(0.0) as f32)
            }
        }
    }
}

impl Default for Opacity {
    fn default() -> Self {
        Self {
            mode: AlphaMode::Opaque,
            factor: 1.0,
            texture: None,
            vertex_alpha: false,
        }
    }
}

impl Opacity {
    /// Whether some of it lets light through.
    pub fn is_opaque(&self) -> bool {
        self.mode == AlphaMode::Opaque
    }

    /// The share of light that is stopped, in \[0, 1], at a point of a surface.
    pub fn at(&self, point: &SurfacePoint) -> f32 {
        if self.is_opaque() {
            return 1.0;
        }
        let mut alpha = self.factor;
        if let Some(input) = &self.texture {
            alpha *= input.value(point.uv, point.uv1)[0];
        }
        if self.vertex_alpha {
            alpha *= point.colour[3];
        }
        match self.mode {
            AlphaMode::Mask(cutoff) => f32::from(u8::from(alpha >= cutoff)),
            AlphaMode::Blend | AlphaMode::Opaque => alpha.clamp(0.0, 1.0),
        }
    }
}

/// Whether the surface of a model parts two media: it transmits, and refracts or absorbs.
pub(crate) fn bounds_a_body(model: &Model<f32, 3>) -> bool {
    model.transmits() && (model.relative_ior() != [1.0; 3] || model.absorption() != [0.0; 3])
}

/// The share of light that is scattered when seen along the normal, the light that passes included: the mean weight of 64 samples,
/// within \[0, 1]. What passes is counted without the scaling of radiance by n², so that clear glass is white.
fn normal_albedo(model: &Model<f32, 3>) -> [f32; 3] {
    const SAMPLES: u32 = 64;
    let wo = Vec3::new(0.0, 0.0, 1.0);
    let ior = model.relative_ior();
    let mut sum = [0.0_f64; 3];
    for i in 0..SAMPLES {
        let sample = model.sample(wo, SampleStream::new(SamplerKind::Sobol, 0, 0, i).next_3d());
        if sample.pdf > 0.0 {
            for (k, w) in sample.weight.into_iter().enumerate() {
                let squeezed = if sample.wi.z < 0.0 { ior[k] } else { 1.0 };
                sum[k] += f64::from(w * squeezed * squeezed);
            }
        }
    }
    sum.map(|s| ((s / f64::from(SAMPLES)) as f32).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests;
