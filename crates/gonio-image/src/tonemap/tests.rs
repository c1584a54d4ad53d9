use super::*;
use proptest::prelude::*;

fn near(found: [f32; 3], expected: [f64; 3]) {
    for (f, e) in found.into_iter().zip(expected) {
        assert!(
            (f64::from(f) - e).abs() < 2e-5,
            "{found:?} and {expected:?}"
        );
    }
}

/// The published equations, evaluated apart from this code in double precision.
#[test]
fn known_values() {
    let grey = [0.18; 3];
    let bright = [2.0, 0.5, 0.1];
    near(ToneMap::Linear.apply(bright), [1.0, 0.5, 0.1]);
    near(
        ToneMap::Aces.apply(grey),
        [0.105_591_247, 0.105_591_247, 0.105_590_191],
    );
    near(
        ToneMap::Aces.apply(bright),
        [0.901_499_261, 0.418_689_446, 0.105_000_791],
    );
    near(
        ToneMap::AgX.apply(grey),
        [0.214_467_431, 0.214_532_669, 0.214_536_728],
    );
    near(
        ToneMap::AgX.apply(bright),
        [0.807_289_343, 0.449_624_118, 0.210_690_485],
    );
    near(ToneMap::PbrNeutral.apply([1.0; 3]), [0.869_090_909; 3]);
    near(
        ToneMap::PbrNeutral.apply(bright),
        [0.96, 0.321_135_759, 0.150_771_961],
    );
}

/// The specification: "base colours below 0.8 reproduce exactly": with the 4 % Fresnel reflection of white light added,
/// f(c + 0.04) = c for min c ≥ 0.04 and max c ≤ 0.76. Darker, the offset is x − 6.25x², so that black stays black.
#[test]
fn neutral_takes_off_the_fresnel_offset_below_its_compression() {
    for r in [0.04f32, 0.2, 0.5, 0.759] {
        for b in [0.04f32, 0.33, 0.7] {
            let base = [r, 0.1, b];
            let shown = ToneMap::PbrNeutral.apply(base.map(|c| c + 0.04));
            near(shown, base.map(f64::from));
        }
    }
    // min = 0.02: the offset is 0.02 − 6.25 · 0.0004 = 0.0175.
    near(
        ToneMap::PbrNeutral.apply([0.02, 0.3, 0.5]),
        [0.0025, 0.2825, 0.4825],
    );
    // Continuous where compression starts.
    let below = ToneMap::PbrNeutral.apply([0.799_999; 3])[0];
    let above = ToneMap::PbrNeutral.apply([0.800_001; 3])[0];
    assert!((above - below).abs() < 1e-5 && above < 1.0);
}

#[test]
fn black_stays_black_and_grey_rises() {
    for map in ToneMap::ALL {
        assert_eq!(map.apply([0.0; 3]), [0.0; 3], "{map}");
        let mut last = [0.0f32; 3];
        // 2^−14 to 2^10 in 1/64 stops; where a curve is flat, rounding may take back a few last bits.
        for step in 0..24 * 64 {
            let grey = exposure_scale(step as f32 / 64.0 - 14.0);
            let shown = map.apply([grey; 3]);
            for (s, l) in shown.iter().zip(last) {
                assert!(*s >= l - 4e-7, "{map} at {grey}: {s} after {l}");
            }
            last = shown;
        }
        assert!(last.iter().all(|&c| c > 0.97), "{map} reaches {last:?}");
    }
}

#[test]
fn anything_becomes_something_a_screen_has() {
    let odd = [
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        -1.0,
        0.0,
        1e-45,
        1.0,
        1e20,
        f32::MAX,
    ];
    for map in ToneMap::ALL {
        for r in odd {
            for g in odd {
                for b in odd {
                    let shown = map.apply([r, g, b]);
                    assert!(
                        shown.iter().all(|c| (0.0..=1.0).contains(c)),
                        "{map} {r} {g} {b}: {shown:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn exposure_is_a_power_of_two() {
    assert_eq!(exposure_scale(0.0), 1.0);
    assert_eq!(exposure_scale(3.0), 8.0);
    assert_eq!(exposure_scale(-2.0), 0.25);
    assert!((exposure_scale(0.5) - std::f32::consts::SQRT_2).abs() < 1e-7);
    assert!((exposure_scale(-1.5) - 0.353_553_4).abs() < 1e-7);
    assert_eq!(exposure_scale(f32::NAN), 1.0);
    assert!(exposure_scale(1e9).is_finite() && exposure_scale(-1e9) > 0.0);
}

#[test]
fn names_come_back_and_others_are_refused() {
    for map in ToneMap::ALL {
        assert_eq!(map.to_string().parse::<ToneMap>().unwrap(), map);
    }
    assert_eq!("AgX".parse::<ToneMap>().unwrap(), ToneMap::AgX);
    assert_eq!("sRGB".parse::<ToneMap>().unwrap(), ToneMap::Linear);
    let error = "filmic".parse::<ToneMap>().unwrap_err().to_string();
    assert!(
        error.contains("`filmic`") && error.contains("agx"),
        "{error}"
    );
}

#[test]
fn codes_are_srgb() {
    assert_eq!(encode_srgb8([0.0, 0.214_041_14, 1.0]), [0, 128, 255]);
}

proptest! {
    #[test]
    fn colours_stay_in_range(r in 0.0f32..1e4, g in 0.0f32..100.0, b in 0.0f32..1.0) {
        for map in ToneMap::ALL {
            let shown = map.apply([r, g, b]);
            prop_assert!(shown.iter().all(|c| (0.0..=1.0).contains(c)), "{} {:?}", map, shown);
        }
    }
}
