//! Plots hold what they show: closed forms read back from their curves, files that others can read, the same bytes each time.

#![allow(clippy::unwrap_used)]

use gonio_num::{Real, Vec3};
use gonio_plot::{
    Axes, Channel, Draw, Figure, Function, Line, Options, Picture, PlotError, ScaleKind, albedo,
    cartesian, difference, lobe3d, pictures, polar, slice, sphere,
};
use std::f64::consts::PI;

type Plot = fn(&[Function], &Options) -> Result<Figure, PlotError>;

/// Every kind that takes one function.
const KINDS: [(&str, Plot); 6] = [
    ("polar", polar),
    ("cartesian", cartesian),
    ("albedo", albedo),
    ("slice", slice),
    ("lobe3d", lobe3d),
    ("sphere", sphere),
];

fn above(wi: Vec3<f64>, wo: Vec3<f64>) -> bool {
    wi.z > 0.0 && wo.z > 0.0
}

fn lambertian(albedo: f64) -> Function<'static> {
    Function::new(format!("lambertian {albedo}"), move |wi, wo| {
        [if above(wi, wo) { albedo / PI } else { 0.0 }; 3]
    })
}

/// A Blinn–Phong lobe.
fn shiny() -> Function<'static> {
    Function::new("shiny", |wi, wo| {
        let lobe = Real::powf((wi + wo).normalize().z.max(0.0), 100.0);
        [0.1, 0.2, 0.4].map(|c| if above(wi, wo) { c + lobe } else { 0.0 })
    })
}

fn mirror() -> Function<'static> {
    Function::new("mirror", |_, _| [0.0; 3]).with_discrete(|wo, _| {
        Some(Draw {
            wi: Vec3::new(-wo.x, -wo.y, wo.z),
            weight: [0.9; 3],
            probability: 1.0,
        })
    })
}

/// The corners of each line of a colour: the path's numbers, relative after the first two.
fn lines(svg: &str, colour: &str) -> Vec<Vec<[f64; 2]>> {
    let document = roxmltree::Document::parse(svg).unwrap();
    let paths = document
        .descendants()
        .filter(|n| n.has_tag_name("path") && n.attribute("stroke") == Some(colour));
    paths
        .map(|n| {
            let numbers = numbers(n.attribute("d").unwrap());
            let mut at = [0.0, 0.0];
            let mut corners = Vec::new();
            for pair in numbers.chunks(2) {
                at = [at[0] + pair[0], at[1] + pair[1]];
                corners.push(at);
            }
            corners
        })
        .collect()
}

fn numbers(path: &str) -> Vec<f64> {
    let spaced = path.replace(['M', 'l', 'z'], " ").replace('-', " -");
    spaced
        .split_whitespace()
        .map(|word| word.parse().unwrap())
        .collect()
}

const FIRST: &str = "#0072b2";
const INK: &str = "#24292f";

/// Each corner is rounded to a hundredth of a pixel after the one before it: that doesn't add up, as positions are rounded, not steps.
const ROUNDING: f64 = 0.01;
/// How far a curve may be from what it draws: 0.05 pixels for bends, half of that for thinning out.
const FLATNESS: f64 = 0.075;

/// ρ/π cosθ in polar coordinates is the circle through the centre whose diameter is ρ/π, upwards.
#[test]
fn the_lambertian_lobe_with_the_cosine_is_a_circle() {
    let options = Options {
        cosine: true,
        theta_deg: vec![20.0],
        scale: ScaleKind::Linear,
        ..Options::default()
    };
    let svg = polar(&[lambertian(0.8)], &options).unwrap();
    let all = lines(svg.svg(), FIRST);
    let curve = all.iter().max_by_key(|l| l.len()).unwrap();
    // The horizon is as wide as the outer ring, whose value is 0.3.
    let horizon = lines(svg.svg(), INK);
    let radius = 0.5 * (horizon[0][1][0] - horizon[0][0][0]);
    let centre = curve[0];
    let half = 0.5 * radius * (0.8 / PI) / 0.3;
    let off = |p: [f64; 2]| {
        let (x, y) = (p[0] - centre[0], p[1] - (centre[1] - half));
        ((x * x + y * y).sqrt() - half).abs()
    };
    // Corners are on the circle; the middles of chords are as far from it as flatness allows.
    for pair in curve.windows(2) {
        assert!(
            off(pair[0]) < 2.0 * ROUNDING,
            "{:?}: {}",
            pair[0],
            off(pair[0])
        );
        let middle = [0, 1].map(|k| 0.5 * (pair[0][k] + pair[1][k]));
        assert!(
            off(middle) < FLATNESS + ROUNDING,
            "{middle:?}: {}",
            off(middle)
        );
    }
    let top = curve.iter().map(|p| p[1]).fold(f64::INFINITY, f64::min);
    assert!((centre[1] - top - 2.0 * half).abs() < FLATNESS + ROUNDING);
    // Without the cosine it is another curve: the test can fail.
    let plain = Options {
        cosine: false,
        ..options
    };
    let svg = polar(&[lambertian(0.8)], &plain).unwrap();
    let all = lines(svg.svg(), FIRST);
    let curve = all.iter().max_by_key(|l| l.len()).unwrap();
    assert!(curve.iter().any(|p| off(*p) > 5.0));
}

