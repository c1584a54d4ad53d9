//! Values of arguments: sizes, durations, vectors, angles.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use gonio_image::tonemap::ToneMap;
use gonio_num::{Real, Vec3};
use gonio_render::PixelFilter;
use std::time::Duration;

/// The name of a tone map.
pub(crate) fn tone_map() -> impl TypedValueParser<Value = ToneMap> {
    PossibleValuesParser::new([
        PossibleValue::new("linear").alias("srgb"),
        PossibleValue::new("aces"),
        PossibleValue::new("agx"),
        PossibleValue::new("pbr-neutral").alias("neutral"),
    ])
    .try_map(|name| name.parse::<ToneMap>())
}

/// One of some words, each with its value.
pub(crate) fn words<T: Copy + Send + Sync + 'static>(
    all: &'static [(T, &'static str)],
) -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(all.iter().map(|(_, name)| *name)).try_map(|given| {
        let found = all.iter().find(|(_, name)| *name == given);
        found.map(|(value, _)| *value).ok_or("unknown word")
    })
}

/// The name of a pixel filter.
pub(crate) fn pixel_filter() -> impl TypedValueParser<Value = PixelFilter> {
    PossibleValuesParser::new(["box", "tent", "blackman-harris"])
        .try_map(|name| name.parse::<PixelFilter>())
}

/// A whole number from `least` to `most`.
pub(crate) fn whole<T>(least: T, most: T) -> impl Fn(&str) -> Result<T, String> + Clone
where
    T: std::str::FromStr + PartialOrd + std::fmt::Display + Copy,
{
    move |text| {
        text.parse::<T>()
            .ok()
            .filter(|n| (least..=most).contains(n))
            .ok_or_else(|| format!("expected a whole number from {least} to {most}"))
    }
}

/// `1280x720` as width and height.
pub(crate) fn size(text: &str) -> Result<[u32; 2], String> {
    let parts: Vec<&str> = text.split(['x', 'X', '×']).collect();
    let number = |s: &str| s.trim().parse::<u32>().ok().filter(|n| *n > 0);
    match parts[..] {
        [w, h] => Option::zip(number(w), number(h)).map(|(w, h)| [w, h]),
        _ => None,
    }
    .ok_or_else(|| "expected WIDTHxHEIGHT in pixels, such as 1280x720".into())
}

/// `90`, `90s`, `1.5m` or `2h` as a duration.
pub(crate) fn duration(text: &str) -> Result<Duration, String> {
    let (number, unit) = match text.char_indices().next_back() {
        Some((i, 's')) => (&text[..i], 1.0),
        Some((i, 'm')) => (&text[..i], 60.0),
        Some((i, 'h')) => (&text[..i], 3600.0),
        _ => (text, 1.0),
    };
    number
        .parse::<f64>()
        .ok()
        .filter(|n| *n > 0.0)
        .and_then(|n| Duration::try_from_secs_f64(n * unit).ok())
        .ok_or_else(|| "expected a time such as 30s, 1.5m or 2h".into())
}

/// `2%` or `0.02` as a fraction.
pub(crate) fn fraction(text: &str) -> Result<f64, String> {
    let (number, scale) = match text.strip_suffix('%') {
        Some(percent) => (percent.trim(), 0.01),
        None => (text, 1.0),
    };
    number
        .parse::<f64>()
        .ok()
        .map(|n| n * scale)
        .filter(|n| *n > 0.0 && n.is_finite())
        .ok_or_else(|| "expected a positive fraction such as 2% or 0.02".into())
}

/// `x,y,z` as a vector.
pub(crate) fn vector(text: &str) -> Result<Vec3<f32>, String> {
    match numbers(text)?[..] {
        [x, y, z] => Ok(Vec3::new(x, y, z).to_f32()),
        _ => Err("expected three numbers such as 0,1,0".into()),
    }
}

/// A direction of the local frame: polar angle and azimuth in degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Angles {
    pub theta_deg: f64,
    pub phi_deg: f64,
}

impl Angles {
    /// The unit vector (T3, eqs 1–3).
    pub fn direction(self) -> Vec3<f64> {
        let (sin_theta, cos_theta) = cardinal_sin_cos(self.theta_deg);
        let (sin_phi, cos_phi) = cardinal_sin_cos(self.phi_deg);
        Vec3::new(sin_theta * cos_phi, sin_theta * sin_phi, cos_theta)
    }
}

