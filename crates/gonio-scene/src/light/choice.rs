//! [`Choice`], how one of a scene's lights is chosen for a point.

use super::emitter::Emitter;
use super::tree::{Choices, Found, LightTree, Points, Walks};
use super::{Light, Receiver, WHOLE, luminance};
use crate::{Geometry, Surfaces};
use gonio_env::Environment;
use gonio_num::dispatch::{Kernel, dispatch};
use gonio_num::{Vec3, Vectors};
use gonio_radiometry::warp::Discrete;
use std::f64::consts::PI;

/// How one of a scene's lights is chosen for a point.
///
/// By a tree: among things of power Φᵢ one is chosen with the probability pᵢ = ½ Φᵢ/ΣΦ + ½ 1/n. Power alone would starve a small lamp beside the
/// subject of a scene under a large sky; the uniform half bounds the variance of any light at twice what sampling by power, and at twice
/// what sampling evenly, would give. Power of a light that is infinitely far away is what passes through the bounding sphere of the scene,
/// of radius R: π R² E for parallel light, π R² ∫L dω for an environment.
///
/// Of several lights that have a place the one is chosen by a tree, which knows the point; together they are one thing beside those that
/// are infinitely far away.
///
/// By power: pᵢ = Φᵢ/ΣΦ. Evenly: pᵢ = 1/n.
#[derive(Debug)]
pub(super) enum Choice {
    /// There is nothing to choose from.
    None,
    /// One of the lights, half by power and half evenly: too few have a place to make a tree.
    Mixed(Discrete),
    /// The tree, or one of the others.
    Tree {
        tree: LightTree,
        /// The tree, then the others in their order.
        branch: Discrete,
        /// The others.
        infinite: Vec<u32>,
        /// Whether each light is chosen triangle by triangle.
        parts: Vec<bool>,
    },
    /// One of the lights, by power alone.
    Power(Discrete),
    /// One of the lights that shine.
    Uniform {
        shining: Vec<u32>,
        /// For each light 1 over the number of those that shine, or 0.
        probabilities: Vec<f32>,
    },
}

/// A light that was chosen.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Chosen {
    pub light: u32,
    /// The triangle of a mesh that is chosen triangle by triangle, else [`WHOLE`].
    pub primitive: u32,
    /// 0: none.
    pub probability: f32,
    /// Uniform in \[0, 1) again.
    pub rest: f32,
}

/// The largest number of single precision below 1.
const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;

impl Chosen {
    /// Not by its triangles.
    #[inline(always)]
    fn whole((light, probability, rest): (usize, f32, f32)) -> Self {
        Self {
            light: light as u32,
            primitive: WHOLE,
            probability,
            rest,
        }
    }

    #[inline(always)]
    fn by_power(lights: &Discrete, u: f64) -> Self {
        Self::whole(lights.sample_fine(u))
    }

    /// One of `shining`, each of which has the same probability.
    #[inline(always)]
    fn uniform(shining: &[u32], probabilities: &[f32], u: f64) -> Self {
        let scaled = u * shining.len() as f64;
        // A product that is rounded up is the end of the last.
        let k = (scaled as u32).min(shining.len() as u32 - 1);
        let light = shining[k as usize];
        Self {
            light,
            primitive: WHOLE,
            probability: probabilities[light as usize],
            rest: ((scaled - f64::from(k)) as f32).min(BELOW_ONE),
        }
    }

    /// By a tree that was chosen with this probability.
    #[inline(always)]
    fn below(probability: f32, found: &Found) -> Self {
        Self {
            light: found.light,
            primitive: found.primitive,
            probability: probability * found.probability as f32,
            rest: (found.rest as f32).min(BELOW_ONE),
        }
    }
}

impl Choice {
    /// All that there are, each in the place of its [`LightChoice`](super::LightChoice).
    pub fn each(geometry: &Geometry, lights: &[Light], emitters: &[Option<Emitter>]) -> [Self; 3] {
        let powers: Vec<f64> = lights.iter().map(|light| power(light, geometry)).collect();
        let tree = match LightTree::new(geometry, lights, emitters, &powers) {
            Some(tree) => Self::with_tree(tree, lights, &powers),
            None => Discrete::new(&probabilities(&powers)).map_or(Self::None, Self::Mixed),
        };
        [tree, Self::by_power(&powers), Self::uniform(&powers)]
    }

