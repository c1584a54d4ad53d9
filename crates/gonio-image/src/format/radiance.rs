//! Radiance RGBE (`.hdr`, `.pic`), read and written here: errors name the scan line, and every orientation, run-length
//! scheme and exposure is honoured.
//!
//! A sample is m · 2^(e − 136) with an 8-bit mantissa m for each channel and one exponent e for the three; e = 0 is black.
//! Source: Ward, "Real Pixels", Graphics Gems II, 1991; the file layout is in Radiance's `filefmts`. Like most
//! programs, and unlike Radiance's own, no half step is added to the mantissa: so what is written reads back as the
//! nearest value, and black stays black.

mod bytes;
mod scanline;

use crate::rows::Fill;
use crate::{Image, ImageError, Limits};
use bytes::Bytes;
use std::io::{Read, Write};

/// Longest header line that is read; Radiance's own limit is 2048.
const LONGEST_LINE: usize = 65_536;

struct Header {
    /// Factor from file values to radiance: 1 / (EXPOSURE · COLORCORR).
    scale: [f32; 3],
    layout: Layout,
}

/// The order of the pixels in the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Layout {
    width: usize,
    height: usize,
    /// Scan lines are columns.
    by_columns: bool,
    /// x falls along the file.
    flip_x: bool,
    /// y, counted upwards, rises along the file: the bottom comes first.
    flip_y: bool,
}

impl Layout {
    fn lines(&self) -> (usize, usize) {
        if self.by_columns {
            (self.width, self.height)
        } else {
            (self.height, self.width)
        }
    }

    /// Index in the image of sample `i` of scan line `line`.
    fn target(&self, line: usize, i: usize) -> usize {
        let (mut x, mut y) = if self.by_columns {
            (line, i)
        } else {
            (i, line)
        };
        if self.flip_x {
            x = self.width - 1 - x;
        }
        if self.flip_y {
            y = self.height - 1 - y;
        }
        y * self.width + x
    }
}

/// Decodes a Radiance picture of `length` bytes, scan line by scan line.
pub(crate) fn decode(
    file: &str,
    source: impl Read,
    length: u64,
    limits: &Limits,
) -> Result<Image, ImageError> {
    let mut lines = ScanLines::open(file, source, length, limits)?;
    let (layout, scale) = (lines.header.layout, lines.header.scale);
    let mut image = Image::new(layout.width, layout.height);
    while let Some((number, line)) = lines.next(file)? {
        for (i, &rgbe) in line.iter().enumerate() {
            let rgb = from_rgbe(rgbe);
            image.pixels[layout.target(number, i)] = std::array::from_fn(|c| rgb[c] * scale[c]);
        }
    }
    Ok(image)
}

/// Reads what [`write_rows`] wrote; `seen` gets each channel of each row. Returns columns and rows.
pub(crate) fn read_rows(
    file: &str,
    source: impl Read,
    length: u64,
    limits: &Limits,
    seen: &mut dyn FnMut(usize, usize, &[f32]),
) -> Result<[usize; 2], ImageError> {
    let mut lines = ScanLines::open(file, source, length, limits)?;
    let layout = lines.header.layout;
    let mut row = vec![0.0; layout.width];
    while let Some((y, line)) = lines.next(file)? {
        for c in 0..3 {
            for (to, &from) in row.iter_mut().zip(line) {
                *to = from_rgbe(from)[c];
            }
            seen(y, c, &row);
        }
    }
    Ok([layout.width, layout.height])
}

/// A scan line and its number.
type Numbered<'a> = (usize, &'a [[u8; 4]]);

/// The scan lines of a file, one after the other.
struct ScanLines<R> {
    bytes: Bytes<R>,
    header: Header,
    line: Vec<[u8; 4]>,
    number: usize,
}

impl<R: Read> ScanLines<R> {
    fn open(file: &str, source: R, length: u64, limits: &Limits) -> Result<Self, ImageError> {
        let mut bytes = Bytes::new(source);
        let header = read_header(file, &mut bytes)?;
        let layout = header.layout;
        limits.check(file, layout.width as u64, layout.height as u64, 12)?;
        let (lines, line_length) = layout.lines();
        // The shortest a scan line can be: old run lengths reach 2²⁴ and more pixels in a few bytes, so only one byte a
        // line can be asked for. It still stops a header of a hundred bytes before the picture is allocated.
        let present = length.saturating_sub(bytes.taken());
        if present < lines as u64 {
            return Err(ImageError::format(
                file,
                "pixels",
                format!("{present} bytes"),
                format!("{lines} scan lines of {line_length} pixels"),
            ));
        }
        Ok(Self {
            bytes,
            line: vec![[0; 4]; line_length],
            header,
            number: 0,
        })
    }

