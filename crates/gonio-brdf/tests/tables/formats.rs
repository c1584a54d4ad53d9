//! Each format: what is written is read, and small files by hand.

use super::support::*;
use gonio_brdf::measured::{
    Basis, Channel, Component, Data, Layout, LoadOptions, Measurement, Repair, Side, Values,
    format, load, parse, read, tabulate,
};
use gonio_brdf::{Brdf, BrdfError, Model, ModelSpec};
use gonio_num::Vec3;
use std::f64::consts::PI;
use std::path::Path;

/// Writes, reads, and gives both.
fn there_and_back(name: &str, measurement: &Measurement) -> Measurement {
    let format = format::find(name).unwrap();
    let folder = tempfile::tempdir().unwrap();
    // The extension says nothing.
    let path = folder.path().join("table.dat");
    (format.write)(&path, measurement).unwrap();
    let (found, read) = read(&path).unwrap();
    assert_eq!(found.name, name);
    let bytes = std::fs::read(&path).unwrap();
    assert_eq!(parse(Path::new("x"), &bytes).unwrap().1, read);
    read
}

fn channels_of(names: &[&str]) -> Vec<Channel> {
    names.iter().map(|n| Channel::from_name(n)).collect()
}

fn tabulated(layout: &Layout, channels: &[Channel], sides: &[Side]) -> Measurement {
    let model = model("ggx:roughness=0.6,metal=copper");
    let mut f = |wi: Vec3<f64>, wo: Vec3<f64>, out: &mut [f64]| {
        let up = |w: Vec3<f64>| Vec3::new(w.x, w.y, w.z.abs());
        let rgb = model.eval(up(wi), up(wo));
        let scale = 1.0 + 0.5 * f64::from(wi.z < 0.0) + 0.25 * f64::from(wo.z < 0.0);
        for (k, x) in out.iter_mut().enumerate() {
            *x = rgb[k % 3] * scale * (1.0 + (k / 3) as f64);
        }
    };
    tabulate(layout, channels, sides, &mut f, &mut |_| true).unwrap()
}

/// Binary formats keep single precision to the bit but for MERL's scale; text has its shortest exact form.
#[test]
fn values_survive() {
    let spectrum: Vec<Channel> = (0..5)
        .map(|k| Channel::Wavelength(400.0 + 70.0 * f64::from(k)))
        .collect();
    let front = [Side::ReflectionFront];
    let utia = Layout::Grid(
        gonio_brdf::measured::Parameterization::SphericalAnisotropic,
        format::utia::layout(),
    );
    for (name, layout, channels, sides) in [
        ("merl", half([6, 5, 4]), rgb(), &front[..]),
        ("astm", spherical(5, 8), spectrum.clone(), &front),
        (
            "astm",
            spherical_anisotropic(4, 6),
            channels_of(&["x", "y", "z"]),
            &front,
        ),
        ("pbrt", mirrored(5, 7), spectrum.clone(), &front),
        (
            "radiance",
            klems("LBNL/Klems Quarter"),
            channels_of(&["luminance", "solar"]),
            &Side::ALL,
        ),
        (
            "radiance",
            klems("LBNL/Klems Full"),
            channels_of(&["x", "y", "z"]),
            &front,
        ),
        (
            "radiance",
            tree(3, 3),
            channels_of(&["luminance"]),
            &Side::ALL,
        ),
        ("radiance", tree(4, 2), channels_of(&["luminance"]), &front),
        ("gonio", half([6, 5, 4]), spectrum.clone(), &front),
        ("gonio", half_anisotropic([4, 3, 4], 6), rgb(), &front),
        ("gonio", spherical(5, 8), rgb(), &Side::ALL),
        (
            "gonio",
            spherical_anisotropic(3, 4),
            channels_of(&["luminance"]),
            &Side::ALL,
        ),
        ("gonio", klems("LBNL/Klems Quarter"), rgb(), &Side::ALL),
        ("gonio", tree(3, 3), rgb(), &front),
        ("gonio", tree(4, 2), spectrum, &front),
        ("utia", utia, rgb(), &front),
    ] {
        let written = tabulated(&layout, &channels, sides);
        let read = there_and_back(name, &written);
        assert_eq!(read.channels, written.channels, "{name}");
        assert_eq!(read.components.len(), written.components.len(), "{name}");
        for (a, b) in written.components.iter().zip(&read.components) {
            assert_eq!(a.side, b.side);
            if name == "utia" {
                // The row at 90° is not in the file.
                continue;
            }
            assert_eq!(a.data.size(), b.data.size(), "{name}");
            let bound = if name == "merl" { 1e-7 } else { 0.0 };
            if !matches!(a.data, Data::TensorTree(_)) {
                for (x, y) in a.data.values().iter().zip(b.data.values().iter()) {
                    assert!((x - y).abs() <= bound * x.abs(), "{name}: {x} {y}");
                }
            }
            if name == "gonio" {
                assert_eq!(a.data, b.data);
            }
        }
        // The leaves of a tree may be numbered otherwise.
        let mut rng = gonio_radiometry::sequence::Rng::from_name(name);
        for k in 0..if name == "utia" { 0 } else { 200 } {
            let (mut wi, mut wo) = (direction(&mut rng, 0.05), direction(&mut rng, 0.05));
            let side = sides[k % sides.len()];
            wi.z *= if side.from_front() { 1.0 } else { -1.0 };
            wo.z *= if side.to_front() { 1.0 } else { -1.0 };
            for (x, y) in written.eval(wi, wo).iter().zip(read.eval(wi, wo)) {
                assert!((x - y).abs() <= 1e-6 * x.abs(), "{name}: {x} {y}");
            }
        }
    }
}

