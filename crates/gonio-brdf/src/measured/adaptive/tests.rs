//! Batches of adaptive tables have the bits of single calls.

use super::{Adaptive, Nodes, Tables};
use crate::Brdf;
use crate::batch::{Directions, Samples};
use crate::measured::{Channel, Component, Data, LoadOptions, Measured, Measurement, Metadata};
use crate::model::table::Table;
use gonio_num::Vec3;
use gonio_num::dispatch::InstructionSet;
use gonio_radiometry::sequence::Rng;
use gonio_radiometry::warp::around_axis;
use std::f32::consts::PI;
use std::path::Path;
use std::sync::Arc;

/// Random numbers for so many azimuths of the viewer, negative ones among the values.
fn table(phis: usize) -> Table<f32, 3> {
    let mut rng = Rng::from_name("adaptive");
    let mut nodes = |width: usize, height: usize, count: usize, low: f32| Nodes {
        width,
        height,
        values: (0..width * height * count)
            .map(|_| low + rng.next_f32())
            .collect(),
    };
    let phi_i = match phis {
        1 => vec![0.0],
        _ => (0..phis)
            .map(|k| 2.0 * PI * k as f32 / (phis - 1) as f32 - PI)
            .collect(),
    };
    let tables = Tables {
        phi_i,
        theta_i: vec![0.0, 0.6, 1.5],
        ndf: nodes(9, 1, 1, 0.1),
        sigma: nodes(9, 1, 1, 0.5),
        vndf: nodes(13, 11, 3 * phis, 0.0),
        luminance: nodes(10, 6, 3 * phis, 0.0),
        jacobian: true,
    };
    let values = nodes(10, 6, 9 * phis, -0.2).values;
    let data = Data::Adaptive(Adaptive::new(tables, 3, values).unwrap());
    let channels = vec![Channel::Red, Channel::Green, Channel::Blue];
    let components = vec![Component::reflection(data)];
    let measurement = Measurement::new(components, channels, Metadata::default()).unwrap();
    let options = LoadOptions::default();
    let data = Measured::new(Path::new("test"), measurement, options).unwrap();
    let mut table = Table::new(Arc::new(data));
    table.scale = [0.5, 1.0, 0.25];
    table
}

/// Directions all around, some below the horizon, and none at all.
fn directions(name: &str, count: usize) -> Vec<Vec3<f32>> {
    let mut rng = Rng::from_name(name);
    (0..count)
        .map(|k| match k {
            7 => Vec3::new(0.0, 0.0, 0.0),
            8 => Vec3::new(0.0, 0.0, 1.0),
            9 => Vec3::new(1.0, 0.0, 0.0),
            _ => {
                let z = 1.1 * rng.next_f32() - 0.1;
                around_axis(rng.next_f32(), (1.0 - z * z).max(0.0).sqrt(), z)
            }
        })
        .collect()
}

fn split(v: &[Vec3<f32>]) -> [Vec<f32>; 3] {
    [0, 1, 2].map(|k| v.iter().map(|v| v[k]).collect())
}

fn view(v: &[Vec<f32>; 3]) -> Directions<'_> {
    Directions {
        x: &v[0],
        y: &v[1],
        z: &v[2],
    }
}

#[test]
fn batches_have_the_bits_of_single_calls() {
    // More than a block, and no multiple of a number of lanes.
    const COUNT: usize = 301;
    let (wi, wo) = (directions("wi", COUNT), directions("wo", COUNT));
    let (si, so) = (split(&wi), split(&wo));
    let mut rng = Rng::from_name("u");
    let u = [0; 3].map(|_| (0..COUNT).map(|_| rng.next_f32()).collect::<Vec<_>>());
    let zeros = || [0; 3].map(|_| vec![f32::NAN; COUNT]);
    for (table, set) in [1, 4]
        .map(table)
        .iter()
        .flat_map(|t| InstructionSet::ALL.map(|s| (t, s)))
    {
        if !set.is_available() {
            eprintln!("skipped: this machine has no {}", set.name());
            continue;
        }
        let (all, factor) = table.batched().unwrap();
        let (mut f, mut pdf) = (zeros(), vec![f32::NAN; COUNT]);
        let [r, g, b] = &mut f;
        all.eval_batch(set, factor, [view(&si), view(&so)], [r, g, b]);
        all.pdf_batch(set, [view(&si), view(&so)], &mut pdf);
        let (mut drawn, mut weight) = (zeros(), zeros());
        let (mut of_sample, mut delta) = (vec![f32::NAN; COUNT], vec![true; COUNT]);
        let [x, y, z] = &mut drawn;
        let [p, q, s] = &mut weight;
        let samples = Samples {
            wi: [x, y, z],
            weight: [p, q, s],
            pdf: &mut of_sample,
            delta: &mut delta,
        };
        let numbers = [&u[0][..], &u[1], &u[2]];
        all.sample_batch(set, factor, view(&so), numbers, samples);
        let mut bright = 0;
        for k in 0..COUNT {
            let place = format!("{} {k} {:?} {:?}", set.name(), wi[k], wo[k]);
            let single = table.eval(wi[k], wo[k]);
            let sample = table.sample(wo[k], [u[0][k], u[1][k], u[2][k]]);
            bright += usize::from(single[0] > 0.0 && sample.pdf > 0.0);
            for c in 0..3 {
                assert_eq!(single[c].to_bits(), f[c][k].to_bits(), "{place}");
                let found = weight[c][k];
                assert_eq!(sample.weight[c].to_bits(), found.to_bits(), "{place}");
                assert_eq!(sample.wi[c].to_bits(), drawn[c][k].to_bits(), "{place}");
            }
            let single = table.pdf(wi[k], wo[k]);
            assert_eq!(single.to_bits(), pdf[k].to_bits(), "{place}");
            assert_eq!(sample.pdf.to_bits(), of_sample[k].to_bits(), "{place}");
            assert!(!delta[k]);
        }
        assert!(bright > COUNT / 4, "{bright}");
    }
}
