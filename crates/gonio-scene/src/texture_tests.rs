use super::*;
use proptest::prelude::*;

fn picture(width: usize, height: usize, data: RawData, transfer: Transfer) -> Texture {
    let image = RawImage {
        width,
        height,
        data,
        has_alpha: true,
    };
    Texture::new(Arc::new(Bitmap::new("test", image)), transfer)
}

/// A row of texels 0, 51, 102, … in red, with green the row number.
fn ramp(width: usize, height: usize) -> Texture {
    let texels = (0..width * height)
        .map(|i| [(i % width * 51) as u8, (i / width) as u8, 7, 255])
        .collect();
    picture(width, height, RawData::U8(texels), Transfer::Linear)
}

#[test]
fn texel_centres_are_exact_and_midpoints_are_means() {
    let t = ramp(4, 2);
    assert_eq!(t.sample([0.375, 0.25])[0], 0.2);
    assert!((t.sample([0.5, 0.25])[0] - 0.3).abs() < 1e-6);
    assert_eq!(t.sample([0.375, 0.25])[1], 0.0);
    assert_eq!(t.sample([0.375, 0.75])[1], 1.0 / 255.0);
    assert_eq!(t.sample([0.375, 0.75])[3], 1.0);
}

#[test]
fn wrap_modes_continue_as_they_say() {
    let mut t = ramp(4, 1);
    t.filter = Filter::Nearest;
    let red = |t: &Texture, u: f32| (t.sample([u, 0.5])[0] * 5.0).round() as i32;
    let row = |t: &Texture| {
        (-6..10)
            .map(|i| red(t, (i as f32 + 0.5) / 4.0))
            .collect::<Vec<_>>()
    };
    t.wrap = [Wrap::Repeat; 2];
    assert_eq!(row(&t), [2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1]);
    t.wrap = [Wrap::Clamp; 2];
    assert_eq!(row(&t), [0, 0, 0, 0, 0, 0, 0, 1, 2, 3, 3, 3, 3, 3, 3, 3]);
    t.wrap = [Wrap::Mirror; 2];
    assert_eq!(row(&t), [2, 3, 3, 2, 1, 0, 0, 1, 2, 3, 3, 2, 1, 0, 0, 1]);
}

/// The seam between the last and the first texel: repeat blends them, clamp does not.
#[test]
fn the_seam_is_filtered_by_the_wrap_mode() {
    let mut t = ramp(4, 1);
    assert!(
        (t.sample([0.0, 0.5])[0] - 0.3).abs() < 1e-6,
        "mean of 0 and 0.6"
    );
    assert!((t.sample([1.0, 0.5])[0] - 0.3).abs() < 1e-6);
    t.wrap = [Wrap::Clamp; 2];
    assert_eq!(t.sample([0.0, 0.5])[0], 0.0);
    assert!((t.sample([1.0, 0.5])[0] - 0.6).abs() < 1e-6);
    t.wrap = [Wrap::Mirror; 2];
    assert!((t.sample([1.0, 0.5])[0] - 0.6).abs() < 1e-6);
}

/// sRGB 188 is linear 0.5029 (IEC 61966-2-1: ((188/255 + 0.055)/1.055)^2.4 = 0.502886458).
#[test]
fn srgb_is_decoded_but_not_in_alpha() {
    for texels in [
        RawData::U8(vec![[188; 4]]),
        RawData::U16(vec![[188 * 257; 4]]),
    ] {
        let [r, _, _, a] = picture(1, 1, texels.clone(), Transfer::Srgb).sample([0.3, 0.3]);
        assert!((r - 0.502_886_5).abs() < 1e-6, "{r}");
        assert!((a - 188.0 / 255.0).abs() < 1e-6);
        let linear = picture(1, 1, texels, Transfer::Linear).sample([0.3, 0.3]);
        assert!((linear[0] - 188.0 / 255.0).abs() < 1e-6);
    }
}

/// A quarter turn counter-clockwise takes +u to −v (up in the picture).
#[test]
fn uv_transform_scales_then_turns_then_shifts() {
    let t = UvTransform::new([0.5, 0.25], std::f32::consts::FRAC_PI_2, [2.0, 3.0]);
    let [u, v] = t.apply([1.0, 0.0]);
    assert!((u - 0.5).abs() < 1e-6 && (v + 1.75).abs() < 1e-6, "{u} {v}");
    let [u, v] = t.apply([0.0, 1.0]);
    assert!((u - 3.5).abs() < 1e-6 && (v - 0.25).abs() < 1e-6, "{u} {v}");
}

#[test]
fn mean_of_a_ramp() {
    let mean = ramp(4, 2).mean();
    assert!((mean[0] - 0.3).abs() < 1e-7 && (mean[3] - 1.0).abs() < 1e-12);
}

proptest! {
    #[test]
    fn any_coordinates_give_a_value_between_the_texels(
        u in prop::num::f32::ANY, v in prop::num::f32::ANY, w in 0_usize..3, nearest in any::<bool>(),
    ) {
        let mut t = ramp(4, 3);
        t.wrap = [[Wrap::Repeat, Wrap::Clamp, Wrap::Mirror][w]; 2];
        t.filter = if nearest { Filter::Nearest } else { Filter::Bilinear };
        let [r, g, b, a] = t.sample([u, v]);
        prop_assert!((0.0..=0.6 + 1e-6).contains(&r) && (0.0..=2.0 / 255.0 + 1e-6).contains(&g));
        prop_assert!((b - 7.0 / 255.0).abs() < 1e-6 && a == 1.0);
    }
}
