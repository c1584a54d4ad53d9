//! The figures of the page Learn, held to what the theory says of each.

#![allow(clippy::unwrap_used)]

use gonio_web::{Answer, call};
use serde_json::{Value, json};
use std::f64::consts::{FRAC_1_PI, PI};

fn asked(request: &Value) -> (Value, Answer) {
    let answer = call(&json!({ "operation": "learn", "request": request }).to_string());
    (serde_json::from_str(answer.json()).unwrap(), answer)
}

/// The answer, which is no error, and its arrays by name.
struct Learned {
    json: Value,
    answer: Answer,
}

fn learn(request: Value) -> Learned {
    let (json, answer) = asked(&request);
    assert!(json.get("error").is_none(), "{request}: {json}");
    Learned { json, answer }
}

impl Learned {
    fn number(&self, name: &str) -> f64 {
        let value =
            name.split('.')
                .fold(&self.json["answer"], |v, key| match key.parse::<usize>() {
                    Ok(index) => &v[index],
                    Err(_) => &v[key],
                });
        value
            .as_f64()
            .unwrap_or_else(|| panic!("{name}: {}", self.json))
    }

    fn array(&self, name: &str) -> Vec<f32> {
        let place = &self.json["arrays"][name];
        let [first, count] = [0, 1].map(|k| place[k].as_u64().unwrap() as usize);
        self.answer.numbers()[first..first + count].to_vec()
    }
}

fn near(a: f64, b: f64, relative: f64) {
    assert!(
        (a - b).abs() <= relative * b.abs().max(1e-12),
        "{a} and {b}"
    );
}

fn angles(theta: f64, phi: f64) -> Value {
    json!({ "theta": theta, "phi": phi })
}

#[test]
fn t1_v_is_largest_at_555_nm_and_the_sun_is_white() {
    let light = learn(json!({ "figure": "light", "kelvin": 5800.0 }));
    let (lambda, v) = (light.array("lambda"), light.array("v"));
    let brightest = (0..v.len()).max_by(|a, b| v[*a].total_cmp(&v[*b])).unwrap();
    assert_eq!(lambda[brightest], 555.0);
    assert!(light.number("efficacy") > 90.0 && light.number("efficacy") < 96.0);
    assert!((0..3).all(|k| light.number(&format!("rgb.{k}")) > 0.8));
    assert_eq!(light.array("colour").len(), 3 * lambda.len());
}

#[test]
fn t2_to_t4_the_sphere_has_4_pi() {
    let half = learn(json!({ "figure": "solid-angle", "half_angle": 90.0 }));
    near(half.number("steradians"), 2.0 * PI, 1e-14);
    near(half.number("share"), 0.5, 1e-14);
    let there = learn(json!({ "figure": "spherical", "theta": 130.0, "phi": -170.0, "r": 2.0 }));
    near(
        there.number("x"),
        2.0 * 130f64.to_radians().sin() * 170f64.to_radians().cos(),
        1e-14,
    );
    for (name, value) in [("theta", 130.0), ("phi", -170.0), ("r", 2.0)] {
        near(there.number(&format!("back.{name}")), value, 1e-14);
    }
    let patch = |step: f64| {
        learn(
            json!({ "figure": "differential", "theta": 50.0, "phi": 0.0, "dtheta": step, "dphi": step }),
        )
    };
    near(
        patch(1.0).number("differential"),
        patch(1.0).number("exact"),
        2e-5,
    );
    let error = |step: f64| (patch(step).number("sum") - 4.0 * PI).abs();
    assert!(error(1.0) < 1e-3 && error(2.0) > 3.0 * error(1.0));
}

#[test]
fn t5_radiance_does_not_depend_on_the_distance() {
    for distance in [0.5, 2.0, 60.0] {
        let lamp = learn(
            json!({ "figure": "radiance", "radius": 0.5, "distance": distance, "radiance": 3.0 }),
        );
        near(lamp.number("ratio"), 3.0, 1e-12);
        // π L sin²α on the axis.
        near(
            lamp.number("irradiance"),
            3.0 * PI * 0.25 / (0.25 + distance * distance),
            1e-12,
        );
    }
}

