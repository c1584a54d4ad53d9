//! Evaluating and sampling [`Adaptive`].

use super::slices::At;
use super::{Adaptive, Spectra};
use crate::{Brdf, Function, Index, Number, Sample};
use gonio_num::{Real, Vec3};
use std::f64::consts::{FRAC_2_PI, FRAC_PI_2, PI, TAU};

/// cosθi by which f·cosθi is divided, at least: a ten-thousandth of a degree above the horizon. Measured values do not become 0
/// there, and f would be larger than any number.
const LEAST_COSINE: f64 = 1e-6;

/// What a pair of directions looks up.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place<R: Number> {
    /// Where the viewer's direction lies among the slices.
    pub at: At<R>,
    /// The viewer's direction on the unit square.
    pub viewer: [R; 2],
    /// The half vector on the unit square.
    pub half: [R; 2],
    /// dωi / dA, the solid angle of the light's directions for an area of the half vectors' square.
    pub jacobian: R,
}

/// √(2θ/π), the first coordinate of a direction on the unit square.
#[inline(always)]
fn unit_of_theta<R: Number>(theta: R) -> R {
    (theta * R::lit(FRAC_2_PI)).sqrt()
}

/// φ/2π + ½, the second.
#[inline(always)]
fn unit_of_phi<R: Number>(phi: R) -> R {
    phi * R::lit(1.0 / TAU) + R::lit(0.5)
}

/// The angle to the normal, accurate near it unlike the arc cosine; and the length of the vector's projection on the surface.
#[inline(always)]
fn theta<R: Number>(w: Vec3<R>) -> (R, R) {
    let across = (w.x * w.x + w.y * w.y).max(R::lit(1e-37)).sqrt();
    (across.atan2(w.z), across)
}

impl Adaptive {
    /// `wo` moved by the material's symmetry to azimuths that were measured, and the factors for x and y that do it.
    #[inline(always)]
    fn fold<R: Number>(&self, wo: Vec3<R>) -> (Vec3<R>, R, R) {
        let one = R::one();
        if self.symmetry < 2 {
            return (wo, one, one);
        }
        // The measured ones lie below the x axis; of four quarters, left of the y axis too.
        let y = R::select(wo.y.lt(R::zero()), one, -one);
        if self.symmetry == 2 {
            return (Vec3::new(wo.x * y, -wo.y.abs(), wo.z), y, y);
        }
        let x = R::select(wo.x.lt(R::zero()), one, -one);
        (Vec3::new(-wo.x.abs(), -wo.y.abs(), wo.z), x, y)
    }

    /// The direction from which azimuths of half vectors are counted, as cosine and sine: the viewer's, if the material is isotropic.
    #[inline(always)]
    fn origin<R: Number>(&self, wo: Vec3<R>, across: R) -> (R, R) {
        if self.symmetry > 0 {
            return (R::one(), R::zero());
        }
        let pole = across.lt(R::lit(1e-15));
        let over = R::select(pole, R::one(), across).recip();
        (
            R::select(pole, R::one(), wo.x * over),
            R::select(pole, R::zero(), wo.y * over),
        )
    }

    /// What a pair of directions looks up.
    #[inline(always)]
    pub(super) fn place<R: Number>(&self, wi: Vec3<R>, wo: Vec3<R>) -> Place<R> {
        let (wo, x, y) = self.fold(wo);
        let wi = Vec3::new(wi.x * x, wi.y * y, wi.z);
        let (theta_o, across_o) = theta(wo);
        let (cos, sin) = self.origin(wo, across_o);
        let phi_o = self.phi(wo);
        let sum = wi + wo;
        let (theta_h, across_h) = theta(sum);
        let phi = (cos * sum.y - sin * sum.x).atan2(cos * sum.x + sin * sum.y);
        let u = unit_of_theta(theta_h);
        // dωi = 4 (ωo·ωh) dωh with ωo·ωh = |ωi + ωo| / 2, and dωh = sinθ dθ dφ = sinθ πu · 2π dA with sinθ = across / |ωi + ωo|.
        let jacobian = R::lit(4.0 * PI * PI) * u * across_h;
        Place {
            at: self.slices.around(theta_o, phi_o),
            viewer: [unit_of_theta(theta_o), unit_of_phi(phi_o)],
            half: [u, unit_of_phi(phi)],
            jacobian: jacobian.max(R::lit(1e-30)),
        }
    }

