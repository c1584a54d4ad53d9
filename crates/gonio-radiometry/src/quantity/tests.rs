use super::*;
use crate::RadiometryError;
use crate::quadrature::ProductRule;
use proptest::prelude::*;
use std::f64::consts::PI;

#[test]
fn uniform_unit_radiance_gives_an_irradiance_of_pi() {
    let e = law::irradiance(&ProductRule::new(4, 4), |_| Radiance::new(1.0));
    assert!((e.value() - PI).abs() < 1e-14);
    assert_eq!(law::irradiance_of_uniform(Radiance::new(1.0)).value(), PI);
}

#[test]
fn every_unit_parses_as_its_own_kind() {
    for &(name, unit, dimension, scale) in kind::ALL {
        let (found, power) = unit::parse_unit(unit).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(found, dimension, "{name}");
        assert_eq!(power, i32::from(scale), "{name}");
    }
}

#[test]
fn units_in_the_forms_that_people_write() {
    let radiance = |text: &str| text.parse::<Radiance>().map(Quantity::value);
    for text in [
        "3 W/m^2/sr",
        "3 W/(m^2 sr)",
        "3 W/m² sr",
        "3 W/m2/sr",
        "3 W·m⁻²·sr⁻¹",
        "3W m^-2 sr^-1",
        "3 W sr-1 m-2",
        "3e3 mW m⁻² sr⁻¹",
        "  3.0  watts/metre^2 /steradian ",
        "0.3 mW/cm^2/sr * 1e0 sr/sr",
    ] {
        match radiance(text) {
            Ok(value) => assert!((value - 3.0).abs() < 1e-12, "{text}: {value}"),
            // The last one multiplies by a number, which isn't a unit.
            Err(e) => assert!(text.contains("1e0"), "{text}: {e}"),
        }
    }
    assert!(radiance("0.3 mW/cm^2/sr * 1e0 sr/sr").is_err());
    assert_eq!("20 cm".parse::<Length>(), Ok(Length::new(0.2)));
    assert_eq!("0.55 µm".parse::<Wavelength>(), Ok(Wavelength::new(550.0)));
    assert_eq!("250 nits".parse::<Luminance>(), Ok(Luminance::new(250.0)));
    assert_eq!("2 klx".parse::<Illuminance>(), Ok(Illuminance::new(2000.0)));
    assert_eq!("7 J".parse::<RadiantEnergy>(), Ok(RadiantEnergy::new(7.0)));
    assert_eq!(
        "0.3 1/sr".parse::<ReflectanceDistribution>(),
        Ok(ReflectanceDistribution::new(0.3))
    );
    // Per metre of wavelength: 1e9 times as much as per nm.
    let spectral: SpectralRadiance = "2e9 W/m^3/sr".parse().unwrap();
    assert_eq!(spectral.value(), 2.0);
    assert_eq!(
        "1 W/m^2".parse::<Irradiance<f32>>(),
        Ok(Irradiance::new(1.0f32))
    );
}

#[test]
fn wrong_text_names_what_was_found_and_what_is_expected() {
    for (text, needle) in [
        ("3 W/m^2", "the unit is W/m^2; expected W m⁻² sr⁻¹"),
        ("3", "it has no unit; expected W m⁻² sr⁻¹"),
        ("", "doesn't begin with a finite number"),
        ("NaN W/m^2/sr", "doesn't begin with a finite number"),
        ("1e999 W/m^2/sr", "doesn't begin with a finite number"),
        ("1.2.3 W/m^2/sr", "doesn't begin with a finite number"),
        ("3 w/m^2/sr", "unknown unit \"w\"; did you mean \"W\"?"),
        ("3 wat/m^2/sr", "did you mean \"watt\"?"),
        ("3 candel/m^2", "did you mean \"candela\"?"),
        ("3 W/m^2/parsec", "unknown unit \"parsec\""),
        ("3 W/m^x", "isn't a power"),
        ("3 W/m^99/sr", "isn't a power"),
        ("3 W/m^0", "isn't a power"),
        ("3 W/m^2/sr!", "isn't part of a unit"),
        ("1e300 GW/m^2/sr", "too large"),
    ] {
        match text.parse::<Radiance>() {
            Err(e @ RadiometryError::QuantityText { .. }) => {
                assert!(e.to_string().contains(needle), "{text}: {e}");
            }
            other => panic!("{text}: {other:?}"),
        }
    }
    // Long text, and thousands of factors, end in an error, not in an overflow.
    let long = format!("3 {}", "km^9 ".repeat(10_000));
    let message = long.parse::<Length>().unwrap_err().to_string();
    assert!(message.starts_with("\"3 km^9"), "{message}");
}

#[test]
fn laws_of_lights_and_sensors() {
    // A disk of radius 1 mm and radiance 10⁶, seen from 1 m straight ahead: E = L A / r².
    let disk = Area::new(PI * 1e-6);
    let intensity: RadiantIntensity = Radiance::new(1e6) * disk.projected(1.0);
    let e = law::irradiance_of_point(intensity, 1.0, Length::new(1.0));
    assert!((e.value() - PI).abs() < 1e-14);
    // The flux through a beam is the same by étendue.
    let omega = law::solid_angle(Area::new(1e-4), Length::new(1.0));
    let flux: RadiantFlux = Radiance::new(1e6) * (disk.projected(1.0) * omega);
    assert_eq!(flux, intensity * omega);
    // A Lambertian surface of albedo ρ sends back ρE.
    let out = Irradiance::new(7.0) * law::lambertian_brdf(0.3);
    let back = (out * ProjectedSolidAngle::hemisphere()).relabel::<kind::RadiantExitance>();
    assert!((back.value() - 2.1).abs() < 1e-15);
    assert!((law::lambertian_radiance(back).value() - out.value()).abs() < 1e-15);
    // Photometry and spectra.
    let lumens: LuminousFlux = RadiantFlux::new(2.0) * LuminousEfficacy::new(100.0);
    assert_eq!(lumens.to_string(), "200 lm");
    let cd: LuminousIntensity = lumens / SolidAngle::sphere();
    assert!((cd.value() - 50.0 / PI).abs() < 1e-14);
    let band: Radiance = SpectralRadiance::new(0.5) * Wavelength::new(20.0);
    assert_eq!(band.value(), 10.0);
    // Below the horizon nothing arrives.
    assert_eq!(
        law::irradiance_of_point(intensity, -0.5, Length::new(1.0)).value(),
        0.0
    );
}

#[test]
fn sums_ratios_and_formats() {
    let total: RadiantFlux = [1.0, 2.0, 3.5].into_iter().map(RadiantFlux::new).sum();
    assert_eq!(total / RadiantFlux::new(2.0), 3.25);
    assert_eq!(format!("{:.2}", 2.0 * total - total / 2.0), "9.75 W");
    assert_eq!(format!("{:?}", -total), "-6.5 W (radiant flux)");
    assert!(RadiantFlux::new(1.0f32) < RadiantFlux::new(2.0f32));
    let mut sum = Length::new(1.0);
    sum += Length::new(2.0);
    sum -= Length::new(0.5);
    assert_eq!((sum * sum) / sum, sum);
}

proptest! {
    #[test]
    fn text_returns(value in proptest::num::f64::NORMAL) {
        let l = Radiance::new(value);
        prop_assert_eq!(l.to_string().parse::<Radiance>(), Ok(l));
    }

    #[test]
    fn no_text_panics(text in "\\PC{0,40}", number in "[0-9.e+-]{0,6}") {
        let _ = text.parse::<Radiance>();
        let _ = format!("{number}{text}").parse::<Length>();
    }
}
