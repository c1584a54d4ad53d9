//! A conversion holds its picture once: 12 bytes for each texel, a quarter more while it is halved, and some rows.

#![allow(clippy::unwrap_used)]

use gonio_env::{Conversion, Layout, LoadOptions, Panorama};
use gonio_image::{Image, Layers, Store, write_rows};
use std::alloc::{GlobalAlloc, Layout as Block, System};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// Counts the bytes that are allocated, of all threads, and their most.
struct Counting;

static HELD: AtomicUsize = AtomicUsize::new(0);
static MOST: AtomicUsize = AtomicUsize::new(0);

fn more(size: usize) {
    let held = HELD.fetch_add(size, Relaxed) + size;
    MOST.fetch_max(held, Relaxed);
}

// SAFETY: every call goes to `System` unchanged; counting does not allocate. There is no safe way to see allocations.
#[allow(unsafe_code)]
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, block: Block) -> *mut u8 {
        more(block.size());
        unsafe { System.alloc(block) }
    }
    unsafe fn alloc_zeroed(&self, block: Block) -> *mut u8 {
        more(block.size());
        unsafe { System.alloc_zeroed(block) }
    }
    unsafe fn dealloc(&self, p: *mut u8, block: Block) {
        HELD.fetch_sub(block.size(), Relaxed);
        unsafe { System.dealloc(p, block) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// The most bytes that `work` holds beyond those that were there before.
fn most_of(work: impl FnOnce()) -> usize {
    let before = HELD.load(Relaxed);
    MOST.store(before, Relaxed);
    work();
    MOST.load(Relaxed) - before
}

const WIDTH: usize = 2048;
const HEIGHT: usize = 1024;
const PICTURE: usize = 12 * WIDTH * HEIGHT;

/// Rows of the old and of the new picture that are on their way: 4 blocks of 16 with two threads, or 64 rows, in up to four forms
/// (samples of the file, as they were compressed, pixels, lines) of 12 bytes, and codecs' tables.
fn on_their_way(new_width: usize) -> usize {
    4 * 64 * 12 * WIDTH.max(new_width) + (1 << 20)
}

fn convert(from: &Path, to: &Path, conversion: &Conversion<'_>, twice: bool) {
    let panorama = Panorama::load(from, &LoadOptions::default()).unwrap();
    let kept = twice.then(|| panorama.clone());
    let mut rows = panorama.into_rows(conversion);
    let store = match to.extension().unwrap().to_str() {
        Some("hdr") => Store::Hdr,
        _ => Store::ExrFloat,
    };
    write_rows(to, rows.size(), store, &mut |first, texels| {
        rows.make(first, texels);
        Ok(())
    })
    .unwrap();
    assert!(rows.kept().worst() < 1e-3, "{:?}", rows.kept());
    drop(kept);
}

#[test]
fn a_conversion_holds_its_picture_once() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let image = Image::from_fn(WIDTH, HEIGHT, |x, y| {
        let (u, v) = (x as f32 / WIDTH as f32, y as f32 / HEIGHT as f32);
        [
            0.5 + u * (1.0 - u),
            1.0 - 0.5 * v,
            0.25 + ((x * 7 + y * 13) % 32) as f32 / 64.0,
        ]
    });
    image.write(&at("in.hdr")).unwrap();
    let halves = Layers::from_image(&image).to_half();
    halves.write_exr(&at("in.exr")).unwrap();
    drop((image, halves));
    // What is on its way depends on the number of threads.
    let threads = rayon::ThreadPoolBuilder::new().num_threads(2).build();
    threads.unwrap().install(|| {
        for (from, to, layout, size) in [
            ("in.exr", "out.hdr", Layout::LatLong, 512),
            ("in.hdr", "out.exr", Layout::Octahedral, 512),
            // Small enough to have the old picture halved first.
            ("in.exr", "out.exr", Layout::CubeStrip, 64),
        ] {
            let conversion = Conversion {
                size: Some(size),
                ..Conversion::to(layout)
            };
            let new_width = layout.shape()[0] * size;
            let halved = if size < 256 { PICTURE / 4 } else { 0 };
            let bound = PICTURE + halved + on_their_way(new_width);
            // The bound would not notice less than half a picture more: that of halves, say.
            assert!(on_their_way(new_width) < PICTURE / 2);
            let name = format!("{from} to {layout} of {size} in {to}");
            let most = most_of(|| convert(&at(from), &at(to), &conversion, false));
            println!(
                "{name}: {:.3} of a picture, at most {:.3}",
                most as f64 / PICTURE as f64,
                bound as f64 / PICTURE as f64
            );
            assert!(
                most <= bound,
                "{name}: {most} bytes, at most {bound} expected"
            );
        }
        // What would be more than the bound.
        let conversion = Conversion {
            size: Some(64),
            ..Conversion::to(Layout::CubeStrip)
        };
        let most = most_of(|| convert(&at("in.hdr"), &at("out.hdr"), &conversion, true));
        let bound = PICTURE + PICTURE / 4 + on_their_way(WIDTH);
        assert!(most > bound, "held twice, it is {most} bytes");
    });
}
