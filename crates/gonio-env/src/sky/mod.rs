//! Sun and sky: the clear sky of Hošek & Wilkie 2012 and their sun of 2013, over a place at a time.
//!
//! North is −z, in the centre of a panorama; east is +x. The sun is a disc of 0.5358° with limb darkening that shines in addition to
//! the sky. Below the horizon is the ground that the model takes for granted: Lambertian, of the given albedo, under this sky.
//!
//! # Units
//! RGB is the integral of spectral radiance over the CIE 1931 colour matching functions, in linear Rec.709 \[W m⁻² sr⁻¹, weighed by
//! the eye]: its luminance times 683.002 is in cd m⁻², the irradiance likewise in lux. Spectral radiance is per nanometre.

mod model;
mod position;
mod tables;
mod words;

pub use position::{Moment, SunPosition};
pub use words::SkyOptions;

use crate::sampling::{SphereTable, UNIFORM_DENSITY};
use crate::{EnvError, Layout, luminance};
use gonio_image::Image;
use gonio_num::{Frame, Real, Vec3};
use gonio_radiometry::warp::{uniform_cap, uniform_cap_density};
use model::{Channel, SUN_RADIUS, SunTable};
use std::f64::consts::{PI, TAU};
use tables::Channels;

/// A clear sky with the sun in it.
#[derive(Debug)]
pub struct Sky {
    options: SkyOptions,
    position: SunPosition,
    /// Towards the sun.
    towards: Vec3<f64>,
    frame: Frame<f32>,
    channels: [Channel<f32>; 3],
    sun: SunTable<3>,
    ground: [f32; 3],
    /// The sky and the ground without the sun; `None` if they are black.
    table: Option<SphereTable>,
    /// How often a sample goes to the sun.
    sun_probability: f32,
}

/// Rows of the grid of nodes that the sky is sampled by: 1.4° apart.
const ROWS: usize = 128;
/// Rows of the quadrature over the dome.
const QUADRATURE: usize = 128;
/// Rings of the quadrature over the sun's disc.
const RINGS: usize = 16;

/// 1 − cos of the sun's radius.
fn sun_height() -> f64 {
    let half = Real::sin(0.5 * SUN_RADIUS);
    2.0 * half * half
}

impl Sky {
    /// The sky that `options` describe.
    ///
    /// # Errors
    /// [`EnvError::Parameter`] for a number out of its range, and if the sun is below the horizon: the model knows no night.
    pub fn new(options: SkyOptions) -> Result<Self, EnvError> {
        let position = options.check()?;
        let towards = position.direction();
        let elevation = position.elevation_deg.to_radians();
        let albedo = options.albedo;
        let of = model::channels(Channels::Rgb, elevation, options.turbidity, |c| albedo[c]);
        let channels = std::array::from_fn(|c| Channel {
            coefficients: of[c].coefficients.map(|x| x as f32),
            mean: of[c].mean as f32,
        });
        let mut sky = Self {
            options,
            position,
            towards,
            frame: Frame::from_normal(towards.to_f32()),
            channels,
            sun: SunTable::rgb(options.turbidity),
            ground: [0.0; 3],
            table: None,
            sun_probability: 0.0,
        };
        let up = sky.irradiance(Vec3::new(0.0, 1.0, 0.0), QUADRATURE);
        if options.ground {
            sky.ground = [0, 1, 2].map(|c| (albedo[c] * up[c] / PI) as f32);
        }
        let nodes = (0..2 * ROWS * ROWS).map(|k| {
            let (x, y) = (k % (2 * ROWS), k / (2 * ROWS));
            let uv = [x as f64 + 0.5, y as f64 + 0.5];
            let d = Layout::LatLong.direction([uv[0] / (2 * ROWS) as f64, uv[1] / ROWS as f64]);
            luminance(sky.diffuse(d.to_f32())) as f32
        });
        sky.table = SphereTable::new(2 * ROWS, ROWS, nodes.collect());
        // By the power of the two over the sphere.
        let whole = luminance(sky.mean_radiance().map(|l| l as f32));
        let of_sun = luminance(sky.sun_power().map(|l| (l / (4.0 * PI)) as f32));
        sky.sun_probability = match (of_sun > 0.0, &sky.table) {
            (false, _) => 0.0,
            (true, None) => 1.0,
            (true, Some(_)) => (of_sun / whole) as f32,
        };
        Ok(sky)
    }

    /// What it was made from.
    pub fn options(&self) -> &SkyOptions {
        &self.options
    }

    /// Where the sun stands.
    pub fn sun_position(&self) -> SunPosition {
        self.position
    }

    /// Radiance from the unit direction `d`, linear RGB. Finite and never negative: what lies outside of Rec.709 is cut off.
    #[inline]
    pub fn radiance(&self, d: Vec3<f32>) -> [f32; 3] {
        let mut rgb = self.diffuse(d);
        if self.is_in_sun(d) {
            for (to, from) in rgb.iter_mut().zip(self.sunlight(d.to_f64())) {
                *to += from as f32;
            }
        }
        rgb
    }