/// The colours of a tree go through u′ and v′ in single precision: 1e-7 of each, over differences of some 0.1.
#[test]
fn trees_keep_their_colours() {
    let written = tabulated(
        &tree(4, 2),
        &channels_of(&["x", "y", "z"]),
        &[Side::ReflectionFront],
    );
    let read = there_and_back("radiance", &written);
    let (a, b) = (ready(written), ready(read));
    let (wi, wo): (Vec3<f64>, Vec3<f64>) = (
        Vec3::new(0.5, 0.3, 0.8).normalize(),
        Vec3::new(-0.4, -0.3, 0.85).normalize(),
    );
    for (x, y) in a.eval(wi, wo).iter().zip(b.eval(wi, wo)) {
        assert!((x - y).abs() < 1e-5 * x, "{x} {y}");
    }
}

#[test]
fn the_container_keeps_everything() {
    let mut m = tabulated(&spherical(4, 6), &rgb(), &Side::ALL);
    for (k, c) in m.components.iter_mut().enumerate() {
        let sigma = c.data.values().iter().map(|x| 0.01 * x + k as f32);
        c.uncertainty = Some(sigma.collect::<Values>());
    }
    m.metadata.name = "blue paint".into();
    m.metadata.author = "Ångström".into();
    m.metadata.licence = "CC0-1.0".into();
    m.metadata.instrument = "a goniophotometer".into();
    m.metadata.date = "2024-02-29".into();
    m.metadata.description = "two\nlines".into();
    m.metadata.quantity = "BRDF".into();
    m.metadata.unit = "sr^-1".into();
    m.metadata.provenance = vec!["measured".into(), "scaled".into()];
    let read = there_and_back("gonio", &m);
    assert_eq!(read, m);
}

