//! [`Metadata`], where a measurement comes from, and [`Found`], what was seen when it was loaded.

/// What is known of a measurement's origin. Empty where the file says nothing.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Metadata {
    /// The material.
    pub name: String,
    /// What was measured and how.
    pub description: String,
    /// Who measured it.
    pub author: String,
    /// The instrument.
    pub instrument: String,
    /// When, as the file writes it.
    pub date: String,
    /// Under which licence it may be used.
    pub licence: String,
    /// What the numbers are: `BRDF` unless the file says otherwise.
    pub quantity: String,
    /// Their unit: `sr^-1`.
    pub unit: String,
    /// The format's name, the file, and what was done to it since.
    pub provenance: Vec<String>,
}

impl Metadata {
    /// Of a reflection function in sr⁻¹, read as `format`.
    pub(crate) fn of_format(format: &str) -> Self {
        Self {
            quantity: "BRDF".into(),
            unit: "sr^-1".into(),
            provenance: vec![format!("read as {format}")],
            ..Self::default()
        }
    }

    /// The entries that aren't empty, by name.
    pub fn entries(&self) -> Vec<(&'static str, String)> {
        [
            ("name", self.name.clone()),
            ("description", self.description.clone()),
            ("author", self.author.clone()),
            ("instrument", self.instrument.clone()),
            ("date", self.date.clone()),
            ("licence", self.licence.clone()),
            ("quantity", self.quantity.clone()),
            ("unit", self.unit.clone()),
            ("provenance", self.provenance.join("; ")),
        ]
        .into_iter()
        .filter(|(_, text)| !text.is_empty())
        .collect()
    }
}

/// What is done with a value that is negative or missing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Repair {
    /// It counts as 0.
    #[default]
    Zero,
    /// It is filled from the cells around it that have a value.
    Fill,
    /// The measurement is refused.
    Refuse,
}

impl Repair {
    /// By the word of the model's parameter.
    pub fn from_word(word: &str) -> Option<Self> {
        match word {
            "zero" => Some(Self::Zero),
            "fill" => Some(Self::Fill),
            "refuse" => Some(Self::Refuse),
            _ => None,
        }
    }
}

/// What was seen and done when a measurement was made ready to evaluate.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Found {
    /// Numbers in all.
    pub values: u64,
    /// Numbers below 0.
    pub negative: u64,
    /// The first cell with a number below 0.
    pub first_negative: Option<String>,
    /// Numbers that the file says to be missing, by NaN.
    pub missing: u64,
    /// Numbers of cells that lie below the horizon, where nothing can be measured; they are filled from above it.
    pub unreachable: u64,
    /// Cells whose colour has a component below 0 in linear Rec.709, which counts as 0: too saturated for it.
    pub out_of_gamut: u64,
    /// What the file holds and is not evaluated.
    pub unused: Vec<String>,
    /// What was done to the numbers on reading.
    pub notes: Vec<String>,
}

/// Colours brought into the gamut, counted.
#[derive(Debug, Default)]
pub(super) struct Gamut {
    /// Cells with a component below 0.
    pub clipped: u64,
}

impl Gamut {
    /// Components below 0 as 0.
    pub fn clip(&mut self, rgb: [f64; 3]) -> [f64; 3] {
        // A rounding error is not a colour.
        let largest = rgb[0].max(rgb[1]).max(rgb[2]);
        if rgb.iter().any(|c| *c < -1e-6 * largest.abs()) {
            self.clipped += 1;
        }
        rgb.map(|c| c.max(0.0))
    }
}

impl Found {
    /// Lines for a user who would want to know: negative and missing values, and what was done with them.
    pub fn warnings(&self, negative: Repair, missing: Repair) -> Vec<String> {
        let done = |repair| match repair {
            Repair::Fill => "filled from the cells around",
            _ => "taken as 0",
        };
        let mut lines = Vec::new();
        for (count, what, repair) in [
            (self.negative, "negative", negative),
            (self.missing, "missing", missing),
        ] {
            if count > 0 {
                let plural = if count == 1 { "is" } else { "are" };
                lines.push(format!(
                    "{count} of {} values {plural} {what} and {}",
                    self.values,
                    done(repair)
                ));
            }
        }
        lines
    }
}
