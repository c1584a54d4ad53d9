//! What `gonio env convert` writes.

use super::Arguments;
use crate::cli::destination;
use crate::cli::failure::Failure;
use crate::cli::terminal::warn;
use gonio_env::{Layout, Panorama};
use gonio_image::{Channel, ChannelData, FileFormat, Image, Layers, TexelFormat, f16};
use std::path::{Path, PathBuf};

/// Names of separate faces.
const FACES: [&str; 6] = ["px", "nx", "py", "ny", "pz", "nz"];
/// What a name has where that of a face belongs.
const FACE: &str = "{face}";

/// The layout of the picture in memory, and how it is stored.
pub(super) struct Form {
    /// The layout.
    pub layout: Layout,
    kind: FileFormat,
    /// Six files instead of one.
    faces: bool,
}

impl Form {
    /// What the arguments ask for.
    pub fn of(arguments: &Arguments) -> Result<Self, Failure> {
        let to = &arguments.to;
        let pattern = to.to_string_lossy().contains(FACE);
        let word = arguments.layout.as_deref();
        let faces =
            word == Some("cube-faces") || word == Some("faces") || word.is_none() && pattern;
        let extension = destination::extension(to);
        if faces && !pattern && extension.is_empty() {
            return Ok(Self {
                layout: Layout::CubeStrip,
                kind: FileFormat::Exr,
                faces,
            });
        }
        let all = ["exr", "hdr", "png", "ktx2", "dds"];
        destination::check_extension(to, &all, "environments")?;
        let kind = FileFormat::of_extension(to)?;
        let texture = matches!(kind, FileFormat::Ktx2 | FileFormat::Dds);
        let layout = match word {
            _ if faces => Layout::CubeStrip,
            None if texture => Layout::CubeStrip,
            None => Layout::LatLong,
            Some(word) => word.parse().map_err(|e: gonio_env::EnvError| {
                let failure = Failure::from(e);
                failure.rephrase(&[("ayouts are ", "ayouts are cube-faces, ")])
            })?,
        };
        if faces && !pattern {
            return Err(Failure::usage(format!(
                "{}: six faces are no single file",
                to.display()
            ))
            .with_help("name a folder, or a file with {face} in its name, such as 'sky_{face}.exr'"));
        }
        Ok(Self {
            layout,
            kind,
            faces,
        })
    }

    /// Whether it is a KTX2 or DDS file.
    pub fn is_texture(&self) -> bool {
        matches!(self.kind, FileFormat::Ktx2 | FileFormat::Dds)
    }

    /// Refuses what can't be written, before any time is spent.
    pub fn check(&self, arguments: &Arguments) -> Result<(), Failure> {
        let to = &arguments.to;
        if arguments.mips
            && (!self.is_texture() || self.layout.arrangement().is_none() || self.faces)
        {
            return Err(
                Failure::usage(format!("--mips: {} has no smaller levels", to.display()))
                    .with_help("write a cube as .ktx2 or .dds"),
            );
        }
        let can = match self.kind {
            FileFormat::Ktx2 | FileFormat::Dds => true,
            FileFormat::Exr => !matches!(
                arguments.texels,
                Some(TexelFormat::Rgb9e5 | TexelFormat::Bc6h)
            ),
            _ => arguments.texels.is_none(),
        };
        if let (false, Some(texels)) = (can, arguments.texels) {
            return Err(Failure::usage(format!(
                "--texels {texels}: {} can't store them",
                to.display()
            ))
            .with_help(
                "half and float go into .ktx2, .dds and .exr, rgb9e5 and bc6h into .ktx2 and .dds",
            ));
        }
        if self.faces && !to.to_string_lossy().contains(FACE) {
            return if to.is_dir() {
                Ok(())
            } else {
                destination::writable(to)
            };
        }
        destination::writable(Path::new(&to.to_string_lossy().replace(FACE, FACES[0])))
    }

    /// Writes the panorama; the files that were written.
    pub fn write(&self, made: &Panorama, arguments: &Arguments) -> Result<Vec<PathBuf>, Failure> {
        let to = &arguments.to;
        let texels = arguments.texels.unwrap_or_default();
        if self.faces {
            let faces = made
                .faces()
                .ok_or_else(|| Failure::input("the picture is no cube"))?;
            let files = FACES.map(|name| self.file_of(to, name));
            if !to.to_string_lossy().contains(FACE) && !to.is_dir() {
                std::fs::create_dir(to)
                    .map_err(|e| Failure::io(&to.display().to_string(), "make the folder", &e))?;
            }
            for (file, face) in files.iter().zip(&faces) {
                self.write_picture(file, face, arguments)?;
            }
            return Ok(files.to_vec());
        }
        if self.is_texture() && self.layout.arrangement().is_some() {
            let cube = made
                .cube_map(arguments.mips)
                .ok_or_else(|| Failure::input("the picture is no cube"))?;
            warn_of(cube.above(texels), texels);
            cube.write(to, texels)?;
        } else {
            self.write_picture(to, made.image(), arguments)?;
        }
        Ok(vec![to.clone()])
    }

    fn file_of(&self, to: &Path, name: &str) -> PathBuf {
        let text = to.to_string_lossy();
        if text.contains(FACE) {
            PathBuf::from(text.replace(FACE, name))
        } else {
            to.join(format!("{name}.exr"))
        }
    }

    fn write_picture(
        &self,
        file: &Path,
        image: &Image,
        arguments: &Arguments,
    ) -> Result<(), Failure> {
        let texels = arguments.texels;
        match self.kind {
            FileFormat::Ktx2 | FileFormat::Dds => {
                let texels = texels.unwrap_or_default();
                warn_of(texels.above(image), texels);
                image.write_texture(file, texels)?;
            }
            FileFormat::Png if arguments.png16 => {
                image.write_png16(file, arguments.tonemap, arguments.exposure)?;
            }
            FileFormat::Png => image.write_png(file, arguments.tonemap, arguments.exposure)?,
            FileFormat::Exr if texels == Some(TexelFormat::Half) => {
                warn_of(TexelFormat::Half.above(image), TexelFormat::Half);
                halves(image).write_exr(file)?;
            }
            _ => image.write(file)?,
        }
        if self.kind != FileFormat::Png {
            // What was written can be read: the bytes on the disk, not those in memory.
            Image::read(file)?;
        }
        Ok(())
    }
}

fn warn_of(above: u64, texels: TexelFormat) {
    if above > 0 {
        warn(&format!(
            "{above} sample(s) above {} were cut to it, the largest that {texels} holds: a sun loses light",
            texels.largest()
        ));
    }
}

/// The picture as half floats.
fn halves(image: &Image) -> Layers {
    let mut layers = Layers::new(image.width, image.height);
    let most = f16::MAX.to_f32();
    for (c, name) in ["R", "G", "B"].into_iter().enumerate() {
        let samples = image.pixels.iter();
        layers.channels.push(Channel {
            name: name.into(),
            samples: ChannelData::Half(
                samples
                    .map(|p| f16::from_f32(p[c].clamp(-most, most)))
                    .collect(),
            ),
        });
    }
    layers
}
