//! The picture of a model's lobes, a small SVG: curves, arrows and a grid, written out here.

use super::lobe::{Axis, Lobe, VIEWERS, direction};
use super::words::significant;
use gonio_brdf::{Brdf, BrdfError, Model, ModelSpec};

/// Radius of the outer ring, in pixels.
const RADIUS: f64 = 200.0;
/// The surface's point.
const CENTRE: (f64, f64) = (320.0, 262.0);
/// The picture's width.
const WIDTH: f64 = 640.0;
/// How far, in pixels, a curve may be from the straight lines that draw it: too little to be seen.
const FLATNESS: f64 = 0.03;
/// The class of each viewer's colour.
const COLOURS: [&str; VIEWERS.len()] = ["a", "b", "c"];

/// Colours that differ to all eyes (Okabe & Ito 2008), on a ground of their own, light or dark as the reader has it.
const STYLE: &str = "\
text{font:13px system-ui,'Segoe UI',Roboto,Helvetica,Arial,sans-serif;fill:#3c4248;paint-order:stroke;stroke:#fff;stroke-width:3px;stroke-linejoin:round}\
.ground{fill:#fff;stroke:#d8dce0}.other{fill:#eef2f5}.grid{fill:none;stroke:#ccd1d6}.axis{fill:none;stroke:#3c4248;stroke-width:1.5}\
.small{font-size:11px;fill:#6a727a}.lobe{fill-opacity:.1;stroke-width:1.8;stroke-linejoin:round}.ray{fill:none;stroke-width:1.2;stroke-dasharray:1 5}\
.arrow{fill:none;stroke-width:2}.head{stroke-width:0}.n{fill:#3c4248}\
.a{stroke:#0072b2;fill:#0072b2}.b{stroke:#d55e00;fill:#d55e00}.c{stroke:#009e73;fill:#009e73}\
.lobe.b{stroke-dasharray:9 4}.lobe.c{stroke-dasharray:3.5 2.5}\
@media(prefers-color-scheme:dark){text{fill:#d5dade;stroke:#1d2125}.ground{fill:#1d2125;stroke:#3a4046}.other{fill:#262c32}\
.grid{stroke:#444b52}.axis{stroke:#d5dade}.n{fill:#d5dade}.small{fill:#9aa3ab}\
.a{stroke:#56b4e9;fill:#56b4e9}.b{stroke:#f0894a;fill:#f0894a}.c{stroke:#2cc79a;fill:#2cc79a}}";

/// The picture of a model, and the caption below it.
pub struct Picture {
    /// The file.
    pub svg: String,
    /// The caption, Markdown.
    pub caption: String,
}

/// Draws the lobes of what `spec` describes.
///
/// # Errors
/// If it cannot be built.
pub fn draw(spec: &ModelSpec) -> Result<Picture, BrdfError> {
    let model: Model<f64, 3> = spec.build()?;
    let lobes = VIEWERS.map(|viewer| Lobe::new(&model, viewer));
    let axis = Axis::new(&lobes);
    Ok(Picture {
        svg: svg(spec, &lobes, axis, model.transmits()),
        caption: caption(spec, &lobes, axis, model.transmits()),
    })
}

fn caption(spec: &ModelSpec, lobes: &[Lobe], axis: Axis, transmits: bool) -> String {
    let has_curve = axis.most > 0.0;
    let has_discrete = lobes.iter().any(|lobe| !lobe.discrete.is_empty());
    let mut text = format!("`{spec}` in the plane of incidence. ");
    if has_curve {
        text += "A curve shows f |cosθi| in sr⁻¹ (mean of the colours) for light from each direction, as the viewer of its colour \
                 sees it";
        text += if axis.cube_root {
            "; its radius is the **cube root** of the value, so that weak and strong lobes can be read together. "
        } else {
            "; its radius is the value. "
        };
    }
    if has_discrete {
        text += "A thick arrow is a discrete direction: towards the light, with the share of its radiance that reaches the viewer. ";
    }
    if transmits {
        text += "Below the horizon is light that comes through from the other side. ";
    }
    text.trim_end().to_owned()
}

