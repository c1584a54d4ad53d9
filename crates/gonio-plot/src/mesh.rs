//! The surface whose distance from the centre is the value in each direction, as triangles that are small where it bends.

use crate::Function;
use crate::curves::direction;
use gonio_num::Vec3;
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

/// Triangles at most.
const MOST: usize = 250_000;
/// Halvings of an edge at most.
const ROUNDS: usize = 22;
/// Edges longer than this, radians, are halved whatever the surface does.
const COARSEST: f64 = 0.14;

/// How closely the surface is followed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Closeness {
    /// How far from the middle of an edge, in the largest radius, the surface may be.
    pub flatness: f64,
    /// Edges shorter than this, radians, are not halved.
    pub finest: f64,
}

impl Closeness {
    /// For a picture to keep.
    pub const FINE: Self = Self {
        flatness: 2e-3,
        finest: 2e-4,
    };
    /// While something is being dragged: a needle's tip may be blunt, and nothing is missed that is wider than a degree.
    pub const QUICK: Self = Self {
        flatness: 1e-2,
        finest: 1e-2,
    };
}

/// Directions are at least this high above the horizon: at it a function may jump to 0.
const HORIZON: f64 = 1e-3;

/// The values of a function over the directions of reflection.
pub(crate) struct Mesh {
    /// Direction and value of each corner.
    pub corners: Vec<(Vec3<f64>, [f64; 3])>,
    /// Three corners each.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// The values of `f`, with the cosine if asked for, for light from `wi`: over the upper hemisphere, and the lower one for what
    /// transmits. `radius` says how long a value is, the largest being 1 for a mesh that is done: it is asked anew in each round, as the largest
    /// value grows.
    pub fn new(
        f: &Function,
        wi: Vec3<f64>,
        cosine: bool,
        radius: &dyn Fn(f64, [f64; 3]) -> f64,
        value: &dyn Fn([f64; 3]) -> f64,
        closeness: Closeness,
    ) -> Self {
        let mut mesh = Self {
            corners: Vec::new(),
            triangles: Vec::new(),
        };
        let sides: &[f64] = if f.transmits() { &[1.0, -1.0] } else { &[1.0] };
        for side in sides {
            mesh.add_hemisphere(f, wi, cosine, *side);
        }
        let lobes = f.lobes(wi);
        let mut tried: Edges<Edge> = Edges::default();
        for _ in 0..ROUNDS {
            let largest = mesh.largest(value);
            mesh.try_edges(f, wi, cosine, &mut tried);
            let place = |w: Vec3<f64>, c: [f64; 3]| w * radius(largest, c);
            let long = |a: Vec3<f64>, b: Vec3<f64>, m: Vec3<f64>| {
                let length = (a - b).length();
                let near = lobes.iter().map(|l| (*l - m).length()).fold(2.0, f64::min);
                length > COARSEST.min(0.4 * near + 2.0 * closeness.finest)
            };
            let mut split: Edges<u32> = Edges::default();
            let mut keys: Vec<(u32, u32)> = mesh.edges();
            keys.sort_unstable();
            keys.dedup();
            for key in keys {
                let Some(edge) = tried.get_mut(&key) else {
                    continue;
                };
                let (a, b) = (mesh.corners[key.0 as usize], mesh.corners[key.1 as usize]);
                let middle = (place(a.0, a.1) + place(b.0, b.1)) * 0.5;
                let off = (place(edge.direction, edge.colour) - middle).length();
                let bent = off > closeness.flatness && (a.0 - b.0).length() > closeness.finest;
                if bent || long(a.0, b.0, edge.direction) {
                    let index = mesh.corners.len() as u32;
                    mesh.corners.push((edge.direction, edge.colour));
                    split.insert(key, index);
                }
            }
            if split.is_empty() || mesh.triangles.len() > MOST {
                break;
            }
            mesh.split(&split);
        }
        mesh
    }

    /// The largest finite value.
    pub fn largest(&self, value: &dyn Fn([f64; 3]) -> f64) -> f64 {
        let values = self.corners.iter().map(|(_, c)| value(*c));
        values.filter(|x| x.is_finite()).fold(0.0, f64::max)
    }

