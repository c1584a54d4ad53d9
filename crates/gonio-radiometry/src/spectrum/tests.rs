use super::*;
use crate::colour::{white_of, xy_of_xyz};
use crate::spectral_data;
use gonio_num::dual::Dual;
use gonio_num::lanes::Lanes;
use proptest::prelude::*;
use std::f64::consts::PI;

#[test]
fn constants_of_the_si() {
    // CODATA 2018, all exact, here to the digits it prints.
    assert!((FIRST_RADIATION_CONSTANT / 1.191_042_972e-16 - 1.0).abs() < 1e-9);
    assert!((SECOND_RADIATION_CONSTANT / 1.438_776_877e-2 - 1.0).abs() < 1e-9);
    assert!((STEFAN_BOLTZMANN / 5.670_374_419e-8 - 1.0).abs() < 1e-9);
    assert!((WIEN_DISPLACEMENT / 2.897_771_955e-3 - 1.0).abs() < 1e-9);
}

#[test]
fn planck_peaks_where_wien_says() {
    for t in [300.0, 2856.0, 5772.0, 20_000.0] {
        let body = BlackBody::new(t).unwrap();
        let peak = body.peak_nm();
        // d ln L/d ln λ = 0: the values at both sides differ by the third order in the step only.
        let h = 1e-4;
        let [below, above] = [peak * (1.0 - h), peak * (1.0 + h)].map(|l| body.at(l));
        assert!(body.at(peak) > below && body.at(peak) > above);
        // Half the curvature is about 5²/2: an error e of the peak shows as 2·12·h·e.
        assert!(((below - above) / body.at(peak)).abs() < 1e-9, "{t}");
        assert!((body.normalised().at(peak) - 1.0).abs() < 1e-15);
    }
}

#[test]
fn planck_integrates_to_stefan_and_boltzmann() {
    // Over u = ln λ from b/T · 10⁻² to b/T · 10⁴: the tails hold less than 10⁻⁹ of the whole.
    for t in [300.0, 3000.0, 6504.0] {
        let body = BlackBody::new(t).unwrap();
        let n = 4000;
        let (a, b) = (f64::ln(0.01), f64::ln(1e4));
        let sum: f64 = (0..n)
            .map(|i| {
                let l = body.peak_nm() * (a + (b - a) * (i as f64 + 0.5) / n as f64).exp();
                body.at(l) * l * (b - a) / n as f64
            })
            .sum();
        assert!((sum / body.total() - 1.0).abs() < 1e-6, "{t}: {sum}");
        assert!((body.total() * PI - STEFAN_BOLTZMANN * t.powi(4)).abs() < 1e-9 * t.powi(4));
    }
}

#[test]
fn planck_in_f32_and_at_the_edges() {
    for lambda in [1.0, 100.0, 360.0, 555.0, 830.0, 1e4, 1e7] {
        for t in [1.0, 300.0, 2856.0, 6504.0, 1e5, 1e8] {
            let wide: f64 = planck(lambda, t);
            let narrow = f64::from(planck(lambda as f32, t as f32));
            assert!(wide.is_finite() && wide >= 0.0, "{lambda} {t}");
            // The exponent c₂/λT is at most 87, with a relative error of 2⁻²³: 1e-5 of the value.
            if wide > 1e-30 && wide < 1e30 {
                assert!(
                    (narrow / wide - 1.0).abs() < 3e-5,
                    "{lambda} {t}: {narrow} {wide}"
                );
            }
        }
    }
    // Rayleigh–Jeans, 2ckT/λ⁴, where hc ≪ λkT.
    let rayleigh: f64 = 2.0 * 299_792_458.0 * 1.380_649e-23 * 1e6 / 1e-2f64.powi(4) * 1e-9;
    let x = SECOND_RADIATION_CONSTANT / (1e-2 * 1e6);
    assert!((planck(1e7, 1e6) / rayleigh - (1.0 - 0.5 * x)).abs() < 1e-10);
    for t in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(Spectrum::black_body(t).is_err());
    }
}

