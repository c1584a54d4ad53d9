//! The sheet that everything is drawn on: an SVG writer behind plotters' interface.
//!
//! plotters counts in whole pixels. Here its pixel is a hundredth of ours, so that a curve isn't bent to a raster, and line widths and
//! sizes of text are given in hundredths, too.

use crate::font;
use plotters_backend::text_anchor::{HPos, VPos};
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, DrawingErrorKind,
    FontStyle, FontTransform,
};
use std::cell::RefCell;
use std::convert::Infallible;
use std::fmt::Write;
use std::rc::Rc;

/// plotters' pixels in one of ours.
pub(crate) const SCALE: f64 = 100.0;

type Done = Result<(), DrawingErrorKind<Infallible>>;

/// A picture in the plot, opaque sRGB.
#[derive(Debug, Clone)]
pub(crate) struct Raster {
    /// Left, top, width and height of where it is, in pixels of the plot.
    pub place: [f64; 4],
    /// Its own width and height.
    pub size: [u32; 2],
    /// Red, green and blue of each pixel, row by row from the top.
    pub rgb: Vec<u8>,
}

/// What has been drawn.
#[derive(Debug, Default)]
pub(crate) struct Page {
    /// Width and height in pixels.
    pub size: [f64; 2],
    /// Elements of the SVG, in the order of drawing.
    pub body: String,
    /// Pictures: they lie below all elements.
    pub rasters: Vec<Raster>,
    /// Lengths of dashes and gaps of the lines that follow; empty: drawn through.
    pub dash: &'static str,
    /// Whether the text that follows has a rim in the colour of the ground, to be read over lines.
    pub rim: bool,
    /// Whether the text that follows is bold.
    pub bold: bool,
}

/// plotters' way to the page.
#[derive(Clone)]
pub(crate) struct Backend(pub Rc<RefCell<Page>>);

