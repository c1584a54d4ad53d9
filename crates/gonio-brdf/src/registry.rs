//! The registry: every model's name, paper, parameters and declared properties.

use crate::{BrdfError, ModelSpec, ParameterInfo, model};

/// What a model states about itself.
#[derive(Debug, Clone, Copy)]
pub struct ModelInfo {
    /// Name, as written in a description and as its file is called (with `_` for `-`).
    pub name: &'static str,
    /// One line on what it is.
    pub summary: &'static str,
    /// Where it was published.
    pub paper: &'static str,
    /// Its parameters.
    pub parameters: &'static [ParameterInfo],
    /// The parameter that a value without a name sets, as in `lambertian:0.5`.
    pub positional: Option<&'static str>,
    /// Other names, each with parameters that it sets.
    pub aliases: &'static [Alias],
    /// Whether its formula can be printed as shader code.
    pub recordable: bool,
    /// The properties that hold for given parameters.
    pub declares: fn(&ModelSpec) -> Declares,
}

/// Another name of a model.
#[derive(Debug, Clone, Copy)]
pub struct Alias {
    /// The name.
    pub name: &'static str,
    /// Parameters that it sets, which the description may overrule.
    pub preset: &'static [(&'static str, &'static str)],
}

/// The properties that a model declares to have; checks hold it to them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Declares {
    /// f(ωi→ωr) = f(ωr→ωi).
    pub reciprocal: bool,
    /// Radiant exitance ≤ irradiance for every incident field: `albedo_bound` ≤ 1.
    pub energy_conserving: bool,
    /// f depends on φi − φr only.
    pub isotropic: bool,
    /// No directional albedo is larger than this; infinite if no bound is known.
    pub albedo_bound: f64,
    /// `None`: it only reflects. Otherwise light may pass to the other side, whose index of refraction over the outer one this
    /// is, as [`crate::Brdf::relative_ior`] gives it.
    pub relative_ior: Option<[f64; 3]>,
}

impl Declares {
    /// Reciprocal, isotropic, and reflecting at most `albedo_bound` of what arrives.
    pub fn physical(albedo_bound: f64) -> Self {
        Self {
            reciprocal: true,
            energy_conserving: albedo_bound <= 1.0,
            isotropic: true,
            albedo_bound,
            relative_ior: None,
        }
    }
}

/// Every model.
pub fn models() -> &'static [ModelInfo] {
    model::INFOS
}

/// The names of every model.
pub fn names() -> Vec<&'static str> {
    models().iter().map(|m| m.name).collect()
}

/// The model called `name`, or having it as an alias.
///
/// # Errors
/// [`BrdfError::UnknownModel`], with the nearest name.
pub fn find(name: &str) -> Result<&'static ModelInfo, BrdfError> {
    resolve(name).map(|(info, _)| info)
}

/// The model called `name`, and the alias if it is one.
pub(crate) fn resolve(
    name: &str,
) -> Result<(&'static ModelInfo, Option<&'static Alias>), BrdfError> {
    for info in models() {
        if info.name == name {
            return Ok((info, None));
        }
        if let Some(alias) = info.aliases.iter().find(|a| a.name == name) {
            return Ok((info, Some(alias)));
        }
    }
    let known = models()
        .iter()
        .flat_map(|m| std::iter::once(m.name).chain(m.aliases.iter().map(|a| a.name)));
    Err(BrdfError::UnknownModel {
        name: name.into(),
        suggestion: suggest(name, known),
    })
}

/// The candidate most like `word` (Jaro–Winkler similarity, at least 0.75), for "did you mean".
pub fn suggest<'a>(word: &str, candidates: impl Iterator<Item = &'a str>) -> Option<String> {
    let word = word.to_lowercase();
    let mut best: Option<(f64, &str)> = None;
    for candidate in candidates {
        let likeness = strsim::jaro_winkler(&word, candidate);
        if likeness >= 0.75 && best.is_none_or(|(b, _)| likeness > b) {
            best = Some((likeness, candidate));
        }
    }
    best.map(|(_, c)| c.to_owned())
}
