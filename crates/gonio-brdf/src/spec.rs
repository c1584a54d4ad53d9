//! [`ModelSpec`], the description of a model in words, and how it is read and built.

use crate::measured::format::FORMATS;
use crate::{
    BrdfError, Declares, Kind, Model, ModelInfo, Number, ParameterInfo, Value, model, registry,
    shader_file,
};
use gonio_num::Real;
use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

/// A model by name with the values of some of its parameters; the others have their defaults.
///
/// Every name and value is known to be valid; what depends on several parameters is checked by [`ModelSpec::build`].
#[derive(Debug, Clone, PartialEq)]
pub struct ModelSpec {
    /// The model's name in the registry.
    pub name: String,
    /// The values given.
    pub values: BTreeMap<String, Value>,
}

impl ModelSpec {
    /// The model `name` (or an alias) with its defaults, or with the values of a [preset](crate::preset): `MODEL@NAME`. The path of a
    /// shader is the model `shader` of that file.
    ///
    /// # Errors
    /// [`BrdfError::UnknownModel`], [`BrdfError::UnknownPreset`].
    pub fn new(name: &str) -> Result<Self, BrdfError> {
        Self::new_in(name, Path::new(""))
    }

    fn new_in(name: &str, folder: &Path) -> Result<Self, BrdfError> {
        if let Some(file) = shader_file::path(name, folder) {
            return Ok(Self {
                name: model::shader::INFO.name.into(),
                values: [("file".into(), Value::Path(file))].into(),
            });
        }
        if let Some((model, preset)) = name.split_once('@') {
            return crate::preset::spec(model.trim(), preset.trim());
        }
        let (info, alias) = registry::resolve(name)?;
        let mut spec = Self {
            name: info.name.into(),
            values: BTreeMap::new(),
        };
        for (key, text) in alias.map_or(&[][..], |a| a.preset) {
            spec.set_text(key, text)?;
        }
        Ok(spec)
    }

    /// Reads `name`, `name:key=value,key=value`, `sum(spec, spec)`, `scaled(factor, spec)`, `mix(weight, spec, spec)` or
    /// `coat(key=value, spec)`.
    ///
    /// `name` may be followed by `@preset`, or be the path of a shader. A colour is `r/g/b` (linear), `#rrggbb` (sRGB-encoded) or one number for all components. In parentheses a piece that is only
    /// `key=value` belongs to the model before it, before the first model to the composite.
    ///
    /// # Errors
    /// What is wrong and where, with the nearest valid name.
    pub fn parse(text: &str) -> Result<Self, BrdfError> {
        Self::parse_in(text, Path::new(""))
    }

    /// As [`ModelSpec::parse`], with the paths of files relative to a folder.
    ///
    /// # Errors
    /// As [`ModelSpec::parse`].
    pub fn parse_in(text: &str, folder: &Path) -> Result<Self, BrdfError> {
        let text = text.trim();
        let syntax = |column: usize, expected: &str| BrdfError::Syntax {
            text: text.into(),
            column,
            expected: expected.into(),
        };
        let end = text.find([':', '(']).unwrap_or(text.len());
        let name = text[..end].trim();
        if name.is_empty() {
            return Err(syntax(1, "a model's name"));
        }
        let mut whole = Self::new_in(name, folder)?;
        let spec = whole.named_mut(name)?;
        let rest = &text[end..];
        if let Some(inner) = rest.strip_prefix('(') {
            let Some(inner) = inner.strip_suffix(')') else {
                return Err(syntax(text.chars().count() + 1, "`)`"));
            };
            spec.parse_composite(inner, folder)?;
        } else if let Some(pairs) = rest.strip_prefix(':') {
            let mut named = Vec::new();
            for piece in split_top(pairs) {
                match split_pair(piece) {
                    Some(pair) => named.push(pair),
                    None => spec.set_positional(piece, text, folder)?,
                }
            }
            spec.set_pairs(named, folder)?;
        }
        Ok(whole)
    }

    /// The model that `text` describes, or else the table of the measured file of that name.
    ///
    /// ```
    /// use gonio_brdf::ModelSpec;
    /// assert_eq!(ModelSpec::open("ggx:roughness=0.3")?.name, "torrance-sparrow");
    /// assert_eq!(ModelSpec::open("gold-paint.binary")?.name, "table");
    /// # Ok::<(), gonio_brdf::BrdfError>(())
    /// ```
    ///
    /// # Errors
    /// As [`ModelSpec::parse`], where there is no file of that name and its extension is none of a measured file's. Whether the file can
    /// be read shows when the model is built.
    pub fn open(text: &str) -> Result<Self, BrdfError> {
        let path = Path::new(text);
        let extension = path.extension().and_then(|e| e.to_str());
        let is_measured = |e: &str| FORMATS.iter().any(|f| f.extension.eq_ignore_ascii_case(e));
        match Self::parse(text) {
            // A name that no model has.
            Err(BrdfError::UnknownModel { .. } | BrdfError::UnknownPreset { .. })
                if path.exists() || extension.is_some_and(is_measured) =>
            {
                Self::from_pairs("table", [("file", text)])
            }
            described => described,
        }
    }

