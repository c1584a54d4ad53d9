use super::*;
use proptest::prelude::*;

fn close(a: Vec3<f32>, b: [f32; 3], tolerance: f32) {
    assert!(
        (a - Vec3::from(b)).length() <= tolerance,
        "{a:?} is not {b:?}"
    );
}

fn front() -> Camera {
    Camera::look_at(
        Vec3::new(0.0, 0.0, 5.0),
        Vec3::zero(),
        Vec3::new(0.0, 1.0, 0.0),
        90.0,
    )
    .unwrap()
}

/// With a vertical field of view of 90° the top of the film is seen at 45°, its left at atan(aspect).
#[test]
fn film_corners_are_seen_at_the_field_of_view() {
    let camera = front();
    close(
        camera.ray([0.5, 0.5], 2.0, [0.0; 2]).direction,
        [0.0, 0.0, -1.0],
        1e-6,
    );
    let h = std::f32::consts::FRAC_1_SQRT_2;
    close(
        camera.ray([0.5, 0.0], 2.0, [0.0; 2]).direction,
        [0.0, h, -h],
        1e-6,
    );
    close(
        camera.ray([0.5, 1.0], 2.0, [0.0; 2]).direction,
        [0.0, -h, -h],
        1e-6,
    );
    // (−2, 1, −1)/√6
    let s = 6.0_f32.sqrt();
    close(
        camera.ray([0.0, 0.0], 2.0, [0.0; 2]).direction,
        [-2.0 / s, 1.0 / s, -1.0 / s],
        1e-6,
    );
    close(
        camera.ray([0.0, 0.0], 2.0, [0.0; 2]).origin,
        [0.0, 0.0, 5.0],
        0.0,
    );
}

#[test]
fn orthographic_rays_are_parallel_and_span_the_height() {
    let camera = Camera::new(
        "",
        &Affine3::identity(),
        Projection::Orthographic { half_height: 3.0 },
    )
    .unwrap();
    let ray = camera.ray([1.0, 0.0], 1.5, [0.3, 0.4]);
    close(ray.origin, [4.5, 3.0, 0.0], 1e-6);
    close(ray.direction, [0.0, 0.0, -1.0], 1e-6);
}

/// Rays of a thin lens through one point of the film meet in the plane of focus, and start within the aperture.
#[test]
fn thin_lens_focuses() {
    let projection = Projection::ThinLens {
        fov_y_rad: 0.7,
        lens_radius: 0.25,
        focus_distance: 4.0,
    };
    let camera = Camera::new("", &Affine3::identity(), projection).unwrap();
    let pinhole = Camera::new(
        "",
        &Affine3::identity(),
        Projection::Pinhole { fov_y_rad: 0.7 },
    )
    .unwrap();
    let film = [0.2, 0.9];
    let chief = pinhole.ray(film, 1.3, [0.0; 2]).direction;
    let focus = chief * (4.0 / -chief.z);
    let mut widest = 0.0_f32;
    for i in 0..64 {
        let ray = camera.ray(film, 1.3, [(i % 8) as f32 / 8.0, (i / 8) as f32 / 8.0]);
        let r = ray.origin.length();
        assert!(r <= 0.25 + 1e-6 && ray.origin.z == 0.0);
        widest = widest.max(r);
        let at = ray.origin + ray.direction * ((-4.0 - ray.origin.z) / ray.direction.z);
        close(at, focus.to_array(), 2e-5);
    }
    assert!(
        widest > 0.2,
        "the lens is sampled to its rim, not only to {widest}"
    );
}

#[test]
fn a_scaled_or_mirrored_node_gives_a_rigid_camera() {
    let m = Affine3 {
        x: Vec3::new(-2.0, 0.0, 0.0),
        y: Vec3::new(0.0, 3.0, 0.5),
        z: Vec3::new(0.0, 0.0, 0.1),
        origin: Vec3::new(1.0, 2.0, 3.0),
    };
    let camera = Camera::new("", &m, Projection::Pinhole { fov_y_rad: 1.0 }).unwrap();
    let t = camera.to_world;
    close(t.x, [1.0, 0.0, 0.0], 1e-6);
    close(t.y, [0.0, 1.0, 0.0], 1e-6);
    close(t.z, [0.0, 0.0, 1.0], 1e-6);
    close(camera.forward(), [0.0, 0.0, -1.0], 1e-6);
}