    /// The viewer's azimuth; 0 where no table depends on it.
    #[inline(always)]
    fn phi<R: Number>(&self, wo: Vec3<R>) -> R {
        if self.slices.phi.len() == 1 {
            R::zero()
        } else {
            wo.y.atan2(wo.x)
        }
    }

    /// What colours are multiplied by to be f: D/4σ, if they are not f·cosθi already, over cosθi.
    #[inline(always)]
    pub(super) fn scale<R: Number>(&self, cos_i: R, cos_o: R, viewer: [R; 2], half: [R; 2]) -> R {
        let mut scale = cos_i.max(R::lit(LEAST_COSINE)).recip();
        if self.jacobian {
            let sigma: R = self.sigma.at(viewer);
            scale = scale * self.ndf.at(half) / (R::lit(4.0) * sigma).max(R::lit(1e-30));
        }
        let above = cos_i.gt(R::zero()) & cos_o.gt(R::zero());
        R::select(above, scale, R::zero())
    }

    /// f from the colours of the table, of which negative ones count as 0.
    #[inline(always)]
    pub(super) fn shade<R: Number>(scale: R, [r, g, b]: [R; 3]) -> [R; 3] {
        let zero = R::zero();
        [
            r.max(zero) * scale,
            g.max(zero) * scale,
            b.max(zero) * scale,
        ]
    }

    /// The density per solid angle from those of visible normals and of luminance.
    #[inline(always)]
    pub(super) fn density<R: Number>(
        cos_i: R,
        cos_o: R,
        visible: R,
        luminance: R,
        jacobian: R,
    ) -> R {
        let above = cos_i.gt(R::zero()) & cos_o.gt(R::zero());
        R::select(above, visible * luminance / jacobian, R::zero())
    }

    fn eval_in<R: Number, const C: usize>(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; 3] {
        let place = self.place(wi, wo);
        let blend = self.slices.blend::<R, C>(place.at);
        let (p, _) = self.vndf.invert(place.half, &blend);
        let [r, g, b, _] = self.colours.at(p, &blend);
        let scale = self.scale(wi.z, wo.z, place.viewer, place.half);
        Self::shade(scale, [r, g, b])
    }

    fn pdf_in<R: Number, const C: usize>(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        let place = self.place(wi, wo);
        let blend = self.slices.blend::<R, C>(place.at);
        let (p, visible) = self.vndf.invert(place.half, &blend);
        let luminance = self.colours.density(p, &blend);
        Self::density(wi.z, wo.z, visible, luminance, place.jacobian)
    }

    fn eval_and_pdf_in<R: Number, const C: usize>(&self, wi: Vec3<R>, wo: Vec3<R>) -> ([R; 3], R) {
        let place = self.place(wi, wo);
        let blend = self.slices.blend::<R, C>(place.at);
        let (p, visible) = self.vndf.invert(place.half, &blend);
        let [r, g, b, luminance] = self.colours.at(p, &blend);
        let scale = self.scale(wi.z, wo.z, place.viewer, place.half);
        (
            Self::shade(scale, [r, g, b]),
            Self::density(wi.z, wo.z, visible, luminance, place.jacobian),
        )
    }

    /// The slices around the viewer, of which a direction is drawn.
    #[inline(always)]
    pub(super) fn slices_of<R: Number>(&self, wo: Vec3<R>) -> At<R> {
        let (wo, _, _) = self.fold(wo);
        self.slices.around(theta(wo).0, self.phi(wo))
    }