#[test]
fn planck_over_lanes_and_dual_numbers() {
    let lambda = [360.0f32, 555.0, 830.0, 2000.0];
    let wide = planck(Lanes(lambda), Lanes::splat(2856.0));
    assert_eq!(wide.0, lambda.map(|l| planck(l, 2856.0)));
    // Planck's law in terms of x = c₂/λT: d ln L/d ln T = x/(1 − e⁻ˣ), d ln L/d ln λ = that − 5.
    for (l, t) in [(400.0, 3000.0), (1e6, 2000.0)] {
        let d = planck(Dual::<f64, 2>::variable(l, 0), Dual::variable(t, 1));
        let x = SECOND_RADIATION_CONSTANT * 1e9 / (l * t);
        let by_t = x / (1.0 - (-x).exp());
        assert!((d.partials[1] * t / d.value / by_t - 1.0).abs() < 1e-8);
        assert!((d.partials[0] * l / d.value - (by_t - 5.0)).abs() < 1e-8);
    }
}

#[test]
fn white_points_of_the_illuminants() {
    // CIE 15:2018, table 3, CIE 1931 observer.
    for (illuminant, x, y) in [
        (Illuminant::A, 0.44758, 0.40745),
        (Illuminant::D50, 0.34567, 0.35851),
        (Illuminant::D55, 0.33243, 0.34744),
        (Illuminant::D65, 0.31272, 0.32903),
        (Illuminant::D75, 0.29903, 0.31488),
        (Illuminant::E, 0.33333, 0.33333),
    ] {
        let xy = xy_of_xyz(white_of(&illuminant.spectrum()));
        let error = (xy[0] - x).abs().max((xy[1] - y).abs());
        assert!(error < 5e-5, "{illuminant}: {xy:?}");
        assert!((illuminant.spectrum().at(560.0) - 100.0).abs() < 1e-9);
        assert_eq!(illuminant.name().to_lowercase().parse(), Ok(illuminant));
    }
    let error = "D56".parse::<Illuminant>().unwrap_err().to_string();
    assert!(error.contains("did you mean \"D5"), "{error}");
    let error = "fluorescent".parse::<Illuminant>().unwrap_err().to_string();
    assert!(error.contains("A, D50, D55, D65, D75, E"), "{error}");
}

#[test]
fn illuminants_are_the_published_tables() {
    // A few values of ISO/CIE 11664-2, whose digits are given here.
    for (lambda, value) in [
        (300.0, 0.0341),
        (460.0, 117.812),
        (630.0, 83.2886),
        (830.0, 60.3125),
    ] {
        assert!(
            (Illuminant::D65.spectrum().at(lambda) - value).abs() < 1e-3,
            "{lambda}"
        );
    }
    for (lambda, value) in [(300.0, 0.930483), (500.0, 59.8611), (780.0, 241.675)] {
        assert!(
            (Illuminant::A.spectrum().at(lambda) / value - 1.0).abs() < 1e-5,
            "{lambda}"
        );
    }
    for (illuminant, tolerance) in [
        (Illuminant::A, 1e-3),
        (Illuminant::D50, 2e-2),
        (Illuminant::D65, 1e-3),
    ] {
        let Some(path) = spectral_data(&format!("illuminant_{illuminant}.csv")) else {
            return;
        };
        let columns = SpectralColumns::read(&path).unwrap();
        for (&l, &v) in columns.lambda_nm.iter().zip(&columns.values[0]) {
            let ours = illuminant.spectrum().at(l);
            assert!((ours - v).abs() < tolerance, "{illuminant} {l}: {ours} {v}");
        }
    }
}

#[test]
fn daylight_has_its_range() {
    for t in [3999.0, 25_001.0, f64::NAN] {
        assert!(daylight(t).is_err());
        assert!(daylight_chromaticity(t).is_err());
    }
    // The two branches meet at 7000 K.
    let [a, b] = [7000.0, 7000.001].map(|t| daylight_chromaticity(t).unwrap());
    assert!((a[0] - b[0]).abs() < 1e-4 && (a[1] - b[1]).abs() < 1e-4);
}