#[test]
fn large_tables_stay_in_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gonio");
    let spectrum: Vec<Channel> = (0..64)
        .map(|k| Channel::Wavelength(400.0 + 5.0 * f64::from(k)))
        .collect();
    let m = tabulated(&spherical(12, 16), &spectrum, &[Side::ReflectionFront]);
    format::container::write(&path, &m).unwrap();
    let data = load(&path, LoadOptions::default()).unwrap();
    assert!(data.measurement().components[0].data.values().is_mapped());
    // Repair makes a copy.
    let options = LoadOptions {
        negative: Repair::Fill,
        ..LoadOptions::default()
    };
    let mut bad = m.clone();
    let mut values = bad.components[0].data.values().to_vec();
    values[7] = -0.5;
    let Data::Grid(grid) = &bad.components[0].data else {
        panic!()
    };
    let grid =
        gonio_brdf::measured::Grid::new(grid.parameterization(), grid.axes().to_vec(), 64, values);
    bad.components[0].data = Data::Grid(grid.unwrap());
    format::container::write(&path, &bad).unwrap();
    let data = load(&path, options).unwrap();
    assert!(!data.measurement().components[0].data.values().is_mapped());
    assert_eq!(data.found().negative, 1);
}

#[test]
fn merl_by_hand() {
    let mut bytes: Vec<u8> = [1i32, 1, 2].iter().flat_map(|n| n.to_le_bytes()).collect();
    for x in [
        1500.0f64,
        3000.0,
        1500.0 / 1.15,
        0.0,
        -1500.0 / 1.66,
        1500.0 / 1.66,
    ] {
        bytes.extend(x.to_le_bytes());
    }
    let (format, m) = parse(Path::new("hand.binary"), &bytes).unwrap();
    assert_eq!((format.name, m.channels), ("merl", rgb()));
    let values = m.components[0].data.values();
    for (x, expected) in values.iter().zip([1.0f32, 1.0, -1.0, 2.0, 0.0, 1.0]) {
        assert!((x - expected).abs() < 1e-6, "{values:?}");
    }
}

const ASTM: &str = "LAB_NAME \"an institute\"\nSAMPLE_NAME steel\nMEAS_DATE 1999/12/31\nLASER 633\nNUM_POINTS 6\n\
    VARS theta_i,phi_i,theta_s,phi_s,R,G,B\n0.0,0.0,0.0,0.0,0.1,0.2,0.3\n0,0,0.5,0,1,2,3\n0,0,0.5,3.14159265,4,5,6\n\
    0.6,0,0,0,7,8,9\n0.6,0,0.5,0,1,1,1\n0.6,0,0.5,-3.14159265,2,2,2\n";

#[test]
fn astm_by_hand() {
    let (format, m) = parse(Path::new("hand.astm"), ASTM.as_bytes()).unwrap();
    assert_eq!(format.name, "astm");
    assert_eq!(m.channels, rgb());
    assert_eq!(
        (m.metadata.author.as_str(), m.metadata.name.as_str()),
        ("an institute", "steel")
    );
    assert_eq!(
        (m.metadata.date.as_str(), m.metadata.description.as_str()),
        ("1999/12/31", "LASER 633")
    );
    let Data::Grid(grid) = &m.components[0].data else {
        panic!()
    };
    assert_eq!(grid.shape(), [2, 2, 2]);
    let data = ready(m.clone());
    let at = |theta: f64, phi: f64| gonio_radiometry::direction::spherical_direction(theta, phi);
    // Seen from the side of the light and from the other.
    assert!((data.eval(at(0.0, 0.0), at(0.5, 0.0))[0] - 1.0).abs() < 1e-5);
    assert!((data.eval(at(0.6, 0.0), at(0.5, PI))[2] - 2.0).abs() < 1e-5);
    assert!((data.eval(at(0.6, 0.0), at(0.0, 0.0))[1] - 8.0).abs() < 1e-4);
    // Degrees and radians are told apart.
    let degrees = ASTM
        .replace("0.5,", "30,")
        .replace("0.6,", "35,")
        .replace("3.14159265", "180");
    let (_, m) = parse(Path::new("hand.astm"), degrees.as_bytes()).unwrap();
    let Data::Grid(grid) = &m.components[0].data else {
        panic!()
    };
    assert!((grid.axes()[1].nodes()[1] - PI / 6.0).abs() < 1e-9);
    // In the plane of incidence.
    let plane = "VARS theta_i,theta_s,465nm\n0.5,-0.5,1\n0.5,0,2\n0.5,0.5,3\n";
    let (_, m) = parse(Path::new("plane.astm"), plane.as_bytes()).unwrap();
    assert_eq!(m.channels, [Channel::Wavelength(465.0)]);
    assert!(
        m.notes
            .iter()
            .any(|n| n.contains("plane of incidence only")),
        "{:?}",
        m.notes
    );
    let data = ready(m);
    assert!((data.eval(at(0.5, 0.0), at(0.5, PI))[0] - 3.0).abs() < 1e-5);
    assert!((data.eval(at(0.5, 1.0), at(0.5, 1.0))[0] - 1.0).abs() < 1e-5);
}

