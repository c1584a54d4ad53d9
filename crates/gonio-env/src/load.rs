//! Reading environments from files and from the words of a command line.

use crate::error::suggest;
use crate::lookup::Map;
use crate::projection::disc_from_uv;
use crate::{EnvError, Environment, Layout, luminance};
use gonio_image::{Image, Limits};
use std::path::Path;

/// How a picture is read.
#[derive(Debug, Clone, Default)]
pub struct LoadOptions {
    /// How the picture is laid out; found out from its shape if nothing.
    pub layout: Option<Layout>,
    /// Replace and count texels that are NaN, infinite or negative instead of refusing them: NaN, −∞ and negative values
    /// become 0, +∞ the largest finite value of the picture.
    pub sanitize: bool,
    /// How large the picture may be.
    pub limits: Limits,
}

impl Environment {
    /// Reads a picture (EXR, Radiance HDR, PNG, JPEG; PNG and JPEG are decoded from sRGB).
    ///
    /// Without `layout` a picture twice as wide as high is lat-long; any other is an error that asks for the layout,
    /// since an angular map and a mirrored ball look alike.
    ///
    /// # Errors
    /// [`EnvError::NotFound`], [`EnvError::Image`], [`EnvError::AmbiguousLayout`], [`EnvError::Shape`],
    /// [`EnvError::Texel`].
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
        let path = path.as_ref();
        if !path.exists() {
            return Err(EnvError::NotFound {
                file: path.to_owned(),
                suggestion: None,
            });
        }
        Self::of_image(Image::read_within(path, &options.limits)?, path, options)
    }

    /// As [`Environment::load_with`], from the bytes of a picture; `file` names it in errors.
    ///
    /// # Errors
    /// As [`Environment::load_with`], without [`EnvError::NotFound`].
    pub fn decode(bytes: &[u8], file: &Path, options: &LoadOptions) -> Result<Self, EnvError> {
        Self::of_image(Image::decode(bytes, &options.limits)?, file, options)
    }

    fn of_image(image: Image, path: &Path, options: &LoadOptions) -> Result<Self, EnvError> {
        let layout = match options.layout {
            Some(layout) => layout,
            None => detect(&image, path)?,
        };
        Ok(Self::from_map(Map::new(
            image,
            layout,
            Some(path),
            options.sanitize,
        )?))
    }

    /// Reads what stands after `--env`: `uniform:1`, `uniform:r/g/b` (radiance in W m⁻² sr⁻¹), or a file's name.
    ///
    /// ```
    /// use gonio_env::{Environment, LoadOptions};
    /// let env = Environment::parse("uniform:1/0.5/0", &LoadOptions::default())?;
    /// assert_eq!(env.mean_radiance(), [1.0, 0.5, 0.0]);
    /// # Ok::<(), gonio_env::EnvError>(())
    /// ```
    ///
    /// # Errors
    /// [`EnvError::Parameter`] for a uniform radiance that is no number, and as [`Environment::load`].
    pub fn parse(text: &str, options: &LoadOptions) -> Result<Self, EnvError> {
        if let Some(value) = text.strip_prefix("uniform:") {
            return Self::try_uniform(parse_radiance(value)?);
        }
        match Self::load_with(text, options) {
            Err(EnvError::NotFound { file, .. }) => {
                let word = text.split(':').next().unwrap_or(text);
                let suggestion = suggest(word, &["uniform"]).map(|_| "uniform:1");
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

fn detect(image: &Image, path: &Path) -> Result<Layout, EnvError> {
    let (width, height) = (image.width, image.height);
    if width == 2 * height {
        return Ok(Layout::LatLong);
    }
    Err(EnvError::AmbiguousLayout {
        file: Some(path.to_owned()),
        width,
        height,
        disc: width == height && is_black_outside_the_disc(image),
    })
}

/// Whether what stands clear of the inscribed disc is darker than a thousandth of the mean.
fn is_black_outside_the_disc(image: &Image) -> bool {
    let n = image.width;
    let mean = image.pixels.iter().map(|p| luminance(*p)).sum::<f64>() / image.pixels.len() as f64;
    // A rim drawn with antialiasing may reach two texels out.
    let clear = 1.0 + 4.0 / n as f64;
    let mut any = false;
    for (k, pixel) in image.pixels.iter().enumerate() {
        let at = |i: usize| (i as f64 + 0.5) / n as f64;
        let [x, y] = disc_from_uv([at(k % n), at(k / n)]);
        if x * x + y * y > clear * clear {
            any = true;
            if luminance(*pixel) > 1e-3 * mean {
                return false;
            }
        }
    }
    any
}
