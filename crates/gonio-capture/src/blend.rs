//! Several views, in one frame, merged to one panorama.
//!
//! Each channel of a view is scaled so that the median of its ratio to the first view is 1 where both are sure. Where a view
//! disagrees with the others near its own camera, it shows its photographer: there it counts for nothing. What remains is
//! averaged with the squared confidences as weights, so that the sharper view prevails.

use crate::panorama::Panorama;
use gonio_image::Image;
use gonio_num::{Real, Vec3};

/// Half-angle \[rad] around a camera in which its photographer may stand.
const PHOTOGRAPHER: f64 = 1.2;
/// Least difference, in the logarithm of luminance, that shows a photographer.
const DISAGREEMENT: f64 = 0.2;

/// A view in the common frame.
#[derive(Debug, Clone)]
pub struct View {
    /// What it saw.
    pub panorama: Panorama,
    /// The unit direction to its camera.
    pub towards_camera: Vec3<f64>,
}

/// The merged panorama, and the factors that each view's channels were multiplied by.
#[derive(Debug, Clone)]
pub struct Blend {
    /// Merged.
    pub panorama: Panorama,
    /// One a view; 1 for the first.
    pub gains: Vec<[f64; 3]>,
}

/// Merges views of one size; at least one.
pub fn blend(mut views: Vec<View>) -> Blend {
    let gains: Vec<[f64; 3]> = (0..views.len())
        .map(|v| gain(&views[0].panorama, &views[v].panorama))
        .collect();
    for (view, gain) in views.iter_mut().zip(&gains) {
        for p in &mut view.panorama.image.pixels {
            for c in 0..3 {
                p[c] *= gain[c] as f32;
            }
        }
    }
    let trust: Vec<Vec<f32>> = (0..views.len()).map(|v| trust(&views, v)).collect();
    let image = &views[0].panorama.image;
    let n = image.pixels.len();
    let mut merged = Panorama {
        image: Image::new(image.width, image.height),
        confidence: vec![0.0; n],
        sigma: vec![0.0; n],
        clipped: vec![0.0; n],
    };
    for k in 0..n {
        let (mut total, mut variance, mut clipped) = (0.0_f64, 0.0_f64, 0.0_f64);
        let mut rgb = [0.0_f64; 3];
        // Without any confidence the picture still shows what a view saw there: its camera.
        let unsure = views
            .iter()
            .zip(&trust)
            .all(|(v, t)| v.panorama.confidence[k] * t[k] <= 0.0);
        for (view, trust) in views.iter().zip(&trust) {
            let p = &view.panorama;
            let sure = p.confidence[k] * trust[k];
            let seen = p.image.pixels[k].iter().any(|c| *c > 0.0);
            let w = if unsure {
                f64::from(u8::from(seen))
            } else {
                f64::from(sure).sq()
            };
            for (sum, value) in rgb.iter_mut().zip(p.image.pixels[k]) {
                *sum += w * f64::from(value);
            }
            variance += (w * f64::from(p.sigma[k])).sq();
            clipped += w * f64::from(p.clipped[k]);
            total += w;
            merged.confidence[k] = merged.confidence[k].max(sure);
        }
        if total > 0.0 {
            merged.image.pixels[k] = rgb.map(|c| (c / total) as f32);
            merged.sigma[k] = (variance.sqrt() / total) as f32;
            merged.clipped[k] = (clipped / total) as f32;
        }
    }
    Blend {
        panorama: merged,
        gains,
    }
}

fn sure(p: &Panorama, k: usize) -> bool {
    p.confidence[k] > 0.5 && p.clipped[k] <= 0.0
}

/// Median ratio of each channel where both are sure; 1 if that is nowhere.
fn gain(reference: &Panorama, view: &Panorama) -> [f64; 3] {
    [0, 1, 2].map(|c| {
        let mut ratios: Vec<(f64, f64)> = (0..reference.confidence.len())
            .filter(|k| sure(reference, *k) && sure(view, *k))
            .filter_map(|k| {
                let (a, b) = (reference.image.pixels[k][c], view.image.pixels[k][c]);
                (a > 0.0 && b > 0.0)
                    .then(|| (f64::from(a) / f64::from(b), reference.solid_angle(k)))
            })
            .collect();
        ratios.sort_by(|p, q| p.0.total_cmp(&q.0));
        let half = 0.5 * ratios.iter().map(|r| r.1).sum::<f64>();
        let mut passed = 0.0;
        for (ratio, weight) in ratios {
            passed += weight;
            if passed >= half {
                return ratio;
            }
        }
        1.0
    })
}

