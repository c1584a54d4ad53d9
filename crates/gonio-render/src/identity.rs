//! [`Identity`], what decides the value of every sample.

use crate::RenderOptions;
use gonio_scene::Camera;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;

/// What decides the value of every sample of a picture: the program's version, the scene, the camera and the settings, each as a name and
/// a text.
///
/// Two films may be added if their identities are equal. The number of samples is no part of it, nor when to stop, unless that is decided pixel
/// by pixel.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Identity(BTreeMap<String, String>);

/// A property that two identities don't share.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mismatch {
    /// The name of the property, in words.
    pub what: String,
    /// The value of one, if it has the property.
    pub found: String,
    /// The value of the other.
    pub expected: String,
}

impl fmt::Display for Mismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            what,
            found,
            expected,
        } = self;
        let another = if what == LAYERS { "other" } else { "another" };
        write!(f, "{another} {what}: {found}, expected {expected}")
    }
}

/// The name of the scene's hash among the properties.
const SCENE: &str = "scene";
const VERSION: &str = "version";
const ADAPTIVE: &str = "adaptive";
const LAYERS: &str = "layers";

impl Identity {
    /// The identity of a picture of a scene, by this version.
    ///
    /// - `scene`: a hash of everything that the scene is made of, in hexadecimal digits; what `options` and `camera` say is added here
    pub fn new(scene: &str, camera: &Camera, options: &RenderOptions) -> Self {
        // Written out, so that a new option is not forgotten here.
        let RenderOptions {
            width,
            height,
            target,
            integrator,
            sampler,
            screen,
            filter,
            seed,
            keep,
        } = options;
        let Camera {
            name: _,
            to_world,
            projection,
            aspect: _,
        } = camera;
        // The shortest text that reads back as the same number: as good as its bits.
        let properties = [
            (VERSION, format!("gonio {}", env!("CARGO_PKG_VERSION"))),
            (SCENE, scene.to_owned()),
            ("size", format!("{width}x{height}")),
            ("camera", format!("{projection:?} at {to_world:?}")),
            ("integrator", format!("{integrator:?}")),
            ("sampler", format!("{sampler:?}")),
            ("filter", filter.name().to_owned()),
            ("seed", seed.to_string()),
            (LAYERS, keep.to_string()),
        ];
        let mut all = BTreeMap::from(properties.map(|(k, v)| (k.to_owned(), v)));
        if !screen.is_independent() {
            all.insert("screen".to_owned(), format!("{screen:?}"));
        }
        // What a pixel is judged by decides which samples it has.
        if target.adaptive {
            let goal = match target.noise {
                Some(noise) => format!("to a noise of {noise}"),
                None => format!("{} samples in the mean", target.samples),
            };
            all.insert(ADAPTIVE.to_owned(), goal);
        }
        Self(all)
    }

    /// The properties, sorted by name.
    pub fn properties(&self) -> impl Iterator<Item = (&str, &str)> {
        self.0.iter().map(|(k, v)| (k.as_str(), v.as_str()))
    }

    /// The value of a property: `version`, `scene`, `size`, `camera`, `integrator`, `sampler`, `filter`, `seed`, `layers`, and `adaptive` and
    /// `screen` where pixels aren't sampled one like the other and each by itself; nothing if there is none of this name.
    pub fn get(&self, name: &str) -> Option<&str> {
        self.0.get(name).map(String::as_str)
    }

    /// The first property in which `self` is not what is `expected`: the version before the scene, the scene before the others.
    pub fn mismatch(&self, expected: &Self) -> Option<Mismatch> {
        let names = [VERSION, SCENE].into_iter();
        let all = names.chain(expected.0.keys().chain(self.0.keys()).map(String::as_str));
        let text = |of: &Self, name: &str| of.get(name).unwrap_or("none").to_owned();
        for name in all {
            if self.get(name) != expected.get(name) {
                return Some(Mismatch {
                    what: name.to_owned(),
                    found: text(self, name),
                    expected: text(expected, name),
                });
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Target;
    use crate::integrator::{LightChoice, Path};
    use gonio_num::Vec3;

    fn camera(height: f32) -> Camera {
        let at = |y| Vec3::new(0.0, y, 5.0);
        Camera::look_at(at(height), at(0.0), Vec3::new(0.0, 0.0, 1.0), 40.0).unwrap()
    }

    #[test]
    fn what_differs_is_named() {
        let options = RenderOptions::default();
        let own = Identity::new("ab", &camera(2.0), &options);
        let longer = RenderOptions {
            target: Target {
                samples: 1 << 20,
                ..options.target
            },
            ..options
        };
        assert_eq!(own.mismatch(&own), None);
        assert_eq!(Identity::new("ab", &camera(2.0), &longer), own);
        let other = |scene, height, options: &RenderOptions| {
            let other = Identity::new(scene, &camera(height), options);
            own.mismatch(&other).map(|m| m.what)
        };
        let reseeded = RenderOptions { seed: 1, ..options };
        let smaller = RenderOptions {
            width: 64,
            ..options
        };
        let adaptive = |noise| RenderOptions {
            target: Target {
                noise: Some(noise),
                adaptive: true,
                ..options.target
            },
            ..options
        };
        assert_eq!(
            other("ab", 2.0, &adaptive(0.1)).as_deref(),
            Some("adaptive")
        );
        let mean = |samples| RenderOptions {
            target: Target {
                samples,
                adaptive: true,
                ..options.target
            },
            ..options
        };
        assert_eq!(other("ab", 2.0, &mean(64)).as_deref(), Some("adaptive"));
        let few = Identity::new("ab", &camera(2.0), &mean(32));
        let many = Identity::new("ab", &camera(2.0), &mean(64));
        assert_eq!(
            few.mismatch(&many).map(|m| m.what).as_deref(),
            Some("adaptive")
        );
        let coarse = Identity::new("ab", &camera(2.0), &adaptive(0.1));
        let fine = Identity::new("ab", &camera(2.0), &adaptive(0.05));
        assert_eq!(
            coarse.mismatch(&fine).map(|m| m.what).as_deref(),
            Some("adaptive")
        );
        for light_choice in [LightChoice::Power, LightChoice::Uniform] {
            let path = Path {
                light_choice,
                ..Path::default()
            };
            let options = RenderOptions {
                integrator: crate::Integrator::Path(path),
                ..options
            };
            assert_eq!(other("ab", 2.0, &options).as_deref(), Some("integrator"));
        }
        let direct = RenderOptions {
            integrator: crate::Integrator::Direct(crate::integrator::Direct::default()),
            ..options
        };
        assert_eq!(other("cd", 3.0, &reseeded).as_deref(), Some("scene"));
        assert_eq!(other("ab", 3.0, &options).as_deref(), Some("camera"));
        assert_eq!(other("ab", 2.0, &reseeded).as_deref(), Some("seed"));
        assert_eq!(other("ab", 2.0, &smaller).as_deref(), Some("size"));
        assert_eq!(other("ab", 2.0, &direct).as_deref(), Some("integrator"));
        let mut older = own.clone();
        older.0.insert("version".into(), "gonio 0.0.1".into());
        let found = older.mismatch(&own).map(|m| m.to_string()).unwrap();
        assert!(
            found.starts_with("another version: gonio 0.0.1, expected gonio "),
            "{found}"
        );
    }
}
