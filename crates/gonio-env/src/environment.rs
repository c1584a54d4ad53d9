//! [`Environment`], one radiance per direction.

use crate::lookup::Map;
use crate::sampling::{Guide, SamplingMethod, SphereTable, UNIFORM_DENSITY, uniform_direction};
use crate::texels::Remedy;
use crate::{Convention, EnvError, Layout, Panorama, Proxy, Sky, luminance};
use gonio_image::Image;
use gonio_num::{Frame, Real, Vec3};
use gonio_radiometry::warp::{cosine_hemisphere, cosine_hemisphere_density};
use std::sync::{Arc, OnceLock};

/// A sampled direction towards the environment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EnvSample {
    /// Towards the light; world, unit.
    pub wi: Vec3<f32>,
    /// Radiance from there \[W m⁻² sr⁻¹], as [`Environment::radiance`] gives it.
    pub radiance: [f32; 3],
    /// Density of having chosen `wi` \[sr⁻¹], as [`Environment::pdf`] gives it, to the bit. 0 only where it underflows
    /// (below 1e-38 of the picture's peak): such a sample carries nothing and must be skipped.
    pub pdf: f32,
}

/// Light from infinitely far away: one radiance per direction.
///
/// A clone is cheap: pictures are shared. See the [crate's page](crate) for how it interpolates and samples.
#[derive(Debug, Clone)]
pub struct Environment {
    pub(crate) source: Source,
    /// Counter-clockwise seen from above, in (−180, 180].
    pub(crate) yaw_deg: f64,
    sin_yaw: f32,
    cos_yaw: f32,
    pub(crate) scale: [f32; 3],
    pub(crate) proxy: Option<Proxy>,
}

#[derive(Debug, Clone)]
pub(crate) enum Source {
    Uniform([f32; 3]),
    Picture(Arc<Picture>),
    Sky(Arc<Sky>),
}

#[derive(Debug)]
pub(crate) struct Picture {
    pub map: Arc<Map>,
    method: SamplingMethod,
    /// `None` if the picture is black.
    pub table: Option<SphereTable>,
    /// Density over luminance of the unscaled picture, where the density is the luminance itself: in the lat-long layout.
    pub density_of_luminance: Option<f64>,
    /// For [`Guide::Compensated`], made when first asked for; `None` in it if nothing exceeds the mean.
    compensated: OnceLock<Option<SphereTable>>,
}

/// Share of the uniform density in the sampling of a disc-shaped picture, whose table is resampled and could miss light.
const DISC_FLOOR: f32 = 0.01;

impl Environment {
    /// The same radiance \[W m⁻² sr⁻¹] from every direction.
    ///
    /// # Panics
    /// If a channel is NaN, infinite or negative; [`Environment::try_uniform`] returns an error instead.
    pub fn uniform(radiance: [f32; 3]) -> Self {
        Self::try_uniform(radiance).unwrap_or_else(|e| panic!("{e}"))
    }

    /// The same radiance \[W m⁻² sr⁻¹] from every direction.
    ///
    /// # Errors
    /// [`EnvError::Parameter`] if a channel is NaN, infinite or negative.
    pub fn try_uniform(radiance: [f32; 3]) -> Result<Self, EnvError> {
        check_colour("radiance", radiance)?;
        Ok(Self::of(Source::Uniform(radiance)))
    }

    /// The environment that `image` shows, its pixels being radiance \[W m⁻² sr⁻¹].
    ///
    /// Any size will do for `LatLong`, down to 1 × 1; the other layouts want their proportions. What stands outside a disc
    /// is ignored.
    ///
    /// # Errors
    /// [`EnvError::Shape`], and [`EnvError::Texel`] for a texel that is NaN, infinite or negative.
    pub fn from_image(image: Image, layout: Layout) -> Result<Self, EnvError> {
        Self::from_panorama(Panorama::new(image, layout, Convention::Gonio)?)
    }

    /// As [`Environment::from_image`], but replaces unsound texels instead of refusing them: NaN, −∞ and negative
    /// values become 0, +∞ the largest finite value of the picture. [`EnvInfo`](crate::EnvInfo) counts them.
    ///
    /// # Errors
    /// [`EnvError::Shape`].
    pub fn from_image_sanitized(image: Image, layout: Layout) -> Result<Self, EnvError> {
        let panorama = Panorama::new(image, layout, Convention::Gonio)?;
        Self::of_panorama(panorama, Remedy::Clamp)
    }

    pub(crate) fn from_map(map: Map) -> Self {
        let picture = Picture::new(Arc::new(map), SamplingMethod::default());
        Self::of(Source::Picture(Arc::new(picture)))
    }

