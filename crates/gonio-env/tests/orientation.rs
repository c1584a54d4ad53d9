//! The labelled six-axis image, through every layout and every picture format, seen from inside.

use gonio_env::test_image::{DOT, FACES, Face, LABEL_HEIGHT, LABEL_WIDTH, label_dot, six_axes};
use gonio_env::{Environment, Layout};
use gonio_image::Image;
use gonio_num::Vec3;

/// Rows that resolve a label's dot, 4° to 6° wide, by at least two texels. The ball's far side needs most: there a
/// texel 8° off the axis is 1 / (n/2 · ½ sin 4°) rad wide, 3.2° for n = 1024.
fn size(layout: Layout) -> usize {
    match layout {
        Layout::LatLong => 256,
        Layout::Angular => 512,
        Layout::MirrorBall => 1024,
        // Rows of a face.
        layout if layout.arrangement().is_some() => 128,
        _ => 512,
    }
}

/// Angle around −z in which the ball's photograph can't resolve a dot.
const BLIND_COS: f64 = 0.99;

/// Reads the label of `face` with a window that looks along `look` with `up` upwards: how many of its dots, and of the
/// plain surface around them, are wrong.
fn wrong_dots(
    env: &Environment,
    layout: Layout,
    face: &Face,
    look: Vec3<f64>,
    up: Vec3<f64>,
) -> usize {
    let right = look.cross(up);
    let mut wrong = 0;
    // One dot more on every side.
    for row in 0..LABEL_HEIGHT + 2 {
        for column in 0..LABEL_WIDTH + 2 {
            let x = (column as f64 - 0.5 - 0.5 * LABEL_WIDTH as f64) * DOT;
            let y = (0.5 * LABEL_HEIGHT as f64 + 0.5 - row as f64) * DOT;
            let d = (look + right * x + up * y).normalize();
            if layout == Layout::MirrorBall && d.z < -BLIND_COS {
                continue;
            }
            let seen = env.radiance(d.to_f32());
            let dark = column > 0 && row > 0 && label_dot(face.label, column - 1, row - 1);
            let expected = if dark { [0.0; 3] } else { face.colour };
            if (0..3).any(|c| (seen[c] - expected[c]).abs() > 0.5) {
                wrong += 1;
            }
        }
    }
    wrong
}

fn wrong_in_all(env: &Environment, layout: Layout) -> usize {
    FACES
        .iter()
        .map(|f| wrong_dots(env, layout, f, f.forward, f.up))
        .sum()
}

#[test]
fn every_layout_shows_every_label_unmirrored() {
    for layout in Layout::ALL {
        let image = six_axes(layout, size(layout));
        let env = Environment::from_image(image.clone(), layout).unwrap();
        assert_eq!(wrong_in_all(&env, layout), 0, "{layout}");
        // Negative controls: mirrored left to right, and upside down, which leaves a strip its X and signs.
        let (w, h) = (image.width, image.height);
        let mirrored = Image::from_fn(w, h, |x, y| image.get(w - 1 - x, y));
        let flipped = Image::from_fn(w, h, |x, y| image.get(x, h - 1 - y));
        for turned in [mirrored, flipped] {
            let env = Environment::from_image(turned, layout).unwrap();
            assert!(wrong_in_all(&env, layout) > 20, "{layout}");
        }
    }
}

#[test]
fn labels_stand_at_the_places_worked_out_by_hand() {
    // Picture coordinates beside the letters, in the face's colour.
    let lat_long = six_axes(Layout::LatLong, 256);
    let at = |image: &Image, u: f64, v: f64| {
        image.get(
            (u * image.width as f64) as usize,
            (v * image.height as f64) as usize,
        )
    };
    let (red, cyan, green) = ([1.0, 0.0, 0.0], [0.0, 1.0, 1.0], [0.0, 1.0, 0.0]);
    let (magenta, blue, yellow) = ([1.0, 0.0, 1.0], [0.0, 0.0, 1.0], [1.0, 1.0, 0.0]);
    for (u, v, colour) in [
        (0.75, 0.38, red),
        (0.25, 0.38, cyan),
        (0.5, 0.15, green),
        (0.5, 0.85, magenta),
        (0.01, 0.38, blue),
        (0.99, 0.38, blue),
        (0.5, 0.38, yellow),
    ] {
        assert_eq!(at(&lat_long, u, v), colour, "lat-long ({u}, {v})");
    }
    let angular = six_axes(Layout::Angular, 256);
    for (u, v, colour) in [
        (0.75, 0.5, red),
        (0.25, 0.5, cyan),
        (0.5, 0.4, yellow),
        (0.5, 0.01, blue),
    ] {
        // The centres of +X and −X are the gap between their letters.
        assert_eq!(at(&angular, u, v), colour, "angular ({u}, {v})");
    }
    assert_eq!(at(&angular, 0.02, 0.02), [0.0; 3]);
    let ball = six_axes(Layout::MirrorBall, 256);
    for (u, v, colour) in [
        (0.854, 0.5, red),
        (0.146, 0.5, cyan),
        (0.5, 0.35, blue),
        (0.5, 0.01, yellow),
    ] {
        assert_eq!(at(&ball, u, v), colour, "mirror ball ({u}, {v})");
    }
}

#[test]
fn a_positive_yaw_turns_counter_clockwise_seen_from_above() {
    // From above, with −z at the top of the plan and +x on the right, counter-clockwise takes −z to −x.
    let layout = Layout::LatLong;
    let env = Environment::from_image(six_axes(layout, 256), layout).unwrap();
    let up = Vec3::new(0.0, 1.0, 0.0);
    let minus_x = Vec3::new(-1.0, 0.0, 0.0);
    let turned = env.clone().rotated_deg(90.0);
    assert_eq!(wrong_dots(&turned, layout, &FACES[5], minus_x, up), 0);
    let back = env.clone().rotated_deg(-90.0);
    assert_eq!(wrong_dots(&back, layout, &FACES[5], -minus_x, up), 0);
    // A full turn in odd steps is no turn.
    let full = env
        .clone()
        .rotated_deg(100.5)
        .rotated_deg(200.0)
        .rotated_deg(59.5);
    assert_eq!(wrong_in_all(&full, layout), 0);
    assert!(wrong_in_all(&turned, layout) > 100);
}

#[test]
fn every_picture_format_keeps_it() {
    let folder = tempfile::tempdir().unwrap();
    for layout in Layout::ALL {
        for extension in ["exr", "hdr", "png"] {
            let path = folder.path().join(format!("{layout}.{extension}"));
            six_axes(layout, 192).write(&path).unwrap();
            let read = Image::read(&path).unwrap();
            assert_eq!(read, six_axes(layout, 192), "{}", path.display());
            let env = Environment::load(&path, Some(layout)).unwrap();
            let red = env.radiance(Vec3::new(1.0, 0.42, 0.0).normalize());
            assert_eq!(red, [1.0, 0.0, 0.0], "{}", path.display());
        }
    }
}