#[test]
fn pbrt_by_hand() {
    let text =
        "# a comment\n3 400 550 700 # wavelengths\n0 0 0 0  0.1 0.2 0.3\n0.5 1 0.7 2.5 .4\n.5 .6\n";
    let (format, m) = parse(Path::new("hand.brdf"), text.as_bytes()).unwrap();
    assert_eq!(format.name, "pbrt");
    assert_eq!(m.channels.len(), 3);
    let Data::Grid(grid) = &m.components[0].data else {
        panic!()
    };
    // Two rows fill half of a grid of 2 × 2 × 2 only by the normal's azimuths: they are scattered.
    assert!(grid.cells() > 100, "{:?}", grid.shape());
    assert!(m.notes[0].contains("2 rows form no grid"), "{:?}", m.notes);
}

#[test]
fn utia_by_hand() {
    // Value = number of the elevation of the light, and 10 more in green, 20 in blue.
    let mut bytes = Vec::new();
    for plane in 0..3 {
        for k in 0..6 * 48 * 6 * 48 {
            let theta_i = k / (48 * 6 * 48);
            bytes.extend((f64::from(theta_i) + 10.0 * f64::from(plane)).to_le_bytes());
        }
    }
    let (format, m) = parse(Path::new("hand.bin"), &bytes).unwrap();
    assert_eq!(format.name, "utia");
    let data = ready(m);
    let at = |deg: f64| gonio_radiometry::direction::spherical_direction(deg.to_radians(), 0.7);
    for (deg, expected) in [(0.0, 0.0), (22.5, 1.5), (75.0, 5.0), (82.5, 5.5)] {
        let [r, g, b] = data.eval(at(deg), at(40.0));
        assert!(
            (r - expected).abs() < 1e-5
                && (g - r - 10.0).abs() < 1e-5
                && (b - r - 20.0).abs() < 1e-5,
            "{deg} {r}"
        );
    }
}

/// A basis of two patches that the file defines; the numbers say which is which.
const XML: &str = r#"<?xml version="1.0"?>
<WindowElement xmlns="http://windows.lbl.gov"><Optical><Layer>
<Material><Name>glass &amp; co</Name><Manufacturer>nobody</Manufacturer></Material>
<DataDefinition><IncidentDataStructure>Columns</IncidentDataStructure>
<AngleBasis><AngleBasisName>two</AngleBasisName>
<AngleBasisBlock><Theta>0</Theta><nPhis>1</nPhis><ThetaBounds><LowerTheta>0</LowerTheta><UpperTheta>45</UpperTheta></ThetaBounds></AngleBasisBlock>
<AngleBasisBlock><Theta>67.5</Theta><nPhis>2</nPhis><ThetaBounds><LowerTheta>45</LowerTheta><UpperTheta>90</UpperTheta></ThetaBounds></AngleBasisBlock>
</AngleBasis></DataDefinition>
<WavelengthData><Wavelength unit="Integral">Solar</Wavelength></WavelengthData>
<WavelengthData><Wavelength unit="Integral">Visible</Wavelength><WavelengthDataBlock>
<WavelengthDataDirection>Reflection Back</WavelengthDataDirection>
<ColumnAngleBasis>two</ColumnAngleBasis><RowAngleBasis>two</RowAngleBasis>
<ScatteringData>0.00, 0.01, 0.02
 0.10 0.11 0.12, 0.20,0.21,0.22,</ScatteringData></WavelengthDataBlock></WavelengthData>
