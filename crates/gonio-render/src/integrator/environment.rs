//! How light from the environment is sampled at a surface.

use super::vertex::Vertex;
use super::{RayCounts, dimension};
use gonio_env::{Candidates, Environment, Guide, Reflected};
use gonio_num::Vec3;
use gonio_radiometry::sequence::SampleStream;
use gonio_scene::{Interior, LightTarget, Scene};

/// How light from the environment is sampled at a surface. Every choice has the same expectation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum EnvironmentSampling {
    /// By its luminance.
    #[default]
    Luminance,
    /// By what exceeds the mean luminance: the reflection function finds the rest (Karlík et al. 2019).
    Compensated,
    /// By luminance times cosine, for surfaces that reflect alone; by luminance for those that transmit.
    Cosine,
    /// By light × reflection × cosine: several candidates of either, one of which casts a shadow ray (Talbot et al. 2005).
    Product(Candidates),
}

impl EnvironmentSampling {
    /// The name: `luminance`, `compensated`, `cosine` or `product`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Luminance => "luminance",
            Self::Compensated => "compensated",
            Self::Cosine => "cosine",
            Self::Product(_) => "product",
        }
    }

    /// What single directions are drawn by at `vertex`.
    #[inline(always)]
    pub(super) fn guide(self, vertex: &Vertex<'_>) -> Guide {
        match self {
            Self::Luminance | Self::Product(_) => Guide::Luminance,
            Self::Compensated => Guide::Compensated,
            Self::Cosine if vertex.transmits => Guide::Luminance,
            Self::Cosine => Guide::Cosine(vertex.facing_normal()),
        }
    }

    /// The weight of the environment's light where the reflection function has drawn its direction: where the candidates stand for both
    /// strategies already, none.
    #[inline(always)]
    pub(super) fn takes_all(self, drawn_is_delta: bool) -> bool {
        matches!(self, Self::Product(_)) && !drawn_is_delta
    }
}

impl Vertex<'_> {
    /// The environment's light scattered toward the viewer, by the product. The part that reflects into single directions is left out.
    ///
    /// - `bounce`: for the dimensions of the sequence
    /// - `interior`: the bodies on the viewer's side
    pub(super) fn reflect_product(
        &self,
        scene: &Scene,
        (environment, candidates): (&Environment, Candidates),
        bounce: u32,
        interior: &Interior,
        stream: &mut SampleStream,
        counts: &mut RayCounts,
    ) -> [f32; 3] {
        let judge = |wi: Vec3<f32>| {
            let (f_cos, pdf) = self.eval_cos(wi);
            Reflected { f_cos, pdf }
        };
        let draw = |u: [f32; 3]| {
            let drawn = self.sample(u).filter(|drawn| !drawn.delta)?;
            let f_cos = drawn.weight.map(|w| w * drawn.pdf);
            let pdf = drawn.pdf;
            Some((drawn.wi, Reflected { f_cos, pdf }))
        };
        let mut next = dimension::of_product(bounce);
        let numbers = || {
            stream.seek(next);
            next += 3;
            stream.next_3d()
        };
        let kept = environment.sample_product(self.point.p, candidates, judge, draw, numbers);
        kept.map_or([0.0; 3], |kept| {
            let target = LightTarget::Infinite;
            self.unblocked(scene, kept.wi, target, kept.contribution, interior, counts)
        })
    }
}
