//! From each layout and convention to each: orientation, flux, seams, exact copies.

use gonio_env::projection::cube::LOOKED_UP;
use gonio_env::test_image::{
    DOT, FACES, LABEL_HEIGHT, LABEL_WIDTH, label_dot, six_axes, six_axes_of,
};
use gonio_env::{
    Convention, Conversion, EnvError, Environment, Filter, Layout, Panorama, View, rotation_deg,
};
use gonio_image::Image;
use gonio_num::{Real, Vec3};

/// Rows that resolve a label's dots; of a cube, those of a face.
fn size(layout: Layout) -> usize {
    match layout {
        Layout::LatLong => 128,
        Layout::MirrorBall => 512,
        layout if layout.arrangement().is_some() => 64,
        _ => 256,
    }
}

/// How many dots of the labels, and of the plain surface around them, are wrong in the picture. The ball's photograph can't
/// resolve what is around −z: `blind` is whether one was on the way.
fn wrong_dots(panorama: &Panorama, blind: bool) -> usize {
    let image = panorama.image();
    let mut wrong = 0;
    for face in &FACES {
        for row in 0..LABEL_HEIGHT + 2 {
            for column in 0..LABEL_WIDTH + 2 {
                let x = (column as f64 - 0.5 - 0.5 * LABEL_WIDTH as f64) * DOT;
                let y = (0.5 * LABEL_HEIGHT as f64 + 0.5 - row as f64) * DOT;
                let d = (face.forward + face.right() * x + face.up * y).normalize();
                if blind && d.z < -0.96 {
                    continue;
                }
                let [u, v] = panorama.view().uv(d);
                let at = |c: f64, n: usize| ((c * n as f64) as usize).min(n - 1);
                let (px, py) = (at(u, image.width), at(v, image.height));
                let centre = |p: usize, n: usize| (p as f64 + 0.5) / n as f64;
                if !panorama
                    .layout()
                    .contains([centre(px, image.width), centre(py, image.height)])
                {
                    continue;
                }
                let seen = image.get(px, py);
                let dark = column > 0 && row > 0 && label_dot(face.label, column - 1, row - 1);
                let expected = if dark { [0.0; 3] } else { face.colour };
                wrong += usize::from((0..3).any(|c| (seen[c] - expected[c]).abs() > 0.5));
            }
        }
    }
    wrong
}

fn labelled(layout: Layout) -> Panorama {
    Panorama::new(six_axes(layout, size(layout)), layout, Convention::Gonio)
        .expect("a picture of the layout")
}

fn to(layout: Layout) -> Conversion<'static> {
    Conversion {
        size: Some(size(layout)),
        ..Conversion::to(layout)
    }
}

#[test]
fn labels_survive_every_pair_of_layouts() {
    for from in Layout::ALL {
        for into in Layout::ALL {
            let conversion = Conversion {
                filter: Filter::Nearest,
                ..to(into)
            };
            let made = labelled(from).resampled(&conversion);
            let blind = from == Layout::MirrorBall || into == Layout::MirrorBall;
            let wrong = wrong_dots(&made, blind);
            // Of 702 places. Where texels are coarsest, beside the ball's rim, one on the border of a dot may be the
            // neighbour's; a face that is turned or mirrored makes more than 100.
            assert!(wrong <= 8, "{from} to {into}: {wrong}");
        }
    }
}

#[test]
fn labels_survive_every_convention_and_the_way_back() {
    for convention in Convention::ALL {
        for layout in Layout::ALL {
            let view = View::new(layout, convention);
            let image = six_axes_of(&view, size(layout));
            let panorama = Panorama::new(image.clone(), layout, convention).unwrap();
            let blind = layout == Layout::MirrorBall;
            assert!(wrong_dots(&panorama, blind) <= 2, "{convention} {layout}");
            let own = panorama.resampled(&Conversion {
                filter: Filter::Nearest,
                ..to(Layout::LatLong)
            });
            assert!(wrong_dots(&own, blind) <= 2, "{convention} {layout} read");
            let conversion = Conversion {
                convention,
                filter: Filter::Nearest,
                ..to(layout)
            };
            let back = labelled(Layout::LatLong).resampled(&conversion);
            assert!(
                wrong_dots(&back, blind) <= 2,
                "{convention} {layout} written"
            );
            // Negative control: another convention that differs sees other labels.
            let taken_for_own = Panorama::new(image, layout, Convention::Gonio).unwrap();
            if !view.is_own() {
                assert!(
                    wrong_dots(&taken_for_own, blind) > 100,
                    "{convention} {layout}"
                );
            }
        }
    }
}

