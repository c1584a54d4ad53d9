//! Where the sun stands at a place and time.
//!
//! Meeus, *Astronomical Algorithms* (2nd edition, 1998): the sun's apparent place by chapter 25 ("low accuracy", 0.01°), sidereal
//! time by chapter 12, with the nutation's largest term, and the parallax. Refraction is left out: the sky model's elevation is the
//! geometric one.

use crate::EnvError;
use gonio_num::Real;
use std::f64::consts::TAU;

/// A moment, in universal time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment {
    /// Days since noon of 2000-01-01, UT.
    days: f64,
}

/// Years that the formulas are good for.
const YEARS: std::ops::RangeInclusive<i64> = 1900..=2100;
/// Terrestrial time runs before universal time, about as much as from 2010 to 2030. A minute is 0.0007° of the sun's way.
const TERRESTRIAL_AHEAD_DAYS: f64 = 69.0 / 86_400.0;

/// Days from 2000-01-01 to a date of the Gregorian calendar (Fliegel & Van Flandern 1968).
fn days_from_2000(year: i64, month: i64, day: i64) -> i64 {
    let a = (month - 14) / 12;
    let julian = day - 32_075 + 1461 * (year + 4800 + a) / 4 + 367 * (month - 2 - 12 * a) / 12
        - 3 * ((year + 4900 + a) / 100) / 4;
    julian - 2_451_545
}

fn days_of_month(year: i64, month: i64) -> i64 {
    match month {
        2 if year % 4 == 0 && (year % 100 != 0 || year % 400 == 0) => 29,
        2 => 28,
        4 | 6 | 9 | 11 => 30,
        _ => 31,
    }
}

impl Moment {
    /// Reads a date and time with its offset from universal time, ISO 8601: `2026-06-21T12:00+02:00`, `2026-06-21T10:00:30Z`.
    ///
    /// # Errors
    /// [`EnvError::Parameter`] for anything else, a day or hour that does not exist, and a year outside 1900 to 2100.
    pub fn parse(text: &str) -> Result<Self, EnvError> {
        let error = |expected| EnvError::Parameter {
            name: "date and time",
            found: text.to_owned(),
            expected,
        };
        let form =
            "a date and time with offset, such as 2026-06-21T12:00+02:00, or Z for universal time";
        let read = |part: &str, digits: usize| {
            let sound = part.len() == digits && part.bytes().all(|b| b.is_ascii_digit());
            part.parse::<i64>()
                .ok()
                .filter(|_| sound)
                .ok_or_else(|| error(form))
        };
        let (date, rest) = text.split_once('T').ok_or_else(|| error(form))?;
        let [year, month, day] = date.split('-').collect::<Vec<_>>()[..] else {
            return Err(error(form));
        };
        let (year, month, day) = (read(year, 4)?, read(month, 2)?, read(day, 2)?);
        let (clock, offset_minutes) = if let Some(clock) = rest.strip_suffix('Z') {
            (clock, 0)
        } else {
            let at = rest.rfind(['+', '-']).ok_or_else(|| error(form))?;
            let (hours, minutes) = rest[at + 1..].split_once(':').ok_or_else(|| error(form))?;
            let (hours, minutes) = (read(hours, 2)?, read(minutes, 2)?);
            if hours > 14 || minutes > 59 {
                return Err(error("an offset from −14:00 to +14:00"));
            }
            let sign = if rest[at..].starts_with('-') { -1 } else { 1 };
            (&rest[..at], sign * (60 * hours + minutes))
        };
        let (hour, minute, second) = match clock.split(':').collect::<Vec<_>>()[..] {
            [h, m] => (read(h, 2)?, read(m, 2)?, 0),
            [h, m, s] => (read(h, 2)?, read(m, 2)?, read(s, 2)?),
            _ => return Err(error(form)),
        };
        if !YEARS.contains(&year) {
            return Err(error("a year from 1900 to 2100"));
        }
        if !(1..=12).contains(&month) || day < 1 || day > days_of_month(year, month) {
            return Err(error("a day of the calendar"));
        }
        if hour > 23 || minute > 59 || second > 59 {
            return Err(error("a time from 00:00 to 23:59:59"));
        }
        let seconds = 3600 * hour + 60 * (minute - offset_minutes) + second;
        Ok(Self {
            days: days_from_2000(year, month, day) as f64 - 0.5 + seconds as f64 / 86_400.0,
        })
    }

