//! Groups of lights: glTF has none, so they stand among the extras, where Blender puts custom properties.

use crate::light::group;
use gltf::json::extras::Extras;

/// The property that names the group of lights that a node, a light or a material is in.
const PROPERTY: &str = "light_group";

/// The group that `extras` names; a warning if that can be none.
pub(super) fn light_group(
    extras: &Extras,
    place: &str,
    warn: &mut dyn FnMut(String),
) -> Option<String> {
    let values: serde_json::Map<String, serde_json::Value> =
        serde_json::from_str(extras.as_ref()?.get()).ok()?;
    let value = values.get(PROPERTY)?;
    match value.as_str() {
        Some(name) if group::is_name(name) => Some(name.to_owned()),
        _ => {
            warn(format!(
                "{place}: the extra property {PROPERTY} is {value}, expected {}: ignored",
                group::NAMES
            ));
            None
        }
    }
}
