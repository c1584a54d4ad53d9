//! Whole captures of simulated photographs, against the panorama that they show.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod evidence;

use evidence::*;
use gonio_capture::simulate::{Film, Studio};
use gonio_capture::{
    BallMaterial, CaptureError, KnownLight, Options, Photo, Projection, ResponseChoice, Rotation,
};
use gonio_image::{Image, RawData, RawImage};
use gonio_num::{Real, Vec3};

const STOPS: [f64; 3] = [1.0, 0.125, 0.015_625];
const SIZE: [usize; 2] = [400, 300];

fn dark(_: Vec3<f64>) -> [f64; 3] {
    [0.0; 3]
}

/// A tame sunset: without a sun to clip.
fn shots(studio: &Studio, film: &Film, name: &str) -> Vec<Photo> {
    film.expose(&studio.radiance(&light(&sunset(8.0)), &dark), name)
}

/// An outline that is e pixels too small puts the direction of normal angle β off by 2 e tan β / ρ. Light that continues
/// behind the ball leaves no contrast at the very rim, so the edge is found up to a pixel inside: with ρ = 100 and tan β ≤ 1 for half of
/// the directions at most 1.2°; the median is below half of that, and the 95 % (tan β = 4.4) below 5°.
#[test]
fn directions_and_light_come_back() {
    let studio = near(8.0, SIZE);
    let env = sunset(8.0);
    let found = taken(
        &shots(&studio, &real_film(&STOPS), "come back"),
        &options(&studio),
    )
    .unwrap();
    let e = compare(&found, &[studio], &env);
    assert!(e.direction[0] < 1.2 && e.direction[1] < 5.0, "{e:?}");
    // Vignetting dims the ball's rim by (100/250)² · 10 % = 1.6 %; a misplaced texel of this sky differs by some per cent.
    assert!(e.radiance[0] < 0.1, "{e:?}");
    assert!(e.irradiance < 0.1, "{e:?}");

    // Negative control: ten pixels off is seen in each.
    let [x, y] = ball(&studio).centre();
    let wrong = Options {
        balls: vec![[x + 10.0, y, 100.0]],
        ..options(&studio)
    };
    let off = compare(
        &taken(&shots(&studio, &real_film(&STOPS), "come back"), &wrong).unwrap(),
        &[studio],
        &env,
    );
    assert!(off.direction[0] > 3.0 * e.direction[0], "{off:?} {e:?}");
    assert!(off.radiance[1] > e.radiance[1], "{off:?} {e:?}");
}

/// Exposures between which the camera was knocked come back as those of a tripod do: they are moved by whole pixels, so that a half remains,
/// which turns a direction by 2 · 0.5 tan β / ρ: 0.6° for half of the directions, beside what the outline costs.
#[test]
fn a_knocked_camera_is_noticed_and_made_good() {
    let env = sunset(8.0);
    let studio = near(8.0, SIZE);
    let (photos, seen) = knocked(&studio, &env, &STOPS);
    let found = taken(&photos, &options(&studio)).unwrap();
    let moved = found.notes.iter().filter(|n| n.contains("moved back"));
    assert_eq!(moved.count(), 2, "{:?}", found.notes);
    let e = compare(&found, &[seen], &env);
    assert!(e.direction[0] < 1.8 && e.radiance[0] < 0.1, "{e:?}");
    // A tripod's need nothing.
    let still = shots(&studio, &real_film(&STOPS), "come back");
    let aligned = gonio_capture::align::align(&still, &STOPS, None).unwrap();
    assert_eq!(aligned.photos, None, "{:?}", aligned.shifts);
    // Negative control: merged as they are, exposures contradict each other at every edge.
    let response = gonio_capture::Response::recover(&still, &STOPS).unwrap();
    let edges = |photos: &[Photo]| {
        let merged = gonio_capture::Radiance::merge(photos, &STOPS, &response).unwrap();
        let mut sigma: Vec<f64> = merged.sigma.iter().map(|s| f64::from(*s)).collect();
        quantile(&mut sigma, 0.95)
    };
    let aligned = gonio_capture::align::align(&photos, &STOPS, None).unwrap();
    let (apart, together) = (edges(&photos), edges(&aligned.photos.unwrap()));
    assert!(apart > 1.5 * together, "{apart} {together}");
}