/// 0 where view `v` shows its own photographer, 1 elsewhere.
fn trust(views: &[View], v: usize) -> Vec<f32> {
    let view = &views[v];
    let n = view.panorama.confidence.len();
    let mut trust = vec![1.0; n];
    if views.len() == 1 {
        return trust;
    }
    let luminance = |p: [f32; 3]| f64::from(0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2]);
    // ln of this view over the mean of the others, where both are known.
    let difference: Vec<Option<f64>> = (0..n)
        .map(|k| {
            let here = luminance(view.panorama.image.pixels[k]);
            let (mut sum, mut weight) = (0.0, 0.0);
            for (o, other) in views.iter().enumerate() {
                if o != v {
                    let w = f64::from(other.panorama.confidence[k]).sq();
                    sum += w * luminance(other.panorama.image.pixels[k]);
                    weight += w;
                }
            }
            (weight > 0.05 && here > 0.0 && sum > 0.0).then(|| Real::ln(here * weight / sum))
        })
        .collect();
    let mut sizes: Vec<f64> = difference.iter().flatten().map(|d| d.abs()).collect();
    if sizes.is_empty() {
        return trust;
    }
    sizes.sort_by(f64::total_cmp);
    // 4 σ of the usual disagreement, from its median.
    let limit = (4.0 * sizes[sizes.len() / 2] / 0.6745).max(DISAGREEMENT);
    let (w, h) = (view.panorama.image.width, view.panorama.image.height);
    for (k, trust) in trust.iter_mut().enumerate() {
        let d = view.panorama.direction(k);
        let angle = d
            .cross(view.towards_camera)
            .length()
            .atan2(d.dot(view.towards_camera));
        if angle > PHOTOGRAPHER {
            continue;
        }
        // The mean over 5 × 5 texels: an edge that is off by a texel is no photographer.
        let (i, j) = (k % w, k / w);
        let (mut sum, mut count) = (0.0, 0.0);
        for dj in 0..5 {
            for di in 0..5 {
                let row = (j + dj).saturating_sub(2).min(h - 1);
                if let Some(d) = difference[row * w + (i + w + di - 2) % w] {
                    sum += d;
                    count += 1.0;
                }
            }
        }
        if count > 0.0 {
            let excess = (sum / count).abs() / limit;
            *trust = (2.0 - 2.0 * excess).saturate() as f32;
        }
    }
    trust
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::register::tests::scene;
    use crate::rotation::Rotation;

    #[test]
    fn a_photographer_goes_and_the_gain_is_found() {
        let truth = scene("blend", 64, Rotation::IDENTITY);
        let (a, b) = (Vec3::new(0.0, 0.0, 1.0), Vec3::new(1.0, 0.0, 0.0));
        let mut views: Vec<View> = [a, b]
            .map(|towards_camera| View {
                panorama: truth.clone(),
                towards_camera,
            })
            .into();
        for k in 0..truth.confidence.len() {
            let d = truth.direction(k);
            for view in &mut views {
                // A dark figure of 20° around the camera, of which 8° are known to be one.
                let near = d.dot(view.towards_camera);
                if near > Real::cos(20.0_f64.to_radians()) {
                    view.panorama.image.pixels[k] = [0.001; 3];
                }
                if near > Real::cos(8.0_f64.to_radians()) {
                    view.panorama.confidence[k] = 0.0;
                }
            }
            for c in 0..3 {
                views[1].panorama.image.pixels[k][c] *= [0.5, 0.4, 0.3][c];
            }
        }
        let found = blend(views);
        for (g, e) in found.gains[1].iter().zip([2.0, 2.5, 1.0 / 0.3]) {
            assert!((g / e - 1.0).abs() < 1e-6, "{g}");
        }
        for k in 0..truth.confidence.len() {
            let (p, t) = (found.panorama.image.pixels[k][1], truth.image.pixels[k][1]);
            // Half a window of 5 texels at the figure's edge may be blended.
            let d = truth.direction(k);
            let edge = [a, b]
                .iter()
                .any(|c| (Real::acos(d.dot(*c)).to_degrees() - 20.0).abs() < 9.0);
            assert!(edge || (p / t - 1.0).abs() < 1e-5, "{k} {p} {t}");
        }
    }

    #[test]
    fn one_view_stays_itself() {
        let panorama = scene("one view", 16, Rotation::IDENTITY);
        let view = View {
            panorama: panorama.clone(),
            towards_camera: Vec3::new(0.0, 0.0, 1.0),
        };
        let found = blend(vec![view]);
        assert_eq!(found.panorama.image, panorama.image);
        assert_eq!(found.gains, [[1.0; 3]]);
    }
}