    /// The viewer's direction mirrored about the half vector at a point of the unit square; below the horizon if that is no
    /// direction.
    #[inline(always)]
    pub(super) fn reflect<R: Number>(&self, wo: Vec3<R>, [a, b]: [R; 2]) -> Vec3<R> {
        let (wo, x, y) = self.fold(wo);
        let (cos_o, sin_o) = self.origin(wo, theta(wo).1);
        let (sin, cos) = (a * a * R::lit(FRAC_PI_2)).sin_cos();
        let (sin_phi, cos_phi) = ((b - R::lit(0.5)) * R::lit(TAU)).sin_cos();
        let half = Vec3::new(
            sin * (cos_o * cos_phi - sin_o * sin_phi),
            sin * (sin_o * cos_phi + cos_o * sin_phi),
            cos,
        );
        let wi = wo.reflect(half);
        // Half vectors that turn away from the viewer come where tables are mixed.
        let z = R::select(wo.dot(half).gt(R::zero()), wi.z, -R::one());
        Vec3::new(wi.x * x, wi.y * y, z)
    }

    /// The direction that two uniform numbers draw; below the horizon where they draw nothing.
    pub(crate) fn draw<R: Number>(&self, wo: Vec3<R>, u: [R; 2]) -> Vec3<R> {
        match self.slices.phi.len() {
            1 => self.draw_in::<R, 1>(wo, u),
            _ => self.draw_in::<R, 2>(wo, u),
        }
    }

    fn draw_in<R: Number, const C: usize>(&self, wo: Vec3<R>, u: [R; 2]) -> Vec3<R> {
        let blend = self.slices.blend::<R, C>(self.slices_of(wo));
        // The first number draws the row, as in the format's other programs.
        let p = self.luminance.draw([u[1], u[0]], &blend);
        let half = self.vndf.draw(p, &blend);
        self.reflect(wo, half)
    }

    fn albedo_in<R: Number, const C: usize>(&self, wo: Vec3<R>) -> R {
        let blend = self.slices.blend::<R, C>(self.slices_of(wo));
        let [albedo] = blend.of_slices(&self.albedo, 0, R::Index::splat(0), [0]);
        albedo
    }

    /// The mean weight of 64 draws from each slice's viewer: an estimate of the albedo, in which nothing but efficiency rests.
    pub(super) fn albedo_of_slices(&self) -> Vec<f32> {
        let mut all = Vec::new();
        for phi in &self.slices.phi {
            for theta in &self.slices.theta {
                // At the horizon itself nothing is drawn.
                let (theta, phi) = (f64::from(*theta).min(1.57), f64::from(*phi));
                let (sin, cos) = Real::sin_cos(theta);
                let (sin_phi, cos_phi) = Real::sin_cos(phi);
                let wo = Vec3::new(sin * cos_phi, sin * sin_phi, cos);
                let mut sum = 0.0;
                for k in 0..64 {
                    let at = |k: i32| (f64::from(k) + 0.5) / 8.0;
                    let weight = self.sample(wo, [at(k / 8), at(k % 8), 0.5]).weight;
                    sum += weight.iter().sum::<f64>() / 3.0;
                }
                all.push((sum / 64.0).clamp(0.0, 1.0) as f32);
            }
        }
        all
    }
}

impl<R: Number> Brdf<R, 3> for Adaptive {
    fn eval(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; 3] {
        match self.slices.phi.len() {
            1 => self.eval_in::<R, 1>(wi, wo),
            _ => self.eval_in::<R, 2>(wi, wo),
        }
    }

    fn pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        match self.slices.phi.len() {
            1 => self.pdf_in::<R, 1>(wi, wo),
            _ => self.pdf_in::<R, 2>(wi, wo),
        }
    }

    fn eval_and_pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> ([R; 3], R) {
        match self.slices.phi.len() {
            1 => self.eval_and_pdf_in::<R, 1>(wi, wo),
            _ => self.eval_and_pdf_in::<R, 2>(wi, wo),
        }
    }

    fn sample(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R, 3> {
        self.sample_of(self.draw(wo, [u[0], u[1]]), wo)
    }

    fn albedo_estimate(&self, wo: Vec3<R>) -> R {
        match self.slices.phi.len() {
            1 => self.albedo_in::<R, 1>(wo),
            _ => self.albedo_in::<R, 2>(wo),
        }
    }
}

