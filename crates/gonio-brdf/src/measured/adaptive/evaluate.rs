//! [`AdaptiveTable`], an adaptive table ready to be evaluated and drawn from.

use super::super::channel::{ToRgb, rgb};
use super::super::metadata::Gamut;
use super::Adaptive;
use super::geometry::{Geometry, twice_if_one};
use super::plane::Colours;
use crate::{Function, Index, Number};
use gonio_num::{Real, Vec3};
use gonio_radiometry::direction::spherical_direction;
use std::borrow::Cow;
use std::sync::Arc;

/// An adaptive table of RGB, ready.
///
/// Its code is compiled for single and for double precision, and over lanes in [`batch`](super::batch) alone: any other number calls it lane by lane.
#[derive(Debug, Clone)]
pub(crate) struct AdaptiveTable {
    pub(super) geometry: Arc<Geometry>,
    pub(super) colours: Colours,
    /// Mean weight of a sample for each slice.
    albedo: Vec<f32>,
}

impl AdaptiveTable {
    /// Of values that are finite. Those that are negative stay.
    pub(in super::super) fn new(adaptive: &Adaptive, to_rgb: &ToRgb, gamut: &mut Gamut) -> Self {
        let geometry = Arc::clone(&adaptive.geometry);
        let [width, height] = adaptive.shape();
        let rgb = projected(adaptive, to_rgb, gamut);
        let rgb = twice_if_one(&rgb, &adaptive.tables);
        let colours = Colours::new(&rgb, &geometry.luminance, width, height, &geometry.slices);
        let mut this = Self {
            colours,
            albedo: vec![0.0; geometry.slices.count()],
            geometry,
        };
        this.albedo = this.albedo_of_slices();
        this
    }

    fn eval_in<R: Number, const C: usize>(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; 3] {
        let place = self.geometry.place(wi, wo);
        let blend = self.geometry.slices.blend::<R, C>(place.at);
        let (p, _) = self.geometry.vndf.invert(place.half, &blend);
        let [r, g, b, _] = self.colours.at(p, &blend);
        let scale = self.geometry.scale(wi.z, wo.z, place.viewer, place.half);
        Geometry::shade(scale, [r, g, b])
    }

    fn pdf_in<R: Number, const C: usize>(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        let place = self.geometry.place(wi, wo);
        let blend = self.geometry.slices.blend::<R, C>(place.at);
        let (p, visible) = self.geometry.vndf.invert(place.half, &blend);
        let luminance = self.colours.density(p, &blend);
        Geometry::density(wi.z, wo.z, visible, luminance, place.jacobian)
    }

    fn eval_and_pdf_in<R: Number, const C: usize>(&self, wi: Vec3<R>, wo: Vec3<R>) -> ([R; 3], R) {
        let place = self.geometry.place(wi, wo);
        let blend = self.geometry.slices.blend::<R, C>(place.at);
        let (p, visible) = self.geometry.vndf.invert(place.half, &blend);
        let [r, g, b, luminance] = self.colours.at(p, &blend);
        let scale = self.geometry.scale(wi.z, wo.z, place.viewer, place.half);
        (
            Geometry::shade(scale, [r, g, b]),
            Geometry::density(wi.z, wo.z, visible, luminance, place.jacobian),
        )
    }

    fn albedo_in<R: Number, const C: usize>(&self, wo: Vec3<R>) -> R {
        let blend = self
            .geometry
            .slices
            .blend::<R, C>(self.geometry.slices_of(wo));
        let [albedo] = blend.of_slices(&self.albedo, 0, R::Index::splat(0), [0]);
        albedo
    }

    /// The mean weight of 64 draws from each slice's viewer: an estimate of the albedo, in which nothing but efficiency rests.
    fn albedo_of_slices(&self) -> Vec<f32> {
        let mut all = Vec::new();
        for phi in &self.geometry.slices.phi {
            for theta in &self.geometry.slices.theta {
                // At the horizon itself nothing is drawn.
                let (theta, phi) = (f64::from(*theta).min(1.57), f64::from(*phi));
                let wo = spherical_direction(theta, phi);
                let mut sum = 0.0;
                for k in 0..64 {
                    let at = |k: i32| (f64::from(k) + 0.5) / 8.0;
                    let wi = self.sample(wo, [at(k / 8), at(k % 8), 0.5]);
                    let (f, pdf) = self.eval_and_pdf(wi, wo);
                    if pdf > 0.0 {
                        sum += f.iter().sum::<f64>() / 3.0 * wi.z / pdf;
                    }
                }
                all.push((sum / 64.0).clamp(0.0, 1.0) as f32);
            }
        }
        all
    }

    /// Linear RGB in sr⁻¹.
    #[inline(never)]
    pub fn eval<R: Number>(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; 3] {
        R::call(&Eval(self), six(wi, wo))
    }

