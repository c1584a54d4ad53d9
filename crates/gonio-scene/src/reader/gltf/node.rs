//! The node hierarchy: meshes placed in the world, cameras and lights.

use super::Reader;
use super::group::light_group;
use crate::SceneError;
use crate::camera::{Camera, Projection};
use crate::light::{Light, SpotCone};
use gltf::json::accessor::Type;
use gltf::json::camera::Type as CameraType;
use gltf::json::extensions::scene::khr_lights_punctual::Type as LightType;
use gltf::json::scene::Node;
use gonio_num::{Affine3, Vec3};

impl Reader<'_, '_> {
    /// Walks the nodes of a scene: the given one, the default one, the first, or without any scene all root nodes.
    pub(super) fn scene(&mut self, choice: Option<usize>) -> Result<(), SceneError> {
        let root = self.arrays.root;
        let chosen = choice.or(root.scene.map(|s| s.value()));
        let roots: Vec<usize> = match chosen.or((!root.scenes.is_empty()).then_some(0)) {
            Some(index) => {
                let scene = root.scenes.get(index);
                let scene = scene.ok_or_else(|| {
                    self.arrays
                        .missing(&format!("scene {index}"), root.scenes.len())
                })?;
                if let Some(name) = scene.name.as_ref().filter(|n| !n.is_empty())
                    && !self.placement.object_only
                {
                    self.builder.rename(name.as_str());
                }
                if choice.is_none() && root.scenes.len() > 1 {
                    let message = format!(
                        "the file has {} scenes, scene {index} is used",
                        root.scenes.len()
                    );
                    self.builder.warn(message);
                }
                scene.nodes.iter().map(|n| n.value()).collect()
            }
            None => {
                let children = root.nodes.iter().flat_map(|n| n.children.iter().flatten());
                let mut is_child = vec![false; root.nodes.len()];
                for child in children {
                    if let Some(slot) = is_child.get_mut(child.value()) {
                        *slot = true;
                    }
                }
                (0..root.nodes.len()).filter(|&i| !is_child[i]).collect()
            }
        };
        let mut visited = vec![false; root.nodes.len()];
        let outer = self.placement.to_world;
        let mut open: Vec<(usize, Affine3<f64>)> =
            roots.into_iter().rev().map(|i| (i, outer)).collect();
        while let Some((index, parent)) = open.pop() {
            let place = format!("node {index}");
            let node = root
                .nodes
                .get(index)
                .ok_or_else(|| self.arrays.missing(&place, root.nodes.len()))?;
            if std::mem::replace(&mut visited[index], true) {
                let found = "a node that is reached twice";
                return Err(SceneError::format(
                    self.arrays.path,
                    place,
                    found,
                    "a tree of nodes",
                ));
            }
            let to_world = self.transform(node, &place)?.then(&parent);
            self.node(node, &place, &to_world)?;
            let children = node.children.iter().flatten().rev();
            open.extend(children.map(|child| (child.value(), to_world)));
        }
        Ok(())
    }

    /// What a node itself holds.
    fn node(
        &mut self,
        node: &Node,
        place: &str,
        to_world: &Affine3<f64>,
    ) -> Result<(), SceneError> {
        let group = light_group(&node.extras, place, &mut |w| self.builder.warn(w));
        if let Some(mesh) = node.mesh {
            let first = self.builder.instance_count();
            let parts = self.mesh(mesh.value())?;
            for instance in self.instances(node, place)? {
                let placed = instance.then(to_world);
                // Viewers hide things by scaling them to nothing.
                if placed.inverse().is_none() {
                    self.builder
                        .warn(format!("{place}: its transform flattens the mesh, skipped"));
                    continue;
                }
                for &(shape, material) in &parts {
                    if self.builder.instance_count() >= self.max_instances {
                        return Err(SceneError::Limit {
                            path: self.arrays.path.to_owned(),
                            place: place.into(),
                            found: "one more instance".into(),
                            limit: format!("{} instances", self.max_instances),
                        });
                    }
                    self.builder.instance(shape, placed.to_f32(), material);
                }
            }
            if let Some(group) = &group {
                self.builder.group_from(first, group.as_str());
            }
        }
        if self.placement.object_only {
            return Ok(());
        }
        if let Some(camera) = node.camera {
            self.camera(node, camera.value(), place, &to_world.to_f32())?;
        }
        let light = node
            .extensions
            .as_ref()
            .and_then(|e| e.khr_lights_punctual.as_ref());
        if let Some(light) = light {
            self.light(light.light.value(), place, to_world, group)?;
        }
        Ok(())
    }

