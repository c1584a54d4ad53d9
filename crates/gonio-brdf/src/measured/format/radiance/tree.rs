//! The text of a tensor tree: `{` branches or values `}`.

use super::super::super::input::Input;
use super::super::super::tree::{Child, DEEPEST, Growing, TensorTree};
use super::super::text::line_of;
use super::bands::Table;
use crate::BrdfError;
use roxmltree::Node;

struct Text<'a, 'b> {
    input: &'a Input<'b>,
    text: &'a str,
    at: usize,
    /// The line that the text begins on.
    first_line: usize,
}

/// Reads the tree of one band.
pub(super) fn parse(
    input: &Input<'_>,
    all: &str,
    node: Node<'_, '_>,
    rank: u32,
) -> Result<Table, BrdfError> {
    let mut text = Text {
        input,
        text: node.text().unwrap_or_default(),
        at: 0,
        first_line: line_of(all, node.range().start),
    };
    let mut growing = Growing::new(rank, 1);
    text.child(&mut growing, rank, 0)?;
    text.skip();
    if text.at < text.text.len() {
        return Err(text.error("the end of the tree"));
    }
    let tree: TensorTree = growing.done();
    Ok(Table::Tree(tree))
}

impl Text<'_, '_> {
    fn error(&self, expected: &str) -> BrdfError {
        let line = self.first_line + line_of(self.text, self.at) - 1;
        let rest: String = self.text[self.at..].chars().take(12).collect();
        let found = if rest.is_empty() {
            "the end of the data".into()
        } else {
            format!("`{rest}`")
        };
        self.input.error(format!("line {line}"), found, expected)
    }

    /// Passes white space and a comma.
    fn skip(&mut self) {
        let rest = &self.text[self.at..];
        let separator = |c: char| c.is_whitespace() || c == ',';
        self.at += rest.len() - rest.trim_start_matches(separator).len();
    }

    fn next_is(&mut self, c: char) -> bool {
        self.skip();
        self.text[self.at..].starts_with(c)
    }

    fn eat(&mut self, c: char, expected: &str) -> Result<(), BrdfError> {
        if !self.next_is(c) {
            return Err(self.error(expected));
        }
        self.at += c.len_utf8();
        Ok(())
    }

    /// One `{…}`, `level` below the root.
    fn child(&mut self, growing: &mut Growing, rank: u32, level: u32) -> Result<Child, BrdfError> {
        if level > DEEPEST {
            return Err(self.error(&format!("at most {DEEPEST} levels")));
        }
        self.eat('{', "`{`")?;
        let child = if self.next_is('{') {
            let branch = growing.branch();
            for place in 0..1usize << rank {
                let child = self.child(growing, rank, level + 1)?;
                growing.set(branch, place, child);
            }
            Child::Branch(branch)
        } else {
            let begin = self.at;
            let values = self.values()?;
            // 2^(rank·n) values are a grid of n levels.
            let levels = (values.len().max(1)).ilog2() / rank;
            if values.len() != 1usize << (rank * levels) || level + levels > DEEPEST {
                self.at = begin;
                let counts = format!(
                    "1, {}, {} … values in braces, not {}",
                    1 << rank,
                    1 << (2 * rank),
                    values.len()
                );
                return Err(self.error(&counts));
            }
            grid(growing, rank, levels, &values, 0, levels)
        };
        self.eat('}', "`}`")?;
        Ok(child)
    }

    fn values(&mut self) -> Result<Vec<f32>, BrdfError> {
        let mut values = Vec::new();
        loop {
            self.skip();
            let rest = &self.text[self.at..];
            let ends = |c: char| c.is_whitespace() || matches!(c, ',' | '{' | '}');
            let word = &rest[..rest.find(ends).unwrap_or(rest.len())];
            if word.is_empty() {
                return Ok(values);
            }
            match word.parse::<f32>() {
                Ok(x) if x.is_finite() => values.push(x),
                _ => return Err(self.error("a finite number")),
            }
            self.at += word.len();
        }
    }
}

/// The part of a grid of 2^`all` values along each side, the last coordinate fastest, that begins at `first` and has 2^`levels` along
/// each.
fn grid(
    growing: &mut Growing,
    rank: u32,
    levels: u32,
    values: &[f32],
    first: usize,
    all: u32,
) -> Child {
    if levels == 0 {
        return growing.leaf([values[first]]);
    }
    let branch = growing.branch();
    let half = 1usize << (levels - 1);
    for place in 0..1usize << rank {
        let mut at = first;
        for k in 0..rank {
            if place >> k & 1 == 1 {
                at += half << (all * (rank - 1 - k));
            }
        }
        let child = grid(growing, rank, levels - 1, values, at, all);
        growing.set(branch, place, child);
    }
    Child::Branch(branch)
}
