//! [`Double`], numbers of double precision with their single-precision counterpart: one number, or one in each lane.

use gonio_num::lanes::Lanes;
use gonio_num::{DoubleLanes, Real, Vec3};

/// A number of double precision. Angles may go through single precision, whose sines and cosines have lanes.
pub(crate) trait Double: Real {
    /// The same in single precision.
    type Single: Real<Mask = Self::Mask>;
    /// Exactly.
    fn of(x: Self::Single) -> Self;
    /// Rounded.
    fn single(self) -> Self::Single;

    #[inline(always)]
    fn of_vector(v: Vec3<Self::Single>) -> Vec3<Self> {
        Vec3::new(Self::of(v.x), Self::of(v.y), Self::of(v.z))
    }

    #[inline(always)]
    fn single_vector(v: Vec3<Self>) -> Vec3<Self::Single> {
        Vec3::new(v.x.single(), v.y.single(), v.z.single())
    }
}

impl Double for f64 {
    type Single = f32;
    #[inline(always)]
    fn of(x: f32) -> f64 {
        x.into()
    }
    #[inline(always)]
    fn single(self) -> f32 {
        self as f32
    }
}

impl<const L: usize> Double for DoubleLanes<L> {
    type Single = Lanes<L>;
    #[inline(always)]
    fn of(x: Lanes<L>) -> Self {
        x.to_double()
    }
    #[inline(always)]
    fn single(self) -> Lanes<L> {
        self.to_single()
    }
}
