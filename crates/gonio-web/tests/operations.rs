//! Every operation as a page asks for it: answers are the library's own, and what can't be answered is one clear error.

#![allow(clippy::unwrap_used)]

use gonio_web::{Answer, call};
use serde_json::{Value, json};
use std::f64::consts::PI;

fn asked(operation: &str, request: Value) -> Answer {
    call(&json!({ "operation": operation, "request": request }).to_string())
}

fn parsed(answer: &Answer) -> Value {
    serde_json::from_str(answer.json()).unwrap()
}

/// The answer, which is no error.
fn answer(operation: &str, request: Value) -> (Value, Answer) {
    let answer = asked(operation, request);
    let json = parsed(&answer);
    assert!(json.get("error").is_none(), "{operation}: {json}");
    (json["answer"].clone(), answer)
}

/// The error, which has a message.
fn error(operation: &str, request: Value) -> Value {
    let json = parsed(&asked(operation, request));
    assert!(json["error"]["message"].is_string(), "{operation}: {json}");
    json["error"].clone()
}

fn array(answer: &Answer, name: &str) -> Vec<f32> {
    let place = &parsed(answer)["arrays"][name];
    let [first, count] = [0, 1].map(|k| place[k].as_u64().unwrap() as usize);
    answer.numbers()[first..first + count].to_vec()
}

fn angles(theta: f64, phi: f64) -> Value {
    json!({ "theta": theta, "phi": phi })
}

#[test]
fn the_catalogue_has_every_model_with_ranges() {
    let (all, _) = answer("catalogue", json!({}));
    let models = all["models"].as_array().unwrap();
    let names: Vec<&str> = models.iter().map(|m| m["name"].as_str().unwrap()).collect();
    assert_eq!(names, gonio_brdf::registry::names());
    for model in models {
        for p in model["parameters"].as_array().unwrap() {
            assert!(p["kind"].is_string() && p["meaning"].is_string(), "{p}");
        }
        if let Some(example) = model["example"].as_str() {
            let (told, _) = answer("describe", json!({ "function": example }));
            assert_eq!(told["model"], model["name"], "{example}");
        }
    }
    // Each name of a preset stands for something.
    let ward = models.iter().find(|m| m["name"] == "ward").unwrap();
    for preset in ward["presets"].as_array().unwrap().iter().step_by(17) {
        answer("describe", json!({ "function": preset }));
    }
}

#[test]
fn parameters_are_set_and_taken_away() {
    let set = |function: &Value, values: Value| json!({ "function": function, "values": values });
    let (told, _) = answer(
        "set",
        set(&json!("ggx:metal=gold"), json!({ "roughness": "0.4" })),
    );
    assert_eq!(
        told["text"],
        "torrance-sparrow:distribution=ggx,metal=gold,roughness=0.4"
    );
    let of = |name: &str| {
        let all = told["parameters"].as_array().unwrap();
        all.iter().find(|p| p["name"] == name).unwrap().clone()
    };
    assert_eq!(of("roughness")["value"], 0.4);
    assert_eq!(of("roughness")["given"], true);
    assert_eq!(of("metal")["value"], "gold");
    let both = json!({ "roughness": null, "metal": null, "distribution": null });
    let (told, _) = answer("set", set(&told["text"], both));
    assert_eq!(told["text"], "torrance-sparrow");

    let complaint = error("set", set(&json!("ggx"), json!({ "roughness": "2" })));
    assert_eq!(
        complaint["message"],
        "parameter `roughness` of `torrance-sparrow` is `2`; expected a number from 0 to 1"
    );
    let complaint = error("set", set(&json!("ggx"), json!({ "rougness": "1" })));
    assert_eq!(complaint["help"], "did you mean `roughness`?");
}

/// What is taken away is read by those that it is for.
#[test]
fn descriptions_go_elsewhere() {
    let function = "sum(lambertian:0.3, ggx:roughness=0.5)";
    let (told, _) = answer("describe", json!({ "function": function }));
    let scene = format!(
        "[environment]\nuniform = 1\n{}[[shape]]\nkind = \"sphere\"\nmaterial = \"object\"\n",
        told["as"]["toml"].as_str().unwrap()
    );
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, scene).unwrap();
    let scene = gonio_scene::Scene::load(&path, &Default::default()).unwrap();
    let material = scene.materials.iter().find(|m| m.name == "object");
    assert_eq!(material.unwrap().even_model().unwrap().info().name, "sum");

    let command = told["as"]["command"].as_str().unwrap();
    assert!(command.ends_with(&format!("'{}'", told["text"].as_str().unwrap())));
    assert!(
        told["as"]["python"]
            .as_str()
            .unwrap()
            .contains("\"--json\"")
    );
}

