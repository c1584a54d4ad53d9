//! Material extensions that add layers and passages to the metallic-roughness base: parameters of the model `gltf`, and the
//! textures that drive them.

use super::material::{Materials, Use, usage};
use crate::material::Channels;
use crate::texture::Transfer;
use crate::{Material, SceneError};
use gltf::json;
use gonio_brdf::{ModelSpec, Value};
use serde_json::Map;

/// A texture that drives a parameter: value = `scale` · texel + `offset`, times the description's value.
pub(super) struct Drive {
    pub parameter: &'static str,
    pub used: Use,
    pub transfer: Transfer,
    pub channels: Channels,
    pub scale: [f32; 3],
    pub offset: [f32; 3],
}

impl Drive {
    /// The texel as it is.
    fn plain(parameter: &'static str, used: Use, transfer: Transfer, channels: Channels) -> Self {
        Self {
            parameter,
            used,
            transfer,
            channels,
            scale: [1.0; 3],
            offset: [0.0; 3],
        }
    }
}

/// An extension that the parser left as it is.
struct Extension<'a> {
    name: &'static str,
    /// The material.
    place: &'a str,
    values: &'a Map<String, serde_json::Value>,
}

impl Materials<'_> {
    /// Sets what the extensions of a material say in `spec`, and returns the textures that drive it.
    ///
    /// # Errors
    /// [`SceneError::Format`] for values of the wrong kind.
    pub(super) fn layers(
        &mut self,
        spec: &mut ModelSpec,
        source: &json::Material,
        place: &str,
    ) -> Result<Vec<Drive>, SceneError> {
        let mut drives = Vec::new();
        let Some(extensions) = source.extensions.as_ref() else {
            return Ok(drives);
        };
        self.passage(spec, extensions, place, &mut drives)?;
        let found = |name| self.extension(extensions, name, place);
        let (anisotropy, iridescence) = (
            found("KHR_materials_anisotropy")?,
            found("KHR_materials_iridescence")?,
        );
        let (sheen, coat) = (
            found("KHR_materials_sheen")?,
            found("KHR_materials_clearcoat")?,
        );
        if let Some(extension) = anisotropy {
            self.anisotropy(spec, &extension, &mut drives)?;
        }
        if let Some(extension) = iridescence {
            self.iridescence(spec, &extension, &mut drives)?;
        }
        if let Some(extension) = sheen {
            self.sheen(spec, &extension, &mut drives)?;
        }
        if let Some(extension) = coat {
            self.clearcoat(spec, &extension, source, &mut drives)?;
        }
        Ok(drives)
    }

    /// KHR_materials_transmission, and KHR_materials_volume, which does nothing without.
    fn passage(
        &mut self,
        spec: &mut ModelSpec,
        extensions: &json::extensions::material::Material,
        place: &str,
        drives: &mut Vec<Drive>,
    ) -> Result<(), SceneError> {
        let Some(transmission) = &extensions.transmission else {
            return Ok(());
        };
        let share = transmission.transmission_factor.0;
        if share == 0.0 {
            return Ok(());
        }
        self.set(spec, place, "transmission", [share], (0.0, 1.0))?;
        if let Some(texture) = &transmission.transmission_texture {
            drives.push(Drive::plain(
                "transmission",
                usage(texture),
                Transfer::Linear,
                Channels::Red,
            ));
        }
        let Some(volume) = &extensions.volume else {
            return Ok(());
        };
        let thickness = volume.thickness_factor.0;
        if thickness < 0.0 {
            let found = format!("thicknessFactor {thickness}");
            return Err(SceneError::format(
                self.arrays.path,
                place,
                found,
                "a number ≥ 0",
            ));
        }
        // The way through the body is traced: of its thickness only whether there is any matters.
        if thickness > 0.0 {
            spec.set("body", Value::Choice("solid".into()))?;
            let colour = volume.attenuation_color.0;
            self.set(spec, place, "attenuation_color", colour, (0.0, 1.0))?;
            let distance = volume.attenuation_distance.0;
            if distance <= 0.0 {
                let found = format!("attenuationDistance {distance}");
                return Err(SceneError::format(
                    self.arrays.path,
                    place,
                    found,
                    "a number > 0",
                ));
            }
            if distance.is_finite() {
                self.set(spec, place, "attenuation_distance", [distance], (0.0, 1e6))?;
            }
        }
        Ok(())
    }

    fn anisotropy(
        &mut self,
        spec: &mut ModelSpec,
        extension: &Extension<'_>,
        drives: &mut Vec<Drive>,
    ) -> Result<(), SceneError> {
        let strength = self.number(extension, "anisotropyStrength", 0.0)?;
        if strength == 0.0 {
            return Ok(());
        }
        self.set(spec, extension.place, "anisotropy", [strength], (0.0, 1.0))?;
        let radians = self.number(extension, "anisotropyRotation", 0.0)?;
        // Of any number of turns the last one counts.
        let degrees = radians.to_degrees() % 360.0;
        self.set(
            spec,
            extension.place,
            "rotation_deg",
            [degrees],
            (-360.0, 360.0),
        )?;
        if let Some(used) = self.used(extension, "anisotropyTexture")? {
            drives.push(Drive {
                scale: [2.0, 2.0, 1.0],
                offset: [-1.0, -1.0, 0.0],
                ..Drive::plain(
                    "anisotropy_direction",
                    used,
                    Transfer::Linear,
                    Channels::Rgb,
                )
            });
        }
        Ok(())
    }

    fn iridescence(
        &mut self,
        spec: &mut ModelSpec,
        extension: &Extension<'_>,
        drives: &mut Vec<Drive>,
    ) -> Result<(), SceneError> {
        let place = extension.place;
        let strength = self.number(extension, "iridescenceFactor", 0.0)?;
        if strength == 0.0 {
            return Ok(());
        }
        self.set(spec, place, "iridescence", [strength], (0.0, 1.0))?;
        if let Some(used) = self.used(extension, "iridescenceTexture")? {
            drives.push(Drive::plain(
                "iridescence",
                used,
                Transfer::Linear,
                Channels::Red,
            ));
        }
        let ior = self.number(extension, "iridescenceIor", 1.3)?;
        self.set(spec, place, "iridescence_ior", [ior], (1.0, 4.0))?;
        let least = self.number(extension, "iridescenceThicknessMinimum", 100.0)?;
        let most = self.number(extension, "iridescenceThicknessMaximum", 400.0)?;
        let used = self.used(extension, "iridescenceThicknessTexture")?;
        // The texture goes from one to the other, either of which may be the larger one.
        let base = if used.is_some() {
            least.max(most)
        } else {
            most
        };
        let key = "iridescence_thickness_nm";
        self.set(spec, place, key, [base], (0.0, 5000.0))?;
        if let Some(used) = used
            && base > 0.0
        {
            drives.push(Drive {
                scale: [(most - least) / base; 3],
                offset: [least / base; 3],
                ..Drive::plain(key, used, Transfer::Linear, Channels::Green)
            });
        }
        Ok(())
    }

    fn sheen(
        &mut self,
        spec: &mut ModelSpec,
        extension: &Extension<'_>,
        drives: &mut Vec<Drive>,
    ) -> Result<(), SceneError> {
        let place = extension.place;
        let colour = self.colour(extension, "sheenColorFactor", [0.0; 3])?;
        if colour == [0.0; 3] {
            return Ok(());
        }
        self.set(spec, place, "sheen_color", colour, (0.0, 1.0))?;
        let roughness = self.number(extension, "sheenRoughnessFactor", 0.0)?;
        self.set(spec, place, "sheen_roughness", [roughness], (0.0, 1.0))?;
        if let Some(used) = self.used(extension, "sheenColorTexture")? {
            drives.push(Drive::plain(
                "sheen_color",
                used,
                Transfer::Srgb,
                Channels::Rgb,
            ));
        }
        if let Some(used) = self.used(extension, "sheenRoughnessTexture")? {
            drives.push(Drive::plain(
                "sheen_roughness",
                used,
                Transfer::Linear,
                Channels::Alpha,
            ));
        }
        Ok(())
    }

    fn clearcoat(
        &mut self,
        spec: &mut ModelSpec,
        extension: &Extension<'_>,
        source: &json::Material,
        drives: &mut Vec<Drive>,
    ) -> Result<(), SceneError> {
        let place = extension.place;
        let strength = self.number(extension, "clearcoatFactor", 0.0)?;
        if strength == 0.0 {
            return Ok(());
        }
        self.set(spec, place, "clearcoat", [strength], (0.0, 1.0))?;
        let roughness = self.number(extension, "clearcoatRoughnessFactor", 0.0)?;
        self.set(spec, place, "clearcoat_roughness", [roughness], (0.0, 1.0))?;
        if let Some(used) = self.used(extension, "clearcoatTexture")? {
            drives.push(Drive::plain(
                "clearcoat",
                used,
                Transfer::Linear,
                Channels::Red,
            ));
        }
        if let Some(used) = self.used(extension, "clearcoatRoughnessTexture")? {
            drives.push(Drive::plain(
                "clearcoat_roughness",
                used,
                Transfer::Linear,
                Channels::Green,
            ));
        }
        if source.emissive_factor.0 != [0.0; 3] {
            self.warn(format!(
                "{place}: its emission isn't darkened by its clear coat"
            ));
        }
        Ok(())
    }

    /// The normal of a clear coat: bent by a map of its own, whatever bends the base's.
    pub(super) fn coat_normal(
        &mut self,
        material: &mut Material,
        source: &json::Material,
        place: &str,
    ) -> Result<(), SceneError> {
        let Some(extensions) = source.extensions.as_ref() else {
            return Ok(());
        };
        let coated = material.spec().values.contains_key("clearcoat");
        let extension = self.extension(extensions, "KHR_materials_clearcoat", place)?;
        let Some(extension) = extension.filter(|_| coated) else {
            return Ok(());
        };
        let key = "clearcoatNormalTexture";
        let map = match extension.values.get(key) {
            None => None,
            Some(value) => {
                match json::deserialize::from_value::<json::material::NormalTexture>(value.clone())
                {
                    Ok(map) => self.normal_map(&map, place)?,
                    Err(_) => {
                        let expected = "a texture's index, texCoord and scale";
                        return Err(self.wrong(&extension, key, value, expected));
                    }
                }
            }
        };
        if map != material.normal_map {
            material.bind_normal("clearcoat_normal", map)?;
        }
        Ok(())
    }

    fn extension<'a>(
        &self,
        extensions: &'a json::extensions::material::Material,
        name: &'static str,
        place: &'a str,
    ) -> Result<Option<Extension<'a>>, SceneError> {
        match extensions.others.get(name) {
            None => Ok(None),
            Some(serde_json::Value::Object(values)) => Ok(Some(Extension {
                name,
                place,
                values,
            })),
            Some(other) => {
                let found = format!("{name}: {other}");
                Err(SceneError::format(
                    self.arrays.path,
                    place,
                    found,
                    "an object",
                ))
            }
        }
    }

    fn number(&self, e: &Extension<'_>, key: &str, default: f32) -> Result<f32, SceneError> {
        let Some(value) = e.values.get(key) else {
            return Ok(default);
        };
        let number = value.as_f64().map(|x| x as f32).filter(|x| x.is_finite());
        number.ok_or_else(|| self.wrong(e, key, value, "a number"))
    }

    fn colour(
        &self,
        e: &Extension<'_>,
        key: &str,
        default: [f32; 3],
    ) -> Result<[f32; 3], SceneError> {
        let Some(value) = e.values.get(key) else {
            return Ok(default);
        };
        let numbers: Option<Vec<f32>> = value.as_array().and_then(|array| {
            let number = |x: &serde_json::Value| x.as_f64().map(|x| x as f32);
            let finite = array.iter().map(|x| number(x).filter(|x| x.is_finite()));
            finite.collect()
        });
        let colour = numbers.and_then(|n| <[f32; 3]>::try_from(n).ok());
        colour.ok_or_else(|| self.wrong(e, key, value, "three numbers"))
    }

    fn used(&self, e: &Extension<'_>, key: &str) -> Result<Option<Use>, SceneError> {
        let Some(value) = e.values.get(key) else {
            return Ok(None);
        };
        match json::deserialize::from_value::<json::texture::Info>(value.clone()) {
            Ok(info) => Ok(Some(usage(&info))),
            Err(_) => Err(self.wrong(e, key, value, "a texture's index and texCoord")),
        }
    }

    fn wrong(
        &self,
        e: &Extension<'_>,
        key: &str,
        value: &serde_json::Value,
        expected: &str,
    ) -> SceneError {
        let place = format!("{}, {}", e.place, e.name);
        SceneError::format(self.arrays.path, place, format!("{key} {value}"), expected)
    }
}
