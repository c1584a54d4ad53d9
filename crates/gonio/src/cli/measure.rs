//! `gonio measure`.

use super::failure::{Failure, chain};
use super::render::EnvironmentArguments;
use super::{parse, print, print_json};
use gonio_num::Vec3;
use gonio_render::integrator::{Direct, Path as PathTracer};
use gonio_render::sensor::{self, Parallelogram, Reading, SensorOptions};
use gonio_render::{Integrator, RenderError};
use gonio_scene::{LoadOptions, Scene, SceneBuilder};
use std::path::PathBuf;

#[derive(clap::Subcommand)]
pub(super) enum Command {
    /// Irradiance E = ∫ L cosθ dω at a point with a normal, or of a bare environment
    #[command(after_help = "Examples:\n  \
        gonio measure irradiance --env uniform:1\n  \
        gonio measure irradiance --env sunset.hdr --normal 0,1,0\n  \
        gonio measure irradiance room.toml --point 0,0.8,0 --normal 0,1,0")]
    Irradiance {
        #[command(flatten)]
        source: Source,
        /// Where
        #[arg(long, value_name = "X,Y,Z", default_value = "0,0,0", value_parser = parse::vector, allow_hyphen_values = true)]
        point: Vec3<f32>,
        /// The side that receives light
        #[arg(long, value_name = "X,Y,Z", default_value = "0,1,0", value_parser = parse::vector, allow_hyphen_values = true)]
        normal: Vec3<f32>,
    },
    /// Radiant exitance M = ∫ L cosθ dω leaving a surface at a point
    #[command(
        after_help = "Example:\n  gonio measure exitance room.toml --point 0,0,0 --normal 0,1,0"
    )]
    Exitance {
        #[command(flatten)]
        source: Source,
        /// A point on the surface
        #[arg(long, value_name = "X,Y,Z", value_parser = parse::vector, allow_hyphen_values = true)]
        point: Vec3<f32>,
        /// The side that light leaves from
        #[arg(long, value_name = "X,Y,Z", value_parser = parse::vector, allow_hyphen_values = true)]
        normal: Vec3<f32>,
        /// How far from the point rays start: less than the gap to other surfaces
        #[arg(long, value_name = "LENGTH", default_value = "0.001", value_parser = parse::finite)]
        distance: f32,
    },
    /// Radiance L along a ray: what arrives at its origin from its direction
    #[command(
        after_help = "Example:\n  gonio measure radiance room.toml --origin 0,1,4 --direction 0,0,-1"
    )]
    Radiance {
        #[command(flatten)]
        source: Source,
        /// Where the light arrives
        #[arg(long, value_name = "X,Y,Z", default_value = "0,0,0", value_parser = parse::vector, allow_hyphen_values = true)]
        origin: Vec3<f32>,
        /// Where it comes from, seen from the origin
        #[arg(long, value_name = "X,Y,Z", value_parser = parse::vector, allow_hyphen_values = true)]
        direction: Vec3<f32>,
    },
    /// Radiant flux Φ = ∫∫ L cosθ dω dA through a rectangle, or of a light
    #[command(after_help = "Examples:\n  \
        gonio measure flux room.toml --corner -1,0,-1 --side-u 0,0,2 --side-v 2,0,0\n  \
        gonio measure flux room.toml --light 0")]
    Flux {
        #[command(flatten)]
        source: Source,
        /// A corner of the rectangle
        #[arg(long, value_name = "X,Y,Z", value_parser = parse::vector, allow_hyphen_values = true,
              required_unless_present = "light", requires = "side_u", requires = "side_v")]
        corner: Option<Vec3<f32>>,
        /// One side of it
        #[arg(long, value_name = "X,Y,Z", value_parser = parse::vector, allow_hyphen_values = true)]
        side_u: Option<Vec3<f32>>,
        /// The other side: the rectangle receives light on the side of side-u × side-v
        #[arg(long, value_name = "X,Y,Z", value_parser = parse::vector, allow_hyphen_values = true)]
        side_v: Option<Vec3<f32>>,
        /// The flux that a light of the scene emits, by its number from 0
        #[arg(long, value_name = "NUMBER", conflicts_with = "corner")]
        light: Option<usize>,
    },
}

/// What is measured, and how well.
#[derive(clap::Args)]
pub(super) struct Source {
    /// A scene: .toml, .gltf, .glb, .obj or .ply; without one, the environment alone
    scene: Option<PathBuf>,
    #[command(flatten)]
    environment: EnvironmentArguments,
    /// Samples
    #[arg(long, value_name = "N", default_value_t = 65536)]
    samples: u64,
    /// Seed of the samples
    #[arg(long, value_name = "S", default_value_t = 0)]
    seed: u64,
    /// Light from lights alone, without reflections between surfaces
    #[arg(long)]
    direct: bool,
    /// Print the reading as JSON
    #[arg(long)]
    json: bool,
}

impl Source {
    fn options(&self) -> SensorOptions {
        SensorOptions {
            integrator: if self.direct {
                Integrator::Direct(Direct)
            } else {
                Integrator::Path(PathTracer::default())
            },
            samples: self.samples,
            seed: self.seed,
        }
    }

    fn scene(&self) -> Result<Scene, Failure> {
        let environment = self.environment.load()?;
        let mut scene = match &self.scene {
            Some(path) => {
                Scene::load(path, &LoadOptions::default()).map_err(|e| Failure::input(chain(&e)))?
            }
            None if let Some(environment) = environment => {
                let mut scene = SceneBuilder::new("environment");
                scene.environment(environment);
                return scene.build().map_err(|e| Failure::input(chain(&e)));
            }
            None => {
                return Err(
                    Failure::usage("nothing to measure: no scene and no environment")
                        .with_help("name a scene file, or give --env FILE or --env uniform:1"),
                );
            }
        };
        if environment.is_some() {
            scene.set_environment(environment);
        }
        if scene.lights.is_empty() {
            eprintln!("warning: the scene has no light: every reading is 0");
        }
        Ok(scene)
    }

