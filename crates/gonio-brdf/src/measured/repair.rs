//! Negative, missing and unreachable values.

use super::grid::Grid;
use super::measurement::{Data, Measurement};
use super::metadata::{Found, Repair};
use crate::BrdfError;
use std::path::Path;

/// Replaces what is not a value: counts it in `found`. A component with nothing to replace is left where it is. Negative numbers of an
/// adaptive table that count as 0 stay, as they are interpolated.
pub(super) fn repair(
    path: &Path,
    measurement: &mut Measurement,
    negative: Repair,
    missing: Repair,
    found: &mut Found,
) -> Result<(), BrdfError> {
    for component in &mut measurement.components {
        let values = component.data.values();
        found.values += values.len() as u64;
        let mut faults = 0;
        for (at, x) in values.iter().enumerate() {
            if *x >= 0.0 && x.is_finite() {
                continue;
            }
            faults += 1;
            if x.is_infinite() {
                return Err(refused(path, &component.data, at, "a finite number"));
            }
        }
        let mut state = if let Data::Grid(grid) = &component.data {
            below_the_horizon(grid)
        } else {
            Vec::new()
        };
        let unreachable = state.contains(&State::Empty);
        if faults == 0 && !unreachable {
            continue;
        }
        let stay = matches!(component.data, Data::Adaptive(_));
        let mut changed = unreachable;
        let mut new = values.to_vec();
        if state.is_empty() {
            state = vec![State::Full; new.len()];
        }
        for (at, x) in new.iter_mut().enumerate() {
            if state[at] == State::Empty {
                found.unreachable += 1;
                continue;
            }
            let (repair, expected) = if x.is_nan() {
                found.missing += 1;
                (missing, "a value: missing ones are refused")
            } else if *x < 0.0 {
                found.negative += 1;
                if found.first_negative.is_none() {
                    found.first_negative = Some(component.data.place(at));
                }
                (negative, "a value ≥ 0: negative ones are refused")
            } else {
                continue;
            };
            match repair {
                Repair::Refuse => return Err(refused(path, &component.data, at, expected)),
                Repair::Zero if *x < 0.0 && stay => {}
                Repair::Zero => {
                    *x = 0.0;
                    changed = true;
                }
                Repair::Fill => {
                    state[at] = State::Empty;
                    changed = true;
                }
            }
        }
        match &component.data {
            _ if !changed => continue,
            Data::Grid(grid) => fill_grid(grid, &mut new, &mut state),
            Data::Adaptive(all) => {
                let [width, height] = all.shape();
                let size = width * height;
                let functions = new.chunks_exact_mut(size);
                for (values, state) in functions.zip(state.chunks_exact_mut(size)) {
                    fill(&[height, width], &[false; 2], 1, values, state);
                }
            }
            Data::Klems(_) | Data::TensorTree(_) => {}
        }
        // Nothing lies around a patch or a leaf in a way that would tell its value, and a grid may have no value at all.
        for (x, state) in new.iter_mut().zip(&state) {
            if *state == State::Empty {
                *x = 0.0;
            }
        }
        component.data = component.data.with_values(new.into());
    }
    Ok(())
}

fn refused(path: &Path, data: &Data, at: usize, expected: &str) -> BrdfError {
    BrdfError::Format {
        path: path.into(),
        place: format!("{}, channel {}", data.place(at), data.channel(at)),
        found: data.values()[at].to_string(),
        expected: expected.into(),
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    /// Has a value.
    Full,
    /// Has none yet.
    Empty,
    /// Has none yet and is beside one that has.
    Edge,
}

/// Which numbers of a grid by half vectors stand for directions below the horizon and have no positive value; none for other grids.
fn below_the_horizon(grid: &Grid) -> Vec<State> {
    if !grid.parameterization().is_half() {
        return Vec::new();
    }
    let channels = grid.channels();
    let mut state = vec![State::Full; grid.values().len()];
    for (cell, values) in grid.values().chunks_exact(channels).enumerate() {
        if values.iter().any(|x| *x > 0.0) {
            continue;
        }
        let (wi, wo) = grid.directions(cell);
        if wi.z <= 0.0 || wo.z <= 0.0 {
            state[cell * channels..][..channels].fill(State::Empty);
        }
    }
    state
}

fn fill_grid(grid: &Grid, values: &mut [f32], state: &mut [State]) {
    let periodic: Vec<bool> = grid
        .axes()
        .iter()
        .map(|a| matches!(a.boundary(), super::grid::Boundary::Periodic(_)))
        .collect();
    fill(&grid.shape(), &periodic, grid.channels(), values, state);
}

/// Fills empty numbers with the mean of their neighbours along the axes, from the edge of what is full inwards.
fn fill(
    shape: &[usize],
    periodic: &[bool],
    channels: usize,
    values: &mut [f32],
    state: &mut [State],
) {
    let mut strides = vec![channels; shape.len()];
    for k in (0..shape.len().saturating_sub(1)).rev() {
        strides[k] = strides[k + 1] * shape[k + 1];
    }
    let neighbours = |at: usize, into: &mut Vec<usize>| {
        into.clear();
        for k in 0..shape.len() {
            let (n, stride) = (shape[k], strides[k]);
            let place = at / stride % n;
            if place + 1 < n {
                into.push(at + stride);
            } else if periodic[k] && n > 2 {
                into.push(at - place * stride);
            }
            if place > 0 {
                into.push(at - stride);
            } else if periodic[k] && n > 2 {
                into.push(at + (n - 1) * stride);
            }
        }
    };
    let mut around = Vec::new();
    let mut edge: Vec<usize> = Vec::new();
    for at in 0..values.len() {
        if state[at] == State::Empty {
            neighbours(at, &mut around);
            if around.iter().any(|n| state[*n] == State::Full) {
                edge.push(at);
            }
        }
    }
    while !edge.is_empty() {
        for at in &edge {
            state[*at] = State::Edge;
        }
        let mut next = Vec::new();
        let mut filled = Vec::with_capacity(edge.len());
        for at in &edge {
            neighbours(*at, &mut around);
            let (mut sum, mut count) = (0.0f64, 0u32);
            for n in &around {
                match state[*n] {
                    State::Full => {
                        sum += f64::from(values[*n]);
                        count += 1;
                    }
                    State::Empty => next.push(*n),
                    State::Edge => {}
                }
            }
            filled.push((sum / f64::from(count.max(1))) as f32);
        }
        for (at, x) in edge.iter().zip(filled) {
            values[*at] = x;
            state[*at] = State::Full;
        }
        next.sort_unstable();
        next.dedup();
        edge = next;
    }
}