#[test]
fn conventions_are_those_of_their_sources() {
    // In the program's own coordinates: what the centre of a panorama shows, and what three quarters of the way to the right.
    // The sources are on the book's page.
    let (x, y, z) = (
        Vec3::new(1.0, 0.0, 0.0),
        Vec3::new(0.0, 1.0, 0.0),
        Vec3::new(0.0, 0.0, 1.0),
    );
    for (convention, centre, right, up) in [
        (Convention::Gonio, -z, x, y),
        (Convention::OpenGl, -z, x, y),
        // u = atan2(x, −z) / 2π.
        (Convention::Mitsuba, z, -x, y),
        // u = 1/2 − atan2(y, x) / 2π.
        (Convention::Blender, x, -y, z),
        // u = 1/2 + atan2(z, x) / 2π.
        (Convention::Gltf, x, z, y),
        // u = atan2(y, x) / 2π.
        (Convention::Pbrt, -x, -y, z),
        // u = 1/2 + atan2(x, −y) / 2π.
        (Convention::Unreal, -y, x, z),
    ] {
        let view = View::new(Layout::LatLong, convention);
        let shows = |u, v| convention.of_world(view.direction([u, v]));
        for (found, expected) in [
            (shows(0.5, 0.5), centre),
            (shows(0.75, 0.5), right),
            (shows(0.5, 0.0), up),
        ] {
            assert!(
                (found - expected).length() < 1e-15,
                "{convention}: {found:?} for {expected:?}"
            );
        }
        for axis in [x, y, z] {
            assert_eq!(convention.to_world(convention.of_world(axis)), axis);
        }
    }
    // pbrt-v4's square: columns along x, rows along y, the zenith in the centre.
    let square = View::new(Layout::EqualAreaOctahedral, Convention::Pbrt);
    for (uv, expected) in [
        ([0.5, 0.5], z),
        ([1.0, 0.5], x),
        ([0.5, 1.0], y),
        ([0.0, 0.0], -z),
    ] {
        let found = Convention::Pbrt.of_world(square.direction(uv));
        assert!((found - expected).length() < 1e-15, "{found:?}");
    }
    // Blender's mirror ball shows in its centre what is behind: its −y.
    let ball = View::new(Layout::MirrorBall, Convention::Blender);
    assert!((Convention::Blender.of_world(ball.direction([0.5, 0.5])) + y).length() < 1e-15);
    // OpenGL's table of faces: the axis and the directions of sc and tc.
    let table = [
        (x, -z, -y),
        (-x, z, -y),
        (y, x, z),
        (-y, x, -z),
        (z, x, -y),
        (-z, -x, -y),
    ];
    for (face, (forward, right, down)) in LOOKED_UP.faces.iter().zip(table) {
        assert_eq!(
            (face.forward, face.right, face.down),
            (forward, right, down)
        );
    }
}

/// Radiance of a sky without fine detail.
fn smooth(d: Vec3<f64>) -> [f32; 3] {
    let warm = 1.0 + 0.6 * d.y + 0.3 * d.x * d.z;
    let sun = Real::exp(4.0 * (d.dot(Vec3::new(0.48, 0.6, -0.64)) - 1.0));
    [warm + 5.0 * sun, 0.8 * warm + 4.0 * sun, 1.4 + d.z].map(|c| c as f32)
}

fn smooth_picture(layout: Layout, rows: usize) -> Panorama {
    let view = View::new(layout, Convention::Gonio);
    let [width, height] = layout.shape().map(|n| n * rows);
    let image = Image::from_fn(width, height, |x, y| {
        smooth(view.direction([
            (x as f64 + 0.5) / width as f64,
            (y as f64 + 0.5) / height as f64,
        ]))
    });
    Panorama::new(image, layout, Convention::Gonio).expect("a picture of the layout")
}

#[test]
fn irradiance_is_kept() {
    for from in Layout::ALL {
        let rows = if from.arrangement().is_some() {
            64
        } else {
            128
        };
        for into in Layout::ALL {
            if from != Layout::LatLong && into != Layout::LatLong {
                continue;
            }
            let conversion = Conversion {
                // A ball's rim shows most of what is behind it in few texels.
                size: Some(match into {
                    Layout::MirrorBall => 192,
                    into if into.arrangement().is_some() => 48,
                    _ => 96,
                }),
                ..Conversion::to(into)
            };
            let (_, kept) = smooth_picture(from, rows).converted(&conversion);
            assert!(
                kept.worst() < 1e-3,
                "{from} to {into}: {:.2e}",
                kept.worst()
            );
        }
    }
}

