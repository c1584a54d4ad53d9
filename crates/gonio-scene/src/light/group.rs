//! [`LightGroups`]: lights by the names that they are told apart by in a picture.

use crate::{Material, SceneError};
use std::ops::Range;

/// The group of lights that are in no other.
pub const NO_GROUP: &str = "default";

/// The longest name of a group, in bytes: it becomes a part of the names of channels.
const LONGEST: usize = 64;

/// Which lights belong together, as a scene says it.
#[derive(Debug, Clone, Default)]
pub(crate) struct LightGroups {
    /// Of the point, spot and directional lights, in their order; missing at the end: none.
    pub punctual: Vec<Option<String>>,
    /// Of instances whose materials shine; the last one that has an instance counts, and each counts before the material's.
    pub instances: Vec<(Range<u32>, String)>,
    pub environment: Option<String>,
}

/// The groups of the lights of a scene.
#[derive(Debug, Clone, Default)]
pub(super) struct Grouped {
    /// Each once, in the order of the lights.
    pub names: Vec<String>,
    /// The place among them of each light's.
    pub of: Vec<u32>,
}

impl Grouped {
    /// - `groups`: that of each light, if it is in one
    pub fn new<'a>(groups: impl Iterator<Item = Option<&'a str>>) -> Self {
        let mut all = Self::default();
        let mut known = std::collections::HashMap::new();
        for group in groups {
            let name = group.unwrap_or(NO_GROUP);
            let index = *known.entry(name).or_insert_with(|| {
                all.names.push(name.to_owned());
                all.names.len() as u32 - 1
            });
            all.of.push(index);
        }
        all
    }
}

impl LightGroups {
    /// # Errors
    /// [`SceneError::Parameter`] for a name that can be no part of a channel's.
    pub fn check(&self, materials: &[Material]) -> Result<(), SceneError> {
        let instances = self.instances.iter().map(|(_, name)| name);
        let others = self.punctual.iter().chain([&self.environment]).flatten();
        let of_materials = materials.iter().filter_map(|m| m.emission.group.as_ref());
        let mut all = instances.chain(others).chain(of_materials);
        match all.find(|name| !is_name(name)) {
            None => Ok(()),
            Some(name) => Err(SceneError::Parameter {
                name: "group of lights".into(),
                found: format!("{name:?}"),
                expected: NAMES.into(),
            }),
        }
    }
}

/// What names of groups are made of.
pub(crate) const NAMES: &str = "a name of letters, digits, - and _, of 64 bytes at most";

/// Whether a group can have this name: no sign that separates the names of layers and channels, or names and values.
pub(crate) fn is_name(name: &str) -> bool {
    let good = |c: char| c.is_alphanumeric() || c == '-' || c == '_';
    (1..=LONGEST).contains(&name.len()) && name.chars().all(good)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_are_numbered_in_their_order() {
        let all = Grouped::new([Some("key"), None, Some("rim"), Some("key"), None].into_iter());
        assert_eq!(all.names, ["key", "default", "rim"]);
        assert_eq!(all.of, [0, 1, 2, 0, 1]);
        assert!(Grouped::new(std::iter::empty()).names.is_empty());
    }

    #[test]
    fn names_fit_channels() {
        for name in ["key", "Fenster-süd", "a_1", &"x".repeat(64)] {
            assert!(is_name(name), "{name}");
        }
        for name in ["", "a.b", "a=b", "a b", "a/b", "\0", &"x".repeat(65)] {
            assert!(!is_name(name), "{name}");
        }
    }
}
