//! [`Function`], what is plotted: closures over two directions.

use gonio_num::Vec3;
use rayon::prelude::*;

type Eval<'a> = dyn Fn(&[[Vec3<f64>; 2]]) -> Vec<[f64; 3]> + Sync + 'a;
type Sample<'a> = dyn Fn(Vec3<f64>, [f64; 3]) -> Option<Draw> + Sync + 'a;

/// Evaluations that are worth a thread.
const GRAIN: usize = 512;

/// A direction that a reflection function drew.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Draw {
    /// Towards the light, unit, local frame.
    pub wi: Vec3<f64>,
    /// The fraction that is reflected over the probability of this direction.
    pub weight: [f64; 3],
    /// The probability of this direction, > 0.
    pub probability: f64,
}

/// Light that leaves in one discrete direction: a mirror's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spike {
    /// Towards the viewer, unit, local frame.
    pub wo: Vec3<f64>,
    /// The share of the light that leaves there, each channel: of radiance in units of n².
    pub share: [f64; 3],
}

/// A reflection function f(ωi→ωr) in sr⁻¹, without the cosine, as closures in `f64`.
///
/// Both directions leave the surface, `wi` to the light and `wo` to the viewer; unit length, local frame, normal +z. Values that are
/// not finite are gaps in a plot, and are counted.
///
/// ```
/// use gonio_plot::{Function, Options, polar};
/// let paint = Function::new("paint", |wi, wo| [if wi.z > 0.0 && wo.z > 0.0 { 0.8 / std::f64::consts::PI } else { 0.0 }; 3]);
/// let figure = polar(&[paint], &Options::default())?;
/// assert!(figure.svg().starts_with("<svg"));
/// # Ok::<(), gonio_plot::PlotError>(())
/// ```
pub struct Function<'a> {
    /// Name in legends.
    pub name: String,
    eval: Box<Eval<'a>>,
    delta: Option<Box<Sample<'a>>>,
    relative_ior: Option<[f64; 3]>,
}

impl<'a> Function<'a> {
    /// A function by its value for one pair (`wi`, `wo`).
    pub fn new(
        name: impl Into<String>,
        eval: impl Fn(Vec3<f64>, Vec3<f64>) -> [f64; 3] + Sync + 'a,
    ) -> Self {
        Self::batched(name, move |pairs| {
            let values = pairs.par_iter().with_min_len(GRAIN);
            values.map(|[wi, wo]| eval(*wi, *wo)).collect()
        })
    }

    /// A function by its values for many pairs [`wi`, `wo`] at once: for one that is expensive to call. A value that is missing in the
    /// answer counts as not finite.
    pub fn batched(
        name: impl Into<String>,
        eval: impl Fn(&[[Vec3<f64>; 2]]) -> Vec<[f64; 3]> + Sync + 'a,
    ) -> Self {
        Self {
            name: name.into(),
            eval: Box::new(eval),
            delta: None,
            relative_ior: None,
        }
    }

    /// Adds its discrete directions, which `eval` can't see: `draw` is its sampling of `wi` given `wo` and three numbers in [0, 1), and
    /// answers where a discrete direction was drawn, nothing elsewhere.
    pub fn with_discrete(
        mut self,
        draw: impl Fn(Vec3<f64>, [f64; 3]) -> Option<Draw> + Sync + 'a,
    ) -> Self {
        self.delta = Some(Box::new(draw));
        self
    }

    /// Says that light may also pass to the other side, z < 0, whose index of refraction over the one above this is, each channel; 1
    /// for what only lets through.
    pub fn transmitting(mut self, relative_ior: [f64; 3]) -> Self {
        self.relative_ior = Some(relative_ior);
        self
    }

    /// Whether light may pass to the other side.
    pub fn transmits(&self) -> bool {
        self.relative_ior.is_some()
    }

    /// f for each pair.
    pub(crate) fn eval(&self, pairs: &[[Vec3<f64>; 2]]) -> Vec<[f64; 3]> {
        let mut values = (self.eval)(pairs);
        values.resize(pairs.len(), [f64::NAN; 3]);
        values
    }

    /// n² of the side of `w`, each channel.
    pub(crate) fn index_squared(&self, w: Vec3<f64>) -> [f64; 3] {
        match self.relative_ior {
            Some(n) if w.z < 0.0 => n.map(|n| n * n),
            _ => [1.0; 3],
        }
    }

    /// Directions at which a narrow lobe of light from `w` may stand: the mirror's, back to where it came from, and for what transmits
    /// the refracted and the straight one. The plots look closely there.
    pub(crate) fn lobes(&self, w: Vec3<f64>) -> Vec<Vec3<f64>> {
        let mut all = vec![Vec3::new(-w.x, -w.y, w.z), w];
        if let Some(n) = self.relative_ior {
            all.push(-w);
            let mean = (n[0] + n[1] + n[2]) / 3.0;
            let eta = if w.z < 0.0 { mean } else { 1.0 / mean };
            let across = eta * eta * (1.0 - w.z * w.z);
            if across < 1.0 {
                let up = if w.z < 0.0 { 1.0 } else { -1.0 };
                let height = up * (1.0 - across).sqrt();
                all.push(Vec3::new(-eta * w.x, -eta * w.y, height));
            }
        }
        all
    }

    /// The discrete directions that light from `wi` leaves in.
    ///
    /// They are found by drawing: the third number chooses among parts, and a few of the first two serve a function that chooses by them.
    pub(crate) fn spikes(&self, wi: Vec3<f64>) -> Vec<Spike> {
        let mut found: Vec<Spike> = Vec::new();
        // Where light from `wi` goes, a viewer at `wi` gets it from.
        for ahead in self.draws(wi) {
            if let Some(back) = self
                .draws(ahead.wi)
                .iter()
                .find(|d| d.wi.dot(wi) > 1.0 - 1e-9)
            {
                let (from, to) = (self.index_squared(wi), self.index_squared(ahead.wi));
                let share = [0, 1, 2].map(|k| back.weight[k] * back.probability * from[k] / to[k]);
                found.push(Spike {
                    wo: ahead.wi,
                    share,
                });
            }
        }
        found
    }

    /// Each discrete direction of light for a viewer at `wo`, once.
    pub(crate) fn draws(&self, wo: Vec3<f64>) -> Vec<Draw> {
        let Some(draw) = &self.delta else {
            return Vec::new();
        };
        let mut found: Vec<Draw> = Vec::new();
        for k in 0..1024_u32 {
            let middle = |part: u32, of: u32| (f64::from(part) + 0.5) / f64::from(of);
            let u = [middle(k % 4, 4), middle(k / 4 % 4, 4), middle(k / 16, 64)];
            let Some(d) = draw(wo, u) else { continue };
            let sound = d.wi.is_finite() && d.probability > 0.0;
            // The same direction, but for rounding.
            if sound && found.iter().all(|f| (f.wi - d.wi).length() > 1e-6) {
                found.push(d);
            }
        }
        found.sort_by(|a, b| a.wi.z.total_cmp(&b.wi.z).then(a.wi.x.total_cmp(&b.wi.x)));
        found
    }
}

impl std::fmt::Debug for Function<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Function")
            .field("name", &self.name)
            .field("relative_ior", &self.relative_ior)
            .finish_non_exhaustive()
    }
}
