//! Everything a renderer needs of an environment, in a folder, each file read again and compared.

use crate::cube::Cube;
use crate::harmonics::{Residual, Window};
use crate::maps::{Family, MapError, Maps, Method, mirror};
use crate::{Dfg, Harmonics, IblError, Kernel, Target};
use gonio_env::Environment;
use gonio_image::{ChannelData, CubeMap, Image, Layers, TexelFormat, write_file};
use serde::Serialize;
use std::path::Path;
use std::time::Instant;

/// What is made.
#[derive(Debug, Clone)]
pub struct Options {
    /// For whom.
    pub target: Target,
    /// Texels along an edge of level 0, a power of two from 16 to 4096.
    pub size: usize,
    /// Kernels of the levels.
    pub family: Family,
    /// Also a chain of the sheen "Charlie".
    pub sheen: bool,
    /// How means are found.
    pub method: Method,
    /// Texels of each level that are compared with exact quadrature; 0: none.
    pub check: usize,
    /// Texels along an edge of the diffuse map, a power of two.
    pub diffuse_size: usize,
    /// Bands of the spherical harmonics.
    pub bands: usize,
    /// For `custom`: of irradiance.
    pub irradiance: bool,
    /// Their window.
    pub window: Window,
    /// Columns and rows of the table.
    pub table_size: usize,
    /// The model of the table.
    pub table_model: String,
    /// Texels of the cubes.
    pub format: TexelFormat,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            target: Target::Gltf,
            size: 256,
            family: Family::Ggx,
            sheen: false,
            method: Method::Tree(crate::DEFAULT_TOLERANCE),
            check: 16,
            diffuse_size: 32,
            bands: 3,
            irradiance: false,
            window: Window::None,
            table_size: 128,
            table_model: "ggx".to_owned(),
            format: TexelFormat::Half,
        }
    }
}

/// One level of a chain.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LevelReport {
    /// Which file.
    pub map: String,
    /// Counted from 0.
    pub level: usize,
    /// Texels along an edge.
    pub size: usize,
    /// Perceptual roughness; 0: the picture.
    pub roughness: f64,
    /// Time that it took.
    pub seconds: f64,
    /// Against exact quadrature.
    pub error: Option<MapError>,
}

/// What was made.
#[derive(Debug, Clone, Serialize)]
pub struct Report {
    /// For whom.
    pub target: Target,
    /// The files, by name, all read again.
    pub files: Vec<String>,
    /// The levels of every chain.
    pub levels: Vec<LevelReport>,
    /// What the coefficients mean.
    pub harmonics: String,
    /// What the window took.
    pub residual: Residual,
    /// Samples above the largest that the format of the cubes holds, which became that.
    pub clamped: u64,
    /// Remarks that a reader of the files should know.
    pub notes: Vec<String>,
}

/// Coefficients in a file.
#[derive(Serialize)]
struct HarmonicsFile<'a> {
    target: Target,
    meaning: &'a str,
    bands: usize,
    order: &'a str,
    coefficients: &'a [[f64; 3]],
}

/// What a step is called in the progress, and how many there are.
pub type Progress<'a> = &'a mut dyn FnMut(&str);

/// Names of the steps in [`write()`]: each level of each chain, and four more.
pub fn steps(options: &Options) -> usize {
    let chains = 1 + usize::from(options.sheen && options.target != Target::Three);
    chains * options.target.levels(options.size) + 4
}

