//! [`Scene`], everything that an image shows, and [`SceneBuilder`], which puts one together.

use crate::geometry::{Aabb, Geometry, Instance, Shape, SurfacePoint};
use crate::light::{Light, Lights};
use crate::material::{Material, Shading};
use crate::{Camera, Ray, SceneError};
use gonio_brdf::{ModelSpec, registry};
use gonio_env::Environment;
use gonio_num::{Affine3, Vec3};
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
    transparent: bool,
}

/// What to read of a file, and how much at most.
#[derive(Debug, Clone)]
pub struct LoadOptions {
    /// Which of a glTF file's scenes; its default one if none is given.
    pub scene: Option<usize>,
    /// The name or the index of the camera that becomes the first one.
    pub camera: Option<String>,
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
            max_bytes: 4 << 30,
            max_texture_pixels: 1 << 28,
            max_instances: 10_000_000,
        }
    }
}

/// Layers of partly transparent surfaces that a shadow ray passes before it counts as stopped.
const MAX_LAYERS: usize = 256;

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

    /// The share of light that passes along the ray, in \[0, 1]: Π (1 − opacity) over the surfaces it crosses, at most 256 of
    /// them. Without partly transparent materials this is 0 or 1, at the cost of [`Scene::occluded`].
    pub fn transmittance(&self, ray: &Ray) -> f32 {
        if !self.transparent {
            return if self.occluded(ray) { 0.0 } else { 1.0 };
        }
        let mut passed = 1.0;
        let mut rest = *ray;
        for _ in 0..MAX_LAYERS {
            let Some(point) = self.intersect(&rest) else {
                return passed;
            };
            let opacity = &self.material(&point).opacity;
            passed *= 1.0 - opacity.at(&point);
            if passed <= 0.0 {
                return 0.0;
            }
            let t_max = rest.t_max - point.t;
            rest = point.spawn_ray(ray.direction);
            rest.t_max = t_max;
        }
        0.0
    }

    /// Whether some surfaces let light through, so that rays have to ask [`Shading::alpha`].
    pub fn has_transparency(&self) -> bool {
        self.transparent
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
        }
        self.materials = changed;
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

    /// Puts another environment in the place of the present one, or takes it away.
    pub fn set_environment(&mut self, environment: Option<Environment>) {
        let punctual = self
            .lights
            .iter()
            .filter(|l| l.is_delta())
            .cloned()
            .collect();
        self.lights = Lights::new(
            self.geometry.clone(),
            &self.materials,
            punctual,
            environment,
        );
        self.warnings.retain(|w| w != NO_LIGHT);
        if self.lights.is_empty() {
            self.warnings.push(NO_LIGHT.into());
        }
    }
}

/// The warning of a scene in the dark.
const NO_LIGHT: &str = "the scene has no light: everything is black";

/// Collects the parts of a scene.
///
/// ```
/// use gonio_scene::{Light, Material, SceneBuilder, Shape};
/// use gonio_brdf::ModelSpec;
/// use gonio_num::{Affine3, Vec3};
/// let mut scene = SceneBuilder::new("ball");
/// let grey = scene.material(Material::new("grey", &ModelSpec::parse("lambertian:reflectance=0.5")?)?);
/// let sphere = scene.shape(Shape::Sphere);
/// scene.instance(sphere, Affine3::translation(Vec3::new(0.0, 1.0, 0.0)), grey);
/// scene.light(Light::Point { position: Vec3::new(0.0, 5.0, 0.0), intensity: [10.0; 3] });
/// let scene = scene.build()?;
/// assert_eq!(scene.lights.len(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Default)]
pub struct SceneBuilder {
    name: String,
    shapes: Vec<Shape>,
    instances: Vec<Instance>,
    materials: Vec<Material>,
    lights: Vec<Light>,
    environment: Option<Environment>,
    cameras: Vec<Camera>,
    film_size: Option<[u32; 2]>,
    warnings: Vec<String>,
}