    /// Local transform of a node.
    fn transform(&self, node: &Node, place: &str) -> Result<Affine3<f64>, SceneError> {
        let m = match &node.matrix {
            Some(m) => {
                let column = |k: usize| Vec3::new(m[4 * k], m[4 * k + 1], m[4 * k + 2]).to_f64();
                Affine3::from_columns(column(0), column(1), column(2), column(3))
            }
            None => placed(
                node.translation.unwrap_or([0.0; 3]),
                node.rotation.map_or([0.0, 0.0, 0.0, 1.0], |q| q.0),
                node.scale.unwrap_or([1.0; 3]),
            ),
        };
        if [m.x, m.y, m.z, m.origin].iter().all(|v| v.is_finite()) {
            return Ok(m);
        }
        Err(SceneError::format(
            self.arrays.path,
            place,
            "a transform that isn't finite",
            "finite numbers",
        ))
    }

    /// The copies that EXT_mesh_gpu_instancing makes of a node's mesh, in the node's coordinates; without it, one.
    fn instances(&self, node: &Node, place: &str) -> Result<Vec<Affine3<f64>>, SceneError> {
        let extension = node
            .extensions
            .as_ref()
            .and_then(|e| e.others.get("EXT_mesh_gpu_instancing"));
        let Some(attributes) = extension.map(|e| &e["attributes"]) else {
            return Ok(vec![Affine3::identity()]);
        };
        let accessor = |name: &str| attributes[name].as_u64().map(|i| i as usize);
        let translation: Option<Vec<[f32; 3]>> = accessor("TRANSLATION")
            .map(|a| self.arrays.rows(a, &[Type::Vec3], 0.0))
            .transpose()?;
        let rotation: Option<Vec<[f32; 4]>> = accessor("ROTATION")
            .map(|a| self.arrays.rows(a, &[Type::Vec4], 1.0))
            .transpose()?;
        let scale: Option<Vec<[f32; 3]>> = accessor("SCALE")
            .map(|a| self.arrays.rows(a, &[Type::Vec3], 1.0))
            .transpose()?;
        let counts = [
            translation.as_ref().map(Vec::len),
            rotation.as_ref().map(Vec::len),
            scale.as_ref().map(Vec::len),
        ];
        let count = counts.into_iter().flatten().max().unwrap_or(0);
        if counts.into_iter().flatten().any(|n| n != count) {
            let found =
                format!("EXT_mesh_gpu_instancing attributes of different lengths {counts:?}");
            return Err(SceneError::format(
                self.arrays.path,
                place,
                found,
                "the same number of each",
            ));
        }
        let copies = (0..count).map(|i| {
            placed(
                translation.as_ref().map_or([0.0; 3], |t| t[i]),
                rotation.as_ref().map_or([0.0, 0.0, 0.0, 1.0], |r| r[i]),
                scale.as_ref().map_or([1.0; 3], |s| s[i]),
            )
        });
        Ok(copies.collect())
    }

    fn camera(
        &mut self,
        node: &Node,
        index: usize,
        place: &str,
        to_world: &Affine3<f32>,
    ) -> Result<(), SceneError> {
        let root = self.arrays.root;
        let place = format!("{place}, camera {index}");
        let camera = root
            .cameras
            .get(index)
            .ok_or_else(|| self.arrays.missing(&place, root.cameras.len()))?;
        let kind = self.arrays.checked(&camera.type_, &place, "type")?;
        let (projection, aspect) = match (kind, &camera.perspective, &camera.orthographic) {
            (CameraType::Perspective, Some(p), _) => {
                (Projection::Pinhole { fov_y_rad: p.yfov }, p.aspect_ratio)
            }
            (CameraType::Orthographic, _, Some(o)) => (
                Projection::Orthographic {
                    half_height: o.ymag.abs(),
                },
                Some((o.xmag / o.ymag).abs()),
            ),
            _ => {
                let found = format!("type {kind:?} without its properties");
                return Err(SceneError::format(
                    self.arrays.path,
                    place,
                    found,
                    "perspective or orthographic",
                ));
            }
        };
        let name = camera.name.as_ref().or(node.name.as_ref()).cloned();
        let name = name.unwrap_or_else(|| format!("camera {index}"));
        let mut made = Camera::new(name, to_world, projection).map_err(|e| match e {
            SceneError::Parameter {
                name,
                found,
                expected,
            } => SceneError::format(
                self.arrays.path,
                format!("{place}, {name}"),
                found,
                expected,
            ),
            other => other,
        })?;
        made.aspect = aspect.filter(|a| a.is_finite() && *a > 0.0);
        self.builder.camera(made);
        Ok(())
    }