    /// By power alone.
    fn by_power(powers: &[f64]) -> Self {
        // There are more than a table may have.
        Discrete::new(&shares(powers)).map_or_else(|_| Self::uniform(powers), Self::Power)
    }

    fn uniform(powers: &[f64]) -> Self {
        let shining: Vec<u32> = (0..)
            .zip(powers)
            .filter(|&(_, &p)| shines(p))
            .map(|(light, _)| light)
            .collect();
        if shining.is_empty() {
            return Self::None;
        }
        let each = (1.0 / shining.len() as f64) as f32;
        let probability = |&p: &f64| if shines(p) { each } else { 0.0 };
        Self::Uniform {
            shining,
            probabilities: powers.iter().map(probability).collect(),
        }
    }

    fn with_tree(tree: LightTree, lights: &[Light], powers: &[f64]) -> Self {
        let mut branches = vec![0.0];
        let mut infinite = Vec::new();
        for (i, &power) in powers.iter().enumerate() {
            if tree.holds(i as u32) {
                branches[0] += power;
            } else {
                branches.push(power);
                infinite.push(i as u32);
            }
        }
        match Discrete::new(&probabilities(&branches)) {
            Ok(branch) => Self::Tree {
                parts: (0..lights.len() as u32)
                    .map(|i| tree.has_parts(i))
                    .collect(),
                tree,
                branch,
                infinite,
            },
            Err(_) => Self::None,
        }
    }

    pub fn is_none(&self) -> bool {
        matches!(self, Self::None)
    }

    /// Whether it matters which way a point faces.
    pub fn asks_for_normals(&self) -> bool {
        matches!(self, Self::Tree { .. })
    }

    /// Whether a light is chosen triangle by triangle.
    pub fn parts(&self, light: u32) -> bool {
        match self {
            Self::Tree { parts, .. } => parts[light as usize],
            _ => false,
        }
    }

    /// Chooses a light for a point.
    #[inline]
    pub fn choose(&self, at: &Receiver, u: f32) -> Option<Chosen> {
        match self {
            Self::Tree { .. } => dispatch(Choose {
                choice: self,
                at,
                u,
            }),
            _ => self.choose_here(at, u),
        }
    }

    /// As [`Choice::choose`], in the instruction set that the caller has chosen.
    #[inline(always)]
    fn choose_here(&self, at: &Receiver, u: f32) -> Option<Chosen> {
        match self {
            Self::None => None,
            Self::Mixed(lights) => Some(Chosen::whole(lights.sample(u))),
            Self::Power(lights) => Some(Chosen::by_power(lights, finer(u, at.p))),
            Self::Uniform {
                shining,
                probabilities,
            } => Some(Chosen::uniform(shining, probabilities, finer(u, at.p))),
            Self::Tree {
                tree,
                branch,
                infinite,
                ..
            } => {
                let (index, probability, rest) = sample_branch(branch, infinite, u);
                if index > 0 {
                    let light = infinite[index - 1] as usize;
                    return Some(Chosen::whole((light, probability, rest)));
                }
                let found = tree.choose(at, finer(rest, at.p))?;
                Some(Chosen::below(probability, &found))
            }
        }
    }

    /// [`Choice::choose`] for many points.
    ///
    /// - `normals`: as [`Receiver::normal`]; empty where [`Choice::asks_for_normals`] says that they don't matter
    /// - `walks`: room to work in
    /// - `chosen`: one a point, written
    pub fn choose_many(
        &self,
        from: &Surfaces,
        normals: &Vectors,
        u: &[f32],
        walks: &mut Walks,
        chosen: &mut Vec<Chosen>,
    ) {
        chosen.clear();
        chosen.resize(from.p.len(), Chosen::default());
        dispatch(ChooseMany {
            choice: self,
            from,
            normals,
            u: &u[..from.p.len()],
            walks,
            chosen,
        });
    }

    /// The probability with which a light is chosen at a point, or this triangle of it, if it is chosen triangle by triangle.
    pub fn probability(&self, at: &Receiver, light: u32, primitive: u32) -> f32 {
        match self {
            Self::Tree { tree, branch, .. } if tree.holds(light) => {
                branch.probability(0) * tree.probability(at, light, primitive) as f32
            }
            _ => self.probability_of_infinite(light),
        }
    }

