//! `gonio env irradiance`.

use crate::cli::destination;
use crate::cli::environment::PanoramaArguments;
use crate::cli::failure::Failure;
use crate::cli::parse;
use crate::cli::terminal::{print, print_json, significant};
use gonio_env::Layout;
use gonio_ibl::{Kernel, Maps, Method, Target};
use gonio_image::{CubeMap, Image, TexelFormat};
use gonio_num::Vec3;
use serde::Serialize;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
#[command(after_help = "Examples:\n  \
    gonio env irradiance sunset.hdr --normal 0,1,0\n  \
    gonio env irradiance sunset.hdr -o diffuse.exr\n  \
    gonio env irradiance sunset.hdr -o gloss.ktx2 --exponent 50 --size 128")]
pub(in crate::cli) struct Arguments {
    /// A panorama (EXR, HDR, PNG, JPEG), or uniform:RADIANCE
    environment: String,
    /// Print the irradiance on surfaces of this normal [default: the six axes]
    #[arg(long, value_name = "X,Y,Z", value_parser = parse::vector, allow_hyphen_values = true)]
    normal: Option<Vec3<f32>>,
    /// Write a map: a cube (.ktx2, .dds) or a panorama (.exr, .hdr)
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Texels along an edge of the cube, or rows of the panorama
    #[arg(long, value_name = "N", default_value = "64", value_parser = parse::whole(1usize, 4096))]
    size: usize,
    /// Instead of irradiance the mean radiance weighed by the cosine to this power: Phong's lobe about the axis
    #[arg(
        long,
        value_name = "P",
        requires = "output",
        allow_hyphen_values = true
    )]
    exponent: Option<f64>,
    #[command(flatten)]
    reading: PanoramaArguments,
    /// Print it as JSON
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Reading {
    normal: [f64; 3],
    irradiance: [f64; 3],
    error: [f64; 3],
}

const AXES: [[f64; 3]; 6] = [
    [1.0, 0.0, 0.0],
    [-1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, -1.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.0, 0.0, -1.0],
];

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let kernel = Kernel::cosine(arguments.exponent.unwrap_or(1.0))?;
    if let Some(path) = &arguments.output {
        destination::check_extension(path, &["exr", "hdr", "ktx2", "dds"], "maps")?;
        destination::writable(path)?;
    }
    if arguments.normal.is_some_and(|n| n.length() == 0.0) {
        return Err(Failure::usage("--normal 0,0,0: it has no direction")
            .with_help("give a vector such as 0,1,0"));
    }
    let environment = arguments.reading.parse(&arguments.environment)?;
    if let Some(path) = &arguments.output {
        let maps = Maps::new(&environment, kernel.width(), METHOD);
        // Irradiance is π times the mean radiance under the cosine.
        let factor = if arguments.exponent.is_some() {
            1.0
        } else {
            std::f32::consts::PI
        };
        write(path, &maps, &kernel, arguments.size, factor)?;
        if arguments.exponent.is_some() {
            return print(&format!("written and read again: {}", path.display()));
        }
    }
    let normals: Vec<[f64; 3]> = match arguments.normal {
        Some(n) => vec![[n.x, n.y, n.z].map(f64::from)],
        None => AXES.to_vec(),
    };
    let readings: Vec<Reading> = normals
        .into_iter()
        .map(|n| {
            let unit = Vec3::new(n[0], n[1], n[2]).normalize();
            let e = environment.irradiance_with_error(unit.to_f32());
            Reading {
                normal: [unit.x, unit.y, unit.z],
                irradiance: e.value,
                error: e.error,
            }
        })
        .collect();
    if arguments.json {
        return print_json(&readings);
    }
    let mut text = String::from("normal                     irradiance R, G, B [W m⁻²]\n");
    for r in &readings {
        let [x, y, z] = r.normal;
        let e = r.irradiance.map(significant);
        let _ = writeln!(
            text,
            "{x:>7.4} {y:>7.4} {z:>7.4}   {:>12} {:>12} {:>12}",
            e[0], e[1], e[2]
        );
    }
    if let Some(path) = &arguments.output {
        let _ = writeln!(text, "written and read again: {}", path.display());
    }
    print(&text)
}

/// A tenth of the error of the default, since irradiance maps are small.
const METHOD: Method = Method::Tree(0.15);

fn write(
    path: &Path,
    maps: &Maps<'_>,
    kernel: &Kernel,
    size: usize,
    factor: f32,
) -> Result<(), Failure> {
    let times = |rgb: [f32; 3]| rgb.map(|c| c * factor);
    if matches!(destination::extension(path).as_str(), "ktx2" | "dds") {
        let mut cube = maps.cube(kernel, size, Target::Custom, METHOD);
        for t in &mut cube.texels {
            *t = times(*t);
        }
        let faces = [0, 1, 2, 3, 4, 5].map(|f| cube.face(f));
        let map = CubeMap::new(faces)?;
        map.write(path, TexelFormat::Float)?;
        return same(path, CubeMap::read(path)? == map);
    }
    let (width, height) = (2 * size, size);
    let rows: Vec<Vec<Vec3<f32>>> = (0..height)
        .map(|y| {
            let v = (y as f64 + 0.5) / height as f64;
            (0..width)
                .map(|x| {
                    Layout::LatLong
                        .direction([(x as f64 + 0.5) / width as f64, v])
                        .to_f32()
                })
                .collect()
        })
        .collect();
    // Pieces of rows: axes that share a list of lights should be neighbours.
    let blocks: Vec<Vec<Vec3<f32>>> = rows
        .iter()
        .flat_map(|r| r.chunks(16))
        .map(<[_]>::to_vec)
        .collect();
    let means = maps.means(kernel, &blocks, METHOD);
    let picture = Image {
        width,
        height,
        pixels: means.into_iter().flatten().map(times).collect(),
    };
    picture.write(path)?;
    let read = Image::read(path)?;
    // Radiance HDR keeps eight bits of the largest channel.
    let rounding = if destination::extension(path) == "hdr" {
        1.0 / 128.0
    } else {
        0.0
    };
    let near = read.pixels.iter().zip(&picture.pixels).all(|(a, b)| {
        let largest = b[0].max(b[1]).max(b[2]);
        (0..3).all(|k| (a[k] - b[k]).abs() <= rounding * largest)
    });
    same(path, near && (read.width, read.height) == (width, height))
}

fn same(path: &Path, same: bool) -> Result<(), Failure> {
    if same {
        return Ok(());
    }
    Err(Failure::input(format!(
        "{}: read again, it is not what was written",
        path.display()
    ))
    .with_help("the disk may be full or failing: write elsewhere"))
}
