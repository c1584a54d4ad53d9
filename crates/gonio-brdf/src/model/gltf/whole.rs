//! The material with all its layers, evaluated and sampled.

use super::Gltf;
use crate::part::colour::{add, each_component, largest, mean, only_where, scale};
use crate::part::geometry::{Half, flipped_where, refracted_about};
use crate::part::masking::{Masking, smith_g1_over_cos, visibility_from_areas};
use crate::{Brdf, Sample};
use gonio_num::{Mask, Real, Vec3, Work};
use gonio_radiometry::warp::{cosine_hemisphere, cosine_hemisphere_density};
use std::f64::consts::FRAC_1_PI;

/// What becomes of the light that meets a facet of the base.
struct Facet<R: Real, const N: usize> {
    /// Factor on c/π.
    diffuse: R,
    /// Factor on D V of the reflection.
    mirrored: [R; N],
    /// Factor on c D V of the transmission.
    passing: R,
}

/// The probabilities of drawing each part; they add up to 1.
struct Parts<R> {
    coat: R,
    sheen: R,
    diffuse: R,
    facets: R,
    /// About the albedo.
    sum: R,
}

/// A direction to the viewer, seen as if from outside.
struct Viewer<R: Real> {
    o: Vec3<R>,
    /// Whether it is on the inner side of a surface that transmits.
    below: R::Mask,
    /// Whether it is inside of a body, where no layer lies on the surface.
    inside: R::Mask,
}

/// f and the sampling density.
pub(super) struct EvalWhole<'a, R: Real, const N: usize>(
    pub &'a Gltf<R, N>,
    pub Vec3<R>,
    pub Vec3<R>,
);

impl<R: Real, const N: usize> Work for EvalWhole<'_, R, N> {
    type Output = ([R; N], R);
    #[inline(always)]
    fn run(self) -> ([R; N], R) {
        self.0.eval_whole(self.1, self.2)
    }
}

/// The direction that the random numbers draw.
pub(super) struct DrawWhole<'a, R: Real, const N: usize>(
    pub &'a Gltf<R, N>,
    pub Vec3<R>,
    pub [R; 3],
);

impl<R: Real, const N: usize> Work for DrawWhole<'_, R, N> {
    type Output = Vec3<R>;
    #[inline(always)]
    fn run(self) -> Vec3<R> {
        self.0.draw_whole(self.1, self.2)
    }
}

/// Whether the front of a facet is seen, at the cosine `cos` to its normal, from the outer side or from below.
#[inline(always)]
fn is_front<R: Real>(cos: R, below: R::Mask) -> R::Mask {
    R::select(below, -cos, cos).gt(R::zero())
}

/// `w`, or a direction along the horizon, where nothing is, if it isn't above it.
#[inline(always)]
fn above<R: Real>(w: Vec3<R>) -> Vec3<R> {
    let none = Vec3::new(R::one(), R::zero(), R::zero());
    Vec3::select(w.z.gt(R::zero()), w, none)
}