/// Makes everything in `folder`, which must exist, and reads every file again.
///
/// | file | what |
/// |---|---|
/// | `specular.ktx2`, `specular.dds` (unreal, unity), `specular.exr` (three: the atlas) | means of radiance, level by level |
/// | `sheen.*` | the same for Charlie, if asked for |
/// | `diffuse.*` | irradiance / π |
/// | `harmonics.json` | spherical harmonics |
/// | `dfg.exr` | the table; B is the albedo of the sheen, if asked for |
/// | `report.json` | the report |
///
/// # Errors
/// Arguments out of range, models without kernel, files that can't be written, or that don't read as they were written.
pub fn write(
    environment: &Environment,
    options: &Options,
    folder: &Path,
    progress: Progress<'_>,
) -> Result<Report, IblError> {
    check(options)?;
    let target = options.target;
    let count = target.levels(options.size);
    let levels: Vec<f64> = (0..count).map(|k| target.roughness(k, count)).collect();
    let extension = match target {
        Target::Unreal | Target::Unity => "dds",
        _ => "ktx2",
    };
    let chain = kernels(&options.family, &levels)?;
    let sheen = if options.sheen {
        kernels(&Family::Charlie, &levels)?
    } else {
        Vec::new()
    };
    let width = chain
        .iter()
        .chain(&sheen)
        .flatten()
        .map(Kernel::width)
        .fold(1.0, f64::min);
    progress("light");
    let maps = Maps::new(environment, width, options.method);
    let mut report = Report {
        target,
        files: Vec::new(),
        levels: Vec::new(),
        harmonics: target.harmonics_meaning().to_owned(),
        residual: Window::None.apply(&Harmonics::new(vec![[0.0; 3]])?).1,
        clamped: 0,
        notes: Vec::new(),
    };
    if environment.sky().is_some() {
        // A count of points in a circle of radius r steps is off by about r^(−4/3), and r is six.
        report.notes.push(
            "a computed sky is read at points: the flux of its sun is within a few per cent"
                .to_owned(),
        );
    }
    for kernel in chain.iter().flatten() {
        if let Kernel::Model(m) = kernel
            && m.colour_difference > 1e-3
        {
            report.notes.push(format!(
                "{}: its colours have lobes of different shapes; the kernel is their mean",
                m.name
            ));
        }
    }
    if target == Target::Three {
        progress("specular");
        let start = Instant::now();
        let atlas = maps.three_atlas(options.size, &chain, options.method);
        let seconds = start.elapsed().as_secs_f64();
        image(folder, "specular.exr", &atlas, &mut report)?;
        report.levels.push(LevelReport {
            map: "specular.exr".to_owned(),
            level: 0,
            size: options.size,
            roughness: 0.0,
            seconds,
            error: None,
        });
        // The atlas holds the same means at other directions: they are checked as cubes of 16 texels.
        for (k, kernel) in chain.iter().enumerate() {
            if let (Some(kernel), true) = (kernel, options.check > 0) {
                progress("check");
                let cube = maps.cube(kernel, 16, target, options.method);
                report.levels.push(LevelReport {
                    map: "specular.exr".to_owned(),
                    level: k,
                    size: (options.size >> k).max(16),
                    roughness: levels[k],
                    seconds: 0.0,
                    error: Some(maps.compare(kernel, &cube, target, options.check)),
                });
            }
        }
    } else {
        let chains = [("specular", &chain), ("sheen", &sheen)];
        for (name, kernels) in chains.into_iter().filter(|(_, k)| !k.is_empty()) {
            let file = format!("{name}.{extension}");
            let mut cubes = Vec::new();
            for (k, kernel) in kernels.iter().enumerate() {
                progress(name);
                let start = Instant::now();
                let size = options.size >> k;
                let cube = match kernel {
                    Some(kernel) => maps.cube(kernel, size, target, options.method),
                    None => mirror(environment, size, target),
                };
                let seconds = start.elapsed().as_secs_f64();
                let error = match kernel {
                    Some(kernel) if options.check > 0 => {
                        Some(maps.compare(kernel, &cube, target, options.check))
                    }
                    _ => None,
                };
                report.levels.push(LevelReport {
                    map: file.clone(),
                    level: k,
                    size,
                    roughness: levels[k],
                    seconds,
                    error,
                });
                cubes.push(cube);
            }
            write_cubes(folder, &file, &cubes, options.format, &mut report)?;
        }
    }
    progress("diffuse");
    let diffuse = maps.cube(
        &Kernel::Cosine { exponent: 1.0 },
        options.diffuse_size,
        target,
        options.method,
    );
    let file = format!("diffuse.{extension}");
    write_cubes(folder, &file, &[diffuse], options.format, &mut report)?;
    progress("harmonics");
    write_harmonics(environment, options, folder, &mut report)?;
    progress("table");
    write_table(options, folder, &mut report)?;
    report.files.push("report.json".to_owned());
    json(folder, "report.json", &report)?;
    Ok(report)
}