/// The rectangle between the axes, from their lines: left, top, width, height.
fn rectangle(svg: &str) -> [f64; 4] {
    let axes = lines(svg, INK);
    let points: Vec<[f64; 2]> = axes
        .into_iter()
        .filter(|l| l.len() == 2)
        .flatten()
        .collect();
    let range = |k: usize| {
        let all = points.iter().map(|p| p[k]);
        let low = all.clone().fold(f64::INFINITY, f64::min);
        (low, all.fold(f64::NEG_INFINITY, f64::max))
    };
    let ((_, right), (top, _)) = (range(0), range(1));
    // Ticks stick out to the left and below, 5 pixels.
    let (left, bottom) = (range(0).0 + 5.0, range(1).1 - 5.0);
    [left, top, right - left, bottom - top]
}

/// f = cosθo/π gives a(θo) = ∫ cosθo/π cosθi dωi = cosθo.
#[test]
fn the_albedo_of_a_known_function_is_its_closed_form() {
    let f = Function::new("known", |wi: Vec3<f64>, wo: Vec3<f64>| {
        [if above(wi, wo) { wo.z / PI } else { 0.0 }; 3]
    });
    let svg = albedo(&[f], &Options::default()).unwrap();
    let [left, top, w, h] = rectangle(svg.svg());
    let all = lines(svg.svg(), FIRST);
    let curve = all.iter().max_by_key(|l| l.len()).unwrap();
    assert!(curve.len() > 10);
    for p in curve {
        let theta = 90.0 * (p[0] - left) / w;
        let shown = 1.0 - (p[1] - top) / h;
        let expected = Real::cos(theta.to_radians());
        // The quadrature's tolerance, 0.0005, and a pixel: the place of the axes is known to that.
        assert!(
            (shown - expected).abs() < 0.0005 + 1.0 / h,
            "{theta} {shown} {expected}"
        );
    }
}

/// f = (θo/90°)².
#[test]
fn cartesian_curves_are_where_their_values_are() {
    let f = Function::new("angle", |_, wo: Vec3<f64>| {
        let share = Real::acos(wo.z) / (0.5 * PI);
        [share * share; 3]
    });
    let options = Options {
        theta_deg: vec![10.0],
        scale: ScaleKind::Linear,
        ..Options::default()
    };
    let svg = cartesian(&[f], &options).unwrap();
    let [left, top, w, h] = rectangle(svg.svg());
    let all = lines(svg.svg(), FIRST);
    let curve = all
        .iter()
        .filter(|l| l.len() > 2)
        .max_by_key(|l| l.len())
        .unwrap();
    for p in curve {
        let theta = -90.0 + 180.0 * (p[0] - left) / w;
        let shown = 1.0 - (p[1] - top) / h;
        assert!(
            (shown - theta * theta / 8100.0).abs() < 2.0 / h,
            "{theta} {shown}"
        );
    }
}

