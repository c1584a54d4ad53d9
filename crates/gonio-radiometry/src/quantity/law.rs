//! The laws of radiometry that are more than a product of two quantities (T2, T5–T8).

use super::{
    Area, Irradiance, Length, Quantity, Radiance, RadiantExitance, RadiantFlux, RadiantIntensity,
    ReflectanceDistribution, SolidAngle, kind,
};
use crate::quadrature::ProductRule;
use gonio_num::{Real, Vec3};

/// Solid angle of a part of a sphere, Ω = A / r² (T2).
///
/// - `area`: on the sphere of radius `radius`, in [0, 4πr²]
///
/// Infinite or NaN at `radius` = 0.
///
/// ```
/// use gonio_radiometry::quantity::{Area, Length, law};
/// assert_eq!(law::solid_angle(Area::new(8.0), Length::new(2.0)).to_string(), "2 sr");
/// ```
pub fn solid_angle<R: Real>(area: Area<R>, radius: Length<R>) -> SolidAngle<R> {
    SolidAngle::new(area / (radius * radius))
}

/// Flux of a thin beam, dΦ = L cosθ dω dA (T5).
///
/// - `cos_theta`: between the beam and the normal of `area`; below 0 counts as 0
///
/// ```
/// use gonio_radiometry::quantity::{Area, Radiance, SolidAngle, law};
/// let flux = law::beam_flux(Radiance::new(5.0), 0.5, SolidAngle::new(0.01), Area::new(2.0));
/// assert!((flux.value() - 0.05_f64).abs() < 1e-15); // W
/// ```
pub fn beam_flux<R: Real>(
    radiance: Radiance<R>,
    cos_theta: R,
    solid_angle: SolidAngle<R>,
    area: Area<R>,
) -> RadiantFlux<R> {
    radiance * solid_angle.projected(cos_theta) * area
}

/// Irradiance under the same radiance from the whole hemisphere, E = πL (T6).
///
/// ```
/// use gonio_radiometry::quantity::{Radiance, law};
/// assert_eq!(law::irradiance_of_uniform(Radiance::new(1.0)).value(), std::f64::consts::PI);
/// ```
pub fn irradiance_of_uniform<R: Real>(radiance: Radiance<R>) -> Irradiance<R> {
    radiance * Quantity::<R, kind::ProjectedSolidAngle>::hemisphere()
}

/// Irradiance under any radiance, E = ∫ L(ω) cosθ dω over the hemisphere around +z (7), by the quadrature `rule`.
///
/// The rule says for which L it is exact.
///
/// ```
/// use gonio_radiometry::{quadrature::ProductRule, quantity::{Radiance, law}};
/// // L = cosθ: E = 2π ∫ cos²θ d(cosθ) = 2π/3.
/// let e = law::irradiance(&ProductRule::new(8, 8), |w| Radiance::new(w.z));
/// assert!((e.value() - std::f64::consts::TAU / 3.0).abs() < 1e-14);
/// ```
pub fn irradiance(
    rule: &ProductRule,
    mut radiance: impl FnMut(Vec3<f64>) -> Radiance,
) -> Irradiance {
    let [e] = rule.hemisphere(|w| [radiance(w).value() * w.z]);
    Irradiance::new(e)
}

/// Irradiance from a point source, E = I cosθ / r²: the inverse-square law.
///
/// - `cos_theta`: between the direction to the source and the surface's normal; below 0 counts as 0
/// - `distance`: positive; the result is infinite or NaN at 0
///
/// ```
/// use gonio_radiometry::quantity::{Length, RadiantIntensity, law};
/// let e = law::irradiance_of_point(RadiantIntensity::new(8.0), 0.5, Length::new(2.0));
/// assert_eq!(e.to_string(), "1 W/m²");
/// ```
pub fn irradiance_of_point<R: Real>(
    intensity: RadiantIntensity<R>,
    cos_theta: R,
    distance: Length<R>,
) -> Irradiance<R> {
    let r2 = (distance * distance).value();
    Irradiance::new(intensity.value() * cos_theta.max(R::zero()) / r2)
}

/// Intensity of an isotropic source, I = Φ / 4π.
///
/// ```
/// use gonio_radiometry::quantity::{RadiantFlux, law};
/// assert!((law::isotropic_intensity(RadiantFlux::new(100.0_f64)).value() - 7.957747154594767).abs() < 1e-14);
/// ```
pub fn isotropic_intensity<R: Real>(flux: RadiantFlux<R>) -> RadiantIntensity<R> {
    flux / SolidAngle::sphere()
}

/// Radiance of a Lambertian surface of radiant exitance M, L = M / π in every direction (T7).
///
/// ```
/// use gonio_radiometry::quantity::{RadiantExitance, law};
/// assert_eq!(law::lambertian_radiance(RadiantExitance::new(std::f64::consts::PI)).value(), 1.0);
/// ```
pub fn lambertian_radiance<R: Real>(exitance: RadiantExitance<R>) -> Radiance<R> {
    exitance.relabel::<kind::Irradiance>() / Quantity::<R, kind::ProjectedSolidAngle>::hemisphere()
}

/// BRDF of a Lambertian surface, f = ρ / π (15).
///
/// - `albedo`: ρ, the reflected fraction of the irradiance, in [0, 1]
///
/// ```
/// use gonio_radiometry::quantity::{Irradiance, law};
/// let radiance = Irradiance::new(10.0) * law::lambertian_brdf(0.5);
/// assert!((radiance.value() - 5.0 / std::f64::consts::PI).abs() < 1e-15);
/// ```
pub fn lambertian_brdf<R: Real>(albedo: R) -> ReflectanceDistribution<R> {
    ReflectanceDistribution::new(albedo / R::pi())
}