    /// Sampled by another method: same density, other directions for the same numbers. Without effect on what is no picture.
    pub fn with_sampling_method(mut self, method: SamplingMethod) -> Self {
        if let Source::Picture(picture) = &self.source {
            let other = Picture::new(picture.map.clone(), method);
            self.source = Source::Picture(Arc::new(other));
        }
        self
    }

    fn of(source: Source) -> Self {
        Self {
            source,
            yaw_deg: 0.0,
            sin_yaw: 0.0,
            cos_yaw: 1.0,
            scale: [1.0; 3],
            proxy: None,
        }
    }

    /// The environment that is a sky with its sun.
    pub fn from_sky(sky: Sky) -> Self {
        Self::of(Source::Sky(Arc::new(sky)))
    }

    /// The sky that it is made of, if it is.
    pub fn sky(&self) -> Option<&Sky> {
        match &self.source {
            Source::Sky(sky) => Some(sky),
            _ => None,
        }
    }

    /// As seen in a room: light comes from the surface of `proxy`, where the capture position saw it, instead of from infinitely far
    /// away. Only the functions whose names end in `_from` know of it; the others go on to speak of the capture position.
    pub fn with_proxy(mut self, proxy: Option<Proxy>) -> Self {
        self.proxy = proxy;
        self
    }

    /// The room around it, if it has one.
    pub fn proxy(&self) -> Option<&Proxy> {
        self.proxy.as_ref()
    }

    /// Turned by `yaw_deg` degrees about +y, counter-clockwise seen from above (right-handed), after any turn before.
    /// What stood in front (−z) stands on the left (−x) after 90°.
    ///
    /// # Panics
    /// If `yaw_deg` is NaN or infinite; [`Environment::try_rotated_deg`] returns an error instead.
    pub fn rotated_deg(self, yaw_deg: f32) -> Self {
        self.try_rotated_deg(yaw_deg)
            .unwrap_or_else(|e| panic!("{e}"))
    }

    /// As [`Environment::rotated_deg`].
    ///
    /// # Errors
    /// [`EnvError::Parameter`] if `yaw_deg` is NaN or infinite.
    pub fn try_rotated_deg(mut self, yaw_deg: f32) -> Result<Self, EnvError> {
        if !yaw_deg.is_finite() {
            return Err(EnvError::Parameter {
                name: "rotation",
                found: yaw_deg.to_string(),
                expected: "a finite number of degrees",
            });
        }
        let turn = (self.yaw_deg + f64::from(yaw_deg)).rem_euclid(360.0);
        self.yaw_deg = if turn > 180.0 { turn - 360.0 } else { turn };
        let (sin, cos) = yaw_sin_cos(self.yaw_deg);
        (self.sin_yaw, self.cos_yaw) = (sin as f32, cos as f32);
        Ok(self)
    }

    /// With its radiance multiplied, channel by channel, after any factor before. Sampling follows the unscaled luminance.
    ///
    /// # Panics
    /// If a factor is NaN, infinite or negative; [`Environment::try_scaled`] returns an error instead.
    pub fn scaled(self, factor: [f32; 3]) -> Self {
        self.try_scaled(factor).unwrap_or_else(|e| panic!("{e}"))
    }

    /// As [`Environment::scaled`].
    ///
    /// # Errors
    /// [`EnvError::Parameter`] if a factor is NaN, infinite or negative.
    pub fn try_scaled(mut self, factor: [f32; 3]) -> Result<Self, EnvError> {
        check_colour("scale", factor)?;
        for (s, f) in self.scale.iter_mut().zip(factor) {
            *s *= f;
        }
        Ok(self)
    }

    /// Sine and cosine of the yaw.
    #[inline(always)]
    fn turn<R: Real>(&self) -> (R, R) {
        (
            R::lit(f64::from(self.sin_yaw)),
            R::lit(f64::from(self.cos_yaw)),
        )
    }

    /// World to the picture's own frame.
    #[inline(always)]
    pub(crate) fn to_local<R: Real>(&self, d: Vec3<R>) -> Vec3<R> {
        let (s, c) = self.turn::<R>();
        Vec3::new(c * d.x - s * d.z, d.y, s * d.x + c * d.z)
    }

    #[inline(always)]
    pub(crate) fn to_world<R: Real>(&self, d: Vec3<R>) -> Vec3<R> {
        let (s, c) = self.turn::<R>();
        Vec3::new(c * d.x + s * d.z, d.y, c * d.z - s * d.x)
    }

