//! glTF materials as [`Material`]s of the model `gltf`.

use super::accessor::Arrays;
use super::group::light_group;
use super::image::Images;
use crate::material::{AlphaMode, Channels, NormalMap, Opacity, TextureInput};
use crate::texture::{Filter, Texture, Transfer, UvTransform, Wrap};
use crate::{Material, SceneError};
use gltf::json::{self, Index, texture::MagFilter, texture::WrappingMode, validation::Checked};
use gonio_brdf::{ModelSpec, Value};

/// Reads materials and the textures that they use.
pub(super) struct Materials<'a> {
    pub arrays: &'a Arrays<'a>,
    pub images: Images<'a>,
    pub warnings: Vec<String>,
}

/// Where a texture is used: its index, its set of coordinates, and its transform.
#[derive(Clone, Copy)]
pub(super) struct Use {
    texture: usize,
    uv_set: u32,
    transform: Option<UvTransform>,
}

impl Materials<'_> {
    /// The material of a primitive without one: every property has glTF's default, so it is a white rough metal.
    pub fn default_material(&mut self, vertex_colours: bool) -> Result<Material, SceneError> {
        self.read(None, &json::Material::default(), "default", vertex_colours)
    }

    /// Material `index` of the document.
    ///
    /// - `vertex_colours`: whether a primitive that uses it has colours
    ///
    /// # Errors
    /// [`SceneError::Format`] for references to what doesn't exist, and what reading an image gives.
    pub fn material(&mut self, index: usize, vertex_colours: bool) -> Result<Material, SceneError> {
        let material = self.arrays.root.materials.get(index);
        let material = material.ok_or_else(|| {
            self.arrays.missing(
                &format!("material {index}"),
                self.arrays.root.materials.len(),
            )
        })?;
        let name = material
            .name
            .clone()
            .unwrap_or_else(|| format!("material {index}"));
        self.read(Some(index), material, &name, vertex_colours)
    }

    fn read(
        &mut self,
        index: Option<usize>,
        source: &json::Material,
        name: &str,
        vertex_colours: bool,
    ) -> Result<Material, SceneError> {
        let place = index.map_or("default material".into(), |i| {
            format!("material {i} ({name})")
        });
        let pbr = &source.pbr_metallic_roughness;
        let [r, g, b, a] = pbr.base_color_factor.0;
        let base_texture = pbr.base_color_texture.as_ref().map(usage);
        let extensions = source.extensions.as_ref();
        let unlit = extensions.is_some_and(|e| e.unlit.is_some());
        let mut material = if unlit {
            let mut black = ModelSpec::new("lambertian")?;
            black.set("reflectance", Value::Number(0.0))?;
            let mut material = Material::new(name, &black)?;
            material.emission.radiance = [r, g, b];
            material.emission.vertex_colour = vertex_colours;
            material.emission.texture = self.texture(base_texture, Transfer::Srgb, &place)?;
            self.warn(format!(
                "{place}: unlit, so it shines with its base colour as radiance (W m⁻² sr⁻¹) and lights its surroundings"
            ));
            material
        } else {
            self.reflecting(source, name, &place, vertex_colours)?
        };
        material.double_sided = source.double_sided;
        if material.emission.is_lit() {
            let warn = &mut |w| self.warn(w);
            material.emission.group = light_group(&source.extras, &place, warn);
        }
        let mode = self
            .arrays
            .checked(&source.alpha_mode, &place, "alphaMode")?;
        let cutoff = source.alpha_cutoff.map_or(0.5, |c| c.0);
        let mode = match mode {
            json::material::AlphaMode::Opaque => AlphaMode::Opaque,
            json::material::AlphaMode::Mask => AlphaMode::Mask(cutoff),
            json::material::AlphaMode::Blend => AlphaMode::Blend,
        };
        if mode != AlphaMode::Opaque {
            let texture = self.texture(base_texture, Transfer::Srgb, &place)?;
            material.opacity = Opacity {
                mode,
                factor: a,
                texture: texture.map(|t| TextureInput::new(t, Channels::Alpha)),
                vertex_alpha: vertex_colours,
            };
        }
        Ok(material)
    }

    fn reflecting(
        &mut self,
        source: &json::Material,
        name: &str,
        place: &str,
        vertex_colours: bool,
    ) -> Result<Material, SceneError> {
        let pbr = &source.pbr_metallic_roughness;
        let extensions = source.extensions.as_ref();
        let mut spec = ModelSpec::new("gltf")?;
        let [r, g, b, _] = pbr.base_color_factor.0;
        self.set(&mut spec, place, "base_color", [r, g, b], (0.0, 1.0))?;
        self.set(
            &mut spec,
            place,
            "metallic",
            [pbr.metallic_factor.0],
            (0.0, 1.0),
        )?;
        self.set(
            &mut spec,
            place,
            "roughness",
            [pbr.roughness_factor.0],
            (0.0, 1.0),
        )?;
        if let Some(ior) = extensions.and_then(|e| e.ior.as_ref()) {
            // 0 stands for an infinite index; the largest that the model has comes close.
            let ior = if ior.ior.0 == 0.0 { 10.0 } else { ior.ior.0 };
            self.set(&mut spec, place, "ior", [ior], (1.0, 10.0))?;
        }
        let specular = extensions.and_then(|e| e.specular.as_ref());
        if let Some(s) = specular {
            self.set(
                &mut spec,
                place,
                "specular",
                [s.specular_factor.0],
                (0.0, 1.0),
            )?;
            self.set(
                &mut spec,
                place,
                "specular_color",
                s.specular_color_factor.0,
                (0.0, 100.0),
            )?;
        }
        let drives = self.layers(&mut spec, source, place)?;
        let mut material = Material::new(name, &spec)?;
        let base = pbr.base_color_texture.as_ref().map(usage);
        self.bind(
            &mut material,
            "base_color",
            base,
            Transfer::Srgb,
            Channels::Rgb,
            place,
        )?;
        let both = pbr.metallic_roughness_texture.as_ref().map(usage);
        self.bind(
            &mut material,
            "metallic",
            both,
            Transfer::Linear,
            Channels::Blue,
            place,
        )?;
        self.bind(
            &mut material,
            "roughness",
            both,
            Transfer::Linear,
            Channels::Green,
            place,
        )?;
        if let Some(s) = specular {
            let strength = s.specular_texture.as_ref().map(usage);
            self.bind(
                &mut material,
                "specular",
                strength,
                Transfer::Linear,
                Channels::Alpha,
                place,
            )?;
            let colour = s.specular_color_texture.as_ref().map(usage);
            self.bind(
                &mut material,
                "specular_color",
                colour,
                Transfer::Srgb,
                Channels::Rgb,
                place,
            )?;
        }
        for drive in drives {
            if let Some(texture) = self.texture(Some(drive.used), drive.transfer, place)? {
                let input = TextureInput {
                    texture,
                    channels: drive.channels,
                    scale: drive.scale,
                    offset: drive.offset,
                };
                material.bind_texture(drive.parameter, input)?;
            }
        }
        if vertex_colours {
            material.bind_vertex_colour("base_color")?;
        }
        if let Some(map) = &source.normal_texture {
            material.normal_map = self.normal_map(map, place)?;
        }
        material.along_bitangent = spec.values.contains_key("anisotropy");
        self.coat_normal(&mut material, source, place)?;
        let strength = extensions
            .and_then(|e| e.emissive_strength.as_ref())
            .map_or(1.0, |e| e.emissive_strength.0);
        let radiance = source.emissive_factor.0.map(|c| c * strength);
        if radiance.iter().any(|c| !(c.is_finite() && *c >= 0.0)) {
            let found = format!("emissiveFactor × emissiveStrength = {radiance:?}");
            return Err(SceneError::format(
                self.arrays.path,
                place,
                found,
                "finite numbers ≥ 0",
            ));
        }
        material.emission.radiance = radiance;
        if material.emission.is_lit() {
            let used = source.emissive_texture.as_ref().map(usage);
            material.emission.texture = self.texture(used, Transfer::Srgb, place)?;
        }
        Ok(material)
    }

    /// Sets a parameter of the model from one or three numbers, limited to its range with a warning.
    pub(super) fn set<const N: usize>(
        &mut self,
        spec: &mut ModelSpec,
        place: &str,
        key: &str,
        value: [f32; N],
        (low, high): (f32, f32),
    ) -> Result<(), SceneError> {
        let limited = value.map(|v| v.max(low).min(high));
        if limited != value {
            self.warn(format!(
                "{place}: {key} = {value:?} is limited to {low}…{high}"
            ));
        }
        let value = match limited[..] {
            [x] => Value::Number(x.into()),
            [r, g, b] => Value::Colour([r.into(), g.into(), b.into()]),
            _ => return Ok(()),
        };
        spec.set(key, value)?;
        Ok(())
    }

    fn bind(
        &mut self,
        material: &mut Material,
        parameter: &str,
        used: Option<Use>,
        transfer: Transfer,
        channels: Channels,
        place: &str,
    ) -> Result<(), SceneError> {
        if let Some(texture) = self.texture(used, transfer, place)? {
            material.bind_texture(parameter, TextureInput::new(texture, channels))?;
        }
        Ok(())
    }

    /// The texture of a use, with its image read.
    fn texture(
        &mut self,
        used: Option<Use>,
        transfer: Transfer,
        place: &str,
    ) -> Result<Option<Texture>, SceneError> {
        let Some(used) = used else { return Ok(None) };
        let root = self.arrays.root;
        let place = format!("{place}, texture {}", used.texture);
        let source = root.textures.get(used.texture);
        let source = source.ok_or_else(|| self.arrays.missing(&place, root.textures.len()))?;
        let mut texture =
            Texture::new(self.images.bitmap(source.source.value(), &place)?, transfer);
        if let Some(index) = source.sampler {
            let sampler = root.samplers.get(index.value());
            let sampler = sampler.ok_or_else(|| {
                self.arrays
                    .missing(&format!("{place}, sampler"), root.samplers.len())
            })?;
            let wrap = |mode: &Checked<WrappingMode>| {
                let mode = self.arrays.checked(mode, &place, "wrap mode")?;
                Ok::<_, SceneError>(match mode {
                    WrappingMode::Repeat => Wrap::Repeat,
                    WrappingMode::ClampToEdge => Wrap::Clamp,
                    WrappingMode::MirroredRepeat => Wrap::Mirror,
                })
            };
            texture.wrap = [wrap(&sampler.wrap_s)?, wrap(&sampler.wrap_t)?];
            if let Some(filter) = &sampler.mag_filter
                && self.arrays.checked(filter, &place, "magFilter")? == MagFilter::Nearest
            {
                texture.filter = Filter::Nearest;
            }
        }
        if let Some(transform) = used.transform {
            texture.transform = transform;
        }
        match used.uv_set {
            0 | 1 => texture.uv_set = used.uv_set as u8,
            other => self.warn(format!(
                "{place}: TEXCOORD_{other} is not read, TEXCOORD_0 is used"
            )),
        }
        Ok(Some(texture))
    }

    pub(super) fn normal_map(
        &mut self,
        map: &json::material::NormalTexture,
        place: &str,
    ) -> Result<Option<NormalMap>, SceneError> {
        let others = map.extensions.as_ref().map(|e| &e.others);
        let used = Use {
            texture: map.index.value(),
            uv_set: map.tex_coord,
            transform: None,
        };
        let used = self.transformed(used, others, place)?;
        let texture = self.texture(Some(used), Transfer::Linear, place)?;
        Ok(texture.map(|texture| NormalMap {
            texture,
            scale: map.scale,
        }))
    }

    /// A use with KHR_texture_transform out of extensions that the parser left as they are.
    fn transformed(
        &self,
        mut used: Use,
        extensions: Option<&serde_json::Map<String, serde_json::Value>>,
        place: &str,
    ) -> Result<Use, SceneError> {
        let Some(value) = extensions.and_then(|e| e.get("KHR_texture_transform")) else {
            return Ok(used);
        };
        let parsed = json::deserialize::from_value::<json::extensions::texture::TextureTransform>(
            value.clone(),
        );
        let transform = parsed.map_err(|e| {
            let found = format!("KHR_texture_transform: {e}");
            SceneError::format(
                self.arrays.path,
                place,
                found,
                "offset, rotation, scale and texCoord",
            )
        })?;
        used.transform = Some(uv_transform(&transform));
        used.uv_set = transform.tex_coord.unwrap_or(used.uv_set);
        Ok(used)
    }

    pub(super) fn warn(&mut self, warning: String) {
        self.warnings.push(warning);
    }
}

/// How a texture reference uses its texture.
pub(super) fn usage(info: &json::texture::Info) -> Use {
    let transform = info
        .extensions
        .as_ref()
        .and_then(|e| e.texture_transform.as_ref());
    Use {
        texture: Index::value(&info.index),
        uv_set: transform
            .and_then(|t| t.tex_coord)
            .unwrap_or(info.tex_coord),
        transform: transform.map(uv_transform),
    }
}

fn uv_transform(t: &json::extensions::texture::TextureTransform) -> UvTransform {
    UvTransform::new(t.offset.0, t.rotation.0, t.scale.0)
}