#[test]
fn values_are_those_of_the_library() {
    let request =
        json!({ "function": "lambertian:0.5", "wi": angles(30.0, 0.0), "wo": angles(60.0, 90.0) });
    let (value, _) = answer("evaluate", request);
    assert_eq!(value["f_per_sr"][0], 0.5 / PI);
    let f_cos = value["f_cos_per_sr"][1].as_f64().unwrap();
    // cos 30°, to rounding.
    assert!((f_cos - 0.5 / PI * 0.75_f64.sqrt()).abs() < 1e-15);
}

/// The albedo of what reflects half, and the largest values of its lobes.
#[test]
fn plots_of_a_lambertian_surface() {
    let f = "lambertian:0.5";
    let wi = angles(45.0, 180.0);
    let half = 0.5 / PI;
    let near = |x: &Value| (x.as_f64().unwrap() - half).abs() < 1e-12;

    let request = json!({ "function": f, "wi": wi, "scale": "linear", "cosine": false });
    let (told, lobe) = answer("lobe", request);
    assert!(near(&told["largest"][0]));
    let (directions, triangles) = (array(&lobe, "directions"), array(&lobe, "triangles"));
    assert_eq!(directions.len(), array(&lobe, "values").len());
    let corners = directions.len() as f32 / 3.0;
    assert!(triangles.len() > 100 && triangles.iter().all(|k| *k < corners));

    let request = json!({ "function": f, "wi": wi, "cosine": false });
    let (told, curve) = answer("curve", request);
    assert!(near(&told["largest"][2]));
    assert_eq!(
        3 * array(&curve, "angles").len(),
        array(&curve, "values").len()
    );

    let request = json!({ "function": f, "thetas": [0.0, 60.0], "phi": 0.0 });
    let total = array(&answer("albedo", request).1, "total");
    // The quadrature stops when two steps agree to 5e-4.
    assert!(total.iter().all(|a| (a - 0.5).abs() < 5e-4), "{total:?}");

    let (told, _) = answer("slice", json!({ "function": f, "phi_d": 90.0 }));
    assert_eq!(told["side"], 181);

    let request = json!({ "function": f, "wi": wi, "size": 8, "cosine": true });
    assert_eq!(array(&answer("hemisphere", request).1, "values").len(), 192);

    let request = json!({
        "functions": [f, "oren-nayar"], "kind": "polar", "theta": [30.0], "phi": 0.0, "scale": "auto",
        "channel": "luminance", "cosine": false,
    });
    let (told, _) = answer("plot", request);
    assert!(told["svg"].as_str().unwrap().starts_with("<svg"));
}

#[test]
fn a_mirror_has_a_spike() {
    let wi = angles(30.0, 180.0);
    let request = json!({ "function": "mirror", "wi": wi, "scale": "linear", "cosine": false });
    let spikes = array(&answer("lobe", request).1, "spikes");
    assert_eq!(spikes.len(), 6);
    assert!(
        (spikes[0] - 0.5).abs() < 1e-6 && spikes[3] > 0.0,
        "{spikes:?}"
    );
    let request = json!({ "function": "mirror", "wi": wi, "cosine": false });
    let angle = array(&answer("curve", request).1, "spikes")[0];
    assert!((angle - 30.0).abs() < 1e-4, "{angle}");
}

#[test]
fn light_comes_from_where_a_ball_says() {
    let request = json!({
        "function": "lambertian:1", "light": angles(60.0, 90.0), "size": 41,
        "factors": { "light": true, "brdf": true, "cosine": true },
    });
    let values = array(&answer("ball", request).1, "values");
    let at = |row: usize| values[3 * (41 * row + 20)];
    // From above: brighter at the top, where the surface faces the light.
    assert!(at(4) > at(20) && at(20) > at(36));
    // In the middle, cos 60° of a white surface that appears as 1.
    assert!((at(20) - 0.5).abs() < 1e-6);
}

