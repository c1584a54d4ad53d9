//! The images of a glTF document, each decoded once, when it is first used.

use super::accessor::Arrays;
use super::container::resolve;
use crate::texture::Bitmap;
use crate::{LoadOptions, SceneError};
use gonio_image::{Limits, RawImage};
use std::collections::HashMap;
use std::sync::Arc;

/// The images used so far.
pub(super) struct Images<'a> {
    arrays: &'a Arrays<'a>,
    limits: Limits,
    options: &'a LoadOptions,
    decoded: HashMap<usize, Arc<Bitmap>>,
}

impl<'a> Images<'a> {
    pub fn new(arrays: &'a Arrays<'a>, options: &'a LoadOptions) -> Self {
        let limits = Limits {
            max_pixels: options.max_texture_pixels,
            ..Limits::default()
        };
        Self {
            arrays,
            limits,
            options,
            decoded: HashMap::new(),
        }
    }

    /// Image `index`, decoded.
    ///
    /// # Errors
    /// [`SceneError::Format`] if it doesn't exist or has no bytes, [`SceneError::Io`] if its file can't be read,
    /// [`SceneError::Image`] if it can't be decoded.
    pub fn bitmap(&mut self, index: usize, place: &str) -> Result<Arc<Bitmap>, SceneError> {
        if let Some(bitmap) = self.decoded.get(&index) {
            return Ok(bitmap.clone());
        }
        let (arrays, images) = (self.arrays, &self.arrays.root.images);
        let image = images.get(index);
        let image = image
            .ok_or_else(|| arrays.missing(&format!("{place}, image {index}"), images.len()))?;
        let label = match (&image.uri, &image.name) {
            (Some(uri), _) if !uri.starts_with("data:") => format!("image {index} ({uri})"),
            (_, Some(name)) => format!("image {index} ({name})"),
            _ => format!("image {index}"),
        };
        let owned;
        let bytes: &[u8] = match (&image.uri, image.buffer_view) {
            (Some(uri), _) => {
                owned = resolve(arrays.path, &label, uri, self.options)?;
                &owned
            }
            (None, Some(view)) => arrays.view(view.value())?,
            (None, None) => {
                let found = "neither a URI nor a bufferView";
                return Err(SceneError::format(
                    arrays.path,
                    label,
                    found,
                    "an image's bytes",
                ));
            }
        };
        let raw =
            RawImage::decode_within(bytes, &self.limits).map_err(|source| SceneError::Image {
                what: format!("{}: {label}", arrays.path.display()),
                source,
            })?;
        let bitmap = Arc::new(Bitmap::new(label, raw));
        self.decoded.insert(index, bitmap.clone());
        Ok(bitmap)
    }
}
