//! The lobe in space.

use crate::canvas::{Canvas, Colour, GRID, INK, Look, MUTED, PALETTE};
use crate::colours;
use crate::curves::direction;
use crate::depth::{Corner, Depth};
use crate::figure::{self, Figure, Place};
use crate::mesh::{Closeness, Mesh};
use crate::scale::{Scale, ScaleKind, number};
use crate::{Channel, Function, Options, PlotError, slice};
use gonio_num::Vec3;

/// Where it is seen from, degrees: across the plane of incidence, somewhat from its front.
const AZIMUTH: f64 = -62.0;
const ELEVATION: f64 = 24.0;
/// Pixels of the picture for each of the page.
const DENSITY: f64 = 1.6;

/// The lobes of functions in space: the distance of the surface from the centre is f in sr⁻¹ towards that direction, for light from the
/// first of [`Options::theta_deg`] (45° unless given), the orange line. Rings on the base have the values beside them; they lie in the surface's plane.
///
/// The surface is made of triangles that are halved until it is within 0.002 of the largest radius of them, and down to 0.01° around the directions
/// where a narrow lobe may stand. With [`Options::cosine`] it is f |cosθr|. With [`Channel::Rgb`] it has the colour that is reflected.
///
/// # Errors
/// [`PlotError::Count`] unless there are 1 to 8 functions; [`PlotError::Nothing`] for one that is 0 everywhere, as a mirror is;
/// [`PlotError::Option`].
pub fn lobe3d(functions: &[Function], options: &Options) -> Result<Figure, PlotError> {
    options.check(functions.len())?;
    let theta = options.thetas(&[45.0])[0];
    let wi = direction(-theta, options.phi_deg);
    let value = |c: [f64; 3]| options.channel.value(c);
    // The scale is known when the largest value is. The cube root bends a surface more than proportion does: what is flat enough on it is so on both.
    let kind = match options.scale {
        ScaleKind::Auto => ScaleKind::CubeRoot,
        kind => kind,
    };
    let radius = |largest: f64, c: [f64; 3]| {
        let scale = Scale::new(kind, largest * 1e-4, largest, false);
        let r = scale.position(value(c));
        if r.is_finite() { r } else { 0.0 }
    };
    let mut meshes = Vec::new();
    for f in functions {
        let mesh = Mesh::new(f, wi, options.cosine, &radius, &value, Closeness::FINE);
        if mesh.largest(&value) == 0.0 {
            return Err(slice::nothing(f));
        }
        meshes.push(mesh);
    }
    let scale = scale(&meshes, options, &value);
    let transmits = functions.iter().any(Function::transmits) || theta > 90.0;

    let canvas = Canvas::new(options.page_size(match functions.len() {
        1 => [600.0, if transmits { 640.0 } else { 500.0 }],
        count => colours::page(count, 0.0),
    }));
    let title = figure::title(functions, options);
    let gaps = |m: &Mesh| {
        m.corners
            .iter()
            .filter(|(_, c)| !value(*c).is_finite())
            .count()
    };
    let notes: Vec<String> = figure::gaps_note(meshes.iter().map(gaps).sum())
        .into_iter()
        .collect();
    let mut subtitle = format!(
        "{} in sr⁻¹ by direction, for light from θi = {}°",
        options.quantity(),
        number(theta)
    );
    subtitle += match scale.words() {
        "" => ", radius in proportion",
        "logarithmic" => ", radius logarithmic",
        _ => ", radius cube root",
    };
    if options.channel != Channel::Rgb {
        subtitle += &format!("; {}", options.channel.name());
    }
    let place = figure::header(&canvas, &title, &subtitle);
    let place = figure::footer(&canvas, place, &notes);
    let names: Vec<&str> = functions.iter().map(|f| f.name.as_str()).collect();
    let places = figure::panels(place, functions.len(), 1.1, 16.0);
    let places = colours::named(&canvas, &names, places);
    let mut words = subtitle;
    for (k, (mesh, place)) in meshes.iter().zip(places).enumerate() {
        let look = Shown {
            scale: &scale,
            options,
            colour: PALETTE[k % PALETTE.len()],
            wi,
            transmits,
        };
        look.draw(&canvas, place, mesh);
        let largest = number(mesh.largest(&value));
        words += &format!(" {}: largest value {largest} sr⁻¹.", names[k]);
    }
    Ok(Figure::new(canvas, &title, &words, notes))
}