#[test]
fn integrals_of_three_tables_are_exact() {
    // λ ↦ (λ−400)/100 and its square and cube over [400, 500]: 100/2, 100/3, 100/4; the knots in between don't matter.
    let ramp = Spectrum::irregular(vec![400.0, 437.0, 500.0], vec![0.0, 0.37, 1.0]).unwrap();
    let same =
        Spectrum::regular(400.0, 10.0, (0..=10).map(|i| f64::from(i) / 10.0).collect()).unwrap();
    let range = WavelengthRange {
        min_nm: 400.0,
        max_nm: 500.0,
    };
    for (factors, exact) in [
        (vec![&ramp], 50.0),
        (vec![&ramp, &same], 100.0 / 3.0),
        (vec![&ramp, &same, &same], 25.0),
    ] {
        let sum = Spectrum::integrate_product(&factors, range);
        assert!((sum - exact).abs() < 1e-12, "{sum} {exact}");
    }
    // Held beyond the ends: 50 more up to 550, nothing below 400.
    let wide = WavelengthRange {
        min_nm: 300.0,
        max_nm: 550.0,
    };
    assert!((ramp.integrate(wide) - 100.0).abs() < 1e-12);
    // Zero beyond the ends: the jump doesn't leak.
    let boxed = Spectrum::Irregular(std::sync::Arc::new(
        Irregular::new(vec![410.5, 420.25], vec![2.0, 2.0], Beyond::Zero).unwrap(),
    ));
    assert!((boxed.integrate(wide) - 19.5).abs() < 1e-12);
    assert!((boxed.times(&same).integrate(wide) - 2.0 * 9.75 * 0.15375).abs() < 1e-12);
    assert_eq!(boxed.at(420.25), 2.0);
    assert_eq!(boxed.at(420.26), 0.0);
    assert_eq!(boxed.at(410.4), 0.0);
    let empty = WavelengthRange {
        min_nm: 500.0,
        max_nm: 400.0,
    };
    assert_eq!(ramp.integrate(empty), 0.0);
    assert_eq!(Spectrum::Constant(3.0).integrate(range), 300.0);
    // Smooth ones: sin over a half period of 100 nm. Simpson's error is (π/100)⁴/2880 of the whole: 2e-8.
    let wave = Spectrum::function(|l| gonio_num::Real::sin(PI * (l - 400.0) / 100.0));
    assert!((wave.integrate(range) - 200.0 / PI).abs() < 3e-8);
}

#[test]
fn tables_interpolate_and_hold() {
    let one = Spectrum::regular(500.0, 5.0, vec![0.25]).unwrap();
    for l in [1.0, 500.0, 1e6] {
        assert_eq!(one.at(l), 0.25);
    }
    let t = Spectrum::regular(500.0, 5.0, vec![1.0, 3.0, 0.0]).unwrap();
    for (l, v) in [
        (400.0, 1.0),
        (500.0, 1.0),
        (502.5, 2.0),
        (505.0, 3.0),
        (507.5, 1.5),
        (510.0, 0.0),
        (600.0, 0.0),
    ] {
        assert_eq!(t.at(l), v, "{l}");
    }
    assert_eq!(t.scaled(2.0).at(502.5), 4.0);
    let nan = f64::NAN;
    for (l, v) in [
        (vec![], vec![]),
        (vec![1.0], vec![1.0, 2.0]),
        (vec![2.0, 1.0], vec![1.0, 2.0]),
        (vec![1.0, 1.0], vec![1.0, 2.0]),
        (vec![-1.0, 1.0], vec![1.0, 2.0]),
        (vec![nan, 1.0], vec![1.0, 2.0]),
        (vec![1.0, 2.0], vec![1.0, nan]),
        (vec![1.0, f64::INFINITY], vec![1.0, 2.0]),
    ] {
        assert!(Spectrum::irregular(l, v).is_err());
    }
    for (first, step, v) in [
        (0.0, 1.0, vec![1.0]),
        (1.0, 0.0, vec![1.0]),
        (1.0, nan, vec![1.0]),
        (1.0, 1.0, vec![]),
        (1.0, 1.0, vec![f64::INFINITY]),
    ] {
        assert!(Spectrum::regular(first, step, v).is_err());
    }
}

#[test]
fn text_in_its_usual_forms() {
    for text in [
        "400 0.1\n500 0.2\n",
        "# a comment\r\n\r\n400\t0.1 # here too\r\n500\t0.2",
        "nm,spd\n400,0.1\n500,0.2\n",
        "\u{feff}wavelength;value\n400;0.1\n500;0.2\n",
        "  4e2 , 1e-1 \n 500. , .2 ",
    ] {
        let s = Spectrum::parse(text, "test.spd").unwrap_or_else(|e| panic!("{text}: {e}"));
        assert!((s.at(450.0) - 0.15).abs() < 1e-15);
    }
    let two = SpectralColumns::parse("nm,eta,k\n400,1,2\n500,3,4\n", "two.csv").unwrap();
    assert_eq!(two.names, ["eta", "k"]);
    assert_eq!(two.spectrum(1).unwrap().at(450.0), 3.0);
    assert!(two.spectrum(2).is_none());
}