    /// A pyramid of eight sides.
    fn add_hemisphere(&mut self, f: &Function, wi: Vec3<f64>, cosine: bool, side: f64) {
        let first = self.corners.len() as u32;
        let mut directions = vec![Vec3::new(0.0, 0.0, side)];
        for k in 0..8 {
            let w = direction(90.0, 45.0 * f64::from(k));
            directions.push(on_side(w, side));
        }
        let colours = colours(f, wi, cosine, &directions);
        self.corners.extend(directions.into_iter().zip(colours));
        for k in 0..8 {
            let rim = |k: u32| first + 1 + k % 8;
            self.triangles.push(if side > 0.0 {
                [first, rim(k), rim(k + 1)]
            } else {
                [first, rim(k + 1), rim(k)]
            });
        }
    }

    fn edges(&self) -> Vec<(u32, u32)> {
        let of = |t: &[u32; 3]| [key(t[0], t[1]), key(t[1], t[2]), key(t[2], t[0])];
        self.triangles.iter().flat_map(of).collect()
    }

    /// Evaluates the middles of the edges that aren't known, all at once.
    fn try_edges(&self, f: &Function, wi: Vec3<f64>, cosine: bool, tried: &mut Edges<Edge>) {
        let mut new: Vec<(u32, u32)> = self.edges();
        new.retain(|key| !tried.contains_key(key));
        new.sort_unstable();
        new.dedup();
        let middles: Vec<Vec3<f64>> = new
            .iter()
            .map(|(a, b)| {
                let (a, b) = (self.corners[*a as usize].0, self.corners[*b as usize].0);
                on_side((a + b).normalize(), if a.z < 0.0 { -1.0 } else { 1.0 })
            })
            .collect();
        let colours = colours(f, wi, cosine, &middles);
        for ((key, direction), colour) in new.into_iter().zip(middles).zip(colours) {
            tried.insert(key, Edge { direction, colour });
        }
    }

    /// Replaces each triangle by those that its halved edges leave. As both sides of an edge halve it, there are no cracks.
    fn split(&mut self, split: &Edges<u32>) {
        let old = std::mem::take(&mut self.triangles);
        for t in old {
            let half = |k: usize| split.get(&key(t[k], t[(k + 1) % 3])).copied();
            let halves = [half(0), half(1), half(2)];
            match halves {
                [None, None, None] => self.triangles.push(t),
                [Some(a), Some(b), Some(c)] => {
                    self.triangles
                        .extend([[t[0], a, c], [a, t[1], b], [c, b, t[2]], [a, b, c]])
                }
                _ => {
                    // Turned so that the first edge is halved and, of two, the third isn't.
                    let turn = (0..3)
                        .find(|k| halves[*k].is_some() && halves[(k + 2) % 3].is_none())
                        .unwrap_or(0);
                    let [p, q, r] = [0, 1, 2].map(|k| t[(turn + k) % 3]);
                    match (halves[turn], halves[(turn + 1) % 3]) {
                        (Some(a), Some(b)) => {
                            self.triangles.extend([[a, q, b], [p, a, b], [p, b, r]]);
                        }
                        (Some(a), None) => self.triangles.extend([[p, a, r], [a, q, r]]),
                        _ => self.triangles.push(t),
                    }
                }
            }
        }
    }
}

/// By the two corners of an edge.
type Edges<T> = HashMap<(u32, u32), T, BuildHasherDefault<EdgeHasher>>;

/// Fibonacci hashing: the numbers are ours, so nobody chooses them to collide.
#[derive(Default)]
struct EdgeHasher(u64);

impl Hasher for EdgeHasher {
    fn write(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.write_u32(u32::from(*byte));
        }
    }

    fn write_u32(&mut self, x: u32) {
        const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;
        self.0 = (self.0.rotate_left(32) ^ u64::from(x)).wrapping_mul(GOLDEN);
    }

    fn finish(&self) -> u64 {
        // The best bits are the highest; a table takes the lowest.
        self.0.rotate_left(26)
    }
}

/// What is known of the middle of an edge.
struct Edge {
    direction: Vec3<f64>,
    colour: [f64; 3],
}

fn key(a: u32, b: u32) -> (u32, u32) {
    (a.min(b), a.max(b))
}

/// `w`, or the direction just above or below the horizon that is nearest to it.
fn on_side(w: Vec3<f64>, side: f64) -> Vec3<f64> {
    Vec3::new(w.x, w.y, side * (side * w.z).max(HORIZON)).normalize()
}

