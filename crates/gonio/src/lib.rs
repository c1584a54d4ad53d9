//! Gonio, a reflectance laboratory and reference renderer.
//!
//! You bring a reflection function and light. Gonio evaluates it, proves or refutes that it is physical, and renders it.
//!
//! This crate is the façade: each concept of the theory is a module, re-exported from the crate that implements it.
//!
//! | module | concept |
//! |---|---|
//! | [`num`] | the numbers that formulas are written over |
//! | [`radiometry`] | quantities and units, spectra and colour, directions, solid angles, sampling |
//! | [`image`] | pictures of light: files, tone mapping, differences |
//! | [`verify`] | evidence: is this reflection function physical? |
//! | [`plot`] | pictures of reflection functions |
//! | [`exec`] | reflection functions that other programs evaluate |
//! | [`brdf`] | reflection functions and their registry |
//! | [`env`](mod@env) | environment maps |
//! | [`scene`] | shapes, materials, lights, cameras, and readers |
//! | [`render`] | the reflection equation solved over a scene; radiometric sensors |
//! | [`preview`] | the embedded scene that `gonio render` shows without a file |
//! | [`report`] | verdicts as JUnit XML and as a page of HTML |
//!
//! # radiometry
//! Quantities are types: radiance times projected solid angle is irradiance, and a wrong product does not compile.
//! ```
//! use gonio::radiometry::quantity::*;
//! let e: Irradiance = Radiance::new(1.0) * ProjectedSolidAngle::hemisphere();
//! assert_eq!(e.value(), std::f64::consts::PI); // W/m²
//! ```
//!
//! # brdf
//! A model by its description, in any number type; f is in sr⁻¹, without the cosine.
//! ```
//! use gonio::brdf::{Brdf, Model, ModelSpec};
//! use gonio::num::Vec3;
//! let model: Model<f64, 3> = ModelSpec::parse("lambertian:reflectance=0.5")?.build()?;
//! let up = Vec3::new(0.0, 0.0, 1.0);
//! assert_eq!(model.eval(up, up)[0], 0.5 / std::f64::consts::PI);
//! # Ok::<(), gonio::brdf::BrdfError>(())
//! ```
//!
//! # verify
//! Anybody's function as a closure; the report says what fails, by how much, and where.
//! ```
//! use gonio::num::Vec3;
//! use gonio::verify::{Effort, Expectation, Subject, check};
//! // Brighter towards the viewer's own direction: swapping wi and wo gives another value.
//! let lopsided = |wi: Vec3<f64>, wo: Vec3<f64>| match wi.z > 0.0 && wo.z > 0.0 {
//!     true => [0.2 * wo.z; 3],
//!     false => [0.0; 3],
//! };
//! let subject = Subject::new("lopsided", &lopsided);
//! let report = check(&subject, &Expectation::PHYSICAL, Effort::Quick, "rustdoc")?;
//! let failed: Vec<String> = report.failures().map(|v| v.property.to_string()).collect();
//! assert_eq!(failed, ["reciprocity"]);
//! # Ok::<(), gonio::verify::SubjectFailed>(())
//! ```
//!
//! # plot
//! A picture of anybody's function, as SVG text or PNG.
//! ```
//! use gonio::plot::{Function, Options, polar};
//! let paint = Function::new("paint", |wi, wo| [if wi.z > 0.0 && wo.z > 0.0 { 0.25 } else { 0.0 }; 3]);
//! let figure = polar(&[paint], &Options { theta_deg: vec![45.0], ..Options::default() })?;
//! assert!(figure.svg().starts_with("<svg"));
//! # Ok::<(), gonio::plot::PlotError>(())
//! ```
//!
//! # env
//! Light from infinitely far away.
//! ```
//! use gonio::env::Environment;
//! use gonio::num::Vec3;
//! let sky = Environment::uniform([1.0, 2.0, 3.0]);
//! let [r, _, b] = sky.irradiance(Vec3::new(0.0, 1.0, 0.0));
//! assert!((r - std::f64::consts::PI).abs() < 1e-12 && (b - 3.0 * r).abs() < 1e-12);
//! ```
//!
//! # scene and render
//! A ball under that sky, and a picture of it: it shows its albedo.
//! ```
//! use gonio::brdf::ModelSpec;
//! use gonio::env::Environment;
//! use gonio::num::Affine3;
//! use gonio::render::{RenderOptions, render};
//! use gonio::scene::{Material, SceneBuilder, Shape};
//! use std::ops::ControlFlow;
//!
//! let mut builder = SceneBuilder::new("ball");
//! let paint = ModelSpec::parse("lambertian:reflectance=0.5")?;
//! let material = builder.material(Material::new("paint", &paint)?);
//! let sphere = builder.shape(Shape::Sphere);
//! builder.instance(sphere, Affine3::identity(), material);
//! builder.environment(Environment::uniform([1.0; 3]));
//! let scene = builder.build()?;
//!
//! let options = RenderOptions { width: 32, height: 32, ..RenderOptions::default() };
//! let camera = scene.camera_or_framing(1.0);
//! let (film, _) = render(&scene, &camera, &options, |_, _| ControlFlow::Continue(()))?;
//! let centre = film.image().get(16, 16);
//! assert!((centre[0] - 0.5).abs() < 0.05);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Longer ones are in the crate's `examples` folder.

pub use gonio_brdf as brdf;
pub use gonio_env as env;
pub use gonio_exec as exec;
pub use gonio_image as image;
pub use gonio_num as num;
pub use gonio_plot as plot;
pub use gonio_radiometry as radiometry;
pub use gonio_render as render;
pub use gonio_report as report;
pub use gonio_scene as scene;
pub use gonio_verify as verify;

pub mod cli;
pub mod preview;

#[cfg(doctest)]
mod documents;
