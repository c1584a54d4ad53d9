//! Pictures by the renderer, in parts that add up.

use crate::answer::{Answer, colours};
use crate::complaint::Complaint;
use crate::light::environment;
use crate::plots::{Switches, side};
use crate::subject::Angles;
use gonio_brdf::ModelSpec;
use gonio_env::Environment;
use gonio_num::Affine3;
use gonio_render::integrator::{Direct, Path};
use gonio_render::{Exposure, Integrator, RenderOptions, Target, expose};
use gonio_scene::{Camera, Light, LoadOptions, Material, Scene, SceneBuilder, Shape};
use serde::Deserialize;
use serde_json::json;
use std::f32::consts::PI;
use std::ops::ControlFlow;
use std::sync::{Mutex, PoisonError};

/// What is pictured, but for the function.
#[derive(Deserialize, Clone, PartialEq)]
#[serde(rename_all = "kebab-case")]
enum Object {
    /// A sphere alone.
    Ball,
    /// The preview object on its stand: `files/scene.toml`.
    Preview,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Render {
    function: String,
    object: Object,
    light: String,
    direction: Angles,
    turn: f32,
    width: usize,
    height: usize,
    first: u32,
    count: u32,
    bounces: u32,
    factors: Switches,
}

/// A scene that is built, and what it was built for.
struct Stage {
    object: Object,
    scene: Scene,
    light: String,
    function: String,
}

/// The last one: parts of a picture, and of the next one with another function, have all but that in common.
static STAGE: Mutex<Option<Stage>> = Mutex::new(None);

/// The name of the material that is looked at.
const OBJECT: &str = "object";

/// The scene without a light of its own.
fn build(object: &Object, function: &ModelSpec) -> Result<Scene, Complaint> {
    match object {
        Object::Ball => {
            let mut builder = SceneBuilder::new("ball");
            let material = builder.material(Material::new(OBJECT, function)?);
            let shape = builder.shape(Shape::Sphere);
            builder.instance(shape, Affine3::identity(), material);
            builder.environment(Environment::uniform([1.0; 3]));
            Ok(builder.build()?)
        }
        Object::Preview => {
            let mut scene = Scene::load("files/scene.toml", &LoadOptions::default())?;
            scene.replace_material(OBJECT, function)?;
            Ok(scene)
        }
    }
}

/// Forgets it.
pub(crate) fn forget() {
    *STAGE.lock().unwrap_or_else(PoisonError::into_inner) = None;
}

/// Puts the light of a request into a scene.
fn illuminate(scene: &mut Scene, camera: &Camera, of: &Render) -> Result<(), Complaint> {
    let words = if of.factors.light {
        of.light.as_str()
    } else {
        "uniform:1"
    };
    if words != "point" {
        let light = environment(words)?.try_rotated_deg(of.turn)?;
        scene.set_lights(Vec::new(), Some(light));
        return Ok(());
    }
    // As of the ball: from the direction of the viewer, x to the right, y up.
    let towards = camera
        .to_world
        .transform_vector(of.direction.direction().to_f32());
    let light = Light::Directional {
        direction: -towards.normalize(),
        irradiance: [PI; 3],
    };
    scene.set_lights(vec![light], None);
    Ok(())
}

/// Sums of samples of each pixel.
pub(crate) fn render(of: Render) -> Result<Answer, Complaint> {
    let (width, height) = (side(of.width)? as u32, side(of.height)? as u32);
    let last = of.first.checked_add(of.count).filter(|_| of.count > 0);
    let Some(last) = last else {
        return Err(Complaint::new(
            "there are no samples from `first` on, `count` of them",
        ));
    };
    let function = if of.factors.brdf {
        of.function.as_str()
    } else {
        "lambertian:1"
    };
    let light = format!(
        "{} {} {:?} {}",
        of.factors.light, of.light, of.direction, of.turn
    );
    let mut kept = STAGE.lock().unwrap_or_else(PoisonError::into_inner);
    let spec = ModelSpec::open(function)?;
    let stage = match kept.take() {
        Some(mut stage) if stage.object == of.object => {
            if stage.function != function {
                stage.scene.replace_material(OBJECT, &spec)?;
                stage.function = function.into();
            }
            stage
        }
        _ => Stage {
            object: of.object.clone(),
            scene: build(&of.object, &spec)?,
            light: String::new(),
            function: function.into(),
        },
    };
    let stage = kept.insert(stage);
    let camera = stage.scene.camera_or_framing(width as f32 / height as f32);
    if stage.light != light {
        illuminate(&mut stage.scene, &camera, &of)?;
        stage.light = light;
    }
    let whole = of.factors.light && of.factors.brdf && of.factors.cosine;
    let options = RenderOptions {
        width,
        height,
        target: Target {
            samples: last,
            time: None,
            noise: None,
            adaptive: false,
        },
        integrator: if whole {
            Integrator::Path(Path {
                max_bounces: of.bounces,
                ..Path::default()
            })
        } else {
            Integrator::Direct(Direct {
                without_cosine: !of.factors.cosine,
                ..Direct::default()
            })
        },
        ..RenderOptions::default()
    };
    let mut exposure = Exposure::new(width, height, of.first)?;
    expose(&stage.scene, &camera, &options, &mut exposure, |_, _| {
        ControlFlow::Continue(())
    })?;
    let film = &exposure.film;
    let count = f64::from(of.count);
    let sums = film.pixels().iter().map(|p| p.mean().map(|x| x * count));
    Ok(Answer::new(
        json!({ "samples": of.count, "rejected": film.rejected().count }),
        vec![("sums", colours(sums))],
    ))
}