#[test]
fn t6_sums_come_near_the_integral() {
    // Closed forms: π, and ∫ (1 + 2 cosθ)/3 cosθ dω = π/3 + 4π/9.
    for (sky, exact) in [
        ("uniform", Some(PI)),
        ("overcast", Some(7.0 * PI / 9.0)),
        ("low-sun", None),
    ] {
        let sum = learn(json!({ "figure": "irradiance", "sky": sky, "steps": 8 }));
        let exact = exact.unwrap_or(sum.number("exact"));
        near(sum.number("exact"), exact, 1e-6);
        let sums = sum.array("sums");
        near(f64::from(sums[31]), exact, 2e-3);
        near(f64::from(sums[7]), sum.number("sum"), 1e-6);
        let cells: f32 = sum.array("cells").iter().sum();
        near(f64::from(cells), sum.number("sum"), 1e-5);
        assert_eq!(sum.array("cells").len(), 8 * 32);
    }
}

#[test]
fn t7_paint_returns_its_reflectance_and_a_mirror_nearly_all() {
    let paint = learn(json!({ "figure": "exitance", "function": "lambertian:reflectance=0.6" }));
    near(paint.number("exitance.0"), 0.6 * PI, 1e-6);
    near(paint.number("irradiance"), PI, 1e-15);
    let mirror = learn(json!({ "figure": "exitance", "function": "mirror:reflectance=0.9" }));
    near(mirror.number("albedo.1"), 0.9, 1e-6);
}

#[test]
fn t8_a_narrow_cone_gives_the_reflection_function() {
    let cone = |half: f64| {
        learn(
            json!({ "figure": "brdf", "function": "ggx:roughness=0.4,metal=gold",
            "wi": angles(45.0, 180.0), "wo": angles(38.0, 0.0), "half_angle": half }),
        )
    };
    let narrow = cone(0.2);
    near(narrow.number("ratio.0"), narrow.number("f.0"), 1e-3);
    // ∫ cosθ dω of a cone: cosθ of its axis times π sin²α.
    near(
        narrow.number("irradiance"),
        45f64.to_radians().cos() * PI * 0.2f64.to_radians().sin().powi(2),
        1e-5,
    );
    let wide = cone(20.0);
    assert!((wide.number("ratio.0") / wide.number("f.0") - 1.0).abs() > 0.02);
}

#[test]
fn t11_only_brushed_metal_changes_when_it_turns() {
    let turn = |function: &str| {
        learn(
            json!({ "figure": "turn", "function": function, "wi": angles(45.0, 180.0), "wo": angles(52.0, 14.0), "steps": 36 }),
        )
    };
    let smooth = turn("ggx:roughness=0.4");
    near(smooth.number("least"), smooth.number("largest"), 1e-9);
    let brushed = turn("ggx:alpha_x=0.08,alpha_y=0.35");
    assert!(brushed.number("largest") > 1.5 * brushed.number("least"));
    assert_eq!(brushed.array("values").len(), 3 * 37);
}

#[test]
fn t13_lights_add_up() {
    let light = |theta: f64, radiance: f64| json!({ "theta": theta, "phi": 180.0, "radiance": [radiance, radiance, radiance] });
    let sum = learn(
        json!({ "figure": "reflection", "function": "lambertian:reflectance=1", "wo": angles(30.0, 0.0),
        "lights": [light(60.0, 1.0), light(0.0, 0.5)] }),
    );
    near(sum.number("sum.0"), (0.5 + 0.5) * FRAC_1_PI, 1e-12);
    near(f64::from(sum.array("terms")[3]), 0.5 * FRAC_1_PI, 1e-6);
    // Under a uniform sky Lr is the albedo.
    let sky = learn(
        json!({ "figure": "reflection-sky", "function": "lambertian:reflectance=0.7", "wo": angles(30.0, 0.0), "sky": "uniform", "steps": 4 }),
    );
    near(sky.number("exact.2"), 0.7, 1e-6);
    assert_eq!(sky.array("terms").len(), 3 * 4 * 16);
}

