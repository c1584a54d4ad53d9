use super::*;
use crate::spectrum::{Illuminant, SpectralColumns, Spectrum};
use gonio_num::Real;
use gonio_num::lanes::Lanes;
use proptest::prelude::*;

fn assert_matrix(ours: Matrix3, published: [[f64; 3]; 3], tolerance: f64) {
    for (a, b) in ours.0.iter().flatten().zip(published.iter().flatten()) {
        assert!((a - b).abs() < tolerance, "{a} {b}: {ours:?}");
    }
}

#[test]
fn matrices_are_the_published_ones() {
    // IEC 61966-2-1.
    let srgb = [
        [0.4124, 0.3576, 0.1805],
        [0.2126, 0.7152, 0.0722],
        [0.0193, 0.1192, 0.9505],
    ];
    assert_matrix(RgbSpace::SRGB.to_xyz(), srgb, 5.1e-5);
    // ITU-R BT.2020, by its primaries; Y row as in the recommendation.
    let rec2020 = [
        [0.6370, 0.1446, 0.1689],
        [0.2627, 0.6780, 0.0593],
        [0.0000, 0.0281, 1.0610],
    ];
    assert_matrix(RgbSpace::REC2020.to_xyz(), rec2020, 1e-4);
    // SMPTE ST 2065-1, equation for X, Y, Z.
    let ap0 = [
        [0.9525523959, 0.0, 0.0000936786],
        [0.3439664498, 0.7281660966, -0.0721325464],
        [0.0, 0.0, 1.0088251844],
    ];
    assert_matrix(RgbSpace::ACES2065_1.to_xyz(), ap0, 1e-9);
    // Academy S-2014-004.
    let ap1 = [
        [0.6624541811, 0.1340042065, 0.1561876870],
        [0.2722287168, 0.6740817658, 0.0536895174],
        [-0.0055746495, 0.0040607335, 1.0103391003],
    ];
    assert_matrix(RgbSpace::ACESCG.to_xyz(), ap1, 1e-9);
    // sRGB to ACEScg with Bradford, as in OpenColorIO's configurations.
    let to_ap1 = [
        [0.6131, 0.3395, 0.0474],
        [0.0702, 0.9164, 0.0135],
        [0.0206, 0.1096, 0.8698],
    ];
    assert_matrix(RgbSpace::SRGB.to_space(&RgbSpace::ACESCG), to_ap1, 1e-4);
}

#[test]
fn bradford_from_d65_to_d50() {
    // Lindbloom, "Chromatic Adaptation", with his whites.
    let m = bradford([0.95047, 1.0, 1.08883], [0.96422, 1.0, 0.82521]);
    let published = [
        [1.0478112, 0.0228866, -0.0501270],
        [0.0295424, 0.9904844, -0.0170491],
        [-0.0092345, 0.0150436, 0.7521316],
    ];
    assert_matrix(m, published, 1e-6);
    assert_eq!(
        bradford([0.9, 1.0, 1.1], [0.9, 1.0, 1.1]),
        Matrix3::IDENTITY
    );
    let singular = Matrix3([[1.0; 3]; 3]);
    assert_eq!(von_kries(&singular, [1.0; 3], [1.0; 3]), None);
    assert_eq!(
        von_kries(&Matrix3::IDENTITY, [0.0, 1.0, 1.0], [1.0; 3]),
        None
    );
}

#[test]
fn white_is_white_in_every_space() {
    for a in RgbSpace::ALL {
        assert!((a.luminance_weights().iter().sum::<f64>() - 1.0).abs() < 1e-14);
        let xy = xy_of_xyz(a.to_xyz().apply([1.0; 3]));
        assert!((xy[0] - a.white[0]).abs() < 1e-14 && (xy[1] - a.white[1]).abs() < 1e-14);
        for b in RgbSpace::ALL {
            for c in a.to_space(&b).apply([1.0; 3]) {
                assert!((c - 1.0).abs() < 1e-13, "{} {}", a.name, b.name);
            }
        }
        let reflector = rgb_of_reflectance(&Spectrum::Constant(1.0), &Illuminant::A.spectrum(), &a);
        assert!(reflector.iter().all(|c| (c - 1.0).abs() < 1e-13));
        assert_eq!(a.name.to_lowercase().replace('-', " ").parse(), Ok(a));
    }
    assert_eq!("BT.709".parse(), Ok(RgbSpace::SRGB));
    let error = "sRBG".parse::<RgbSpace>().unwrap_err().to_string();
    assert!(error.contains("did you mean \"sRGB\""), "{error}");
}

