//! [`Shares`]: the radiance of a sample, told apart by the way and the source of the light.

use crate::film::Kept;
use gonio_scene::Lights;

/// Which share light belongs to, for the layers that a film keeps.
#[derive(Debug)]
pub(crate) struct Split {
    count: usize,
    direct: Option<usize>,
    indirect: Option<usize>,
    /// The share of each light's group; empty where groups are not told apart.
    of_light: Vec<usize>,
}

/// Nothing is told apart.
pub(crate) static WHOLE: Split = Split {
    count: 0,
    direct: None,
    indirect: None,
    of_light: Vec::new(),
};

impl Split {
    /// - `kept`: has as many groups as the lights, or none
    pub fn new(kept: &Kept, lights: &Lights) -> Self {
        let (direct, indirect, first_group) = kept.places();
        let of_light = first_group.map_or(Vec::new(), |first| {
            let all = (0..lights.len() as u32).map_while(|light| lights.group(light));
            all.map(|group| first + group as usize).collect()
        });
        Self {
            count: kept.shares(),
            direct,
            indirect,
            of_light,
        }
    }

    /// Shares of a sample.
    pub fn count(&self) -> usize {
        self.count
    }
}

/// The shares of one sample, as they come together.
pub(crate) struct Shares<'a> {
    pub split: &'a Split,
    /// As many as [`Split::count`]; black at first.
    pub values: &'a mut [[f32; 3]],
}

impl Shares<'_> {
    /// Of a sample that is not told apart.
    pub fn none() -> Self {
        Self {
            split: &WHOLE,
            values: &mut [],
        }
    }

    /// Adds light.
    ///
    /// - `light`: the index of the light that it comes from
    /// - `reflections`: how many it has made, passages through surfaces included
    #[inline]
    pub fn add(&mut self, light: Option<u32>, reflections: u32, radiance: [f32; 3]) {
        if self.values.is_empty() {
            return;
        }
        let way = match reflections {
            0 | 1 => self.split.direct,
            _ => self.split.indirect,
        };
        let group = light.and_then(|light| self.split.of_light.get(light as usize).copied());
        for share in [way, group].into_iter().flatten() {
            self.values[share] = super::sum(self.values[share], radiance);
        }
    }

    /// Multiplies all of them.
    pub fn attenuate(&mut self, left: [f32; 3]) {
        for share in self.values.iter_mut() {
            *share = super::product(left, *share);
        }
    }
}
