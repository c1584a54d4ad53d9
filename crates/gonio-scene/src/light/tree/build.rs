//! How a [`LightTree`] is built: from the root down, each node by splits in two until it has eight parts.

use super::bounds::{COLUMNS, LightBounds};
use super::source::{Source, Summary, bounds_of, summary};
use super::{LEAF, Leaf, LightTree, NONE, Node, WIDTH};
use crate::Aabb;
use crate::light::WHOLE;
use std::ops::Range;

/// Places at which an axis may be split, plus 1.
const BINS: usize = 12;

/// The tree of these sources, two or more, of `count` lights.
pub(super) fn build(mut sources: Vec<Source>, count: usize) -> LightTree {
    let whole = summary(&sources);
    let scale = whole.bounds.radius().max(f32::MIN_POSITIVE.sqrt());
    let brightest = sources.iter().map(|s| s.all.power).fold(0.0, f64::max);
    let mut tree = LightTree {
        nodes: Vec::new(),
        leaves: Vec::new(),
        first: vec![NONE; count],
        leaf_of: Vec::new(),
    };
    let mut open = vec![(0..sources.len(), (NONE, 0))];
    while let Some((range, parent)) = open.pop() {
        let index = tree.nodes.len() as u32;
        if parent.0 != NONE {
            tree.nodes[parent.0 as usize].children[parent.1 as usize] = index;
        }
        let mut node = Node {
            bounds: [[0.0; WIDTH]; COLUMNS],
            children: [NONE; WIDTH],
            parent,
        };
        let parts = split_in_eight(&mut sources, range);
        for slot in 0..WIDTH {
            let bounds = match parts.get(slot) {
                None => LightBounds::NONE,
                Some(part) => bounds_of(&sources[part.clone()], scale, brightest),
            };
            for (column, value) in node.bounds.iter_mut().zip(bounds.columns()) {
                column[slot] = value;
            }
        }
        for (slot, part) in parts.into_iter().enumerate() {
            let place = (index, slot as u32);
            if part.len() > 1 {
                open.push((part, place));
                continue;
            }
            node.children[slot] = LEAF | tree.leaves.len() as u32;
            let source = &sources[part.start];
            tree.leaves.push(Leaf {
                light: source.light,
                primitive: source.primitive,
                parent: place,
            });
        }
        tree.nodes.push(node);
    }
    index_leaves(&mut tree);
    tree
}

/// Notes where each light and each triangle is.
fn index_leaves(tree: &mut LightTree) {
    let mut rooms = vec![0; tree.first.len()];
    for leaf in &tree.leaves {
        let last = if leaf.primitive == WHOLE {
            0
        } else {
            leaf.primitive
        };
        let room = &mut rooms[leaf.light as usize];
        *room = (*room).max(last + 1);
    }
    let mut end = 0;
    for (first, room) in tree.first.iter_mut().zip(rooms) {
        if room > 0 {
            *first = end;
            end += room;
        }
    }
    tree.leaf_of = vec![NONE; end as usize];
    for (i, leaf) in tree.leaves.iter().enumerate() {
        let offset = if leaf.primitive == WHOLE {
            0
        } else {
            leaf.primitive
        };
        tree.leaf_of[(tree.first[leaf.light as usize] + offset) as usize] = i as u32;
    }
}

/// Splits, each time, the part that costs most.
fn split_in_eight(sources: &mut [Source], range: Range<usize>) -> Vec<Range<usize>> {
    let cost = |sources: &[Source], part: &Range<usize>| summary(&sources[part.clone()]).cost();
    let mut parts = vec![(cost(sources, &range), range)];
    while parts.len() < WIDTH {
        let most = (0..parts.len())
            .filter(|&i| parts[i].1.len() > 1)
            .max_by(|&a, &b| parts[a].0.total_cmp(&parts[b].0));
        let Some(most) = most else {
            break;
        };
        let part = parts[most].1.clone();
        let middle = part.start + split_in_two(&mut sources[part.clone()]);
        let halves = [part.start..middle, middle..part.end];
        let [a, b] = halves.map(|half| (cost(sources, &half), half));
        parts[most] = a;
        parts.push(b);
    }
    parts.into_iter().map(|(_, part)| part).collect()
}

/// Orders two or more sources so that the first ones and the others are two good parts; the number of the first ones.
///
/// Source: Conty Estévez & Kulla 2018, section 4.4: of all axes and twelve bins, the split of least cost, weighted by the ratio of the
/// longest side to that of the axis, so that thin parts are avoided.
fn split_in_two(sources: &mut [Source]) -> usize {
    let centres = Aabb::around(sources.iter().map(|s| s.centre));
    let sides = centres.diagonal().to_array();
    let longest = sides.into_iter().fold(0.0, f32::max);
    let mut best: Option<(f64, usize, usize)> = None;
    for axis in 0..3 {
        // 0 or not finite: there is nothing to tell them apart by.
        if !(sides[axis] > 0.0 && sides[axis].is_finite()) {
            continue;
        }
        let mut bins: [Option<Summary>; BINS] = [None; BINS];
        for source in sources.iter() {
            let bin = &mut bins[bin_of(source, &centres, axis)];
            *bin = joined(bin, &Some(source.all));
        }
        let thin = f64::from(longest / sides[axis]);
        let mut above = [0.0; BINS];
        let mut rest = None;
        for i in (1..BINS).rev() {
            rest = joined(&rest, &bins[i]);
            above[i] = rest.map_or(0.0, |s| s.cost());
        }
        let mut below = None;
        for i in 1..BINS {
            below = joined(&below, &bins[i - 1]);
            let cost = thin * (below.map_or(0.0, |s: Summary| s.cost()) + above[i]);
            let parts = bins[i..].iter().any(Option::is_some);
            if below.is_some() && parts && best.is_none_or(|(least, ..)| cost < least) {
                best = Some((cost, axis, i));
            }
        }
    }
    let Some((_, axis, bin)) = best else {
        return sources.len() / 2;
    };
    // In their order on either side.
    sources.sort_by_key(|s| bin_of(s, &centres, axis) >= bin);
    sources.partition_point(|s| bin_of(s, &centres, axis) < bin)
}

fn joined(a: &Option<Summary>, b: &Option<Summary>) -> Option<Summary> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.union(b)),
        (a, b) => a.or(*b),
    }
}

fn bin_of(source: &Source, centres: &Aabb, axis: usize) -> usize {
    let (c, low) = (source.centre.to_array()[axis], centres.min.to_array()[axis]);
    let side = centres.diagonal().to_array()[axis];
    (((c - low) / side * BINS as f32) as usize).min(BINS - 1)
}
