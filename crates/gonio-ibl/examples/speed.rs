use gonio_env::Environment;
use gonio_ibl::*;
use gonio_image::Image;
use gonio_num::Vec3;
use std::time::Instant;
fn main() {
    let (w, h) = (2048, 1024);
    let sun = Vec3::new(0.5f64, 0.6, -0.3).normalize();
    let image = Image::from_fn(w, h, |x, y| {
        let d: Vec3<f64> = gonio_env::Layout::LatLong
            .direction([(x as f64 + 0.5) / w as f64, (y as f64 + 0.5) / h as f64]);
        let t = d.y;
        if d.dot(sun) > (0.5f64.to_radians()).cos() {
            return [6000.0, 5700.0, 5000.0];
        }
        if t > 0.0 {
            [
                0.3 + 0.4 * (1.0 - t) as f32,
                0.5 + 0.3 * (1.0 - t) as f32,
                1.0,
            ]
        } else {
            let c = if (((d.x / d.y) * 3.0).floor() as i64 + ((d.z / d.y) * 3.0).floor() as i64) % 2
                == 0
            {
                0.3
            } else {
                0.1
            };
            [c, c * 0.9, c * 0.7]
        }
    });
    let t = Instant::now();
    let env = Environment::from_image(image, gonio_env::Layout::LatLong).unwrap();
    println!("env {:?}", t.elapsed());
    let tol: f64 = std::env::args()
        .nth(1)
        .map_or(DEFAULT_TOLERANCE, |a| a.parse().unwrap());
    let t = Instant::now();
    let tree = LightTree::new(
        &env,
        std::env::args()
            .nth(2)
            .map_or(0.0083, |a| a.parse().unwrap()),
    );
    println!("tree {:?} {}", t.elapsed(), tree.size());
    for level in 1..9 {
        let p = 1.0 - (1.0 - level as f64 / 8.0f64).sqrt();
        let k = Kernel::ggx(p).unwrap();
        let size = 256usize >> level;
        let block = 8.min(size);
        let mut blocks = Vec::new();
        for face in 0..6 {
            for by in 0..size / block {
                for bx in 0..size / block {
                    let mut b = Vec::new();
                    for y in 0..block {
                        for x in 0..block {
                            b.push(
                                cube::centre(face, size, bx * block + x, by * block + y).to_f32(),
                            );
                        }
                    }
                    blocks.push(b);
                }
            }
        }
        let t = Instant::now();
        let f = Filter::new(&tree, &k, tol);
        let found: Vec<[f32; 3]> = f.apply(&blocks).into_iter().flatten().collect();
        let e = t.elapsed();
        let axes: Vec<Vec3<f32>> = blocks.into_iter().flatten().collect();
        let step = (axes.len() / 64).max(1);
        let pick: Vec<usize> = (0..axes.len()).step_by(step).collect();
        let some: Vec<_> = pick.iter().map(|i| axes[*i]).collect();
        let t = Instant::now();
        let truth = reference(&env, &tree, &k, &some);
        let er = t.elapsed();
        let mut mean = 0.0;
        let mut worst = 0.0f64;
        let mut bias = 0.0;
        for (i, tr) in pick.iter().zip(&truth) {
            for c in 0..3 {
                let r = (found[*i][c] as f64 - tr[c] as f64) / tr[c] as f64;
                mean += r.abs();
                bias += r;
                worst = worst.max(r.abs());
            }
        }
        let n = 3.0 * truth.len() as f64;
        println!(
            "level {level} size {size} alpha {:.4} {:?} mean {:.2e} worst {:.2e} bias {:+.1e} (ref {:?})",
            p * p,
            e,
            mean / n,
            worst,
            bias / n,
            er
        );
    }
}