</Layer></Optical></WindowElement>"#;

#[test]
fn radiance_by_hand() {
    let (format, m) = parse(Path::new("hand.xml"), XML.as_bytes()).unwrap();
    assert_eq!(
        (format.name, m.metadata.name.as_str()),
        ("radiance", "glass & co")
    );
    let data = ready(m);
    let at = |deg: f64, phi: f64| {
        gonio_radiometry::direction::spherical_direction(deg.to_radians(), phi)
    };
    // Row: outgoing patch; column: incoming one, by where its light travels: from azimuth π it travels to 0, patch 1.
    for (wi, wo, expected) in [
        (at(10.0, 0.0), at(10.0, 0.0), 0.00),
        (at(60.0, PI), at(10.0, 0.0), 0.01),
        (at(60.0, 0.0), at(10.0, 0.0), 0.02),
        (at(60.0, PI), at(60.0, PI), 0.21),
        (at(60.0, 0.0), at(60.0, 0.2), 0.12),
    ] {
        assert!(
            (data.eval(wi, wo)[0] - expected).abs() < 1e-7,
            "{wi:?} {wo:?}"
        );
    }
    // In rows the numbers go the other way.
    let rows = XML.replace("Columns", "Rows");
    let data = ready(parse(Path::new("hand.xml"), rows.as_bytes()).unwrap().1);
    assert!((data.eval(at(60.0, PI), at(10.0, 0.0))[0] - 0.10).abs() < 1e-7);
    // The file's front is the other side.
    let front = XML.replace("Reflection Back", "Transmission Front");
    let m = parse(Path::new("hand.xml"), front.as_bytes()).unwrap().1;
    assert_eq!(m.components[0].side, Side::TransmissionBack);
}

#[test]
fn tensor_trees_by_hand() {
    let tree = |structure: &str, data: &str| {
        let text = XML.replace("Columns", structure).replace(
            "<ColumnAngleBasis>two</ColumnAngleBasis><RowAngleBasis>two</RowAngleBasis>",
            "<AngleBasis>LBNL/Shirley-Chiu</AngleBasis>",
        );
        let (begin, end) = (
            text.find("<ScatteringData>").unwrap() + 16,
            text.find("</ScatteringData>").unwrap(),
        );
        let text = format!("{}{data}{}", &text[..begin], &text[end..]);
        parse(Path::new("hand.xml"), text.as_bytes()).map(|(_, m)| m)
    };
    let at = |deg: f64, phi: f64| {
        gonio_radiometry::direction::spherical_direction(deg.to_radians(), phi)
    };
    // A grid of 2×2×2 in single braces, the last coordinate fastest: the first is ½ − ½ sinθi, never above ½.
    let data = ready(tree("TensorTree3", "{ 0.1 0.2 0.3 0.4 9 9 9 9 }").unwrap());
    // Light travels to azimuth 0: seen at azimuth 45° is the upper half of both.
    assert!((data.eval(at(40.0, PI), at(40.0, PI / 4.0))[0] - 0.4).abs() < 1e-6);
    assert!((data.eval(at(40.0, PI), at(40.0, -PI / 4.0))[0] - 0.3).abs() < 1e-6);
    // The same as branches: the first coordinate is the lowest bit.
    let data = ready(tree("TensorTree3", "{{0.1}{9}{0.3}{9}{0.2}{9}{0.4}{9}}").unwrap());
    assert!((data.eval(at(40.0, PI), at(40.0, -PI / 4.0))[0] - 0.3).abs() < 1e-6);
    let values: Vec<String> = (0..16).map(|k| format!("0.{k:02}")).collect();
    let data = ready(tree("TensorTree4", &format!("{{{}}}", values.join(","))).unwrap());
    // Light travels to 45° (1, 1), seen at −45° (1, 0): 8 + 4 + 2.
    assert!((data.eval(at(50.0, PI / 4.0 + PI), at(50.0, -PI / 4.0))[0] - 0.14).abs() < 1e-6);
    for bad in [
        "",
        "{",
        "{1 2 3}",
        "{ 1 2 3 4 5 6 7 x }",
        "{1}}",
        "{1} 2",
        "{{1}{2}}",
        "1",
        "{nan}",
        &"{".repeat(2000),
    ] {
        let error = tree("TensorTree3", bad).unwrap_err().to_string();
        assert!(error.contains("hand.xml: line"), "{bad}: {error}");
    }
    assert!(tree("TensorTree5", "{1}").is_err());
}