    /// The probability with which a light is chosen, if that is the same everywhere.
    pub fn probability_of_infinite(&self, light: u32) -> f32 {
        match self {
            Self::None => 0.0,
            Self::Mixed(lights) | Self::Power(lights) => lights.probability(light as usize),
            Self::Uniform { probabilities, .. } => probabilities[light as usize],
            Self::Tree {
                branch, infinite, ..
            } => {
                let place = infinite.binary_search(&light);
                place.map_or(0.0, |i| branch.probability(i + 1))
            }
        }
    }

    /// The probability that a light is chosen, or any triangle of it.
    pub fn probability_of_light(&self, at: &Receiver, light: u32) -> f32 {
        match self {
            Self::Tree { tree, branch, .. } if tree.holds(light) => {
                branch.probability(0) * tree.probability_of_light(at, light) as f32
            }
            _ => self.probability_of_infinite(light),
        }
    }
}

/// The tree, 0, or the place of one of the others, from 1 on; its probability, and what is left of `u`.
#[inline(always)]
fn sample_branch(branch: &Discrete, infinite: &[u32], u: f32) -> (usize, f32, f32) {
    if infinite.is_empty() {
        // What `branch` says as well, without a search.
        (0, 1.0, u)
    } else {
        branch.sample(u)
    }
}

/// A number of 24 bits with 29 more, which are a hash of it and the point: a light of many is chosen with a smaller probability than 2⁻²⁴, and
/// what is left of the number within its share would have no digits.
#[inline(always)]
fn finer(u: f32, p: Vec3<f32>) -> f64 {
    let mut h = u64::from(u.to_bits()) << 32 | u64::from(p.x.to_bits());
    h ^= (u64::from(p.y.to_bits()) << 32 | u64::from(p.z.to_bits())).rotate_left(17);
    // The finalizer of SplitMix64 (Steele, Lea and Flood 2014).
    h = (h ^ (h >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    h = (h ^ (h >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    h ^= h >> 31;
    // Multiples of 2⁻⁵³ below 2⁻²⁴.
    let low = (h >> 35) as f64 * (1.0 / (1_u64 << 53) as f64);
    f64::from(u) + low
}

struct Choose<'a> {
    choice: &'a Choice,
    at: &'a Receiver,
    u: f32,
}

impl Kernel for Choose<'_> {
    type Output = Option<Chosen>;
    #[inline(always)]
    fn run<const L: usize>(self) -> Self::Output {
        self.choice.choose_here(self.at, self.u)
    }
}

struct ChooseMany<'a> {
    choice: &'a Choice,
    from: &'a Surfaces,
    normals: &'a Vectors,
    u: &'a [f32],
    walks: &'a mut Walks,
    chosen: &'a mut [Chosen],
}

impl Kernel for ChooseMany<'_> {
    type Output = ();
    #[inline(always)]
    fn run<const L: usize>(self) {
        match self.choice {
            Choice::None => {}
            // There is but one, and nothing of the number is used up.
            Choice::Mixed(lights) if lights.len() == 1 => {
                for (chosen, &u) in self.chosen.iter_mut().zip(self.u) {
                    *chosen = Chosen::whole((0, 1.0, u));
                }
            }
            Choice::Mixed(lights) => {
                for (chosen, &u) in self.chosen.iter_mut().zip(self.u) {
                    *chosen = Chosen::whole(lights.sample(u));
                }
            }
            Choice::Power(lights) => {
                for (i, (chosen, &u)) in self.chosen.iter_mut().zip(self.u).enumerate() {
                    *chosen = Chosen::by_power(lights, finer(u, self.from.p.get(i)));
                }
            }
            Choice::Uniform {
                shining,
                probabilities,
            } => {
                for (i, (chosen, &u)) in self.chosen.iter_mut().zip(self.u).enumerate() {
                    let u = finer(u, self.from.p.get(i));
                    *chosen = Chosen::uniform(shining, probabilities, u);
                }
            }
            Choice::Tree {
                tree,
                branch,
                infinite,
                ..
            } => {
                self.walks.clear();
                for (i, (chosen, &u)) in self.chosen.iter_mut().zip(self.u).enumerate() {
                    let (index, probability, rest) = sample_branch(branch, infinite, u);
                    if index > 0 {
                        let light = infinite[index - 1] as usize;
                        *chosen = Chosen::whole((light, probability, rest));
                    } else {
                        self.walks.push(i as u32, finer(rest, self.from.p.get(i)));
                    }
                }
                let points = Points {
                    p: &self.from.p,
                    normals: self.normals,
                };
                let mut choices = OfTree {
                    probability: branch.probability(0),
                    chosen: self.chosen,
                };
                tree.choose_many::<L>(points, self.walks, &mut choices);
            }
        }
    }
}

