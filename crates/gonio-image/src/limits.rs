//! [`Limits`]: how much a reader may allocate.

use crate::ImageError;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Cursor, Read, Seek, SeekFrom};
use std::path::Path;

/// A file that is read.
pub(crate) enum Source {
    File(BufReader<File>),
    Memory(Cursor<Vec<u8>>),
}

impl Source {
    /// The first bytes, at most `count` of them; reading begins with them again.
    pub fn start(&mut self, count: u64) -> io::Result<Vec<u8>> {
        let mut start = Vec::new();
        self.take(count).read_to_end(&mut start)?;
        self.rewind()?;
        Ok(start)
    }

    /// All bytes.
    pub fn into_bytes(mut self) -> io::Result<Vec<u8>> {
        if let Self::Memory(bytes) = self {
            return Ok(bytes.into_inner());
        }
        let mut bytes = Vec::new();
        if let Self::File(file) = &self {
            // Exactly its size: a vector that grows would hold twice as much for a moment.
            let length = file.get_ref().metadata()?.len();
            bytes.reserve_exact(usize::try_from(length).unwrap_or(0).saturating_add(1));
        }
        self.read_to_end(&mut bytes)?;
        Ok(bytes)
    }
}

impl Read for Source {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::File(file) => file.read(bytes),
            Self::Memory(all) => all.read(bytes),
        }
    }
}

impl BufRead for Source {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        match self {
            Self::File(file) => file.fill_buf(),
            Self::Memory(all) => all.fill_buf(),
        }
    }

    fn consume(&mut self, count: usize) {
        match self {
            Self::File(file) => file.consume(count),
            Self::Memory(all) => all.consume(count),
        }
    }
}

impl Seek for Source {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        match self {
            Self::File(file) => file.seek(to),
            Self::Memory(all) => all.seek(to),
        }
    }
}

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

    /// The file, to be read piece by piece, if it is within the limit. Special files, which can't be gone back in, are read up
    /// to the limit.
    pub(crate) fn open(&self, path: &Path) -> Result<Source, ImageError> {
        let io = |action| move |e| ImageError::io(path, action, e);
        let file = File::open(path).map_err(io("open it"))?;
        let about = file.metadata().map_err(io("ask for its length"))?;
        if about.is_file() {
            self.check_bytes(&path.display().to_string(), about.len())?;
            return Ok(Source::File(BufReader::with_capacity(1 << 18, file)));
        }
        Ok(Source::Memory(Cursor::new(self.read_all(path, file)?)))
    }

    /// The whole file, if it is within the limit. Special files without a length are read up to the limit.
    pub(crate) fn read_file(&self, path: &Path) -> Result<Vec<u8>, ImageError> {
        self.open(path)?
            .into_bytes()
            .map_err(|e| ImageError::io(path, "read it", e))
    }

    /// What a special file gives, up to the limit.
    fn read_all(&self, path: &Path, file: File) -> Result<Vec<u8>, ImageError> {
        let mut bytes = Vec::new();
        file.take(self.max_bytes.saturating_add(1))
            .read_to_end(&mut bytes)
            .map_err(|e| ImageError::io(path, "read it", e))?;
        self.check_bytes(&path.display().to_string(), bytes.len() as u64)?;
        Ok(bytes)
    }
}
