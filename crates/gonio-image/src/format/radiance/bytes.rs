//! Bytes of a file, looked at a few at a time.

use crate::ImageError;
use std::io::Read;

/// Bytes that are read ahead.
const AHEAD: usize = 1 << 16;

/// A window that moves over a file.
pub(super) struct Bytes<R> {
    source: R,
    window: Vec<u8>,
    /// What of the window is still to come.
    start: usize,
    /// How many bytes lie before the window.
    before: u64,
    ended: bool,
    failure: Option<std::io::Error>,
}

impl<R: Read> Bytes<R> {
    pub fn new(source: R) -> Self {
        Self {
            source,
            window: Vec::new(),
            start: 0,
            before: 0,
            ended: false,
            failure: None,
        }
    }

    /// How many bytes were taken.
    pub fn taken(&self) -> u64 {
        self.before + self.start as u64
    }

    /// Why there were no more bytes, if it was not the end of the file.
    pub fn failure(&mut self, file: &str) -> Option<ImageError> {
        let source = self.failure.take()?;
        Some(ImageError::Io {
            file: file.into(),
            action: "read it",
            source,
        })
    }

    /// The next `count` bytes, which stay; fewer at the end of the file.
    pub fn peek(&mut self, count: usize) -> &[u8] {
        if self.window.len() - self.start < count && !self.ended {
            self.window.drain(..self.start);
            self.before += self.start as u64;
            self.start = 0;
            let more = (count.max(AHEAD) - self.window.len()) as u64;
            let had = self.window.len();
            if let Err(e) = (&mut self.source).take(more).read_to_end(&mut self.window) {
                self.failure = Some(e);
                self.ended = true;
            }
            self.ended |= ((self.window.len() - had) as u64) < more;
        }
        let end = self.window.len().min(self.start + count);
        &self.window[self.start..end]
    }

    /// The next `count` bytes, if there are as many.
    pub fn take(&mut self, count: usize) -> Option<&[u8]> {
        if self.peek(count).len() < count {
            return None;
        }
        self.start += count;
        Some(&self.window[self.start - count..self.start])
    }

    /// The next line of at most `longest` bytes, without its end.
    pub fn line(&mut self, longest: usize) -> Option<Vec<u8>> {
        let line = self.peek(longest);
        let end = line.iter().position(|&b| b == b'\n')?;
        let line = line[..end].to_vec();
        self.start += end + 1;
        Some(line)
    }
}
