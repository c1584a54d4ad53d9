use super::*;
use crate::colour::{RgbSpace, xyz_of_emission};
use crate::quantity::RadiantFlux;
use crate::spectrum::Illuminant;

#[test]
fn the_candela_is_683_lumens_a_watt_at_540_thz() {
    // K_m is K_cd / V(555.016 nm), to the six digits that the standard gives.
    let derived = LUMINOUS_EFFICACY_540_THZ / luminous_efficiency(LAMBDA_540_THZ_NM);
    assert!((derived - MAX_LUMINOUS_EFFICACY).abs() < 1e-3, "{derived}");
    let flux = RadiantFlux::new(1.0) * efficacy_at(LAMBDA_540_THZ_NM);
    assert!((flux.value() - 683.0).abs() < 1e-3);
    assert_eq!(luminous_efficiency(555.0), 1.0);
    assert_eq!(luminous_efficiency(359.9), 0.0);
    assert_eq!(luminous_efficiency(830.1), 0.0);
}

#[test]
fn efficacies() {
    // ∫ V dλ = 106.8569 nm (by 1 nm); over 470 nm of equal power 683.002 · 106.8569 / 470.
    let v = Observer::cie_1931().y.integrate(VISIBLE);
    assert!((v - 106.8569).abs() < 1e-4, "{v}");
    let equal = efficacy_of(&Illuminant::E.spectrum());
    assert!((equal.value() - 155.284).abs() < 1e-3, "{equal}");
    // A black body, all radiation counted: 54.7 lm/W at 4000 K and 95 lm/W at 7000 K (Wikipedia, "Luminous efficacy").
    let body = |t| efficacy_of_black_body(BlackBody::new(t).unwrap()).value();
    assert!((body(4000.0) - 54.7).abs() < 0.1, "{}", body(4000.0));
    assert!((body(7000.0) - 95.0).abs() < 0.5, "{}", body(7000.0));
    // The best is near 6640 K.
    assert!(body(6640.0) > body(6400.0) && body(6640.0) > body(6900.0));
}

#[test]
fn luminance_of_rgb_and_of_spectra_agree() {
    let light = Illuminant::D65.spectrum();
    let rgb = RgbSpace::SRGB.from_xyz().apply(xyz_of_emission(&light));
    let by_rgb = luminance_of_rgb(rgb, LuminousEfficacy::new(MAX_LUMINOUS_EFFICACY));
    let by_spectrum = luminance_of(&light);
    assert!((by_rgb / by_spectrum - 1.0).abs() < 1e-12);
    assert!((relative_luminance([1.0f64; 3]) - 1.0).abs() < 1e-15);
    assert!((relative_luminance([0.0, 1.0, 0.0f32]) - 0.7152).abs() < 5e-5);
}
