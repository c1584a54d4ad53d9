//! [`Photo`], a photograph with what its file tells about its exposure.

use crate::CaptureError;
use exif::{In, Tag, Value};
use gonio_image::{Image, RawData, RawImage};
use std::io::Cursor;
use std::path::Path;

/// What a camera writes beside the picture.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Exif {
    /// Exposure time \[s].
    pub time_s: Option<f64>,
    /// Focal length divided by the aperture's diameter.
    pub f_number: Option<f64>,
    /// Sensitivity, ISO 12232.
    pub iso: Option<f64>,
    /// Focal length \[mm] that has the same diagonal field of view on film of 36 mm × 24 mm.
    pub focal_35mm: Option<f64>,
}

impl Exif {
    /// Reads it from the bytes of a JPEG, TIFF or PNG; what isn't there, or makes no sense, is `None`.
    pub fn of(bytes: &[u8]) -> Self {
        let Ok(found) = exif::Reader::new().read_from_container(&mut Cursor::new(bytes)) else {
            return Self::default();
        };
        let number = |tag| {
            let value = match &found.get_field(tag, In::PRIMARY)?.value {
                Value::Rational(v) => v.first()?.to_f64(),
                other => f64::from(other.get_uint(0)?),
            };
            (value.is_finite() && value > 0.0).then_some(value)
        };
        Self {
            time_s: number(Tag::ExposureTime),
            f_number: number(Tag::FNumber),
            iso: number(Tag::PhotographicSensitivity),
            focal_35mm: number(Tag::FocalLengthIn35mmFilm),
        }
    }

    /// t S / (100 N²) \[s]: what the picture's values are proportional to, besides the light. `None` without a time; the
    /// F-number and the sensitivity count as 1 and ISO 100 if the file lacks them.
    pub fn exposure(&self) -> Option<f64> {
        let n = self.f_number.unwrap_or(1.0);
        Some(self.time_s? * self.iso.unwrap_or(100.0) / (100.0 * n * n))
    }

    /// Luminance \[cd m⁻²] that saturates the picture, by ISO 12232's sensitivity: H = 78 lx s / S is the exposure of the sensor at
    /// saturation, and H = 0.65 L t / N², so L = 120 N² / (S t). `None` unless time, F-number and sensitivity are known.
    pub fn saturation_luminance(&self) -> Option<f64> {
        let n = self.f_number?;
        Some(78.0 / 0.65 * n * n / (self.iso? * self.time_s?))
    }
}

/// A photograph as its file holds it.
#[derive(Debug, Clone, PartialEq)]
pub struct Photo {
    /// The file's name, for messages.
    pub name: String,
    /// Its samples, turned upright.
    pub picture: RawImage,
    /// What its camera wrote.
    pub exif: Exif,
}

/// Extensions of cameras' raw files.
const RAW: [&str; 14] = [
    "cr2", "cr3", "nef", "arw", "dng", "raf", "orf", "rw2", "pef", "srw", "raw", "crw", "3fr",
    "iiq",
];

impl Photo {
    /// Reads a JPEG, PNG, TIFF, EXR or Radiance HDR file.
    ///
    /// # Errors
    /// [`CaptureError::CameraRaw`] by the name's extension, [`CaptureError::Image`].
    pub fn read(path: &Path) -> Result<Self, CaptureError> {
        let extension = path
            .extension()
            .map(|e| e.to_string_lossy().to_ascii_lowercase())
            .unwrap_or_default();
        if RAW.contains(&extension.as_str()) && path.exists() {
            return Err(CaptureError::CameraRaw { file: path.into() });
        }
        let (picture, bytes) = RawImage::read_upright(path)?;
        Ok(Self {
            name: path.display().to_string(),
            exif: Exif::of(&bytes),
            picture,
        })
    }

    /// A photograph that is in memory.
    pub fn new(name: impl Into<String>, picture: RawImage, exif: Exif) -> Self {
        Self {
            name: name.into(),
            picture,
            exif,
        }
    }

    /// The photograph of linear values, as an EXR holds them.
    pub fn linear(name: impl Into<String>, image: &Image) -> Self {
        let pixels = image
            .pixels
            .iter()
            .map(|&[r, g, b]| [r, g, b, 1.0])
            .collect();
        let picture = RawImage {
            width: image.width,
            height: image.height,
            data: RawData::F32(pixels),
            has_alpha: false,
        };
        Self::new(name, picture, Exif::default())
    }