#[test]
fn files_are_sound_and_have_the_size_asked_for() {
    for (name, plot) in KINDS {
        for size in [None, Some([200, 200]), Some([300, 600])] {
            let options = Options {
                size,
                ..Options::default()
            };
            let figure = plot(&[shiny()], &options).unwrap();
            let document = roxmltree::Document::parse(figure.svg()).unwrap();
            let root = document.root_element();
            assert_eq!(root.attribute("role"), Some("img"), "{name}");
            let text = |tag| {
                let node = root.children().find(|n| n.has_tag_name(tag)).unwrap();
                node.text().unwrap().to_owned()
            };
            assert_eq!(text("title"), "shiny", "{name}");
            assert!(text("desc").len() > 20, "{name}");
            // Nothing from elsewhere.
            for node in document.descendants() {
                for attribute in node.attributes().filter(|a| a.name() == "href") {
                    assert!(attribute.value().starts_with("data:image/png;base64,"));
                }
            }
            let numbers = document.descendants().flat_map(|n| n.attributes());
            for a in numbers.filter(|a| a.name() != "href" && a.name() != "font-family") {
                let value = a.value();
                assert!(
                    !value.contains("NaN") && !value.contains("inf"),
                    "{name}: {value}"
                );
            }
            let [w, h] = figure.size().map(|x| x as u32);
            if let Some(size) = size {
                assert_eq!([w, h], size, "{name}");
            }
            let png = image::load_from_memory(&figure.png(1.0).unwrap()).unwrap();
            assert_eq!((png.width(), png.height()), (w, h), "{name}");
        }
    }
}

/// The title is drawn with the embedded font: dark pixels where it stands, and more of them for a longer one.
#[test]
fn text_is_there_without_fonts_of_the_system() {
    let dark = |title: &str| {
        let options = Options {
            title: Some(title.into()),
            ..Options::default()
        };
        let figure = polar(&[lambertian(0.5)], &options).unwrap();
        let png = image::load_from_memory(&figure.png(2.0).unwrap())
            .unwrap()
            .to_rgb8();
        assert_eq!(png.width(), 2 * figure.size()[0] as u32);
        let head = image::imageops::crop_imm(&png, 0, 0, png.width(), 2 * 36).to_image();
        head.pixels().filter(|p| p.0[0] < 100).count()
    };
    let (none, short, long) = (
        dark(" "),
        dark("Gold"),
        dark("Gold, θ = 30°, sr⁻¹, f |cos θr|"),
    );
    assert_eq!(none, 0);
    assert!(short > 200 && long > 3 * short, "{short} {long}");
}

#[test]
fn the_same_bytes_each_time() {
    let options = Options {
        size: Some([700, 400]),
        ..Options::default()
    };
    for (name, plot) in KINDS {
        let draw = || {
            let figure = plot(&[shiny(), lambertian(0.5)], &options).unwrap();
            (figure.svg().to_owned(), figure.png(1.0).unwrap())
        };
        assert!(draw() == draw(), "{name}");
    }
}

#[test]
fn a_dirac_delta_is_an_arrow_with_its_share_or_a_clear_error() {
    for (name, plot) in KINDS {
        let drawn = plot(&[mirror()], &Options::default());
        if ["slice", "lobe3d"].contains(&name) {
            let message = drawn.unwrap_err().to_string();
            assert!(
                message.starts_with("mirror: ") && message.contains("Dirac"),
                "{message}"
            );
        } else {
            let figure = drawn.unwrap();
            if name != "albedo" {
                assert!(
                    figure.notes().iter().any(|n| n.contains("Dirac delta")),
                    "{name}"
                );
            }
            if ["polar", "cartesian"].contains(&name) {
                assert!(figure.svg().contains(">0.9</text>"), "{name}");
            }
        }
    }
    // All of it is found by the albedo: a line at 0.9.
    let figure = albedo(&[mirror()], &Options::default()).unwrap();
    assert!(
        figure.svg().contains("mirror: 0.9 at 0°"),
        "{}",
        figure.svg()
    );
}

#[test]
fn values_that_are_not_finite_are_gaps_and_counted() {
    let broken = || {
        Function::new("broken", |wi: Vec3<f64>, wo: Vec3<f64>| match wo.x {
            x if x > 0.5 => [f64::NAN; 3],
            x if x < -0.9 => [f64::INFINITY; 3],
            _ => [wi.z; 3],
        })
    };
    for (name, plot) in KINDS {
        let figure = plot(&[broken()], &Options::default()).unwrap();
        assert!(
            figure.notes().iter().any(|n| n.contains("not finite")),
            "{name}"
        );
        figure.png(1.0).unwrap();
    }
    // A batch that is answered in part.
    let short = Function::batched("short", |pairs| vec![[0.1; 3]; pairs.len() / 2]);
    let figure = polar(&[short], &Options::default()).unwrap();
    assert!(figure.notes().iter().any(|n| n.contains("not finite")));
}

