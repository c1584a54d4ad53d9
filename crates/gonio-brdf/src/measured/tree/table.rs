//! [`TreeTable`], a tensor tree ready to be evaluated and drawn from over any number.

use super::super::channel::{ToRgb, luminance};
use super::super::metadata::Gamut;
use super::rings::Rings;
use super::slices::Slices;
use super::{Child, TensorTree, coordinates};
use crate::{Index, Number};
use gonio_num::{Mask, Vec3};
use gonio_radiometry::colour::RgbSpace;
use std::f64::consts::FRAC_1_PI;

/// A tree ready to be evaluated.
///
/// Squares are drawn with probability ∝ luminance × area among those that hold the viewer's direction: f·cosθi over the density is then
/// the albedo, whatever was drawn (but for its colour).
#[derive(Debug, Clone)]
pub(in super::super) struct TreeTable {
    rank: u32,
    depth: u32,
    /// (red, green, blue, −1) of a leaf, (…, number of the branch) of a branch: 4 numbers for each child of each branch.
    nodes: Vec<f32>,
    sampling: Sampling,
}

#[derive(Debug, Clone)]
enum Sampling {
    Isotropic(Rings),
    Anisotropic(Slices),
}

impl TreeTable {
    /// Of values that are finite and not negative.
    ///
    /// # Errors
    /// If the tree is too fine to be drawn from: what was found and what was expected.
    pub fn new(
        tree: &TensorTree,
        to_rgb: &ToRgb,
        gamut: &mut Gamut,
    ) -> Result<Self, (String, String)> {
        if tree.branches() >= 1 << 24 {
            return Err((
                format!("{} branches", tree.branches()),
                "fewer than 16777216".into(),
            ));
        }
        let colours: Vec<[f32; 3]> = tree
            .leaves()
            .chunks_exact(tree.channels())
            .map(|leaf| {
                let values: Vec<f64> = leaf.iter().map(|x| f64::from(*x)).collect();
                gamut.clip(to_rgb.apply(&values)).map(|c| c as f32)
            })
            .collect();
        let mut nodes = Vec::with_capacity((tree.branches() * 4) << tree.rank);
        for branch in 0..tree.branches() as u32 {
            for place in 0..1 << tree.rank {
                match tree.child(branch, place) {
                    Child::Leaf(l) => {
                        let [r, g, b] = colours[l as usize];
                        nodes.extend([r, g, b, -1.0]);
                    }
                    Child::Branch(b) => nodes.extend([0.0, 0.0, 0.0, b as f32]),
                }
            }
        }
        let light = |leaf: u32| {
            let [r, g, b] = colours[leaf as usize];
            luminance([r.into(), g.into(), b.into()])
        };
        let sampling = if tree.rank == 3 {
            Sampling::Isotropic(Rings::new(tree, &light)?)
        } else {
            Sampling::Anisotropic(Slices::new(tree, &light)?)
        };
        Ok(Self {
            rank: tree.rank,
            depth: tree.depth,
            nodes,
            sampling,
        })
    }

    /// Linear RGB, whatever side the directions are on.
    #[inline(always)]
    pub fn eval<R: Number>(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; 3] {
        let x = coordinates(self.rank, wi, wo);
        match self.rank {
            3 => descend::<R, 3>(&self.nodes, self.depth, x),
            _ => descend::<R, 4>(&self.nodes, self.depth, x),
        }
    }

    /// Density per solid angle of drawing `wi`, whatever side it is on.
    #[inline(always)]
    pub fn pdf<R: Number>(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        let [r, g, b] = self.eval(wi, wo);
        let [wr, wg, wb] = RgbSpace::SRGB_LUMINANCE_WEIGHTS;
        let light = R::lit(wr) * r + R::lit(wg) * g + R::lit(wb) * b;
        let total = self.albedo(wo);
        let some = total.gt(R::lit(1e-30));
        let density = light / R::select(some, total, R::one());
        // Where nothing is reflected the cosine lobe is drawn from.
        R::select(some, density, R::lit(FRAC_1_PI)) * wi.z.abs()
    }

    /// Draws a direction with z ≥ 0; the caller puts it on the component's side.
    #[inline(always)]
    pub fn sample<R: Number>(&self, wo: Vec3<R>, u: [R; 3]) -> Vec3<R> {
        let some = self.albedo(wo).gt(R::lit(1e-30));
        let wi = match &self.sampling {
            Sampling::Isotropic(rings) => rings.sample(wo, u),
            Sampling::Anisotropic(slices) => slices.sample(wo, u),
        };
        let from_cosine = gonio_radiometry::warp::cosine_hemisphere([u[0], u[1]]);
        Vec3::select(some, wi, from_cosine)
    }

    /// The luminous albedo.
    #[inline(always)]
    pub fn albedo<R: Number>(&self, wo: Vec3<R>) -> R {
        match &self.sampling {
            Sampling::Isotropic(rings) => rings.albedo(wo),
            Sampling::Anisotropic(slices) => slices.albedo(wo),
        }
    }
}

/// The colour of the leaf that holds `x`. Lanes that have arrived keep what they found.
#[inline(always)]
fn descend<R: Number, const D: usize>(nodes: &[f32], depth: u32, x: [R; 4]) -> [R; 3] {
    let mut x = x;
    let mut branch = R::Index::splat(0);
    let mut found = [R::zero(); 3];
    let mut arrived = R::Mask::splat(false);
    for _ in 0..depth {
        let mut at = branch.times(1 << D);
        for k in 0..D {
            let twice = x[k] + x[k];
            let upper = twice.ge(R::one());
            let bit = R::Index::splat(1 << k);
            at = R::select_index(upper, at.plus(bit), at);
            x[k] = R::select(upper, twice - R::one(), twice);
        }
        let [r, g, b, code] = R::gather(nodes, at.times(4));
        found = [
            R::select(arrived, found[0], r),
            R::select(arrived, found[1], g),
            R::select(arrived, found[2], b),
        ];
        arrived = arrived | code.lt(R::zero());
        if !R::maybe_any(!arrived) {
            break;
        }
        branch = code.index((1 << 24) - 1);
    }
    found
}
