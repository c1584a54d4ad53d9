//! The embedded font: plots have the same text on a machine without fonts.
//!
//! Inter 3.19 in two weights, reduced to Latin, Greek, figures and the signs of mathematics (SIL Open Font License 1.1, in `fonts/`).

use resvg::usvg::fontdb;
use std::sync::{Arc, LazyLock};

const REGULAR: &[u8] = include_bytes!("../fonts/Inter-Regular.otf");
const SEMIBOLD: &[u8] = include_bytes!("../fonts/Inter-SemiBold.otf");

/// How wide the letters are, so that a program that writes no pictures carries no font. For each, in the order of their numbers, three
/// little-endian 16-bit numbers: the letter's number in Unicode, and how far it advances in either weight, of [`EM`]. The first is the
/// box for missing letters, under 0.
const ADVANCES: &[u8] = include_bytes!("../fonts/advances.bin");

/// Units of the font in its size.
const EM: f64 = 2816.0;

/// Names of the font in an SVG: a reader without Inter sees the text in the system's own.
pub(crate) const FAMILY: &str =
    "Inter,system-ui,'Segoe UI',Roboto,'Helvetica Neue',Arial,sans-serif";

/// Height of a capital letter over the size of the font.
pub(crate) const CAPITAL: f64 = 2048.0 / EM;

/// How much of the size of the font reaches below the base line.
pub(crate) const DESCENT: f64 = 680.0 / EM;

/// The width of `text` in the unit of `size`. A letter that the font doesn't have is as wide as its box for missing ones.
pub(crate) fn width(text: &str, size: f64, bold: bool) -> f64 {
    let units: u32 = text.chars().map(|c| advance(u32::from(c), bold)).sum();
    f64::from(units) / EM * size
}

/// How far a letter advances, of [`EM`].
fn advance(letter: u32, bold: bool) -> u32 {
    let (rows, _) = ADVANCES.as_chunks::<6>();
    let number = |row: &[u8; 6], at: usize| u32::from(u16::from_le_bytes([row[at], row[at + 1]]));
    let place = rows.binary_search_by_key(&letter, |row| number(row, 0));
    number(&rows[place.unwrap_or(0)], if bold { 4 } else { 2 })
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
    use skrifa::instance::{LocationRef, Size};
    use skrifa::{FontRef, MetadataProvider};

    /// `GONIO_UPDATE=1` writes them.
    #[test]
    fn the_advances_are_those_of_the_fonts() {
        let fonts = [REGULAR, SEMIBOLD].map(|data| FontRef::new(data).unwrap());
        let letters = fonts[0].charmap();
        let mut all: Vec<u32> = letters.mappings().map(|(letter, _)| letter).collect();
        all.push(0);
        all.sort_unstable();
        let mut bytes = Vec::new();
        for letter in all {
            bytes.extend(u16::try_from(letter).unwrap().to_le_bytes());
            for font in &fonts {
                let metrics = font.glyph_metrics(Size::unscaled(), LocationRef::default());
                let glyph = font.charmap().map(letter).unwrap_or_default();
                let advance = metrics.advance_width(glyph).unwrap();
                bytes.extend((advance as u16).to_le_bytes());
            }
        }
        if std::env::var_os("GONIO_UPDATE").is_some() {
            let file = concat!(env!("CARGO_MANIFEST_DIR"), "/fonts/advances.bin");
            std::fs::write(file, &bytes).unwrap();
        }
        assert!(bytes == ADVANCES, "GONIO_UPDATE=1 writes them anew");
    }

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