    /// Where the sun stands, seen from `latitude_deg` (north positive) and `longitude_deg` (east positive): within 0.01° from 1950
    /// to 2050, and 0.02° from 1900 to 2100. Refraction, up to 0.6° at the horizon, is not included.
    pub fn sun(&self, latitude_deg: f64, longitude_deg: f64) -> SunPosition {
        let t = (self.days + TERRESTRIAL_AHEAD_DAYS) / 36_525.0;
        let sin_cos = |deg: f64| Real::sin_cos(deg.rem_euclid(360.0).to_radians());
        // Meeus 25.2 to 25.4, equation of the centre.
        let mean_longitude = 280.466_46 + (36_000.769_83 + 0.000_303_2 * t) * t;
        let anomaly = 357.529_11 + (35_999.050_29 - 0.000_153_7 * t) * t;
        let centre = (1.914_602 - (0.004_817 + 0.000_014 * t) * t) * sin_cos(anomaly).0
            + (0.019_993 - 0.000_101 * t) * sin_cos(2.0 * anomaly).0
            + 0.000_289 * sin_cos(3.0 * anomaly).0;
        // Aberration and nutation (25.8, 22.2).
        let node = 125.04 - 1934.136 * t;
        let nutation = -0.004_78 * sin_cos(node).0;
        let longitude = mean_longitude + centre - 0.005_69 + nutation;
        let obliquity = 23.439_291 - 0.013_004_2 * t + 0.002_56 * sin_cos(node).1;
        let ((sin_l, cos_l), (sin_e, cos_e)) = (sin_cos(longitude), sin_cos(obliquity));
        // Meeus 25.6, 25.7: unit vector in the equator's frame.
        let (x, y, z) = (cos_l, cos_e * sin_l, sin_e * sin_l);
        // Meeus 12.4, apparent.
        let sidereal = 280.460_618_37
            + 360.985_647_366_29 * self.days
            + 0.000_387_933 * t * t
            + nutation * cos_e;
        let (sin_h, cos_h) = sin_cos(sidereal + longitude_deg);
        let ((sin_lat, cos_lat), to_south_east) = (
            Real::sin_cos(latitude_deg.to_radians()),
            (cos_h * x + sin_h * y, cos_h * y - sin_h * x),
        );
        let (towards_meridian, east) = to_south_east;
        let north = cos_lat * z - sin_lat * towards_meridian;
        let up = sin_lat * z + cos_lat * towards_meridian;
        let across = (north * north + east * east).sqrt();
        // 8.794″ times the cosine of the elevation.
        let parallax = 8.794 / 3600.0 * across;
        SunPosition {
            azimuth_deg: Real::atan2(east, north).to_degrees().rem_euclid(360.0),
            elevation_deg: Real::atan2(up, across).to_degrees() - parallax,
        }
    }

    #[cfg(test)]
    fn apparent_place(&self) -> [f64; 2] {
        // From the north pole the elevation is the declination; the azimuth, 180° east of the meridian, gives the right ascension.
        let seen = self.sun(90.0, 0.0);
        [seen.azimuth_deg, seen.elevation_deg]
    }
}

/// Where the sun stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SunPosition {
    /// From north over east \[degrees], 0 to 360.
    pub azimuth_deg: f64,
    /// Above the horizon \[degrees], −90 to 90.
    pub elevation_deg: f64,
}