fn colours(f: &Function, wi: Vec3<f64>, cosine: bool, to: &[Vec3<f64>]) -> Vec<[f64; 3]> {
    let pairs: Vec<_> = to.iter().map(|wo| [wi, *wo]).collect();
    let mut colours = f.eval(&pairs);
    if cosine {
        for (colour, wo) in colours.iter_mut().zip(to) {
            *colour = colour.map(|x| x * wo.z.abs());
        }
    }
    colours
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_num::Real;

    fn of(f: &Function) -> Mesh {
        let radius = |largest: f64, c: [f64; 3]| c[0] / largest.max(1e-300);
        Mesh::new(
            f,
            direction(-40.0, 0.0),
            false,
            &radius,
            &|c| c[0],
            Closeness::FINE,
        )
    }

    /// Each edge belongs to two triangles, but for those of the rim: there are no cracks.
    #[test]
    fn there_are_no_cracks() {
        let spot = direction(40.0, 0.0);
        let f = Function::new("", move |_, wo: Vec3<f64>| {
            [1.0 + 9.0 * Real::exp(-2e4 * (1.0 - wo.dot(spot))); 3]
        });
        let mesh = of(&f);
        let mut count: HashMap<(u32, u32), usize> = HashMap::new();
        for edge in mesh.edges() {
            *count.entry(edge).or_default() += 1;
        }
        for ((a, b), n) in count {
            let at_rim = |k: u32| mesh.corners[k as usize].0.z < 2.0 * HORIZON;
            assert_eq!(n, if at_rim(a) && at_rim(b) { 1 } else { 2 }, "{a} {b}");
        }
    }

    /// The needle of a surface of roughness 0.02 is found and has its height.
    #[test]
    fn a_needle_is_found() {
        let spot = direction(40.0, 0.0);
        let f = Function::new("", move |_, wo: Vec3<f64>| {
            let x2 = 2.0 * (1.0 - wo.dot(spot)) / (4e-4 * 4e-4);
            [1.0 / ((1.0 + x2) * (1.0 + x2)); 3]
        });
        let mesh = of(&f);
        let largest = mesh.largest(&|c| c[0]);
        assert!(largest > 0.9, "{largest}");
        assert!(mesh.triangles.len() < 40_000, "{}", mesh.triangles.len());
    }

    #[test]
    fn a_quick_mesh_is_small_and_near() {
        for width in [1e-4, 1e-2, 0.3] {
            let spot = direction(40.0, 0.0);
            let f = Function::new("", move |_, wo: Vec3<f64>| {
                let x2 = 2.0 * (1.0 - wo.dot(spot)) / (width * width);
                [0.1 + 1.0 / ((1.0 + x2) * (1.0 + x2)); 3]
            });
            let radius = |largest: f64, c: [f64; 3]| c[0] / largest.max(1e-300);
            let of = |closeness| {
                let wi = direction(-40.0, 0.0);
                Mesh::new(&f, wi, false, &radius, &|c| c[0], closeness)
            };
            let (quick, fine) = (of(Closeness::QUICK), of(Closeness::FINE));
            assert!(
                quick.triangles.len() < 3000
                    && 2 * quick.triangles.len() < fine.triangles.len() + 1000,
                "{} {}",
                quick.triangles.len(),
                fine.triangles.len()
            );
            // The tip of what is wider than the shortest edge.
            let tip = |m: &Mesh| m.largest(&|c| c[0]);
            assert!(width < 1e-2 || tip(&quick) > 0.9 * tip(&fine), "{width}");
        }
    }

    /// A sphere of radius 1: the volume of its upper half is 2π/3.
    #[test]
    fn an_even_function_is_a_half_sphere() {
        let mesh = of(&Function::new("", |_, _| [1.0; 3]));
        let volume: f64 = mesh
            .triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|k| mesh.corners[k as usize].0);
                a.dot(b.cross(c)) / 6.0
            })
            .sum();
        let expected = 2.0 * std::f64::consts::PI / 3.0;
        // Chords of 0.14 at most lie within 0.14²/8 of the sphere.
        assert!(
            (volume / expected - 1.0).abs() < 3.0 * 0.14 * 0.14 / 8.0,
            "{volume}"
        );
    }
}
