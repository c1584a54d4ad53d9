use gonio_brdf::batch::{self, Directions, Samples};
use gonio_brdf::{Model, ModelSpec};
use gonio_num::dispatch::InstructionSet;
use gonio_radiometry::sequence::Rng;
fn cpu() -> f64 {
    let s = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap();
    s.split(' ').next().unwrap().parse::<f64>().unwrap() * 1e-9
}
fn main() {
    let p = std::env::args().nth(1).unwrap();
    let m: Model<f32, 3> = ModelSpec::parse(&format!("table:{p}"))
        .unwrap()
        .build()
        .unwrap();
    let count: usize = std::env::args().nth(2).map_or(4096, |x| x.parse().unwrap());
    let mut rng = Rng::from_name("x");
    let mut dirs = || {
        let mut v = [vec![], vec![], vec![]];
        for _ in 0..count {
            let z = rng.next_f32();
            let p = 6.2831853 * rng.next_f64();
            let s = (1.0 - z * z).sqrt();
            v[0].push(s * p.cos() as f32);
            v[1].push(s * p.sin() as f32);
            v[2].push(z);
        }
        v
    };
    let (wi, wo) = (dirs(), dirs());
    let u: Vec<f32> = (0..3 * count).map(|_| rng.next_f32()).collect();
    let d = |v: &'static [Vec<f32>; 3]| Directions {
        x: &v[0],
        y: &v[1],
        z: &v[2],
    };
    let wi: &'static _ = Box::leak(Box::new(wi));
    let wo: &'static _ = Box::leak(Box::new(wo));
    let z = || vec![0.0f32; count];
    let mut o: Vec<Vec<f32>> = (0..7).map(|_| z()).collect();
    let mut delta = vec![false; count];
    for set in InstructionSet::ALL {
        for what in 0..3 {
            if std::env::args()
                .nth(3)
                .is_some_and(|o| o.parse::<usize>().unwrap() != set as usize * 3 + what)
            {
                continue;
            }
            let reps = (40_000_000 / count).max(1);
            let mut best = f64::MAX;
            for _ in 0..6 {
                let t = cpu();
                for _ in 0..reps {
                    let [a, b, c, e, f, g, h] = &mut o[..] else {
                        panic!()
                    };
                    match what {
                        0 => batch::pdf_on(set, &m, d(wi), d(wo), a),
                        1 => batch::eval_on(set, &m, d(wi), d(wo), [a, b, c]),
                        _ => batch::sample_on(
                            set,
                            &m,
                            d(wo),
                            [&u[..count], &u[count..2 * count], &u[2 * count..]],
                            Samples {
                                wi: [a, b, c],
                                weight: [e, f, g],
                                pdf: h,
                                delta: &mut delta,
                            },
                        ),
                    }
                }
                best = best.min(cpu() - t);
            }
            println!(
                "{:8} {:6} {:.1} M/s  {}",
                set.name(),
                ["pdf", "eval", "sample"][what as usize],
                (reps * count) as f64 / best / 1e6,
                o[0][..count.min(4096)].iter().sum::<f32>()
            );
        }
    }
}
