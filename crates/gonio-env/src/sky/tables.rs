//! The coefficients of Hošek & Wilkie, embedded: LICENSE-hosek-wilkie.txt stands beside them, `benches/peers/sky_tables.py` writes
//! them.

/// Levels of turbidity, 1 to 10.
pub(super) const TURBIDITIES: usize = 10;
/// Wavelengths of the spectral tables: 320, 360, … 720 nm.
pub(super) const WAVELENGTHS: usize = 11;
/// The first of them \[nm].
pub(super) const FIRST_NM: f64 = 320.0;
/// From one to the next \[nm].
pub(super) const STEP_NM: f64 = 40.0;
/// Coefficients of the sky's distribution.
pub(super) const COEFFICIENTS: usize = 9;
/// Control points over the sun's elevation.
pub(super) const CONTROL_POINTS: usize = 6;
/// Pieces of the sun's radiance over elevation.
pub(super) const SEGMENTS: usize = 45;
/// Powers in one piece.
pub(super) const POWERS: usize = 4;
/// Powers of the limb darkening.
pub(super) const LIMB: usize = 6;

const SKY: usize = TURBIDITIES * 2 * CONTROL_POINTS;
const SPECTRAL_MEAN: usize = SKY * WAVELENGTHS * COEFFICIENTS;
const RGB: usize = SPECTRAL_MEAN + SKY * WAVELENGTHS;
const RGB_MEAN: usize = RGB + SKY * 3 * COEFFICIENTS;
const SUN: usize = RGB_MEAN + SKY * 3;
const LIMB_AT: usize = SUN + TURBIDITIES * SEGMENTS * WAVELENGTHS * POWERS;
const COUNT: usize = LIMB_AT + WAVELENGTHS * LIMB;

static BYTES: &[u8; 4 * COUNT] = include_bytes!("hosek_wilkie.bin");

fn number(at: usize) -> f64 {
    let b = &BYTES[4 * at..4 * at + 4];
    f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
}

/// Which of the sky's two sets of tables.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Channels {
    Spectral,
    Rgb,
}

impl Channels {
    pub fn count(self) -> usize {
        match self {
            Self::Spectral => WAVELENGTHS,
            Self::Rgb => 3,
        }
    }

    /// Coefficient `k` of a channel at a control point; the mean radiance for `k` = [`COEFFICIENTS`].
    pub fn sky(
        self,
        turbidity: usize,
        albedo: usize,
        point: usize,
        channel: usize,
        k: usize,
    ) -> f64 {
        let (first, mean) = match self {
            Self::Spectral => (0, SPECTRAL_MEAN),
            Self::Rgb => (RGB, RGB_MEAN),
        };
        let cell = ((turbidity * 2 + albedo) * CONTROL_POINTS + point) * self.count() + channel;
        if k == COEFFICIENTS {
            number(mean + cell)
        } else {
            number(first + cell * COEFFICIENTS + k)
        }
    }
}

/// Coefficient of power `k` of the sun's radiance at a wavelength.
pub(super) fn sun(turbidity: usize, segment: usize, wavelength: usize, k: usize) -> f64 {
    number(SUN + ((turbidity * SEGMENTS + segment) * WAVELENGTHS + wavelength) * POWERS + k)
}

/// Coefficient of power `k` of the limb darkening at a wavelength.
pub(super) fn limb(wavelength: usize, k: usize) -> f64 {
    number(LIMB_AT + wavelength * LIMB + k)
}
