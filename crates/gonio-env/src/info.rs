//! [`EnvInfo`], what an environment is made of.

use crate::environment::Source;
use crate::{Environment, Layout, luminance};
use gonio_num::{Real, Vec3};
use serde::Serialize;
use std::fmt;

/// A description of an environment, for people and, through serde, for programs. Radiometric values include the scale,
/// directions the rotation.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EnvInfo {
    /// The file it was read from.
    pub file: Option<String>,
    /// How the picture is laid out; nothing for a uniform environment.
    pub layout: Option<Layout>,
    /// Columns of the picture; 0 for a uniform environment.
    pub width: usize,
    /// Rows of the picture; 0 for a uniform environment.
    pub height: usize,
    /// Rotation about +y \[degrees], counter-clockwise seen from above.
    pub yaw_deg: f64,
    /// Radiance averaged over the sphere \[W m⁻² sr⁻¹], RGB.
    pub mean_radiance: [f64; 3],
    /// Irradiance \[W m⁻²], RGB, on surfaces whose normals are +x, −x, +y, −y, +z, −z.
    pub irradiance: [[f64; 3]; 6],
    /// The texel of the largest luminance.
    pub peak: Peak,
    /// Largest luminance over smallest positive luminance; 1 for a uniform environment, nothing for a black one.
    pub dynamic_range: Option<f64>,
    /// Share of the texels that are black, each weighed by its solid angle.
    pub black_share: f64,
    /// Texels that had a NaN or an infinite channel and were replaced.
    pub non_finite_replaced: u64,
    /// Other texels that had a negative channel and were replaced.
    pub negative_replaced: u64,
    /// Texels whose largest channel equals the picture's largest value exactly.
    pub texels_at_maximum: u64,
    /// Whether the brightest light looks clipped: four or more texels at exactly the same maximum, in less than a
    /// twentieth of the sphere, at four times the mean or more. Irradiance is then probably too small.
    pub looks_clipped: bool,
}

/// The brightest texel.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Peak {
    /// Its radiance \[W m⁻² sr⁻¹].
    pub radiance: [f64; 3],
    /// Column and row; (0, 0) for a uniform environment.
    pub texel: [usize; 2],
    /// Unit vector towards it (world).
    pub direction: [f64; 3],
    /// Angle from the zenith +y \[degrees].
    pub theta_deg: f64,
    /// Azimuth \[degrees] in [−180, 180]: 0 in front (−z), 90 to the right (+x).
    pub phi_deg: f64,
}

/// Names of the normals of [`EnvInfo::irradiance`], in order.
const AXES: [(&str, Vec3<f64>); 6] = [
    ("+x", Vec3::new(1.0, 0.0, 0.0)),
    ("-x", Vec3::new(-1.0, 0.0, 0.0)),
    ("+y", Vec3::new(0.0, 1.0, 0.0)),
    ("-y", Vec3::new(0.0, -1.0, 0.0)),
    ("+z", Vec3::new(0.0, 0.0, 1.0)),
    ("-z", Vec3::new(0.0, 0.0, -1.0)),
];

/// What a walk over the texels finds.
#[derive(Default)]
struct Survey {
    smallest: f64,
    largest: f64,
    at_maximum: u64,
    solid_angle: f64,
    at_maximum_solid_angle: f64,
    black_solid_angle: f64,
}

impl Environment {
    /// Measures the environment. It walks every texel for each axis: some tenths of a second for 1024 × 512.
    pub fn info(&self) -> EnvInfo {
        let mean_radiance = self.mean_radiance();
        let mut irradiance = [[0.0; 3]; 6];
        for (to, from) in irradiance
            .iter_mut()
            .zip(self.irradiances(&AXES.map(|(_, n)| n)))
        {
            *to = from.value;
        }
        let scale = self.scale.map(f64::from);
        let times_scale = |l: [f32; 3]| [0, 1, 2].map(|k| f64::from(l[k]) * scale[k]);
        let mut info = EnvInfo {
            file: None,
            layout: None,
            width: 0,
            height: 0,
            yaw_deg: self.yaw_deg,
            mean_radiance,
            irradiance,
            peak: Peak {
                radiance: mean_radiance,
                texel: [0, 0],
                direction: [0.0, 0.0, -1.0],
                theta_deg: 90.0,
                phi_deg: 0.0,
            },
            dynamic_range: (!self.is_black()).then_some(1.0),
            black_share: if self.is_black() { 1.0 } else { 0.0 },
            non_finite_replaced: 0,
            negative_replaced: 0,
            texels_at_maximum: 0,
            looks_clipped: false,
        };
        let Source::Picture(picture) = &self.source else {
            return info;
        };
        let map = &picture.map;
        let (peak, x, y) = map.peak();
        let survey = self.survey();
        let local = map.layout.direction(map.centre(x, y));
        let d = self.to_world_f64(local);
        let azimuth = Real::atan2(d.x, -d.z).to_degrees();
        info.file = map.file.as_ref().map(|f| f.display().to_string());
        info.layout = Some(map.layout);
        info.width = map.width;
        info.height = map.height;
        info.peak = Peak {
            radiance: times_scale(map.texels[y * map.width + x]),
            texel: [x, y],
            direction: d.to_array(),
            theta_deg: Real::atan2((d.x * d.x + d.z * d.z).sqrt(), d.y).to_degrees(),
            phi_deg: azimuth,
        };
        info.dynamic_range = (survey.largest > 0.0).then(|| survey.largest / survey.smallest);
        info.black_share = survey.black_solid_angle / survey.solid_angle;
        info.non_finite_replaced = map.defects.non_finite;
        info.negative_replaced = map.defects.negative;
        info.texels_at_maximum = survey.at_maximum;
        let mean = luminance(mean_radiance.map(|l| l as f32));
        info.looks_clipped = survey.at_maximum >= 4
            && survey.at_maximum_solid_angle < 0.05 * survey.solid_angle
            && peak * luminance(self.scale) >= 4.0 * mean;
        info
    }