impl DrawingBackend for Backend {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        let [w, h] = self.0.borrow().size;
        ((w * SCALE) as u32, (h * SCALE) as u32)
    }

    fn ensure_prepared(&mut self) -> Done {
        Ok(())
    }

    fn present(&mut self) -> Done {
        Ok(())
    }

    fn draw_pixel(&mut self, at: BackendCoord, color: BackendColor) -> Done {
        self.draw_rect(at, at, &color, true)
    }

    fn draw_line<S: BackendStyle>(
        &mut self,
        from: BackendCoord,
        to: BackendCoord,
        style: &S,
    ) -> Done {
        self.draw_path([from, to], style)
    }

    fn draw_rect<S: BackendStyle>(
        &mut self,
        (x0, y0): BackendCoord,
        (x1, y1): BackendCoord,
        style: &S,
        fill: bool,
    ) -> Done {
        let corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)];
        if fill {
            self.fill_polygon(corners, style)
        } else {
            self.draw_path(corners.into_iter().chain([(x0, y0)]), style)
        }
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        path: I,
        style: &S,
    ) -> Done {
        let d = line(path);
        let mut page = self.0.borrow_mut();
        let dash = match page.dash {
            "" => String::new(),
            dash => format!(" stroke-dasharray=\"{dash}\""),
        };
        let paint = paint("stroke", style.color());
        let width = hundredths(style.stroke_width() as i32);
        let _ = writeln!(
            page.body,
            "<path d=\"{d}\" fill=\"none\"{paint} stroke-width=\"{width}\"{dash} stroke-linejoin=\"round\"/>"
        );
        Ok(())
    }

    fn draw_circle<S: BackendStyle>(
        &mut self,
        (x, y): BackendCoord,
        radius: u32,
        style: &S,
        fill: bool,
    ) -> Done {
        let look = if fill {
            paint("fill", style.color())
        } else {
            format!(
                " fill=\"none\"{} stroke-width=\"{}\"",
                paint("stroke", style.color()),
                hundredths(style.stroke_width() as i32)
            )
        };
        let (x, y, r) = (hundredths(x), hundredths(y), hundredths(radius as i32));
        let _ = writeln!(
            self.0.borrow_mut().body,
            "<circle cx=\"{x}\" cy=\"{y}\" r=\"{r}\"{look}/>"
        );
        Ok(())
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        corners: I,
        style: &S,
    ) -> Done {
        let (d, paint) = (line(corners), paint("fill", style.color()));
        let _ = writeln!(self.0.borrow_mut().body, "<path d=\"{d}z\"{paint}/>");
        Ok(())
    }

    fn draw_text<T: BackendTextStyle>(&mut self, text: &str, style: &T, at: BackendCoord) -> Done {
        let size = style.size() / SCALE;
        let (x, y) = (f64::from(at.0) / SCALE, f64::from(at.1) / SCALE);
        let anchor = match style.anchor().h_pos {
            HPos::Left => "",
            HPos::Center => " text-anchor=\"middle\"",
            HPos::Right => " text-anchor=\"end\"",
        };
        let drop = match style.anchor().v_pos {
            VPos::Top => font::CAPITAL * size,
            VPos::Center => 0.5 * font::CAPITAL * size,
            VPos::Bottom => -font::DESCENT * size,
        };
        let mut page = self.0.borrow_mut();
        let bold = matches!(style.style(), FontStyle::Bold) || page.bold;
        let weight = if bold { " font-weight=\"600\"" } else { "" };
        let rim = if page.rim {
            " paint-order=\"stroke\" stroke=\"#fff\" stroke-width=\"3\" stroke-linejoin=\"round\""
        } else {
            ""
        };
        let turn = match style.transform() {
            FontTransform::None => 0,
            FontTransform::Rotate90 => 90,
            FontTransform::Rotate180 => 180,
            FontTransform::Rotate270 => 270,
        };
        // The base line is below the anchor in the text's own frame.
        let (dx, dy) = match turn {
            90 => (-drop, 0.0),
            180 => (0.0, -drop),
            270 => (drop, 0.0),
            _ => (0.0, drop),
        };
        let (x, y) = (short(x + dx), short(y + dy));
        let turned = match turn {
            0 => String::new(),
            _ => format!(" transform=\"rotate({turn} {x} {y})\""),
        };
        let (fill, size, words) = (paint("fill", style.color()), short(size), escaped(text));
        let _ = writeln!(
            page.body,
            "<text x=\"{x}\" y=\"{y}\" font-size=\"{size}\"{weight}{anchor}{fill}{rim}{turned}>{words}</text>"
        );
        Ok(())
    }

    fn estimate_text_size<T: BackendTextStyle>(
        &self,
        text: &str,
        style: &T,
    ) -> Result<(u32, u32), DrawingErrorKind<Infallible>> {
        let bold = matches!(style.style(), FontStyle::Bold);
        let width = font::width(text, style.size(), bold);
        Ok((width.ceil() as u32, style.size().ceil() as u32))
    }
}

impl Page {
    /// The file; without its ground and its pictures unless `whole`.
    pub fn document(&self, title: &str, description: &str, whole: bool) -> String {
        let [w, h] = self.size.map(short);
        let mut out = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {w} {h}\" width=\"{w}\" height=\"{h}\" role=\"img\" \
             font-family=\"{}\">\n<title>{}</title>\n<desc>{}</desc>\n",
            escaped(font::FAMILY),
            escaped(title),
            escaped(description)
        );
        if whole {
            let _ = writeln!(out, "<rect width=\"{w}\" height=\"{h}\" fill=\"#fff\"/>");
            for raster in &self.rasters {
                out += &raster.element();
            }
        }
        out + &self.body + "</svg>\n"
    }
}

impl Raster {
    fn element(&self) -> String {
        let [x, y, w, h] = self.place.map(short);
        format!(
            "<image x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" preserveAspectRatio=\"none\" href=\"data:image/png;base64,{}\"/>\n",
            base64(&crate::png::encode(self.size, &self.rgb))
        )
    }
}

