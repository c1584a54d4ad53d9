//! [`Kept`]: which layers a film keeps sums for, beside those that every film has.

use crate::RenderError;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Layers that take room of their own in a film: 112 bytes a pixel for the position, 8 for the material, 56 for each share of the radiance, 384
/// for samples told apart by their brightness.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Kept {
    /// Where the camera's rays meet the first surface, world space.
    pub position: bool,
    /// What the surface in the middle of the pixel is made of.
    pub material: bool,
    /// Light after at most one reflection, passages through surfaces included: light that is seen itself, and what is seen by light that
    /// comes straight from its source.
    pub direct: bool,
    /// All other light: [`Kept::direct`] and this add up to the picture.
    pub indirect: bool,
    /// Shares of as many groups of lights, which add up to the picture; 0: they are not told apart.
    pub groups: u32,
    /// Samples told apart by their brightness, for the picture in which fireflies weigh less, [`Film::reweighted`](crate::Film::reweighted).
    #[serde(default)]
    pub reweighted: bool,
}

/// Sums of three numbers that a position takes: components that are positive and those that are negative.
pub(super) const OF_POSITION: usize = 2;

impl Kept {
    /// Nothing more than every film has.
    pub const NOTHING: Self = Self {
        position: false,
        material: false,
        direct: false,
        indirect: false,
        groups: 0,
        reweighted: false,
    };

    /// Shares of the radiance: the direct one, the indirect one, then one for each group.
    pub fn shares(&self) -> usize {
        usize::from(self.direct) + usize::from(self.indirect) + self.groups as usize
    }

    /// The places of the shares among them: of the direct one, the indirect one, and the first group.
    pub(crate) fn places(&self) -> (Option<usize>, Option<usize>, Option<usize>) {
        let (direct, indirect) = (usize::from(self.direct), usize::from(self.indirect));
        (
            self.direct.then_some(0),
            self.indirect.then_some(direct),
            (self.groups > 0).then_some(direct + indirect),
        )
    }

    /// Sums of three numbers in each pixel.
    pub(super) fn triples(&self) -> usize {
        self.first_share() + self.shares()
    }

    /// The place of the first share among the sums.
    pub(super) fn first_share(&self) -> usize {
        if self.position { OF_POSITION } else { 0 }
    }

    /// # Errors
    /// [`RenderError::Parameter`] if the lights of the scene are in another number of groups.
    pub(crate) fn check(&self, groups: usize) -> Result<(), RenderError> {
        if self.groups == 0 || self.groups as usize == groups {
            return Ok(());
        }
        Err(RenderError::Parameter {
            option: "layers",
            found: format!("{} groups of lights, of {groups}", self.groups),
            expected: "as many as the scene has, or none",
        })
    }
}

/// The names of the layers, with commas; `none` without.
impl fmt::Display for Kept {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let all = [
            (self.position, "position"),
            (self.material, "material"),
            (self.direct, "direct"),
            (self.indirect, "indirect"),
            (self.groups > 0, "groups"),
            (self.reweighted, "reweighted"),
        ];
        let names: Vec<&str> = (all.iter())
            .filter(|(kept, _)| *kept)
            .map(|(_, name)| *name)
            .collect();
        match names.is_empty() {
            true => f.write_str("none"),
            false => f.write_str(&names.join(", ")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_follow_one_another() {
        let all = Kept {
            position: true,
            material: true,
            direct: true,
            indirect: true,
            groups: 3,
            reweighted: true,
        };
        assert_eq!(all.places(), (Some(0), Some(1), Some(2)));
        assert_eq!((all.shares(), all.triples()), (5, 7));
        assert_eq!(
            all.to_string(),
            "position, material, direct, indirect, groups, reweighted"
        );
        let some = Kept {
            indirect: true,
            groups: 1,
            ..Kept::NOTHING
        };
        assert_eq!(some.places(), (None, Some(0), Some(1)));
        assert_eq!((some.shares(), some.triples()), (2, 2));
        assert_eq!(Kept::NOTHING.places(), (None, None, None));
        assert_eq!(
            (Kept::NOTHING.triples(), Kept::NOTHING.to_string()),
            (0, "none".into())
        );
    }

    #[test]
    fn groups_are_those_of_the_scene() {
        let two = Kept {
            groups: 2,
            ..Kept::NOTHING
        };
        assert!(two.check(2).is_ok() && Kept::NOTHING.check(2).is_ok());
        assert!(matches!(two.check(3), Err(RenderError::Parameter { .. })));
    }
}
