//! [`TextureInput`], a texture as the source of a parameter's values.

use crate::Texture;

/// Which channels of a texture are used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Channels {
    /// Red, green and blue.
    #[default]
    Rgb,
    /// Red, for all components.
    Red,
    /// Green, for all components.
    Green,
    /// Blue, for all components.
    Blue,
    /// Alpha, for all components.
    Alpha,
}

/// A texture's channels, scaled and shifted: value = `scale` · texel + `offset`.
#[derive(Debug, Clone, PartialEq)]
pub struct TextureInput {
    /// The texture.
    pub texture: Texture,
    /// The channels used.
    pub channels: Channels,
    /// Factor.
    pub scale: [f32; 3],
    /// Summand.
    pub offset: [f32; 3],
}

impl TextureInput {
    /// The texture's channels as they are.
    pub fn new(texture: Texture, channels: Channels) -> Self {
        Self {
            texture,
            channels,
            scale: [1.0; 3],
            offset: [0.0; 3],
        }
    }

    /// The value at a point with these texture coordinates.
    #[inline]
    pub fn value(&self, uv: [f32; 2], uv1: [f32; 2]) -> [f32; 3] {
        let [r, g, b, a] = self.texture.lookup(uv, uv1);
        let texel = match self.channels {
            Channels::Rgb => [r, g, b],
            Channels::Red => [r; 3],
            Channels::Green => [g; 3],
            Channels::Blue => [b; 3],
            Channels::Alpha => [a; 3],
        };
        std::array::from_fn(|k| self.scale[k] * texel[k] + self.offset[k])
    }
}