/// The scale of all lobes: in proportion, unless one is thin or small beside another.
fn scale(meshes: &[Mesh], options: &Options, value: &dyn Fn([f64; 3]) -> f64) -> Scale {
    let peaks: Vec<f64> = meshes.iter().map(|m| m.largest(value)).collect();
    let most = peaks.iter().copied().fold(0.0, f64::max);
    let lowest = peaks.iter().copied().fold(f64::INFINITY, f64::min);
    // The solid angle in which a lobe is above a tenth of its peak, by the triangles that are.
    let wide = |mesh: &Mesh, peak: f64| -> f64 {
        let above = |k: u32| value(mesh.corners[k as usize].1) > 0.1 * peak;
        let triangles = mesh.triangles.iter();
        triangles
            .filter(|t| t.iter().all(|k| above(*k)))
            .map(|t| {
                let [a, b, c] = t.map(|k| mesh.corners[k as usize].0);
                0.5 * (b - a).cross(c - a).length()
            })
            .sum()
    };
    // 0.2 sr is a cone of 29° from side to side.
    let thin = lowest < 0.2 * most
        || meshes
            .iter()
            .zip(&peaks)
            .any(|(mesh, peak)| wide(mesh, *peak) < 0.2);
    let kind = match options.scale {
        ScaleKind::Auto if thin => ScaleKind::CubeRoot,
        ScaleKind::Auto => ScaleKind::Linear,
        kind => kind,
    };
    let values = meshes
        .iter()
        .flat_map(|m| &m.corners)
        .map(|(_, c)| value(*c));
    let least = values
        .filter(|x| *x > 1e-4 * most)
        .fold(f64::INFINITY, f64::min);
    Scale::new(kind, least, most, false)
}

/// How a lobe is shown.
struct Shown<'a> {
    scale: &'a Scale,
    options: &'a Options,
    colour: Colour,
    wi: Vec3<f64>,
    transmits: bool,
}