    pub(crate) fn to_world_f64(&self, d: Vec3<f64>) -> Vec3<f64> {
        let (s, c) = yaw_sin_cos(self.yaw_deg);
        Vec3::new(c * d.x + s * d.z, d.y, c * d.z - s * d.x)
    }

    /// Radiance \[W m⁻² sr⁻¹] from the unit direction `d` (world). Finite and ≥ 0 for every finite `d`.
    #[inline]
    pub fn radiance(&self, d: Vec3<f32>) -> [f32; 3] {
        self.times_scale(match &self.source {
            Source::Uniform(radiance) => *radiance,
            Source::Picture(picture) => picture.map.radiance(self.to_local(d)),
            Source::Sky(sky) => sky.radiance(self.to_local(d)),
        })
    }

    /// [`Environment::radiance`] from the direction `d` at the point `p`: with a [`Proxy`], the radiance of the point of the room that
    /// is seen in this direction. `p` matters not without one.
    #[inline]
    pub fn radiance_from(&self, p: Vec3<f32>, d: Vec3<f32>) -> [f32; 3] {
        match &self.proxy {
            None => self.radiance(d),
            Some(proxy) => self.radiance(proxy.look_up(p, d).0),
        }
    }

    /// Density \[sr⁻¹] of [`Environment::sample_from`] at the point `p`.
    #[inline]
    pub fn pdf_from(&self, p: Vec3<f32>, d: Vec3<f32>) -> f32 {
        self.radiance_and_pdf_from(p, d).1
    }

    /// [`Environment::radiance_from`] and [`Environment::pdf_from`] at once.
    #[inline]
    pub fn radiance_and_pdf_from(&self, p: Vec3<f32>, d: Vec3<f32>) -> ([f32; 3], f32) {
        match &self.proxy {
            None => self.radiance_and_pdf(d),
            Some(proxy) => {
                let (seen, jacobian) = proxy.look_up(p, d);
                let (radiance, pdf) = self.radiance_and_pdf(seen);
                (radiance, pdf * jacobian)
            }
        }
    }

    /// [`Environment::sample`] at the point `p`: towards a point of the [`Proxy`], chosen by the light that the capture position sees
    /// there.
    #[inline]
    pub fn sample_from(&self, p: Vec3<f32>, u: [f32; 2]) -> EnvSample {
        let sample = self.sample(u);
        let Some(proxy) = &self.proxy else {
            return sample;
        };
        let wi = proxy.direction(p, sample.wi);
        let (radiance, pdf) = self.radiance_and_pdf_from(p, wi);
        EnvSample { wi, radiance, pdf }
    }

    /// Density \[sr⁻¹] with which [`Environment::sample`] chooses the unit direction `d` (world). It integrates to 1 over
    /// the sphere. A black environment samples the sphere uniformly.
    #[inline]
    pub fn pdf(&self, d: Vec3<f32>) -> f32 {
        self.radiance_and_pdf(d).1
    }

    /// [`Environment::radiance`] and [`Environment::pdf`] at once: hardly more than the radiance alone of a lat-long picture.
    #[inline]
    pub fn radiance_and_pdf(&self, d: Vec3<f32>) -> ([f32; 3], f32) {
        match &self.source {
            Source::Uniform(radiance) => (self.times_scale(*radiance), UNIFORM_DENSITY),
            Source::Picture(picture) => {
                let d = self.to_local(d);
                let map = &picture.map;
                let radiance = map.radiance_in(map.cell(map.layout.uv(d)));
                let pdf = match (picture.density_of_luminance, &picture.table) {
                    (Some(factor), _) => (luminance(radiance) * factor) as f32,
                    (None, Some(table)) => table.density(Layout::LatLong.uv(d)),
                    (None, None) => UNIFORM_DENSITY,
                };
                (self.times_scale(radiance), pdf)
            }
            Source::Sky(sky) => {
                let d = self.to_local(d);
                (self.times_scale(sky.radiance(d)), sky.density(d))
            }
        }
    }

