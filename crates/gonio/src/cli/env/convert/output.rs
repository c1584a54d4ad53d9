//! What `gonio env convert` writes.

use super::{Arguments, Described};
use crate::cli::destination;
use crate::cli::failure::Failure;
use crate::cli::terminal::warn;
use gonio_env::{Conversion, Kept, Layout, Panorama};
use gonio_image::{FileFormat, Store, TexelFormat, f16, write_rows};
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

    /// Makes the picture and writes it: row by row where the format lets it.
    pub fn make(
        &self,
        panorama: Panorama,
        conversion: &Conversion<'_>,
        arguments: &Arguments,
    ) -> Result<Made, Failure> {
        if self.is_texture() {
            return self.make_texture(panorama, conversion, arguments);
        }
        let mut rows = panorama.into_rows(conversion);
        let [width, height] = rows.size();
        let to = &arguments.to;
        let store = self.store(arguments);
        let mut above = 0;
        let files = if self.faces {
            let files = FACES.map(|name| self.file_of(to, name));
            if !to.to_string_lossy().contains(FACE) && !to.is_dir() {
                std::fs::create_dir(to)
                    .map_err(|e| Failure::io(&to.display().to_string(), "make the folder", &e))?;
            }
            for (face, file) in files.iter().enumerate() {
                write_rows(file, [height, height], store, &mut |first, texels| {
                    rows.make_face(face, first, texels);
                    above += cut(store, texels);
                    Ok(())
                })?;
            }
            files.to_vec()
        } else {
            write_rows(to, [width, height], store, &mut |first, texels| {
                rows.make(first, texels);
                above += cut(store, texels);
                Ok(())
            })?;
            vec![to.clone()]
        };
        Ok(Made {
            written: Described {
                layout: rows.layout(),
                convention: rows.convention(),
                width,
                height,
            },
            kept: rows.kept(),
            files,
            above,
        })
    }

    fn store(&self, arguments: &Arguments) -> Store {
        match (self.kind, arguments.texels) {
            (FileFormat::Png, _) => Store::Png {
                tonemap: arguments.tonemap,
                exposure_ev: arguments.exposure,
                deep: arguments.png16,
            },
            (FileFormat::Hdr, _) => Store::Hdr,
            (_, Some(TexelFormat::Half)) => Store::ExrHalf,
            _ => Store::ExrFloat,
        }
    }

    /// A KTX2 or DDS file, whose picture has to be there whole: a cube stands in it face by face.
    fn make_texture(
        &self,
        panorama: Panorama,
        conversion: &Conversion<'_>,
        arguments: &Arguments,
    ) -> Result<Made, Failure> {
        let texels = arguments.texels.unwrap_or_default();
        let (made, kept) = panorama.converted(conversion);
        let written = Described::of(&made);
        let files = if self.faces {
            FACES.map(|name| self.file_of(&arguments.to, name)).to_vec()
        } else {
            vec![arguments.to.clone()]
        };
        let no_cube = || Failure::input("the picture is no cube");
        let above = if self.faces {
            let faces = made.faces().ok_or_else(no_cube)?;
            drop(made);
            for (file, face) in files.iter().zip(&faces) {
                face.write_texture(file, texels)?;
            }
            faces.iter().map(|face| texels.above(face)).sum()
        } else if self.layout.arrangement().is_some() {
            let cube = made.into_cube_map(arguments.mips).ok_or_else(no_cube)?;
            cube.write(&arguments.to, texels)?;
            cube.above(texels)
        } else {
            made.image().write_texture(&arguments.to, texels)?;
            texels.above(made.image())
        };
        Ok(Made {
            written,
            kept,
            files,
            above,
        })
    }

    /// What there is to say about samples that are above what was written can hold.
    pub fn warn_of(&self, above: u64, arguments: &Arguments) {
        let texels = arguments.texels.unwrap_or_default();
        if above > 0 {
            warn(&format!(
                "{above} sample(s) above {} were cut to it, the largest that {texels} holds: a sun loses light",
                texels.largest()
            ));
        }
    }

    fn file_of(&self, to: &Path, name: &str) -> PathBuf {
        let text = to.to_string_lossy();
        if text.contains(FACE) {
            PathBuf::from(text.replace(FACE, name))
        } else {
            to.join(format!("{name}.exr"))
        }
    }
}

/// What was made.
pub(super) struct Made {
    pub written: Described,
    pub kept: Kept,
    pub files: Vec<PathBuf>,
    /// Samples that were cut to what the format holds.
    pub above: u64,
}

/// Cuts what half floats can't hold, and counts it.
fn cut(store: Store, texels: &mut [[f32; 3]]) -> u64 {
    let most = f16::MAX.to_f32();
    let mut above = 0;
    if store == Store::ExrHalf {
        for c in texels.iter_mut().flatten() {
            above += u64::from(*c > most);
            *c = c.clamp(-most, most);
        }
    }
    above
}
