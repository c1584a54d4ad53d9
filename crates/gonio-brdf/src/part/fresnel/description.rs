//! Fresnel reflectance in descriptions: the parameters, and what they make together.

use super::{Fresnel, ThinFilm};
use crate::model::components;
use crate::part::metal;
use crate::{BrdfError, ModelSpec, ParameterInfo};
use gonio_num::Real;

impl<R: Real, const N: usize> Fresnel<R, N> {
    /// Sets one of the constants, if this kind of reflectance has it.
    pub(crate) fn set(&mut self, parameter: &str, value: [R; 3]) {
        match (self, parameter) {
            (Self::Schlick { f0 } | Self::F82Tint { f0, .. }, "f0") => *f0 = components(value),
            (Self::F82Tint { tint, .. }, "f82") => *tint = components(value),
            (Self::Dielectric { ior }, "ior") => *ior = value[0],
            (Self::Conductor { eta, .. }, "eta") => *eta = components(value),
            (Self::Conductor { k, .. }, "k") => *k = components(value),
            (Self::ThinFilm(film), _) => film.set(parameter, value),
            _ => {}
        }
    }

    /// From the parameters `fresnel`, `f0`, `f82`, `ior`, `eta`, `k`, `metal`, `film_thickness_nm` and `film_ior` of a description.
    ///
    /// A parameter that another kind of reflectance needs is an error, not ignored.
    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        let given = |key: &str| spec.values.contains_key(key);
        let mut kind = spec.word("fresnel");
        if !given("fresnel") {
            // What is given says which reflectance is meant.
            for (keys, word) in [
                (&["film_thickness_nm", "film_ior"][..], "thin-film"),
                (&["metal", "eta", "k"], "conductor"),
                (&["ior"], "dielectric"),
                (&["f82"], "f82-tint"),
                (&["f0"], "schlick"),
            ] {
                if keys.iter().any(|key| given(key)) {
                    kind = word.into();
                    break;
                }
            }
        }
        for (key, used_by) in [
            ("f0", &["schlick", "f82-tint"][..]),
            ("f82", &["f82-tint"]),
            ("ior", &["dielectric", "thin-film"]),
            ("eta", &["conductor", "thin-film"]),
            ("k", &["conductor", "thin-film"]),
            ("metal", &["conductor", "thin-film"]),
            ("film_thickness_nm", &["thin-film"]),
            ("film_ior", &["thin-film"]),
        ] {
            if given(key) && !used_by.contains(&kind.as_str()) {
                let users = used_by.join(" or ");
                return Err(spec.wrong(
                    key,
                    &format!("no value here: only fresnel={users} uses it, and fresnel is {kind}"),
                ));
            }
        }
        Ok(match kind.as_str() {
            "schlick" => Self::Schlick {
                f0: spec.colour("f0")?,
            },
            "f82-tint" => Self::F82Tint {
                f0: spec.colour("f0")?,
                tint: spec.colour("f82")?,
            },
            "dielectric" => Self::Dielectric {
                ior: spec.real("ior"),
            },
            "conductor" => {
                let (eta, k) = conductor(spec)?;
                Self::Conductor { eta, k }
            }
            "thin-film" => {
                if N != 3 {
                    return Err(BrdfError::Unsupported {
                        what: format!(
                            "a thin film's colour is known for RGB, and {N} components were asked for"
                        ),
                    });
                }
                let (eta, k) = if given("metal") || given("eta") || given("k") {
                    if given("ior") {
                        return Err(spec.wrong("ior", "either ior or a metal under the film"));
                    }
                    conductor(spec)?
                } else {
                    let ior: R = spec.real("ior");
                    ([ior; N], [R::zero(); N])
                };
                Self::ThinFilm(ThinFilm {
                    thickness_nm: spec.real("film_thickness_nm"),
                    ior: spec.real("film_ior"),
                    eta,
                    k,
                })
            }
            _ => Self::None,
        })
    }
}

/// η and k of a metal by name (gold when nothing is given), or as given.
fn conductor<R: Real, const N: usize>(spec: &ModelSpec) -> Result<([R; N], [R; N]), BrdfError> {
    let given = |key: &str| spec.values.contains_key(key);
    if given("metal") && (given("eta") || given("k")) {
        return Err(spec.wrong("metal", "either metal=NAME or eta and k, not both"));
    }
    if given("eta") || given("k") {
        for key in ["eta", "k"] {
            if !given(key) {
                return Err(spec.wrong(key, "both eta and k"));
            }
        }
        return Ok((spec.colour("eta")?, spec.colour("k")?));
    }
    let word = spec.word("metal");
    let name = if word.is_empty() { "gold" } else { &word };
    let metal =
        metal::find(name).ok_or_else(|| spec.wrong("metal", "the name of a measured metal"))?;
    Ok((
        spec.components("metal", metal.eta)?,
        spec.components("metal", metal.k)?,
    ))
}

/// `fresnel`: which reflectance.
pub(crate) const fn parameter(default: &'static str) -> ParameterInfo {
    ParameterInfo::choice(
        "fresnel",
        &[
            "schlick",
            "f82-tint",
            "dielectric",
            "conductor",
            "thin-film",
            "none",
        ],
        Some(default),
        "reflectance of the facets; when not given, the parameters below that are given decide",
    )
}
/// `f0`.
pub(crate) const F0: ParameterInfo = ParameterInfo::colour(
    "f0",
    (0.0, 1.0),
    Some([0.04; 3]),
    "reflectance at normal incidence (fresnel=schlick or f82-tint)",
);
/// `f82`.
pub(crate) const F82: ParameterInfo = ParameterInfo::colour(
    "f82",
    (0.0, 1.0),
    Some([1.0; 3]),
    "factor on Schlick's reflectance near 82° (fresnel=f82-tint)",
);
/// `ior`.
pub(crate) const IOR: ParameterInfo = ParameterInfo::number(
    "ior",
    "",
    (0.1, 10.0),
    Some(1.5),
    "relative index of refraction (fresnel=dielectric), or of what is under the film",
);
/// `eta`.
pub(crate) const ETA: ParameterInfo = ParameterInfo::colour(
    "eta",
    (0.001, 100.0),
    Some([1.5; 3]),
    "real part of the index of refraction, with k (fresnel=conductor or thin-film)",
);
/// `k`.
pub(crate) const K: ParameterInfo = ParameterInfo::colour(
    "k",
    (0.0, 100.0),
    Some([0.0; 3]),
    "imaginary part of the index of refraction, with eta (fresnel=conductor or thin-film)",
);
/// `metal`.
pub(crate) const METAL: ParameterInfo = ParameterInfo::choice(
    "metal",
    metal::NAMES,
    None,
    "a measured metal instead of eta and k (fresnel=conductor or thin-film); gold when neither is given",
);
/// `film_thickness_nm`.
pub(crate) const FILM_THICKNESS: ParameterInfo = ParameterInfo::number(
    "film_thickness_nm",
    "nm",
    (0.0, 5000.0),
    Some(500.0),
    "thickness of a film on the facets (fresnel=thin-film)",
);
/// `film_ior`.
pub(crate) const FILM_IOR: ParameterInfo = ParameterInfo::number(
    "film_ior",
    "",
    (1.0, 4.0),
    Some(1.33),
    "index of refraction of the film (fresnel=thin-film)",
);