#[test]
fn t17_glass_and_metal() {
    let glass = learn(json!({ "figure": "fresnel", "ior": 1.5, "k": 0.0 }));
    near(glass.number("f0"), 0.04, 1e-12);
    near(glass.number("brewster"), 1.5f64.atan().to_degrees(), 1e-12);
    let (s, p, mean) = (
        glass.array("s"),
        glass.array("p"),
        glass.array("unpolarised"),
    );
    for ((s, p), mean) in s.iter().zip(&p).zip(&mean) {
        near(f64::from(0.5 * (s + p)), f64::from(*mean), 1e-5);
        assert!(s >= p && *p >= -1e-7);
    }
    assert!(
        p[112..=113].iter().all(|p| *p < 1e-4),
        "Brewster's angle is 56.3°"
    );
    assert_eq!((s[180], p[180]), (1.0, 1.0));
    let gold = learn(json!({ "figure": "fresnel", "ior": 0.2, "k": 3.4 }));
    assert!(gold.number("f0") > 0.9 && gold.json["answer"]["brewster"].is_null());
}

/// f = F G D / (4 cosθi cosθr), (18).
#[test]
fn t18_the_factors_are_those_of_the_model() {
    let facets =
        learn(json!({ "figure": "torrance-sparrow", "roughness": 0.5, "ior": 1.5, "theta": 50.0 }));
    let (angles, d, g, f) = (
        facets.array("angles"),
        facets.array("d"),
        facets.array("g"),
        facets.array("f"),
    );
    let value = facets.array("value");
    let cos_i = 50f64.to_radians().cos();
    for (i, angle) in angles.iter().enumerate() {
        let cos_r = f64::from(*angle).to_radians().cos();
        let product = f64::from(f[i]) * f64::from(g[i]) * f64::from(d[i]) / (4.0 * cos_i * cos_r);
        near(f64::from(value[3 * i]), product, 1e-5);
        assert!((0.0..=1.0).contains(&g[i]) && (0.0..=1.0).contains(&f[i]));
    }
}

#[test]
fn t21_the_ball_shows_the_panorama() {
    let ball = learn(json!({ "figure": "mirror-ball", "light": "uniform:2", "size": 16 }));
    let values = ball.array("ball");
    assert!(values[0].is_nan(), "the corner is beside the ball");
    assert_eq!(values[3 * (8 * 16 + 8)], 2.0);
    assert_eq!(ball.array("panorama").len(), 3 * 32 * 16);
    for point in ball.array("mesh").chunks(7) {
        assert!(point[0].hypot(point[1]) <= 1.0001, "{point:?}");
        assert_eq!(point[4], 2.0);
    }
}

#[test]
fn what_makes_no_sense_is_one_error() {
    for request in [
        json!({ "figure": "none" }),
        json!({ "figure": "light", "kelvin": -1.0 }),
        json!({ "figure": "light" }),
        json!({ "figure": "light", "kelvin": 5000.0, "more": 1 }),
        json!({ "figure": "solid-angle", "half_angle": 200.0 }),
        json!({ "figure": "irradiance", "sky": "uniform", "steps": 0 }),
        json!({ "figure": "irradiance", "sky": "uniform", "steps": 100000 }),
        json!({ "figure": "irradiance", "sky": "night", "steps": 4 }),
        json!({ "figure": "exitance", "function": "gxx" }),
        json!({ "figure": "turn", "function": "ggx", "wi": angles(0.0, 0.0), "wo": angles(0.0, 0.0), "steps": 1e9 }),
        json!({ "figure": "fresnel", "ior": 0.5, "k": 0.0 }),
        json!({ "figure": "mirror-ball", "light": "uniform:1", "size": 100000 }),
        json!({ "figure": "mirror-ball", "light": "none.hdr", "size": 8 }),
    ] {
        let (json, _) = asked(&request);
        assert!(json["error"]["message"].is_string(), "{request}: {json}");
    }
}
