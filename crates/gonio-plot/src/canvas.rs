//! What plots are drawn with: lines, areas, text and pictures in pixels, by plotters on our page.

use crate::font;
use crate::page::{Backend, Page, Raster, SCALE};
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::cell::RefCell;
use std::rc::Rc;

/// A colour, 0xRRGGBB.
pub(crate) type Colour = u32;

/// Text and axes.
pub(crate) const INK: Colour = 0x24292f;
/// Text of less weight.
pub(crate) const MUTED: Colour = 0x57606a;
/// Lines of a grid.
pub(crate) const GRID: Colour = 0xd0d7de;
/// Lines between those.
pub(crate) const FAINT: Colour = 0xeaeef2;

/// Colours that differ to all eyes (Okabe & Ito 2008, without its yellow, which is not seen on white).
pub(crate) const PALETTE: [Colour; 8] = [
    0x0072b2, 0xd55e00, 0x009e73, 0xcc79a7, 0xe69f00, 0x56b4e9, 0x24292f, 0x8c6d31,
];

/// Dashes and gaps, so that curves differ without colour, too.
pub(crate) const DASHES: [&str; 8] = [
    "",
    "7 3.5",
    "2 2.5",
    "9 3 2 3",
    "12 3",
    "4 2",
    "7 2.5 2 2.5 2 2.5",
    "1 3.5",
];

/// Sizes of text.
pub(crate) const TITLE: f64 = 16.0;
pub(crate) const LABEL: f64 = 13.0;
pub(crate) const SMALL: f64 = 11.5;

/// A line's look.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stroke {
    pub colour: Colour,
    pub width: f64,
    pub dash: &'static str,
}

impl Stroke {
    pub fn new(colour: Colour, width: f64) -> Self {
        Self {
            colour,
            width,
            dash: "",
        }
    }
}

/// A text's look.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Look {
    pub size: f64,
    pub colour: Colour,
    pub bold: bool,
    /// A rim in the colour of the ground.
    pub rim: bool,
    /// Where the place is: −1 at its left, 0 in its middle, 1 at its right.
    pub across: i8,
    /// Where the place is: −1 at its top, 0 in its middle, 1 at its bottom.
    pub down: i8,
}

impl Look {
    pub const LABEL: Self = Self {
        size: LABEL,
        colour: INK,
        bold: false,
        rim: false,
        across: -1,
        down: 0,
    };
    pub const SMALL: Self = Self {
        size: SMALL,
        colour: MUTED,
        ..Self::LABEL
    };
    pub const TITLE: Self = Self {
        size: TITLE,
        bold: true,
        down: -1,
        ..Self::LABEL
    };

    pub fn centred(self) -> Self {
        Self { across: 0, ..self }
    }

    pub fn right(self) -> Self {
        Self { across: 1, ..self }
    }

    pub fn top(self) -> Self {
        Self { down: -1, ..self }
    }

    pub fn rimmed(self) -> Self {
        Self { rim: true, ..self }
    }

    pub fn bold(self) -> Self {
        Self { bold: true, ..self }
    }

    pub fn coloured(self, colour: Colour) -> Self {
        Self { colour, ..self }
    }
}

/// A page being drawn.
pub(crate) struct Canvas {
    page: Rc<RefCell<Page>>,
    area: DrawingArea<Backend, Shift>,
}

impl Canvas {
    pub fn new(size: [f64; 2]) -> Self {
        let page = Rc::new(RefCell::new(Page {
            size,
            ..Page::default()
        }));
        Self {
            area: Backend(page.clone()).into_drawing_area(),
            page,
        }
    }

    pub fn size(&self) -> [f64; 2] {
        self.page.borrow().size
    }

    /// What has been drawn.
    pub fn finish(self) -> Page {
        self.page.take()
    }

    /// A part of it, for a chart: left, top, width and height.
    pub fn part(&self, [x, y, w, h]: [f64; 4]) -> DrawingArea<Backend, Shift> {
        let corner = |x: f64, y: f64| (unit(x), unit(y));
        let ((x0, y0), (x1, y1)) = (corner(x, y), corner(x + w, y + h));
        self.area.clone().shrink((x0, y0), (x1 - x0, y1 - y0))
    }

    pub fn line(&self, points: &[[f64; 2]], stroke: Stroke) {
        self.page.borrow_mut().dash = stroke.dash;
        done(
            self.area
                .draw(&PathElement::new(places(points), style(stroke))),
        );
        self.page.borrow_mut().dash = "";
    }

    pub fn area(&self, corners: &[[f64; 2]], colour: Colour, opacity: f64) {
        let fill = rgb(colour).mix(opacity).filled();
        done(self.area.draw(&Polygon::new(places(corners), fill)));
    }

    pub fn rectangle(&self, [x, y, w, h]: [f64; 4], stroke: Stroke) {
        let corners = [[x, y], [x + w, y], [x + w, y + h], [x, y + h], [x, y]];
        self.line(&corners, stroke);
    }

    pub fn text(&self, words: &str, [x, y]: [f64; 2], look: Look) {
        {
            let mut page = self.page.borrow_mut();
            (page.rim, page.bold) = (look.rim, look.bold);
        }
        let style = text_style(look.size, look.colour).pos(Pos::new(
            match look.across {
                -1 => HPos::Left,
                0 => HPos::Center,
                _ => HPos::Right,
            },
            match look.down {
                -1 => VPos::Top,
                0 => VPos::Center,
                _ => VPos::Bottom,
            },
        ));
        done(self.area.draw_text(words, &style, (unit(x), unit(y))));
        let mut page = self.page.borrow_mut();
        (page.rim, page.bold) = (false, false);
    }

    /// A shaft with a head at its end.
    pub fn arrow(&self, from: [f64; 2], to: [f64; 2], head: f64, stroke: Stroke) {
        let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
        let length = (dx * dx + dy * dy).sqrt().max(1e-9);
        let (ux, uy) = (dx / length, dy / length);
        let neck = [to[0] - head * ux, to[1] - head * uy];
        let half = 0.42 * head;
        self.line(&[from, neck], stroke);
        let corners = [
            to,
            [neck[0] - half * uy, neck[1] + half * ux],
            [neck[0] + half * uy, neck[1] - half * ux],
        ];
        self.area(&corners, stroke.colour, 1.0);
    }

    /// A picture below everything else: left, top, width and height.
    pub fn picture(&self, place: [f64; 4], size: [u32; 2], rgb: Vec<u8>) {
        self.page
            .borrow_mut()
            .rasters
            .push(Raster { place, size, rgb });
    }
}

/// The page takes everything: drawing on it can't fail.
pub(crate) fn done<E>(_: Result<(), E>) {}

/// Pixels as plotters counts them.
pub(crate) fn unit(x: f64) -> i32 {
    (x * SCALE).round() as i32
}

fn places(points: &[[f64; 2]]) -> Vec<(i32, i32)> {
    points.iter().map(|[x, y]| (unit(*x), unit(*y))).collect()
}

pub(crate) fn rgb(colour: Colour) -> RGBColor {
    let [_, r, g, b] = colour.to_be_bytes();
    RGBColor(r, g, b)
}

pub(crate) fn style(stroke: Stroke) -> ShapeStyle {
    rgb(stroke.colour).stroke_width(unit(stroke.width) as u32)
}

pub(crate) fn text_style(size: f64, colour: Colour) -> TextStyle<'static> {
    let font = (font::FAMILY, size * SCALE).into_font();
    TextStyle {
        color: rgb(colour).to_backend_color(),
        ..TextStyle::from(font)
    }
}