/// Whether the options can be fulfilled.
///
/// # Errors
/// The first argument out of range.
pub fn check(options: &Options) -> Result<(), IblError> {
    Harmonics::check_bands(options.bands)?;
    if !(1..=4096).contains(&options.table_size) {
        return Err(IblError::parameter(
            "table size",
            options.table_size,
            "a whole number from 1 to 4096",
        ));
    }
    Dfg::at(&options.table_model, &[0.5], &[0.5])?;
    options.family.kernel(0.5)?;
    for (name, size) in [
        ("size", options.size),
        ("diffuse size", options.diffuse_size),
    ] {
        if !size.is_power_of_two() || !(16..=4096).contains(&size) {
            return Err(IblError::parameter(
                name,
                size,
                "a power of two from 16 to 4096",
            ));
        }
    }
    if let Method::Sampling(n) = options.method
        && !(1..=1_000_000).contains(&n)
    {
        return Err(IblError::parameter(
            "samples",
            n,
            "a whole number from 1 to 1000000",
        ));
    }
    if let Method::Tree(t) = options.method
        && !(0.02..=4.0).contains(&t)
    {
        return Err(IblError::parameter(
            "tolerance",
            t,
            "a number from 0.02 to 4",
        ));
    }
    Ok(())
}

fn kernels(family: &Family, levels: &[f64]) -> Result<Vec<Option<Kernel>>, IblError> {
    levels
        .iter()
        .map(|r| {
            if *r > 0.0 {
                family.kernel(*r).map(Some)
            } else {
                Ok(None)
            }
        })
        .collect()
}

fn mismatch(file: &str, place: String, found: impl ToString, expected: impl ToString) -> IblError {
    IblError::Validation {
        file: file.to_owned(),
        place,
        found: found.to_string(),
        expected: expected.to_string(),
    }
}

/// Relative rounding of a format to its texels' largest channel. BC6H is a fit to sixteen texels at once: its error has no bound of this kind,
/// and only its size and sign are compared.
fn rounding(format: TexelFormat) -> f32 {
    match format {
        TexelFormat::Half => 1.0 / 2048.0,
        // Nine bits of the largest channel's mantissa.
        TexelFormat::Rgb9e5 => 1.0 / 256.0,
        TexelFormat::Float => 0.0,
        _ => f32::INFINITY,
    }
}

fn write_cubes(
    folder: &Path,
    file: &str,
    cubes: &[Cube],
    format: TexelFormat,
    report: &mut Report,
) -> Result<(), IblError> {
    let levels = cubes
        .iter()
        .map(|c| [0, 1, 2, 3, 4, 5].map(|f| c.face(f)))
        .collect();
    let map = CubeMap::with_levels(levels)?;
    let clamped = map.above(format);
    report.clamped += clamped;
    let path = folder.join(file);
    map.write(&path, format)?;
    let read = CubeMap::read(&path)?;
    let name = path.display().to_string();
    if read.levels.len() != map.levels.len() {
        return Err(mismatch(
            &name,
            "number of levels".to_owned(),
            read.levels.len(),
            map.levels.len(),
        ));
    }
    for (k, (a, b)) in read.levels.iter().zip(&map.levels).enumerate() {
        for face in 0..6 {
            compare(
                &name,
                &format!("level {k}, face {face}"),
                &a[face],
                &b[face],
                rounding(format),
                clamped > 0,
            )?;
        }
    }
    report.files.push(file.to_owned());
    Ok(())
}

fn compare(
    name: &str,
    place: &str,
    read: &Image,
    meant: &Image,
    rounding: f32,
    clamped: bool,
) -> Result<(), IblError> {
    if (read.width, read.height) != (meant.width, meant.height) {
        let size = |i: &Image| format!("{} × {}", i.width, i.height);
        return Err(mismatch(name, place.to_owned(), size(read), size(meant)));
    }
    for (i, (a, b)) in read.pixels.iter().zip(&meant.pixels).enumerate() {
        let largest = b.iter().fold(0.0f32, |m, v| m.max(v.abs()));
        for k in 0..3 {
            let sound = a[k].is_finite() && a[k] >= b[k].min(0.0);
            // Half floats below 6e-5 have fewer digits.
            let near = (a[k] - b[k]).abs()
                <= (rounding * largest).max(if rounding > 0.0 { 6.2e-5 } else { 0.0 });
            // What was clamped is smaller, as the report says.
            if !sound || !(near || rounding.is_infinite() || (clamped && a[k] < b[k])) {
                let place = format!(
                    "{place}, texel ({}, {}), channel {k}",
                    i % read.width,
                    i / read.width
                );
                return Err(mismatch(name, place, a[k], b[k]));
            }
        }
    }
    Ok(())
}

