//! [`EnvInfo`], what an environment is made of.

use crate::environment::Source;
use crate::projection::View;
use crate::{Convention, Environment, Layout, Panorama, luminance};
use gonio_image::{TexelFormat, f16};
use gonio_num::{Real, Vec3};
use serde::Serialize;
use std::fmt;

/// A description of an environment, for people and, through serde, for programs. Radiometric values include the scale,
/// directions the rotation.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EnvInfo {
    /// The file it was read from.
    pub file: Option<String>,
    /// The sky that it is, in words.
    pub sky: Option<String>,
    /// How the picture is laid out; nothing for a uniform environment.
    pub layout: Option<Layout>,
    /// Whose turn of the layout; nothing for a uniform environment.
    pub convention: Option<Convention>,
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
    /// Whether the brightest light looks clipped: four or more texels at exactly the same maximum, or one at the largest
    /// half float (65,504) or RGB9E5 (65,408), in less than a twentieth of the sphere, at four times the mean or more.
    /// Irradiance is then probably too small.
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
#[derive(Debug, Default)]
struct Survey {
    smallest: f64,
    largest: f64,
    /// The texel of the largest luminance, and its value.
    peak: [usize; 2],
    peak_radiance: [f32; 3],
    at_maximum: u64,
    maximum: f32,
    solid_angle: f64,
    at_maximum_solid_angle: f64,
    black_solid_angle: f64,
}

/// A picture that was resampled to be light, as it was.
#[derive(Debug)]
pub(crate) struct Origin {
    view: View,
    width: usize,
    height: usize,
    survey: Survey,
}

impl Origin {
    /// Surveys the picture.
    pub fn of(panorama: &Panorama) -> Self {
        let image = panorama.image();
        Self {
            view: *panorama.view(),
            width: image.width,
            height: image.height,
            survey: survey(panorama.view(), image.width, image.height, &image.pixels),
        }
    }
}

fn survey(view: &View, width: usize, height: usize, texels: &[[f32; 3]]) -> Survey {
    let mut survey = Survey {
        smallest: f64::INFINITY,
        largest: -1.0,
        ..Survey::default()
    };
    let layout = view.layout();
    for (i, texel) in texels.iter().enumerate() {
        let (x, y) = (i % width, i / width);
        let uv = centre(x, y, width, height);
        if !layout.contains(uv) {
            continue;
        }
        let solid_angle = layout.jacobian(uv);
        let l = luminance(*texel);
        survey.solid_angle += solid_angle;
        if l > survey.largest {
            survey.largest = l;
            survey.peak = [x, y];
            survey.peak_radiance = *texel;
        }
        if l > 0.0 {
            survey.smallest = survey.smallest.min(l);
        } else {
            survey.black_solid_angle += solid_angle;
        }
        let high = texel.iter().copied().fold(0.0, f32::max);
        if high > survey.maximum {
            survey.maximum = high;
            survey.at_maximum = 0;
            survey.at_maximum_solid_angle = 0.0;
        }
        if high >= survey.maximum {
            survey.at_maximum += 1;
            survey.at_maximum_solid_angle += solid_angle;
        }
    }
    survey
}

fn centre(x: usize, y: usize, width: usize, height: usize) -> [f64; 2] {
    [
        (x as f64 + 0.5) / width as f64,
        (y as f64 + 0.5) / height as f64,
    ]
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
            sky: None,
            layout: None,
            convention: None,
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
        if let Source::Sky(sky) = &self.source {
            let d = self.to_world_f64(sky.sun_position().direction());
            info.sky = Some(sky.words());
            info.dynamic_range = None;
            info.peak.radiance = sky.peak();
            for (to, factor) in info.peak.radiance.iter_mut().zip(scale) {
                *to *= factor;
            }
            info.peak.direction = d.to_array();
            info.peak.theta_deg = Real::atan2((d.x * d.x + d.z * d.z).sqrt(), d.y).to_degrees();
            info.peak.phi_deg = Real::atan2(d.x, -d.z).to_degrees();
        }
        let Source::Picture(picture) = &self.source else {
            return info;
        };
        let map = &picture.map;
        let (view, width, height) = match &map.origin {
            Some(origin) => (origin.view, origin.width, origin.height),
            None => (
                View::new(map.layout, Convention::Gonio),
                map.width,
                map.height,
            ),
        };
        let own;
        let survey = match &map.origin {
            Some(origin) => &origin.survey,
            None => {
                own = survey(&view, width, height, map.texels());
                &own
            }
        };
        let [x, y] = survey.peak;
        let d = self.to_world_f64(view.direction(centre(x, y, width, height)));
        let azimuth = Real::atan2(d.x, -d.z).to_degrees();
        info.file = map.file.as_ref().map(|f| f.display().to_string());
        info.layout = Some(view.layout());
        info.convention = Some(view.convention());
        info.width = width;
        info.height = height;
        info.peak = Peak {
            radiance: times_scale(survey.peak_radiance),
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
        let formats = [f16::MAX.to_f32(), TexelFormat::Rgb9e5.largest()];
        info.looks_clipped = (survey.at_maximum >= 4 || formats.contains(&survey.maximum))
            && survey.at_maximum_solid_angle < 0.05 * survey.solid_angle
            && survey.largest * luminance(self.scale) >= 4.0 * mean;
        info
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
                "layout           {layout}, {} × {}{}",
                self.width,
                self.height,
                match self.convention {
                    Some(c) if c != Convention::Gonio => format!(", as {c} turns it"),
                    _ => String::new(),
                }
            )?,
            None => match &self.sky {
                Some(sky) => writeln!(f, "layout           {sky}")?,
                None => writeln!(f, "layout           uniform")?,
            },
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
                    ": the brightest light looks clipped (it has one value, four times the mean or more)"
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