#[test]
fn exposures_of_different_views_are_refused() {
    let studio = near(8.0, SIZE);
    let mut photos = shots(&studio, &real_film(&[0.5]), "one view");
    let turned = Studio {
        rotation: Rotation::of_angles(1.5, 0.15, 0.05),
        ..studio
    };
    photos.extend(shots(&turned, &real_film(&[0.1]), "another"));
    let error = taken(&photos, &options(&studio)).unwrap_err();
    assert!(matches!(error, CaptureError::NotAligned { .. }), "{error}");
    assert!(error.help().unwrap().contains("--views"));
}

#[test]
fn the_same_photographs_give_the_same_bits() {
    let studio = near(8.0, SIZE);
    let photos = shots(&studio, &perfect_film(&[0.1]), "bits");
    let linear = Options {
        response: ResponseChoice::Linear,
        height: 32,
        ..options(&studio)
    };
    let (a, b) = (
        taken(&photos, &linear).unwrap(),
        taken(&photos, &linear).unwrap(),
    );
    assert_eq!(a.panorama.image, b.panorama.image);
    assert_eq!(a.layers().unwrap(), b.layers().unwrap());
    let names: Vec<String> = a
        .layers()
        .unwrap()
        .channels
        .into_iter()
        .map(|c| c.name)
        .collect();
    assert!(names.iter().any(|n| n == "confidence.Y") && names.iter().any(|n| n == "clipped.Y"));
    assert!(
        a.metadata()
            .iter()
            .any(|(n, _)| n == "capture.view1.distance-radii")
    );
}

/// The rotation between two views comes out to the accuracy of their outlines, and the photographers go.
#[test]
fn two_viewpoints_become_one_panorama() {
    let env = sunset(8.0);
    let first = Studio {
        photographer: 0.25,
        ..near(8.0, SIZE)
    };
    let turn = Rotation::of_angles(1.5, 0.15, 0.05);
    let second = Studio {
        rotation: turn,
        ..first
    };
    let mut photos = shots(&first, &real_film(&STOPS), "view one");
    let alone = photos.clone();
    photos.extend(shots(&second, &real_film(&STOPS), "view two"));
    let marked = Options {
        camera_deg: 6.0,
        fill: false,
        ..options(&first)
    };
    let two = taken(
        &photos,
        &Options {
            views: 2,
            ..marked.clone()
        },
    )
    .unwrap();
    let rotation = two.views[1].registration.unwrap().rotation;
    let error = rotation.inverse().then_inner(turn).angle().to_degrees();
    assert!(error < 1.2, "{error}");
    // Negative control of the measure: a rotation that is 5° off shows in directions, light and the correlation.
    let off = |deg: f64| {
        let wrong = turn.then_inner(Rotation::of_angles(deg.to_radians(), 0.0, 0.0));
        let forced = Options {
            views: 2,
            rotations: vec![wrong],
            ..marked.clone()
        };
        let found = taken(&photos, &forced).unwrap();
        (
            compare(&found, &[first, second], &env),
            found.views[1].registration.unwrap().correlation,
        )
    };
    let ((right, good), (wrong, bad)) = (off(0.0), off(5.0));
    assert!(bad < good - 0.05, "{bad} {good}");
    assert!(wrong.direction[1] > 4.0 && wrong.direction[0] > right.direction[0] + 1.0);
    assert!(wrong.radiance[0] > right.radiance[0], "{wrong:?} {right:?}");
    // The photographer of the first view is at +z: black there alone, sky or sea with the second view.
    let one = taken(&alone, &marked).unwrap();
    let camera = ball(&first).towards_camera();
    let ratio = |c: &gonio_capture::Capture| {
        let mut ratios: Vec<f64> = (0..c.panorama.confidence.len())
            .filter(|k| c.panorama.direction(*k).dot(camera) > Real::cos(0.2))
            .map(|k| {
                let truth = env.radiance(c.panorama.direction(k).to_f32());
                luminance(c.panorama.image.pixels[k]) / luminance(truth)
            })
            .collect();
        quantile(&mut ratios, 0.5)
    };
    assert!(
        ratio(&one) < 0.1 * ratio(&two),
        "{} {}",
        ratio(&one),
        ratio(&two)
    );
    let unseen = |c: &gonio_capture::Capture| -> f64 {
        (0..c.panorama.confidence.len())
            .filter(|k| c.panorama.confidence[*k] < 0.05)
            .map(|k| c.panorama.solid_angle(k))
            .sum()
    };
    // Three texels at the edge of a figure may be trusted to neither view.
    assert!(
        unseen(&one) > 0.02 && unseen(&two) < 0.002,
        "{} {}",
        unseen(&one),
        unseen(&two)
    );
}

