//! The kinds of quantity, and the products between them.

use super::{Dimension, Quantity};
use gonio_num::Real;
use std::f64::consts::PI;
use std::ops::{Div, Mul};

/// What a [`Quantity`] measures, and in which unit.
pub trait Kind: Copy + 'static {
    /// The name of the quantity, as "radiant exitance".
    const NAME: &'static str;
    /// The unit, as "W/m²".
    const UNIT: &'static str;
    /// Powers of the base units: watt, lumen, second, metre, steradian.
    const DIMENSION: Dimension;
    /// The decimal power by which the unit differs from that product of base units: 9 for "per nm", −9 for nm.
    const SCALE: i8;
}

macro_rules! kinds {
    ($($name:ident $label:literal $unit:literal [$w:literal $lm:literal $s:literal $m:literal $sr:literal] $scale:literal;)*) => {$(
        #[doc = concat!("The kind of ", $label, " \\[", $unit, "\\].")]
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub struct $name;
        impl Kind for $name {
            const NAME: &'static str = $label;
            const UNIT: &'static str = $unit;
            const DIMENSION: Dimension = Dimension { watt: $w, lumen: $lm, second: $s, metre: $m, steradian: $sr };
            const SCALE: i8 = $scale;
        }
    )*
        /// Every kind's name, unit, dimension and scale.
        #[cfg(test)]
        pub(super) const ALL: &[(&str, &str, Dimension, i8)] =
            &[$(($name::NAME, $name::UNIT, $name::DIMENSION, $name::SCALE)),*];
    };
}

kinds! {
    // kind                 name                     unit               W lm s m sr  scale
    Length                  "length"                 "m"               [0 0 0 1 0]   0;
    Area                    "area"                   "m²"              [0 0 0 2 0]   0;
    ProjectedArea           "projected area"         "m²"              [0 0 0 2 0]   0;
    Time                    "time"                   "s"               [0 0 1 0 0]   0;
    Wavelength              "wavelength"             "nm"              [0 0 0 1 0]  -9;
    SolidAngle              "solid angle"            "sr"              [0 0 0 0 1]   0;
    ProjectedSolidAngle     "projected solid angle"  "sr"              [0 0 0 0 1]   0;
    Etendue                 "étendue"                "m² sr"           [0 0 0 2 1]   0;
    RadiantEnergy           "radiant energy"         "J"               [1 0 1 0 0]   0;
    RadiantFlux             "radiant flux"           "W"               [1 0 0 0 0]   0;
    RadiantIntensity        "radiant intensity"      "W/sr"            [1 0 0 0 -1]  0;
    Irradiance              "irradiance"             "W/m²"            [1 0 0 -2 0]  0;
    RadiantExitance         "radiant exitance"       "W/m²"            [1 0 0 -2 0]  0;
    Radiance                "radiance"               "W m⁻² sr⁻¹"      [1 0 0 -2 -1] 0;
    ReflectanceDistribution "reflectance distribution" "sr⁻¹"          [0 0 0 0 -1]  0;
    SpectralFlux            "spectral flux"          "W/nm"            [1 0 0 -1 0]  9;
    SpectralIntensity       "spectral intensity"     "W sr⁻¹ nm⁻¹"     [1 0 0 -1 -1] 9;
    SpectralIrradiance      "spectral irradiance"    "W m⁻² nm⁻¹"      [1 0 0 -3 0]  9;
    SpectralExitance        "spectral exitance"      "W m⁻² nm⁻¹"      [1 0 0 -3 0]  9;
    SpectralRadiance        "spectral radiance"      "W m⁻² sr⁻¹ nm⁻¹" [1 0 0 -3 -1] 9;
    LuminousEnergy          "luminous energy"        "lm s"            [0 1 1 0 0]   0;
    LuminousFlux            "luminous flux"          "lm"              [0 1 0 0 0]   0;
    LuminousIntensity       "luminous intensity"     "cd"              [0 1 0 0 -1]  0;
    Illuminance             "illuminance"            "lx"              [0 1 0 -2 0]  0;
    LuminousExitance        "luminous exitance"      "lm/m²"           [0 1 0 -2 0]  0;
    Luminance               "luminance"              "cd/m²"           [0 1 0 -2 -1] 0;
    LuminousEfficacy        "luminous efficacy"      "lm/W"            [-1 1 0 0 0]  0;
}

/// One direction of a law: `$a * $b` is `$c`.
macro_rules! times {
    ($a:ident, $b:ident, $c:ident) => {
        impl<R: Real> Mul<Quantity<R, $b>> for Quantity<R, $a> {
            type Output = Quantity<R, $c>;
            #[inline(always)]
            fn mul(self, other: Quantity<R, $b>) -> Quantity<R, $c> {
                Quantity::new(self.value * other.value)
            }
        }
    };
}

/// `$c / $a` is `$b`.
macro_rules! over {
    ($c:ident, $a:ident, $b:ident) => {
        impl<R: Real> Div<Quantity<R, $a>> for Quantity<R, $c> {
            type Output = Quantity<R, $b>;
            #[inline(always)]
            fn div(self, other: Quantity<R, $a>) -> Quantity<R, $b> {
                Quantity::new(self.value / other.value)
            }
        }
    };
}