#[test]
fn names_are_only_text() {
    let name = "<script>alert('&\"')</script>\u{0}\u{7}";
    let f = Function::new(name, |_, _| [0.2; 3]);
    let figure = polar(&[f, lambertian(0.5)], &Options::default()).unwrap();
    let document = roxmltree::Document::parse(figure.svg()).unwrap();
    assert!(document.descendants().all(|n| !n.has_tag_name("script")));
    figure.png(1.0).unwrap();
}

#[test]
fn eight_functions_and_no_more() {
    for (name, plot) in KINDS {
        let all = |n: usize| {
            (0..n)
                .map(|k| lambertian(0.1 * (k + 1) as f64))
                .collect::<Vec<_>>()
        };
        for channel in [Channel::Luminance, Channel::Rgb] {
            let options = Options {
                channel,
                size: Some([1100, 600]),
                ..Options::default()
            };
            let figure = plot(&all(8), &options).unwrap();
            for k in 1..=8 {
                let shown = format!("lambertian {}", 0.1 * f64::from(k));
                assert!(figure.svg().contains(&shown), "{name}: {shown}");
            }
        }
        for count in [0, 9] {
            let error = plot(&all(count), &Options::default()).unwrap_err();
            let expected = PlotError::Count {
                found: count,
                expected: "1 to 8",
            };
            assert_eq!(error, expected, "{name}");
        }
    }
    let one = difference(&[lambertian(0.5)], &Options::default()).unwrap_err();
    assert!(one.to_string().contains("2 to compare"), "{one}");
}

#[test]
fn options_that_make_no_sense() {
    let wrong = [
        Options {
            theta_deg: vec![90.0],
            ..Options::default()
        },
        Options {
            theta_deg: vec![-1.0],
            ..Options::default()
        },
        Options {
            theta_deg: vec![f64::NAN],
            ..Options::default()
        },
        Options {
            theta_deg: vec![10.0; 9],
            ..Options::default()
        },
        Options {
            phi_deg: f64::INFINITY,
            ..Options::default()
        },
        Options {
            phi_d_deg: f64::NAN,
            ..Options::default()
        },
        Options {
            size: Some([100, 400]),
            ..Options::default()
        },
        Options {
            size: Some([400, 20_000]),
            ..Options::default()
        },
    ];
    for options in wrong {
        for (name, plot) in KINDS {
            let error = plot(&[lambertian(0.5)], &options).unwrap_err();
            assert!(matches!(error, PlotError::Option { .. }), "{name}: {error}");
        }
    }
    let figure = polar(&[lambertian(0.5)], &Options::default()).unwrap();
    for density in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e6] {
        assert!(figure.png(density).is_err(), "{density}");
    }
    assert!("loud".parse::<Channel>().is_err() && "square".parse::<ScaleKind>().is_err());
}

/// Where a picture is in the plot: the first one, without the bar's.
fn picture(figure: &Figure, at: [f64; 2]) -> [u8; 3] {
    let document = roxmltree::Document::parse(figure.svg()).unwrap();
    let node = document
        .descendants()
        .find(|n| n.has_tag_name("image"))
        .unwrap();
    let [x, y, w, h] =
        ["x", "y", "width", "height"].map(|a| node.attribute(a).unwrap().parse::<f64>().unwrap());
    let png = image::load_from_memory(&figure.png(1.0).unwrap())
        .unwrap()
        .to_rgb8();
    png.get_pixel((x + at[0] * w) as u32, (y + at[1] * h) as u32)
        .0
}

fn brightness(rgb: [u8; 3]) -> u32 {
    rgb.iter().map(|c| u32::from(*c)).sum()
}

