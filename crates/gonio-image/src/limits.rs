//! [`Limits`]: how much a reader may allocate.

use crate::ImageError;
use std::io::Read;
use std::path::Path;

/// How large a picture may be. Every reader checks its header against these before it allocates pixels, so a file of a
/// hundred bytes that claims to be 100,000 × 100,000 pixels is refused at once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Width × height. Default 2²⁸ (a panorama of 23,170 × 11,585).
    pub max_pixels: u64,
    /// Bytes of the decoded picture, all channels together; the file itself may not be larger either. Default 8 GiB.
    /// A decoder works with a few more buffers, at most about three times this.
    pub max_bytes: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            max_pixels: 1 << 28,
            max_bytes: 8 << 30,
        }
    }
}

impl Limits {
    /// Checks a picture of `width` × `height` whose decoded pixels take `bytes_per_pixel`.
    ///
    /// # Errors
    /// [`ImageError::Format`] if a side is 0, [`ImageError::Limit`] if it is too large.
    pub(crate) fn check(
        &self,
        file: &str,
        width: u64,
        height: u64,
        bytes_per_pixel: u64,
    ) -> Result<(), ImageError> {
        if width == 0 || height == 0 {
            return Err(ImageError::format(
                file,
                "header",
                format!("a picture of {width} × {height}"),
                "at least one pixel",
            ));
        }
        let pixels = width.saturating_mul(height);
        if pixels > self.max_pixels {
            return Err(ImageError::Limit {
                file: file.into(),
                what: format!("pixels ({width} × {height}):"),
                found: pixels,
                limit: self.max_pixels,
            });
        }
        self.check_bytes(file, pixels.saturating_mul(bytes_per_pixel))
    }

    pub(crate) fn check_bytes(&self, file: &str, bytes: u64) -> Result<(), ImageError> {
        // What does not fit the address space cannot be allocated, whatever the limit says.
        let limit = self.max_bytes.min(isize::MAX as u64);
        if bytes > limit {
            return Err(ImageError::Limit {
                file: file.into(),
                what: "bytes:".into(),
                found: bytes,
                limit,
            });
        }
        Ok(())
    }

    /// The whole file, if it is within the limit. Special files without a length are read up to the limit.
    pub(crate) fn read_file(&self, path: &Path) -> Result<Vec<u8>, ImageError> {
        let name = path.display().to_string();
        let file = std::fs::File::open(path).map_err(|e| ImageError::io(path, "open it", e))?;
        let length = file
            .metadata()
            .map_err(|e| ImageError::io(path, "ask for its length", e))?
            .len();
        self.check_bytes(&name, length)?;
        let mut bytes = Vec::new();
        file.take(self.max_bytes.saturating_add(1))
            .read_to_end(&mut bytes)
            .map_err(|e| ImageError::io(path, "read it", e))?;
        self.check_bytes(&name, bytes.len() as u64)?;
        Ok(bytes)
    }
}
