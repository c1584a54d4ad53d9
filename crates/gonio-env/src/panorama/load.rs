//! Reading a panorama: a picture, a cube map, or six faces.

use super::Panorama;
use crate::EnvError;
use crate::load::LoadOptions;
use crate::projection::{Convention, Layout, View};
use crate::texels::{Defects, Remedy};
use gonio_image::{CubeMap, Image};
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Names of the six faces that are looked for in a folder, in the order of their faces.
const NAMES: [[&str; 6]; 4] = [
    ["px", "nx", "py", "ny", "pz", "nz"],
    ["posx", "negx", "posy", "negy", "posz", "negz"],
    ["+x", "-x", "+y", "-y", "+z", "-z"],
    ["right", "left", "top", "bottom", "front", "back"],
];
const EXTENSIONS: [&str; 7] = ["exr", "hdr", "png", "jpg", "jpeg", "tif", "tiff"];
/// What a pattern has where the name of a face belongs.
const FACE: &str = "{face}";

impl Panorama {
    /// Reads an environment: a picture (EXR, Radiance HDR, PNG, JPEG, TIFF, KTX2, DDS), a cube map (KTX2, DDS), or six faces: a
    /// folder with files such as `px.exr` … `nz.exr`, or a name with `{face}` in it.
    ///
    /// Without [`LoadOptions::layout`] it is found by content and shape: a cube map is one; 2 : 1 is lat-long, unless
    /// it is black outside two discs; 4 : 3 and 3 : 4 are crosses if they are black beside one; 6 : 1 and 1 : 6 are strips.
    /// Without [`LoadOptions::convention`] a KTX2 or DDS cube follows [`Convention::OpenGl`], as those formats say, and any other picture
    /// this program's own.
    ///
    /// # Errors
    /// [`EnvError::NotFound`], [`EnvError::Image`], [`EnvError::AmbiguousLayout`], [`EnvError::Shape`], [`EnvError::Faces`],
    /// [`EnvError::MissingFaces`], and [`EnvError::Texel`] unless texels are replaced.
    pub fn load(path: impl AsRef<Path>, options: &LoadOptions) -> Result<Self, EnvError> {
        let mut panorama = read(path.as_ref(), options)?;
        panorama.check_texels(options.remedy())?;
        Ok(panorama)
    }
}

impl LoadOptions {
    pub(crate) fn remedy(&self) -> Remedy {
        match (self.repair, self.sanitize) {
            (true, _) => Remedy::Neighbours,
            (false, true) => Remedy::Clamp,
            (false, false) => Remedy::Refuse,
        }
    }
}

/// Reads without looking at texels.
pub(crate) fn read(path: &Path, options: &LoadOptions) -> Result<Panorama, EnvError> {
    let text = path.to_string_lossy();
    if text.contains(FACE) {
        return of_pattern(&text, options);
    }
    if !path.exists() {
        return Err(EnvError::NotFound {
            file: path.to_owned(),
            suggestion: None,
        });
    }
    if path.is_dir() {
        return of_folder(path, options);
    }
    let mut start = Vec::new();
    if let Ok(file) = File::open(path) {
        // What can't be read is an error of the reader below, which names it.
        let _ = file.take(CubeMap::HEADER as u64).read_to_end(&mut start);
    }
    if CubeMap::is_in(&start) {
        let cube = CubeMap::read_within(path, &options.limits)?;
        return of_cube(cube, path, options);
    }
    of_picture(Image::read_within(path, &options.limits)?, path, options)
}

/// As [`read`], of the bytes of a file.
pub(crate) fn of_bytes(
    bytes: &[u8],
    file: &Path,
    options: &LoadOptions,
) -> Result<Panorama, EnvError> {
    if CubeMap::is_in(bytes) {
        return of_cube(CubeMap::decode(bytes, &options.limits)?, file, options);
    }
    of_picture(Image::decode(bytes, &options.limits)?, file, options)
}

fn of_cube(cube: CubeMap, path: &Path, options: &LoadOptions) -> Result<Panorama, EnvError> {
    if options.layout.is_some_and(|l| l.arrangement().is_none()) {
        return Err(EnvError::Shape {
            file: Some(path.to_owned()),
            width: cube.size,
            height: cube.size,
            expected: "a picture of the layout that was named, not the six faces of a cube map",
        });
    }
    let convention = options.convention.unwrap_or(Convention::OpenGl);
    let mut panorama = Panorama::from_cube(&cube, convention)?;
    panorama.file = Some(path.to_owned());
    Ok(panorama)
}