impl SceneBuilder {
    /// A scene of nothing yet.
    pub fn new(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            ..Self::default()
        }
    }

    /// Gives the scene another name.
    pub fn rename(&mut self, name: impl Into<String>) {
        self.name = name.into();
    }

    /// Adds a shape; returns its index.
    pub fn shape(&mut self, shape: Shape) -> u32 {
        self.shapes.push(shape);
        self.shapes.len() as u32 - 1
    }

    /// Adds a material; returns its index.
    pub fn material(&mut self, material: Material) -> u32 {
        self.materials.push(material);
        self.materials.len() as u32 - 1
    }

    /// The materials so far.
    pub fn materials(&self) -> &[Material] {
        &self.materials
    }

    /// Places a shape, made of a material, in the world.
    pub fn instance(&mut self, shape: u32, to_world: Affine3<f32>, material: u32) {
        self.instances.push(Instance {
            shape,
            to_world,
            material,
            area_light: None,
        });
    }

    /// Number of instances so far.
    pub fn instance_count(&self) -> usize {
        self.instances.len()
    }

    /// Adds a point, spot or directional light, or sets the environment. Surfaces become lights by their materials: an
    /// [`Light::Area`] is ignored here.
    pub fn light(&mut self, light: Light) {
        match light {
            Light::Environment(e) => self.environment = Some(e),
            Light::Area { .. } => {}
            delta => self.lights.push(delta),
        }
    }

    /// Sets the environment.
    pub fn environment(&mut self, environment: Environment) {
        self.environment = Some(environment);
    }

    /// Adds a camera; the first is the default.
    pub fn camera(&mut self, camera: Camera) {
        self.cameras.push(camera);
    }

    /// The image size that is asked for.
    pub fn film_size(&mut self, size: [u32; 2]) {
        self.film_size = Some(size);
    }

    /// Adds a warning, unless it is there already.
    pub fn warn(&mut self, warning: impl Into<String>) {
        let warning = warning.into();
        if !self.warnings.contains(&warning) {
            self.warnings.push(warning);
        }
    }

    /// Checks everything and builds the scene.
    ///
    /// # Errors
    /// [`SceneError::Empty`] if there is neither an instance nor an environment; [`SceneError::Parameter`] if a light isn't
    /// finite or is negative, or an instance has no material; and what [`Geometry::build`] refuses.
    pub fn build(mut self) -> Result<Scene, SceneError> {
        if self.instances.is_empty() && self.environment.is_none() {
            return Err(SceneError::Empty { name: self.name });
        }
        for (index, light) in self.lights.iter().enumerate() {
            check_light(index, light)?;
        }
        let mut lights = self.lights.len() as u32;
        for (index, instance) in self.instances.iter_mut().enumerate() {
            let material = self.materials.get(instance.material as usize);
            let material = material.ok_or_else(|| SceneError::Parameter {
                name: format!("material of instance {index}"),
                found: instance.material.to_string(),
                expected: format!("an index below {}", self.materials.len()),
            })?;
            instance.area_light = material.emission.is_lit().then(|| {
                lights += 1;
                lights - 1
            });
        }
        let transparent = self
            .instances
            .iter()
            .any(|i| !self.materials[i.material as usize].opacity.is_opaque());
        let geometry = Arc::new(Geometry::build(self.shapes, self.instances)?);
        let lights = Lights::new(
            geometry.clone(),
            &self.materials,
            self.lights,
            self.environment,
        );
        if lights.is_empty() {
            self.warnings.push(NO_LIGHT.into());
        }
        Ok(Scene {
            name: self.name,
            geometry,
            materials: self.materials,
            lights,
            cameras: self.cameras,
            film_size: self.film_size,
            warnings: self.warnings,
            transparent,
        })
    }
}

/// # Errors
/// [`SceneError::Parameter`] if a number of the light isn't finite, its colour is negative, or its direction isn't unit.
fn check_light(index: usize, light: &Light) -> Result<(), SceneError> {
    let colour_is_good = |c: &[f32; 3]| c.iter().all(|&x| x.is_finite() && x >= 0.0);
    let is_unit = |d: &Vec3<f32>| (d.length() - 1.0).abs() < 1e-4;
    let good = match light {
        Light::Point {
            position,
            intensity,
        } => position.is_finite() && colour_is_good(intensity),
        Light::Directional {
            direction,
            irradiance,
        } => is_unit(direction) && colour_is_good(irradiance),
        Light::Spot {
            position,
            direction,
            intensity,
            ..
        } => position.is_finite() && is_unit(direction) && colour_is_good(intensity),
        Light::Area { .. } | Light::Environment(_) => true,
    };
    if good {
        return Ok(());
    }
    Err(SceneError::Parameter {
        name: format!("light {index}"),
        found: format!("{light:?}"),
        expected: "a finite position, a unit direction and a colour that is nowhere negative"
            .into(),
    })
}

#[cfg(test)]
#[path = "scene_tests.rs"]
mod tests;
