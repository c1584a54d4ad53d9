//! `gonio measure`.

use super::environment::{EnvironmentArguments, replaced};
use super::failure::Failure;
use super::parse;
use super::render::load_scene;
use super::terminal::{print, print_json, significant, warn};
use gonio_env::Environment;
use gonio_num::Vec3;
use gonio_render::Integrator;
use gonio_render::integrator::{Direct, Path as PathTracer};
use gonio_render::sensor::{self, Parallelogram, Reading, SensorOptions};
use gonio_scene::{Ray, Scene, SceneBuilder};
use std::path::PathBuf;

#[derive(clap::Subcommand)]
#[command(after_help = "Example:\n  gonio measure irradiance --env uniform:1")]
pub(super) enum Command {
    /// Irradiance E = ∫ L cosθ dω at a point with a normal, or of a bare environment
    #[command(after_help = "Examples:\n  \
        gonio measure irradiance --env uniform:1\n  \
        gonio measure irradiance --env sunset.hdr --normal 0,1,0\n  \
        gonio measure irradiance room.toml --point 0,0.8,0 --normal 0,1,0")]
    Irradiance {
        /// Where
        #[arg(long, value_name = "X,Y,Z", default_value = "0,0,0", value_parser = parse::vector, allow_hyphen_values = true)]
        point: Vec3<f32>,
        /// The side that receives light
        #[arg(long, value_name = "X,Y,Z", default_value = "0,1,0", value_parser = parse::vector, allow_hyphen_values = true)]
        normal: Vec3<f32>,
        #[command(flatten)]
        source: Source,
    },
    /// Radiant exitance M = ∫ L cosθ dω leaving a surface at a point
    #[command(
        after_help = "Example:\n  gonio measure exitance room.toml --point 0,0,0 --normal 0,1,0"
    )]
    Exitance {
        /// A point on the surface
        #[arg(long, value_name = "X,Y,Z", value_parser = parse::vector, allow_hyphen_values = true)]
        point: Vec3<f32>,
        /// The side that light leaves from
        #[arg(long, value_name = "X,Y,Z", value_parser = parse::vector, allow_hyphen_values = true)]
        normal: Vec3<f32>,
        /// How far from the point rays start: less than the gap to other surfaces
        #[arg(long, value_name = "LENGTH", default_value = "0.001", value_parser = parse::finite, allow_hyphen_values = true)]
        distance: f32,
        #[command(flatten)]
        source: Source,
    },
    /// Radiance L along a ray: what arrives at its origin from its direction
    #[command(
        after_help = "Example:\n  gonio measure radiance room.toml --origin 0,1,4 --direction 0,0,-1"
    )]
    Radiance {
        /// Where the light arrives
        #[arg(long, value_name = "X,Y,Z", default_value = "0,0,0", value_parser = parse::vector, allow_hyphen_values = true)]
        origin: Vec3<f32>,
        /// Where it comes from, seen from the origin
        #[arg(long, value_name = "X,Y,Z", value_parser = parse::vector, allow_hyphen_values = true)]
        direction: Vec3<f32>,
        #[command(flatten)]
        source: Source,
    },
    /// Radiant flux Φ = ∫∫ L cosθ dω dA through a rectangle, or of a light
    #[command(after_help = "Examples:\n  \
        gonio measure flux room.toml --corner -1,0,-1 --side-u 0,0,2 --side-v 2,0,0\n  \
        gonio measure flux room.toml --light 0")]
    Flux {
        /// A corner of the rectangle
        #[arg(long, value_name = "X,Y,Z", value_parser = parse::vector, allow_hyphen_values = true,
              requires = "side_u", requires = "side_v")]
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
        #[command(flatten)]
        source: Source,
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
    #[arg(long, value_name = "N", default_value_t = 65536, value_parser = parse::whole(2, u64::from(u32::MAX)), allow_hyphen_values = true)]
    samples: u64,
    /// Seed of the samples
    #[arg(long, value_name = "S", default_value_t = 0, value_parser = parse::whole(0, u64::MAX), allow_hyphen_values = true)]
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
                Integrator::Direct(Direct::default())
            } else {
                Integrator::Path(PathTracer::default())
            },
            samples: self.samples,
            seed: self.seed,
        }
    }

    fn scene(&self) -> Result<Scene, Failure> {
        let scene = match &self.scene {
            Some(path) => {
                let mut scene = load_scene(path, &self.environment.for_scene())?;
                self.environment.apply(&mut scene)?;
                scene
            }
            None => {
                let mut scene = SceneBuilder::new("environment");
                scene.environment(self.some_environment()?);
                scene.build()?
            }
        };
        for warning in &scene.warnings {
            warn(warning);
        }
        Ok(scene)
    }

    fn some_environment(&self) -> Result<Environment, Failure> {
        let environment = self.environment.load()?.ok_or_else(|| {
            Failure::usage("nothing to measure: no scene and no environment")
                .with_help("name a scene file, or give --env FILE or --env uniform:1")
        })?;
        if let Some(text) = replaced(&environment) {
            warn(&text);
        }
        Ok(environment)
    }

    /// The bare environment, when that is all there is.
    fn bare_environment(&self) -> Result<Option<Environment>, Failure> {
        match self.scene {
            Some(_) => Ok(None),
            None => self.some_environment().map(Some),
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
        } => (source, exitance(source, *point, *normal, *distance)?),
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
            if light.is_none() && corner.is_none() {
                return Err(nothing_to_receive());
            }
            let scene = source.scene()?;
            let reading = match (light, corner, side_u, side_v) {
                (Some(light), ..) => flux_of_light(&scene, *light)?,
                (None, Some(corner), Some(side_u), Some(side_v)) => {
                    let detector = Parallelogram {
                        corner: *corner,
                        side_u: *side_u,
                        side_v: *side_v,
                    };
                    sensor::flux(&scene, &detector, &source.options())?
                }
                _ => {
                    return Err(nothing_to_receive());
                }
            };
            (source, reading)
        }
    };
    if source.json {
        return print_json(&reading);
    }
    print(&in_words(&reading))
}

