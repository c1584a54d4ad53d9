//! [`Scene`], everything that an image shows.

use crate::geometry::{Aabb, Geometry, SurfacePoint};
use crate::interior::{Body, Interior};
use crate::light::{Light, LightTarget, Lights};
use crate::material::{Material, Shading, bounds_a_body};
use crate::{Camera, Files, Ray, SceneError};
use gonio_brdf::{Brdf, Model, ModelSpec, registry};
use gonio_env::Environment;
use gonio_num::Vec3;
use std::path::Path;
use std::sync::Arc;

/// Surfaces, what they are made of, what shines on them, and from where they are seen.
#[derive(Debug)]
pub struct Scene {
    /// Its name: the file's own, or the file's stem.
    pub name: String,
    /// All surfaces.
    pub geometry: Arc<Geometry>,
    /// What they are made of; instances refer to them by index.
    pub materials: Vec<Material>,
    /// All lights.
    pub lights: Lights,
    /// The cameras, the default one first; may be none: see [`Camera::framing`].
    pub cameras: Vec<Camera>,
    /// The image size (width, height) that the file asks for.
    pub film_size: Option<[u32; 2]>,
    /// What a reader could not map, in words, each thing once.
    pub warnings: Vec<String>,
    pub(crate) transparent: bool,
    pub(crate) absorbing: bool,
}

/// What to read of a file, and how much at most.
#[derive(Debug, Clone)]
pub struct LoadOptions {
    /// Which of a glTF file's scenes; its default one if none is given.
    pub scene: Option<usize>,
    /// The name or the index of the camera that becomes the first one.
    pub camera: Option<String>,
    /// Whether NaN, infinite and negative texels of the environment are replaced and counted, instead of refused.
    pub sanitize: bool,
    /// Where files are read from.
    pub files: Files,
    /// Bytes that a file, and all buffers of a file together, may have.
    pub max_bytes: u64,
    /// Pixels that one texture may have.
    pub max_texture_pixels: u64,
    /// Instances that a scene may have.
    pub max_instances: usize,
}

impl Default for LoadOptions {
    fn default() -> Self {
        Self {
            scene: None,
            camera: None,
            sanitize: false,
            files: Files::Disk,
            max_bytes: 4 << 30,
            max_texture_pixels: 1 << 28,
            max_instances: 10_000_000,
        }
    }
}

/// Layers of partly transparent surfaces that a shadow ray passes before it counts as stopped.
const MAX_LAYERS: usize = 256;
/// Unit, and along no axis or diagonal, where the edges of many models lie.
const UPWARDS: Vec3<f32> = Vec3::new(0.36, 0.864, 0.352);

impl Scene {
    /// Reads a scene, by the file's extension: `.toml` (the native format), `.gltf` and `.glb` (glTF 2.0), `.obj` and `.ply` (a
    /// mesh of grey material, in front of no light).
    ///
    /// # Errors
    /// [`SceneError`], with the file, the place, what was found and what was expected. [`SceneError::Empty`] if there is
    /// neither a surface nor an environment: nothing to render.
    pub fn load(path: impl AsRef<Path>, options: &LoadOptions) -> Result<Self, SceneError> {
        crate::reader::load(path.as_ref(), options)
    }

    /// The nearest surface along a ray.
    #[inline]
    pub fn intersect(&self, ray: &Ray) -> Option<SurfacePoint> {
        let hit = self.geometry.intersect(ray)?;
        Some(self.geometry.surface(ray, &hit))
    }

    /// Whether any surface crosses the ray, however transparent.
    #[inline]
    pub fn occluded(&self, ray: &Ray) -> bool {
        self.geometry.occluded(ray)
    }

    /// The share of radiance that comes from `target`, in the direction `wi` (unit), to a surface point, each component in \[0, 1]:
    /// Π (1 − opacity) over the surfaces in between, at most 256 of them, times e^(−σd) for the ways through bodies that absorb.
    /// Where it is zero the cost is that of [`Scene::occluded`] if no material is partly transparent.
    ///
    /// - `interior`: the bodies that the way begins in
    ///
    /// A surface that transmits stops such a way as others do: what it scatters comes along other ways.
    #[inline(always)]
    pub fn transmittance(
        &self,
        from: &SurfacePoint,
        wi: Vec3<f32>,
        target: LightTarget,
        interior: &Interior,
    ) -> [f32; 3] {
        if self.transparent || !interior.is_outside() {
            return self.transmittance_of_layers(from, wi, target, interior);
        }
        let ray = match target {
            LightTarget::Point(p) => from.spawn_ray_to(p),
            LightTarget::Infinite => from.spawn_ray(wi),
        };
        let left = if self.occluded(&ray) { 0.0 } else { 1.0 };
        [left; 3]
    }