#[test]
fn srgb_transfer() {
    // IEC 61966-2-1's formula, evaluated by hand.
    for (linear, encoded) in [
        (0.0, 0.0),
        (0.002, 0.02584),
        (0.003_130_8, 0.040_449_936),
        (0.5, 0.735_356_983_052_449),
        (1.0, 1.0),
    ] {
        assert!((srgb_encode(linear) - encoded).abs() < 1e-12, "{linear}");
        assert!((srgb_decode(encoded) - linear).abs() < 1e-9, "{linear}");
        assert_eq!(srgb_encode(-linear), -srgb_encode(linear));
    }
    assert!((srgb_decode(0.5f64) - 0.214_041_140_482_232).abs() < 1e-12);
    let values = [-0.5f32, 0.002, 0.0031, 0.7];
    assert_eq!(srgb_encode(Lanes(values)).0, values.map(srgb_encode));
    assert_eq!(srgb_decode(Lanes(values)).0, values.map(srgb_decode));
    // Every 8-bit code returns, in f32.
    for code in 0..=255u8 {
        let linear = srgb_decode(f32::from(code) / 255.0);
        assert_eq!((srgb_encode(linear) * 255.0 + 0.5) as u8, code);
    }
}

#[test]
fn delta_e_2000_of_the_published_pairs() {
    // Sharma, Wu and Dalal 2005, table 1: pairs 1, 4, 7, 9, 11, 13, 17 to 21, 25, 26, 34.
    for (a, b, expected) in [
        ([50.0, 2.6772, -79.7751], [50.0, 0.0, -82.7485], 2.0425),
        ([50.0, -1.3802, -84.2814], [50.0, 0.0, -82.7485], 1.0000),
        ([50.0, 0.0, 0.0], [50.0, -1.0, 2.0], 2.3669),
        ([50.0, 2.4900, -0.0010], [50.0, -2.4900, 0.0009], 7.1792),
        ([50.0, 2.4900, -0.0010], [50.0, -2.4900, 0.0011], 7.2195),
        ([50.0, -0.0010, 2.4900], [50.0, 0.0009, -2.4900], 4.8045),
        ([50.0, 2.5, 0.0], [50.0, 0.0, -2.5], 4.3065),
        ([50.0, 2.5, 0.0], [73.0, 25.0, -18.0], 27.1492),
        ([50.0, 2.5, 0.0], [61.0, -5.0, 29.0], 22.8977),
        ([50.0, 2.5, 0.0], [56.0, -27.0, -3.0], 31.9030),
        ([50.0, 2.5, 0.0], [58.0, 24.0, 15.0], 19.4535),
        (
            [60.2574, -34.0099, 36.2677],
            [60.4626, -34.1751, 39.4387],
            1.2644,
        ),
        (
            [63.0109, -31.0961, -5.8663],
            [62.8187, -29.7946, -4.0864],
            1.2630,
        ),
        (
            [2.0776, 0.0795, -1.1350],
            [0.9033, -0.0636, -0.5514],
            0.9082,
        ),
    ] {
        assert!(
            (delta_e_2000(a, b) - expected).abs() < 5.1e-5,
            "{a:?} {b:?} {}",
            delta_e_2000(a, b)
        );
        assert!((delta_e_2000(b, a) - expected).abs() < 5.1e-5);
        assert_eq!(delta_e_2000(a, a), 0.0);
    }
}

#[test]
fn lab_of_known_colours() {
    let white = [0.9504, 1.0, 1.0888];
    assert_eq!(lab_of_xyz(white, white), [100.0, 0.0, 0.0]);
    let black = lab_of_xyz([0.0; 3], white);
    assert!(black.iter().all(|c| c.abs() < 1e-12));
    // Grey of 18.42 %: L* = 50.
    let grey = lab_of_xyz(white.map(|c| 0.184_186_5 * c), white);
    assert!((grey[0] - 50.0).abs() < 1e-4 && grey[1].abs() < 1e-12 && grey[2].abs() < 1e-12);
}

#[test]
fn black_bodies_and_daylight_have_their_temperatures() {
    for t in [2000.0, 2856.0, 6504.0, 20_000.0] {
        let xyz = xyz_of_emission(&Spectrum::black_body(t).unwrap());
        let found = correlated_colour_temperature(xy_of_xyz(xyz)).unwrap();
        assert!((found.kelvin / t - 1.0).abs() < 1e-5, "{t}: {found:?}");
        assert!(found.duv.abs() < 1e-7);
    }
    // A black body of 6504 K: (0.3134, 0.3236) in tables to four digits.
    let xy = xy_of_xyz(xyz_of_emission(&Spectrum::black_body(6504.0).unwrap()));
    assert!(
        (xy[0] - 0.3134).abs() < 1e-4 && (xy[1] - 0.3236).abs() < 1e-4,
        "{xy:?}"
    );
    // D65: 6504 K and 0.0032 above the locus, on the green side.
    let d65 =
        correlated_colour_temperature(xy_of_xyz(white_of(&Illuminant::D65.spectrum()))).unwrap();
    assert!((d65.kelvin - 6504.0).abs() < 3.0, "{d65:?}");
    assert!((d65.duv - 0.0032).abs() < 1e-4, "{d65:?}");
    for bad in [[0.7, 0.29], [f64::NAN, 0.3], [0.3, 0.0]] {
        assert!(correlated_colour_temperature(bad).is_err(), "{bad:?}");
    }
}

