//! Reading environments from files and from the words of a command line.

use crate::error::suggest;
use crate::info::Origin;
use crate::lookup::Map;
use crate::panorama::{self, Panorama};
use crate::texels::Remedy;
use crate::{Convention, Conversion, EnvError, Environment, Layout, Sky};
use gonio_image::Limits;
use std::path::Path;

/// How a picture is read.
#[derive(Debug, Clone, Default)]
pub struct LoadOptions {
    /// How the picture is laid out; found out from its shape if nothing.
    pub layout: Option<Layout>,
    /// Replace and count texels that are NaN, infinite or negative instead of refusing them: NaN, −∞ and negative values
    /// become 0, +∞ the largest finite value of the picture.
    pub sanitize: bool,
    /// Replace and count such texels by the mean of their sound neighbours; goes before `sanitize`.
    pub repair: bool,
    /// Whose turn of the layout the picture has; [`Panorama::load`] says what it is otherwise.
    pub convention: Option<Convention>,
    /// How large the picture may be.
    pub limits: Limits,
}

impl Environment {
    /// Reads an environment in any layout, as [`Panorama::load`] does: a picture (codes of PNG, JPEG and TIFF are decoded from sRGB), a
    /// cube map, or six faces.
    ///
    /// Without `layout` it is found by content and shape; a square picture is an error that asks for the layout, since an
    /// angular map and a mirrored ball look alike.
    ///
    /// # Errors
    /// As [`Panorama::load`].
    pub fn load(path: impl AsRef<Path>, layout: Option<Layout>) -> Result<Self, EnvError> {
        Self::load_with(
            path,
            &LoadOptions {
                layout,
                ..LoadOptions::default()
            },
        )
    }

    /// As [`Environment::load`], with every option.
    ///
    /// # Errors
    /// As [`Environment::load`]; no [`EnvError::Texel`] if `sanitize`.
    pub fn load_with(path: impl AsRef<Path>, options: &LoadOptions) -> Result<Self, EnvError> {
        Self::of_panorama(panorama::read(path.as_ref(), options)?, options.remedy())
    }

    /// As [`Environment::load_with`], from the bytes of a picture; `file` names it in errors.
    ///
    /// # Errors
    /// As [`Environment::load_with`], without [`EnvError::NotFound`].
    pub fn decode(bytes: &[u8], file: &Path, options: &LoadOptions) -> Result<Self, EnvError> {
        Self::of_panorama(panorama::of_bytes(bytes, file, options)?, options.remedy())
    }

    /// The light that a panorama shows.
    ///
    /// A lat-long panorama, an angular map and a mirrored ball are looked up as they are. Any other layout, or convention, is
    /// resampled once to a lat-long panorama whose rows are two for each row of a cube's face, or one for each of another
    /// picture: finer than the picture everywhere, so that what is lost is one interpolation. Irradiance stays to 1e-3.
    ///
    /// # Errors
    /// [`EnvError::Shape`], [`EnvError::Texel`].
    pub fn from_panorama(panorama: Panorama) -> Result<Self, EnvError> {
        Self::of_panorama(panorama, Remedy::Refuse)
    }

    pub(crate) fn of_panorama(mut panorama: Panorama, remedy: Remedy) -> Result<Self, EnvError> {
        panorama.check_texels(remedy)?;
        let defects = panorama.defects;
        let file = panorama.file().map(Path::to_owned);
        let native = matches!(
            panorama.layout(),
            Layout::LatLong | Layout::Angular | Layout::MirrorBall
        ) && panorama.view().is_own();
        let (origin, panorama) = if native {
            (None, panorama)
        } else {
            let origin = Origin::of(&panorama);
            let rows = panorama.image().height / panorama.layout().shape()[1];
            let size = match panorama.layout() {
                layout if layout.arrangement().is_some() => 2 * rows,
                Layout::DualParaboloid => 2 * rows,
                _ => rows,
            };
            let same = panorama.layout() == Layout::LatLong && panorama.image().width == 2 * rows;
            let to = Conversion {
                size: Some(if same { rows } else { size }),
                ..Conversion::to(Layout::LatLong)
            };
            (Some(origin), panorama.resampled(&to))
        };
        let layout = panorama.layout();
        let mut map = Map::new(panorama.into_image(), layout, file.as_deref(), false)?;
        map.defects = defects;
        map.origin = origin;
        Ok(Self::from_map(map))
    }

    /// Reads what stands after `--env`: `uniform:1`, `uniform:r/g/b` (radiance in W m⁻² sr⁻¹), `sky:` and the words of
    /// [`SkyOptions`](crate::SkyOptions), or a file's name.
    ///
    /// ```
    /// use gonio_env::{Environment, LoadOptions};
    /// let env = Environment::parse("uniform:1/0.5/0", &LoadOptions::default())?;
    /// assert_eq!(env.mean_radiance(), [1.0, 0.5, 0.0]);
    /// # Ok::<(), gonio_env::EnvError>(())
    /// ```
    ///
    /// # Errors
    /// [`EnvError::Parameter`] for a uniform radiance or a sky that is none, [`EnvError::UnknownWord`], and as [`Environment::load`].
    pub fn parse(text: &str, options: &LoadOptions) -> Result<Self, EnvError> {
        if let Some(value) = text.strip_prefix("uniform:") {
            return Self::try_uniform(parse_radiance(value)?);
        }
        if let Some(words) = text.strip_prefix("sky:") {
            return Ok(Self::from_sky(Sky::new(words.parse()?)?));
        }
        match Self::load_with(text, options) {
            Err(EnvError::NotFound { file, .. }) => {
                let word = text.split(':').next().unwrap_or(text);
                let suggestion = suggest(word, &["uniform", "sky"]).map(|near| match near {
                    "sky" => "sky:elevation=40",
                    _ => "uniform:1",
                });
                Err(EnvError::NotFound { file, suggestion })
            }
            other => other,
        }
    }
}

fn parse_radiance(text: &str) -> Result<[f32; 3], EnvError> {
    let error = || EnvError::Parameter {
        name: "uniform radiance",
        found: text.to_owned(),
        expected: "one number or three, r/g/b, such as 1 or 1/0.9/0.8",
    };
    let numbers: Vec<f32> = text
        .split('/')
        .map(|n| n.trim().parse::<f32>())
        .collect::<Result<_, _>>()
        .map_err(|_| error())?;
    match numbers[..] {
        [grey] => Ok([grey; 3]),
        [r, g, b] => Ok([r, g, b]),
        _ => Err(error()),
    }
}