    /// The next scan line and its number; nothing after the last.
    fn next(&mut self, file: &str) -> Result<Option<Numbered<'_>>, ImageError> {
        let (number, (lines, length)) = (self.number, self.header.layout.lines());
        if number == lines {
            return Ok(None);
        }
        if let Err(problem) = scanline::decode(&mut self.bytes, &mut self.line) {
            return Err(self.bytes.failure(file).unwrap_or_else(|| {
                ImageError::format(
                    file,
                    format!("scan line {number} of {lines}"),
                    problem,
                    format!("{length} RGBE pixels"),
                )
            }));
        }
        self.number += 1;
        Ok(Some((number, &self.line)))
    }
}

fn read_header<R: Read>(file: &str, bytes: &mut Bytes<R>) -> Result<Header, ImageError> {
    let mut number = 0;
    let mut next_line = || -> Result<(usize, String), ImageError> {
        number += 1;
        let Some(line) = bytes.line(LONGEST_LINE) else {
            return Err(bytes.failure(file).unwrap_or_else(|| {
                ImageError::format(
                    file,
                    format!("header line {number}"),
                    "no end of the line",
                    "a header ended by an empty line, then the resolution",
                )
            }));
        };
        let line = String::from_utf8_lossy(&line);
        Ok((number, line.trim_end_matches('\r').to_string()))
    };
    next_line()?;
    let mut scale = [1.0f64; 3];
    loop {
        let (number, line) = next_line()?;
        if line.trim().is_empty() {
            break;
        }
        let Some((key, value)) = line.split_once('=') else {
            // A line without `=` is a command that made the picture, or a comment.
            continue;
        };
        let place = || format!("header line {number}");
        match key.trim() {
            "FORMAT" if value.trim() == "32-bit_rle_rgbe" => {}
            "FORMAT" => {
                return Err(ImageError::unsupported(
                    file,
                    format!("FORMAT={}", value.trim()),
                    "32-bit_rle_rgbe is",
                ));
            }
            "EXPOSURE" => {
                let [exposure] = factors(value).ok_or_else(|| {
                    ImageError::format(file, place(), line.clone(), "EXPOSURE=a positive number")
                })?;
                scale = scale.map(|s| s / exposure);
            }
            "COLORCORR" => {
                let correction: [f64; 3] = factors(value).ok_or_else(|| {
                    ImageError::format(
                        file,
                        place(),
                        line.clone(),
                        "COLORCORR=three positive numbers",
                    )
                })?;
                scale = std::array::from_fn(|c| scale[c] / correction[c]);
            }
            _ => {}
        }
    }
    let (number, line) = next_line()?;
    let layout = resolution(&line).ok_or_else(|| {
        ImageError::format(
            file,
            format!("header line {number}"),
            format!("`{}`", line.chars().take(60).collect::<String>()),
            "a resolution like `-Y 512 +X 1024`",
        )
    })?;
    Ok(Header {
        scale: scale.map(|s| s as f32),
        layout,
    })
}

/// `N` positive finite numbers and nothing else.
fn factors<const N: usize>(text: &str) -> Option<[f64; N]> {
    let mut words = text.split_whitespace();
    let mut all = [0.0; N];
    for value in &mut all {
        *value = words.next()?.parse().ok()?;
        // A factor beyond these bounds would make every value 0 or ∞.
        if !(1e-30..=1e30).contains(value) {
            return None;
        }
    }
    words.next().is_none().then_some(all)
}

fn resolution(line: &str) -> Option<Layout> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let &[first, first_count, second, second_count] = words.as_slice() else {
        return None;
    };
    // Fits an `i32`, as Radiance has it: products cannot overflow 64 bits.
    let count = |s: &str| s.parse::<i32>().ok().and_then(|n| usize::try_from(n).ok());
    let (a, b) = (count(first_count)?, count(second_count)?);
    let by_columns = first.ends_with('X');
    let (x, y, width, height) = if by_columns {
        (first, second, a, b)
    } else {
        (second, first, b, a)
    };
    let flip_x = match x {
        "+X" => false,
        "-X" => true,
        _ => return None,
    };
    let flip_y = match y {
        "-Y" => false,
        "+Y" => true,
        _ => return None,
    };
    Some(Layout {
        width,
        height,
        by_columns,
        flip_x,
        flip_y,
    })
}

