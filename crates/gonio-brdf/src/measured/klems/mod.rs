//! [`Klems`], values by patches of the two hemispheres, and how they are evaluated and drawn from.

mod basis;

pub use basis::Basis;

use super::channel::{ToRgb, luminance};
use super::metadata::Gamut;
use super::search::interval;
use super::values::Values;
use super::views::accumulate;
use crate::{Index, Number};
use gonio_num::Vec3;
use gonio_radiometry::warp::around_axis;

/// One value for each pair of patches of the incoming and the outgoing hemisphere, constant within.
///
/// An incoming patch is named by the azimuth in which its light travels, not by that from where it comes: the patch of light from
/// azimuth φ is the one at φ + 180°, so that the mirror direction has the same number (Klems 1994).
#[derive(Debug, Clone, PartialEq)]
pub struct Klems {
    incoming: Basis,
    outgoing: Basis,
    channels: usize,
    values: Values,
}

impl Klems {
    /// `values`: for each outgoing patch, each incoming one, each channel.
    ///
    /// # Errors
    /// If their number is not the product of the three: what was found and what was expected.
    pub fn new(
        incoming: Basis,
        outgoing: Basis,
        channels: usize,
        values: impl Into<Values>,
    ) -> Result<Self, (String, String)> {
        let values = values.into();
        let expected = incoming.len() * outgoing.len() * channels;
        if expected == 0 || values.len() != expected {
            return Err((
                format!("{} values", values.len()),
                format!(
                    "{} × {} patches × {channels}",
                    outgoing.len(),
                    incoming.len()
                ),
            ));
        }
        Ok(Self {
            incoming,
            outgoing,
            channels,
            values,
        })
    }

    /// The patches of the incoming hemisphere.
    pub fn incoming(&self) -> &Basis {
        &self.incoming
    }

    /// The patches of the outgoing hemisphere.
    pub fn outgoing(&self) -> &Basis {
        &self.outgoing
    }

    /// Numbers for each pair of patches.
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// The numbers.
    pub fn values(&self) -> &Values {
        &self.values
    }

    pub(super) fn with_values(&self, values: Values) -> Self {
        Self {
            values,
            ..self.clone()
        }
    }

    /// All channels, whatever side the directions are on.
    pub(super) fn lookup(&self, wi: Vec3<f64>, wo: Vec3<f64>, out: &mut [f64]) {
        let i = self.incoming.find(-wi.x, -wi.y) as usize;
        let o = self.outgoing.find(wo.x, wo.y) as usize;
        let at = (o * self.incoming.len() + i) * self.channels;
        for (x, value) in out.iter_mut().zip(&self.values[at..at + self.channels]) {
            *x = f64::from(*value);
        }
    }
}

/// Patches ready to be evaluated.
///
/// For the outgoing patch of the viewer an incoming one is drawn with probability ∝ value × projected solid angle, and in it a direction
/// uniformly by projected solid angle: f·cosθi over the density is then the albedo, whatever was drawn.
#[derive(Debug, Clone)]
pub(super) struct KlemsTable {
    incoming: Basis,
    outgoing: Basis,
    /// 4 numbers (RGB and one unused) for each outgoing and incoming patch.
    colours: Vec<f32>,
    patches: Vec<f32>,
    /// Cumulative probabilities of the incoming patches for each outgoing one.
    cumulative: Vec<f32>,
    /// Probability over projected solid angle.
    density: Vec<f32>,
    /// Luminous albedo of each outgoing patch.
    totals: Vec<f32>,
}

impl KlemsTable {
    /// Of values that are finite and not negative.
    pub fn new(klems: &Klems, to_rgb: &ToRgb, gamut: &mut Gamut) -> Self {
        let n = klems.incoming.len();
        let mut this = Self {
            incoming: klems.incoming.clone(),
            outgoing: klems.outgoing.clone(),
            colours: Vec::new(),
            patches: klems.incoming.table(),
            cumulative: Vec::new(),
            density: Vec::new(),
            totals: Vec::new(),
        };
        let solid: Vec<f64> = (0..n)
            .map(|k| klems.incoming.projected_solid_angle(k))
            .collect();
        for row in klems.values.chunks_exact(n * klems.channels) {
            let mut masses = Vec::with_capacity(n);
            for (cell, solid) in row.chunks_exact(klems.channels).zip(&solid) {
                let values: Vec<f64> = cell.iter().map(|x| f64::from(*x)).collect();
                let rgb = gamut.clip(to_rgb.apply(&values));
                this.colours
                    .extend([rgb[0] as f32, rgb[1] as f32, rgb[2] as f32, 0.0]);
                masses.push(luminance(rgb) * solid);
            }
            let start = this.cumulative.len();
            accumulate(masses.iter().copied(), &mut this.cumulative);
            for (k, solid) in solid.iter().enumerate() {
                let p = this.cumulative[start + k + 1] - this.cumulative[start + k];
                this.density.push((f64::from(p) / solid) as f32);
            }
            this.totals.push(masses.iter().sum::<f64>() as f32);
        }
        this
    }

    #[inline(always)]
    fn at<R: Number>(&self, wi: Vec3<R>, wo: Vec3<R>) -> R::Index {
        let i = self.incoming.find(-wi.x, -wi.y);
        let o = self.outgoing.find(wo.x, wo.y);
        o.times(self.incoming.len() as u32).plus(i)
    }

    /// Linear RGB, whatever side the directions are on.
    #[inline(always)]
    pub fn eval<R: Number>(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; 3] {
        let [r, g, b, _] = R::gather(&self.colours, self.at(wi, wo).times(4));
        [r, g, b]
    }

    /// Density per solid angle of drawing `wi`, whatever side it is on.
    #[inline(always)]
    pub fn pdf<R: Number>(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        let [d] = R::gather(&self.density, self.at(wi, wo));
        d * wi.z.abs()
    }

    /// Draws a direction with z ≥ 0; the caller puts it on the component's side.
    #[inline(always)]
    pub fn sample<R: Number>(&self, wo: Vec3<R>, u: [R; 3]) -> Vec3<R> {
        let n = self.incoming.len() as u32;
        let o = self.outgoing.find(wo.x, wo.y);
        let (patch, t) = interval(&self.cumulative, o.times(n + 1), n, u[1]);
        let [a, b, first, width] = R::gather(&self.patches, patch.times(4));
        let s = t.lerp(a, b);
        let w = around_axis(
            first + u[0] * width,
            s.safe_sqrt(),
            (R::one() - s).safe_sqrt(),
        );
        Vec3::new(-w.x, -w.y, w.z)
    }

    /// The luminous albedo.
    #[inline(always)]
    pub fn albedo<R: Number>(&self, wo: Vec3<R>) -> R {
        R::gather::<1>(&self.totals, self.outgoing.find(wo.x, wo.y))[0]
    }
}
