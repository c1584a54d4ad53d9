//! Projections: how directions are laid out on a picture, both ways, with their solid-angle Jacobians.
//!
//! A picture has coordinates (u, v) in [0, 1]²: u grows to the right and v downwards from the top left corner. The
//! world is right-handed with +y up; "forward" is −z, "right" is +x.

pub mod angular;
pub mod lat_long;
pub mod mirror_ball;

use crate::EnvError;
use gonio_num::{Real, Vec3};
use serde::Serialize;
use std::fmt;
use std::str::FromStr;

/// How a panorama lays the sphere of directions out on a picture.
///
/// | layout | picture | centre looks | solid angle dω / (du dv) |
/// |---|---|---|---|
/// | `LatLong` | 2 : 1 | −z | 2π² sin(πv) |
/// | `Angular` | disc in a square | −z | 4π² sin(πr) / (πr) |
/// | `MirrorBall` | disc in a square | +z, at the camera | 16 |
///
/// r is the distance from the picture's centre; the disc has r ≤ 1. Outside the disc is nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Layout {
    /// Longitude along u and polar angle along v, also named equirectangular. See [`lat_long`].
    LatLong,
    /// The light probe or angular map of Debevec 1998: the distance from the centre is the angle from −z. See
    /// [`angular`].
    Angular,
    /// An orthographic photograph of a perfectly reflecting ball, as the camera took it (not flipped). See
    /// [`mirror_ball`].
    MirrorBall,
}

impl Layout {
    /// Every layout, for lists and tests.
    pub const ALL: [Layout; 3] = [Layout::LatLong, Layout::Angular, Layout::MirrorBall];

    /// The name that [`Layout::from_str`] reads: `lat-long`, `angular` or `mirror-ball`.
    pub fn name(self) -> &'static str {
        match self {
            Layout::LatLong => "lat-long",
            Layout::Angular => "angular",
            Layout::MirrorBall => "mirror-ball",
        }
    }

    /// Whether the picture is a disc inscribed in a square.
    pub fn is_disc(self) -> bool {
        !matches!(self, Layout::LatLong)
    }

    /// The unit direction shown at (u, v).
    ///
    /// Outside a disc the formula goes on without meaning: ask [`Layout::contains`] first. Never NaN in [0, 1]².
    #[inline(always)]
    pub fn direction<R: Real>(self, uv: [R; 2]) -> Vec3<R> {
        match self {
            Layout::LatLong => lat_long::direction(uv),
            Layout::Angular => angular::direction(uv),
            Layout::MirrorBall => mirror_ball::direction(uv),
        }
    }

    /// Where the unit direction `d` is shown: (u, v), each in [0, 1].
    ///
    /// A direction that a whole curve of the picture shows (a pole, the rim of a disc) gets one point of that curve.
    #[inline(always)]
    pub fn uv<R: Real>(self, d: Vec3<R>) -> [R; 2] {
        match self {
            Layout::LatLong => lat_long::uv(d),
            Layout::Angular => angular::uv(d),
            Layout::MirrorBall => mirror_ball::uv(d),
        }
    }

    /// Solid angle a unit of picture area, dω / (du dv) \[sr] (T4); 0 outside the layout's domain.
    ///
    /// Its integral over the picture is 4π.
    #[inline(always)]
    pub fn jacobian<R: Real>(self, uv: [R; 2]) -> R {
        match self {
            Layout::LatLong => lat_long::jacobian(uv),
            Layout::Angular => angular::jacobian(uv),
            Layout::MirrorBall => mirror_ball::jacobian(uv),
        }
    }

    /// Whether (u, v) shows a direction: everywhere in [0, 1]² for lat-long, in the inscribed disc for the others.
    #[inline(always)]
    pub fn contains<R: Real>(self, uv: [R; 2]) -> R::Mask {
        match self {
            Layout::LatLong => {
                let zero = R::zero();
                let one = R::one();
                uv[0].ge(zero) & uv[0].le(one) & uv[1].ge(zero) & uv[1].le(one)
            }
            Layout::Angular | Layout::MirrorBall => {
                let [x, y] = disc_from_uv(uv);
                (x * x + y * y).le(R::one())
            }
        }
    }
}

/// Disc coordinates (x right, y up, both in [−1, 1]) of (u, v).
#[inline(always)]
pub(crate) fn disc_from_uv<R: Real>(uv: [R; 2]) -> [R; 2] {
    let two = R::lit(2.0);
    [two * uv[0] - R::one(), R::one() - two * uv[1]]
}

/// (u, v) of disc coordinates (x right, y up).
#[inline(always)]
pub(crate) fn uv_from_disc<R: Real>(p: [R; 2]) -> [R; 2] {
    let half = R::lit(0.5);
    [half + half * p[0], half - half * p[1]]
}

impl fmt::Display for Layout {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Layout {
    type Err = EnvError;

    /// Reads `lat-long`, `angular` or `mirror-ball`, and the other names people use: `latlong`, `equirectangular`,
    /// `light-probe`, `probe`, `mirrorball`, `ball`.
    fn from_str(text: &str) -> Result<Self, EnvError> {
        match text.to_ascii_lowercase().replace('_', "-").as_str() {
            "lat-long" | "latlong" | "equirectangular" => Ok(Layout::LatLong),
            "angular" | "angular-map" | "light-probe" | "probe" => Ok(Layout::Angular),
            "mirror-ball" | "mirrorball" | "mirrored-ball" | "ball" => Ok(Layout::MirrorBall),
            _ => Err(EnvError::UnknownLayout {
                found: text.to_owned(),
            }),
        }
    }
}

#[cfg(test)]
mod tests;
