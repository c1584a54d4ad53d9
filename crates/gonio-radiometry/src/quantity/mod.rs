//! Quantities as types: a wrong product doesn't compile (T2, T5–T7).
//!
//! A [`Quantity`] is a number with a [`Kind`], a type that stands for what is measured and in which unit. The laws of
//! radiometry are the products between kinds, listed in one table in [`kind`]:
//!
//! ```
//! use gonio_radiometry::quantity::*;
//! let radiance = Radiance::new(2.0); // W m⁻² sr⁻¹
//! let irradiance: Irradiance = radiance * ProjectedSolidAngle::hemisphere();
//! assert_eq!(irradiance.to_string(), "6.283185307179586 W/m²");
//! let flux: RadiantFlux = irradiance * Area::new(0.5);
//! assert_eq!(flux.value(), std::f64::consts::PI);
//! ```
//!
//! Radiance times a *plain* solid angle is a forgotten cosine. It has the dimension of irradiance, but isn't one:
//!
//! ```compile_fail
//! use gonio_radiometry::quantity::*;
//! let wrong = Radiance::new(2.0) * SolidAngle::new(1.0);
//! ```
//!
//! Nor do flux and intensity add up:
//!
//! ```compile_fail
//! use gonio_radiometry::quantity::*;
//! let wrong = RadiantFlux::new(2.0) + RadiantIntensity::new(1.0);
//! ```
//!
//! # Why so
//! - **Kinds, not dimensions.** Irradiance arrives and radiant exitance leaves: one dimension, two quantities. Solid angle
//!   and projected solid angle likewise. A library of dimensions can't tell them apart, and those are the mistakes that
//!   people make. [`Quantity::relabel`] goes from one to the other where that is meant, and only between equal units.
//! - **A table, not type arithmetic.** Each law is a line that reads as in a textbook, and the compiler's message for a wrong
//!   product names the two kinds. That each line's dimensions and units add up is checked when the crate is compiled.
//!   `uom` was looked at: it has no kinds for radiance or projected solid angle, and its errors are hard to read.
//! - **Steradian and lumen are base units here**, besides watt, second and metre: the SI's "dimensionless steradian" would
//!   let intensity pass for flux.
//! - Kernels compute with bare numbers. Quantities are for the borders: readers, reports, sensors, tests.

pub mod kind;
pub mod law;
mod unit;

#[cfg(test)]
mod tests;

pub use kind::Kind;
pub use unit::Dimension;

use gonio_num::Real;
use std::cmp::Ordering;
use std::fmt;
use std::iter::Sum;
use std::marker::PhantomData;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// A number of type `R` that counts units of kind `K`.
///
/// Made by [`Quantity::new`] or parsed from text with a unit (`"3 W/m^2".parse::<Irradiance>()`); shown with its unit.
pub struct Quantity<R, K> {
    value: R,
    kind: PhantomData<fn() -> K>,
}

impl<R, K: Kind> Quantity<R, K> {
    /// `value` units of this kind; the unit is [`Kind::UNIT`].
    #[inline(always)]
    pub const fn new(value: R) -> Self {
        Self {
            value,
            kind: PhantomData,
        }
    }
}

impl<R: Real, K: Kind> Quantity<R, K> {
    /// The number of units.
    #[inline(always)]
    pub fn value(self) -> R {
        self.value
    }

    /// The same number and unit, seen as another kind: an irradiance that leaves again is a radiant exitance.
    ///
    /// Kinds of different units don't compile:
    ///
    /// ```compile_fail
    /// use gonio_radiometry::quantity::*;
    /// let wrong: Radiance = Irradiance::new(1.0).relabel();
    /// ```
    #[inline(always)]
    pub fn relabel<K2: Kind>(self) -> Quantity<R, K2> {
        const {
            assert!(
                K::DIMENSION.equals(K2::DIMENSION) && K::SCALE == K2::SCALE,
                "only kinds of the same unit can be relabelled"
            );
        }
        Quantity::new(self.value)
    }
}

impl<R: Copy, K> Copy for Quantity<R, K> {}

impl<R: Copy, K> Clone for Quantity<R, K> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}

impl<R: PartialEq, K> PartialEq for Quantity<R, K> {
    fn eq(&self, other: &Self) -> bool {
        self.value == other.value
    }
}

impl<R: PartialOrd, K> PartialOrd for Quantity<R, K> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        self.value.partial_cmp(&other.value)
    }
}

impl<R: fmt::Debug, K: Kind> fmt::Debug for Quantity<R, K> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?} {} ({})", self.value, K::UNIT, K::NAME)
    }
}