/// sin and cos of an angle in degrees, exact at multiples of 90°: a direction given as θ = 90° lies in the horizon.
fn cardinal_sin_cos(degrees: f64) -> (f64, f64) {
    let quarter = degrees / 90.0;
    if quarter == quarter.floor() {
        match quarter.rem_euclid(4.0) as u8 {
            0 => (0.0, 1.0),
            1 => (1.0, 0.0),
            2 => (0.0, -1.0),
            _ => (-1.0, 0.0),
        }
    } else {
        Real::sin_cos(degrees.to_radians())
    }
}

/// `θ,φ` or `θ` in degrees.
pub(crate) fn angles(text: &str) -> Result<Angles, String> {
    let expected = || "expected θ,φ in degrees, θ from 0 to 180, such as 45,0".to_owned();
    let (theta_deg, phi_deg) = match numbers(text).map_err(|_| expected())?[..] {
        [theta] => (theta, 0.0),
        [theta, phi] => (theta, phi),
        _ => return Err(expected()),
    };
    if (0.0..=180.0).contains(&theta_deg) {
        Ok(Angles { theta_deg, phi_deg })
    } else {
        Err(expected())
    }
}

/// A finite number.
pub(crate) fn finite(text: &str) -> Result<f32, String> {
    text.parse::<f32>()
        .ok()
        .filter(|n| n.is_finite())
        .ok_or_else(|| "expected a finite number".into())
}

fn numbers(text: &str) -> Result<Vec<f64>, String> {
    text.split(',')
        .map(|word| {
            word.trim()
                .parse::<f64>()
                .ok()
                .filter(|n| n.is_finite())
                .ok_or_else(|| format!("'{word}' is not a finite number"))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn good_values() {
        assert_eq!(whole(1_u32, 9)("9"), Ok(9));
        assert_eq!(size("1280x720"), Ok([1280, 720]));
        assert_eq!(size("3×4"), Ok([3, 4]));
        assert_eq!(duration("1.5m"), Ok(Duration::from_secs(90)));
        assert_eq!(duration("2"), Ok(Duration::from_secs(2)));
        assert_eq!(fraction("2%"), Ok(0.02));
        assert_eq!(fraction("0.5"), Ok(0.5));
        assert_eq!(vector("0, 1,-2.5"), Ok(Vec3::new(0.0, 1.0, -2.5)));
        assert_eq!(
            angles("45,-90"),
            Ok(Angles {
                theta_deg: 45.0,
                phi_deg: -90.0
            })
        );
        assert_eq!(
            angles("30"),
            Ok(Angles {
                theta_deg: 30.0,
                phi_deg: 0.0
            })
        );
        assert_eq!(finite("-2.5"), Ok(-2.5));
    }

    #[test]
    fn bad_values() {
        for text in ["", "0", "10", "-1", "1.5", "x"] {
            assert!(whole(1_u32, 9)(text).is_err(), "{text}");
        }
        for text in [
            "",
            "12",
            "0x4",
            "4x",
            "axb",
            "1x2x3",
            "-1x2",
            "99999999999x1",
        ] {
            assert!(size(text).is_err(), "{text}");
        }
        for text in ["", "s", "-1s", "0", "nan", "inf", "1d", "1e300h"] {
            assert!(duration(text).is_err(), "{text}");
        }
        for text in ["", "%", "0", "-2%", "nan", "inf"] {
            assert!(fraction(text).is_err(), "{text}");
        }
        for text in ["", "1,2", "1,2,3,4", "1,2,nan", "a,b,c"] {
            assert!(vector(text).is_err(), "{text}");
        }
        for text in ["", "181", "-1", "nan,0", "1,2,3"] {
            assert!(angles(text).is_err(), "{text}");
        }
        for text in ["", "nan", "inf", "x"] {
            assert!(finite(text).is_err(), "{text}");
        }
    }

    #[test]
    fn cardinal_angles_are_exact() {
        let at = |theta_deg, phi_deg| Angles { theta_deg, phi_deg }.direction();
        assert_eq!(at(90.0, 0.0), Vec3::new(1.0, 0.0, 0.0));
        assert_eq!(at(90.0, 90.0), Vec3::new(0.0, 1.0, 0.0));
        assert_eq!(at(0.0, 123.0).z, 1.0);
        assert_eq!(at(90.0, -180.0), Vec3::new(-1.0, 0.0, 0.0));
        let v = at(45.0, 45.0);
        assert!((v.length() - 1.0).abs() < 1e-15 && (v.x - 0.5).abs() < 1e-15);
    }
}