    /// Density per solid angle of drawing `wi`.
    #[inline(never)]
    pub fn pdf<R: Number>(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        let [pdf] = R::call(&Pdf(self), six(wi, wo));
        pdf
    }

    /// Both, the same to the bit.
    #[inline(never)]
    pub fn eval_and_pdf<R: Number>(&self, wi: Vec3<R>, wo: Vec3<R>) -> ([R; 3], R) {
        let [r, g, b, pdf] = R::call(&EvalAndPdf(self), six(wi, wo));
        ([r, g, b], pdf)
    }

    /// Draws a direction; below the horizon where that gives nothing.
    #[inline(never)]
    pub fn sample<R: Number>(&self, wo: Vec3<R>, u: [R; 3]) -> Vec3<R> {
        let [x, y, z] = R::call(&Draw(self), six(wo, Vec3::new(u[0], u[1], u[2])));
        Vec3::new(x, y, z)
    }

    /// The albedo, roughly.
    #[inline(never)]
    pub fn albedo<R: Number>(&self, wo: Vec3<R>) -> R {
        let [albedo] = R::call(&Albedo(self), six(wo, wo));
        albedo
    }
}

/// Linear RGB of every node, slice by slice, colour by colour, row by row.
fn projected<'a>(adaptive: &'a Adaptive, to_rgb: &ToRgb, gamut: &mut Gamut) -> Cow<'a, [f32]> {
    if *to_rgb == ToRgb::new(&rgb()) {
        return Cow::Borrowed(&adaptive.values);
    }
    let size = adaptive.tables.luminance.size();
    let mut all = vec![0.0; adaptive.tables.slices() * 3 * size];
    let mut sums = vec![[0.0f64; 3]; size];
    let slices = adaptive.values.chunks_exact(adaptive.channels * size);
    for (slice, out) in slices.zip(all.chunks_exact_mut(3 * size)) {
        sums.fill([0.0; 3]);
        for (weight, values) in to_rgb.weights.iter().zip(slice.chunks_exact(size)) {
            for (sum, value) in sums.iter_mut().zip(values) {
                for c in 0..3 {
                    sum[c] += weight[c] * f64::from(*value);
                }
            }
        }
        for (i, sum) in sums.iter().enumerate() {
            // Counted only: between nodes of any sign it is the mean that must not be negative.
            gamut.clip(*sum);
            for c in 0..3 {
                out[c * size + i] = sum[c] as f32;
            }
        }
    }
    Cow::Owned(all)
}

/// Six numbers of two vectors.
fn six<R: Real>(a: Vec3<R>, b: Vec3<R>) -> [R; 6] {
    [a.x, a.y, a.z, b.x, b.y, b.z]
}

/// A function of two vectors that is compiled for single and for double precision.
macro_rules! function {
    ($(#[$doc:meta])* $name:ident, $m:literal, |$all:ident, $a:ident, $b:ident| $body:expr) => {
        $(#[$doc])*
        struct $name<'a>(&'a AdaptiveTable);

        impl Function<6, $m> for $name<'_> {
            fn single(&self, [x, y, z, s, t, u]: [f32; 6]) -> [f32; $m] {
                let ($all, $a, $b) = (self.0, Vec3::new(x, y, z), Vec3::new(s, t, u));
                $body
            }
            fn double(&self, [x, y, z, s, t, u]: [f64; 6]) -> [f64; $m] {
                let ($all, $a, $b) = (self.0, Vec3::new(x, y, z), Vec3::new(s, t, u));
                $body
            }
        }
    };
}
function!(
    /// f of (wi, wo).
    Eval, 3, |all, wi, wo| match all.geometry.slices.phi.len() {
        1 => all.eval_in::<_, 1>(wi, wo),
        _ => all.eval_in::<_, 2>(wi, wo),
    }
);
function!(
    /// The density of (wi, wo).
    Pdf, 1, |all, wi, wo| match all.geometry.slices.phi.len() {
        1 => [all.pdf_in::<_, 1>(wi, wo)],
        _ => [all.pdf_in::<_, 2>(wi, wo)],
    }
);
function!(
    /// Both.
    EvalAndPdf, 4, |all, wi, wo| {
        let ([r, g, b], pdf) = match all.geometry.slices.phi.len() {
            1 => all.eval_and_pdf_in::<_, 1>(wi, wo),
            _ => all.eval_and_pdf_in::<_, 2>(wi, wo),
        };
        [r, g, b, pdf]
    }
);
function!(
    /// The direction that (wo, u) draws; below the horizon if it is none.
    Draw, 3, |all, wo, u| all.geometry.draw(wo, [u.x, u.y]).to_array()
);
function!(
    /// The albedo of (wo, anything), roughly.
    Albedo, 1, |all, wo, _other| match all.geometry.slices.phi.len() {
        1 => [all.albedo_in::<_, 1>(wo)],
        _ => [all.albedo_in::<_, 2>(wo)],
    }
);
