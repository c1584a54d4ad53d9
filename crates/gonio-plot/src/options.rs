//! [`Options`], what every kind of plot can be told.

use crate::{PlotError, ScaleKind};

/// Functions in one plot at most.
pub const MOST_FUNCTIONS: usize = 8;

/// Which number a colour becomes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Channel {
    /// The luminance of linear Rec. 709 colours: 0.2126 R + 0.7152 G + 0.0722 B.
    #[default]
    Luminance,
    /// The first channel alone.
    Red,
    /// The second channel alone.
    Green,
    /// The third channel alone.
    Blue,
    /// Each of the three by itself: three curves, or colours in a picture.
    Rgb,
}

impl Channel {
    /// Every choice, with its name.
    pub const ALL: [(Self, &'static str); 5] = [
        (Self::Luminance, "luminance"),
        (Self::Red, "red"),
        (Self::Green, "green"),
        (Self::Blue, "blue"),
        (Self::Rgb, "rgb"),
    ];

    /// The numbers that are made of a colour, each by its weights.
    pub(crate) fn weights(self) -> &'static [[f64; 3]] {
        const LUMINANCE: [f64; 3] = [0.2126, 0.7152, 0.0722];
        const PARTS: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        match self {
            Self::Luminance => &[LUMINANCE],
            Self::Red => &PARTS[..1],
            Self::Green => &PARTS[1..2],
            Self::Blue => &PARTS[2..],
            Self::Rgb => &PARTS,
        }
    }

    /// One number of a colour; luminance where all three are shown.
    pub(crate) fn value(self, colour: [f64; 3]) -> f64 {
        match self {
            Self::Rgb => weighted(Self::Luminance.weights()[0], colour),
            one => weighted(one.weights()[0], colour),
        }
    }

    pub(crate) fn name(self) -> &'static str {
        Self::ALL
            .iter()
            .find(|(c, _)| *c == self)
            .map_or("", |(_, name)| name)
    }
}

/// Σ weight · component; a component without weight doesn't count, not even NaN.
pub(crate) fn weighted(weights: [f64; 3], colour: [f64; 3]) -> f64 {
    let parts = weights.iter().zip(colour).filter(|(w, _)| **w != 0.0);
    parts.map(|(w, c)| w * c).sum()
}

impl std::str::FromStr for Channel {
    type Err = PlotError;

    fn from_str(text: &str) -> Result<Self, PlotError> {
        let found = Self::ALL.iter().find(|(_, name)| *name == text);
        found.map(|(channel, _)| *channel).ok_or(PlotError::Option {
            option: "channel",
            found: text.into(),
            expected: "luminance, red, green, blue or rgb".into(),
        })
    }
}

/// What a plot shows and how.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Width and height in pixels, 200 to 10,000 each; nothing: what suits the kind.
    pub size: Option<[u32; 2]>,
    /// The words at the top; nothing: the function's name.
    pub title: Option<String>,
    /// Angles of incidence in degrees, each in [0, 180); nothing: what suits the kind. Beyond 90 the light comes from below the surface.
    pub theta_deg: Vec<f64>,
    /// Azimuth of the plane of incidence in degrees: it matters for what is not isotropic.
    pub phi_deg: f64,
    /// φd of a slice in degrees.
    pub phi_d_deg: f64,
    /// Which number a colour becomes.
    pub channel: Channel,
    /// How a value becomes a length or a colour.
    pub scale: ScaleKind,
    /// Whether f is multiplied by |cosθr| of the outgoing direction: then a lobe is the intensity of the reflected light.
    pub cosine: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            size: None,
            title: None,
            theta_deg: Vec::new(),
            phi_deg: 0.0,
            phi_d_deg: 90.0,
            channel: Channel::default(),
            scale: ScaleKind::default(),
            cosine: false,
        }
    }
}

/// Angles of incidence in one plot at most.
pub const MOST_ANGLES: usize = 8;

impl Options {
    /// Fails unless every value makes sense for `count` functions.
    pub(crate) fn check(&self, count: usize) -> Result<(), PlotError> {
        if !(1..=MOST_FUNCTIONS).contains(&count) {
            return Err(PlotError::Count {
                found: count,
                expected: "1 to 8",
            });
        }
        let wrong = |option, found: String, expected: &str| {
            Err(PlotError::Option {
                option,
                found,
                expected: expected.into(),
            })
        };
        if let Some([w, h]) = self.size
            && ![w, h].iter().all(|x| (200..=10_000).contains(x))
        {
            return wrong(
                "size",
                format!("{w}x{h}"),
                "200 to 10000 pixels along each side",
            );
        }
        if self.theta_deg.len() > MOST_ANGLES {
            return wrong(
                "theta",
                format!("{} angles", self.theta_deg.len()),
                "at most 8",
            );
        }
        if let Some(theta) = self
            .theta_deg
            .iter()
            .find(|t| !(0.0..180.0).contains(*t) || **t == 90.0)
        {
            return wrong(
                "theta",
                format!("{theta}°"),
                "angles from 0° to 180°, but not 90°",
            );
        }
        for (option, angle) in [("phi", self.phi_deg), ("phi-d", self.phi_d_deg)] {
            if !angle.is_finite() {
                return wrong(option, angle.to_string(), "a finite angle in degrees");
            }
        }
        Ok(())
    }

    /// The angles of incidence, `usual` if there are none.
    pub(crate) fn thetas(&self, usual: &[f64]) -> Vec<f64> {
        if self.theta_deg.is_empty() {
            usual.to_vec()
        } else {
            self.theta_deg.clone()
        }
    }

    /// The size, in proportion to `usual` if it isn't given.
    pub(crate) fn page_size(&self, usual: [f64; 2]) -> [f64; 2] {
        self.size.map_or(usual, |size| size.map(f64::from))
    }

    /// The formula that is shown.
    pub(crate) fn quantity(&self) -> &'static str {
        if self.cosine { "f |cos θr|" } else { "f" }
    }
}