fn picture(changes: Value) -> Value {
    let mut request = json!({
        "function": "lambertian:0.5", "object": "ball", "light": "uniform:1", "direction": angles(0.0, 0.0),
        "turn": 0.0, "width": 16, "height": 16, "first": 0, "count": 4, "bounces": 1,
        "factors": { "light": true, "brdf": true, "cosine": true },
    });
    for (key, value) in changes.as_object().unwrap() {
        request[key] = value.clone();
    }
    request
}

/// The pixel in the middle, divided by the samples.
fn middle(request: Value) -> f32 {
    let count = request["count"].as_f64().unwrap() as f32;
    let sums = array(&answer("render", request).1, "sums");
    sums[3 * (16 * 8 + 8)] / count
}

#[test]
fn parts_of_a_picture_add_up() {
    let sums = |changes: Value| array(&answer("render", picture(changes)).1, "sums");
    let whole = sums(json!({ "count": 8 }));
    let first = sums(json!({ "count": 3 }));
    let rest = sums(json!({ "first": 3, "count": 5 }));
    for ((a, b), sum) in first.iter().zip(&rest).zip(&whole) {
        // Each was rounded once, the sum here once more.
        let rounding = 4.0 * f32::EPSILON * sum.abs();
        assert!((a + b - sum).abs() <= rounding, "{a} + {b}, {sum}");
    }
}

/// With a factor off the others remain. In the middle of the ball every sample of uniform light lies in (0, 2 × the answer) but without the cosine, so
/// that the standard error of 1,024 is below 1/32 of the answer; the bounds are four times that. Without the cosine samples of the reflection function
/// have a weight 1 / cosθ, which multiple importance sampling bounds by that of the light's: half of the above is theirs.
#[test]
fn factors_of_a_picture() {
    let of = |light: &str, [light_on, brdf, cosine]: [bool; 3]| {
        let factors = json!({ "light": light_on, "brdf": brdf, "cosine": cosine });
        middle(picture(
            json!({ "light": light, "count": 1024, "factors": factors }),
        ))
    };
    let near = |found: f32, expected: f32| {
        assert!((found / expected - 1.0).abs() < 0.125, "{found} {expected}");
    };
    near(of("uniform:3", [true, true, true]), 1.5);
    // White under the light.
    near(of("uniform:3", [true, false, true]), 3.0);
    // Under light of 1, whatever the light is.
    near(of("uniform:3", [false, true, true]), 0.5);
    // ∫ 0.5/π dω over the hemisphere.
    near(of("uniform:1", [true, true, false]), 1.0);
}

#[test]
fn a_point_of_light_is_where_the_ball_has_it() {
    let direction = angles(60.0, 180.0);
    let request = picture(json!({ "light": "point", "direction": direction, "count": 16 }));
    let sums = array(&answer("render", request).1, "sums");
    let at = |column: usize| sums[3 * (16 * 8 + column)];
    // From the left: what faces it is bright, the right lies in the shadow.
    assert!(at(5) > 1.5 * at(8) && at(8) > 0.0, "{} {}", at(5), at(8));
    assert_eq!(at(12), 0.0);
}

#[test]
fn a_panorama_lies_as_the_library_has_it() {
    // The sun in the east, +x, a quarter of the width right of the middle, 30° high; in the middle of a pixel, as it is half of one wide.
    let light = "sky:elevation=30.5,azimuth=90.5";
    let request = json!({ "light": light, "width": 360, "height": 180 });
    let values = array(&answer("panorama", request).1, "values");
    let brightest = (0..360 * 180).max_by(|a, b| values[3 * a].total_cmp(&values[3 * b]));
    let at = brightest.unwrap();
    assert_eq!([at % 360, at / 360], [270, 59]);
}

#[test]
fn verdicts_come_with_witnesses() {
    let check =
        |function: &str| answer("check", json!({ "function": function, "effort": "quick" })).0;
    let report = check("lambertian");
    assert_eq!(report["passed"], true);
    assert!(report["verdicts"].as_array().unwrap().len() > 10);
    let report = check("phong:diffuse=0,specular=1,exponent=2,normalisation=published");
    let verdicts = report["verdicts"].as_array().unwrap();
    let energy = verdicts
        .iter()
        .find(|v| v["property"] == "energy_conservation");
    assert!(energy.unwrap()["witness"]["wo"]["theta_deg"].is_number());
}