fn svg(spec: &ModelSpec, lobes: &[Lobe], axis: Axis, transmits: bool) -> String {
    let bottom = CENTRE.1 + if transmits { RADIUS + 24.0 } else { 24.0 };
    let height = bottom + 40.0;
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height}\" width=\"{WIDTH}\" height=\"{height}\" role=\"img\">\n\
         <title>Lobes of {spec}</title>\n<style>{STYLE}</style>\n\
         <rect class=\"ground\" x=\".5\" y=\".5\" width=\"{}\" height=\"{}\" rx=\"6\"/>\n",
        WIDTH - 1.0,
        height - 1.0
    );
    grid(&mut out, axis, transmits);
    for (colour, lobe) in COLOURS.iter().zip(lobes) {
        curve(&mut out, colour, lobe, axis);
    }
    surface(&mut out);
    for ((colour, lobe), viewer) in COLOURS.iter().zip(lobes).zip(VIEWERS) {
        discrete(&mut out, colour, lobe);
        to_viewer(&mut out, colour, viewer);
    }
    scale(&mut out, axis);
    if transmits {
        let x = WIDTH - 20.0;
        text(&mut out, "small", "end", (x, CENTRE.1 + 40.0), "other side");
    }
    legend(&mut out, lobes, bottom + 18.0);
    out + "</svg>\n"
}

/// Rings of equal values, and a tick every 10°, as a spoke with its angle every 30°.
fn grid(out: &mut String, axis: Axis, transmits: bool) {
    let (left, right) = (-90.0, 90.0);
    let half = |radius: f64, clockwise: u8| {
        let (from, to) = (place(left, radius), place(right, radius));
        let radius = px(radius);
        format!(
            "M{}A{radius} {radius} 0 0 {clockwise} {}",
            point(from),
            point(to)
        )
    };
    if transmits {
        path(out, "other", &half(RADIUS, 0));
    }
    let mut radii: Vec<f64> = axis.rings().iter().map(|&v| axis.radius(v)).collect();
    if radii.is_empty() {
        radii.push(1.0);
    }
    for radius in radii {
        let mut ring = half(RADIUS * radius, 1);
        if transmits {
            ring += &half(RADIUS * radius, 0);
        }
        path(out, "grid", &ring);
    }
    let end = if transmits { 26 } else { 9 };
    let mut ticks = String::new();
    for tens in -9..=end {
        let degrees = f64::from(tens * 10);
        let spoke = tens % 3 == 0;
        let inner = if spoke { 0.0 } else { RADIUS - 6.0 };
        ticks += &segment(place(degrees, inner), place(degrees, RADIUS));
        if spoke {
            let (x, y) = place(degrees, RADIUS + 14.0);
            // From the nearer normal, outside or inside.
            let angle: i32 = if tens > 9 { 18 - tens } else { tens } * 10;
            let words = format!("{}°", angle.abs());
            text(out, "small", "middle", (x, y + 4.0), &words);
        }
    }
    path(out, "grid", &ticks);
}

/// The horizon and the normal.
fn surface(out: &mut String) {
    let horizon = segment(place(-90.0, RADIUS), place(90.0, RADIUS));
    path(
        out,
        "axis",
        &(horizon + &segment(CENTRE, place(0.0, RADIUS - 8.0))),
    );
    path(out, "head n", &head(0.0, RADIUS));
    text(
        out,
        "label",
        "start",
        (CENTRE.0 + 8.0, CENTRE.1 - RADIUS + 24.0),
        "n",
    );
}

/// The values of the rings, below the horizon on the side of the mirror direction; in the corner what they are.
fn scale(out: &mut String, axis: Axis) {
    for value in axis.rings() {
        let x = CENTRE.0 - RADIUS * axis.radius(value);
        let label = significant(value, 3);
        text(out, "small", "middle", (x, CENTRE.1 + 15.0), &label);
    }
    if axis.most > 0.0 {
        text(out, "label", "start", (20.0, 30.0), "f |cosθi| in sr⁻¹");
    }
    if axis.cube_root {
        text(out, "small", "start", (20.0, 48.0), "radius: cube root");
    }
}

fn curve(out: &mut String, colour: &str, lobe: &Lobe, axis: Axis) {
    if lobe.peak() == 0.0 {
        return;
    }
    let mut points = vec![CENTRE];
    for &(degrees, value) in &lobe.curve {
        points.push(place(degrees, RADIUS * axis.radius(value)));
    }
    points.push(CENTRE);
    let points: Vec<String> = simplified(&points).into_iter().map(point).collect();
    path(
        out,
        &format!("lobe {colour}"),
        &format!("M{}Z", points.join("L")),
    );
}

fn discrete(out: &mut String, colour: &str, lobe: &Lobe) {
    let tip = 0.78 * RADIUS;
    for &(degrees, share) in &lobe.discrete {
        arrow(out, colour, degrees, 0.0, tip);
        let (x, y) = place(degrees, tip + 20.0);
        text(out, "label", "middle", (x, y + 4.0), &significant(share, 3));
    }
}