fn of_picture(image: Image, path: &Path, options: &LoadOptions) -> Result<Panorama, EnvError> {
    let layout = match options.layout {
        Some(layout) => layout,
        None => detect(&image, path)?,
    };
    let panorama = Panorama {
        image,
        view: View::new(layout, options.convention.unwrap_or_default()),
        file: Some(path.to_owned()),
        defects: Defects::default(),
    };
    panorama.check_shape()?;
    Ok(panorama)
}

/// The layout of a picture whose proportion, and what is black, leave no doubt.
fn detect(image: &Image, path: &Path) -> Result<Layout, EnvError> {
    let (width, height) = (image.width, image.height);
    let black = |layout| Panorama::is_black_outside(image, layout);
    let is = |w: usize, h: usize| width * h == height * w;
    let found = if is(2, 1) {
        let discs = width >= 16 && black(Layout::DualParaboloid);
        Some(if discs {
            Layout::DualParaboloid
        } else {
            Layout::LatLong
        })
    } else if is(6, 1) {
        Some(Layout::CubeStrip)
    } else if is(1, 6) {
        Some(Layout::CubeStripVertical)
    } else if is(4, 3) && black(Layout::CubeCross) {
        Some(Layout::CubeCross)
    } else if is(3, 4) && black(Layout::CubeCrossVertical) {
        Some(Layout::CubeCrossVertical)
    } else {
        None
    };
    found.ok_or_else(|| EnvError::AmbiguousLayout {
        file: Some(path.to_owned()),
        width,
        height,
        disc: width == height && black(Layout::Angular),
    })
}

/// The files of the six faces in a folder: of the first set of names that is there whole.
fn faces_of_folder(folder: &Path) -> Option<[PathBuf; 6]> {
    let whole = |extension: &str, names: &[&str; 6]| {
        let files = names.map(|name| folder.join(format!("{name}.{extension}")));
        files.iter().all(|f| f.is_file()).then_some(files)
    };
    EXTENSIONS
        .iter()
        .find_map(|extension| NAMES.iter().find_map(|names| whole(extension, names)))
}

fn of_folder(folder: &Path, options: &LoadOptions) -> Result<Panorama, EnvError> {
    let Some(files) = faces_of_folder(folder) else {
        let some = EXTENSIONS.iter().find_map(|extension| {
            let with = |name: &str| folder.join(format!("{name}.{extension}"));
            NAMES.iter().find_map(|names| incomplete(names, with))
        });
        return Err(EnvError::MissingFaces {
            place: folder.to_owned(),
            found: match some {
                Some(found) => format!("a folder with {found}"),
                None => "a folder without any".into(),
            },
        });
    };
    of_files(&files, folder, options)
}

/// Which of six files are there and which are not, if there are both.
fn incomplete(names: &[&str; 6], with: impl Fn(&str) -> PathBuf) -> Option<String> {
    let (there, missing): (Vec<PathBuf>, Vec<PathBuf>) = names
        .iter()
        .map(|name| with(name))
        .partition(|f| f.is_file());
    let name = |file: &PathBuf| {
        let name = file.file_name().unwrap_or_default();
        name.to_string_lossy().into_owned()
    };
    let (there, missing) = (there.first()?, missing.first()?);
    Some(format!("{} but no {}", name(there), name(missing)))
}

fn of_pattern(pattern: &str, options: &LoadOptions) -> Result<Panorama, EnvError> {
    let with = |name: &str| PathBuf::from(pattern.replace(FACE, name));
    let whole = NAMES
        .iter()
        .find(|names| names.iter().all(|n| with(n).is_file()));
    let Some(names) = whole else {
        let some = NAMES.iter().find_map(|names| incomplete(names, with));
        return Err(EnvError::MissingFaces {
            place: pattern.into(),
            found: some
                .unwrap_or_else(|| format!("no file such as {}", with(NAMES[0][0]).display())),
        });
    };
    of_files(&names.map(with), Path::new(pattern), options)
}

fn of_files(
    files: &[PathBuf; 6],
    place: &Path,
    options: &LoadOptions,
) -> Result<Panorama, EnvError> {
    let mut faces = Vec::with_capacity(6);
    for file in files {
        let image = Image::read_within(file, &options.limits)?;
        let first: &Image = faces.first().unwrap_or(&image);
        if image.width != image.height || image.width != first.width {
            return Err(EnvError::Faces {
                file: file.clone(),
                width: image.width,
                height: image.height,
                expected: if faces.is_empty() {
                    image.height
                } else {
                    first.width
                },
            });
        }
        faces.push(image);
    }
    let faces = <[Image; 6]>::try_from(faces).expect("invariant: one picture a file");
    let cube = CubeMap::new(faces)?;
    let options = LoadOptions {
        convention: Some(options.convention.unwrap_or_default()),
        ..options.clone()
    };
    of_cube(cube, place, &options)
}
