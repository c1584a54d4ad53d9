//! The parameters of `disney`, by Disney's names.

use crate::ParameterInfo;
use crate::part::slopes::{ROTATION_DEG, ROUGHNESS};

const fn unit(name: &'static str, default: f64, meaning: &'static str) -> ParameterInfo {
    ParameterInfo::number(name, "", (0.0, 1.0), Some(default), meaning)
}

/// What the registry lists.
pub(super) const PARAMETERS: &[ParameterInfo] = &[
    ParameterInfo::colour(
        "base_color",
        (0.0, 1.0),
        Some([0.8; 3]),
        "colour of the diffuse part, F0 of the metal; its root tints what is transmitted",
    ),
    unit("metallic", 0.0, "0 dielectric, 1 metal"),
    ROUGHNESS,
    unit(
        "anisotropic",
        0.0,
        "alpha_x = roughness²/a, alpha_y = roughness²·a with a = √(1 − 0.9 anisotropic)",
    ),
    ROTATION_DEG,
    unit(
        "specular",
        0.5,
        "F0 of the dielectric over 0.08: 0.5 is an index of 1.5",
    ),
    ParameterInfo::number(
        "ior",
        "",
        (1.0, 4.0),
        None,
        "index of refraction instead of specular; version=2015",
    ),
    unit(
        "specular_tint",
        0.0,
        "how much the hue of base_color tints F0 of the dielectric",
    ),
    unit("sheen", 0.0, "strength of the grazing lobe of cloth"),
    unit(
        "sheen_tint",
        0.5,
        "how much the hue of base_color tints the sheen",
    ),
    unit("clearcoat", 0.0, "strength of the second specular lobe"),
    unit(
        "clearcoat_gloss",
        1.0,
        "0 satin to 1 gloss: alpha from 0.1 to 0.001",
    ),
    ParameterInfo::number(
        "subsurface",
        "",
        (0.0, 1.0),
        None,
        "blends the diffuse part to a flatter one after Hanrahan & Krueger; version=2012",
    ),
    ParameterInfo::number("flatness", "", (0.0, 1.0), None, "the same in version=2015"),
    ParameterInfo::number(
        "spec_trans",
        "",
        (0.0, 1.0),
        None,
        "share of the dielectric that is glass instead of diffuse; version=2015",
    ),
    ParameterInfo::choice(
        "version",
        &["2012", "2015"],
        Some("2015"),
        "2012: Schlick's reflectance, opaque; 2015: a dielectric's reflectance, may transmit",
    ),
];
