//! [`Shading`]: a material at a point of a surface, ready to reflect.

use super::{Binding, Material, NormalMap};
use crate::SurfacePoint;
use gonio_brdf::{Brdf, Model};
use gonio_num::{Frame, Real, Vec3};
use std::borrow::Cow;

/// Smallest cosine between the direction to the viewer and the shading normal on the viewer's side.
const MIN_COS: f32 = 1e-3;

/// What a surface is at one point, as one viewer sees it.
#[derive(Debug, Clone)]
pub struct Shading<'a> {
    /// Local coordinates of the reflection function: +x along the tangent; normal +z on the viewer's side for a function that
    /// only reflects, on the outer side of the surface for one that transmits.
    pub frame: Frame<f32>,
    /// The reflection function, its textured parameters set.
    pub model: Cow<'a, Model<f32, 3>>,
    /// Whether the reflection function transmits here: [`Brdf::transmits`].
    pub transmits: bool,
    /// Share of light that the surface stops, in \[0, 1]: 1 is opaque.
    pub alpha: f32,
    /// About the share of light reflected, for an image of the colours alone.
    pub albedo: [f32; 3],
}

impl Material {
    /// The material at `point`, seen from the unit direction `wo` (world, leaving the surface).
    ///
    /// The frame's normal is the shading normal, bent by the normal map, on the side of the geometric normal that faces `wo`.
    /// Interpolated or mapped normals may still face away from `wo`, where a reflection function has no value and the point
    /// would be black. So a normal n with n·wo < c = 0.001 becomes n + (c − n·wo) wo, normalised: its part across wo stays, its
    /// part along wo is raised to c. The result is continuous, always in wo's hemisphere and never NaN.
    ///
    /// A function that transmits is one of both sides, the outer and the inner one. There the normal, found in the same way, is turned
    /// back to the outer side, that of the geometric normal: the local direction to the viewer has z < 0 where the surface is
    /// seen from its inner side. A part of a sum that only reflects is then black on the inner side, where alone it would
    /// reflect as on the outer one.
    ///
    /// Nothing is allocated unless the model itself holds allocated parts (a sum) *and* is textured.
    pub fn shade(&self, point: &SurfacePoint, wo: Vec3<f32>) -> Shading<'_> {
        let alpha = self.opacity.at(point);
        let mut albedo = self.albedo;
        let mut transmits = self.model_transmits;
        let mut model = if self.bindings.is_empty() {
            Cow::Borrowed(&self.model)
        } else {
            let mut model = self.model.clone();
            for (index, binding) in self.bindings.iter().enumerate() {
                let value = binding.value(point);
                model.set_parameter(binding.slot, value);
                if self.albedo_binding == Some(index) {
                    albedo = value;
                }
            }
            transmits = model.transmits();
            Cow::Owned(model)
        };
        let behind = point.ng.dot(wo) < 0.0;
        let bent = bent_normal(point, self.normal_map.as_ref());
        let mut frame = facing_frame(bent, point.ng, point.tangent, wo, transmits);
        if self.along_bitangent && frame.t.dot(point.bitangent()) < 0.0 {
            frame.t = -frame.t;
        }
        if let Some(second) = &self.second_normal {
            let bent = bent_normal(point, second.map.as_ref());
            let bent = if behind && !transmits { -bent } else { bent };
            let local = frame.to_local(bent).to_array();
            model.to_mut().set_parameter(second.slot, local);
        }
        Shading {
            frame,
            model,
            transmits,
            alpha,
            albedo,
        }
    }
}

/// The shading normal with a normal map applied, if there is one, on the front side.
fn bent_normal(point: &SurfacePoint, map: Option<&NormalMap>) -> Vec3<f32> {
    let Some(map) = map else {
        return point.ns;
    };
    let [r, g, b, _] = map.texture.lookup(point.uv, point.uv1);
    let (x, y, z) = (
        (2.0 * r - 1.0) * map.scale,
        (2.0 * g - 1.0) * map.scale,
        2.0 * b - 1.0,
    );
    let frame = Frame::from_normal_tangent(point.ns, point.tangent);
    let bent = frame.s * x + frame.t * (y * point.bitangent_sign) + frame.n * z;
    let length = bent.length();
    if length > 1e-6 && length.is_finite() {
        bent / length
    } else {
        point.ns
    }
}

impl Binding {
    /// The parameter's value at a point; the model limits it to the parameter's range.
    fn value(&self, point: &SurfacePoint) -> [f32; 3] {
        let mut value = self.base;
        if let Some(input) = &self.texture {
            let t = input.value(point.uv, point.uv1);
            value = std::array::from_fn(|k| value[k] * t[k]);
        }
        if self.vertex_colour {
            value = std::array::from_fn(|k| value[k] * point.colour[k]);
        }
        value
    }
}

/// The front-side normal `n` of a surface with geometric normal `ng`, on the side of `wo` and in its hemisphere.
#[inline(always)]
fn facing<R: Real>(n: Vec3<R>, ng: Vec3<R>, wo: Vec3<R>) -> Vec3<R> {
    let n = Vec3::select(ng.dot(wo).lt(R::zero()), -n, n);
    let cos = n.dot(wo);
    let least = R::lit(f64::from(MIN_COS));
    Vec3::select(least.le(cos), n, (n + wo * (least - cos)).normalize())
}

/// The frame that [`Material::shade`] gives a surface with these normals, shading and geometric, and this tangent, seen from `wo`.
#[inline(always)]
pub fn facing_frame<R: Real>(
    ns: Vec3<R>,
    ng: Vec3<R>,
    tangent: Vec3<R>,
    wo: Vec3<R>,
    transmits: bool,
) -> Frame<R> {
    let mut normal = facing(ns, ng, wo);
    if transmits {
        normal = Vec3::select(ng.dot(wo).lt(R::zero()), -normal, normal);
    }
    Frame::from_normal_tangent(normal, tangent)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn unit(v: [f32; 3]) -> Option<Vec3<f32>> {
        let v = Vec3::from(v);
        (v.length() > 1e-3).then(|| v.normalize())
    }

    proptest! {
        #[test]
        fn the_normal_always_faces_the_viewer(
            n in prop::array::uniform3(-1.0_f32..1.0),
            ng in prop::array::uniform3(-1.0_f32..1.0),
            wo in prop::array::uniform3(-1.0_f32..1.0),
        ) {
            let (Some(n), Some(ng), Some(wo)) = (unit(n), unit(ng), unit(wo)) else { return Ok(()) };
            let f = facing(n, ng, wo);
            prop_assert!((f.length() - 1.0).abs() < 1e-5);
            // After normalising, the part along wo is c/√(1 + c²) to c.
            prop_assert!(f.dot(wo) > 0.9 * MIN_COS, "{}", f.dot(wo));
            let side = if ng.dot(wo) < 0.0 { -n } else { n };
            if side.dot(wo) >= MIN_COS {
                prop_assert_eq!(f, side);
            }
        }
    }

    /// Exactly away from the viewer is the worst case: the normal becomes the viewer's direction.
    #[test]
    fn a_normal_straight_away_is_turned_round() {
        let wo = Vec3::new(0.0, 0.0, 1.0);
        assert_eq!(facing(-wo, wo, wo), wo);
    }
}