/// Where the lights go that the tree chooses.
struct OfTree<'a> {
    /// With which the tree was chosen.
    probability: f32,
    chosen: &'a mut [Chosen],
}

impl Choices for OfTree<'_> {
    #[inline(always)]
    fn found(&mut self, point: u32, found: &Found) {
        self.chosen[point as usize] = Chosen::below(self.probability, found);
    }
}

/// The power that a light sends into the scene, weighted by luminance \[W].
pub(super) fn power(light: &Light, geometry: &Geometry) -> f64 {
    // A scene without extent still has lights to choose from.
    let radius = f64::from(geometry.bounds().radius()).max(1e-6);
    let cross_section = PI * radius * radius;
    match light {
        Light::Directional { irradiance, .. } => cross_section * luminance(*irradiance),
        Light::Environment(e) => cross_section * spherical_integral(e),
        _ => flux(light, geometry).map_or(0.0, |(rgb, factor)| factor * luminance(rgb)),
    }
}

/// What a light emits, and the factor that makes radiant flux of it \[W]: the intensity and 4π for a point light, or the solid angle of a
/// spot light's cone; the radiance and π A for each side of an area light. Nothing for a light that is infinitely far away.
pub(super) fn flux(light: &Light, geometry: &Geometry) -> Option<([f32; 3], f64)> {
    match light {
        Light::Point { intensity, .. } => Some((*intensity, 4.0 * PI)),
        Light::Spot {
            intensity, cone, ..
        } => Some((*intensity, cone.solid_angle())),
        Light::Area {
            instance,
            radiance,
            two_sided,
        } => {
            let sides = if *two_sided { 2.0 } else { 1.0 };
            let area = f64::from(geometry.area(*instance));
            Some((*radiance, sides * PI * area))
        }
        Light::Directional { .. } | Light::Environment(_) => None,
    }
}

/// ∫ L dω of the luminance over the sphere, by 256 stratified samples of the environment's own density.
fn spherical_integral(e: &Environment) -> f64 {
    const SIDE: u32 = 16;
    let mut sum = 0.0;
    for i in 0..SIDE * SIDE {
        let u = [i % SIDE, i / SIDE].map(|k| (k as f32 + 0.5) / SIDE as f32);
        let s = e.sample(u);
        if s.pdf > 0.0 {
            sum += luminance(s.radiance) / f64::from(s.pdf);
        }
    }
    sum / f64::from(SIDE * SIDE)
}

/// Whether a light of this power is one to choose.
fn shines(power: f64) -> bool {
    power > 0.0 && power.is_finite()
}

/// Of the powers of lights that shine the largest, and what they are together, relative to it.
fn largest_and_total(powers: &[f64]) -> (f64, f64) {
    let shining = || powers.iter().copied().filter(|&p| shines(p));
    let largest = shining().fold(0.0, f64::max);
    (largest, shining().map(|p| p / largest).sum())
}

/// ½ Φᵢ/ΣΦ + ½ 1/n over the n lights with power; 0 for the others.
pub(super) fn probabilities(powers: &[f64]) -> Vec<f32> {
    let (largest, total) = largest_and_total(powers);
    let count = powers.iter().filter(|&&p| shines(p)).count() as f64;
    powers
        .iter()
        .map(|&p| {
            if shines(p) {
                (0.5 * (p / largest) / total + 0.5 / count) as f32
            } else {
                0.0
            }
        })
        .collect()
}

/// Φᵢ/ΣΦ over the lights with power, and no less than the smallest number there is, so that none of them is impossible; 0 for the others.
pub(super) fn shares(powers: &[f64]) -> Vec<f32> {
    let (largest, total) = largest_and_total(powers);
    powers
        .iter()
        .map(|&p| {
            if shines(p) {
                (((p / largest) / total) as f32).max(f32::MIN_POSITIVE)
            } else {
                0.0
            }
        })
        .collect()
}