/// Laws whose right side over the first factor is the second, checked at compile time: the units add up.
macro_rules! one_way_laws {
    ($($a:ident * $b:ident = $c:ident;)*) => {$(
        times!($a, $b, $c);
        times!($b, $a, $c);
        over!($c, $a, $b);
        const _: () = assert!(
            $a::DIMENSION.times($b::DIMENSION).equals($c::DIMENSION) && $a::SCALE + $b::SCALE == $c::SCALE,
            "the units of a law don't add up"
        );
    )*};
}

/// Laws that give both products and both quotients.
macro_rules! laws {
    ($($a:ident * $b:ident = $c:ident;)*) => {
        one_way_laws! { $($a * $b = $c;)* }
        $(over!($c, $b, $a);)*
    };
}

laws! {
    // Radiometry.
    RadiantFlux * Time = RadiantEnergy;
    RadiantIntensity * SolidAngle = RadiantFlux;
    Irradiance * Area = RadiantFlux;
    Radiance * ProjectedSolidAngle = Irradiance;
    Radiance * ProjectedArea = RadiantIntensity;
    Radiance * Etendue = RadiantFlux;
    Area * ProjectedSolidAngle = Etendue;
    ProjectedArea * SolidAngle = Etendue;
    // Reflection: dLr = f dE (8).
    Irradiance * ReflectanceDistribution = Radiance;
    SpectralIrradiance * ReflectanceDistribution = SpectralRadiance;
    Illuminance * ReflectanceDistribution = Luminance;
    // Spectral quantities, over a range of wavelengths.
    SpectralFlux * Wavelength = RadiantFlux;
    SpectralIntensity * Wavelength = RadiantIntensity;
    SpectralIrradiance * Wavelength = Irradiance;
    SpectralExitance * Wavelength = RadiantExitance;
    SpectralRadiance * Wavelength = Radiance;
    // Spectral quantities, over directions and areas.
    SpectralIntensity * SolidAngle = SpectralFlux;
    SpectralIrradiance * Area = SpectralFlux;
    SpectralRadiance * ProjectedSolidAngle = SpectralIrradiance;
    SpectralRadiance * ProjectedArea = SpectralIntensity;
    SpectralRadiance * Etendue = SpectralFlux;
    // Photometry.
    LuminousFlux * Time = LuminousEnergy;
    LuminousIntensity * SolidAngle = LuminousFlux;
    Illuminance * Area = LuminousFlux;
    Luminance * ProjectedSolidAngle = Illuminance;
    Luminance * ProjectedArea = LuminousIntensity;
    Luminance * Etendue = LuminousFlux;
    // From radiometry to photometry.
    RadiantEnergy * LuminousEfficacy = LuminousEnergy;
    RadiantFlux * LuminousEfficacy = LuminousFlux;
    RadiantIntensity * LuminousEfficacy = LuminousIntensity;
    Irradiance * LuminousEfficacy = Illuminance;
    RadiantExitance * LuminousEfficacy = LuminousExitance;
    Radiance * LuminousEfficacy = Luminance;
}

// Flux over area is what arrives, an irradiance or illuminance: `relabel` makes it what leaves.
one_way_laws! {
    RadiantExitance * Area = RadiantFlux;
    SpectralExitance * Area = SpectralFlux;
    LuminousExitance * Area = LuminousFlux;
}

/// Length times length is an area; a quotient of the two is a length.
impl<R: Real> Mul for Quantity<R, Length> {
    type Output = Quantity<R, Area>;
    #[inline(always)]
    fn mul(self, other: Self) -> Quantity<R, Area> {
        Quantity::new(self.value * other.value)
    }
}
over!(Area, Length, Length);

impl<R: Real> Quantity<R, SolidAngle> {
    /// All directions: 4π sr (T4).
    pub fn sphere() -> Self {
        Self::new(R::lit(4.0 * PI))
    }

    /// The directions on one side of a plane: 2π sr.
    pub fn hemisphere() -> Self {
        Self::new(R::lit(2.0 * PI))
    }

    /// The projected solid angle of a *small* solid angle at the angle θ to the normal: Ω max(cosθ, 0).
    pub fn projected(self, cos_theta: R) -> Quantity<R, ProjectedSolidAngle> {
        Quantity::new(self.value * cos_theta.max(R::zero()))
    }
}

impl<R: Real> Quantity<R, ProjectedSolidAngle> {
    /// ∫ cosθ dω over the hemisphere: π sr (T6).
    pub fn hemisphere() -> Self {
        Self::new(R::pi())
    }
}

impl<R: Real> Quantity<R, Area> {
    /// The area that a plane surface shows to a direction at the angle θ to its normal: A max(cosθ, 0).
    pub fn projected(self, cos_theta: R) -> Quantity<R, ProjectedArea> {
        Quantity::new(self.value * cos_theta.max(R::zero()))
    }
}
