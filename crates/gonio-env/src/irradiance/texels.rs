//! [`LatLongTexels`], the texels of a panorama as they are.

use crate::Layout;
use crate::environment::{Environment, Source};
use gonio_num::Vec3;

/// The texels of a lat-long picture, for programs that integrate over them.
///
/// Between texel centres the radiance is interpolated bilinearly, around the circle in longitude; beyond the first and the last
/// row it is constant along meridians.
#[derive(Debug, Clone, Copy)]
pub struct LatLongTexels<'a> {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Row after row from the top left; each is to be multiplied by `scale`.
    pub texels: &'a [[f32; 3]],
    /// Factor of each channel.
    pub scale: [f32; 3],
    environment: &'a Environment,
}

impl LatLongTexels<'_> {
    /// The direction in the world of a direction of the picture's own frame, in which the centre looks along −z.
    pub fn to_world(&self, d: Vec3<f64>) -> Vec3<f64> {
        self.environment.to_world_f64(d)
    }
}

impl Environment {
    /// The texels, if this is a lat-long picture.
    pub fn lat_long_texels(&self) -> Option<LatLongTexels<'_>> {
        match &self.source {
            Source::Picture(p) if p.map.layout == Layout::LatLong => Some(LatLongTexels {
                width: p.map.width,
                height: p.map.height,
                texels: p.map.texels(),
                scale: self.scale,
                environment: self,
            }),
            _ => None,
        }
    }

    /// Columns and rows of the picture, whatever its layout; nothing for a uniform environment. A computed sky has none: it is given
    /// 4096 × 2048, on which its sun is six texels wide.
    pub fn picture_size(&self) -> Option<[usize; 2]> {
        match &self.source {
            Source::Sky(_) => Some([4096, 2048]),
            Source::Picture(p) => Some([p.map.width, p.map.height]),
            Source::Uniform(_) => None,
        }
    }
}
