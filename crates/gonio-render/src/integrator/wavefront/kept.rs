//! [`Kept`], the points of a wave that stay when others are left out.

/// Some of many, in their order.
#[derive(Debug, Default)]
pub(super) struct Kept {
    /// Their numbers.
    pub indices: Vec<u32>,
    /// First and end of neighbours that are kept together; empty where there are too many of them.
    runs: Vec<[u32; 2]>,
}

/// As many neighbours at least make it worth to copy runs.
const RUN: usize = 16;

impl Kept {
    /// Those whose flag isn't 0.
    pub fn choose(&mut self, flags: &[u32]) {
        self.indices.resize(flags.len(), 0);
        let mut count = 0;
        for (i, &flag) in flags.iter().enumerate() {
            self.indices[count] = i as u32;
            count += usize::from(flag != 0);
        }
        self.indices.truncate(count);
        self.runs.clear();
        let mut start = 0;
        while start < count {
            if RUN * self.runs.len() > count {
                self.runs.clear();
                return;
            }
            let first = self.indices[start];
            // Where all numbers are neighbours, the last one tells at once.
            let whole = self.indices[count - 1] - first == (count - 1 - start) as u32;
            let rest = &self.indices[start..];
            let length = match whole {
                true => count - start,
                false => (first..).zip(rest).take_while(|(i, k)| i == *k).count(),
            };
            self.runs.push([first, first + length as u32]);
            start += length;
        }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.indices.len()
    }

    /// Copies theirs from one column to the front of another.
    pub fn copy(&self, from: &[f32], to: &mut [f32]) {
        if self.runs.is_empty() {
            for (to, &i) in to.iter_mut().zip(&self.indices) {
                *to = from[i as usize];
            }
            return;
        }
        let mut at = 0;
        for &[first, end] in &self.runs {
            let run = &from[first as usize..end as usize];
            to[at..at + run.len()].copy_from_slice(run);
            at += run.len();
        }
    }

    /// Moves theirs to the front of a column.
    pub fn move_to_front(&self, column: &mut [f32]) {
        if self.runs.is_empty() {
            for (to, &i) in self.indices.iter().enumerate() {
                column[to] = column[i as usize];
            }
            return;
        }
        let mut at = 0;
        for &[first, end] in &self.runs {
            let (first, end) = (first as usize, end as usize);
            if first > at {
                column.copy_within(first..end, at);
            }
            at += end - first;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Few long runs, many short ones, all, none.
    #[test]
    fn columns_keep_what_is_chosen() {
        let column: Vec<f32> = (0..1000).map(|i| i as f32).collect();
        let mut kept = Kept::default();
        for (keeps, by_runs) in [
            ((|_| true) as fn(usize) -> bool, true),
            (|i| i % 100 > 3, true),
            (|i| i > 990, true),
            (|i| i % 3 == 0, false),
            (|_| false, false),
        ] {
            let flags: Vec<u32> = (0..1000).map(|i| u32::from(keeps(i))).collect();
            kept.choose(&flags);
            assert_eq!(!kept.runs.is_empty(), by_runs);
            let expected: Vec<f32> = (0..1000).filter(|&i| keeps(i)).map(|i| i as f32).collect();
            assert_eq!(kept.len(), expected.len());
            let mut copied = vec![-1.0; 1000];
            kept.copy(&column, &mut copied);
            assert_eq!(copied[..kept.len()], expected);
            let mut moved = column.clone();
            kept.move_to_front(&mut moved);
            assert_eq!(moved[..kept.len()], expected);
        }
    }
}