    /// The part that is of the model called `model` (or having it as an alias), the description itself or one of those that it is
    /// made of. A [preset](crate::preset) may stand for a sum, in which the model that was named is a part.
    pub fn part(&self, model: &str) -> Option<&Self> {
        let name = registry::find(model).ok()?.name;
        if self.name == name {
            return Some(self);
        }
        let mut parts = self.values.values().filter_map(|value| match value {
            Value::Models(models) => Some(models.iter()),
            _ => None,
        });
        parts.find_map(|mut models| models.find_map(|m| m.part(name)))
    }

    /// As [`ModelSpec::part`], for what was made by [`ModelSpec::new`] with this name.
    fn named_mut(&mut self, name: &str) -> Result<&mut Self, BrdfError> {
        let model = name.split('@').next().unwrap_or(name).trim();
        let name = match self.name == model::shader::INFO.name {
            true => model::shader::INFO.name,
            false => registry::find(model)?.name,
        };
        Ok(self
            .part_mut(name)
            .expect("invariant: what a name stands for has a part of its model"))
    }

    fn part_mut(&mut self, name: &str) -> Option<&mut Self> {
        if self.name == name {
            return Some(self);
        }
        self.values.values_mut().find_map(|value| match value {
            Value::Models(models) => models.iter_mut().find_map(|m| m.part_mut(name)),
            _ => None,
        })
    }