#[test]
fn broken_text_is_named_with_its_line() {
    let huge = format!("{} 1", "9".repeat(5000));
    for (text, place, needle) in [
        ("", "line 1", "no row of numbers"),
        ("# only\n# comments\n", "line 2", "no row of numbers"),
        ("nm,spd\n", "line 1", "no row of numbers"),
        (
            "nm\n400\n",
            "line 2",
            "1 field(s); expected a wavelength and 1 value(s)",
        ),
        (
            "400 1\n500",
            "line 2",
            "1 field(s); expected a wavelength and 1 value(s)",
        ),
        ("400 1\n500 2 3", "line 2", "3 field(s)"),
        ("400,1\n500,\n", "line 2", "\"\"; expected a finite number"),
        (
            "400 1\n500 x\n",
            "line 2",
            "\"x\"; expected a finite number",
        ),
        ("400 NaN\n", "line 1", "\"NaN\""),
        ("400 1\n500 inf\n", "line 2", "\"inf\""),
        ("400 1\n400 2\n", "line 2", "400 nm after 400 nm"),
        ("400 1\n\n300 2\n", "line 3", "300 nm after 400 nm"),
        ("-400 1\n", "line 1", "increasing"),
        ("0.4 1\n0.5 2\n", "line 2", "look like µm"),
        ("nm,a,b\n400,1,2\n", "line 1", "2 values a row"),
        (huge.as_str(), "line 1", "expected a finite number"),
    ] {
        let error = Spectrum::parse(text, "broken.spd").unwrap_err().to_string();
        assert!(
            error.starts_with(&format!("broken.spd, {place}:")),
            "{error}"
        );
        assert!(error.contains(needle), "{error}");
        assert!(error.len() < 300);
    }
}

#[test]
fn broken_files_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("missing.spd");
    let error = Spectrum::read(&path).unwrap_err().to_string();
    assert!(error.contains("missing.spd can't be read"), "{error}");
    let binary = folder.path().join("binary.spd");
    std::fs::write(&binary, [0x34, 0x30, 0xff, 0xfe]).unwrap();
    let error = Spectrum::read(&binary).unwrap_err().to_string();
    assert!(error.contains("byte 2 isn't UTF-8"), "{error}");
    let large = folder.path().join("large.spd");
    std::fs::File::create(&large)
        .unwrap()
        .set_len(1 << 30)
        .unwrap();
    let error = Spectrum::read(&large).unwrap_err().to_string();
    assert!(error.contains("larger than 16777216 bytes"), "{error}");
    assert!(Spectrum::read(folder.path()).is_err());
    let good = folder.path().join("good.spd");
    std::fs::write(&good, "400 1\n500 2\n").unwrap();
    assert_eq!(Spectrum::read(&good).unwrap().at(450.0), 1.5);
}

#[test]
fn metals_of_the_shared_data_are_read() {
    let Some(folder) = spectral_data("ior") else {
        return;
    };
    let mut count = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "spd") {
            let s = Spectrum::read(&path).unwrap();
            assert!(s.at(555.0) >= 0.0, "{}", path.display());
            count += 1;
        }
    }
    assert!(count > 10, "{count} files");
}

proptest! {
    #[test]
    fn regular_and_irregular_agree(values in prop::collection::vec(-1.0..1.0f64, 2..20), x in -0.5..1.5f64) {
        let n = values.len();
        let lambda = 400.0 + x * 5.0 * (n - 1) as f64;
        let a = Spectrum::regular(400.0, 5.0, values.clone()).unwrap();
        let b = Spectrum::irregular((0..n).map(|i| 400.0 + 5.0 * i as f64).collect(), values).unwrap();
        prop_assert!((a.at(lambda) - b.at(lambda)).abs() < 1e-12);
        prop_assert!((a.integrate(VISIBLE) - b.integrate(VISIBLE)).abs() < 1e-9);
    }

    #[test]
    fn no_text_panics(text in "[0-9a-z.,;# \t\n+-]{0,200}") {
        let _ = SpectralColumns::parse(&text, "any");
    }
}
