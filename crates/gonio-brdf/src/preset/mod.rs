//! Presets: published parameters of a model, by the name of a material.
//!
//! `MODEL@NAME` in a description stands for a set of parameters; `key=value` after it overrule them. There are two kinds:
//!
//! - **fits**: parameters that somebody fitted to a measured material, one table a publication and model (`data/`). A table's `form` is
//!   the description that its rows fill in, so that a row says exactly which formula was fitted: with the normalisation, the Fresnel
//!   reflectance and the diffuse part that the publication has. Where those are parts of a sum, further `key=value` are for the
//!   model that is named.
//! - **metals**: each word of a model's parameter `metal`.
//!
//! A name that several sets have means the first of them, in the order of the list below; `MODEL@SET/NAME` means one of them.

mod table;

use crate::{BrdfError, Kind, ModelInfo, ModelSpec, registry};
use table::Table;

/// The presets of one publication for one model, or its metals.
#[derive(Debug, Clone)]
pub struct PresetSet {
    /// The model's name, or its alias under which the presets are found.
    pub model: &'static str,
    /// The set's name.
    pub name: &'static str,
    /// One line on what was fitted, and where it was published.
    pub summary: &'static str,
    /// The names of its presets, sorted.
    pub presets: Vec<&'static str>,
}

macro_rules! tables {
    ($($model:literal, $set:literal, $file:literal, $summary:literal;)*) => {
        /// Every table of fits. A model's first set is the one that a bare name looks in first.
        static TABLES: [Table; [$($file),*].len()] = [$(
            Table::new($model, $set, $summary, include_str!(concat!("data/", $file))),
        )*];
    };
}

tables! {
    "blinn-phong", "ngan", "blinn_phong_ngan.txt",
        "MERL materials, fitted by Ngan, Durand & Matusik 2005";
    "lafortune", "ngan", "lafortune_ngan.txt",
        "MERL materials, fitted by Ngan, Durand & Matusik 2005";
    "ward", "ngan", "ward_ngan.txt",
        "MERL materials, fitted by Ngan, Durand & Matusik 2005";
    "ward-duer", "ngan", "ward_duer_ngan.txt",
        "MERL materials, fitted by Ngan, Durand & Matusik 2005";
    "ashikhmin-shirley", "ngan", "ashikhmin_shirley_ngan.txt",
        "MERL materials, fitted by Ngan, Durand & Matusik 2005";
    "ashikhmin-shirley", "low-e2", "ashikhmin_shirley_low_e2.txt",
        "MERL materials, fitted by Löw et al. 2012 (their error E2)";
    "ashikhmin-shirley", "low-e1", "ashikhmin_shirley_low_e1.txt",
        "MERL materials, fitted by Löw et al. 2012 (their error E1)";
    "cook-torrance", "ngan", "cook_torrance_ngan.txt",
        "MERL materials, fitted by Ngan, Durand & Matusik 2005";
    "cook-torrance", "low-e2", "cook_torrance_low_e2.txt",
        "MERL materials, fitted by Löw et al. 2012 (their error E2)";
    "cook-torrance", "low-e1", "cook_torrance_low_e1.txt",
        "MERL materials, fitted by Löw et al. 2012 (their error E1)";
    "bagher", "bagher", "bagher_bagher.txt",
        "MERL materials, fitted by Bagher et al. 2012, each colour by itself";
    "low-microfacet", "low-e2", "low_microfacet_low_e2.txt",
        "MERL materials, fitted by Löw et al. 2012 (their error E2)";
    "low-smooth", "low-e2", "low_smooth_low_e2.txt",
        "MERL materials, fitted by Löw et al. 2012 (their error E2)";
}

/// The name of the set of metals.
const METALS: &str = "metal";

/// The words of a model's parameter `metal`, if it has one.
fn metals(info: &ModelInfo) -> Option<&'static [&'static str]> {
    let metal = info.parameters.iter().find(|p| p.name == METALS)?;
    match metal.kind {
        Kind::Choice { options, .. } => Some(options),
        _ => None,
    }
}

/// Every set, model by model in the registry's order.
pub fn sets() -> Vec<PresetSet> {
    let names = registry::models().iter().flat_map(|info| {
        let aliases = info.aliases.iter().map(|a| a.name);
        std::iter::once(info.name).chain(aliases)
    });
    names.flat_map(sets_of).collect()
}

/// The sets of a model, or of an alias, in the order in which a bare name is looked for; none for what is in no registry.
pub fn sets_of(model: &str) -> Vec<PresetSet> {
    let Ok((info, alias)) = registry::resolve(model) else {
        return Vec::new();
    };
    let model = alias.map_or(info.name, |a| a.name);
    let fits = TABLES.iter().filter(|t| t.model == model);
    let mut sets: Vec<PresetSet> = fits
        .map(|t| PresetSet {
            model: t.model,
            name: t.set,
            summary: t.summary,
            presets: t.names(),
        })
        .collect();
    if let Some(names) = metals(info) {
        let mut presets = names.to_vec();
        presets.sort_unstable();
        sets.push(PresetSet {
            model,
            name: METALS,
            summary: "measured indices of refraction of metals",
            presets,
        });
    }
    sets
}

/// The description that `MODEL@NAME` stands for.
///
/// # Errors
/// [`BrdfError::UnknownModel`], [`BrdfError::UnknownPreset`].
pub(crate) fn spec(model: &str, preset: &str) -> Result<ModelSpec, BrdfError> {
    let (info, alias) = registry::resolve(model)?;
    let name = alias.map_or(info.name, |a| a.name);
    let (set, word) = match preset.split_once('/') {
        Some((set, word)) => (Some(set.trim()), word.trim()),
        None => (None, preset),
    };
    for table in &TABLES {
        if table.model == name
            && set.is_none_or(|s| s == table.set)
            && let Some(text) = table.description(word)
        {
            return ModelSpec::parse(&text);
        }
    }
    if set.is_none_or(|s| s == METALS) && metals(info).is_some_and(|names| names.contains(&word)) {
        let mut spec = ModelSpec::new(model)?;
        spec.set_text(METALS, word)?;
        return Ok(spec);
    }
    Err(unknown(name, preset))
}

fn unknown(model: &'static str, preset: &str) -> BrdfError {
    let own = sets_of(model);
    // What was meant is a name of this model, with its set if one was given.
    let known: Vec<String> = own
        .iter()
        .flat_map(|set| {
            let with_set = preset.contains('/');
            let full = move |name: &&str| match with_set {
                true => format!("{}/{name}", set.name),
                false => (*name).to_owned(),
            };
            set.presets.iter().map(full)
        })
        .collect();
    let word = preset.rsplit('/').next().unwrap_or(preset).trim();
    let mut elsewhere: Vec<&'static str> = Vec::new();
    for set in sets() {
        if set.presets.contains(&word) && !elsewhere.contains(&set.model) {
            elsewhere.push(set.model);
        }
    }
    BrdfError::UnknownPreset {
        model: model.into(),
        name: preset.into(),
        suggestion: registry::suggest(preset, known.iter().map(String::as_str)),
        elsewhere: elsewhere.into_iter().filter(|m| *m != model).collect(),
    }
}
