//! Projections: how directions are laid out on a picture, both ways, with their solid-angle Jacobians.
//!
//! A picture has coordinates (u, v) in [0, 1]²: u grows to the right and v downwards from the top left corner. The
//! world is right-handed with +y up; "forward" is −z, "right" is +x.

pub mod angular;
mod convention;
pub mod cube;
pub mod dual_paraboloid;
pub mod equal_area;
pub mod lat_long;
pub mod mirror_ball;
pub mod octahedral;

pub use convention::{Convention, View};

use crate::EnvError;
use cube::{Arrangement, INSIDE};
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
/// | `CubeCross` | 4 : 3 | −z (the face in the second column) | 48 (1 + s² + t²)^(−3/2) |
/// | `CubeCrossVertical` | 3 : 4 | (the face in the second row and column looks along −z) | 48 (1 + s² + t²)^(−3/2) |
/// | `CubeStrip`, `CubeStripVertical` | 6 : 1, 1 : 6 | (faces +x, −x, +y, −y, +z, −z) | 24 (1 + s² + t²)^(−3/2) |
/// | `Octahedral` | square | −z | 4 / r³ |
/// | `EqualAreaOctahedral` | square | −z | 4π |
/// | `DualParaboloid` | two discs, 2 : 1 | (the left disc −z, the right one +z) | 32 / (1 + r²)² |
///
/// This is how this program turns them; a [`View`] turns them as others do. r is the distance from the picture's centre; the disc has r ≤ 1. Outside the disc is nothing.
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
    /// Six faces of a cube as a cross that lies. See [`cube`].
    CubeCross,
    /// Six faces of a cube as a cross that stands. See [`cube`].
    CubeCrossVertical,
    /// Six faces of a cube side by side. See [`cube`].
    CubeStrip,
    /// Six faces of a cube one below the other. See [`cube`].
    CubeStripVertical,
    /// The octahedron unfolded. See [`octahedral`].
    Octahedral,
    /// The octahedron with equal areas, of Clarberg 2008. See [`equal_area`].
    EqualAreaOctahedral,
    /// Two discs, what is in front and what is behind. See [`dual_paraboloid`].
    DualParaboloid,
}

impl Layout {
    /// Every layout, for lists and tests.
    pub const ALL: [Layout; 10] = [
        Layout::LatLong,
        Layout::Angular,
        Layout::MirrorBall,
        Layout::CubeCross,
        Layout::CubeCrossVertical,
        Layout::CubeStrip,
        Layout::CubeStripVertical,
        Layout::Octahedral,
        Layout::EqualAreaOctahedral,
        Layout::DualParaboloid,
    ];

