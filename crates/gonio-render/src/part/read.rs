//! Reading a part. Every size is compared with the file's before anything is allocated.

use super::{BEFORE, Exposure, HASH, Header, LARGEST_HEADER, MAGIC, VERSION};
use crate::film::record::{Record, Widths, columns_of};
use crate::{Film, RenderError};
use std::fs::File;
use std::io::{BufReader, ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// A part whose header is read.
#[derive(Debug)]
pub struct Opened<R = BufReader<File>> {
    /// The header.
    pub header: Header,
    widths: Widths,
    source: Source<R>,
}

/// Opens a part and reads its header.
///
/// # Errors
/// [`RenderError::Io`] if it can't be read, [`RenderError::Part`] if it is none, is damaged, or has another length than its header says.
pub fn open(path: &Path) -> Result<Opened, RenderError> {
    let io = |action, source| RenderError::Io {
        path: path.to_owned(),
        action,
        source,
    };
    // A folder or a pipe is refused before it is opened: opening a pipe waits for its other end.
    let metadata = std::fs::metadata(path).map_err(|e| io("open it", e))?;
    if !metadata.is_file() {
        return Err(RenderError::Part {
            path: path.to_owned(),
            place: "whole file".into(),
            found: if metadata.is_dir() {
                "a folder".into()
            } else {
                "a pipe or a device".into()
            },
            expected: "a part of a picture".into(),
        });
    }
    let file = File::open(path).map_err(|e| io("open it", e))?;
    let length = file.metadata().map_err(|e| io("open it", e))?.len();
    Opened::of(BufReader::with_capacity(1 << 16, file), length, path)
}

/// Whether a file begins as parts do; not if it can't be read.
pub fn is_one(path: &Path) -> bool {
    let mut start = [0; MAGIC.len()];
    let read = match std::fs::metadata(path) {
        Ok(metadata) if metadata.is_file() => {
            File::open(path).and_then(|mut file| file.read_exact(&mut start))
        }
        _ => return false,
    };
    read.is_ok() && start == MAGIC
}

impl<R: Read> Opened<R> {
    /// As [`open`], of anything that can be read and has `length` bytes; `path` names it in errors.
    ///
    /// # Errors
    /// As [`open`].
    pub fn of(reader: R, length: u64, path: &Path) -> Result<Self, RenderError> {
        let mut source = Source {
            reader,
            path: path.to_owned(),
            at: 0,
            length,
            hasher: blake3::Hasher::new(),
        };
        let magic: [u8; 8] = source.array("a part of a picture")?;
        if magic != MAGIC {
            let found = format!("the bytes {:02x?}", magic);
            return Err(source.error(
                "byte 0",
                found,
                "a part of a picture: 89 67 6f 6e 69 6f 70 0a",
            ));
        }
        let version = u32::from_le_bytes(source.array("the version")?);
        if version != VERSION {
            return Err(source.error(
                "byte 8",
                format!("version {version} of the format"),
                format!("version {VERSION}"),
            ));
        }
        let size = u32::from_le_bytes(source.array("the length of the header")?);
        let most = u64::from(LARGEST_HEADER).min(length.saturating_sub(BEFORE + HASH));
        if u64::from(size) > most {
            return Err(source.error(
                "byte 12",
                format!("a header of {size} bytes"),
                format!("at most {most}"),
            ));
        }
        let mut json = vec![0; size as usize];
        source.fill(&mut json, "the header")?;
        let header: Header = serde_json::from_slice(&json)
            .map_err(|e| source.error("header", e.to_string(), "the header of a part"))?;
        let widths = source.check(&header, u64::from(size))?;
        Ok(Self {
            header,
            widths,
            source,
        })
    }

    /// The part alone.
    ///
    /// # Errors
    /// As [`Opened::add_to`], and as [`Film::new`].
    pub fn read(self) -> Result<Exposure, RenderError> {
        let Header {
            kept,
            width,
            height,
            first,
            ..
        } = self.header;
        let mut exposure = Exposure::keeping(kept, width, height, first)?;
        self.add_to(&mut exposure)?;
        Ok(exposure)
    }

    /// Adds the part to an exposure whose samples end where those of the part begin, pixel by pixel: no more than that exposure
    /// is in memory. After an error the exposure is of no use.
    ///
    /// # Errors
    /// [`RenderError::Part`] if the file is damaged, [`RenderError::Io`] if it can't be read.
    ///
    /// # Panics
    /// If the sizes or the layers differ, or the part's samples don't follow.
    pub fn add_to(mut self, exposure: &mut Exposure) -> Result<(), RenderError> {
        let header = &self.header;
        let film = &mut exposure.film;
        assert_eq!((film.width(), film.height()), (header.width, header.height));
        assert_eq!(film.kept(), header.kept);
        assert_eq!(exposure.samples.end, header.first);
        let count = header.end - header.first;
        let mut record = vec![0; self.widths.bytes()];
        let mut sums = Record::default();
        for index in 0..film.pixels().len() {
            self.source.fill(&mut record, "the sums of a pixel")?;
            if self.widths.read(&record, count, &mut sums).is_none() {
                let (x, y) = (index as u32 % header.width, index as u32 / header.width);
                return Err(self.source.error(
                    format!("pixel {x}, {y}"),
                    "numbers that no samples add up to",
                    format!("the sums of at most {count} samples"),
                ));
            }
            film.merge_pixel(index, &sums);
        }
        let hash = self.source.hasher.finalize();
        let mut stored = [0; HASH as usize];
        self.source.fill(&mut stored, "the hash")?;
        if hash != stored {
            return Err(self.source.error(
                "whole file",
                "other bytes than were written",
                format!("bytes of the hash {}", blake3::Hash::from_bytes(stored)),
            ));
        }
        film.note_rejected(header.rejected());
        exposure.samples.end = header.end;
        exposure.rays += header.rays;
        exposure.elapsed = exposure
            .elapsed
            .saturating_add(Duration::try_from_secs_f64(header.seconds).unwrap_or_default());
        Ok(())
    }
}

/// Bytes, counted and hashed as they are read.
#[derive(Debug)]
struct Source<R> {
    reader: R,
    path: PathBuf,
    at: u64,
    length: u64,
    hasher: blake3::Hasher,
}

impl<R: Read> Source<R> {
    fn fill(&mut self, bytes: &mut [u8], what: &str) -> Result<(), RenderError> {
        self.reader
            .read_exact(bytes)
            .map_err(|source| match source.kind() {
                ErrorKind::UnexpectedEof => self.error(
                    format!("byte {}", self.at),
                    format!("the end of the file, of {} bytes", self.length),
                    what.to_owned(),
                ),
                _ => RenderError::Io {
                    path: self.path.clone(),
                    action: "read it",
                    source,
                },
            })?;
        self.hasher.update(bytes);
        self.at += bytes.len() as u64;
        Ok(())
    }

    fn array<const N: usize>(&mut self, what: &str) -> Result<[u8; N], RenderError> {
        let mut bytes = [0; N];
        self.fill(&mut bytes, what)?;
        Ok(bytes)
    }

    /// Compares what the header says with itself and with the file's length.
    fn check(&self, header: &Header, size: u64) -> Result<Widths, RenderError> {
        // A film of that size, or the reason why there is none; before its numbers are counted.
        Film::check(header.kept, header.width, header.height)?;
        let Some(widths) = Widths::from_slice(header.kept, &header.columns) else {
            return Err(self.error(
                "header, columns",
                format!("{} numbers: {:?}", header.columns.len(), header.columns),
                format!("{} widths of 0 to 8 bytes", columns_of(&header.kept)),
            ));
        };
        let (groups, named) = (header.kept.groups as usize, header.names.groups.len());
        if groups > 0 && groups != named {
            return Err(self.error(
                "header, names",
                format!("{named} names of groups"),
                format!("{groups}, as many as there are groups"),
            ));
        }
        if header.first >= header.end || header.of.is_some_and(|of| header.end > of) {
            let of = header.of.map_or(String::new(), |of| format!(" of {of}"));
            return Err(self.error(
                "header",
                format!("samples {} to {}{of}", header.first, header.end),
                "at least one sample, within the whole",
            ));
        }
        if !(header.seconds >= 0.0 && header.seconds.is_finite()) {
            let found = format!("{} seconds", header.seconds);
            return Err(self.error("header, seconds", found, "a time"));
        }
        let pixels = u64::from(header.width) * u64::from(header.height);
        let expected = pixels
            .saturating_mul(widths.bytes() as u64)
            .saturating_add(BEFORE + size + HASH);
        if expected != self.length {
            return Err(self.error(
                "whole file",
                format!("{} bytes", self.length),
                format!(
                    "{expected}, for {}×{} pixels of {} bytes",
                    header.width,
                    header.height,
                    widths.bytes()
                ),
            ));
        }
        Ok(widths)
    }

    fn error(
        &self,
        place: impl Into<String>,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> RenderError {
        RenderError::Part {
            path: self.path.clone(),
            place: place.into(),
            found: found.into(),
            expected: expected.into(),
        }
    }
}
