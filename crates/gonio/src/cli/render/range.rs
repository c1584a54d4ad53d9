//! Which samples are taken: all, a range, or a part of as many.

use super::{Arguments, DEFAULT_SAMPLES, NO_LIMIT};
use crate::cli::failure::Failure;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Variables in which job systems tell a task its index.
const INDICES: [(&str, &str); 4] = [
    ("SLURM_ARRAY_TASK_ID", "Slurm"),
    ("PBS_ARRAY_INDEX", "PBS"),
    ("HQ_TASK_ID", "HyperQueue"),
    ("JOB_COMPLETION_INDEX", "Kubernetes"),
];

/// One of `of` parts, counted from 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Part {
    /// None: the index that the job system tells.
    index: Option<u32>,
    of: u32,
}

/// The samples to take.
#[derive(Debug)]
pub(super) struct Chosen {
    pub samples: Range<u32>,
    /// Those of the whole picture, if that is settled.
    pub of: Option<u32>,
    /// The index of the part.
    part: Option<u32>,
}

impl Chosen {
    /// A file's name with the index of the part for `{part}`.
    pub fn name(&self, path: &Path) -> PathBuf {
        match (self.part, path.to_str()) {
            (Some(part), Some(text)) => text.replace("{part}", &part.to_string()).into(),
            _ => path.to_owned(),
        }
    }
}

/// `3/8` or `auto/8`.
pub(super) fn part(text: &str) -> Result<Part, String> {
    let expected = || {
        "expected K/N with K from 0 to N − 1, such as 0/8, or auto/N for the index that the job system tells"
            .to_owned()
    };
    let (index, of) = text.split_once('/').ok_or_else(expected)?;
    let of = of.parse().ok().filter(|n| *n > 0).ok_or_else(expected)?;
    let index = match index {
        "auto" => None,
        number => Some(
            number
                .parse()
                .ok()
                .filter(|k| *k < of)
                .ok_or_else(expected)?,
        ),
    };
    Ok(Part { index, of })
}

/// `16:32`: from the first sample up to, and without, the last.
pub(super) fn samples(text: &str) -> Result<Range<u32>, String> {
    let number = |s: &str| s.parse::<u32>().ok();
    text.split_once(':')
        .and_then(|(first, end)| Some(number(first)?..number(end)?))
        .filter(|range| !range.is_empty())
        .ok_or_else(|| {
            "expected FIRST:END, samples counted from 0, END not among them, such as 16:32".into()
        })
}

/// The samples that the arguments ask for.
pub(super) fn of(
    arguments: &Arguments,
    environment: impl Fn(&str) -> Option<String>,
) -> Result<Chosen, Failure> {
    let open_ended = arguments.time.is_some() || arguments.noise.is_some();
    let spp = arguments.spp;
    if let Some(range) = &arguments.samples {
        if let Some(spp) = spp.filter(|spp| range.end > *spp) {
            return Err(Failure::usage(format!(
                "--samples {}:{} goes beyond --spp {spp}",
                range.start, range.end
            ))
            .with_help("--spp is the number of samples of the whole picture"));
        }
        return Ok(Chosen {
            samples: range.clone(),
            of: spp,
            part: None,
        });
    }
    if let Some(part) = arguments.part {
        let whole = spp.unwrap_or(DEFAULT_SAMPLES);
        let index = match part.index {
            Some(index) => index,
            None => index_from(part.of, environment)?,
        };
        let at = |k: u32| (u64::from(whole) * u64::from(k) / u64::from(part.of)) as u32;
        let range = at(index)..at(index + 1);
        if range.is_empty() {
            return Err(Failure::usage(format!(
                "part {index} of {} has none of the {whole} samples per pixel",
                part.of
            ))
            .with_help(format!(
                "make at most {whole} parts, or more samples: --spp"
            )));
        }
        return Ok(Chosen {
            samples: range,
            of: Some(whole),
            part: Some(index),
        });
    }
    let end = self::spp(arguments);
    // Only the mean is given then.
    let some_have_more = arguments.adaptive && arguments.noise.is_none();
    Ok(Chosen {
        samples: 0..if some_have_more { NO_LIMIT } else { end },
        of: (!open_ended && !some_have_more).then_some(end),
        part: None,
    })
}