#[test]
fn a_small_sun_is_not_lost_when_the_picture_shrinks() {
    let mut image = Image::filled(1024, 512, [0.1; 3]);
    image.set(601, 180, [5000.0; 3]);
    let sun = || Panorama::new(image.clone(), Layout::LatLong, Convention::Gonio).unwrap();
    let conversion = Conversion {
        size: Some(32),
        ..Conversion::to(Layout::CubeStrip)
    };
    let (_, kept) = sun().converted(&conversion);
    // The sun's light moves by up to half a new texel, 1.8°, towards the texel's centre: tan 45° · 0.03 = 3 % of its cosine.
    assert!(kept.worst() < 0.03, "{:.2e}", kept.worst());
    // Negative control: one sample a texel misses it.
    let nearest = Conversion {
        filter: Filter::Nearest,
        ..conversion
    };
    assert!(sun().converted(&nearest).1.worst() > 0.2);
}

#[test]
fn seams_are_not_seen() {
    // Interpolation between texels a distance h apart misses a function by h²/8 of its second derivatives, at an edge as
    // elsewhere but for the place of the neighbours along it, at most half a texel, times the first.
    for layout in Layout::ALL {
        let rows = if layout.arrangement().is_some() {
            64
        } else {
            256
        };
        let conversion = Conversion {
            size: Some(256),
            filter: Filter::Bilinear,
            ..Conversion::to(Layout::LatLong)
        };
        let made = smooth_picture(layout, rows).resampled(&conversion);
        let image = made.image();
        let mut worst = 0.0_f32;
        for (i, texel) in image.pixels.iter().enumerate() {
            let uv = [
                ((i % image.width) as f64 + 0.5) / image.width as f64,
                ((i / image.width) as f64 + 0.5) / image.height as f64,
            ];
            let d: Vec3<f64> = made.view().direction(uv);
            // The whole rim of a disc shows one direction, which no picture resolves.
            if layout == Layout::MirrorBall && d.z < -0.9 || layout == Layout::Angular && d.z > 0.99
            {
                continue;
            }
            let truth = smooth(d);
            for c in 0..3 {
                worst = worst.max((texel[c] - truth[c]).abs() / truth[c]);
            }
        }
        assert!(worst < 0.02, "{layout}: {worst}");
    }
}

#[test]
fn what_only_moves_is_copied_exactly() {
    let noise = |n: usize| {
        Image::from_fn(6 * n, n, |x, y| {
            [(x * 31 + y * 17) as f32 % 13.0, x as f32, y as f32]
        })
    };
    let strip = Panorama::new(noise(8), Layout::CubeStrip, Convention::Gonio).unwrap();
    for layout in [
        Layout::CubeCross,
        Layout::CubeCrossVertical,
        Layout::CubeStripVertical,
    ] {
        for convention in Convention::ALL {
            let conversion = Conversion {
                convention,
                ..Conversion::to(layout)
            };
            let (there, kept) = strip.clone().converted(&conversion);
            assert!(
                kept.worst() < 1e-5,
                "{layout} {convention}: {:.1e}",
                kept.worst()
            );
            let (back, _) = there.converted(&Conversion::to(Layout::CubeStrip));
            assert_eq!(back.image(), strip.image(), "{layout} {convention}");
        }
    }
    let image = Image::from_fn(16, 8, |x, y| [x as f32, y as f32, 1.0]);
    let panorama = Panorama::new(image.clone(), Layout::LatLong, Convention::Gonio).unwrap();
    let (turned, _) = panorama.converted(&Conversion {
        rotation: rotation_deg(90.0, 0.0, 0.0),
        ..Conversion::to(Layout::LatLong)
    });
    // Counter-clockwise from above: what was in the centre column is a quarter to the left.
    assert_eq!(turned.image().get(4, 3), image.get(8, 3));
}

#[test]
fn rotations_turn_as_they_say() {
    let at = |yaw, pitch, roll, d: Vec3<f64>| {
        let panorama = labelled(Layout::CubeStrip);
        let turned = panorama.resampled(&Conversion {
            rotation: rotation_deg(yaw, pitch, roll),
            filter: Filter::Nearest,
            ..to(Layout::CubeStrip)
        });
        let [u, v] = turned.view().uv(d);
        let image = turned.image();
        image.get(
            (u * image.width as f64) as usize,
            (v * image.height as f64) as usize,
        )
    };
    // Beside the letters of each face.
    let beside = Vec3::new(-1.0, 0.8, 0.05).normalize();
    // What was in front (−z, yellow) stands on the left.
    assert_eq!(at(90.0, 0.0, 0.0, beside), [1.0, 1.0, 0.0]);
    // What was in front rises to the zenith.
    assert_eq!(
        at(0.0, 90.0, 0.0, Vec3::new(0.05, 1.0, 0.8).normalize()),
        [1.0, 1.0, 0.0]
    );
    // What was on the right (+x, red) rises, as one looks forward.
    assert_eq!(
        at(0.0, 0.0, 90.0, Vec3::new(0.05, 1.0, 0.8).normalize()),
        [1.0, 0.0, 0.0]
    );
}