/// A sun that gives more than half of the irradiance is white in the only exposure; a grey ball in the same place brings it back.
#[test]
fn the_sun_comes_back_by_a_grey_ball() {
    let env = sunny();
    let studio = near(8.0, SIZE);
    let linear = Options {
        response: ResponseChoice::Linear,
        ..options(&studio)
    };
    let burnt = perfect_film(&[0.1]).expose(&studio.radiance(&light(&env), &dark), "burnt");
    let before = compare(&taken(&burnt, &linear).unwrap(), &[studio], &env);
    let grey = Studio {
        material: None,
        rays: 1,
        ..near(8.0, [160, 120])
    };
    let picture = grey.radiance(&|_| [0.001; 3], &shading(&env));
    let shot = perfect_film(&[0.1]).expose(&picture, "grey");
    let restored = Options {
        known_light: Some(KnownLight::GreyBall(shot, None)),
        ..linear
    };
    let found = taken(&burnt, &restored).unwrap();
    let after = compare(&found, &[studio], &env);
    // Without it more than half of the light is gone; with it a tenth may be wrong, as without any sun.
    assert!(
        before.irradiance > 0.5 && after.irradiance < 0.1,
        "{before:?} {after:?}"
    );
    let towards = found.restored.unwrap().direction;
    // Clipped texels reach half of one, 0.7°, beyond a sun whose direction is as wrong as the outline makes it, up to 1.2°.
    assert!(
        towards.dot(Vec3::new(0.6, 0.5, 0.6245)) > Real::cos(2.0_f64.to_radians()),
        "{towards:?}"
    );
}

#[test]
fn a_photograph_without_a_ball_is_refused() {
    let env = sunset(8.0);
    for (k, yaw) in [0.0, 90.0, 200.0].into_iter().enumerate() {
        // The sphere is behind the camera: what is seen is the landscape alone.
        let studio = Studio {
            centre: Vec3::new(0.0, 0.0, 50.0),
            ..near(3.0, SIZE)
        };
        let view = env.clone().rotated_deg(yaw);
        let away = Studio {
            projection: Projection::Perspective {
                focal: 250.0,
                principal: [200.0, 150.0],
            },
            ..studio
        };
        let picture = away.radiance(&light(&view), &dark);
        let photo = real_film(&[0.3]).expose(&picture, &format!("no ball {k}"));
        let error = taken(&photo, &Options::default()).unwrap_err();
        assert!(matches!(error, CaptureError::NoBall { .. }), "{error}");
    }
    let flat = Photo::linear("flat", &Image::filled(200, 150, [0.5; 3]));
    assert!(matches!(
        taken(&[flat], &Options::default()),
        Err(CaptureError::NoBall { .. })
    ));
}