    /// The model `name` with parameters given as text.
    ///
    /// # Errors
    /// As [`ModelSpec::parse`].
    pub fn from_pairs<'a>(
        name: &str,
        pairs: impl IntoIterator<Item = (&'a str, &'a str)>,
    ) -> Result<Self, BrdfError> {
        let mut whole = Self::new(name)?;
        whole.named_mut(name)?.set_pairs(pairs, Path::new(""))?;
        Ok(whole)
    }

    /// Sets parameters from text, first those that every description of the model may have: a file says which others there are.
    fn set_pairs<'a>(
        &mut self,
        pairs: impl IntoIterator<Item = (&'a str, &'a str)>,
        folder: &Path,
    ) -> Result<(), BrdfError> {
        let info = self.info()?;
        let known = |key: &str| info.parameters.iter().any(|p| p.name == key);
        let (first, rest): (Vec<_>, Vec<_>) =
            pairs.into_iter().partition(|(key, _)| known(key.trim()));
        for (key, value) in first.into_iter().chain(rest) {
            self.set_text_in(key, value, folder)?;
        }
        Ok(())
    }

    /// The parameters that it may have: those of its model, and those that its file declares.
    ///
    /// # Errors
    /// If the file can't be read, or as [`ModelSpec::info`].
    pub fn parameters(&self) -> Result<Vec<&'static ParameterInfo>, BrdfError> {
        let info = self.info()?;
        let mut all: Vec<_> = info.parameters.iter().collect();
        if info.name == model::shader::INFO.name
            && let Some(loaded) = shader_file::load(self)?
        {
            all.extend(loaded.parameters);
        }
        Ok(all)
    }

    /// Several models, separated by commas.
    pub(crate) fn parse_list(text: &str, folder: &Path) -> Result<Vec<Self>, BrdfError> {
        let mut groups: Vec<String> = Vec::new();
        for piece in split_top(text) {
            match groups.last_mut() {
                // `key=value` without a model's name goes on with the model before it.
                Some(last) if split_pair(piece).is_some_and(|(key, _)| !key.contains(':')) => {
                    last.push_str(if last.contains(':') { "," } else { ":" });
                    last.push_str(piece);
                }
                _ => groups.push(piece.into()),
            }
        }
        groups.iter().map(|g| Self::parse_in(g, folder)).collect()
    }

    /// Sets a parameter.
    ///
    /// # Errors
    /// If there is no such parameter, or the value is of the wrong kind or out of range (NaN always is).
    pub fn set(&mut self, key: &str, value: Value) -> Result<(), BrdfError> {
        let value = self.parameter(key)?.check(&self.name, value)?;
        self.values.insert(key.into(), value);
        Ok(())
    }

    /// Sets a parameter from text.
    ///
    /// # Errors
    /// As [`ModelSpec::set`], and if the text cannot be read.
    pub fn set_text(&mut self, key: &str, text: &str) -> Result<(), BrdfError> {
        self.set_text_in(key, text, Path::new(""))
    }

    /// As [`ModelSpec::set_text`], with the paths of files relative to a folder.
    ///
    /// # Errors
    /// As [`ModelSpec::set_text`].
    pub fn set_text_in(&mut self, key: &str, text: &str, folder: &Path) -> Result<(), BrdfError> {
        let key = key.trim();
        let value = self.parameter(key)?.parse(&self.name, text, folder)?;
        self.values.insert(key.into(), value);
        Ok(())
    }

    /// The registry's entry of this model.
    ///
    /// # Errors
    /// If `name` was changed to one that does not exist.
    pub fn info(&self) -> Result<&'static ModelInfo, BrdfError> {
        registry::find(&self.name)
    }

    /// The properties that the model declares to have with these values.
    ///
    /// # Errors
    /// As [`ModelSpec::info`].
    pub fn declares(&self) -> Result<Declares, BrdfError> {
        Ok((self.info()?.declares)(self))
    }

    /// The model, ready to evaluate with numbers of type `R` and `N` colour components.
    ///
    /// # Errors
    /// If parameters contradict each other, a file cannot be read, or a coloured (not grey) value is asked for with
    /// N ≠ 3.
    pub fn build<R: Number, const N: usize>(&self) -> Result<Model<R, N>, BrdfError> {
        Model::from_spec(self)
    }

    /// Whether it, or a model in it, is read from a file.
    pub fn reads_files(&self) -> bool {
        self.values.values().any(|value| match value {
            Value::Path(_) => true,
            Value::Models(models) => models.iter().any(Self::reads_files),
            _ => false,
        })
    }

    fn parse_composite(&mut self, inner: &str, folder: &Path) -> Result<(), BrdfError> {
        let info = self.info()?;
        let Some(key) = info
            .parameters
            .iter()
            .find(|p| matches!(p.kind, Kind::Models))
        else {
            return Err(BrdfError::Unsupported {
                what: format!(
                    "`{}` takes no other models: write {}:key=value,…",
                    self.name, self.name
                ),
            });
        };
        // `key=value` before the first model belongs to the composite itself.
        let mut rest = inner;
        for piece in split_top(inner) {
            let Some((name, value)) = split_pair(piece).filter(|(name, _)| !name.contains(':'))
            else {
                break;
            };
            self.set_text_in(name, value, folder)?;
            let end = piece.as_ptr() as usize - inner.as_ptr() as usize + piece.len();
            rest = inner[end..]
                .trim_start()
                .trim_start_matches(',')
                .trim_start();
        }
        let positional = info.positional.filter(|p| !self.values.contains_key(*p));
        if let Some(positional) = positional {
            let first = split_top(rest).first().copied().unwrap_or_default();
            self.set_text_in(positional, first, folder)?;
            let end = first.as_ptr() as usize - rest.as_ptr() as usize + first.len();
            rest = rest[end..].trim_start().trim_start_matches(',');
        }
        self.set_text_in(key.name, rest, folder)
    }

    fn set_positional(&mut self, piece: &str, text: &str, folder: &Path) -> Result<(), BrdfError> {
        match self.info()?.positional {
            Some(key) if !piece.is_empty() && !self.values.contains_key(key) => {
                self.set_text_in(key, piece, folder)
            }
            _ => {
                let at = piece.as_ptr() as usize - text.as_ptr() as usize;
                Err(BrdfError::Syntax {
                    text: text.into(),
                    column: text[..at].chars().count() + 1,
                    expected: "key=value".into(),
                })
            }
        }
    }

    fn parameter(&self, key: &str) -> Result<&'static ParameterInfo, BrdfError> {
        let info = self.info()?;
        if let Some(found) = info.parameters.iter().find(|p| p.name == key) {
            return Ok(found);
        }
        let all = self.parameters()?;
        let found = all.iter().copied().find(|p| p.name == key);
        found.ok_or_else(|| BrdfError::UnknownParameter {
            model: self.name.clone(),
            name: key.into(),
            suggestion: registry::suggest(key, all.iter().map(|p| p.name)),
        })
    }

    /// Fails if there is no parameter of this name.
    pub(crate) fn parameter_exists(&self, key: &str) -> Result<(), BrdfError> {
        self.parameter(key).map(|_| ())
    }

    /// The value of a parameter, given or default.
    pub fn value(&self, key: &str) -> Option<Value> {
        self.values
            .get(key)
            .cloned()
            .or_else(|| self.parameter(key).ok()?.default_value())
    }

    /// A number that is given or has a default.
    pub(crate) fn number(&self, key: &str) -> Option<f64> {
        match self.value(key) {
            Some(Value::Number(x)) => Some(x),
            _ => None,
        }
    }

    /// As [`ModelSpec::number`], of a parameter that declares a default.
    pub(crate) fn real<R: Real>(&self, key: &str) -> R {
        R::lit(
            self.number(key)
                .expect("invariant: this parameter declares a default"),
        )
    }

    /// A word that is given or has a default; empty otherwise.
    pub(crate) fn word(&self, key: &str) -> String {
        match self.value(key) {
            Some(Value::Choice(s)) => s,
            _ => String::new(),
        }
    }

    /// Linear RGB of a parameter that is given or has a default.
    pub(crate) fn rgb(&self, key: &str) -> Option<[f64; 3]> {
        match self.value(key) {
            Some(Value::Colour(c)) => Some(c),
            _ => None,
        }
    }

    /// The largest component of a colour that is given or has a default.
    pub(crate) fn largest(&self, key: &str) -> f64 {
        self.largest_sum(&[(key, 1.0)])
    }

    /// The largest component of a weighted sum of colours.
    pub(crate) fn largest_sum(&self, terms: &[(&str, f64)]) -> f64 {
        let mut sum = [0.0; 3];
        for (key, weight) in terms {
            let rgb = self.rgb(key).unwrap_or_default();
            for (s, x) in sum.iter_mut().zip(rgb) {
                *s += weight * x;
            }
        }
        sum.into_iter().fold(0.0, f64::max)
    }

    /// As [`ModelSpec::rgb`], in `N` components, of a parameter that declares a default.
    pub(crate) fn colour<R: Real, const N: usize>(&self, key: &str) -> Result<[R; N], BrdfError> {
        let rgb = self
            .rgb(key)
            .expect("invariant: this parameter declares a default");
        self.components(key, rgb)
    }

    /// Linear RGB as `N` components: as they are for N = 3, grey for any other N.
    pub(crate) fn components<R: Real, const N: usize>(
        &self,
        key: &str,
        rgb: [f64; 3],
    ) -> Result<[R; N], BrdfError> {
        if N != 3 && (rgb[0] != rgb[1] || rgb[1] != rgb[2]) {
            return Err(BrdfError::Unsupported {
                what: format!(
                    "parameter `{key}` of `{}` is an RGB colour, and {N} components were asked for: \
                     only a grey value can be used there",
                    self.name
                ),
            });
        }
        let mut out = [R::zero(); N];
        for (k, x) in out.iter_mut().enumerate() {
            *x = R::lit(rgb[k.min(2)]);
        }
        Ok(out)
    }

    /// The models that a sum or product is made of.
    pub(crate) fn models(&self, key: &str) -> &[ModelSpec] {
        match self.values.get(key) {
            Some(Value::Models(models)) => models,
            _ => &[],
        }
    }

    /// An error about the value of one parameter.
    pub(crate) fn wrong(&self, key: &str, expected: &str) -> BrdfError {
        let found = self
            .value(key)
            .map_or_else(|| "missing".into(), |v| format!("`{v}`"));
        BrdfError::Parameter {
            model: self.name.clone(),
            parameter: key.into(),
            found,
            expected: expected.into(),
        }
    }
}

