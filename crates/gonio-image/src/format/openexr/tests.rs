use super::*;
use crate::{Compression, f16};
use exr::image::{AnyChannel, AnyChannels, Blocks, Encoding, FlatSamples, Layer};
use exr::meta::attribute::{self, LineOrder};
use exr::meta::header::LayerAttributes;
use proptest::prelude::*;

fn read(bytes: &[u8]) -> Result<Layers, ImageError> {
    decode("test.exr", Cursor::new(bytes), &Limits::default())
}

fn write(layers: &Layers, compression: Compression) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    encode("test.exr", layers, compression, &mut file).unwrap();
    file.into_inner()
}

/// As they are read: sorted.
fn sorted(mut layers: Layers) -> Layers {
    layers
        .channels
        .sort_by(|a, b| a.name.as_bytes().cmp(b.name.as_bytes()));
    layers.metadata.sort();
    layers
}

fn mixed() -> Layers {
    let image = Image::from_fn(19, 23, |x, y| [x as f32 * 0.1, (y as f32).sqrt(), 1e-3]);
    let mut layers = Layers::from_image(&image);
    let half = (0..19 * 23)
        .map(|i| f16::from_f32(i as f32 * 0.25))
        .collect();
    layers.push("depth.Z", ChannelData::Half(half)).unwrap();
    let ids = (0..19 * 23)
        .map(|i: u32| i.wrapping_mul(99_999_989))
        .collect();
    layers.push("id", ChannelData::Uint(ids)).unwrap();
    layers.set_metadata("samples", "256");
    layers.set_metadata("comments", "a comment");
    layers.set_metadata("owner", "");
    layers.set_metadata("scene", "Möbelhaus ±1 – 家具");
    layers
}

#[test]
fn everything_comes_back_under_every_compression() {
    let layers = mixed();
    for compression in [
        Compression::None,
        Compression::Rle,
        Compression::Zip,
        Compression::Piz,
    ] {
        let back = read(&write(&layers, compression)).unwrap();
        assert_eq!(back, sorted(layers.clone()), "{compression:?}");
    }
}

#[test]
fn the_same_picture_is_the_same_file() {
    let first = write(&mixed(), Compression::Zip);
    for _ in 0..5 {
        assert_eq!(write(&mixed(), Compression::Zip), first);
    }
}

#[test]
fn non_finite_and_negative_values_are_kept() {
    let mut image = Image::filled(3, 1, [f32::NEG_INFINITY, -0.0, -7.5]);
    image.set(1, 0, [f32::NAN; 3]);
    let back = decode_image(
        "t",
        Cursor::new(write(&Layers::from_image(&image), Compression::Zip)),
        &Limits::default(),
    );
    let scan = back.unwrap().scan();
    assert_eq!((scan.nan, scan.infinite, scan.negative), (3, 2, 2));
}

#[test]
fn half_precision_rounds() {
    let image = Image::filled(2, 2, [0.1, 65_504.0, 1e6]);
    let layers = Layers::from_image(&image).to_half();
    let shown = read(&write(&layers, Compression::Piz))
        .unwrap()
        .to_image()
        .unwrap();
    assert_eq!(shown.get(1, 1), [0.099_975_586, 65_504.0, f32::INFINITY]);
}

#[test]
fn the_shown_layer() {
    let image = Image::filled(2, 1, [1.0, 2.0, 3.0]);
    let grey = |v: f32| ChannelData::Float(vec![v; 2]);
    let show = |layers: &Layers| {
        decode_image(
            "t",
            Cursor::new(write(layers, Compression::None)),
            &Limits::default(),
        )
    };

    let mut layers = Layers::new(2, 1);
    layers.push("Z", grey(9.0)).unwrap();
    assert_eq!(
        show(&layers).unwrap().get(0, 0),
        [9.0; 3],
        "an only channel is grey"
    );
    layers.push("normal.X", grey(8.0)).unwrap();
    let error = show(&layers).unwrap_err().to_string();
    assert!(
        error.contains("Z, normal.X") && error.contains("not supported"),
        "{error}"
    );
    layers.push_rgb("albedo", &image).unwrap();
    assert_eq!(
        show(&layers).unwrap(),
        image,
        "the first layer with R, G and B"
    );
    layers.push("Y", grey(4.0)).unwrap();
    assert_eq!(
        show(&layers).unwrap().get(1, 0),
        [4.0; 3],
        "the default layer's Y"
    );
    layers.push_rgb("", &Image::filled(2, 1, [5.0; 3])).unwrap();
    assert_eq!(
        show(&layers).unwrap().get(1, 0),
        [5.0; 3],
        "the default layer's R, G and B"
    );
    layers.push("A", grey(0.5)).unwrap();
    let raw = decode_raw("t", &write(&layers, Compression::None), &Limits::default()).unwrap();
    assert!(raw.has_alpha);
    assert_eq!(raw.get(0, 0), [5.0, 5.0, 5.0, 0.5]);
}