#[test]
fn code_in_every_language() {
    for language in ["wgsl", "glsl", "hlsl", "msl", "osl"] {
        let request = json!({ "function": "ggx:metal=gold", "language": language });
        let (told, _) = answer("export", request);
        let text = told["text"].as_str().unwrap();
        assert!(text.contains("torrance_sparrow_eval"), "{language}");
    }
}

#[test]
fn files_are_read_and_read_again() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.wgsl");
    let function = path.to_str().unwrap();
    let write = |value: &str| {
        let text = format!("fn eval(wi: vec3f, wo: vec3f) -> vec3f {{ return vec3f({value}); }}\n");
        std::fs::write(&path, text).unwrap();
        answer("forget", json!({}));
    };
    let f = || {
        let directions = [angles(10.0, 0.0), angles(20.0, 0.0)];
        let request = json!({ "function": function, "wi": directions[0], "wo": directions[1] });
        answer("evaluate", request).0["f_per_sr"][0].as_f64()
    };
    write("0.25");
    assert_eq!(f(), Some(0.25));
    write("0.125");
    assert_eq!(f(), Some(0.125));
    // A mistake has its place.
    write("0.5 +");
    let complaint = error("describe", json!({ "function": function }));
    assert_eq!(complaint["place"]["line"], 1, "{complaint}");

    let broken = folder.path().join("broken.binary");
    std::fs::write(&broken, b"nonsense").unwrap();
    let broken = broken.to_str().unwrap();
    let complaint = error("describe", json!({ "function": broken }));
    let message = complaint["message"].as_str().unwrap();
    assert!(message.contains("broken.binary"), "{message}");
    error("file", json!({ "path": broken }));
    error("file", json!({ "path": folder.path() }));
}

#[test]
fn what_is_no_request_is_one_error() {
    let one = angles(0.0, 0.0);
    for (operation, request) in [
        ("dance", json!({})),
        ("catalogue", json!({ "a": 1 })),
        ("describe", json!({})),
        ("describe", json!({ "function": 3 })),
        ("describe", json!({ "function": "" })),
        ("describe", json!({ "function": "sum(ggx" })),
        (
            "lobe",
            json!({ "function": "ggx", "wi": one, "scale": "cubic", "cosine": false }),
        ),
        (
            "curve",
            json!({ "function": "ggx", "wi": angles(90.0, 0.0), "cosine": false }),
        ),
        (
            "albedo",
            json!({ "function": "ggx", "thetas": [90.0], "phi": 0.0 }),
        ),
        (
            "hemisphere",
            json!({ "function": "ggx", "wi": one, "size": 100_000, "cosine": false }),
        ),
        (
            "panorama",
            json!({ "light": "nowhere.hdr", "width": 4, "height": 2 }),
        ),
        ("check", json!({ "function": "ggx", "effort": "much" })),
        ("export", json!({ "function": "ggx", "language": "cobol" })),
        ("render", picture(json!({ "count": 0 }))),
        ("render", picture(json!({ "width": 0 }))),
        ("render", picture(json!({ "first": u32::MAX, "count": 2 }))),
        ("render", picture(json!({ "light": "uniform:-1" }))),
        ("render", picture(json!({ "object": "preview" }))),
    ] {
        error(operation, request);
    }
    for text in ["", "{", "[]", "null", r#"{"operation": "catalogue"}"#, "\0"] {
        let json = parsed(&call(text));
        assert!(json["error"]["message"].is_string(), "{text}: {json}");
    }
    // An error takes nothing away.
    middle(picture(json!({ "light": "uniform:0.5" })));
}

#[test]
fn bytes_are_lengths_text_and_numbers() {
    let request = json!({ "function": "ggx", "thetas": [0.0], "phi": 0.0 });
    let (_, whole) = answer("albedo", request);
    let (json, numbers) = (whole.json().to_owned(), whole.numbers().to_vec());
    let bytes = whole.into_bytes();
    let number = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!(number(0), bytes.len());
    assert_eq!(&bytes[8..8 + number(4)], json.as_bytes());
    let first = 8 + number(4).next_multiple_of(4);
    assert_eq!(bytes.len(), first + 4 * numbers.len());
    assert_eq!(bytes[first..first + 4], numbers[0].to_le_bytes());
}