fn image(folder: &Path, file: &str, picture: &Image, report: &mut Report) -> Result<(), IblError> {
    let path = folder.join(file);
    picture.write(&path)?;
    let read = Image::read(&path)?;
    compare(
        &path.display().to_string(),
        "picture",
        &read,
        picture,
        0.0,
        false,
    )?;
    report.files.push(file.to_owned());
    Ok(())
}

fn json(folder: &Path, file: &str, value: &impl Serialize) -> Result<(), IblError> {
    let path = folder.join(file);
    let name = path.display().to_string();
    let broken = |e: serde_json::Error| mismatch(&name, "the document".to_owned(), e, "JSON");
    let text = serde_json::to_string_pretty(value).map_err(broken)?;
    write_file(&path, text.as_bytes())?;
    let bytes =
        std::fs::read(&path).map_err(|e| mismatch(&name, "the file".to_owned(), e, "readable"))?;
    let read: serde_json::Value = serde_json::from_slice(&bytes).map_err(broken)?;
    let meant = serde_json::to_value(value).map_err(broken)?;
    if read != meant {
        return Err(mismatch(
            &name,
            "the document".to_owned(),
            "different",
            "the same",
        ));
    }
    Ok(())
}

fn write_harmonics(
    environment: &Environment,
    options: &Options,
    folder: &Path,
    report: &mut Report,
) -> Result<(), IblError> {
    let radiance = Harmonics::of_radiance(environment, options.bands)?;
    let (windowed, residual) = options.window.apply(&radiance);
    report.residual = residual;
    let coefficients = options.target.harmonics(&windowed, options.irradiance);
    let file = HarmonicsFile {
        target: options.target,
        meaning: options.target.harmonics_meaning(),
        bands: options.bands,
        order: "(l, m) at l² + l + m; m < 0 for sin |m|φ",
        coefficients: &coefficients,
    };
    json(folder, "harmonics.json", &file)?;
    report.files.push("harmonics.json".to_owned());
    Ok(())
}

/// The table in a target's layout, as a picture; its blue channel is the albedo of the sheen, or 0 without.
///
/// # Errors
/// As [`Dfg::at`].
pub fn table_picture(
    target: Target,
    size: usize,
    model: &str,
    sheen: bool,
) -> Result<Image, IblError> {
    let layout = target.table();
    let roughnesses = layout.nodes(size);
    let cosines: Vec<f64> = if layout.root_cosine {
        roughnesses.iter().map(|c| c * c).collect()
    } else {
        roughnesses.clone()
    };
    let whole = Dfg::at(model, &cosines, &roughnesses)?;
    let sheen = match sheen {
        true => Some(Dfg::at("sheen-charlie", &cosines, &roughnesses)?),
        false => None,
    };
    Ok(Image::from_fn(size, size, |x, y| {
        let row = if layout.rough_first { size - 1 - y } else { y };
        let [bias, all] = whole.get(x, row);
        let blue = sheen.as_ref().map_or(0.0, |s| s.get(x, row)[1]);
        if layout.multiple_scattering {
            [bias, all, blue]
        } else {
            [all - bias, bias, blue]
        }
    }))
}

fn write_table(options: &Options, folder: &Path, report: &mut Report) -> Result<(), IblError> {
    let picture = table_picture(
        options.target,
        options.table_size,
        &options.table_model,
        options.sheen,
    )?;
    let mut layers = Layers::new(picture.width, picture.height);
    for (k, name) in ["R", "G", "B"].into_iter().enumerate() {
        let samples = picture.pixels.iter().map(|p| p[k]).collect();
        layers.push(name, ChannelData::Float(samples))?;
    }
    layers.set_metadata("model", &options.table_model);
    let path = folder.join("dfg.exr");
    layers.write_exr(&path)?;
    let read = Image::read(&path)?;
    compare(
        &path.display().to_string(),
        "table",
        &read,
        &picture,
        0.0,
        false,
    )?;
    report.files.push("dfg.exr".to_owned());
    Ok(())
}
