//! Fireflies: light that a lamp sends by way of a mirror, which is found by chance alone.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod support;

use gonio_image::Image;
use gonio_num::{Affine3, Vec3};
use gonio_render::{Film, Kept, RenderOptions};
use gonio_scene::{Scene, SceneBuilder, Shape};
use support::*;

const SIDE: u32 = 48;

/// A floor, a mirrored ball beside it, and a lamp: what the ball throws onto the floor is met by few paths.
fn scene(mirrored: bool) -> Scene {
    let mut scene = SceneBuilder::new("fireflies");
    let grey = material("lambertian:reflectance=0.6");
    add(&mut scene, Shape::Rectangle, floor(0.0, 20.0), grey);
    let ball = material(if mirrored {
        "mirror"
    } else {
        "lambertian:reflectance=0.6"
    });
    let beside =
        Affine3::scale(Vec3::splat(1.0)).then(&Affine3::translation(Vec3::new(2.2, 1.0, 0.0)));
    add(&mut scene, Shape::Sphere, beside, ball);
    let lamp = emitter("lambertian:reflectance=0", [50.0; 3]);
    add(&mut scene, Shape::Rectangle, ceiling(6.0, 0.6), lamp);
    scene.build().unwrap()
}

fn taken(scene: &Scene, side: u32, spp: u32) -> Film {
    let options = RenderOptions {
        keep: Kept {
            reweighted: true,
            ..Kept::NOTHING
        },
        ..options(INTEGRATORS[1], SAMPLERS[0], side, spp)
    };
    picture(scene, &camera_above(5.0, 20.0), &options)
}

/// The brightest pixel over the mean of all.
fn peak(image: &Image) -> f32 {
    let all = image.pixels.iter().map(|p| p[0]);
    let mean = all.clone().sum::<f32>() / all.len() as f32;
    all.fold(0.0, f32::max) / mean
}

/// In a floor that is lit evenly to within a factor of two no pixel is three times as bright as the mean: one firefly adds a quarter of a pixel's
/// brightness, and so would have to be met eight times in a window. The control: the mean of all samples is far beyond that.
#[test]
fn fireflies_are_gone() {
    let film = taken(&scene(true), SIDE, 16);
    let (plain, found) = (peak(&film.image()), peak(&film.reweighted().unwrap()));
    println!("the brightest pixel: {plain} of the mean, reweighted {found}");
    assert!(found < 3.0, "{found}");
    assert!(plain > 3.0, "{plain}");
}

/// Where nothing is rare, the picture is the mean: it is darker by no more than a rounding, 2⁻³² of 9/8 of the upper level of the brightest sample, and the
/// last bits of the results. Fewer than κ samples of a kind there are at the border of what is lit, if anywhere: in fewer pixels than a side has.
#[test]
fn a_picture_without_fireflies_stays() {
    let film = taken(&scene(false), SIDE, 64);
    let (plain, found) = (film.image(), film.reweighted().unwrap());
    let brightest = plain.pixels.iter().map(|p| p[0]).fold(0.0, f32::max);
    let rounding = 64.0 * 2.0_f32.powi(-32) * 1.125 * 8.0 * brightest;
    let off =
        |(a, b): (&[f32; 3], &[f32; 3])| (a[0] - b[0]).abs() > rounding + 2.0 * f32::EPSILON * a[0];
    let differ = plain
        .pixels
        .iter()
        .zip(&found.pixels)
        .filter(|p| off(*p))
        .count();
    println!("{differ} of {} pixels differ", SIDE * SIDE);
    assert!(differ < SIDE as usize, "{differ}");
    // The control.
    let film = taken(&scene(true), SIDE, 64);
    let (plain, found) = (film.image(), film.reweighted().unwrap());
    let differ = plain
        .pixels
        .iter()
        .zip(&found.pixels)
        .filter(|p| off(*p))
        .count();
    assert!(differ > SIDE as usize, "{differ}");
}