#[test]
fn files_are_models() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("gold.binary");
    let m = table(&half([12, 8, 6]), "ggx:roughness=0.6,metal=gold");
    format::merl::write(&path, &m).unwrap();
    let spec = ModelSpec::parse(&format!("merl:{},scale=0.5", path.display())).unwrap();
    let half: Model<f64, 3> = spec.build().unwrap();
    let whole = ready(m);
    let (wi, wo) = (Vec3::new(0.6, 0.0, 0.8), Vec3::new(-0.6, 0.0, 0.8));
    let (a, b) = (half.eval(wi, wo)[0], 0.5 * whole.eval(wi, wo)[0]);
    assert!((a - b).abs() < 1e-6 * b);
    assert!(matches!(
        spec.build::<f64, 4>(),
        Err(BrdfError::Unsupported { .. })
    ));
    assert!(spec.declares().unwrap().reciprocal && spec.declares().unwrap().isotropic);
    // An anisotropic file declares otherwise, and a grey one can be evaluated with any number of components.
    let path = folder.path().join("grey.gonio");
    let m = tabulated(
        &klems("LBNL/Klems Quarter"),
        &channels_of(&["luminance"]),
        &Side::ALL,
    );
    format::container::write(&path, &m).unwrap();
    let spec = ModelSpec::parse(&format!("table:{},component=all", path.display())).unwrap();
    let d = spec.declares().unwrap();
    assert!(!d.reciprocal && !d.isotropic && d.relative_ior == Some([1.0; 3]));
    let four: Model<f64, 4> = spec.build().unwrap();
    assert!(Brdf::<f64, 4>::transmits(&four) && four.eval(wi, wo)[3] > 0.0);
    let missing = ModelSpec::parse(&format!(
        "table:{},component=transmission-front",
        folder.path().join("gold.binary").display()
    ));
    let error = missing.unwrap().build::<f64, 3>().unwrap_err().to_string();
    assert!(
        error.contains("reflection-front") && error.contains("component="),
        "{error}"
    );
}

#[test]
fn components_must_agree() {
    let m = tabulated(
        &klems("LBNL/Klems Quarter"),
        &rgb(),
        &[Side::ReflectionFront],
    );
    let twice = vec![m.components[0].clone(), m.components[0].clone()];
    assert!(Measurement::new(twice, rgb(), m.metadata.clone()).is_err());
    assert!(Measurement::new(vec![], rgb(), m.metadata.clone()).is_err());
    assert!(
        Measurement::new(
            m.components.clone(),
            channels_of(&["luminance"]),
            m.metadata.clone()
        )
        .is_err()
    );
    let falling = channels_of(&["600 nm", "500 nm", "400 nm"]);
    assert!(Measurement::new(m.components.clone(), falling, m.metadata.clone()).is_err());
    let mut c = Component::reflection(m.components[0].data.clone());
    c.uncertainty = Some(vec![1.0f32].into());
    assert!(Measurement::new(vec![c], rgb(), m.metadata).is_err());
    assert!(Basis::known("LBNL/Klems Full").is_some());
}