    /// Spectral radiance \[W m⁻² sr⁻¹ nm⁻¹] from the unit direction `d` at a wavelength; 0 outside of 320 to 720 nm, and below the
    /// horizon. The albedo is the mean of its channels.
    pub fn spectral_radiance(&self, d: Vec3<f64>, lambda_nm: f64) -> f64 {
        let step = (lambda_nm - tables::FIRST_NM) / tables::STEP_NM;
        if !(0.0..=(tables::WAVELENGTHS - 1) as f64).contains(&step) || d.y < 0.0 {
            return 0.0;
        }
        let grey = self.options.albedo.iter().sum::<f64>() / 3.0;
        let elevation = self.position.elevation_deg.to_radians();
        let all = model::channels(
            Channels::Spectral,
            elevation,
            self.options.turbidity,
            |_| grey,
        );
        let cos_gamma = d.dot(self.towards);
        let sin_gamma = d.cross(self.towards).length();
        let gamma = Real::atan2(sin_gamma, cos_gamma);
        let low = (step as usize).min(tables::WAVELENGTHS - 2);
        let of = |channel: usize| all[channel].radiance(d.y, gamma, cos_gamma);
        let share = step - low as f64;
        let mut sum = 0.0;
        if self.options.sky {
            sum += (1.0 - share) * of(low) + share * of(low + 1);
        }
        if self.is_in_sun(d.to_f32()) {
            let sun = SunTable::wavelength(self.options.turbidity, lambda_nm);
            sum += sun.radiance(Real::asin(d.y.min(1.0)), sin_gamma)[0];
        }
        sum
    }

    /// Sky and ground, without the sun.
    #[inline(always)]
    fn diffuse(&self, d: Vec3<f32>) -> [f32; 3] {
        if d.y < 0.0 {
            return self.ground;
        }
        if !self.options.sky {
            return [0.0; 3];
        }
        let sun = self.frame.n;
        let cos_gamma = d.dot(sun);
        let gamma = Real::atan2(d.cross(sun).length(), cos_gamma);
        let mut rgb = [0.0; 3];
        for (to, channel) in rgb.iter_mut().zip(&self.channels) {
            *to = channel.radiance(d.y, gamma, cos_gamma);
        }
        rgb
    }

    /// Whether `d` meets the sun's disc above the horizon.
    #[inline(always)]
    fn is_in_sun(&self, d: Vec3<f32>) -> bool {
        // By the chord: a cosine this close to 1 has no digits left.
        let chord = (d - self.frame.n).length_squared();
        self.options.sun && d.y >= 0.0 && f64::from(chord) <= 2.0 * sun_height()
    }

    /// The sun's own radiance in a direction of its disc.
    fn sunlight(&self, d: Vec3<f64>) -> [f64; 3] {
        let sin_gamma = d.cross(self.towards).length();
        self.sun
            .radiance(Real::asin(d.y.clamp(0.0, 1.0)), sin_gamma)
    }

    /// Density \[sr⁻¹] of [`Sky::sample`].
    #[inline]
    pub(crate) fn density(&self, d: Vec3<f32>) -> f32 {
        if self.is_black() {
            return UNIFORM_DENSITY;
        }
        let diffuse = match &self.table {
            Some(table) => table.density(Layout::LatLong.uv(d)),
            None => 0.0,
        };
        let sun = if self.is_in_sun(d) {
            uniform_cap_density(Vec3::new(0.0, 0.0, 1.0), sun_height() as f32)
        } else {
            0.0
        };
        (1.0 - self.sun_probability) * diffuse + self.sun_probability * sun
    }

    /// A unit direction distributed by [`Sky::density`]: the sun's disc evenly, or the sky by its luminance.
    #[inline]
    pub(crate) fn sample(&self, u: [f32; 2]) -> Vec3<f32> {
        let p = self.sun_probability;
        match &self.table {
            Some(table) if u[0] >= p => table.sample([(u[0] - p) / (1.0 - p), u[1]]),
            _ => {
                let cap = uniform_cap([u[0] / p.max(f32::MIN_POSITIVE), u[1]], sun_height() as f32);
                self.frame.to_world(cap)
            }
        }
    }

    /// Whether nothing shines.
    pub(crate) fn is_black(&self) -> bool {
        self.table.is_none() && self.sun_probability <= 0.0
    }

    /// Irradiance on a surface with the unit normal `n`, by a midpoint rule of `rows` rings over the dome and one over the sun.
    pub(crate) fn irradiance(&self, n: Vec3<f64>, rows: usize) -> [f64; 3] {
        let mut sum = [0.0; 3];
        let mut add = |d: Vec3<f64>, radiance: [f64; 3], solid_angle: f64| {
            let cos = n.dot(d);
            if cos > 0.0 {
                for (s, l) in sum.iter_mut().zip(radiance) {
                    *s += l * cos * solid_angle;
                }
            }
        };
        self.over_sky(rows, &mut add);
        self.over_sun(&mut add);
        let below = 0.5 * PI * (1.0 - n.y);
        [0, 1, 2].map(|c| sum[c] + f64::from(self.ground[c]) * below)
    }

