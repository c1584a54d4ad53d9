//! Ray queries against Embree 4, in turn, in one run: million rays a second, medians, and their ratio.
//!
//! `GONIO_EMBREE=…/libembree4.so cargo bench -p gonio-scene --bench embree`; the Python package `embreex` carries the library. Embree is
//! asked ray by ray (`rtcIntersect1`, `rtcOccluded1`), Gonio ray by ray and in waves of 1024 (`intersect_many`). Only this bench has unsafe code for it: the
//! declarations are those of the API of version 4, the structures have its sizes with room to spare, and buffers live until the scene is released.
#![allow(unsafe_code)]

mod scenes;

use gonio_num::Vectors;
use gonio_scene::{Geometry, Ray, TriangleMesh};
use libloading::{Library, Symbol};
use std::ffi::c_void;
use std::hint::black_box;
use std::time::Instant;

type Handle = *mut c_void;

/// `RTCRayHit`: 48 bytes of `RTCRay`, then `RTCHit`.
#[derive(Clone, Copy)]
#[repr(C, align(16))]
struct RayHit {
    origin: [f32; 3],
    near: f32,
    direction: [f32; 3],
    time: f32,
    far: f32,
    mask: u32,
    id: u32,
    flags: u32,
    hit: [u32; 12],
}

/// Where `RTCHit` has its geomID, in words.
const GEOMETRY: usize = 6;
const INVALID: u32 = u32::MAX;

impl RayHit {
    fn new(ray: &Ray) -> Self {
        Self {
            origin: ray.origin.to_array(),
            near: 0.0,
            direction: ray.direction.to_array(),
            time: 0.0,
            far: ray.t_max,
            mask: u32::MAX,
            id: 0,
            flags: 0,
            hit: [INVALID; 12],
        }
    }
}

/// Embree's scene of one mesh.
struct Embree<'a> {
    scene: Handle,
    intersect: Symbol<'a, unsafe extern "C" fn(Handle, *mut RayHit, *const c_void)>,
    occluded: Symbol<'a, unsafe extern "C" fn(Handle, *mut RayHit, *const c_void)>,
}

impl<'a> Embree<'a> {
    fn new(library: &'a Library, mesh: &TriangleMesh) -> Result<Self, libloading::Error> {
        const INDEX: i32 = 0;
        const VERTEX: i32 = 1;
        const UINT3: i32 = 0x5003;
        const FLOAT3: i32 = 0x9003;
        const TRIANGLE: i32 = 0;
        // SAFETY: the signatures are those of rtcore_device.h, rtcore_geometry.h and rtcore_scene.h.
        unsafe {
            let device: Symbol<'_, unsafe extern "C" fn(*const u8) -> Handle> =
                library.get(b"rtcNewDevice")?;
            let new_scene: Symbol<'_, unsafe extern "C" fn(Handle) -> Handle> =
                library.get(b"rtcNewScene")?;
            let new_geometry: Symbol<'_, unsafe extern "C" fn(Handle, i32) -> Handle> =
                library.get(b"rtcNewGeometry")?;
            let set_new_buffer: Symbol<
                '_,
                unsafe extern "C" fn(Handle, i32, u32, i32, usize, usize) -> *mut u8,
            > = library.get(b"rtcSetNewGeometryBuffer")?;
            let commit_geometry: Symbol<'_, unsafe extern "C" fn(Handle)> =
                library.get(b"rtcCommitGeometry")?;
            let attach: Symbol<'_, unsafe extern "C" fn(Handle, Handle) -> u32> =
                library.get(b"rtcAttachGeometry")?;
            let commit_scene: Symbol<'_, unsafe extern "C" fn(Handle)> =
                library.get(b"rtcCommitScene")?;
            let device = device(c"threads=1".as_ptr().cast());
            let scene = new_scene(device);
            let geometry = new_geometry(device, TRIANGLE);
            // Embree makes the buffers, of the size that is filled here.
            let vertices = set_new_buffer(geometry, VERTEX, 0, FLOAT3, 12, mesh.positions.len());
            for (i, p) in mesh.positions.iter().enumerate() {
                vertices
                    .add(12 * i)
                    .cast::<[f32; 3]>()
                    .write_unaligned(p.to_array());
            }
            let indices = set_new_buffer(geometry, INDEX, 0, UINT3, 12, mesh.indices.len());
            for (i, t) in mesh.indices.iter().enumerate() {
                indices.add(12 * i).cast::<[u32; 3]>().write_unaligned(*t);
            }
            commit_geometry(geometry);
            attach(scene, geometry);
            commit_scene(scene);
            Ok(Self {
                scene,
                intersect: library.get(b"rtcIntersect1")?,
                occluded: library.get(b"rtcOccluded1")?,
            })
        }
    }

    fn nearest(&self, rays: &[Ray]) -> usize {
        let hit = |ray: &Ray| {
            let mut query = RayHit::new(ray);
            // SAFETY: the scene is committed; the structure is as large as the API's.
            unsafe { (self.intersect)(self.scene, &raw mut query, std::ptr::null()) };
            query.hit[GEOMETRY] != INVALID
        };
        rays.iter().filter(|ray| black_box(hit(ray))).count()
    }