#[test]
fn color_checker() {
    // CIELAB under D50 of the chart's 24 patches, as its maker published in 2005.
    const LAB: [[f64; 3]; 24] = [
        [37.986, 13.555, 14.059],
        [65.711, 18.13, 17.81],
        [49.927, -4.88, -21.925],
        [43.139, -13.095, 21.905],
        [55.112, 8.844, -25.399],
        [70.719, -33.397, -0.199],
        [62.661, 36.067, 57.096],
        [40.02, 10.41, -45.964],
        [51.124, 48.239, 16.248],
        [30.325, 22.976, -21.587],
        [72.532, -23.709, 57.255],
        [71.941, 19.363, 67.857],
        [28.778, 14.179, -50.297],
        [55.261, -38.342, 31.37],
        [42.101, 53.378, 28.19],
        [81.733, 4.039, 79.819],
        [51.935, 49.986, -14.574],
        [51.038, -28.631, -28.638],
        [96.539, -0.425, 1.186],
        [81.257, -0.638, -0.335],
        [66.766, -0.734, -0.504],
        [50.867, -0.153, -0.27],
        [35.656, -0.421, -1.231],
        [20.461, -0.079, -0.973],
    ];
    let Some(path) = crate::spectral_data("colorchecker_babelcolor_avg.csv") else {
        return;
    };
    let chart = SpectralColumns::read(&path).unwrap();
    let light = Illuminant::D50.spectrum();
    let mut sum = 0.0;
    for (i, expected) in LAB.iter().enumerate() {
        let xyz = xyz_of_reflectance(&chart.spectrum(i).unwrap(), &light);
        let difference = delta_e_2000(lab_of_xyz(xyz, white_of(&light)), *expected);
        // The measured charts of the file's average differ from the maker's by about 1.
        assert!(difference < 2.0, "{}: {difference}", chart.names[i]);
        sum += difference;
    }
    assert!(sum / 24.0 < 1.0, "{}", sum / 24.0);
}

#[test]
fn emission_keeps_its_colour_and_scale() {
    let light = Illuminant::A.spectrum();
    let rgb = rgb_of_emission(&light, &RgbSpace::SRGB);
    assert!(rgb[0] > rgb[1] && rgb[1] > rgb[2]);
    let twice = rgb_of_emission(&light.scaled(2.0), &RgbSpace::SRGB);
    for k in 0..3 {
        assert!((twice[k] / rgb[k] - 2.0).abs() < 1e-12);
    }
}

proptest! {
    #[test]
    fn maps_return(r in -1.0..2.0f64, g in -1.0..2.0f64, b in -1.0..2.0f64) {
        for space in RgbSpace::ALL {
            let back = space.from_xyz().apply(space.to_xyz().apply([r, g, b]));
            for (c, d) in back.into_iter().zip([r, g, b]) {
                prop_assert!((c - d).abs() < 1e-12);
            }
        }
        for x in [r, g, b] {
            // The standard's two pieces overlap by 4e-8 in the encoded value.
            prop_assert!((srgb_decode(srgb_encode(x)) - x).abs() < 1e-8);
            let narrow = f64::from(srgb_encode(x as f32));
            prop_assert!((narrow - srgb_encode(x)).abs() < 2e-6);
        }
    }

    #[test]
    fn lab_returns(x in 0.0..2.0f64, y in 0.0..2.0f64, z in 0.0..2.0f64) {
        let white = [0.9, 1.0, 1.1];
        let back = xyz_of_lab(lab_of_xyz([x, y, z], white), white);
        for (c, d) in back.into_iter().zip([x, y, z]) {
            prop_assert!((c - d).abs() < 1e-12);
        }
    }

    #[test]
    fn small_delta_e_2000_is_continuous(l in 1.0..99.0f64, a in -90.0..90.0f64, b in -90.0..90.0f64) {
        // Where hue is defined the difference of neighbours is at most a few times their distance.
        prop_assume!(a.abs() + b.abs() > 1.0);
        let p = [l, a, b];
        let q = [l + 1e-3, a - 1e-3, b + 1e-3];
        let d = delta_e_2000(p, q);
        prop_assert!(d > 0.0 && d < 4.0 * delta_e_76(p, q), "{d}");
        prop_assert!((delta_e_2000(q, p) - d).abs() < 1e-12);
    }

    #[test]
    fn inverses_of_matrices(m in prop::array::uniform3(prop::array::uniform3(-1.0..1.0f64))) {
        let m = Matrix3(m);
        prop_assume!(m.determinant().abs() > 1e-3);
        let identity = m.then(&m.inverse().unwrap());
        for i in 0..3 {
            for j in 0..3 {
                prop_assert!((identity.0[i][j] - f64::from(u8::from(i == j))).abs() < 1e-9);
            }
        }
        let v = [0.3, -0.2, 0.9];
        prop_assert!((m.apply(v)[0] - (m.0[0][0] * 0.3 - m.0[0][1] * 0.2 + m.0[0][2] * 0.9)).abs() < 1e-15);
        prop_assert!(m.determinant().abs() <= 6.0f64.sq());
    }
}
