//! [`SkyOptions`], and the words that describe a sky.

use super::position::{Moment, SunPosition};
use crate::EnvError;
use crate::error::suggest;
use std::str::FromStr;

/// What a sky is made from.
///
/// In words: `2026-06-21T12:00+02:00@48.2,16.4,turbidity=3,albedo=0.2`, or `azimuth=120,elevation=30,…`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SkyOptions {
    /// Where the sun stands; its elevation is 0° to 90°.
    pub sun_position: SunPosition,
    /// Haze: 1 (none) to 10 (warm and damp), 3 for a clear day.
    pub turbidity: f64,
    /// Reflectance of the ground, linear RGB, each 0 to 1.
    pub albedo: [f64; 3],
    /// Whether the sun's disc shines.
    pub sun: bool,
    /// Whether the sky shines.
    pub sky: bool,
    /// Whether the ground is seen below the horizon, lit by sun and sky; black otherwise.
    pub ground: bool,
}

impl Default for SkyOptions {
    /// The sun 45° high in the south, turbidity 3, albedo 0.3.
    fn default() -> Self {
        Self {
            sun_position: SunPosition {
                azimuth_deg: 180.0,
                elevation_deg: 45.0,
            },
            turbidity: 3.0,
            albedo: [0.3; 3],
            sun: true,
            sky: true,
            ground: true,
        }
    }
}

const KEYS: [&str; 7] = [
    "azimuth",
    "elevation",
    "turbidity",
    "albedo",
    "sun",
    "sky",
    "ground",
];
const FORM: &str = "DATE@LATITUDE,LONGITUDE or azimuth=DEG,elevation=DEG, then turbidity=, albedo=, sun=, sky=, ground=";

fn wrong(name: &'static str, found: impl Into<String>, expected: &'static str) -> EnvError {
    EnvError::Parameter {
        name,
        found: found.into(),
        expected,
    }
}

fn number(
    name: &'static str,
    text: &str,
    low: f64,
    high: f64,
    expected: &'static str,
) -> Result<f64, EnvError> {
    let value = text.trim().parse::<f64>().ok();
    value
        .filter(|v| (low..=high).contains(v))
        .ok_or_else(|| wrong(name, text, expected))
}

fn switch(name: &'static str, text: &str) -> Result<bool, EnvError> {
    match text {
        "on" => Ok(true),
        "off" => Ok(false),
        _ => Err(wrong(name, text, "on or off")),
    }
}

impl FromStr for SkyOptions {
    type Err = EnvError;

    fn from_str(text: &str) -> Result<Self, EnvError> {
        let mut options = Self::default();
        let mut words = text.split(',').peekable();
        let mut place = None;
        if let Some((date, latitude)) = words.peek().and_then(|w| w.split_once('@')) {
            words.next();
            let moment = Moment::parse(date)?;
            let form = "degrees from −90 to 90, north positive";
            let latitude = number("latitude", latitude, -90.0, 90.0, form)?;
            let east = "degrees from −180 to 180, east positive, after the latitude and a comma";
            let longitude = number(
                "longitude",
                words.next().unwrap_or_default(),
                -180.0,
                180.0,
                east,
            )?;
            place = Some(moment.sun(latitude, longitude));
        }
        let (mut azimuth, mut elevation) = (None, None);
        for word in words.filter(|w| !w.is_empty()) {
            let Some((key, value)) = word.split_once('=') else {
                return Err(wrong("sky", word, FORM));
            };
            match key.trim() {
                "azimuth" => {
                    azimuth = Some(number(
                        "azimuth",
                        value,
                        -360.0,
                        360.0,
                        "degrees from north over east, −360 to 360",
                    )?)
                }
                "elevation" => {
                    elevation = Some(number(
                        "elevation",
                        value,
                        0.0,
                        90.0,
                        "degrees above the horizon, 0 to 90",
                    )?)
                }
                "turbidity" => {
                    options.turbidity =
                        number("turbidity", value, 1.0, 10.0, "a number from 1 to 10")?
                }
                "albedo" => {
                    let form = "one number from 0 to 1, or three, r/g/b";
                    let parts: Result<Vec<f64>, _> = value
                        .split('/')
                        .map(|v| number("albedo", v, 0.0, 1.0, form))
                        .collect();
                    options.albedo = match parts?[..] {
                        [grey] => [grey; 3],
                        [r, g, b] => [r, g, b],
                        _ => return Err(wrong("albedo", value, form)),
                    };
                }
                "sun" => options.sun = switch("sun", value)?,
                "sky" => options.sky = switch("sky", value)?,
                "ground" => options.ground = switch("ground", value)?,
                other => {
                    return Err(EnvError::UnknownWord {
                        of: "sky",
                        found: other.to_owned(),
                        suggestion: suggest(other, &KEYS),
                        known: &KEYS,
                    });
                }
            }
        }
        options.sun_position = match (place, azimuth, elevation) {
            (Some(position), None, None) => position,
            (None, azimuth, Some(elevation_deg)) => SunPosition {
                azimuth_deg: azimuth.unwrap_or(180.0),
                elevation_deg,
            },
            (Some(_), ..) => {
                return Err(wrong(
                    "sky",
                    text,
                    "the sun's place once: by a date, or by azimuth and elevation",
                ));
            }
            (None, ..) => return Err(wrong("sky", text, FORM)),
        };
        options.check()?;
        Ok(options)
    }
}