/// A highlight is at the left edge of a slice, retro-reflection at the bottom, a sphere's light above and to the left.
#[test]
fn pictures_are_the_right_way_round() {
    let highlight = Function::new("highlight", |wi, wo| {
        [0.01 + Real::powf((wi + wo).normalize().z.max(0.0), 200.0); 3]
    });
    let figure = slice(&[highlight], &Options::default()).unwrap();
    let [left, right] = [0.01, 0.9].map(|x| brightness(picture(&figure, [x, 0.5])));
    assert!(left > right + 200, "{left} {right}");
    let retro = Function::new("retro", |wi: Vec3<f64>, wo: Vec3<f64>| {
        [0.01 + Real::powf(wi.dot(wo).max(0.0), 200.0); 3]
    });
    let figure = slice(&[retro], &Options::default()).unwrap();
    let [top, bottom] = [0.1, 0.99].map(|y| brightness(picture(&figure, [0.5, y])));
    assert!(bottom > top + 200, "{top} {bottom}");
    let figure = sphere(&[lambertian(0.8)], &Options::default()).unwrap();
    let [lit, dark] = [[0.3, 0.3], [0.75, 0.75]].map(|at| brightness(picture(&figure, at)));
    assert!(lit > dark + 200, "{lit} {dark}");
}

#[test]
fn rendered_pictures_keep_their_pixels() {
    let red = Picture {
        name: "red".into(),
        size: [8, 8],
        rgb: [200, 10, 20].repeat(64),
    };
    let figure = pictures(&[red], &Options::default(), "A square").unwrap();
    assert_eq!(picture(&figure, [0.5, 0.5]), [200, 10, 20]);
}

#[test]
fn plots_are_small() {
    // Bytes: what a page with a few of them can bear.
    for (name, plot, most) in [
        ("polar", polar as Plot, 45_000),
        ("cartesian", cartesian, 45_000),
        ("albedo", albedo, 15_000),
        ("slice", slice, 60_000),
    ] {
        let figure = plot(&[shiny()], &Options::default()).unwrap();
        assert!(figure.svg().len() < most, "{name}: {}", figure.svg().len());
    }
}

/// A line of slope 1 and one of decades, read back from the file: both are straight in their scale.
#[test]
fn lines_are_where_their_points_are() {
    let axes = Axes {
        subtitle: "made up",
        x: "code",
        x_ends: [0.0, 100.0],
        x_step: 20.0,
        y: "exposure",
        channels: false,
    };
    let line = |name: &str, f: &dyn Fn(f64) -> f64| Line {
        name: name.into(),
        points: (0..=100).map(|x| [f64::from(x), f(f64::from(x))]).collect(),
    };
    for (scale, f) in [
        (ScaleKind::Linear, (|x| 2.0 * x) as fn(f64) -> f64),
        (ScaleKind::Log, |x| Real::exp(0.05 * x)),
    ] {
        let options = Options {
            scale,
            title: Some("A line".into()),
            ..Options::default()
        };
        let figure = gonio_plot::lines(&[line("straight", &f)], &axes, &options).unwrap();
        // The legend's sample is a line of two points.
        let found = lines(figure.svg(), FIRST);
        let drawn = found.iter().max_by_key(|l| l.len()).unwrap();
        let ([a, b], [c, d]) = (drawn[0], drawn[drawn.len() - 1]);
        assert!(c > a + 300.0 && d < b, "{drawn:?}");
        for [x, y] in drawn {
            // Hundredths of a pixel.
            assert!((b + (d - b) * (x - a) / (c - a) - y).abs() < 0.05);
        }
        assert!(figure.svg().contains("exposure") && figure.svg().contains("straight"));
    }
    // What has no logarithm leaves a gap.
    let broken = line("broken", &|x| {
        if (40.0..60.0).contains(&x) {
            0.0
        } else {
            1.0 + x
        }
    });
    let log = Options {
        scale: ScaleKind::Log,
        ..Options::default()
    };
    let figure = gonio_plot::lines(&[broken], &axes, &log).unwrap();
    let pieces = lines(figure.svg(), FIRST);
    assert_eq!(pieces.iter().filter(|l| l.len() > 2).count(), 2);
    assert!(matches!(
        gonio_plot::lines(&[], &axes, &log),
        Err(PlotError::Count { .. })
    ));
    let backwards = Axes {
        x_ends: [1.0, 0.0],
        ..axes
    };
    assert!(gonio_plot::lines(&[line("a", &|x| x)], &backwards, &log).is_err());
}