impl fmt::Display for ModelSpec {
    /// As [`ModelSpec::parse`] reads it.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name)?;
        if self.values.values().any(|v| matches!(v, Value::Models(_))) {
            let positional = registry::find(&self.name).ok().and_then(|i| i.positional);
            let mut open = "(";
            for (key, value) in &self.values {
                if positional != Some(key) && !matches!(value, Value::Models(_)) {
                    write!(f, "{open}{key}={value}")?;
                    open = ", ";
                }
            }
            if let Some(value) = positional.and_then(|p| self.value(p)) {
                write!(f, "{open}{value}")?;
                open = ", ";
            }
            for value in self.values.values() {
                if matches!(value, Value::Models(_)) {
                    write!(f, "{open}{value}")?;
                }
            }
            return f.write_str(")");
        }
        for (k, (key, value)) in self.values.iter().enumerate() {
            write!(f, "{}{key}={value}", if k == 0 { ":" } else { "," })?;
        }
        Ok(())
    }
}

/// The pieces between commas that are in no parentheses, trimmed; none for blank text.
fn split_top(text: &str) -> Vec<&str> {
    let mut pieces = Vec::new();
    let (mut depth, mut start) = (0usize, 0usize);
    for (at, c) in text.char_indices() {
        match c {
            '(' => depth += 1,
            ')' => depth = depth.saturating_sub(1),
            ',' if depth == 0 => {
                pieces.push(text[start..at].trim());
                start = at + 1;
            }
            _ => {}
        }
    }
    if !text.trim().is_empty() {
        pieces.push(text[start..].trim());
    }
    pieces
}

/// `key=value` split at its first `=` before any parenthesis.
fn split_pair(piece: &str) -> Option<(&str, &str)> {
    let end = piece.find('(').unwrap_or(piece.len());
    let at = piece[..end].find('=')?;
    Some((piece[..at].trim(), piece[at + 1..].trim()))
}
