//! Ray queries on one thread, in rays a second (divan's "items/s"), on two scenes: a bumpy sphere of 998,000 triangles and
//! a soup of 200,000. Pin it to one core to compare: `taskset -c 0 cargo bench -p gonio-scene`.

mod scenes;

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use gonio_scene::{Geometry, Ray, mesh};
use scenes::{incoherent, place, primary, second_bounce, soup_mesh, sphere_mesh};
use std::path::Path;
use std::sync::LazyLock;

fn main() {
    divan::main();
}

static SPHERE: LazyLock<Geometry> = LazyLock::new(|| place(sphere_mesh()));
static SOUP: LazyLock<Geometry> = LazyLock::new(|| place(soup_mesh()));

fn scene(name: &str) -> &'static Geometry {
    if name == "soup" { &SOUP } else { &SPHERE }
}

fn nearest(bencher: Bencher, g: &Geometry, rays: &[Ray]) {
    bencher.counter(ItemsCount::new(rays.len())).bench(|| {
        rays.iter()
            .filter(|r| black_box(g.intersect(r)).is_some())
            .count()
    });
}

fn any(bencher: Bencher, g: &Geometry, rays: &[Ray]) {
    bencher
        .counter(ItemsCount::new(rays.len()))
        .bench(|| rays.iter().filter(|r| black_box(g.occluded(r))).count());
}

#[divan::bench(args = ["sphere", "soup"], sample_count = 9)]
fn a_primary(bencher: Bencher, name: &str) {
    nearest(bencher, scene(name), &primary());
}

#[divan::bench(args = ["sphere", "soup"], sample_count = 9)]
fn b_incoherent(bencher: Bencher, name: &str) {
    nearest(bencher, scene(name), &incoherent());
}

#[divan::bench(args = ["sphere", "soup"], sample_count = 9)]
fn c_second_bounce(bencher: Bencher, name: &str) {
    nearest(bencher, scene(name), &second_bounce(scene(name)));
}

#[divan::bench(args = ["sphere", "soup"], sample_count = 9)]
fn d_any_primary(bencher: Bencher, name: &str) {
    any(bencher, scene(name), &primary());
}

#[divan::bench(args = ["sphere", "soup"], sample_count = 9)]
fn e_any_incoherent(bencher: Bencher, name: &str) {
    any(bencher, scene(name), &incoherent());
}

#[divan::bench(args = ["sphere", "soup"], sample_count = 3)]
fn f_build(bencher: Bencher, name: &str) {
    let make = if name == "soup" {
        soup_mesh
    } else {
        sphere_mesh
    };
    bencher.with_inputs(make).bench_values(place);
}

/// 998,000 triangles of binary PLY.
#[divan::bench(sample_count = 3)]
fn g_read_ply(bencher: Bencher) {
    let mesh = sphere_mesh();
    let mut bytes = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        mesh.positions.len(),
        mesh.indices.len()
    )
    .into_bytes();
    for p in &mesh.positions {
        for x in p.to_array() {
            bytes.extend(x.to_le_bytes());
        }
    }
    for t in &mesh.indices {
        bytes.push(3);
        for i in t {
            bytes.extend(i.to_le_bytes());
        }
    }
    bencher
        .counter(ItemsCount::new(mesh.indices.len()))
        .bench(|| mesh::ply::parse(black_box(&bytes), Path::new("memory")).expect("sound"));
}
