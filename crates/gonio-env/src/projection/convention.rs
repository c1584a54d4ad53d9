//! Conventions: which way a program turns the pictures of an environment.

use super::cube::{Face, Faces, INSIDE, LOOKED_UP};
use super::{Layout, cube};
use crate::EnvError;
use crate::error::suggest;
use gonio_num::{Real, Vec3};
use serde::Serialize;
use std::fmt;
use std::str::FromStr;

/// Whose axes and pictures an environment's file follows.
///
/// The world here is right-handed with +y up and forward along −z; `right` and `forward` below are its +x and −z.
///
/// | convention | its world | a panorama's centre looks | cube faces |
/// |---|---|---|---|
/// | `Gonio` | right-handed, +y up | forward, −z | unmirrored from inside |
/// | `Pbrt` | left-handed, +z up | forward, its −x | as `Gonio` |
/// | `Mitsuba` | right-handed, +y up | back, +z | as `Gonio` |
/// | `Blender` | right-handed, +z up | right, its +x | as `Gonio` |
/// | `Gltf` | right-handed, +y up | right, +x | looked up |
/// | `OpenGl` | right-handed, +y up | forward, −z | looked up |
/// | `Unreal` | left-handed, +z up, +x forward | left, its −y | looked up, in its world |
///
/// Every panorama reads unmirrored from inside. The book's page on converting environments has the sources.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Convention {
    /// That of this program.
    #[default]
    Gonio,
    /// pbrt-v4: equal-area pictures have the zenith in the centre.
    Pbrt,
    /// Mitsuba 3.
    Mitsuba,
    /// Blender and its renderer Cycles.
    Blender,
    /// glTF 2.0 and its sample viewer; three.js.
    Gltf,
    /// The tables of OpenGL, Vulkan and Direct3D, as KTX2 and DDS follow them.
    #[serde(rename = "opengl")]
    OpenGl,
    /// Unreal Engine.
    Unreal,
}

/// The rows of a matrix whose entries are 0, 1 and −1, one of them in each row and column.
type Turn = [[f64; 3]; 3];

const SAME: Turn = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

impl Convention {
    /// Every convention.
    pub const ALL: [Self; 7] = [
        Self::Gonio,
        Self::Pbrt,
        Self::Mitsuba,
        Self::Blender,
        Self::Gltf,
        Self::OpenGl,
        Self::Unreal,
    ];

    /// The name that [`Convention::from_str`] reads.
    pub fn name(self) -> &'static str {
        match self {
            Self::Gonio => "gonio",
            Self::Pbrt => "pbrt",
            Self::Mitsuba => "mitsuba",
            Self::Blender => "blender",
            Self::Gltf => "gltf",
            Self::OpenGl => "opengl",
            Self::Unreal => "unreal",
        }
    }

    /// Its coordinates of a direction of this program's world.
    pub fn of_world(self, d: Vec3<f64>) -> Vec3<f64> {
        match self {
            Self::Gonio | Self::Mitsuba | Self::Gltf | Self::OpenGl => d,
            Self::Pbrt => Vec3::new(d.z, -d.x, d.y),
            Self::Blender => Vec3::new(d.x, -d.z, d.y),
            Self::Unreal => Vec3::new(-d.z, d.x, d.y),
        }
    }

    /// This program's coordinates of a direction of its world.
    pub fn to_world(self, d: Vec3<f64>) -> Vec3<f64> {
        match self {
            Self::Gonio | Self::Mitsuba | Self::Gltf | Self::OpenGl => d,
            Self::Pbrt => Vec3::new(-d.y, d.z, d.x),
            Self::Blender => Vec3::new(d.x, d.z, -d.y),
            Self::Unreal => Vec3::new(d.y, d.z, -d.x),
        }
    }

    /// From the world to the frame in which a picture that is no cube follows the formulas of its layout.
    fn turn(self, layout: Layout) -> Turn {
        let octahedral = matches!(layout, Layout::Octahedral | Layout::EqualAreaOctahedral);
        match self {
            Self::Gonio | Self::OpenGl => SAME,
            // Columns grow along its x, rows along its y, the centre is its z.
            Self::Pbrt if octahedral => [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]],
            Self::Pbrt => SAME,
            Self::Mitsuba => [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
            // Its mirror ball's camera looks along its +y, which is forward.
            Self::Blender if layout == Layout::MirrorBall => SAME,
            Self::Blender | Self::Gltf => [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]],
            Self::Unreal => [[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]],
        }
    }

    /// The faces of its cubes, in this program's world.
    pub fn faces(self) -> Faces {
        match self {
            Self::Gltf | Self::OpenGl => LOOKED_UP,
            Self::Unreal => {
                let world = |v| self.to_world(v);
                Faces {
                    faces: LOOKED_UP.faces.map(|f| Face {
                        forward: world(f.forward),
                        right: world(f.right),
                        down: world(f.down),
                    }),
                    ..LOOKED_UP
                }
            }
            _ => INSIDE,
        }
    }
}