/// Samples per pixel at which the picture ends at the latest.
pub(super) fn spp(arguments: &Arguments) -> u32 {
    let open_ended = arguments.time.is_some() || arguments.noise.is_some();
    arguments.spp.unwrap_or(if open_ended {
        NO_LIMIT
    } else {
        DEFAULT_SAMPLES
    })
}

/// The index that the job system tells.
fn index_from(of: u32, environment: impl Fn(&str) -> Option<String>) -> Result<u32, Failure> {
    let told: Vec<(&str, &str, String)> = INDICES
        .iter()
        .filter_map(|(name, system)| Some((*name, *system, environment(name)?)))
        .collect();
    let Some((name, system, text)) = told.first() else {
        let names = INDICES.map(|(name, _)| name).join(", ");
        return Err(Failure::usage(format!(
            "--part auto/{of}: no job system tells the index: none of {names} is set"
        ))
        .with_help(format!("name the part: --part 0/{of} to {}/{of}", of - 1)));
    };
    if let Some((other, _, differs)) = told.iter().find(|(_, _, t)| t != text) {
        return Err(Failure::usage(format!(
            "--part auto/{of}: {name} is {text}, but {other} is {differs}"
        ))
        .with_help("name the part: --part K/N"));
    }
    text.trim()
        .parse::<u32>()
        .ok()
        .filter(|k| *k < of)
        .ok_or_else(|| {
            Failure::usage(format!(
                "--part auto/{of}: {name} is '{text}', expected 0 to {}",
                of - 1
            ))
            .with_help(format!(
                "parts are counted from 0: let the array of {system} have the indices 0 to {}",
                of - 1
            ))
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_and_ranges_are_read() {
        let known = |index, of| Ok(Part { index, of });
        assert_eq!(part("3/8"), known(Some(3), 8));
        assert_eq!(part("auto/8"), known(None, 8));
        for text in [
            "", "3", "8/8", "-1/8", "0/0", "auto/0", "auto", "a/8", "1/8/9",
        ] {
            assert!(part(text).is_err(), "{text}");
        }
        assert_eq!(samples("16:32"), Ok(16..32));
        for text in [
            "",
            "16",
            "32:16",
            "3:3",
            "a:b",
            "-1:4",
            "1:2:3",
            "0:4294967296",
        ] {
            assert!(samples(text).is_err(), "{text}");
        }
    }

    #[test]
    fn the_index_is_that_of_the_job_system() {
        let with = |pairs: &'static [(&str, &str)]| {
            index_from(4, move |name| {
                let found = pairs.iter().find(|(n, _)| *n == name);
                found.map(|(_, value)| (*value).to_owned())
            })
        };
        assert_eq!(with(&[("SLURM_ARRAY_TASK_ID", "3")]), Ok(3));
        assert_eq!(with(&[("JOB_COMPLETION_INDEX", "0")]), Ok(0));
        assert_eq!(
            with(&[("HQ_TASK_ID", "2"), ("SLURM_ARRAY_TASK_ID", "2")]),
            Ok(2)
        );
        for (pairs, word) in [
            (&[][..], "none of SLURM_ARRAY_TASK_ID"),
            (&[("PBS_ARRAY_INDEX", "4")], "expected 0 to 3"),
            (&[("PBS_ARRAY_INDEX", "x")], "'x'"),
            (
                &[("HQ_TASK_ID", "1"), ("SLURM_ARRAY_TASK_ID", "2")],
                "but HQ_TASK_ID is 1",
            ),
        ] {
            let failure = with(pairs).unwrap_err();
            assert!(failure.message().contains(word), "{failure:?}");
        }
    }
}