/// Declares a piece of the formula as a function of its own: a compiler's time grows faster than the length of a function.
macro_rules! piece {
    ($name:ident($($argument:ty),*) -> $output:ty: $method:ident($($index:tt),*)) => {
        struct $name<'a, R: Real, const N: usize>(&'a Gltf<R, N>, $($argument),*);

        impl<R: Real, const N: usize> Work for $name<'_, R, N> {
            type Output = $output;
            #[inline(always)]
            fn run(self) -> $output {
                self.0.$method($(self.$index),*)
            }
        }
    };
}
piece!(PartsOf(&'a Viewer<R>) -> Parts<R>: parts_of(1));
piece!(FacetOf(R, R::Mask, bool) -> Facet<R, N>: facet_of(1, 2, 3));
piece!(FibresOf(Vec3<R>, Vec3<R>) -> ([R; N], R): fibres_of(1, 2));
piece!(CoatOf(Vec3<R>, Vec3<R>, Half<R>) -> (R, R): coat_of(1, 2, 3));

impl<R: Real, const N: usize> Gltf<R, N> {
    /// On which side a direction lies; only what transmits has two.
    #[inline(always)]
    fn is_below(&self, w: Vec3<R>) -> R::Mask {
        if self.passage.on {
            w.z.lt(R::zero())
        } else {
            R::Mask::splat(false)
        }
    }

    #[inline(always)]
    fn viewer(&self, wo: Vec3<R>) -> Viewer<R> {
        let below = self.is_below(wo);
        Viewer {
            o: flipped_where(below, wo),
            below,
            inside: below & R::Mask::splat(self.passage.solid),
        }
    }

    /// How a facet shares out light at `cos` to its normal. In a body it is the angle outside that counts; beyond the critical angle
    /// all is reflected.
    #[inline(always)]
    fn facet_of(&self, cos: R, inside: R::Mask, film: bool) -> Facet<R, N> {
        let one = R::one();
        let mut cos = cos;
        let mut total = R::Mask::splat(false);
        if self.passage.refracts() {
            let ior = self.passage.relative_ior(self.ior);
            let sin2 = (one - cos * cos).max(R::zero()) * ior * ior;
            total = inside & sin2.ge(one);
            cos = R::select(inside, (one - sin2).safe_sqrt(), cos);
        }
        let weight = (one - cos).saturate().pow5();
        let mut dielectric = self.dielectric(weight);
        let mut metal = self.metal(weight);
        if film && self.film.on {
            dielectric = self.film.over(dielectric, self.dielectric(R::zero()), cos);
            metal = self.film.over(metal, self.base_color, cos);
        }
        each_component!(N, k => { dielectric[k] = R::select(total, one, dielectric[k]); });
        let entering = (one - self.metallic) * (one - largest(dielectric)).max(R::zero());
        let passing = if self.passage.on {
            entering * self.passage.share
        } else {
            R::zero()
        };
        let mut mirrored = dielectric;
        each_component!(N, k => { mirrored[k] = self.metallic.lerp(dielectric[k], metal[k]); });
        Facet {
            diffuse: entering - passing,
            mirrored,
            passing,
        }
    }

    /// The light that the fibres of the sheen reflect, and the density of drawing it from them.
    #[inline(always)]
    fn fibres_of(&self, i: Vec3<R>, o: Vec3<R>) -> ([R; N], R) {
        self.sheen.fibres.eval_and_pdf(i, o)
    }

    /// The coat's lobe and the density of drawing it, in the frame of the anisotropy.
    #[inline(always)]
    fn coat_of(&self, i: Vec3<R>, o: Vec3<R>, half: Half<R>) -> (R, R) {
        let half = Half::of(self.anisotropy.out_of_axes(half.h()), half.cos);
        let i = self.anisotropy.out_of_axes(i);
        self.coat.lobe(i, self.anisotropy.out_of_axes(o), &half)
    }

    /// Probability that a facet which was drawn reflects: its share of what leaves.
    #[inline(always)]
    fn mirror_probability(&self, facet: &Facet<R, N>) -> R {
        let mirrored = mean(facet.mirrored) + R::lit(1e-6);
        mirrored / (mirrored + facet.passing * mean(self.base_color))
    }

    /// Each part's share of the albedo, estimated with the facet that lies flat. They steer efficiency only, so the film is left out.
    #[inline(always)]
    fn parts_of(&self, viewer: &Viewer<R>) -> Parts<R> {
        let (zero, one) = (R::zero(), R::one());
        let cos = viewer.o.z.saturate();
        let facet = R::out_of_line(FacetOf(self, cos, viewer.inside, false));
        let albedo = mean(self.base_color);
        let (mut coat, mut sheen, mut below) = (zero, zero, one);
        if self.sheen.on {
            let (rest, fibres) = self.sheen.split(cos);
            below = R::select(viewer.inside, one, rest);
            sheen = R::select(viewer.inside, zero, fibres);
        }
        if self.coat.on {
            let share = self.coat.share(self.anisotropy.out_of_axes(viewer.o));
            coat = R::select(viewer.inside, zero, share);
        }
        let uncoated = one - coat;
        let sheen = sheen * uncoated;
        let diffuse = facet.diffuse * albedo * below * uncoated;
        let facets = mean(facet.mirrored) + facet.passing * albedo + R::lit(1e-6);
        let facets = facets * below * uncoated;
        let sum = (coat + sheen + diffuse + facets).max(R::lit(1e-20));
        let over = sum.recip();
        Parts {
            coat: coat * over,
            sheen: sheen * over,
            diffuse: diffuse * over,
            facets: facets * over,
            sum,
        }
    }

    #[inline(always)]
    pub(super) fn whole_albedo(&self, wo: Vec3<R>) -> R {
        R::out_of_line(PartsOf(self, &self.viewer(wo))).sum
    }

    #[inline(always)]
    fn eval_whole(&self, wi: Vec3<R>, wo: Vec3<R>) -> ([R; N], R) {
        let (zero, one) = (R::zero(), R::one());
        let (wi, wo) = (self.anisotropy.in_axes(wi), self.anisotropy.in_axes(wo));
        let viewer = self.viewer(wo);
        let (o, below) = (viewer.o, viewer.below);
        let below_i = self.is_below(wi);
        let i = flipped_where(below_i, wi);
        let same = (below & below_i) | (!below & !below_i);
        let valid = i.z.gt(zero) & o.z.gt(zero);

        // The facet: a thin wall's is that of the mirror image.
        let half = Half::new(i, o);
        let (mut h, mut cos, mut inside) = (half.h(), half.cos, viewer.inside);
        let mut faces = R::Mask::splat(true);
        // 4 f/(D V) and 4 p/(D G₁/cosθr) of what passes.
        let mut passing_factors = [one, one];
        if self.passage.refracts() {
            let ior = self.passage.relative_ior(self.ior);
            let n_i = R::select(below_i, ior, one);
            let n_o = R::select(below, ior, one);
            // Symmetric in the directions to the last bit.
            let sum = wi * n_i + wo * n_o;
            let length2 = sum.length_squared().max(R::lit(1e-30));
            let over = length2.sqrt().recip();
            let normal = sum * R::select(sum.z.lt(zero), -over, over);
            let signed = [wi.dot(normal), wo.dot(normal)];
            let (ci, co) = (signed[0].abs(), signed[1].abs());
            faces = same | (is_front(signed[0], below_i) & is_front(signed[1], below));
            h = Vec3::select(same, h, normal);
            cos = R::select(same, cos, R::select(below, ci, co));
            inside = inside & same;
            let jacobian = R::lit(4.0) * ci * co / length2;
            passing_factors = [jacobian * n_o * n_o, jacobian * n_i * n_i];
        }
        let d = self.distribution.density(h);
        let lobe = d * visibility_from_areas(Masking::Smith, &self.distribution, i, o);
        let facet_density = R::lit(0.25) * d * smith_g1_over_cos(&self.distribution, o);
        let facet = R::out_of_line(FacetOf(self, cos, inside, true));
        let mirror = self.mirror_probability(&facet);

        let diffuse = scale(self.base_color, facet.diffuse * R::lit(FRAC_1_PI));
        let mut f = add(scale(facet.mirrored, lobe), diffuse);
        let mut through = facet_density * mirror;
        if self.passage.on {
            let passing = scale(self.base_color, facet.passing * lobe * passing_factors[0]);
            let passing = only_where(faces, passing);
            each_component!(N, k => { f[k] = R::select(same, f[k], passing[k]); });
            let density = facet_density * passing_factors[1] * (one - mirror);
            through = R::select(same, through, R::select(faces, density, zero));
        }
        let parts = R::out_of_line(PartsOf(self, &viewer));
        let cosine = R::select(same, cosine_hemisphere_density(i), zero);
        let mut density = parts.facets * through + parts.diffuse * cosine;

        // The layers lie outside of a body, and on both sides of a wall.
        let on_layers = same & !viewer.inside;
        if self.sheen.on {
            let bare_i = below_i & R::Mask::splat(self.passage.solid);
            let share_i = R::select(bare_i, one, self.sheen.split(i.z).0);
            let share_o = R::select(viewer.inside, one, self.sheen.split(o.z).0);
            f = scale(f, share_i.min(share_o));
            let (fibres, drawn) = R::out_of_line(FibresOf(self, i, o));
            f = add(f, only_where(on_layers, fibres));
            density = density + parts.sheen * R::select(on_layers, drawn, zero);
        }
        if self.coat.on {
            // What leaves a body passes the coat on the light's side.
            let outer = Vec3::select(viewer.inside, i, o);
            let share = self.coat.share(self.anisotropy.out_of_axes(outer));
            let share = R::select(viewer.inside & same, zero, share);
            let (coat, drawn) = R::out_of_line(CoatOf(self, i, o, half));
            let coat = R::select(on_layers, share * coat, zero);
            each_component!(N, k => { f[k] = f[k] * (one - share) + coat; });
            density = density + parts.coat * R::select(on_layers, drawn, zero);
        }
        (only_where(valid, f), R::select(valid, density, zero))
    }

    #[inline(always)]
    fn draw_whole(&self, wo: Vec3<R>, u: [R; 3]) -> Vec3<R> {
        let (zero, one) = (R::zero(), R::one());
        let viewer = self.viewer(self.anisotropy.in_axes(wo));
        let o = viewer.o;
        let parts = R::out_of_line(PartsOf(self, &viewer));
        let tiny = R::lit(1e-20);
        let none = Vec3::new(one, zero, zero);

        let before = parts.coat + parts.sheen + parts.diffuse;
        let rest = ((u[2] - before) / parts.facets.max(tiny)).saturate();
        let h = self.distribution.sample_visible_ggx(o, u[0], u[1]);
        let cos = o.dot(h);
        let seen = cos.gt(zero);
        let cos = cos.clamp(zero, one);
        let mut drawn = above(o.reflect(h));
        if self.passage.on {
            let facet = R::out_of_line(FacetOf(self, cos, viewer.inside, true));
            let mirror = self.mirror_probability(&facet);
            let through = if self.passage.solid {
                let ior = self.passage.relative_ior(self.ior);
                let ratio = R::select(viewer.inside, ior, ior.recip());
                let w = refracted_about(o, h, cos, ratio);
                Vec3::select(w.z.lt(zero), w, none)
            } else {
                flipped_where(drawn.z.gt(zero), drawn)
            };
            drawn = Vec3::select(rest.lt(mirror), drawn, through);
        }
        drawn = Vec3::select(seen, drawn, none);
        drawn = Vec3::select(u[2].lt(before), cosine_hemisphere([u[0], u[1]]), drawn);
        if self.sheen.on {
            let rest = ((u[2] - parts.coat) / parts.sheen.max(tiny)).saturate();
            let fibres = self.sheen.fibres.draw(o, [u[0], u[1], rest]);
            drawn = Vec3::select(u[2].lt(parts.coat + parts.sheen), above(fibres), drawn);
        }
        if self.coat.on {
            let coat = self.coat.draw(self.anisotropy.out_of_axes(o), [u[0], u[1]]);
            let coat = above(self.anisotropy.in_axes(coat));
            drawn = Vec3::select(u[2].lt(parts.coat), coat, drawn);
        }
        self.anisotropy
            .out_of_axes(flipped_where(viewer.below, drawn))
    }

    #[inline(always)]
    pub(super) fn sample_whole(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R, N> {
        let wi = R::out_of_line(DrawWhole(self, wo, u));
        self.sample_of(wi, wo)
    }
}