    #[inline(never)]
    fn transmittance_of_layers(
        &self,
        from: &SurfacePoint,
        wi: Vec3<f32>,
        target: LightTarget,
        interior: &Interior,
    ) -> [f32; 3] {
        // A ray towards a light ends just short of it, light doesn't.
        let (mut rest, mut left) = match target {
            LightTarget::Point(p) => (from.spawn_ray_to(p), (p - from.p).length()),
            LightTarget::Infinite => (from.spawn_ray(wi), f32::INFINITY),
        };
        if !self.transparent && self.occluded(&rest) {
            return [0.0; 3];
        }
        let direction = rest.direction;
        let mut passed = [1.0; 3];
        let mut interior = *interior;
        for _ in 0..MAX_LAYERS {
            let Some(point) = self.intersect(&rest) else {
                return interior.absorb(passed, left);
            };
            let through = 1.0 - self.material(&point).opacity.at(&point);
            if through <= 0.0 {
                return [0.0; 3];
            }
            passed = passed.map(|p| p * through);
            if self.absorbing {
                let shading = self.shade(&point, -direction);
                if self.bounds_a_body(&shading) {
                    let body = self.body(&point, &shading.model);
                    let inner = direction.dot(point.ng) > 0.0;
                    passed = interior.arrive(&body, inner, passed, point.t);
                    interior.cross(&body, !inner);
                } else {
                    passed = interior.absorb(passed, point.t);
                }
            }
            left -= point.t;
            let t_max = rest.t_max - point.t;
            rest = point.spawn_ray(direction);
            rest.t_max = t_max;
        }
        [0.0; 3]
    }

    /// Whether some surfaces let light through, so that rays have to ask [`Shading::alpha`].
    pub fn has_transparency(&self) -> bool {
        self.transparent
    }

    /// Whether some bodies absorb, so that paths have to know what they are inside of.
    #[inline]
    pub fn has_absorption(&self) -> bool {
        self.absorbing
    }

    /// Whether a surface bounds a body, if bodies absorb at all: not one that doesn't transmit, or that neither refracts nor absorbs, since a
    /// thin pane has no inside.
    #[inline]
    pub fn bounds_a_body(&self, shading: &Shading<'_>) -> bool {
        self.absorbing && shading.transmits && bounds_a_body(&shading.model)
    }

    /// The body behind a surface with this reflection function.
    ///
    /// # Panics
    /// If the point isn't one of this scene.
    pub fn body(&self, point: &SurfacePoint, model: &Model<f32, 3>) -> Body {
        Body {
            material: self.geometry.instances()[point.instance as usize].material,
            absorption: model.absorption(),
        }
    }

    /// The bodies that the point `p` is inside of, where bodies absorb at all: those whose boundary is left more often than it is entered on
    /// the way to infinity.
    ///
    /// The way leads upwards, aslant, so that it meets the water's surface from below where that is an open sheet.
    pub fn interior_at(&self, p: Vec3<f32>) -> Interior {
        let mut around = Interior::OUTSIDE;
        if !self.absorbing {
            return around;
        }
        // Bodies that were entered on the way: leaving them tells nothing of p.
        let mut entered = Interior::OUTSIDE;
        let mut ray = Ray::new(p, UPWARDS);
        for _ in 0..MAX_LAYERS {
            let Some(point) = self.intersect(&ray) else {
                break;
            };
            let shading = self.shade(&point, -ray.direction);
            if self.bounds_a_body(&shading) {
                let body = self.body(&point, &shading.model);
                let known = |b: &Body| b.material == body.material;
                if point.ng.dot(ray.direction) < 0.0 {
                    entered.cross(&body, true);
                } else if entered.bodies().iter().any(known) {
                    entered.cross(&body, false);
                } else {
                    around.surround(body);
                }
            }
            ray = point.spawn_ray(ray.direction);
        }
        around
    }

    /// The material of a surface.
    ///
    /// # Panics
    /// If the point isn't one of this scene.
    #[inline]
    pub fn material(&self, point: &SurfacePoint) -> &Material {
        let instance = &self.geometry.instances()[point.instance as usize];
        &self.materials[instance.material as usize]
    }

