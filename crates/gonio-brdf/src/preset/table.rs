//! A table of presets: a form, its columns, and a row for each name.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::sync::OnceLock;

/// The fits of one publication for one model, read when first asked for.
///
/// The text: lines that start with `#` are comments; `form` is followed by a description with `{column}` where a row's values go,
/// `columns` by the columns, `NAME`, `NAME:3` (a colour) or either with `*FACTOR` (times that; for a colour, `*R/G/B` by channel). Every
/// other line is a name and its numbers.
#[derive(Debug)]
pub(super) struct Table {
    pub(super) model: &'static str,
    pub(super) set: &'static str,
    pub(super) summary: &'static str,
    text: &'static str,
    read: OnceLock<Content>,
}

#[derive(Debug)]
struct Content {
    form: &'static str,
    columns: Vec<Column>,
    rows: BTreeMap<&'static str, Vec<f64>>,
}

#[derive(Debug)]
struct Column {
    name: &'static str,
    /// One for each number of the column.
    factors: Vec<f64>,
}

impl Table {
    pub(super) const fn new(
        model: &'static str,
        set: &'static str,
        summary: &'static str,
        text: &'static str,
    ) -> Self {
        Self {
            model,
            set,
            summary,
            text,
            read: OnceLock::new(),
        }
    }

    fn content(&self) -> &Content {
        self.read
            .get_or_init(|| read(self.text).expect("invariant: a test reads the embedded tables"))
    }

    /// The names, sorted.
    pub(super) fn names(&self) -> Vec<&'static str> {
        self.content().rows.keys().copied().collect()
    }

    /// The form filled in with the row of `name`.
    ///
    /// Products with a factor are rounded to six digits: the published numbers have fewer.
    pub(super) fn description(&self, name: &str) -> Option<String> {
        let content = self.content();
        let mut numbers = content.rows.get(name)?.iter();
        let mut text = content.form.to_owned();
        for column in &content.columns {
            let mut value = String::new();
            for (k, factor) in column.factors.iter().enumerate() {
                let slash = if k == 0 { "" } else { "/" };
                let x = numbers.next().copied().unwrap_or_default();
                let x = if *factor == 1.0 {
                    x
                } else {
                    format!("{:.5e}", x * factor).parse().unwrap_or(x)
                };
                // Writing to a string doesn't fail.
                let _ = write!(value, "{slash}{x}");
            }
            text = text.replace(&format!("{{{}}}", column.name), &value);
        }
        Some(text)
    }
}

/// The table, or the line that is not as it should be.
fn read(text: &'static str) -> Result<Content, &'static str> {
    let mut content = Content {
        form: "",
        columns: Vec::new(),
        rows: BTreeMap::new(),
    };
    for line in text.lines().filter(|l| !l.starts_with('#')) {
        let mut words = line.split_whitespace();
        match words.next() {
            None => {}
            Some("form") => content.form = line.trim_start_matches("form").trim(),
            Some("columns") => {
                for word in words {
                    content.columns.push(column(word).ok_or(line)?);
                }
            }
            Some(name) => {
                let numbers: Result<Vec<f64>, _> = words.map(str::parse).collect();
                let numbers = numbers.map_err(|_| line)?;
                let expected: usize = content.columns.iter().map(|c| c.factors.len()).sum();
                let new = content.rows.insert(name, numbers.clone()).is_none();
                if numbers.len() != expected || !new {
                    return Err(line);
                }
            }
        }
    }
    Ok(content)
}

/// `NAME[:3][*FACTOR[/FACTOR/FACTOR]]`.
fn column(word: &'static str) -> Option<Column> {
    let (head, factors) = word.split_once('*').unwrap_or((word, "1"));
    let (name, count) = match head.split_once(':') {
        Some((name, count)) => (name, count.parse().ok()?),
        None => (head, 1),
    };
    let factors: Vec<f64> = factors
        .split('/')
        .map(|f| f.parse().ok())
        .collect::<Option<_>>()?;
    let factors = match factors.as_slice() {
        [one] => vec![*one; count],
        each if each.len() == count => each.to_vec(),
        _ => return None,
    };
    Some(Column { name, factors })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_fills_in_the_form() {
        let table = Table::new(
            "m",
            "s",
            "",
            "# comment\nform m:a={a},b={b},c={c}\ncolumns a:3*1/2/10 b c:3*0.5\nx 1 2 0.3 0.25 1 1 1\n",
        );
        assert_eq!(table.names(), ["x"]);
        assert_eq!(
            table.description("x").unwrap(),
            "m:a=1/4/3,b=0.25,c=0.5/0.5/0.5"
        );
        assert_eq!(table.description("y"), None);
    }

    #[test]
    fn unsound_tables_are_told_by_their_line() {
        for (text, line) in [
            ("columns a:3*1/2\n", "columns a:3*1/2"),
            ("columns a:x\n", "columns a:x"),
            ("columns a\nx 1 2\n", "x 1 2"),
            ("columns a\nx one\n", "x one"),
            ("columns a\nx 1\nx 2\n", "x 2"),
        ] {
            assert_eq!(read(text).err(), Some(line));
        }
    }
}