/// m · 2^(e − 136) for each channel.
fn from_rgbe([r, g, b, e]: [u8; 4]) -> [f32; 3] {
    if e == 0 {
        return [0.0; 3];
    }
    let scale = power_of_two(i32::from(e) - 136);
    [r, g, b].map(|m| (f64::from(m) * scale) as f32)
}

/// The nearest RGBE of finite values ≥ 0, or the channel that is not.
fn to_rgbe(rgb: [f32; 3]) -> Result<[u8; 4], usize> {
    let mut largest = 0.0f32;
    for (channel, &value) in rgb.iter().enumerate() {
        if !value.is_finite() || value < 0.0 {
            return Err(channel);
        }
        largest = largest.max(value);
    }
    if largest == 0.0 {
        return Ok([0; 4]);
    }
    // largest = f · 2^exponent with f in [0.5, 1): the mantissa f · 256 is in [128, 256].
    let mut exponent = exponent(f64::from(largest));
    if f64::from(largest) * power_of_two(8 - exponent) >= 255.5 {
        exponent += 1;
    }
    // The largest exponent is 255, of values below 2^127: half of f32's range. Above, the largest code is the nearest. The
    // smallest is 1: darker values have fewer bits.
    let exponent = exponent.clamp(-127, 127);
    let scale = power_of_two(8 - exponent);
    let [r, g, b] = rgb.map(|v| (f64::from(v) * scale + 0.5).min(255.0) as u8);
    Ok([r, g, b, (exponent + 128) as u8])
}

/// 2^n, exact, for n in −1022..=1023.
fn power_of_two(n: i32) -> f64 {
    f64::from_bits(((n + 1023) as u64) << 52)
}

/// The n with x = f · 2^n, f in [0.5, 1), of a normal positive `x` (every positive `f32` is one as `f64`).
fn exponent(x: f64) -> i32 {
    ((x.to_bits() >> 52) & 0x7ff) as i32 - 1022
}

/// Rows that are made at a time.
const ROWS: usize = 64;

/// Writes a whole Radiance file with new run lengths (flat where a scan line's length rules them out). `fill` gets the first row
/// and room for some; `seen` gets each row as it is stored.
///
/// # Errors
/// What `fill` and `target` say, and [`ImageError::Parameter`] with the first pixel that RGBE cannot hold.
pub(crate) fn write_rows(
    file: &str,
    [width, height]: [usize; 2],
    target: &mut impl Write,
    fill: &mut Fill<'_>,
    seen: &mut dyn FnMut(usize, usize, &[f32]),
) -> Result<(), ImageError> {
    let io = |source| ImageError::Io {
        file: file.into(),
        action: "write it",
        source,
    };
    let header = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n");
    target.write_all(header.as_bytes()).map_err(io)?;
    let mut pixels = Vec::new();
    let mut line = Vec::with_capacity(width);
    let mut out = Vec::new();
    let mut stored = vec![0.0; width];
    for first in (0..height).step_by(ROWS) {
        pixels.resize(ROWS.min(height - first) * width, [0.0; 3]);
        fill(first, &mut pixels)?;
        for (y, row) in (first..).zip(pixels.chunks_exact(width)) {
            line.clear();
            for (x, &rgb) in row.iter().enumerate() {
                line.push(to_rgbe(rgb).map_err(|channel| {
                    ImageError::parameter(format!(
                        "{file}: Radiance HDR holds finite values from 0 up, but channel {} of pixel ({x}, {y}) is {}; write .exr",
                        ["R", "G", "B"][channel],
                        rgb[channel]
                    ))
                })?);
            }
            scanline::encode(&mut line, &mut out);
            target.write_all(&out).map_err(io)?;
            out.clear();
            for c in 0..3 {
                for (to, &from) in stored.iter_mut().zip(&line) {
                    *to = from_rgbe(from)[c];
                }
                seen(y, c, &stored);
            }
        }
    }
    Ok(())
}

/// A whole Radiance file in memory.
#[cfg(test)]
fn encode(image: &Image) -> Result<Vec<u8>, ImageError> {
    let mut out = Vec::new();
    write_rows(
        "test.hdr",
        [image.width, image.height],
        &mut out,
        &mut |first, rows| {
            let start = first * image.width;
            rows.copy_from_slice(&image.pixels[start..start + rows.len()]);
            Ok(())
        },
        &mut |_, _, _| {},
    )?;
    Ok(out)
}

#[cfg(test)]
mod tests;