fn nothing_to_receive() -> Failure {
    Failure::usage("it is not said what the flux goes through, or which light it is of")
        .with_help("give --corner, --side-u and --side-v of a rectangle, or --light NUMBER")
}

/// Of a bare environment the integral is computed, not sampled.
fn irradiance(source: &Source, point: Vec3<f32>, normal: Vec3<f32>) -> Result<Reading, Failure> {
    if let Some(environment) = source.bare_environment()? {
        let n = sensor::unit("normal", normal)?;
        return Ok(closed_form(
            "irradiance",
            "W m⁻²",
            environment.irradiance(n),
        ));
    }
    Ok(sensor::irradiance(
        &source.scene()?,
        point,
        normal,
        &source.options(),
    )?)
}

/// Where there is no surface nothing leaves: that is more likely a slip than a question.
fn exitance(
    source: &Source,
    point: Vec3<f32>,
    normal: Vec3<f32>,
    distance: f32,
) -> Result<Reading, Failure> {
    if source.scene.is_none() {
        return Err(
            Failure::usage("exitance leaves a surface, and there is no scene")
                .with_help("name a scene file"),
        );
    }
    let n = sensor::unit("normal", normal)?;
    let scene = source.scene()?;
    let towards = Ray {
        origin: point + n * distance,
        direction: -n,
        t_max: 2.0 * distance,
    };
    let reading = sensor::radiant_exitance(&scene, point, normal, distance, &source.options())?;
    if scene.intersect(&towards).is_none() {
        return Err(Failure::usage(format!(
            "there is no surface within {distance} of the point {},{},{}",
            point.x, point.y, point.z
        ))
        .with_help("name a point on a surface and its normal, or a larger --distance"));
    }
    Ok(reading)
}

fn radiance(source: &Source, origin: Vec3<f32>, direction: Vec3<f32>) -> Result<Reading, Failure> {
    if let Some(environment) = source.bare_environment()? {
        let d = sensor::unit("direction", direction)?;
        let value = environment.radiance(d).map(f64::from);
        return Ok(closed_form("radiance", "W m⁻² sr⁻¹", value));
    }
    Ok(sensor::radiance(
        &source.scene()?,
        origin,
        direction,
        &source.options(),
    )?)
}

fn flux_of_light(scene: &Scene, light: usize) -> Result<Reading, Failure> {
    let count = scene.lights.len();
    if light >= count {
        return Err(
            Failure::usage(format!("there is no light {light}: the scene has {count}")).with_help(
                match count {
                    0 => "measure the flux through a rectangle".to_owned(),
                    1 => "name it: --light 0".into(),
                    _ => format!("name one of 0 to {}", count - 1),
                },
            ),
        );
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
