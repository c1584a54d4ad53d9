//! Pictures inside plots: values as colours, the bar that explains them, and pictures side by side.

use crate::Channel;
use crate::canvas::{Canvas, INK, Look, Stroke};
use crate::figure::{self, Place};
use crate::font;
use crate::scale::Scale;
use gonio_image::{colormap, srgb};

/// The colour of values that are not finite: none of the maps has it.
pub(crate) const NOT_FINITE: [u8; 3] = [0x00, 0xc8, 0xff];
/// The colour of pairs of directions of which one lies below the horizon.
pub(crate) const BELOW: [u8; 3] = [0xd0, 0xd7, 0xde];

/// The colour of f. One number has a false colour, magma; for three the largest stands on the scale as the brightness, and the others are in
/// proportion to it.
pub(crate) fn of_value(channel: Channel, scale: &Scale, colour: [f64; 3]) -> [u8; 3] {
    if channel != Channel::Rgb {
        let value = channel.value(colour);
        return if value.is_finite() {
            colormap::magma_srgb8(scale.position(value) as f32)
        } else {
            NOT_FINITE
        };
    }
    if colour.iter().any(|x| !x.is_finite()) {
        return NOT_FINITE;
    }
    let most = colour.iter().copied().fold(0.0, f64::max);
    if most == 0.0 {
        return [0; 3];
    }
    let brightness = srgb::decode(scale.position(most));
    colour.map(|x| srgb::encode8((x.max(0.0) / most * brightness) as f32))
}

/// The colour of a difference from −1 to 1: blue for less, white for none, red for more (after ColorBrewer's RdBu, Harrower & Brewer 2003).
pub(crate) fn of_difference(share: f64) -> [u8; 3] {
    const LESS: [[f64; 3]; 3] = [[247.0; 3], [103.0, 169.0, 207.0], [5.0, 48.0, 97.0]];
    const MORE: [[f64; 3]; 3] = [[247.0; 3], [239.0, 138.0, 98.0], [103.0, 0.0, 31.0]];
    if !share.is_finite() {
        return NOT_FINITE;
    }
    let stops = if share < 0.0 { LESS } else { MORE };
    let at = 2.0 * share.abs().min(1.0);
    let (k, part) = if at < 1.0 { (0, at) } else { (1, at - 1.0) };
    [0, 1, 2].map(|c| (stops[k][c] + part * (stops[k + 1][c] - stops[k][c])).round() as u8)
}

/// Room that a bar with its labels takes.
pub(crate) const BAR: f64 = 84.0;

/// Draws a bar of colours with the values that they stand for: `colour` by position from 0 at the bottom to 1 at the top.
pub(crate) fn bar(
    canvas: &Canvas,
    [x, y, h]: [f64; 3],
    colour: &dyn Fn(f64) -> [u8; 3],
    ticks: &[(f64, String)],
    words: &str,
) {
    let steps = 256_u32;
    let rgb = (0..steps)
        .rev()
        .flat_map(|k| colour(f64::from(k) / f64::from(steps - 1)));
    let width = 14.0;
    canvas.picture([x, y, width, h], [1, steps], rgb.collect());
    canvas.rectangle([x, y, width, h], Stroke::new(INK, 0.8));
    let mut last = f64::INFINITY;
    for (position, label) in ticks.iter().filter(|(_, label)| !label.is_empty()) {
        let at = y + h * (1.0 - position);
        // Labels that would touch are left out.
        if (last - at).abs() < 14.0 {
            continue;
        }
        last = at;
        let tick = [[x + width, at], [x + width + 4.0, at]];
        canvas.line(&tick, Stroke::new(INK, 0.8));
        canvas.text(label, [x + width + 8.0, at], Look::SMALL);
    }
    let look = Look {
        down: 1,
        ..Look::SMALL
    };
    canvas.text(words, [x, y - 6.0], look);
}

/// As [`bar`], for the values of a scale.
pub(crate) fn scale_bar(canvas: &Canvas, place: [f64; 3], channel: Channel, scale: &Scale) {
    let ticks = scale.ticks().into_iter();
    let ticks: Vec<_> = ticks.map(|t| (t.position, t.label)).collect();
    let colour = |p: f64| of_value(channel, scale, [scale.value(p); 3]);
    bar(canvas, place, &colour, &ticks, "f in sr⁻¹");
}

/// Draws the names of several functions above their panels; returns the panels' places below them.
pub(crate) fn named(canvas: &Canvas, names: &[&str], places: Vec<Place>) -> Vec<Place> {
    if names.len() < 2 {
        return places;
    }
    let below = |([x, y, w, h], name): (Place, &&str)| {
        let look = Look {
            down: -1,
            ..Look::LABEL.bold()
        };
        canvas.text(&font::fitted(name, look.size, true, w), [x, y], look);
        [x, y + 20.0, w, h - 20.0]
    };
    places.into_iter().zip(names).map(below).collect()
}

/// The note on values that are not finite.
pub(crate) fn gaps_note(gaps: usize) -> Option<String> {
    (gaps > 0).then(|| format!("{gaps} values were not finite: they are light blue."))
}

/// The page's size for `count` square pictures, with `beside` pixels next to them.
pub(crate) fn page(count: usize, beside: f64) -> [f64; 2] {
    if count == 1 {
        return [520.0 + beside, 590.0];
    }
    let [w, h] = figure::page_of_panels(count, 1.0);
    [w - 180.0 + beside + 2.0 * figure::MARGIN, h]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ScaleKind;

    #[test]
    fn differences_have_opposite_colours() {
        assert_eq!(of_difference(0.0), [247; 3]);
        let ([r, _, b], [r2, _, b2]) = (of_difference(-1.0), of_difference(1.0));
        assert!(b > r && r2 > b2);
        assert_eq!(of_difference(f64::NAN), NOT_FINITE);
        assert_eq!(of_difference(3.0), of_difference(1.0));
    }

    #[test]
    fn hues_stay_and_brightness_follows_the_scale() {
        let scale = Scale::new(ScaleKind::Log, 0.01, 100.0, false);
        let [r, g, b] = of_value(Channel::Rgb, &scale, [1.0, 0.5, 0.0]);
        // Half of the way: code 128 of the largest; the other in proportion before encoding.
        assert!(r == 128 && g > 80 && g < 100 && b == 0, "{r} {g} {b}");
        assert_eq!(of_value(Channel::Rgb, &scale, [0.0; 3]), [0; 3]);
        assert_eq!(
            of_value(Channel::Luminance, &scale, [f64::NAN; 3]),
            NOT_FINITE
        );
        assert_eq!(
            of_value(Channel::Luminance, &scale, [1e9; 3]),
            [0xfb, 0xfc, 0xbf]
        );
    }
}
