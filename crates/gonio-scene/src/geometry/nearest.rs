//! [`Nearest`], the best hit so far.

use super::Hit;

/// The best hit so far, or none yet.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Nearest {
    /// Its t, or the ray's end.
    pub(crate) t: f32,
    instance: u32,
    primitive: u32,
    u: f32,
    v: f32,
    found: bool,
}

impl Nearest {
    #[inline(always)]
    pub(crate) fn none(t_max: f32) -> Self {
        Self {
            t: t_max,
            instance: 0,
            primitive: 0,
            u: 0.0,
            v: 0.0,
            found: false,
        }
    }

    /// The best one so far is `hit`; none if that is infinitely far away.
    #[inline(always)]
    pub(crate) fn of(hit: &Hit) -> Self {
        Self {
            t: hit.t,
            instance: hit.instance,
            primitive: hit.primitive,
            u: hit.u,
            v: hit.v,
            found: hit.t < f32::INFINITY,
        }
    }

    /// Whether there is any.
    #[inline(always)]
    pub(crate) fn found(&self) -> bool {
        self.found
    }

    /// Takes a hit if it is nearer, or as near with a lower (instance, primitive). A NaN is never taken.
    #[inline(always)]
    pub(crate) fn offer(&mut self, t: f32, instance: u32, primitive: u32, u: f32, v: f32) -> bool {
        let tie =
            t == self.t && self.found && (instance, primitive) < (self.instance, self.primitive);
        if t < self.t || tie {
            *self = Self {
                t,
                instance,
                primitive,
                u,
                v,
                found: true,
            };
            return true;
        }
        false
    }

    #[inline(always)]
    pub(crate) fn hit(&self) -> Option<Hit> {
        self.found.then_some(Hit {
            t: self.t,
            instance: self.instance,
            primitive: self.primitive,
            u: self.u,
            v: self.v,
        })
    }
}