#[test]
fn unusable_photographs_are_one_error_each() {
    let code = |value: u8, width: usize, exposure: Option<f64>| {
        let picture = RawImage {
            width,
            height: 40,
            data: RawData::U8(vec![[value, value, value, 255]; width * 40]),
            has_alpha: false,
        };
        let exif = gonio_capture::Exif {
            time_s: exposure,
            ..Default::default()
        };
        Photo::new(format!("{value}.jpg"), picture, exif)
    };
    let error =
        |photos: &[Photo], options: &Options| taken(photos, options).unwrap_err().to_string();
    let plain = Options::default();
    let equal = error(
        &[code(10, 40, Some(0.01)), code(20, 40, Some(0.01))],
        &plain,
    );
    assert_eq!(
        equal,
        "10.jpg and 20.jpg have the same exposure (1/100 s), so one tells nothing that the other doesn't"
    );
    let none = error(&[code(10, 40, None), code(20, 40, Some(0.01))], &plain);
    assert_eq!(none, "10.jpg: its EXIF data don't tell the exposure time");
    let sizes = [code(100, 40, Some(0.01)), code(50, 41, Some(0.001))];
    let linear = Options {
        response: ResponseChoice::Linear,
        ..plain.clone()
    };
    assert!(error(&sizes, &linear).contains("41 × 40 pixels, but 100.jpg has 40 × 40"));
    let black = error(&[code(0, 40, Some(0.01)), code(0, 40, Some(0.1))], &plain);
    assert!(
        black.starts_with("the camera's response can't be found: only 0 pixels"),
        "{black}"
    );
    for wrong in [
        Options {
            views: 2,
            ..plain.clone()
        },
        Options {
            exposures: Some(vec![1.0, 2.0]),
            ..plain.clone()
        },
        Options {
            height: 1,
            ..plain.clone()
        },
        Options {
            rotations: vec![Rotation::IDENTITY],
            ..plain.clone()
        },
        Options {
            balls: vec![[900.0, 900.0, 5.0]],
            ..plain.clone()
        },
        Options {
            lens: gonio_capture::Lens::Distance(0.5),
            balls: vec![[20.0, 20.0, 9.0]],
            ..plain.clone()
        },
        Options {
            known_light: Some(KnownLight::Lux(-1.0)),
            ..plain
        },
    ] {
        let e = taken(&[code(10, 40, None)], &wrong).unwrap_err();
        assert!(matches!(e, CaptureError::Parameter { .. }), "{e}");
    }
}

#[test]
fn two_scenes_are_told_apart() {
    let first = near(8.0, SIZE);
    let mut photos = shots(&first, &real_film(&[0.3]), "a sunset");
    let other = first.radiance(
        &|d| [0.6 + 0.4 * d.y + 0.3 * Real::sin(9.0 * d.x) * Real::cos(7.0 * d.z + 2.0 * d.y); 3],
        &dark,
    );
    photos.extend(real_film(&[0.3]).expose(&other, "another place"));
    let error = taken(
        &photos,
        &Options {
            views: 2,
            ..options(&first)
        },
    )
    .unwrap_err();
    assert!(
        matches!(error, CaptureError::DifferentScenes { .. }),
        "{error}"
    );
    assert!(
        error
            .to_string()
            .starts_with("another place 0: not the same scene as a sunset 0")
    );
}