impl fmt::Display for Convention {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Convention {
    type Err = EnvError;

    /// Reads a name in capitals or not, and `three`, `vulkan`, `d3d`, `directx`, `cycles`.
    fn from_str(text: &str) -> Result<Self, EnvError> {
        let word = text.to_ascii_lowercase();
        let names = Self::ALL.map(Self::name);
        Ok(match word.as_str() {
            "three" | "threejs" | "three.js" => Self::Gltf,
            "vulkan" | "d3d" | "directx" | "gl" => Self::OpenGl,
            "cycles" => Self::Blender,
            "ue" | "ue4" | "ue5" => Self::Unreal,
            "pbrt-v4" => Self::Pbrt,
            _ => {
                let known = Self::ALL.into_iter().find(|c| c.name() == word);
                return known.ok_or_else(|| EnvError::UnknownConvention {
                    found: text.to_owned(),
                    suggestion: suggest(&word, &names),
                });
            }
        })
    }
}

/// A layout as a convention turns it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    layout: Layout,
    convention: Convention,
    turn: Turn,
    faces: Faces,
}

impl View {
    /// How `convention` lays `layout` out.
    pub fn new(layout: Layout, convention: Convention) -> Self {
        Self {
            layout,
            convention,
            turn: convention.turn(layout),
            faces: convention.faces(),
        }
    }

    /// The layout.
    pub fn layout(&self) -> Layout {
        self.layout
    }

    /// The convention.
    pub fn convention(&self) -> Convention {
        self.convention
    }

    /// The faces, if it is a cube.
    pub fn faces(&self) -> &Faces {
        &self.faces
    }

    /// Whether it is the layout as this program turns it.
    pub fn is_own(&self) -> bool {
        match self.layout.arrangement() {
            Some(_) => self.faces == INSIDE,
            None => self.turn == SAME,
        }
    }

    /// The unit direction of the world that is shown at (u, v).
    #[inline(always)]
    pub fn direction<R: Real>(&self, uv: [R; 2]) -> Vec3<R> {
        match self.layout.arrangement() {
            Some(arrangement) => cube::direction(uv, &arrangement, &self.faces),
            None => {
                let p = self.layout.direction(uv);
                let t = &self.turn;
                let column = |k: usize| {
                    R::lit(t[0][k]) * p.x + R::lit(t[1][k]) * p.y + R::lit(t[2][k]) * p.z
                };
                Vec3::new(column(0), column(1), column(2))
            }
        }
    }

    /// Where the unit direction `d` of the world is shown.
    #[inline(always)]
    pub fn uv<R: Real>(&self, d: Vec3<R>) -> [R; 2] {
        match self.layout.arrangement() {
            Some(arrangement) => cube::uv(d, &arrangement, &self.faces),
            None => {
                let row =
                    |r: &[f64; 3]| R::lit(r[0]) * d.x + R::lit(r[1]) * d.y + R::lit(r[2]) * d.z;
                let t = &self.turn;
                self.layout
                    .uv(Vec3::new(row(&t[0]), row(&t[1]), row(&t[2])))
            }
        }
    }
}