    /// Whether the samples are codes, which a response curve made; else they are linear values.
    pub fn is_coded(&self) -> bool {
        !matches!(self.picture.data, RawData::F32(_))
    }

    /// Steps of a code in units of 1/255: 1 for 8 bits, 1/257 for 16.
    pub(crate) fn code_step(&self) -> f64 {
        match self.picture.data {
            RawData::U8(_) => 1.0,
            RawData::U16(_) => 1.0 / 257.0,
            RawData::F32(_) => 0.0,
        }
    }

    /// Sample `i`, row after row: codes in units of 1/255, so that both depths range from 0 to 255; linear values as they are.
    pub(crate) fn code(&self, i: usize) -> [f32; 3] {
        let [r, g, b, _] = match &self.picture.data {
            RawData::U8(d) => d[i].map(f32::from),
            RawData::U16(d) => d[i].map(|c| f32::from(c) / 257.0),
            RawData::F32(d) => d[i],
        };
        [r, g, b]
    }

    /// Whether exposures of one view are of one size.
    pub(crate) fn check_sizes(photos: &[Self]) -> Result<(), CaptureError> {
        let first = &photos[0];
        match photos.iter().find(|p| p.size_text() != first.size_text()) {
            None => Ok(()),
            Some(other) => Err(CaptureError::Size {
                file: other.name.clone(),
                found: other.size_text(),
                other: first.name.clone(),
                expected: first.size_text(),
            }),
        }
    }

    pub(crate) fn size_text(&self) -> String {
        format!("{} × {}", self.picture.width, self.picture.height)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The smallest TIFF: a header, one directory with an EXIF directory of three rationals and a short.
    fn tiff() -> Vec<u8> {
        let mut b: Vec<u8> = b"II*\0".to_vec();
        let push = |b: &mut Vec<u8>, tag: u16, kind: u16, value: u32| {
            b.extend(tag.to_le_bytes());
            b.extend(kind.to_le_bytes());
            b.extend(1_u32.to_le_bytes());
            b.extend(value.to_le_bytes());
        };
        b.extend(8_u32.to_le_bytes());
        // At 8: one entry, the EXIF directory at 26.
        b.extend(1_u16.to_le_bytes());
        push(&mut b, 0x8769, 4, 26);
        b.extend(0_u32.to_le_bytes());
        // At 26: three entries; what they point to begins at 26 + 2 + 36 + 4 = 68.
        b.extend(3_u16.to_le_bytes());
        push(&mut b, 0x829a, 5, 68);
        push(&mut b, 0x829d, 5, 76);
        push(&mut b, 0x8827, 3, 400);
        b.extend(0_u32.to_le_bytes());
        for n in [1_u32, 125, 8, 1] {
            b.extend(n.to_le_bytes());
        }
        b
    }

    #[test]
    fn exif_is_read() {
        let exif = Exif::of(&tiff());
        assert_eq!(
            (exif.time_s, exif.f_number, exif.iso),
            (Some(0.008), Some(8.0), Some(400.0))
        );
        // 1/125 s at F 8 and ISO 400: 0.008 · 4 / 64.
        assert!((exif.exposure().unwrap() - 0.0005).abs() < 1e-18);
        // 120 · 64 / (400 / 125) = 2400 cd/m².
        assert!((exif.saturation_luminance().unwrap() - 2400.0).abs() < 1e-9);
    }

    #[test]
    fn broken_exif_is_none() {
        let whole = tiff();
        for n in 0..whole.len() {
            let _ = Exif::of(&whole[..n]);
        }
        assert_eq!(Exif::of(b"no picture"), Exif::default());
        assert_eq!(Exif::default().exposure(), None);
    }

    #[test]
    fn raw_files_are_named_as_such() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.CR2");
        std::fs::write(&path, b"II*\0").unwrap();
        let error = Photo::read(&path).unwrap_err();
        assert!(matches!(error, CaptureError::CameraRaw { .. }), "{error}");
        assert!(error.help().unwrap().contains("--linear"));
    }
}