/// The project's renderer draws the same ball as the simulation, so what holds for one holds for the other: a perfect mirror has
/// no variance but that of the pixel filter over details.
#[test]
fn our_renderer_takes_the_same_photograph() {
    use gonio_brdf::ModelSpec;
    use gonio_num::Affine3;
    use gonio_render::{PixelFilter, RenderOptions, Target, render};
    use gonio_scene::{Camera, Light, Material, SceneBuilder, Shape};
    let env = sunset(8.0);
    let mut scene = SceneBuilder::new("ball");
    let shape = scene.shape(Shape::Sphere);
    let mirror =
        scene.material(Material::new("mirror", &ModelSpec::parse("mirror").unwrap()).unwrap());
    scene.instance(shape, Affine3::identity(), mirror);
    scene.light(Light::Environment(env.clone()));
    let scene = scene.build().unwrap();
    let up = Vec3::new(0.0, 1.0, 0.0);
    let fov = 16.0_f32;
    let camera = Camera::look_at(Vec3::new(0.0, 0.0, 10.0), Vec3::zero(), up, fov).unwrap();
    let (width, height) = (240, 200);
    let render_options = RenderOptions {
        width,
        height,
        target: Target {
            samples: 16,
            time: None,
            noise: None,
            adaptive: false,
        },
        filter: PixelFilter::Box,
        ..RenderOptions::default()
    };
    let (film, _) = render(&scene, &camera, &render_options, |_, _| {
        std::ops::ControlFlow::Continue(())
    })
    .unwrap();
    let focal = 0.5 * f64::from(height) / Real::tan(f64::from(fov).to_radians() / 2.0);
    let studio = Studio {
        size: [width as usize, height as usize],
        projection: Projection::Perspective {
            focal,
            principal: [120.0, 100.0],
        },
        centre: Vec3::new(0.0, 0.0, -10.0),
        radius: 0.0,
        rotation: Rotation::IDENTITY,
        material: Some(BallMaterial::Perfect),
        photographer: 0.0,
        rays: 4,
    };
    let simulated = studio.radiance(&light(&env), &dark);
    let mut off: Vec<f64> = film
        .image()
        .pixels
        .iter()
        .zip(&simulated.pixels)
        .map(|(a, b)| (luminance(*a) / luminance(*b) - 1.0).abs())
        .collect();
    // Two sets of 16 points in a pixel: most of the sky is smooth.
    assert!(quantile(&mut off, 0.5) < 0.01);
    assert!(quantile(&mut off, 0.9) < 0.1);
    let found = taken(
        &[Photo::linear("rendered", &film.image())],
        &Options {
            material: BallMaterial::Perfect,
            ..options(&studio)
        },
    )
    .unwrap();
    let e = compare(&found, &[studio], &env);
    assert!(
        e.direction[0] < 1.5 && e.radiance[0] < 0.1 && e.irradiance < 0.1,
        "{e:?}"
    );
}

/// A real photograph, if it is here: its outline, measured by hand in the enlarged picture to ± 2 pixels at eight places.
#[test]
fn a_real_balls_outline_is_found() {
    let Some(folder) = std::env::var_os("GONIO_MIRRORBALL") else {
        eprintln!("skipped: GONIO_MIRRORBALL names no folder with room_ball.jpg");
        return;
    };
    let photo = Photo::read(&std::path::Path::new(&folder).join("room_ball.jpg")).unwrap();
    let small = Options {
        height: 64,
        ..Options::default()
    };
    let found = taken(std::slice::from_ref(&photo), &small).unwrap();
    let ball = &found.views[0].outline;
    let [x, y] = ball.ball.centre();
    assert!(
        (x - 2042.0).abs() < 2.0 && (y - 2053.0).abs() < 2.0,
        "{x} {y}"
    );
    assert!(
        (ball.ball.radius() - 1980.0).abs() < 2.0 && ball.rms < 1.0,
        "{ball:?}"
    );
    // The room in a mirror is not an exposure of the room.
    let RawData::U8(codes) = &photo.picture.data else {
        panic!("a JPEG of 8 bits");
    };
    let width = photo.picture.width;
    let rows = codes
        .chunks(width)
        .flat_map(|row| row.iter().rev().copied());
    let picture = RawImage {
        data: RawData::U8(rows.collect()),
        ..photo.picture.clone()
    };
    let mirrored = Photo::new("mirrored", picture, photo.exif);
    let circle = [2042.0, 2053.0, 1980.0];
    let error =
        gonio_capture::align::align(&[photo, mirrored], &[1.0, 0.5], Some(circle)).unwrap_err();
    assert!(matches!(error, CaptureError::NotAligned { .. }), "{error}");
    eprintln!("{error}");
}