#[test]
fn parameters_out_of_range_are_refused() {
    for fov_deg in [0.0, 180.0, -1.0, f32::NAN, f32::INFINITY] {
        let made = Camera::look_at(
            Vec3::zero(),
            Vec3::splat(1.0),
            Vec3::new(0.0, 1.0, 0.0),
            fov_deg,
        );
        let message = made.unwrap_err().to_string();
        assert!(message.contains("field of view"), "{message}");
    }
    assert!(Camera::look_at(Vec3::zero(), Vec3::zero(), Vec3::new(0.0, 1.0, 0.0), 40.0).is_err());
    let singular = Affine3::scale(Vec3::zero());
    assert!(Camera::new("", &singular, Projection::Pinhole { fov_y_rad: 1.0 }).is_err());
    let lens = |lens_radius, focus_distance| {
        Projection::ThinLens {
            fov_y_rad: 1.0,
            lens_radius,
            focus_distance,
        }
        .check()
    };
    assert!(lens(0.0, 1.0).is_ok());
    assert!(lens(-0.1, 1.0).is_err());
    assert!(lens(0.1, 0.0).is_err());
    assert!(lens(f32::NAN, 1.0).is_err());
}

/// Where each point lands on the film: the inverse of `ray` for a pinhole.
fn project(camera: &Camera, p: Vec3<f32>, aspect: f32) -> [f32; 2] {
    let Projection::Pinhole { fov_y_rad } = camera.projection else {
        panic!("a pinhole")
    };
    let d = p - camera.position();
    let (x, y, z) = (
        d.dot(camera.to_world.x),
        d.dot(camera.to_world.y),
        -d.dot(camera.to_world.z),
    );
    assert!(z > 0.0, "in front of the camera");
    let t = Real::tan(fov_y_rad * 0.5);
    [0.5 + 0.5 * x / (z * t * aspect), 0.5 - 0.5 * y / (z * t)]
}

proptest! {
    #[test]
    fn rays_are_unit_and_hit_the_film_point_they_were_asked_for(
        film in prop::array::uniform2(0.0_f32..=1.0), aspect in 0.3_f32..3.0,
        eye in prop::array::uniform3(-10.0_f32..10.0), fov in 5.0_f32..150.0,
    ) {
        let camera = Camera::look_at(Vec3::from(eye), Vec3::new(11.0, 12.0, 13.0), Vec3::new(0.0, 1.0, 0.0), fov).unwrap();
        let ray = camera.ray(film, aspect, [0.1, 0.2]);
        prop_assert!((ray.direction.length() - 1.0).abs() < 1e-6);
        let back = project(&camera, ray.origin + ray.direction * 7.0, aspect);
        // Cancellation against coordinates of about 20 units over 7 units of distance: 20/7 · 2⁻²³ · a few, divided by tan(2.5°).
        prop_assert!((back[0] - film[0]).abs() < 1e-4 && (back[1] - film[1]).abs() < 1e-4, "{film:?} {back:?}");
    }

    /// All corners lie inside the film with the margin, and the box fills the film in one direction at least.
    #[test]
    fn framing_holds_the_bounds(
        low in prop::array::uniform3(-5.0_f32..5.0), size in prop::array::uniform3(0.01_f32..9.0), aspect in 0.4_f32..2.5,
    ) {
        let min = Vec3::from(low);
        let bounds = Aabb { min, max: min + Vec3::from(size) };
        let camera = Camera::framing(&bounds, aspect);
        let mut extent = [0.0_f32; 2];
        for i in 0..8 {
            let pick = |bit: usize| if i >> bit & 1 == 0 { bounds.min[bit] } else { bounds.max[bit] };
            let film = project(&camera, Vec3::new(pick(0), pick(1), pick(2)), aspect);
            for k in 0..2 {
                extent[k] = extent[k].max((film[k] - 0.5).abs() * 2.0);
            }
        }
        let fill = FRAMING_FILL as f32;
        prop_assert!(extent[0] <= fill + 1e-3 && extent[1] <= fill + 1e-3, "{extent:?}");
        prop_assert!(extent[0] >= fill - 1e-3 || extent[1] >= fill - 1e-3, "{extent:?}");
        prop_assert!(camera.position().y > bounds.min.y);
    }
}

#[test]
fn framing_nothing_is_still_a_camera() {
    let point = Aabb {
        min: Vec3::splat(2.0),
        max: Vec3::splat(2.0),
    };
    let empty = Aabb {
        min: Vec3::splat(f32::INFINITY),
        max: Vec3::splat(f32::NEG_INFINITY),
    };
    for bounds in [point, empty] {
        let camera = Camera::framing(&bounds, 1.0);
        assert!(camera.position().is_finite());
        assert!((camera.ray([0.5, 0.5], 1.0, [0.0; 2]).direction.length() - 1.0).abs() < 1e-6);
    }
}