    /// Density \[sr⁻¹] with which [`Environment::sample_by`] chooses the unit direction `d` (world).
    ///
    /// It integrates to 1 over the sphere, but for [`Guide::Cosine`] to what is drawn at all: 1 but for the draws that end in patches
    /// at the horizon without light above it.
    #[inline]
    pub fn pdf_by(&self, guide: Guide, d: Vec3<f32>) -> f32 {
        match (guide, &self.source) {
            (Guide::Cosine(n), Source::Uniform(_)) => {
                cosine_hemisphere_density(Vec3::new(0.0, 0.0, n.dot(d)))
            }
            (Guide::Compensated, Source::Picture(picture)) => match picture.compensated() {
                Some(table) => table.density(Layout::LatLong.uv(self.to_local(d))),
                None => self.pdf(d),
            },
            (Guide::Cosine(n), Source::Picture(picture)) => match &picture.table {
                Some(table) => {
                    let d = self.to_local(d);
                    table.density_about(Layout::LatLong.uv(d), self.to_local(n))
                }
                None => UNIFORM_DENSITY,
            },
            _ => self.pdf(d),
        }
    }

    /// As [`Environment::sample`], by another [`Guide`]. The pdf is [`Environment::pdf_by`]'s, to the bit. A pdf of 0 says that there
    /// is nothing to be drawn: all light is below the horizon.
    #[inline]
    pub fn sample_by(&self, guide: Guide, u: [f32; 2]) -> EnvSample {
        let local = match (guide, &self.source) {
            (Guide::Cosine(n), Source::Uniform(_)) => {
                let wi = Frame::from_normal(n).to_world(cosine_hemisphere(u));
                return self.sampled(guide, wi);
            }
            (Guide::Compensated, Source::Picture(picture)) => match picture.compensated() {
                Some(table) => table.sample(u),
                None => return self.sample(u),
            },
            (Guide::Cosine(n), Source::Picture(picture)) => match &picture.table {
                Some(table) => match table.sample_about(u, self.to_local(n)) {
                    Some(d) => d,
                    None => {
                        return EnvSample {
                            wi: n,
                            radiance: [0.0; 3],
                            pdf: 0.0,
                        };
                    }
                },
                None => return self.sample(u),
            },
            _ => return self.sample(u),
        };
        self.sampled(guide, self.to_world(local))
    }

    #[inline(always)]
    fn sampled(&self, guide: Guide, wi: Vec3<f32>) -> EnvSample {
        EnvSample {
            wi,
            radiance: self.radiance(wi),
            pdf: self.pdf_by(guide, wi),
        }
    }

    /// [`Environment::sample_by`] at the point `p`, as [`Environment::sample_from`].
    #[inline]
    pub fn sample_from_by(&self, guide: Guide, p: Vec3<f32>, u: [f32; 2]) -> EnvSample {
        let Some(proxy) = &self.proxy else {
            return self.sample_by(guide, u);
        };
        let guide = in_a_room(guide);
        let wi = proxy.direction(p, self.sample_by(guide, u).wi);
        let (radiance, pdf) = self.radiance_and_pdf_from_by(guide, p, wi);
        EnvSample { wi, radiance, pdf }
    }

    /// [`Environment::radiance_from`] and the density of [`Environment::sample_from_by`] at once.
    #[inline]
    pub fn radiance_and_pdf_from_by(
        &self,
        guide: Guide,
        p: Vec3<f32>,
        d: Vec3<f32>,
    ) -> ([f32; 3], f32) {
        match &self.proxy {
            None if guide == Guide::Luminance => self.radiance_and_pdf(d),
            None => (self.radiance(d), self.pdf_by(guide, d)),
            Some(proxy) => {
                let (seen, jacobian) = proxy.look_up(p, d);
                let pdf = self.pdf_by(in_a_room(guide), seen);
                (self.radiance(seen), pdf * jacobian)
            }
        }
    }

    /// A direction chosen by luminance, from `u` in [0, 1)².
    ///
    /// The direction is a monotone function of each u, but for the turn: stratified u stay stratified. A uniform or black
    /// environment samples the sphere uniformly. Never NaN.
    #[inline]
    pub fn sample(&self, u: [f32; 2]) -> EnvSample {
        let local = match &self.source {
            Source::Picture(picture) => match &picture.table {
                Some(table) => table.sample(u),
                None => uniform_direction(u),
            },
            Source::Sky(sky) if !sky.is_black() => sky.sample(u),
            Source::Uniform(_) | Source::Sky(_) => uniform_direction(u),
        };
        let wi = self.to_world(local);
        // Of the final direction, so that `pdf` gives the same bits for it.
        let (radiance, pdf) = self.radiance_and_pdf(wi);
        EnvSample { wi, radiance, pdf }
    }

    /// How many texels were replaced when the picture was read, because they were NaN, infinite or negative: 0 unless that
    /// was asked for.
    pub fn replaced_texels(&self) -> u64 {
        match &self.source {
            Source::Uniform(_) | Source::Sky(_) => 0,
            Source::Picture(p) => p.map.defects.non_finite + p.map.defects.negative,
        }
    }