    fn survey(&self) -> Survey {
        let mut survey = Survey {
            smallest: f64::INFINITY,
            ..Survey::default()
        };
        let Source::Picture(picture) = &self.source else {
            return survey;
        };
        let map = &picture.map;
        let highest = |t: [f32; 3]| t.into_iter().fold(0.0, f32::max);
        let mut maximum = 0.0;
        for y in 0..map.height {
            for x in 0..map.width {
                if !map.in_domain(x, y) {
                    continue;
                }
                let texel = map.texels[y * map.width + x];
                let solid_angle = map.layout.jacobian(map.centre(x, y));
                let l = luminance(texel);
                survey.solid_angle += solid_angle;
                if l > 0.0 {
                    survey.smallest = survey.smallest.min(l);
                    survey.largest = survey.largest.max(l);
                } else {
                    survey.black_solid_angle += solid_angle;
                }
                let high = highest(texel);
                if high > maximum {
                    maximum = high;
                    survey.at_maximum = 0;
                    survey.at_maximum_solid_angle = 0.0;
                }
                if high >= maximum {
                    survey.at_maximum += 1;
                    survey.at_maximum_solid_angle += solid_angle;
                }
            }
        }
        survey
    }
}

impl fmt::Display for EnvInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rgb = |c: [f64; 3]| {
            format!(
                "{:>12} {:>12} {:>12}",
                number(c[0]),
                number(c[1]),
                number(c[2])
            )
        };
        if let Some(file) = &self.file {
            writeln!(f, "file             {file}")?;
        }
        match self.layout {
            Some(layout) => writeln!(
                f,
                "layout           {layout}, {} × {}",
                self.width, self.height
            )?,
            None => writeln!(f, "layout           uniform")?,
        }
        writeln!(f, "rotation         {:.3}°", self.yaw_deg)?;
        writeln!(f, "{:17}{:>12} {:>12} {:>12}", "", "R", "G", "B")?;
        writeln!(
            f,
            "mean radiance    {}  W m⁻² sr⁻¹",
            rgb(self.mean_radiance)
        )?;
        for ((name, _), e) in AXES.iter().zip(self.irradiance) {
            writeln!(f, "irradiance {name}    {}  W m⁻²", rgb(e))?;
        }
        let p = &self.peak;
        writeln!(f, "peak radiance    {}  W m⁻² sr⁻¹", rgb(p.radiance))?;
        if self.layout.is_some() {
            writeln!(
                f,
                "peak direction   ({:.4}, {:.4}, {:.4}), θ = {:.2}° from the zenith, φ = {:.2}° to the right of −z, texel ({}, {})",
                p.direction[0],
                p.direction[1],
                p.direction[2],
                p.theta_deg,
                p.phi_deg,
                p.texel[0],
                p.texel[1]
            )?;
            match self.dynamic_range {
                Some(range) => writeln!(
                    f,
                    "dynamic range    {} : 1 ({:.1} stops)",
                    number(range),
                    range.log2()
                )?,
                None => writeln!(f, "dynamic range    none: it is black")?,
            }
            writeln!(
                f,
                "black            {:.2} % of the sphere",
                100.0 * self.black_share
            )?;
            writeln!(
                f,
                "replaced texels  {} non-finite, {} negative",
                self.non_finite_replaced, self.negative_replaced
            )?;
            writeln!(
                f,
                "at the maximum   {} texel(s){}",
                self.texels_at_maximum,
                if self.looks_clipped {
                    ": the brightest light looks clipped"
                } else {
                    ""
                }
            )?;
        }
        Ok(())
    }
}

/// Five significant digits.
fn number(x: f64) -> String {
    let magnitude = x.abs();
    if magnitude == 0.0 || (1e-3..1e6).contains(&magnitude) {
        let digits = if magnitude < 1.0 {
            6
        } else {
            4_i32 - magnitude.log10().floor() as i32
        };
        format!("{x:.*}", digits.max(0) as usize)
    } else {
        format!("{x:.4e}")
    }
}