/// The number, formatted as asked (`{:.3}`), then the unit.
impl<R: fmt::Display, K: Kind> fmt::Display for Quantity<R, K> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.value.fmt(f)?;
        write!(f, " {}", K::UNIT)
    }
}

/// As [`fmt::Display`], the number with a power of ten (`{:.3e}`).
impl<R: fmt::LowerExp, K: Kind> fmt::LowerExp for Quantity<R, K> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.value.fmt(f)?;
        write!(f, " {}", K::UNIT)
    }
}

impl<R: Real, K: Kind> Add for Quantity<R, K> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::new(self.value + other.value)
    }
}

impl<R: Real, K: Kind> AddAssign for Quantity<R, K> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<R: Real, K: Kind> Sub for Quantity<R, K> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self::new(self.value - other.value)
    }
}

impl<R: Real, K: Kind> SubAssign for Quantity<R, K> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl<R: Real, K: Kind> Neg for Quantity<R, K> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.value)
    }
}

impl<R: Real, K: Kind> Mul<R> for Quantity<R, K> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: R) -> Self {
        Self::new(self.value * factor)
    }
}

impl<R: Real, K: Kind> Div<R> for Quantity<R, K> {
    type Output = Self;
    #[inline(always)]
    fn div(self, divisor: R) -> Self {
        Self::new(self.value / divisor)
    }
}

/// The ratio of two quantities of one kind is a number.
impl<R: Real, K: Kind> Div for Quantity<R, K> {
    type Output = R;
    #[inline(always)]
    fn div(self, other: Self) -> R {
        self.value / other.value
    }
}

impl<R: Real, K: Kind> Sum for Quantity<R, K> {
    fn sum<I: Iterator<Item = Self>>(terms: I) -> Self {
        terms.fold(Self::new(R::zero()), Add::add)
    }
}

macro_rules! number_times_quantity {
    ($($t:ty),*) => {$(
        impl<K: Kind> Mul<Quantity<$t, K>> for $t {
            type Output = Quantity<$t, K>;
            #[inline(always)]
            fn mul(self, q: Quantity<$t, K>) -> Quantity<$t, K> {
                q * self
            }
        }
    )*};
}
number_times_quantity!(f32, f64);

macro_rules! aliases {
    ($($name:ident: $doc:literal;)*) => {$(
        #[doc = $doc]
        pub type $name<R = f64> = Quantity<R, kind::$name>;
    )*};
}

aliases! {
    Length: "Length \\[m\\].";
    Area: "Area \\[m²\\].";
    ProjectedArea: "Area projected along a direction, A cosθ \\[m²\\].";
    Time: "Time \\[s\\].";
    Wavelength: "A wavelength, or a range of wavelengths \\[nm\\].";
    SolidAngle: "Solid angle Ω \\[sr\\] (T2).";
    ProjectedSolidAngle: "Solid angle weighted by the cosine, ∫ cosθ dω \\[sr\\].";
    Etendue: "Throughput of a beam, ∫∫ cosθ dω dA \\[m² sr\\].";
    RadiantEnergy: "Radiant energy Q \\[J\\].";
    RadiantFlux: "Radiant flux, or power, Φ \\[W\\].";
    RadiantIntensity: "Radiant intensity I \\[W/sr\\].";
    Irradiance: "Irradiance E: flux that arrives, per area \\[W/m²\\] (T6).";
    RadiantExitance: "Radiant exitance M: flux that leaves, per area \\[W/m²\\] (T7).";
    Radiance: "Radiance L \\[W m⁻² sr⁻¹\\] (T5).";
    ReflectanceDistribution: "Value of a BRDF \\[sr⁻¹\\] (T8).";
    SpectralFlux: "Radiant flux per wavelength \\[W/nm\\].";
    SpectralIntensity: "Radiant intensity per wavelength \\[W sr⁻¹ nm⁻¹\\].";
    SpectralIrradiance: "Irradiance per wavelength \\[W m⁻² nm⁻¹\\].";
    SpectralExitance: "Radiant exitance per wavelength \\[W m⁻² nm⁻¹\\].";
    SpectralRadiance: "Radiance per wavelength \\[W m⁻² sr⁻¹ nm⁻¹\\].";
    LuminousEnergy: "Luminous energy \\[lm s\\].";
    LuminousFlux: "Luminous flux \\[lm\\].";
    LuminousIntensity: "Luminous intensity \\[cd\\].";
    Illuminance: "Illuminance: luminous flux that arrives, per area \\[lx\\].";
    LuminousExitance: "Luminous exitance: luminous flux that leaves, per area \\[lm/m²\\].";
    Luminance: "Luminance \\[cd/m²\\], also called nit.";
    LuminousEfficacy: "Luminous efficacy \\[lm/W\\].";
}