    /// The material at a point as seen from the unit direction `wo_world`; see [`Material::shade`].
    ///
    /// # Panics
    /// If the point isn't one of this scene.
    #[inline]
    pub fn shade(&self, point: &SurfacePoint, wo_world: Vec3<f32>) -> Shading<'_> {
        self.material(point).shade(point, wo_world)
    }

    /// The radiance \[W m⁻² sr⁻¹] that a surface emits towards `wo_world`, before opacity; see [`Material::emitted`].
    ///
    /// # Panics
    /// If the point isn't one of this scene.
    #[inline]
    pub fn emitted(&self, point: &SurfacePoint, wo_world: Vec3<f32>) -> [f32; 3] {
        self.material(point).emitted(point, wo_world)
    }

    /// The box around all surfaces.
    pub fn bounds(&self) -> Aabb {
        self.geometry.bounds()
    }

    /// The first camera, or one that frames the scene for an image of this aspect (width / height).
    pub fn camera_or_framing(&self, aspect: f32) -> Camera {
        match self.cameras.first() {
            Some(camera) => camera.clone(),
            None => Camera::framing(&self.bounds(), aspect),
        }
    }

    /// Lets every material called `name` (all of them for `*`) reflect as `spec` says; their emission, opacity and normal
    /// maps stay. Returns how many there are.
    ///
    /// # Errors
    /// [`SceneError::UnknownMaterial`] if there is none of that name, [`SceneError::Brdf`] if the model can't be built; the
    /// scene is then unchanged.
    pub fn replace_material(&mut self, name: &str, spec: &ModelSpec) -> Result<usize, SceneError> {
        let chosen = |m: &Material| name == "*" || m.name == name;
        if !self.materials.iter().any(chosen) {
            return Err(self.unknown_material(name));
        }
        let mut changed = self.materials.clone();
        let mut count = 0;
        for material in changed.iter_mut().filter(|m| chosen(m)) {
            material.replace_model(spec)?;
            count += 1;
            for warning in material.warnings() {
                if !self.warnings.contains(&warning) {
                    self.warnings.push(warning);
                }
            }
        }
        self.materials = changed;
        self.absorbing = self.materials.iter().any(Material::absorbs);
        self.review_lights();
        Ok(count)
    }

    /// The names of the materials, each once, in their order.
    pub fn material_names(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for material in &self.materials {
            if !names.contains(&material.name.as_str()) {
                names.push(&material.name);
            }
        }
        names
    }

    fn unknown_material(&self, name: &str) -> SceneError {
        let names = self.material_names();
        SceneError::UnknownMaterial {
            name: name.into(),
            help: match registry::suggest(name, names.iter().copied()) {
                Some(near) => format!("did you mean `{near}`?"),
                None => format!("the scene has: {}", names.join(", ")),
            },
        }
    }

    /// Puts another environment in the place of the present one, in its group of lights, or takes it away.
    pub fn set_environment(&mut self, environment: Option<Environment>) {
        let punctual = self
            .lights
            .iter()
            .filter(|l| l.is_delta())
            .cloned()
            .collect();
        self.set_lights(punctual, environment);
    }

    /// Puts other lights in the place of the present ones, but for the surfaces that shine.
    ///
    /// - `punctual`: point, spot and directional lights
    pub fn set_lights(&mut self, punctual: Vec<Light>, environment: Option<Environment>) {
        self.lights = Lights::new(
            self.geometry.clone(),
            &self.materials,
            punctual,
            environment,
            self.lights.given_groups().clone(),
        );
        self.review_lights();
    }

    /// Puts the warnings about the lights in order.
    pub(crate) fn review_lights(&mut self) {
        self.warnings
            .retain(|w| w != NO_LIGHT && !w.starts_with(NOT_THROUGH));
        if self.lights.is_empty() {
            self.warnings.push(NO_LIGHT.into());
        }
        if !self.lights.iter().any(Light::is_delta) {
            return;
        }
        let mut used = vec![false; self.materials.len()];
        for instance in self.geometry.instances() {
            used[instance.material as usize] = true;
        }
        let mut smooth: Vec<String> = Vec::new();
        for (material, used) in self.materials.iter().zip(used) {
            if !(used && material.transmits_smoothly()) {
                continue;
            }
            let name = format!("`{}`", material.name);
            if !smooth.contains(&name) {
                smooth.push(name);
            }
        }
        if !smooth.is_empty() {
            self.warnings.push(format!(
                "{NOT_THROUGH} {}, whose shadows are black: light of a single direction can't be found through a smooth surface; \
                 shine by a surface instead, a small sphere say",
                smooth.join(", ")
            ));
        }
    }
}

/// The warning of a scene in the dark.
pub(crate) const NO_LIGHT: &str = "the scene has no light: everything is black";
/// How the warning begins that point-like lights meet smooth glass.
const NOT_THROUGH: &str = "point, spot and directional lights do not shine through";

#[cfg(test)]
#[path = "scene_tests.rs"]
mod tests;