    /// Whether no light comes from anywhere.
    pub fn is_black(&self) -> bool {
        let dark = |c: usize| match &self.source {
            Source::Uniform(radiance) => radiance[c] <= 0.0,
            Source::Sky(sky) => sky.is_black(),
            Source::Picture(p) => p.table.is_none() || p.map.texels().iter().all(|t| t[c] <= 0.0),
        };
        (0..3).all(|c| self.scale[c] <= 0.0 || dark(c))
    }

    #[inline(always)]
    fn times_scale(&self, rgb: [f32; 3]) -> [f32; 3] {
        [
            rgb[0] * self.scale[0],
            rgb[1] * self.scale[1],
            rgb[2] * self.scale[2],
        ]
    }
}

impl Picture {
    fn new(map: Arc<Map>, method: SamplingMethod) -> Self {
        let table = if map.layout.is_disc() {
            disc_table(&map, method)
        } else {
            lat_long_table(&map, method)
        };
        let density_of_luminance = match (&table, map.layout) {
            (Some(table), Layout::LatLong) => {
                let (peak, _, _) = map.peak();
                Some(table.scale() / f64::from(peak as f32))
            }
            _ => None,
        };
        Self {
            map,
            method,
            table,
            density_of_luminance,
            compensated: OnceLock::new(),
        }
    }

    pub fn compensated(&self) -> Option<&SphereTable> {
        let made = self
            .compensated
            .get_or_init(|| self.table.as_ref()?.compensated(self.method));
        made.as_ref()
    }
}

/// From another point of a room a patch of the wall has another cosine than from where the picture was taken.
fn in_a_room(guide: Guide) -> Guide {
    match guide {
        Guide::Cosine(_) => Guide::Luminance,
        other => other,
    }
}

/// sin and cos of an angle in degrees, exact at multiples of 90°.
pub(crate) fn yaw_sin_cos(deg: f64) -> (f64, f64) {
    match deg {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        180.0 => (0.0, -1.0),
        -90.0 => (-1.0, 0.0),
        _ => Real::sin_cos(deg.to_radians()),
    }
}

fn check_colour(name: &'static str, rgb: [f32; 3]) -> Result<(), EnvError> {
    if rgb.into_iter().all(|c| c.is_finite() && c >= 0.0) {
        return Ok(());
    }
    Err(EnvError::Parameter {
        name,
        found: format!("{}/{}/{}", rgb[0], rgb[1], rgb[2]),
        expected: "finite numbers ≥ 0",
    })
}

/// Nodes at the picture's own texels.
fn lat_long_table(map: &Map, method: SamplingMethod) -> Option<SphereTable> {
    let values = map.texels().iter().map(|t| luminance(*t) as f32).collect();
    SphereTable::with_method(map.width, map.height, values, method)
}

/// Nodes on a grid about as fine as the disc, each the largest luminance on the 3 × 3 half-steps around it, above a
/// floor, so that the density is positive wherever light could come from.
fn disc_table(map: &Map, method: SamplingMethod) -> Option<SphereTable> {
    let (peak, _, _) = map.peak();
    if peak <= 0.0 {
        return None;
    }
    let height = (map.width * 5 / 8).max(8);
    let width = 2 * height;
    // Half-steps: in u from node 0, in v from half a step above it.
    let (fine_w, fine_h) = (2 * width, 2 * height + 1);
    let fine: Vec<f32> = (0..fine_w * fine_h)
        .map(|k| {
            let u = (0.5 + 0.5 * (k % fine_w) as f64) / width as f64;
            let v = 0.5 * (k / fine_w) as f64 / height as f64;
            let d = Layout::LatLong.direction([u, v]).to_f32();
            (luminance(map.radiance(d)) / peak) as f32
        })
        .collect();
    let mut values = Vec::with_capacity(width * height);
    for j in 0..height {
        for i in 0..width {
            let mut largest = 0.0_f32;
            for row in fine[2 * j * fine_w..].chunks_exact(fine_w).take(3) {
                for di in 0..3 {
                    largest = largest.max(row[(2 * i + fine_w - 1 + di) % fine_w]);
                }
            }
            values.push(largest);
        }
    }
    let mean = values.iter().map(|v| f64::from(*v)).sum::<f64>() / values.len() as f64;
    // The grid may have missed the only texel that is lit: then it is uniform.
    let floor = if mean > 0.0 {
        mean as f32 * DISC_FLOOR
    } else {
        1.0
    };
    for v in &mut values {
        *v += floor;
    }
    SphereTable::with_method(width, height, values, method)
}
