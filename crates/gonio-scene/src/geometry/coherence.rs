//! [`are_coherent`], whether rays go nearly the same way, as those of a camera do.

use gonio_num::Vectors;

/// Neighbours that are compared.
const GROUP: usize = 8;
/// Groups that are looked at, to tell whether rays are coherent.
const PROBES: usize = 16;
/// The least cosine between directions that go nearly the same way: 3.6°.
const SAME_WAY: f32 = 0.998;
/// How far apart, relative to the scene, rays start that start nearly at the same place.
const SAME_PLACE: f32 = 0.01;

/// Whether most groups of neighbours among the rays go nearly the same way from nearly the same place. Only time depends on it.
pub(crate) fn are_coherent(rays: [&Vectors; 2], extent: f32) -> bool {
    let groups = rays[0].len() / GROUP;
    let step = groups.div_ceil(PROBES).max(1);
    let (mut looked, mut coherent) = (0, 0);
    for first in (0..groups).step_by(step).map(|g| g * GROUP) {
        let [o, d] = rays.map(|v| v.get(first));
        let last = first + GROUP - 1;
        let like = |i: usize| {
            let [p, e] = rays.map(|v| v.get(i));
            let longest = (d.length_squared() * e.length_squared()).sqrt();
            d.dot(e) > SAME_WAY * longest && (p - o).length() < SAME_PLACE * extent
        };
        looked += 1;
        coherent += usize::from(like(first + 1) && like(first + GROUP / 2) && like(last));
    }
    4 * coherent > 3 * looked
}