impl SkyOptions {
    /// Where the sun stands, if everything is in range.
    pub(super) fn check(&self) -> Result<SunPosition, EnvError> {
        let p = self.sun_position;
        if !(self.turbidity >= 1.0 && self.turbidity <= 10.0) {
            return Err(wrong(
                "turbidity",
                self.turbidity.to_string(),
                "a number from 1 to 10",
            ));
        }
        if !self.albedo.iter().all(|a| (0.0..=1.0).contains(a)) {
            return Err(wrong(
                "albedo",
                format!("{:?}", self.albedo),
                "numbers from 0 to 1",
            ));
        }
        if !(p.azimuth_deg.is_finite() && (0.0..=90.0).contains(&p.elevation_deg)) {
            return Err(wrong(
                "sun",
                format!(
                    "azimuth {:.2}°, elevation {:.2}°",
                    p.azimuth_deg, p.elevation_deg
                ),
                "a sun above the horizon: the model knows no night",
            ));
        }
        Ok(p)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_read() {
        let sky: SkyOptions =
            "2026-06-21T12:00+02:00@48.2,16.4,turbidity=4,albedo=0.1/0.2/0.3,ground=off"
                .parse()
                .unwrap();
        assert_eq!(
            (sky.turbidity, sky.albedo, sky.ground, sky.sun),
            (4.0, [0.1, 0.2, 0.3], false, true)
        );
        // Vienna at noon of summer time: an hour before the sun's own noon.
        let p = sky.sun_position;
        assert!(
            (60.0..65.3).contains(&p.elevation_deg) && (130.0..170.0).contains(&p.azimuth_deg),
            "{p:?}"
        );
        let by_hand: SkyOptions = "elevation=30,azimuth=-90".parse().unwrap();
        assert_eq!(by_hand.sun_position.elevation_deg, 30.0);
    }

    #[test]
    fn what_is_wrong_is_named() {
        for (text, word) in [
            ("", "DATE@"),
            ("turbidity=3", "DATE@"),
            ("elevation=-3", "elevation"),
            ("elevation=20,turbidity=11", "turbidity"),
            ("elevation=20,turbidity=nan", "turbidity"),
            ("elevation=20,albedo=1.5", "albedo"),
            ("elevation=20,albedo=1/2", "albedo"),
            ("elevation=20,sun=yes", "on or off"),
            ("elevation=20,turbidty=3", "turbidty"),
            ("2026-06-21T12:00Z@91,0", "latitude"),
            ("2026-06-21T12:00Z@48", "longitude"),
            ("2026-06-21T12:00Z@48,16,elevation=3", "once"),
            ("2026-06-21T23:00Z@48,16", "no night"),
        ] {
            let message = text.parse::<SkyOptions>().unwrap_err().to_string();
            assert!(message.contains(word), "{text}: {message}");
        }
    }
}
