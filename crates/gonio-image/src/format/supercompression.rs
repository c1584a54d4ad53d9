//! Levels of a KTX2 file that are compressed as a whole.

use crate::ImageError;
use crate::contain::contain;
use flate2::read::ZlibDecoder;
use ruzstd::decoding::StreamingDecoder;
use std::borrow::Cow;
use std::io::Read;

/// How the levels of a KTX2 file are compressed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Scheme {
    None,
    Zstandard,
    Zlib,
}

impl Scheme {
    /// The scheme of the header's number.
    pub fn of(file: &str, number: u32) -> Result<Self, ImageError> {
        match number {
            0 => Ok(Self::None),
            2 => Ok(Self::Zstandard),
            3 => Ok(Self::Zlib),
            n => Err(ImageError::unsupported(
                file,
                match n {
                    1 => "supercompression by BasisLZ".into(),
                    n => format!("supercompression by scheme {n}"),
                },
                "Zstandard, ZLIB and none are",
            )),
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::None => "no",
            Self::Zstandard => "Zstandard",
            Self::Zlib => "ZLIB",
        }
    }

    /// The `expected` bytes that `data` stand for. Memory grows with what comes out, never past `expected`.
    pub fn expand<'a>(
        self,
        file: &str,
        level: usize,
        data: &'a [u8],
        expected: u64,
    ) -> Result<Cow<'a, [u8]>, ImageError> {
        let read = |stream: &mut dyn Read| -> Result<Vec<u8>, String> {
            let mut all = Vec::new();
            // One more, to see that nothing follows.
            stream
                .take(expected.saturating_add(1))
                .read_to_end(&mut all)
                .map_err(|e| e.to_string())?;
            Ok(all)
        };
        let outcome = match self {
            Self::None => return Ok(Cow::Borrowed(data)),
            Self::Zlib => contain(|| read(&mut ZlibDecoder::new(data))),
            Self::Zstandard => contain(|| {
                let mut stream = StreamingDecoder::new(data).map_err(|e| e.to_string())?;
                read(&mut stream)
            }),
        };
        let wrong = |found: String| {
            ImageError::format(
                file,
                format!("level {level}"),
                found,
                format!("a {} stream of {expected} bytes", self.name()),
            )
        };
        match outcome {
            Ok(Ok(all)) if all.len() as u64 == expected => Ok(Cow::Owned(all)),
            Ok(Ok(all)) if all.len() as u64 > expected => Err(wrong("more bytes than that".into())),
            Ok(Ok(all)) => Err(wrong(format!("{} bytes", all.len()))),
            Ok(Err(why)) => Err(wrong(format!("a corrupt stream ({why})"))),
            Err(panic) => Err(wrong(format!(
                "a stream that its decoder gave up on ({panic})"
            ))),
        }
    }
}