impl SunPosition {
    /// The unit vector towards it: north is −z, east +x, up +y.
    pub fn direction(&self) -> gonio_num::Vec3<f64> {
        let (sin_a, cos_a) = Real::sin_cos(self.azimuth_deg / 360.0 * TAU);
        let (sin_e, cos_e) = Real::sin_cos(self.elevation_deg / 360.0 * TAU);
        gonio_num::Vec3::new(cos_e * sin_a, sin_e, -cos_e * cos_a)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Degrees that the position promises, twice over for what the almanacs round.
    const PROMISED: f64 = 0.01;

    /// Reda & Andreas, "Solar position algorithm for solar radiation applications", NREL/TP-560-34302 (2003, revised 2008), table
    /// A5.1: 2003-10-17 12:30:30 at −7 h, 39.742476° N, 105.1786° W; topocentric elevation without refraction 39.872046°, azimuth
    /// 194.340241°.
    #[test]
    fn the_example_of_a_finer_algorithm() {
        let seen = Moment::parse("2003-10-17T12:30:30-07:00")
            .unwrap()
            .sun(39.742_476, -105.178_6);
        assert!(
            (seen.elevation_deg - 39.872_046).abs() < PROMISED,
            "{seen:?}"
        );
        assert!(
            (seen.azimuth_deg - 194.340_241).abs() < PROMISED,
            "{seen:?}"
        );
    }

    /// Meeus, example 25.a: 1992-10-13 0h TD, declination −7.78507°; geocentric, so that the parallax of 8.8″ is added back.
    #[test]
    fn the_declination_of_an_almanac() {
        let [_, declination] = Moment::parse("1992-10-13T00:00Z").unwrap().apparent_place();
        assert!((declination - -7.785_07).abs() < PROMISED, "{declination}");
    }

    /// Equinoxes and solstices of 2024 (USNO): 2024-03-20 03:06, 2024-06-20 20:51, 2024-09-22 12:44, 2024-12-21 09:21 UT. At an
    /// equinox the declination is 0, at a solstice ±23.4362°, the obliquity of that year.
    #[test]
    fn the_seasons() {
        for (when, expected) in [
            ("2024-03-20T03:06Z", 0.0),
            ("2024-06-20T20:51Z", 23.436),
            ("2024-09-22T12:44Z", 0.0),
            ("2024-12-21T09:21Z", -23.436),
        ] {
            let [_, declination] = Moment::parse(when).unwrap().apparent_place();
            // The parallax is in it: 0.0024°.
            assert!(
                (declination - expected).abs() < PROMISED + 0.0024,
                "{when}: {declination}"
            );
        }
    }

    /// The equation of time is 0 four times a year: at noon UT of 2023-12-25 the sun stands on the meridian of Greenwich within
    /// half a minute of time.
    #[test]
    fn noon_in_greenwich() {
        let seen = Moment::parse("2023-12-25T12:00Z")
            .unwrap()
            .sun(51.4779, 0.0);
        assert!((seen.azimuth_deg - 180.0).abs() < 0.15, "{seen:?}");
        assert!(seen.direction().z > 0.0 && seen.direction().x.abs() < 0.003);
        // Negative control: two hours later it does not.
        let later = Moment::parse("2023-12-25T14:00Z")
            .unwrap()
            .sun(51.4779, 0.0);
        assert!(later.azimuth_deg > 200.0, "{later:?}");
    }

    #[test]
    fn offsets_are_from_universal_time() {
        let same = [
            "2026-06-21T12:00+02:00",
            "2026-06-21T10:00Z",
            "2026-06-21T10:00:00+00:00",
            "2026-06-20T23:30-10:30",
        ];
        let moments: Vec<_> = same.iter().map(|t| Moment::parse(t).unwrap()).collect();
        assert!(moments.iter().all(|m| *m == moments[0]), "{moments:?}");
    }

    #[test]
    fn what_is_no_moment_is_refused() {
        for (text, word) in [
            ("2026-06-21", "offset"),
            ("2026-06-21T12:00", "offset"),
            ("2026-02-29T12:00Z", "calendar"),
            ("2026-13-01T12:00Z", "calendar"),
            ("2026-06-21T24:00Z", "23:59"),
            ("1899-06-21T12:00Z", "1900"),
            ("2026-06-21T12:00+15:00", "14:00"),
            ("26-6-21T12:00Z", "offset"),
            ("", "offset"),
        ] {
            let message = Moment::parse(text).unwrap_err().to_string();
            assert!(message.contains(word), "{text}: {message}");
        }
    }
}
