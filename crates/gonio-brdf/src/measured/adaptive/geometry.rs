//! [`Geometry`], where directions lie in an adaptive table.

use super::plane::Plane;
use super::slices::{At, Slices};
use super::tables::{Nodes, Tables};
use super::warp::Warp;
use crate::Number;
use gonio_num::Vec3;
use std::borrow::Cow;
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

/// Where directions lie in an adaptive table, ready to be looked up and drawn from.
#[derive(Debug, Clone)]
pub(super) struct Geometry {
    /// How often the azimuths of the slices repeat in a turn; 0 where azimuths are counted from the viewer's.
    symmetry: u32,
    pub slices: Slices,
    ndf: Plane,
    sigma: Plane,
    pub vndf: Warp,
    pub luminance: Warp,
    jacobian: bool,
}

impl Geometry {
    /// From tables that were checked.
    pub fn new(tables: &Tables) -> Self {
        let mut theta = tables.theta_i.clone();
        if theta.len() == 1 {
            // The one elevation holds for all: it is stored twice, so that there are always two to mix.
            theta.push(theta[0] + 1.0);
        }
        let slices = Slices {
            theta,
            phi: tables.phi_i.clone(),
        };
        let warp = |nodes: &Nodes| {
            let values = twice_if_one(&nodes.values, tables);
            Warp::new(&values, nodes.width, nodes.height, &slices)
        };
        let plane = |nodes: &Nodes| Plane::new(&nodes.values, nodes.width, nodes.height);
        Self {
            symmetry: tables.symmetry(),
            ndf: plane(&tables.ndf),
            sigma: plane(&tables.sigma),
            vndf: warp(&tables.vndf),
            luminance: warp(&tables.luminance),
            jacobian: tables.jacobian,
            slices,
        }
    }

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
    pub fn place<R: Number>(&self, wi: Vec3<R>, wo: Vec3<R>) -> Place<R> {
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
    pub fn scale<R: Number>(&self, cos_i: R, cos_o: R, viewer: [R; 2], half: [R; 2]) -> R {
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
    pub fn shade<R: Number>(scale: R, [r, g, b]: [R; 3]) -> [R; 3] {
        let zero = R::zero();
        [
            r.max(zero) * scale,
            g.max(zero) * scale,
            b.max(zero) * scale,
        ]
    }

    /// The density per solid angle from those of visible normals and of luminance.
    #[inline(always)]
    pub fn density<R: Number>(cos_i: R, cos_o: R, visible: R, luminance: R, jacobian: R) -> R {
        let above = cos_i.gt(R::zero()) & cos_o.gt(R::zero());
        R::select(above, visible * luminance / jacobian, R::zero())
    }

    /// The slices around the viewer, of which a direction is drawn.
    #[inline(always)]
    pub fn slices_of<R: Number>(&self, wo: Vec3<R>) -> At<R> {
        let (wo, _, _) = self.fold(wo);
        self.slices.around(theta(wo).0, self.phi(wo))
    }

    /// The viewer's direction mirrored about the half vector at a point of the unit square; below the horizon if that is no
    /// direction.
    #[inline(always)]
    pub fn reflect<R: Number>(&self, wo: Vec3<R>, [a, b]: [R; 2]) -> Vec3<R> {
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
    pub fn draw<R: Number>(&self, wo: Vec3<R>, u: [R; 2]) -> Vec3<R> {
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
}

/// The values of each slice, those of a single elevation twice.
pub(super) fn twice_if_one<'a>(values: &'a [f32], tables: &Tables) -> Cow<'a, [f32]> {
    if tables.theta_i.len() > 1 {
        return values.into();
    }
    let slices = values.chunks_exact(values.len() / tables.slices());
    let twice = slices.flat_map(|s| [s, s]).flatten().copied();
    twice.collect::<Vec<_>>().into()
}
