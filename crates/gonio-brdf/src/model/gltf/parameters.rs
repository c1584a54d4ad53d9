//! What the registry knows of the model: its parameters, and what it declares for them.

use crate::part::{dielectric, slopes};
use crate::{Declares, ModelInfo, ModelSpec, ParameterInfo};

/// The words of `body`.
const BODY: &[&str] = &["thin-walled", "solid"];

/// The sheen's albedo is below 1 in all directions from this roughness on.
const LEAST_SHEEN_ROUGHNESS: f64 = 0.3;

/// What the registry knows.
pub const INFO: ModelInfo = ModelInfo {
    name: "gltf",
    summary: "the material of glTF 2.0: metallic-roughness, with its extensions ior, specular, anisotropy, iridescence, transmission, \
              volume, sheen and clearcoat",
    paper: "Khronos glTF 2.0 specification, appendix B; KHR_materials_ior, _specular, _anisotropy, _iridescence, _transmission, _volume, \
            _sheen, _clearcoat; Estevez & Kulla 2017 for sheen; Belcour & Barla 2017 for iridescence; Walter et al. 2007 for refraction",
    parameters: &[
        ParameterInfo::colour(
            "base_color",
            (0.0, 1.0),
            Some([0.8; 3]),
            "diffuse colour of the dielectric and tint of what passes it, F0 of the metal",
        ),
        ParameterInfo::number(
            "metallic",
            "",
            (0.0, 1.0),
            Some(0.0),
            "0 dielectric, 1 metal",
        ),
        ParameterInfo::number(
            "roughness",
            "",
            (0.0, 1.0),
            Some(0.5),
            "perceptual roughness; alpha = roughness², not below 1e-4",
        ),
        ParameterInfo::number(
            "ior",
            "",
            (1.0, 10.0),
            Some(1.5),
            "index of refraction of the dielectric",
        ),
        ParameterInfo::number(
            "specular",
            "",
            (0.0, 1.0),
            Some(1.0),
            "strength of the dielectric's specular reflection",
        ),
        ParameterInfo::colour(
            "specular_color",
            (0.0, 100.0),
            Some([1.0; 3]),
            "tint of the dielectric's F0",
        ),
        ParameterInfo::number(
            "anisotropy",
            "",
            (0.0, 1.0),
            Some(0.0),
            "strength s: along its direction alpha becomes alpha + (1 − alpha) s²",
        ),
        slopes::ROTATION_DEG,
        ParameterInfo::colour(
            "anisotropy_direction",
            (-1.0, 1.0),
            Some([1.0, 0.0, 1.0]),
            "x and y of the direction of anisotropy before its rotation, and a factor on its strength: what a texture of the extension holds",
        ),
        ParameterInfo::number(
            "iridescence",
            "",
            (0.0, 1.0),
            Some(0.0),
            "strength of a thin film's interference",
        ),
        ParameterInfo::number(
            "iridescence_ior",
            "",
            (1.0, 4.0),
            Some(1.3),
            "index of refraction of the film",
        ),
        ParameterInfo::number(
            "iridescence_thickness_nm",
            "nm",
            (0.0, 5000.0),
            Some(400.0),
            "thickness of the film",
        ),
        ParameterInfo::number(
            "transmission",
            "",
            (0.0, 1.0),
            Some(0.0),
            "share of the light that enters the dielectric and passes it instead of being reflected diffusely",
        ),
        ParameterInfo::choice(
            "body",
            BODY,
            Some("thin-walled"),
            "whether the surface is a thin wall, through which light goes straight on but for its roughness, or bounds a body that refracts",
        ),
        ParameterInfo::colour(
            "attenuation_color",
            (0.0, 1.0),
            Some([1.0; 3]),
            "what remains of white light after attenuation_distance in a solid body",
        ),
        ParameterInfo::number(
            "attenuation_distance",
            "",
            (0.0, 1e6),
            None,
            "length after which attenuation_color remains, not below 1e-6; nothing is absorbed when not given",
        ),
        ParameterInfo::colour(
            "sheen_color",
            (0.0, 1.0),
            Some([0.0; 3]),
            "colour of the sheen; black is none",
        ),
        ParameterInfo::number(
            "sheen_roughness",
            "",
            (0.0, 1.0),
            Some(0.0),
            "perceptual roughness of the sheen; its alpha = sheen_roughness², not below 1e-3",
        ),
        ParameterInfo::number(
            "clearcoat",
            "",
            (0.0, 1.0),
            Some(0.0),
            "strength of the clear coat",
        ),
        ParameterInfo::number(
            "clearcoat_roughness",
            "",
            (0.0, 1.0),
            Some(0.0),
            "perceptual roughness of the clear coat; alpha = clearcoat_roughness², not below 1e-4",
        ),
        ParameterInfo::colour(
            "clearcoat_normal",
            (-1.0, 1.0),
            Some([0.0, 0.0, 1.0]),
            "x, y and z of the coat's normal beside that of the base, which is 0/0/1: where a scene's normal map bends one of them",
        ),
    ],
    positional: None,
    aliases: &[crate::Alias {
        name: "metallic-roughness",
        preset: &[],
    }],
    recordable: true,
    declares,
};

/// Whether a description has the choice `body=solid`.
pub(super) fn is_solid(spec: &ModelSpec) -> bool {
    spec.word("body") == BODY[1]
}

fn declares(spec: &ModelSpec) -> Declares {
    // Diffuse and specular are mixed by the Fresnel reflectance of the half vector, which at grazing angles takes less from the
    // diffuse part than the specular part adds: a bright dielectric can reflect more than it gets. Without a diffuse part each facet
    // shares out what it gets. The coat is mixed by the viewer's angle alone: what it sends to grazing viewers is not
    // taken from the light that the others get. Smooth sheen sends up to six times the light that there is to grazing viewers; from
    // this roughness on at most 0.95.
    let number = |key: &str| spec.real::<f64>(key);
    let transmission = number("transmission");
    let without_diffuse =
        number("metallic") == 1.0 || spec.largest("base_color") == 0.0 || transmission == 1.0;
    let coated = number("clearcoat") > 0.0;
    let gaining =
        spec.largest("sheen_color") > 0.0 && number("sheen_roughness") < LEAST_SHEEN_ROUGHNESS;
    let factor = spec
        .rgb("anisotropy_direction")
        .map_or(1.0, |direction| direction[2]);
    let bent = spec
        .rgb("clearcoat_normal")
        .is_some_and(|normal| normal[0] != 0.0 || normal[1] != 0.0);
    let relative_ior = if is_solid(spec) {
        dielectric::contrasted(number("ior"))
    } else {
        1.0
    };
    Declares {
        reciprocal: !coated,
        isotropic: (number("anisotropy") == 0.0 || factor <= 0.0) && !(coated && bent),
        relative_ior: (transmission > 0.0).then_some([relative_ior; 3]),
        ..Declares::physical(if without_diffuse && !coated && !gaining {
            1.0
        } else {
            f64::INFINITY
        })
    }
}