/// `M` and the corners, the second and later ones relative: shorter.
fn line(path: impl IntoIterator<Item = BackendCoord>) -> String {
    let mut d = String::new();
    let mut last: Option<BackendCoord> = None;
    for (x, y) in path {
        match last {
            None => d += &format!("M{} {}", hundredths(x), hundredths(y)),
            Some((x0, y0)) if (x, y) == (x0, y0) => continue,
            Some((x0, y0)) => {
                if !d.contains('l') {
                    d.push('l');
                } else if x >= x0 {
                    d.push(' ');
                }
                d += &hundredths(x - x0);
                if y >= y0 {
                    d.push(' ');
                }
                d += &hundredths(y - y0);
            }
        }
        last = Some((x, y));
    }
    d
}

fn paint(what: &str, color: BackendColor) -> String {
    let (r, g, b) = color.rgb;
    let mut text = format!(" {what}=\"#{r:02x}{g:02x}{b:02x}\"");
    if color.alpha < 1.0 {
        text += &format!(" {what}-opacity=\"{}\"", short(color.alpha));
    }
    text
}

/// A length in hundredths as text in whole ones, without needless zeros.
fn hundredths(x: i32) -> String {
    let sign = if x < 0 { "-" } else { "" };
    let x = x.unsigned_abs();
    let (whole, part) = (x / 100, x % 100);
    match (whole, part) {
        (_, 0) => format!("{sign}{whole}"),
        (0, p) if p % 10 == 0 => format!("{sign}.{}", p / 10),
        (0, p) => format!("{sign}.{p:02}"),
        (w, p) if p % 10 == 0 => format!("{sign}{w}.{}", p / 10),
        (w, p) => format!("{sign}{w}.{p:02}"),
    }
}

fn short(x: f64) -> String {
    hundredths((x * 100.0).round() as i32)
}

/// Text as XML takes it: with the five signs that mean something there written out, and without control characters, which no XML may have.
pub(crate) fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out += "&amp;",
            '<' => out += "&lt;",
            '>' => out += "&gt;",
            '"' => out += "&quot;",
            '\'' => out += "&#39;",
            '\u{FFFE}' | '\u{FFFF}' => out.push('\u{FFFD}'),
            c if c.is_control() && c != '\n' && c != '\t' => out.push('\u{FFFD}'),
            c => out.push(c),
        }
    }
    out
}

/// Base 64 with padding (RFC 4648, §4).
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut out = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let byte = |k: usize| u32::from(group.get(k).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for k in 0..4 {
            if k <= group.len() {
                out.push(char::from(LETTERS[(bits >> (18 - 6 * k) & 63) as usize]));
            } else {
                out.push('=');
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let all: Vec<String> = [0.0, 1.0, -1.5, 0.25, -0.05, 12.34, 0.004]
            .map(short)
            .into();
        assert_eq!(all, ["0", "1", "-1.5", ".25", "-.05", "12.34", "0"]);
    }

    #[test]
    fn paths_are_relative_after_their_first_corner() {
        let d = line([(100, 200), (150, 150), (150, 150), (140, 175)]);
        assert_eq!(d, "M1 2l.5-.5-.1 .25");
    }

    #[test]
    fn base64_of_the_standard() {
        let all = ["", "f", "fo", "foo", "foob", "fooba", "foobar"].map(|s| base64(s.as_bytes()));
        let expected = [
            "", "Zg==", "Zm8=", "Zm9v", "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy",
        ];
        assert_eq!(all, expected);
    }

    #[test]
    fn no_text_breaks_the_file() {
        assert_eq!(
            escaped("a<b & \"c\"\u{0}\u{1b}"),
            "a&lt;b &amp; &quot;c&quot;\u{FFFD}\u{FFFD}"
        );
    }
}