/// A function of two vectors that is compiled for single and for double precision.
macro_rules! function {
    ($(#[$doc:meta])* $name:ident, $m:literal, |$all:ident, $a:ident, $b:ident| $body:expr) => {
        $(#[$doc])*
        pub(crate) struct $name<'a>(pub &'a Adaptive);

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
    Eval, 3, |all, wi, wo| all.eval(wi, wo)
);
function!(
    /// The density of (wi, wo).
    Pdf, 1, |all, wi, wo| [all.pdf(wi, wo)]
);
function!(
    /// Both.
    EvalAndPdf, 4, |all, wi, wo| {
        let ([r, g, b], pdf) = all.eval_and_pdf(wi, wo);
        [r, g, b, pdf]
    }
);
function!(
    /// The direction that (wo, u) draws; below the horizon if it is none.
    Draw, 3, |all, wo, u| all.draw(wo, [u.x, u.y]).to_array()
);

impl Adaptive {
    /// f(wi→wo) in sr⁻¹ at each of the wavelengths `lambda_nm`: between measured wavelengths linear, beyond them constant. `false`, and
    /// nothing written, if only RGB is known.
    ///
    /// # Panics
    /// If `f` is not as long as `lambda_nm`.
    pub fn eval_spectrum(
        &self,
        wi: Vec3<f64>,
        wo: Vec3<f64>,
        lambda_nm: &[f64],
        f: &mut [f64],
    ) -> bool {
        assert_eq!(f.len(), lambda_nm.len(), "one value a wavelength");
        match self.slices.phi.len() {
            1 => self.eval_spectrum_in::<1>(wi, wo, lambda_nm, f),
            _ => self.eval_spectrum_in::<2>(wi, wo, lambda_nm, f),
        }
    }

    fn eval_spectrum_in<const C: usize>(
        &self,
        wi: Vec3<f64>,
        wo: Vec3<f64>,
        lambda_nm: &[f64],
        f: &mut [f64],
    ) -> bool {
        let Some(spectra) = &self.spectra else {
            return false;
        };
        let place = self.place(wi, wo);
        let blend = self.slices.blend::<f64, C>(place.at);
        let (p, _) = self.vndf.invert(place.half, &blend);
        let (w, h) = (spectra.width, spectra.height);
        let (i, tx) = (p[0] * (w - 1) as f64).cell(w as u32);
        let (j, ty) = (p[1] * (h - 1) as f64).cell(h as u32);
        let corner = j as usize * w + i as usize;
        let corners = [
            (0, 1.0 - tx, 1.0 - ty),
            (1, tx, 1.0 - ty),
            (w, 1.0 - tx, ty),
            (w + 1, tx, ty),
        ];
        let scale = self.scale(wi.z, wo.z, place.viewer, place.half);
        for (f, lambda) in f.iter_mut().zip(lambda_nm) {
            let (low, high, t) = spectra.around(*lambda);
            let mut sum = 0.0;
            for c in 0..C {
                for k in 0..2 {
                    let slice = self.stored_slice(blend.slice[c] as usize + k);
                    for (l, weight) in [(low, 1.0 - t), (high, t)] {
                        let weight = weight * blend.weight[c][k];
                        let table = (slice * spectra.lambda_nm.len() + l) * spectra.size();
                        for (step, x, y) in corners {
                            let value = spectra.values.get(table + corner + step);
                            sum += weight * x * y * f64::from(value);
                        }
                    }
                }
            }
            *f = sum.max(0.0) * scale;
        }
        true
    }

    /// The slice in the file: where the file has one elevation, two of ours are the same.
    fn stored_slice(&self, slice: usize) -> usize {
        let stored = self.spectra.as_ref().map_or(0, Spectra::slices);
        if stored == self.slices.phi.len() {
            slice / 2
        } else {
            slice
        }
    }
}