    /// Radiance averaged over the sphere.
    pub(crate) fn mean_radiance(&self) -> [f64; 3] {
        let mut sum = self.sun_power();
        self.over_sky(QUADRATURE, |_, radiance, solid_angle| {
            for (s, l) in sum.iter_mut().zip(radiance) {
                *s += l * solid_angle;
            }
        });
        [0, 1, 2].map(|c| (sum[c] + f64::from(self.ground[c]) * TAU) / (4.0 * PI))
    }

    /// ∫ L dω over the sun's disc.
    fn sun_power(&self) -> [f64; 3] {
        let mut sum = [0.0; 3];
        self.over_sun(|_, radiance, solid_angle| {
            for (s, l) in sum.iter_mut().zip(radiance) {
                *s += l * solid_angle;
            }
        });
        sum
    }

    /// Visits the dome: direction, radiance, solid angle.
    fn over_sky(&self, rows: usize, mut visit: impl FnMut(Vec3<f64>, [f64; 3], f64)) {
        let columns = 4 * rows;
        let turns: Vec<_> = (0..columns)
            .map(|i| Real::sin_cos(TAU * (i as f64 + 0.5) / columns as f64))
            .collect();
        for row in 0..rows {
            // Even in solid angle.
            let y = (row as f64 + 0.5) / rows as f64;
            let r = (1.0 - y * y).sqrt();
            for (s, c) in &turns {
                let d = Vec3::new(r * s, y, -r * c);
                visit(
                    d,
                    self.diffuse(d.to_f32()).map(f64::from),
                    TAU / (rows * columns) as f64,
                );
            }
        }
    }

    /// Visits the sun's disc.
    fn over_sun(&self, mut visit: impl FnMut(Vec3<f64>, [f64; 3], f64)) {
        if !self.options.sun {
            return;
        }
        let frame = Frame::from_normal(self.towards);
        let spokes = 4 * RINGS;
        for k in 0..RINGS * spokes {
            let u = [(k % RINGS) as f64 + 0.5, (k / RINGS) as f64 + 0.5];
            let u = [u[0] / RINGS as f64, u[1] / spokes as f64];
            let d = frame.to_world(uniform_cap(u, sun_height()));
            if d.y >= 0.0 {
                let solid_angle = TAU * sun_height() / (RINGS * spokes) as f64;
                visit(d, self.sunlight(d), solid_angle);
            }
        }
    }

    /// A lat-long panorama of `height` rows, twice as wide. A texel that the sun touches holds its mean over the texel.
    pub fn panorama(&self, height: usize) -> Image {
        // Points along each side of a texel: the disc is a dozen of them wide at least.
        let fine = (4096 / height.max(1)).clamp(16, 128);
        let width = 2 * height;
        let at = |x: f64, y: f64| {
            Layout::LatLong
                .direction([x / width as f64, y / height as f64])
                .to_f32()
        };
        // From the centre of a texel to its corner, and a little more.
        let reach = SUN_RADIUS + 1.5 * PI / height as f64;
        let near = Real::cos(reach.min(PI)) as f32;
        Image::from_fn(width, height, |x, y| {
            let centre = at(x as f64 + 0.5, y as f64 + 0.5);
            let mut rgb = self.diffuse(centre);
            if self.options.sun && centre.dot(self.frame.n) >= near {
                let mut sum = [0.0; 3];
                let mut weights = 0.0;
                for k in 0..fine * fine {
                    let offset = |i: usize| (i as f64 + 0.5) / fine as f64;
                    let row = y as f64 + offset(k / fine);
                    let d = at(x as f64 + offset(k % fine), row);
                    let weight = Real::sin(PI * row / height as f64);
                    weights += weight;
                    if self.is_in_sun(d) {
                        let radiance = self.sunlight(d.to_f64());
                        for (s, l) in sum.iter_mut().zip(radiance) {
                            *s += weight * l;
                        }
                    }
                }
                for (to, s) in rgb.iter_mut().zip(sum) {
                    *to += (s / weights) as f32;
                }
            }
            rgb
        })
    }

    /// Radiance of the sun's centre, if it shines.
    pub(crate) fn peak(&self) -> [f64; 3] {
        if self.options.sun {
            let d = self.diffuse(self.frame.n).map(f64::from);
            let sun = self.sunlight(self.towards);
            return [0, 1, 2].map(|c| d[c] + sun[c]);
        }
        self.diffuse(self.frame.n).map(f64::from)
    }

    /// In words, for people.
    pub(crate) fn words(&self) -> String {
        let [r, g, b] = self.options.albedo;
        format!(
            "sky, sun at azimuth {:.2}° (from north over east), elevation {:.2}°; turbidity {}, albedo {r}/{g}/{b}{}{}{}",
            self.position.azimuth_deg,
            self.position.elevation_deg,
            self.options.turbidity,
            if self.options.sun {
                ""
            } else {
                ", without sun"
            },
            if self.options.sky {
                ""
            } else {
                ", without sky"
            },
            if self.options.ground {
                ""
            } else {
                ", without ground"
            },
        )
    }
}
