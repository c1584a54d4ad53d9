//! [`SceneBuilder`], which puts a scene together.

use crate::geometry::{Geometry, Instance, Shape};
use crate::light::group::LightGroups;
use crate::light::{Light, Lights};
use crate::{Camera, Material, Scene, SceneError};
use gonio_env::Environment;
use gonio_num::{Affine3, Vec3};
use std::collections::HashSet;
use std::sync::Arc;

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
    groups: LightGroups,
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
        for warning in material.warnings() {
            self.warn(warning);
        }
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

    /// Puts copies of the instances from index `first` on in their place: one of each for every placement, applied after the
    /// instance's own transform.
    pub(crate) fn replicate(&mut self, first: usize, placements: &[Affine3<f64>]) {
        let originals = self.instances.split_off(first);
        for placement in placements {
            for instance in &originals {
                let to_world = instance.to_world.to_f64().then(placement).to_f32();
                self.instance(instance.shape, to_world, instance.material);
            }
        }
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

    /// As [`SceneBuilder::light`], in a group of lights, whose light a picture tells apart.
    pub fn light_in(&mut self, light: Light, group: impl Into<String>) {
        if let Light::Environment(_) = light {
            self.environment_group(group);
        } else if light.is_delta() {
            self.groups.punctual.resize(self.lights.len(), None);
            self.groups.punctual.push(Some(group.into()));
        }
        self.light(light);
    }

    /// Puts the environment into a group of lights, this one and any that takes its place.
    pub fn environment_group(&mut self, group: impl Into<String>) {
        self.groups.environment = Some(group.into());
    }

    /// Puts the instances from index `first` on, those of them that shine, into a group of lights, whichever their materials' are.
    pub fn group_from(&mut self, first: usize, group: impl Into<String>) {
        let instances = first as u32..self.instances.len() as u32;
        self.groups.instances.push((instances, group.into()));
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
        self.groups.check(&self.materials)?;
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
        self.warn_of_groups_without_lights();
        let transparent = self
            .instances
            .iter()
            .any(|i| !self.materials[i.material as usize].opacity.is_opaque());
        let absorbing = self.materials.iter().any(Material::absorbs);
        self.warn_of_bodies_turned_inside_out();
        let geometry = Arc::new(Geometry::build(self.shapes, self.instances)?);
        match geometry.degenerate_count() {
            0 => {}
            1 => self
                .warnings
                .push("one degenerate triangle, without area, is left out".into()),
            n => self.warnings.push(format!(
                "{n} degenerate triangles, without area, are left out"
            )),
        }
        let lights = Lights::new(
            geometry.clone(),
            &self.materials,
            self.lights,
            self.environment,
            self.groups,
        );
        let mut scene = Scene {
            name: self.name,
            geometry,
            materials: self.materials,
            lights,
            cameras: self.cameras,
            film_size: self.film_size,
            warnings: self.warnings,
            transparent,
            absorbing,
        };
        scene.review_lights();
        Ok(scene)
    }

    fn warn_of_groups_without_lights(&mut self) {
        for (instances, name) in self.groups.instances.clone() {
            let range = instances.start as usize..instances.end as usize;
            if self.instances[range].iter().all(|i| i.area_light.is_none()) {
                self.warn(format!(
                    "a shape of the group of lights `{name}` doesn't shine: its material emits nothing"
                ));
            }
        }
    }

    /// A body of glass whose mesh is wound the other way round bends light the wrong way and absorbs outside of itself.
    fn warn_of_bodies_turned_inside_out(&mut self) {
        let mut seen = HashSet::new();
        for index in 0..self.instances.len() {
            let instance = &self.instances[index];
            if !seen.insert((instance.shape, instance.material)) {
                continue;
            }
            let material = &self.materials[instance.material as usize];
            if material.is_boundary()
                && let Some(Shape::Mesh(mesh)) = self.shapes.get(instance.shape as usize)
                && mesh.check().is_ok()
                && mesh.is_inside_out()
            {
                self.warn(format!(
                    "a mesh of the transmitting material `{}` is turned inside out: its triangles face what they enclose, which is right \
                     for the wall of a cavity alone",
                    material.name
                ));
            }
        }
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