#[test]
fn levels_halve_and_keep_the_mean() {
    for n in [16, 12] {
        let cube = smooth_picture(Layout::CubeCross, n).cube_map(true).unwrap();
        let sizes: Vec<usize> = cube.levels.iter().map(|faces| faces[0].width).collect();
        assert_eq!(
            sizes,
            if n == 16 {
                vec![16, 8, 4, 2, 1]
            } else {
                vec![12, 6, 3, 1]
            }
        );
        let conversion = Conversion::to(Layout::CubeStrip);
        let of = |k: usize| {
            let level = gonio_image::CubeMap::new(cube.levels[k].clone()).unwrap();
            let strip = Panorama::from_cube(&level, Convention::Gonio).unwrap();
            strip.converted(&conversion).1.before[2][0]
        };
        // From a face of three texels a side or more; its horizon is between texels, or in the middle of one.
        let (coarse, fine) = (of(sizes.len() - 3), of(0));
        assert!(
            (coarse / fine - 1.0).abs() < 0.02,
            "{n}: {coarse} for {fine}"
        );
    }
}

#[test]
fn odd_pictures_have_a_stated_result() {
    let one =
        |rgb| Panorama::new(Image::filled(1, 1, rgb), Layout::LatLong, Convention::Gonio).unwrap();
    for layout in Layout::ALL {
        let conversion = Conversion {
            size: Some(8),
            ..Conversion::to(layout)
        };
        let (white, kept) = one([2.0; 3]).converted(&conversion);
        for (before, after) in kept
            .before
            .iter()
            .flatten()
            .zip(kept.after.iter().flatten())
        {
            // Uniform radiance 2: irradiance 2π. The sums are coarse on eight rows of a disc: parts of them count.
            assert!(
                (before / (2.0 * std::f64::consts::PI) - 1.0).abs() < 1e-3,
                "{layout} {before}"
            );
            assert!((after / before - 1.0).abs() < 1e-2, "{layout} {after}");
        }
        assert!(
            white
                .image()
                .pixels
                .iter()
                .all(|p| p[0] == 0.0 || (p[0] - 2.0).abs() < 1e-6)
        );
        let (black, kept) = one([0.0; 3]).converted(&conversion);
        assert_eq!(kept.worst(), 0.0);
        assert!(kept.ratios().iter().all(Option::is_none));
        assert!(black.image().pixels.iter().flatten().all(|c| *c == 0.0));
        assert_eq!(one([1.0; 3]).matching_size(layout), 1);
    }
    for (layout, width, height) in [
        (Layout::CubeCross, 8, 7),
        (Layout::CubeStrip, 13, 2),
        (Layout::DualParaboloid, 4, 4),
        (Layout::Angular, 4, 2),
        (Layout::LatLong, 0, 2),
    ] {
        let error =
            Panorama::new(Image::new(width, height), layout, Convention::Gonio).unwrap_err();
        assert!(matches!(error, EnvError::Shape { .. }), "{layout}: {error}");
    }
}

#[test]
fn light_made_of_any_layout_is_that_of_the_picture() {
    for layout in Layout::ALL {
        let rows = if layout.arrangement().is_some() {
            64
        } else {
            128
        };
        let env = Environment::from_panorama(smooth_picture(layout, rows)).unwrap();
        let up = env.irradiance(Vec3::new(0.0, 1.0, 0.0))[0];
        let reference = Environment::from_panorama(smooth_picture(Layout::LatLong, 256)).unwrap();
        let expected = reference.irradiance(Vec3::new(0.0, 1.0, 0.0))[0];
        assert!(
            (up / expected - 1.0).abs() < 1e-3,
            "{layout}: {up} for {expected}"
        );
        let info = env.info();
        assert_eq!(info.layout, Some(layout));
        assert_eq!(info.height, layout.shape()[1] * rows);
        let peak = Vec3::new(
            info.peak.direction[0],
            info.peak.direction[1],
            info.peak.direction[2],
        );
        // A texel is up to 4° wide: on the ball.
        assert!(
            peak.dot(Vec3::new(0.48, 0.6, -0.64)) > 0.99,
            "{layout}: {peak:?}"
        );
    }
}