#[test]
fn other_primaries_are_kept_and_converted_when_shown() {
    let mut layers = Layers::from_image(&Image::filled(1, 1, [0.0, 1.0, 0.0]));
    let rec2020 = Chromaticities {
        red: [0.708, 0.292],
        green: [0.170, 0.797],
        blue: [0.131, 0.046],
        white: [0.3127, 0.3290],
    };
    layers.chromaticities = Some(rec2020);
    let back = read(&write(&layers, Compression::Zip)).unwrap();
    assert_eq!(back.chromaticities, Some(rec2020));
    assert_eq!(back.rgb("").unwrap().get(0, 0), [0.0, 1.0, 0.0]);
    // ITU-R BT.2087, the column of green.
    let shown = back.to_image().unwrap().get(0, 0);
    for (c, expected) in shown.into_iter().zip([-0.5876, 1.1329, -0.1006]) {
        assert!((c - expected).abs() < 1e-3, "{shown:?}");
    }
}

#[test]
fn tiles_and_several_parts_are_read() {
    use exr::image::write::WritableImage;
    use exr::meta::header::ImageAttributes;
    let size = Vec2(20, 11);
    let samples = |v: f32| FlatSamples::F32((0..220).map(|i| v + i as f32).collect());
    let part = |name: &str, v: f32| {
        let list = ["R", "G", "B"].map(|c| AnyChannel::new(c, samples(v)));
        let encoding = Encoding {
            compression: attribute::Compression::PXR24,
            blocks: Blocks::Tiles(Vec2(7, 5)),
            line_order: LineOrder::Increasing,
        };
        Layer::new(
            size,
            LayerAttributes::named(name),
            encoding,
            AnyChannels::sort(list.into_iter().collect()),
        )
    };
    let file = |parts: Vec<Layer<AnyChannels<FlatSamples>>>| {
        let mut bytes = Vec::new();
        exr::image::Image::from_layers(ImageAttributes::with_size(size), parts)
            .write()
            .non_parallel()
            .to_buffered(Cursor::new(&mut bytes))
            .unwrap();
        bytes
    };
    let one = read(&file(vec![part("only", 1.0)])).unwrap();
    assert_eq!(
        one.channels
            .iter()
            .map(|c| c.name.as_str())
            .collect::<Vec<_>>(),
        ["B", "G", "R"]
    );
    assert_eq!(one.to_image().unwrap().get(19, 10), [220.0; 3]);
    let two = read(&file(vec![part("beauty", 1.0), part("albedo", 5.0)])).unwrap();
    assert_eq!(two.channels.len(), 6);
    assert_eq!(two.rgb("albedo").unwrap().get(3, 0), [8.0; 3]);
    assert_eq!(
        two.to_image().unwrap().get(3, 0),
        [4.0; 3],
        "the first part is shown"
    );
}

#[test]
fn what_cannot_be_written_is_refused() {
    let fails = |change: &dyn Fn(&mut Layers), words: &str| {
        let mut layers = Layers::from_image(&Image::new(2, 2));
        change(&mut layers);
        let error = encode(
            "test.exr",
            &layers,
            Compression::Zip,
            &mut Cursor::new(Vec::new()),
        )
        .unwrap_err();
        assert!(matches!(error, ImageError::Parameter { .. }));
        assert!(error.to_string().contains(words), "{error}");
    };
    fails(&|l| l.channels.clear(), "0 channels");
    fails(&|l| l.width = 0, "0 × 2");
    fails(&|l| l.width = 3, "4 samples");
    fails(
        &|l| l.channels[1].name = "R".into(),
        "two channels are named `R`",
    );
    fails(&|l| l.channels[1].name = String::new(), "1 to 255 bytes");
    fails(&|l| l.channels[1].name = "x".repeat(256), "1 to 255 bytes");
    fails(&|l| l.set_metadata("a\0b", ""), "without NUL");
    fails(
        &|l| l.set_metadata("channels", "R"),
        "reserves the attribute name `channels`",
    );
    fails(
        &|l| l.metadata = vec![("a".into(), "1".into()); 2],
        "two attributes are named `a`",
    );
    fails(
        &|l| l.metadata = vec![("owner".into(), "1".into()); 2],
        "two attributes are named `owner`",
    );
}

#[test]
fn layers_refuse_what_does_not_fit() {
    let mut layers = Layers::from_image(&Image::new(2, 2));
    assert!(layers.push_rgb("a", &Image::new(2, 3)).is_err());
    assert!(layers.push("a", ChannelData::Half(vec![])).is_err());
    assert!(layers.push("R", ChannelData::Float(vec![0.0; 4])).is_err());
    assert_eq!(layers.channels.len(), 3);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn floats_come_back_to_the_bit(
        width in 1usize..40,
        bits in prop::collection::vec(any::<u32>(), 40 * 5),
        name in "[a-zA-Zäß.]{1,40}",
        value in any::<String>(),
    ) {
        let height = bits.len() / width;
        let samples: Vec<f32> = bits[..width * height].iter().map(|&b| f32::from_bits(b)).collect();
        let mut layers = Layers::new(width, height);
        layers.push(name.as_str(), ChannelData::Float(samples)).unwrap();
        layers.set_metadata("gonio.note", value.as_str());
        let back = read(&write(&layers, Compression::Zip)).unwrap();
        let ChannelData::Float(back_samples) = &back.channels[0].samples else { panic!("another type") };
        prop_assert_eq!(back_samples.iter().map(|s| s.to_bits()).collect::<Vec<_>>(), &bits[..width * height]);
        prop_assert_eq!(&back.channels[0].name, &name);
        prop_assert_eq!(back.metadata("gonio.note"), Some(value.as_str()));
    }
}