    fn any(&self, rays: &[Ray]) -> usize {
        let hit = |ray: &Ray| {
            let mut query = RayHit::new(ray);
            // SAFETY: as above; `RTCRay` is its front part.
            unsafe { (self.occluded)(self.scene, &raw mut query, std::ptr::null()) };
            query.far < 0.0
        };
        rays.iter().filter(|ray| black_box(hit(ray))).count()
    }
}

// SAFETY: Embree's queries of a committed scene may be made from any thread.
unsafe impl Sync for Embree<'_> {}

/// Rays in waves, as a renderer has them.
fn waves(rays: &[Ray]) -> Vec<(Vectors, Vectors, Vec<f32>)> {
    let wave = |rays: &[Ray]| {
        let (mut o, mut d) = (Vectors::default(), Vectors::default());
        o.resize(rays.len());
        d.resize(rays.len());
        for (i, ray) in rays.iter().enumerate() {
            o.set(i, ray.origin);
            d.set(i, ray.direction);
        }
        (o, d, rays.iter().map(|r| r.t_max).collect())
    };
    rays.chunks(1024).map(wave).collect()
}

/// Million rays a second of a query on `threads` threads, each with a part of the rays.
fn rate<T: Sync>(
    threads: usize,
    rays: usize,
    items: &[T],
    query: impl Fn(&[T]) -> usize + Sync,
) -> (f64, usize) {
    let start = Instant::now();
    let part = items.len().div_ceil(threads);
    let hits = std::thread::scope(|scope| {
        let parts: Vec<_> = items
            .chunks(part)
            .map(|p| scope.spawn(|| query(p)))
            .collect();
        parts
            .into_iter()
            .map(|p| p.join().expect("no query panics"))
            .sum()
    });
    (rays as f64 / 1e6 / start.elapsed().as_secs_f64(), hits)
}

fn median(mut rates: Vec<f64>) -> f64 {
    rates.sort_by(f64::total_cmp);
    rates[rates.len() / 2]
}

fn compare(name: &str, geometry: &Geometry, embree: &Embree<'_>) {
    let sets = [
        ("primary", scenes::primary()),
        ("incoherent", scenes::incoherent()),
        ("second bounce", scenes::second_bounce(geometry)),
    ];
    // `cargo bench … -- primary` runs the sets of that name only.
    let asked = std::env::args().nth(1).filter(|a| !a.starts_with('-'));
    let wanted = |set: &str| asked.as_ref().is_none_or(|a| set.contains(a.as_str()));
    for (set, rays) in sets.iter().filter(|(set, _)| wanted(set)) {
        let waves = waves(rays);
        for any in [false, true] {
            for threads in [1, 2] {
                let mut rates = [const { Vec::new() }; 3];
                let mut hits = [0; 3];
                for _ in 0..7 {
                    let single = |rays: &[Ray]| {
                        let hit = |r: &&Ray| {
                            black_box(if any {
                                geometry.occluded(r)
                            } else {
                                geometry.intersect(r).is_some()
                            })
                        };
                        rays.iter().filter(hit).count()
                    };
                    let many = |waves: &[(Vectors, Vectors, Vec<f32>)]| {
                        let (mut hits, mut hidden, mut count) = (Vec::new(), Vec::new(), 0);
                        for (o, d, ends) in waves {
                            if any {
                                geometry.occluded_many([o, d], ends, &mut hidden);
                                count += hidden.iter().filter(|h| **h).count();
                            } else {
                                geometry.intersect_many([o, d], &mut hits);
                                count += hits.iter().filter(|h| h.t < f32::INFINITY).count();
                            }
                        }
                        count
                    };
                    let theirs = |rays: &[Ray]| {
                        if any {
                            embree.any(rays)
                        } else {
                            embree.nearest(rays)
                        }
                    };
                    let n = rays.len();
                    for (k, (rate, hit)) in [
                        rate(threads, n, rays, theirs),
                        rate(threads, n, rays, single),
                        rate(threads, n, &waves, many),
                    ]
                    .into_iter()
                    .enumerate()
                    {
                        rates[k].push(rate);
                        hits[k] = hit;
                    }
                }
                let [theirs, single, many] = rates.map(median);
                let query = if any { "any" } else { "nearest" };
                println!(
                    "| {name} | {set} | {query} | {threads} | {theirs:.2} | {single:.2} | {many:.2} | {:.2} | {:.2} | {} {} |",
                    single / theirs,
                    many / theirs,
                    hits[0],
                    hits[2]
                );
            }
        }
    }
}

fn main() {
    let Some(path) = std::env::var_os("GONIO_EMBREE") else {
        println!(
            "GONIO_EMBREE is not set: the path of libembree4.so, which `pip install embreex` brings; nothing is compared"
        );
        return;
    };
    // SAFETY: Embree's initialisers do nothing unusual.
    let library =
        unsafe { Library::new(&path) }.unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    // Never unloaded: its threads outlive this function.
    let library: &'static Library = Box::leak(Box::new(library));
    println!(
        "| scene | rays | query | threads | Embree, million a second | Gonio, one by one | Gonio, many | ratio | ratio, many | hits |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for (name, mesh) in [
        ("sphere, 998k", scenes::sphere_mesh()),
        ("soup, 200k", scenes::soup_mesh()),
    ] {
        let embree =
            Embree::new(library, &mesh).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        compare(name, &scenes::place(mesh), &embree);
    }
}
