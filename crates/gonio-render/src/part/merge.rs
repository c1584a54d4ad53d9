//! Parts put together.

use super::{Exposure, Header, Label, open};
use crate::{Kept, RenderError};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Parts of one picture that belong together: no sample is in two of them, none between them is missing.
#[derive(Debug)]
pub struct Parts {
    /// By their samples.
    parts: Vec<(PathBuf, Header)>,
}

impl Parts {
    /// Reads the headers of parts, in any order.
    ///
    /// # Errors
    /// [`RenderError::Merge`] for parts of different pictures, for samples that are in two parts, and for some that are missing between
    /// them: it names the files and what differs. [`RenderError::Part`] and [`RenderError::Io`] for a file that can't be used.
    ///
    /// # Panics
    /// Without paths.
    pub fn of(paths: &[PathBuf]) -> Result<Self, RenderError> {
        assert!(!paths.is_empty(), "no parts");
        let mut parts = Vec::with_capacity(paths.len());
        for path in paths {
            // The file is closed again: there may be more of them than a process may have open.
            parts.push((path.clone(), open(path)?.header));
        }
        parts.sort_by_key(|(_, header)| (header.first, header.end));
        for pair in parts.windows(2) {
            fits(&pair[0], &pair[1])?;
        }
        Ok(Self { parts })
    }

    /// The samples that they hold together.
    pub fn samples(&self) -> Range<u32> {
        self.parts[0].1.first..self.parts[self.parts.len() - 1].1.end
    }

    /// The layers that they keep.
    pub fn kept(&self) -> Kept {
        self.parts[0].1.kept
    }

    /// What they are parts of.
    pub fn label(&self) -> Label {
        self.parts[0].1.label()
    }

    /// Fails if samples are missing at the beginning, or at the end of a picture whose number of samples is settled.
    ///
    /// # Errors
    /// [`RenderError::Merge`] with what is missing.
    pub fn require_whole(&self) -> Result<(), RenderError> {
        let missing = |part: &(PathBuf, Header), range: Range<u32>| RenderError::Merge {
            path: part.0.clone(),
            what: format!("no part has the samples {}", said(&range)),
        };
        let first = &self.parts[0];
        if first.1.first > 0 {
            return Err(missing(first, 0..first.1.first));
        }
        let last = &self.parts[self.parts.len() - 1];
        match last.1.of {
            Some(of) if last.1.end < of => Err(missing(last, last.1.end..of)),
            _ => Ok(()),
        }
    }

    /// Adds them all, one after another: one film is in memory, whatever their number. `progress` is told after each how many are added.
    ///
    /// # Errors
    /// As [`super::Opened::read`]; [`RenderError::Merge`] for a file that was replaced in the meantime.
    pub fn add(&self, mut progress: impl FnMut(usize)) -> Result<Exposure, RenderError> {
        let header = &self.parts[0].1;
        let (width, height) = (header.width, header.height);
        let mut whole = Exposure::keeping(header.kept, width, height, header.first)?;
        for (index, (path, header)) in self.parts.iter().enumerate() {
            let opened = open(path)?;
            if opened.header != *header {
                return Err(RenderError::Merge {
                    path: path.clone(),
                    what: "the file was replaced while parts were added".into(),
                });
            }
            opened.add_to(&mut whole)?;
            progress(index + 1);
        }
        Ok(whole)
    }
}

/// Whether `next` goes on where `part` ends.
fn fits(part: &(PathBuf, Header), next: &(PathBuf, Header)) -> Result<(), RenderError> {
    let (a, b) = (&part.1, &next.1);
    let differs = |what: String| RenderError::Merge {
        path: next.0.clone(),
        what,
    };
    let other = name(&part.0);
    if let Some(mismatch) = b.identity.mismatch(&a.identity) {
        return Err(differs(format!("{mismatch} as in {other}")));
    }
    // Equal pictures have equal ones, unless somebody wrote them by hand.
    if (a.kept, &a.names, a.width, a.height) != (b.kept, &b.names, b.width, b.height) {
        return Err(differs(format!(
            "another list of layers, names or pixels than in {other}"
        )));
    }
    if a.of != b.of {
        let of = |of: Option<u32>| of.map_or("an open number".into(), |n| n.to_string());
        return Err(differs(format!(
            "a part of a picture of {} samples per pixel, {other} is one of {}",
            of(b.of),
            of(a.of)
        )));
    }
    if b.first < a.end {
        return Err(differs(format!(
            "the samples {} are in {other}, too",
            said(&(b.first..b.end.min(a.end)))
        )));
    }
    if b.first > a.end {
        return Err(differs(format!(
            "the samples {} between {other} and this part are missing",
            said(&(a.end..b.first))
        )));
    }
    Ok(())
}

fn name(path: &Path) -> String {
    path.display().to_string()
}

/// A range as `--samples` takes it.
fn said(range: &Range<u32>) -> String {
    format!("{}:{}", range.start, range.end)
}
