//! The embedded font: plots have the same text on a machine without fonts.
//!
//! Inter 3.19 in two weights, reduced to Latin, Greek, figures and the signs of mathematics (SIL Open Font License 1.1, in `fonts/`).

use resvg::usvg::fontdb;
use skrifa::instance::{LocationRef, Size};
use skrifa::{FontRef, MetadataProvider};
use std::sync::{Arc, LazyLock};

const REGULAR: &[u8] = include_bytes!("../fonts/Inter-Regular.otf");
const SEMIBOLD: &[u8] = include_bytes!("../fonts/Inter-SemiBold.otf");

/// Names of the font in an SVG: a reader without Inter sees the text in the system's own.
pub(crate) const FAMILY: &str =
    "Inter,system-ui,'Segoe UI',Roboto,'Helvetica Neue',Arial,sans-serif";

/// Height of a capital letter over the size of the font.
pub(crate) const CAPITAL: f64 = 2048.0 / 2816.0;

/// How much of the size of the font reaches below the base line.
pub(crate) const DESCENT: f64 = 680.0 / 2816.0;

/// The width of `text` in the unit of `size`. A letter that the font doesn't have is as wide as its box for missing ones.
pub(crate) fn width(text: &str, size: f64, bold: bool) -> f64 {
    let Ok(font) = FontRef::new(if bold { SEMIBOLD } else { REGULAR }) else {
        return 0.6 * size * text.chars().count() as f64;
    };
    let metrics = font.glyph_metrics(Size::new(1.0), LocationRef::default());
    let letters = font.charmap();
    let advances = text.chars().map(|c| {
        let glyph = letters.map(c).unwrap_or_default();
        f64::from(metrics.advance_width(glyph).unwrap_or(0.6))
    });
    advances.sum::<f64>() * size
}

/// `text`, cut with an ellipsis so that it is at most `most` wide.
pub(crate) fn fitted(text: &str, size: f64, bold: bool, most: f64) -> String {
    if width(text, size, bold) <= most {
        return text.into();
    }
    let mut letters: Vec<char> = text.chars().collect();
    while !letters.is_empty() {
        letters.pop();
        let cut: String = letters.iter().chain(&['…']).collect();
        if width(&cut, size, bold) <= most {
            return cut;
        }
    }
    String::new()
}

/// `text` in at most `lines` lines of at most `most`, broken after commas, colons, parentheses and spaces; what is left over ends in an ellipsis.
pub(crate) fn wrapped(text: &str, size: f64, bold: bool, most: f64, lines: usize) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    let mut last = String::new();
    for piece in text.split_inclusive([',', ':', '(', ' ', '/']) {
        let longer = format!("{last}{piece}");
        let fits = width(longer.trim_end(), size, bold) <= most;
        if last.is_empty() || fits || out.len() + 1 >= lines {
            last = longer;
        } else {
            out.push(std::mem::replace(&mut last, piece.into()));
        }
    }
    out.push(last);
    out.iter()
        .map(|line| fitted(line.trim(), size, bold, most))
        .collect()
}

/// The fonts that pictures are drawn with: the embedded ones and no others, so that a picture doesn't depend on what is installed.
pub(crate) fn database() -> Arc<fontdb::Database> {
    static FONTS: LazyLock<Arc<fontdb::Database>> = LazyLock::new(|| {
        let mut fonts = fontdb::Database::new();
        fonts.load_font_data(REGULAR.to_vec());
        fonts.load_font_data(SEMIBOLD.to_vec());
        Arc::new(fonts)
    });
    FONTS.clone()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_weights_are_there_and_have_the_signs_of_plots() {
        assert_eq!(database().len(), 2);
        for data in [REGULAR, SEMIBOLD] {
            let font = FontRef::new(data).unwrap();
            for c in "0189.,:=/()|AZaz_·−–×°θφωαρΩ⁻¹²³⁰⁹ₐₕ→↑…√≤≥≈∞".chars()
            {
                assert!(font.charmap().map(c).is_some(), "{c}");
            }
        }
    }

    #[test]
    fn text_is_measured_and_cut() {
        // Inter's figures are 1776/2816 wide at most, and an i is narrower than an m.
        assert!(width("iiii", 10.0, false) < 0.5 * width("mmmm", 10.0, false));
        assert_eq!(width("", 10.0, false), 0.0);
        let cut = fitted("a long name of a function", 10.0, true, 60.0);
        assert!(
            cut.ends_with('…') && width(&cut, 10.0, true) <= 60.0,
            "{cut}"
        );
        let lines = wrapped("ggx:roughness=0.3,metal=gold", 10.0, false, 105.0, 2);
        assert_eq!(lines, ["ggx:roughness=0.3,", "metal=gold"]);
        let lines = wrapped("a,b,c,d,e,f,g,h,i,j,k", 10.0, false, 30.0, 2);
        assert!(lines.len() == 2 && lines[1].ends_with('…'), "{lines:?}");
    }
}