/// The ray to the viewer: dotted across the lobes, an arrow beyond the outer ring.
fn to_viewer(out: &mut String, colour: &str, viewer: f64) {
    path(
        out,
        &format!("ray {colour}"),
        &segment(CENTRE, place(viewer, RADIUS)),
    );
    let tip = RADIUS + 34.0;
    arrow(out, colour, viewer, RADIUS + 6.0, tip);
    let (x, y) = place(viewer, tip + 6.0);
    text(
        out,
        "label",
        "start",
        (x, y + 4.0),
        &format!("viewer {viewer}°"),
    );
}

fn legend(out: &mut String, lobes: &[Lobe], y: f64) {
    let mut x = 32.0;
    for ((colour, lobe), viewer) in COLOURS.iter().zip(lobes).zip(VIEWERS) {
        let mut words = format!("θr = {viewer}°");
        if lobe.peak() > 0.0 {
            words += &format!(": up to {}", significant(lobe.peak(), 3));
        }
        let sample = segment((x, y - 4.0), (x + 22.0, y - 4.0));
        path(out, &format!("lobe {colour}"), &sample);
        text(out, "label", "start", (x + 28.0, y), &words);
        x += 200.0;
    }
}

/// An arrow away from the surface's point.
fn arrow(out: &mut String, colour: &str, degrees: f64, start: f64, tip: f64) {
    let shaft = segment(place(degrees, start), place(degrees, tip - 8.0));
    path(out, &format!("arrow {colour}"), &shaft);
    path(out, &format!("head {colour}"), &head(degrees, tip));
}

/// The head of an arrow whose tip is at `radius`.
fn head(degrees: f64, radius: f64) -> String {
    let w = direction(degrees);
    let (x, y) = place(degrees, radius - 10.0);
    let (across_x, across_y) = (4.5 * w.z, 4.5 * w.x);
    format!(
        "M{}L{}L{}Z",
        point(place(degrees, radius)),
        point((x + across_x, y + across_y)),
        point((x - across_x, y - across_y))
    )
}

/// The path that draws a straight line.
fn segment(from: (f64, f64), to: (f64, f64)) -> String {
    format!("M{}L{}", point(from), point(to))
}

fn path(out: &mut String, class: &str, d: &str) {
    *out += &format!("<path class=\"{class}\" d=\"{d}\"/>\n");
}

fn text(out: &mut String, class: &str, anchor: &str, (x, y): (f64, f64), words: &str) {
    let (x, y) = (px(x), px(y));
    *out += &format!(
        "<text class=\"{class}\" x=\"{x}\" y=\"{y}\" text-anchor=\"{anchor}\">{words}</text>\n"
    );
}

/// The place at `radius` pixels from the surface's point.
fn place(degrees: f64, radius: f64) -> (f64, f64) {
    let w = direction(degrees);
    (CENTRE.0 + radius * w.x, CENTRE.1 - radius * w.z)
}

/// A coordinate, to a hundredth of a pixel.
fn px(x: f64) -> String {
    format!("{}", (x * 100.0).round() / 100.0)
}

fn point((x, y): (f64, f64)) -> String {
    format!("{} {}", px(x), px(y))
}

/// The fewest of the points, roughly, whose straight lines stay within [`FLATNESS`] of all of them (Ramer 1972; Douglas & Peucker
/// 1973).
fn simplified(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut keep = vec![false; points.len()];
    let mut pending = vec![(0, points.len() - 1)];
    while let Some((first, last)) = pending.pop() {
        keep[first] = true;
        keep[last] = true;
        let mut worst = (first, FLATNESS);
        for k in first + 1..last {
            let d = distance(points[k], points[first], points[last]);
            if d > worst.1 {
                worst = (k, d);
            }
        }
        if worst.0 != first {
            pending.push((first, worst.0));
            pending.push((worst.0, last));
        }
    }
    points
        .iter()
        .zip(keep)
        .filter(|(_, keep)| *keep)
        .map(|(&p, _)| p)
        .collect()
}

/// How far `p` is from the straight line between `a` and `b`.
fn distance(p: (f64, f64), a: (f64, f64), b: (f64, f64)) -> f64 {
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let (px, py) = (p.0 - a.0, p.1 - a.1);
    let squared = dx * dx + dy * dy;
    let along = if squared > 0.0 {
        ((px * dx + py * dy) / squared).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let (x, y) = (px - along * dx, py - along * dy);
    (x * x + y * y).sqrt()
}
