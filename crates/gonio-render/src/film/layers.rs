//! The layers of a film for an EXR file.

use super::kept::{Kept, OF_POSITION};
use super::{Film, PixelSums};
use gonio_image::{Channel, ChannelData, Chromaticities, Image, Layers};

/// What the indices in a film are names of.
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Names {
    /// Of the materials.
    pub materials: Vec<String>,
    /// Of the groups of lights.
    pub groups: Vec<String>,
}

impl Names {
    /// Those of a scene.
    pub fn of(scene: &gonio_scene::Scene) -> Self {
        Self {
            materials: scene.materials.iter().map(|m| m.name.clone()).collect(),
            groups: scene.lights.groups().to_vec(),
        }
    }

    /// The layer of a group of lights: `group.key`; by its number where it has no name.
    pub fn layer_of_group(&self, group: usize) -> String {
        match self.groups.get(group) {
            Some(name) => format!("group.{name}"),
            None => format!("group.{group}"),
        }
    }
}

impl Film {
    /// All layers for an EXR file: R G B, `albedo`, `normal`, `depth.Z`, `variance` and `samples.count`, and those that were asked for:
    /// `position`, `material.index`, `direct`, `indirect`, one for each group of lights, and `reweighted`.
    ///
    /// Depth and position are means over the samples that hit a surface, ∞ and 0 where none did; the normal is the unnormalised mean; the
    /// variance is that of the mean; the index of the material is counted from 1, and 0 where the pixel's middle shows no surface.
    pub fn layers(&self, names: &Names, metadata: Vec<(String, String)>) -> Layers {
        let mut channels = Vec::new();
        let mut float = |name: String, value: &dyn Fn(&PixelSums) -> f32| {
            channels.push(Channel {
                name,
                samples: ChannelData::Float(self.pixels.iter().map(value).collect()),
            });
        };
        for (c, name) in ["R", "G", "B"].into_iter().enumerate() {
            float(name.into(), &|p| p.mean()[c] as f32);
            float(format!("albedo.{name}"), &|p| p.albedo()[c]);
            float(format!("variance.{name}"), &|p| {
                p.variance_of_mean()[c] as f32
            });
        }
        for (c, name) in ["X", "Y", "Z"].into_iter().enumerate() {
            float(format!("normal.{name}"), &|p| p.normal()[c]);
        }
        float("depth.Z".into(), &PixelSums::depth);
        channels.push(Channel {
            name: "samples.count".into(),
            samples: ChannelData::Uint(self.pixels.iter().map(|p| p.samples).collect()),
        });
        self.push_kept(names, &mut channels);
        Layers {
            channels,
            metadata,
            chromaticities: Some(Chromaticities::REC709),
            ..Layers::new(self.width as usize, self.height as usize)
        }
    }

    fn push_kept(&self, names: &Names, channels: &mut Vec<Channel>) {
        let kept = self.kept;
        if kept.position {
            let hits = |p: &PixelSums| f64::from(p.hits.max(1));
            for (c, name) in ["X", "Y", "Z"].into_iter().enumerate() {
                let mean = |i: usize| {
                    let [positive, negative] = self.position_sums(i);
                    ((positive[c] - negative[c]) / hits(&self.pixels[i])) as f32
                };
                channels.push(self.channel(format!("position.{name}"), &mean));
            }
        }
        if kept.material {
            channels.push(Channel {
                name: "material.index".into(),
                samples: ChannelData::Uint(self.nearest.iter().map(|n| n.material).collect()),
            });
        }
        if let Some(image) = self.reweighted() {
            channels.extend(picture("reweighted", &image));
        }
        for (share, layer) in names_of_shares(&kept, names).into_iter().enumerate() {
            for (c, name) in ["R", "G", "B"].into_iter().enumerate() {
                let mean = |i: usize| self.share(i, share)[c] as f32;
                channels.push(self.channel(format!("{layer}.{name}"), &mean));
            }
        }
    }

    fn channel(&self, name: String, value: &dyn Fn(usize) -> f32) -> Channel {
        Channel {
            name,
            samples: ChannelData::Float((0..self.pixels.len()).map(value).collect()),
        }
    }

    /// Mean of a share of the radiance of pixel `i`, in the order of [`Kept::shares`].
    fn share(&self, i: usize, share: usize) -> [f64; 3] {
        let at = i * self.kept.triples() + self.kept.first_share() + share;
        let n = f64::from(self.pixels[i].samples.max(1));
        self.triples[at].value().map(|sum| sum / n)
    }

    fn position_sums(&self, i: usize) -> [[f64; 3]; OF_POSITION] {
        let at = i * self.kept.triples();
        [0, 1].map(|k| self.triples[at + k].value())
    }
}

/// The channels `R`, `G` and `B` of a layer that is a picture.
pub fn picture<'a>(layer: &'a str, image: &'a Image) -> impl Iterator<Item = Channel> + 'a {
    (["R", "G", "B"].into_iter().enumerate()).map(move |(c, name)| Channel {
        name: format!("{layer}.{name}"),
        samples: ChannelData::Float(image.pixels.iter().map(|p| p[c]).collect()),
    })
}

/// The layers of the shares, in their order.
fn names_of_shares(kept: &Kept, names: &Names) -> Vec<String> {
    let mut all = Vec::with_capacity(kept.shares());
    if kept.direct {
        all.push("direct".into());
    }
    if kept.indirect {
        all.push("indirect".into());
    }
    all.extend((0..kept.groups as usize).map(|group| names.layer_of_group(group)));
    all
}