    /// The name that [`Layout::from_str`] reads.
    pub fn name(self) -> &'static str {
        match self {
            Layout::LatLong => "lat-long",
            Layout::Angular => "angular",
            Layout::MirrorBall => "mirror-ball",
            Layout::CubeCross => "cube-cross",
            Layout::CubeCrossVertical => "cube-cross-vertical",
            Layout::CubeStrip => "cube-strip",
            Layout::CubeStripVertical => "cube-strip-vertical",
            Layout::Octahedral => "octahedral",
            Layout::EqualAreaOctahedral => "equal-area-octahedral",
            Layout::DualParaboloid => "dual-paraboloid",
        }
    }

    /// Whether the picture is a disc inscribed in a square.
    pub fn is_disc(self) -> bool {
        matches!(self, Layout::Angular | Layout::MirrorBall)
    }

    /// Columns and rows of a picture in units of its size: that of a cube's face, the height of any other.
    pub fn shape(self) -> [usize; 2] {
        match (self, self.arrangement()) {
            (_, Some(a)) => [a.columns, a.rows],
            (Layout::LatLong | Layout::DualParaboloid, _) => [2, 1],
            _ => [1, 1],
        }
    }

    /// How the faces stand, if it is a cube.
    #[inline(always)]
    pub fn arrangement(self) -> Option<Arrangement> {
        match self {
            Layout::CubeCross => Some(Arrangement::CROSS),
            Layout::CubeCrossVertical => Some(Arrangement::CROSS_VERTICAL),
            Layout::CubeStrip => Some(Arrangement::STRIP),
            Layout::CubeStripVertical => Some(Arrangement::STRIP_VERTICAL),
            _ => None,
        }
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
            Layout::CubeCross => cube::direction(uv, &Arrangement::CROSS, &INSIDE),
            Layout::CubeCrossVertical => cube::direction(uv, &Arrangement::CROSS_VERTICAL, &INSIDE),
            Layout::CubeStrip => cube::direction(uv, &Arrangement::STRIP, &INSIDE),
            Layout::CubeStripVertical => cube::direction(uv, &Arrangement::STRIP_VERTICAL, &INSIDE),
            Layout::Octahedral => octahedral::direction(uv),
            Layout::EqualAreaOctahedral => equal_area::direction(uv),
            Layout::DualParaboloid => dual_paraboloid::direction(uv),
        }
    }

    /// Where the unit direction `d` is shown: (u, v), each in [0, 1].
    ///
    /// A direction that several points of the picture show (a pole, the rim of a disc, an edge of a cube) gets one of them.
    #[inline(always)]
    pub fn uv<R: Real>(self, d: Vec3<R>) -> [R; 2] {
        match self {
            Layout::LatLong => lat_long::uv(d),
            Layout::Angular => angular::uv(d),
            Layout::MirrorBall => mirror_ball::uv(d),
            Layout::CubeCross => cube::uv(d, &Arrangement::CROSS, &INSIDE),
            Layout::CubeCrossVertical => cube::uv(d, &Arrangement::CROSS_VERTICAL, &INSIDE),
            Layout::CubeStrip => cube::uv(d, &Arrangement::STRIP, &INSIDE),
            Layout::CubeStripVertical => cube::uv(d, &Arrangement::STRIP_VERTICAL, &INSIDE),
            Layout::Octahedral => octahedral::uv(d),
            Layout::EqualAreaOctahedral => equal_area::uv(d),
            Layout::DualParaboloid => dual_paraboloid::uv(d),
        }
    }

    /// Whether [`Layout::jacobian`] is the same all along a row.
    pub(crate) fn rows_weigh_alike(self) -> bool {
        matches!(self, Layout::LatLong | Layout::EqualAreaOctahedral)
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
            Layout::CubeCross => cube::jacobian(uv, &Arrangement::CROSS),
            Layout::CubeCrossVertical => cube::jacobian(uv, &Arrangement::CROSS_VERTICAL),
            Layout::CubeStrip => cube::jacobian(uv, &Arrangement::STRIP),
            Layout::CubeStripVertical => cube::jacobian(uv, &Arrangement::STRIP_VERTICAL),
            Layout::Octahedral => octahedral::jacobian(uv),
            Layout::EqualAreaOctahedral => equal_area::jacobian(uv),
            Layout::DualParaboloid => dual_paraboloid::jacobian(uv),
        }
    }

    /// Whether (u, v), in [0, 1]², shows a direction: everywhere but beside the discs and the faces of a cross.
    #[inline(always)]
    pub fn contains<R: Real>(self, uv: [R; 2]) -> R::Mask {
        match (self, self.arrangement()) {
            (_, Some(arrangement)) => cube::contains(uv, &arrangement),
            (Layout::Angular | Layout::MirrorBall, _) => {
                let [x, y] = disc_from_uv(uv);
                (x * x + y * y).le(R::one())
            }
            (Layout::DualParaboloid, _) => dual_paraboloid::contains(uv),
            _ => {
                let zero = R::zero();
                let one = R::one();
                uv[0].ge(zero) & uv[0].le(one) & uv[1].ge(zero) & uv[1].le(one)
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

    /// Reads the name of a layout, and others that people use: `latlong`, `equirectangular`, `light-probe`, `probe`,
    /// `mirrorball`, `ball`, `octahedron`, `equal-area`, `paraboloid`, `cross`, `strip`, `cube` (a strip of faces).
    fn from_str(text: &str) -> Result<Self, EnvError> {
        match text.to_ascii_lowercase().replace('_', "-").as_str() {
            "lat-long" | "latlong" | "equirectangular" => Ok(Layout::LatLong),
            "angular" | "angular-map" | "light-probe" | "probe" => Ok(Layout::Angular),
            "mirror-ball" | "mirrorball" | "mirrored-ball" | "ball" => Ok(Layout::MirrorBall),
            "cube-cross" | "cross" | "cube-cross-horizontal" => Ok(Layout::CubeCross),
            "cube-cross-vertical" | "cross-vertical" => Ok(Layout::CubeCrossVertical),
            "cube-strip" | "strip" | "cube" | "cube-strip-horizontal" => Ok(Layout::CubeStrip),
            "cube-strip-vertical" | "strip-vertical" => Ok(Layout::CubeStripVertical),
            "octahedral" | "octahedron" => Ok(Layout::Octahedral),
            "equal-area-octahedral" | "equal-area" | "equiarea" => Ok(Layout::EqualAreaOctahedral),
            "dual-paraboloid" | "paraboloid" => Ok(Layout::DualParaboloid),
            _ => Err(EnvError::UnknownLayout {
                found: text.to_owned(),
            }),
        }
    }
}

#[cfg(test)]
mod tests;
