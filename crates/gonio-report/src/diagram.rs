//! A pair of directions, drawn.

use gonio_num::{Real, Vec3};
use gonio_verify::Witness;

/// The camera's height above the surface, in degrees: low enough to tell directions near grazing from those that aren't.
const ELEVATION_DEG: f64 = 22.0;
/// Radius of the hemisphere and of the margin around it, in units of the picture.
const RADIUS: f64 = 100.0;
const MARGIN: f64 = 26.0;

/// Where a direction is in the picture: x to the right, y down.
fn project(w: Vec3<f64>, camera_deg: f64) -> (f64, f64) {
    let (sin, cos) = Real::sin_cos(ELEVATION_DEG.to_radians());
    let (s, c) = Real::sin_cos(camera_deg.to_radians());
    let (right, away) = (c * w.x + s * w.y, -s * w.x + c * w.y);
    (RADIUS * right, -RADIUS * (w.z * cos + away * sin))
}

/// An arrow from the centre, with its foot on the surface and its letter.
fn arrow(w: Vec3<f64>, camera_deg: f64, class: &str, label: &str) -> String {
    let (x, y) = project(w, camera_deg);
    let (fx, fy) = project(Vec3::new(w.x, w.y, 0.0), camera_deg);
    let length = (x * x + y * y).sqrt().max(1.0);
    let (ux, uy) = (x / length, y / length);
    // The head is a triangle of length 12 whose tip is the direction.
    let (bx, by) = (x - 12.0 * ux, y - 12.0 * uy);
    let head = format!(
        "{x:.1},{y:.1} {:.1},{:.1} {:.1},{:.1}",
        bx - 5.0 * uy,
        by + 5.0 * ux,
        bx + 5.0 * uy,
        by - 5.0 * ux
    );
    let (tx, ty) = (x + 13.0 * ux, y + 13.0 * uy + 4.0);
    format!(
        "<g class=\"{class}\"><path class=\"foot\" d=\"M0 0L{fx:.1} {fy:.1}L{x:.1} {y:.1}\"/>\
         <path class=\"ray\" d=\"M0 0L{bx:.1} {by:.1}\"/><polygon points=\"{head}\"/>\
         <text x=\"{tx:.1}\" y=\"{ty:.1}\">{label}</text></g>"
    )
}

/// The directions of a witness on the hemisphere (on the sphere, if one points below) as an SVG element, seen from where the
/// plane of incidence lies across. `None` if a direction isn't finite.
pub(crate) fn diagram(w: &Witness) -> Option<String> {
    let wo = w.wo.vector();
    let wi = w.wi.map(|d| d.vector());
    let all = wi.into_iter().chain([wo]);
    if !all.clone().all(|w| w.is_finite() && w.length() < 1.5) {
        return None;
    }
    let below = all.clone().any(|w| w.z < 0.0);
    // The direction that leans more lies in the picture's plane; a twelfth of a turn beyond, so that pairs in one plane with the
    // normal don't cover each other.
    let leaning = all.max_by(|a, b| a.z.abs().total_cmp(&b.z.abs()).reverse());
    let leaning = leaning.unwrap_or(wo);
    let azimuth: f64 = Real::atan2(leaning.y, leaning.x);
    let camera = azimuth.to_degrees() - 25.0;
    let (flat, tall): (f64, f64) = Real::sin_cos(ELEVATION_DEG.to_radians());
    let disc = RADIUS * flat;
    let bottom = if below { RADIUS } else { disc } + MARGIN;
    let (left, top) = (-RADIUS - MARGIN, -RADIUS - MARGIN);
    let mut svg = format!(
        "<svg class=\"pair\" viewBox=\"{left} {top} {} {}\" role=\"img\" aria-label=\"directions of the witness\">\
         <ellipse class=\"surface\" rx=\"{RADIUS}\" ry=\"{disc:.1}\"/>",
        2.0 * (RADIUS + MARGIN),
        bottom - top,
    );
    svg += &match below {
        true => format!("<circle class=\"dome\" r=\"{RADIUS}\"/>"),
        false => format!(
            "<path class=\"dome\" d=\"M{0} 0A{0} {0} 0 0 1 {RADIUS} 0\"/>",
            -RADIUS
        ),
    };
    let normal = RADIUS * tall;
    // Its letter stands beside it: at the tip it would meet a direction's.
    svg += &format!(
        "<path class=\"normal\" d=\"M0 0V{:.1}\"/><text class=\"faint\" x=\"-9\" y=\"{:.1}\">n</text>",
        -normal,
        -0.55 * normal
    );
    svg += &arrow(wo, camera, "wo", "ωr");
    if let Some(wi) = wi {
        svg += &arrow(wi, camera, "wi", "ωi");
    }
    svg += "</svg>";
    Some(svg)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pair_has_two_arrows_inside_the_picture() {
        let (a, b) = (Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.0, -1.0, 0.0));
        let svg = diagram(&Witness::pair(a, b)).unwrap();
        let tree = roxmltree::Document::parse(&svg).unwrap();
        let groups = tree.descendants().filter(|n| n.has_tag_name("g")).count();
        assert_eq!(groups, 2);
        let (x, y) = project(a, 10.0);
        assert!(x.hypot(y) <= RADIUS);
        assert!(diagram(&Witness::at(Vec3::new(f64::NAN, 0.0, 1.0))).is_none());
        // The whole sphere where one points below.
        let svg = diagram(&Witness::pair(a, Vec3::new(0.0, 0.6, -0.8))).unwrap();
        assert!(svg.contains("<circle"));
    }

    #[test]
    fn up_is_up_and_the_viewer_is_in_front() {
        assert!(project(Vec3::new(0.0, 0.0, 1.0), 0.0).1 < 0.0);
        assert!(project(Vec3::new(0.0, -1.0, 0.0), 0.0).1 > 0.0);
        assert_eq!(project(Vec3::new(1.0, 0.0, 0.0), 0.0).0, RADIUS);
    }
}