impl Shown<'_> {
    fn draw(&self, canvas: &Canvas, [x, y, w, h]: Place, mesh: &Mesh) {
        let size = [w, h].map(|s| (s * DENSITY).round().max(16.0) as usize);
        // The base is an ellipse of half height sin(elevation); above it stands at most a radius.
        let (base, tall) = (0.44, if self.transmits { 2.15 } else { 1.5 });
        let scale = (0.5 * w - 34.0).min((h - 24.0) / tall).max(10.0);
        let middle = if self.transmits {
            0.5 * h
        } else {
            0.5 * h + scale * 0.5 * (1.0 - base)
        };
        let pixels = [0.5 * w, middle].map(|s| s * DENSITY);
        let mut depth = Depth::new(size, AZIMUTH, ELEVATION, scale * DENSITY, pixels);
        self.base(&mut depth);
        self.surface(&mut depth, mesh);
        canvas.picture([x, y, w, h], size.map(|s| s as u32), depth.finish());
        let at = |p: Vec3<f64>| {
            let [px, py] = depth.place(p);
            [x + px / DENSITY, y + py / DENSITY]
        };
        self.labels(canvas, &at);
    }

    /// Rings, the plane of incidence, the normal and the light.
    fn base(&self, depth: &mut Depth) {
        let phi = self.options.phi_deg;
        let ring = |r: f64| -> Vec<Vec3<f64>> {
            (0..=180)
                .map(|k| direction(90.0, f64::from(2 * k)) * r)
                .map(|p| Vec3::new(p.x, p.y, 0.0))
                .collect()
        };
        for tick in self.scale.ticks().iter().filter(|t| !t.label.is_empty()) {
            let (colour, width) = if tick.position == 1.0 {
                (0x8c959f, 1.8)
            } else {
                (GRID, 1.5)
            };
            depth.line(&ring(tick.position), colour, width);
        }
        let across = direction(90.0, phi);
        let side = direction(90.0, phi + 90.0);
        depth.line(&[across * -1.0, across], 0x8c959f, 1.5);
        depth.line(&[side * -1.0, side], GRID, 1.5);
        let up = Vec3::new(0.0, 0.0, 1.0);
        depth.line(&[up * 0.0, up * 1.05], INK, 1.8);
        depth.line(&[self.wi * 0.0, self.wi * 1.15], 0xd55e00, 3.0);
    }

    fn surface(&self, depth: &mut Depth, mesh: &Mesh) {
        let value = |c: [f64; 3]| self.options.channel.value(c);
        let places: Vec<Vec3<f64>> = mesh
            .corners
            .iter()
            .map(|(w, c)| {
                let r = self.scale.position(value(*c));
                *w * if r.is_finite() { r } else { 0.0 }
            })
            .collect();
        let mut normals = vec![Vec3::new(0.0, 0.0, 0.0); places.len()];
        for t in &mesh.triangles {
            let [a, b, c] = t.map(|k| places[k as usize]);
            let n = (b - a).cross(c - a);
            for k in t {
                normals[*k as usize] += n;
            }
        }
        // A needle thinner than the picture's samples is still to be seen.
        let radius = |p: &&Vec3<f64>| p.length();
        let tip = places.iter().max_by(|a, b| radius(a).total_cmp(&radius(b)));
        if let Some(tip) = tip {
            depth.line(&[*tip * 0.0, *tip], self.colour, 1.4);
        }
        for t in &mesh.triangles {
            let corners = t.map(|k| Corner {
                at: places[k as usize],
                normal: normals[k as usize],
            });
            let colour = mesh.corners[t[0] as usize].1;
            depth.triangle(corners, self.own_colour(colour));
        }
    }

    /// The palette's colour, or the hue that is reflected.
    fn own_colour(&self, colour: [f64; 3]) -> [f32; 3] {
        let most = colour.iter().copied().fold(0.0, f64::max);
        if self.options.channel == Channel::Rgb && most > 0.0 && most.is_finite() {
            return colour.map(|c| (c / most).max(0.0) as f32);
        }
        let [_, r, g, b] = self.colour.to_be_bytes();
        // Lighter than a line, so that shades are seen.
        [r, g, b].map(|c| 0.15 + 0.85 * gonio_image::srgb::decode8(c))
    }

    fn labels(&self, canvas: &Canvas, at: &dyn Fn(Vec3<f64>) -> [f64; 2]) {
        let front = direction(90.0, AZIMUTH);
        let mut last = f64::NEG_INFINITY;
        for tick in self.scale.ticks().iter().filter(|t| !t.label.is_empty()) {
            let [x, y] = at(front * tick.position);
            if tick.position < 0.15 || y - last < 15.0 {
                continue;
            }
            last = y;
            let words = match tick.position {
                1.0 => format!("{} sr⁻¹", tick.label),
                _ => tick.label.clone(),
            };
            canvas.text(&words, [x, y + 9.0], Look::SMALL.centred().rimmed());
        }
        let look = Look::SMALL.centred().rimmed();
        let [x, y] = at(self.wi * 1.22);
        canvas.text("light", [x, y], look.coloured(0xd55e00));
        let [x, y] = at(Vec3::new(0.0, 0.0, 1.12));
        canvas.text("n", [x, y], look.coloured(MUTED));
    }
}