    /// The bare environment, when that is all there is.
    fn bare_environment(&self) -> Result<Option<gonio_env::Environment>, Failure> {
        if self.scene.is_some() {
            Ok(None)
        } else {
            self.environment.load()
        }
    }
}

pub(super) fn run(command: Command) -> Result<(), Failure> {
    let (source, reading) = match &command {
        Command::Irradiance {
            source,
            point,
            normal,
        } => (source, irradiance(source, *point, *normal)?),
        Command::Exitance {
            source,
            point,
            normal,
            distance,
        } => (
            source,
            sensor::radiant_exitance(
                &source.scene()?,
                *point,
                *normal,
                *distance,
                &source.options(),
            )
            .map_err(usage)?,
        ),
        Command::Radiance {
            source,
            origin,
            direction,
        } => (source, radiance(source, *origin, *direction)?),
        Command::Flux {
            source,
            corner,
            side_u,
            side_v,
            light,
        } => {
            let scene = source.scene()?;
            let reading = match (light, corner, side_u, side_v) {
                (Some(light), ..) => flux_of_light(&scene, *light)?,
                (None, Some(corner), Some(side_u), Some(side_v)) => {
                    let detector = Parallelogram {
                        corner: *corner,
                        side_u: *side_u,
                        side_v: *side_v,
                    };
                    sensor::flux(&scene, &detector, &source.options()).map_err(usage)?
                }
                _ => {
                    return Err(Failure::usage(
                        "a rectangle needs --corner, --side-u and --side-v",
                    ));
                }
            };
            (source, reading)
        }
    };
    if source.json {
        return print_json(&reading);
    }
    print(&in_words(&reading));
    Ok(())
}

/// Of a bare environment the integral is computed, not sampled.
fn irradiance(source: &Source, point: Vec3<f32>, normal: Vec3<f32>) -> Result<Reading, Failure> {
    if let Some(environment) = source.bare_environment()? {
        let n = sensor::unit("normal", normal).map_err(usage)?;
        return Ok(closed_form(
            "irradiance",
            "W m⁻²",
            environment.irradiance(n),
        ));
    }
    sensor::irradiance(&source.scene()?, point, normal, &source.options()).map_err(usage)
}

fn radiance(source: &Source, origin: Vec3<f32>, direction: Vec3<f32>) -> Result<Reading, Failure> {
    if let Some(environment) = source.bare_environment()? {
        let d = sensor::unit("direction", direction).map_err(usage)?;
        let value = environment.radiance(d).map(f64::from);
        return Ok(closed_form("radiance", "W m⁻² sr⁻¹", value));
    }
    sensor::radiance(&source.scene()?, origin, direction, &source.options()).map_err(usage)
}

fn flux_of_light(scene: &Scene, light: usize) -> Result<Reading, Failure> {
    let count = scene.lights.len();
    if light >= count {
        return Err(Failure::usage(format!(
            "there is no light {light}: the scene has {count}"
        )));
    }
    match u32::try_from(light)
        .ok()
        .and_then(|i| scene.lights.power(i))
    {
        Some(value) => Ok(closed_form("radiant flux", "W", value)),
        None => Err(Failure::usage(format!(
            "light {light} is infinitely far away: it has no finite flux"
        ))
        .with_help("measure its irradiance, or the flux through a rectangle")),
    }
}

fn closed_form(quantity: &'static str, unit: &'static str, value: [f64; 3]) -> Reading {
    Reading {
        quantity,
        unit,
        value,
        standard_error: None,
        samples: 0,
        rejected: 0,
    }
}

fn usage(error: RenderError) -> Failure {
    Failure::usage(chain(&error))
}

/// The reading in lines: one number if the three agree.
fn in_words(reading: &Reading) -> String {
    let number = |c: usize| match reading.standard_error {
        Some(error) => format!(
            "{} ± {}",
            significant(reading.value[c]),
            significant(error[c])
        ),
        None => significant(reading.value[c]),
    };
    let [r, g, b] = [0, 1, 2].map(number);
    let mut text = if r == g && g == b {
        format!("{}: {r} {}\n", reading.quantity, reading.unit)
    } else {
        format!(
            "{} [{}]\n  red   {r}\n  green {g}\n  blue  {b}\n",
            reading.quantity, reading.unit
        )
    };
    if reading.standard_error.is_some() {
        text += &format!("  ± one standard error, {} samples\n", reading.samples);
    }
    if reading.rejected > 0 {
        text += &format!(
            "  {} samples were not finite or negative and count as 0\n",
            reading.rejected
        );
    }
    text
}

/// Seven significant digits, without an exponent where it reads well.
fn significant(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let magnitude = value.abs().log10().floor() as i32;
    if (-4..7).contains(&magnitude) {
        format!("{value:.*}", (6 - magnitude).max(0) as usize)
    } else {
        format!("{value:.6e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seven_digits() {
        assert_eq!(significant(std::f64::consts::PI), "3.141593");
        assert_eq!(significant(1234.56789), "1234.568");
        assert_eq!(significant(0.00012345678), "0.0001234568");
        assert_eq!(significant(1.5e12), "1.500000e12");
        assert_eq!(significant(0.0), "0");
    }
}
