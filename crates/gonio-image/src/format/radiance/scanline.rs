//! One scan line of RGBE pixels: flat, old run lengths, new run lengths.

use super::bytes::Bytes;
use std::io::Read;

/// Lengths for which new run lengths are defined.
const NEW_LENGTHS: std::ops::RangeInclusive<usize> = 8..=32_767;
/// The longest run, and the longest stretch of literal bytes, in new run lengths.
const LONGEST_RUN: usize = 127;
const LONGEST_LITERAL: usize = 128;

/// Fills `line` from `bytes`, or says what was wrong.
pub(super) fn decode<R: Read>(bytes: &mut Bytes<R>, line: &mut [[u8; 4]]) -> Result<(), String> {
    let n = line.len();
    if NEW_LENGTHS.contains(&n)
        && let &[2, 2, high, low] = bytes.peek(4)
        && high < 128
    {
        let claimed = usize::from(high) << 8 | usize::from(low);
        if claimed != n {
            return Err(format!("a scan line of {claimed} pixels"));
        }
        bytes.take(4);
        return decode_new(bytes, line);
    }
    decode_old(bytes, line)
}

/// Each of the four components in turn: a count above 128 is a run of one byte, one up to 128 a stretch of bytes.
fn decode_new<R: Read>(bytes: &mut Bytes<R>, line: &mut [[u8; 4]]) -> Result<(), String> {
    let end = || "the end of the file".to_string();
    for component in 0..4 {
        let mut x = 0;
        while x < line.len() {
            let code = usize::from(bytes.take(1).ok_or_else(end)?[0]);
            let (count, run) = if code > 128 {
                (code - 128, true)
            } else {
                (code, false)
            };
            if count == 0 {
                return Err(format!("a run of no pixels at pixel {x}"));
            }
            let left = line.len() - x;
            if count > left {
                return Err(format!(
                    "{count} samples at pixel {x}, where {left} are left"
                ));
            }
            let values = bytes.take(if run { 1 } else { count }).ok_or_else(end)?;
            for (i, pixel) in line[x..x + count].iter_mut().enumerate() {
                pixel[component] = values[if run { 0 } else { i }];
            }
            x += count;
        }
    }
    Ok(())
}

/// Pixels one after the other; (1, 1, 1, n) repeats the pixel before it n times, and each following such pixel counts
/// 256 times as much.
fn decode_old<R: Read>(bytes: &mut Bytes<R>, line: &mut [[u8; 4]]) -> Result<(), String> {
    let mut x = 0;
    let mut shift = 0;
    while x < line.len() {
        let Some(&[r, g, b, e]) = bytes.take(4) else {
            return Err(format!("the end of the file at pixel {x}"));
        };
        let [1, 1, 1, count] = [r, g, b, e] else {
            line[x] = [r, g, b, e];
            x += 1;
            shift = 0;
            continue;
        };
        let left = line.len() - x;
        // Past 24 bits a run is longer than any scan line, except one of no pixels.
        let count = if shift > 24 && count > 0 {
            usize::MAX
        } else {
            usize::from(count).checked_shl(shift).unwrap_or(0)
        };
        if count > left {
            return Err(format!(
                "a run longer than the {left} pixels left at pixel {x}"
            ));
        }
        if x == 0 && count > 0 {
            return Err("a run before the first pixel".into());
        }
        if count > 0 {
            let before = line[x - 1];
            line[x..x + count].fill(before);
        }
        x += count;
        shift += 8;
    }
    Ok(())
}

/// Appends `line` to `out`; what must not stand in a flat line is replaced in `line`, too.
pub(super) fn encode(line: &mut [[u8; 4]], out: &mut Vec<u8>) {
    if !NEW_LENGTHS.contains(&line.len()) {
        for pixel in line.iter_mut() {
            *pixel = not_a_run(*pixel);
        }
        out.extend(line.iter().flatten());
        return;
    }
    let n = line.len() as u16;
    out.extend_from_slice(&[2, 2]);
    out.extend_from_slice(&n.to_be_bytes());
    let mut samples = Vec::with_capacity(line.len());
    for component in 0..4 {
        samples.clear();
        samples.extend(line.iter().map(|p| p[component]));
        encode_component(&samples, out);
    }
}

/// In a flat scan line the pixel (1, 1, 1, n) means a run. The largest mantissa of a pixel is at least 128 but at the smallest
/// exponent, so the only such pixel is (1, 1, 1, 1), the grey 2⁻¹³⁵: the darkest there is, written as black.
/// (2, 2, h, l) with h < 128 means new run lengths only where those are defined, and there a scan line is never flat.
fn not_a_run(pixel: [u8; 4]) -> [u8; 4] {
    if pixel[..3] == [1; 3] { [0; 4] } else { pixel }
}

fn encode_component(samples: &[u8], out: &mut Vec<u8>) {
    let run_at = |i: usize| {
        samples[i..]
            .iter()
            .take(LONGEST_RUN)
            .take_while(|&&s| s == samples[i])
            .count()
    };
    let mut i = 0;
    while i < samples.len() {
        let run = run_at(i);
        // Two equal bytes cost the same as literals and would break a stretch of them.
        if run > 2 {
            out.extend_from_slice(&[128 + run as u8, samples[i]]);
            i += run;
            continue;
        }
        let start = i;
        while i < samples.len() && i - start < LONGEST_LITERAL && run_at(i) <= 2 {
            i += 1;
        }
        out.push((i - start) as u8);
        out.extend_from_slice(&samples[start..i]);
    }
}