    fn light(
        &mut self,
        index: usize,
        place: &str,
        to_world: &Affine3<f64>,
        group: Option<String>,
    ) -> Result<(), SceneError> {
        let path = self.arrays.path;
        let place = format!("{place}, light {index}");
        let extension = self
            .arrays
            .root
            .extensions
            .as_ref()
            .and_then(|e| e.khr_lights_punctual.as_ref());
        let lights = extension.map_or(&[][..], |e| e.lights.as_slice());
        let light = lights
            .get(index)
            .ok_or_else(|| self.arrays.missing(&place, lights.len()))?;
        let colour = light.color.map(|c| c * light.intensity);
        if !colour.iter().all(|c| c.is_finite() && *c >= 0.0) {
            let found = format!("color × intensity = {colour:?}");
            return Err(SceneError::format(path, place, found, "finite numbers ≥ 0"));
        }
        let position = to_world.origin.to_f32();
        let axis = -to_world.z;
        let direction = axis.normalize();
        let kind = self.arrays.checked(&light.type_, &place, "type")?;
        if kind != LightType::Point && !direction.is_finite() {
            return Err(SceneError::format(
                path,
                place,
                "a transform without a z axis",
                "a direction",
            ));
        }
        let direction = direction.to_f32();
        let made = match kind {
            LightType::Point => Light::Point {
                position,
                intensity: colour,
            },
            LightType::Directional => Light::Directional {
                direction,
                irradiance: colour,
            },
            LightType::Spot => {
                let angles = light
                    .spot
                    .as_ref()
                    .map(|s| (s.inner_cone_angle, s.outer_cone_angle));
                let cone = angles.and_then(|(inner, outer)| SpotCone::new(inner, outer));
                let cone = cone.ok_or_else(|| {
                    let found = format!("cone angles {angles:?} rad");
                    SceneError::format(
                        path,
                        place.as_str(),
                        found,
                        "0 ≤ innerConeAngle ≤ outerConeAngle ≤ π/2",
                    )
                })?;
                Light::Spot {
                    position,
                    direction,
                    intensity: colour,
                    cone,
                }
            }
        };
        let own = || light_group(&light.extras, &place, &mut |w| self.builder.warn(w));
        match group.or_else(own) {
            Some(group) => self.builder.light_in(made, group),
            None => self.builder.light(made),
        }
        self.builder.warn(
            "KHR_lights_punctual gives photometric values (cd, lx): their numbers are kept, so that 1 cd renders as 1 W sr⁻¹ \
             and 1 lx as 1 W m⁻²",
        );
        if light.range.is_some() {
            self.builder.warn("the range of KHR_lights_punctual lights is ignored: light falls off as 1/r² for ever");
        }
        Ok(())
    }
}

/// Scale, then rotation by a quaternion (x, y, z, w), then translation. The quaternion is normalised; zero is no rotation.
fn placed(translation: [f32; 3], rotation: [f32; 4], scale: [f32; 3]) -> Affine3<f64> {
    let [x, y, z, w] = rotation.map(f64::from);
    let norm2 = x * x + y * y + z * z + w * w;
    let s = if norm2 > 0.0 { 2.0 / norm2 } else { 0.0 };
    let [sx, sy, sz] = scale.map(f64::from);
    Affine3::from_columns(
        Vec3::new(
            1.0 - s * (y * y + z * z),
            s * (x * y + w * z),
            s * (x * z - w * y),
        ) * sx,
        Vec3::new(
            s * (x * y - w * z),
            1.0 - s * (x * x + z * z),
            s * (y * z + w * x),
        ) * sy,
        Vec3::new(
            s * (x * z + w * y),
            s * (y * z - w * x),
            1.0 - s * (x * x + y * y),
        ) * sz,
        Vec3::from(translation).to_f64(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A quarter turn about +y takes +x to −z; scale comes before it.
    #[test]
    fn quaternions_turn_after_scale_and_before_translation() {
        let h = std::f32::consts::FRAC_1_SQRT_2;
        let m = placed([10.0, 0.0, 0.0], [0.0, h, 0.0, h], [2.0, 3.0, 1.0]);
        let p = m.transform_point(Vec3::new(1.0, 1.0, 0.0));
        assert!((p - Vec3::new(10.0, 3.0, -2.0)).length() < 1e-6, "{p:?}");
        let still = placed([0.0; 3], [0.0; 4], [1.0; 3]);
        assert_eq!(still, Affine3::identity());
    }
}
