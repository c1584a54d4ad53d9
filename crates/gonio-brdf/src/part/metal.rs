//! Measured metals by name: complex indices of refraction η + ik.
//!
//! The figures are linear RGB (Rec.709 primaries) projections of measured spectra: for each of η and k and each primary c
//!
//! x_c = ∫ x(λ) m_c(λ) S(λ) dλ / ∫ m_c(λ) S(λ) dλ, 360–830 nm in steps of 1 nm,
//!
//! where m_c is the sRGB matrix (IEC 61966-2-1, XYZ to RGB) applied to the CIE 1931 2° colour matching functions, S is
//! illuminant D65, and x(λ) is interpolated linearly. So a spectrally flat value keeps itself. This is the field's
//! usual approximation: the reflected colour of the projected indices differs from the projection of the reflected
//! spectrum by a few per cent.
//!
//! Spectra: the `.spd` tables distributed with Mitsuba 3.9.1 (BSD-3-Clause), collected from luxpop.com and, where
//! `source` ends in `_palik`, from Palik, Handbook of Optical Constants of Solids. `tests/metals.rs` derives this table
//! again from such a folder.

/// A metal's complex index of refraction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Metal {
    /// Name.
    pub name: &'static str,
    /// Stem of the spectra's file names.
    pub source: &'static str,
    /// Real part η, linear RGB.
    pub eta: [f64; 3],
    /// Imaginary part k ≥ 0, linear RGB.
    pub k: [f64; 3],
}

/// Every metal, and its name in US spelling where it differs.
pub const METALS: &[Metal] = &[
    metal(
        "aluminium",
        "Al",
        [1.40742, 0.92665, 0.58404],
        [7.74040, 6.60261, 5.36029],
    ),
    metal(
        "aluminum",
        "Al",
        [1.40742, 0.92665, 0.58404],
        [7.74040, 6.60261, 5.36029],
    ),
    metal(
        "beryllium",
        "Be",
        [3.48547, 3.35646, 3.07241],
        [3.18309, 3.17465, 3.15613],
    ),
    metal(
        "chrome",
        "Cr",
        [3.68155, 3.06625, 1.85598],
        [4.30993, 4.46111, 4.15025],
    ),
    metal(
        "chromium",
        "Cr",
        [3.68155, 3.06625, 1.85598],
        [4.30993, 4.46111, 4.15025],
    ),
    metal(
        "copper",
        "Cu",
        [0.10449, 0.97817, 1.20467],
        [3.27333, 2.59235, 2.36925],
    ),
    metal(
        "gold",
        "Au",
        [0.08005, 0.40465, 1.56135],
        [3.39046, 2.50377, 1.77089],
    ),
    metal(
        "iridium",
        "Ir",
        [2.59382, 2.19209, 1.79057],
        [4.67403, 4.28393, 3.61474],
    ),
    metal(
        "lithium",
        "Li",
        [0.22096, 0.20665, 0.24121],
        [2.97863, 2.43316, 1.85391],
    ),
    metal(
        "mercury",
        "Hg",
        [2.02772, 1.51531, 1.01621],
        [5.30398, 4.60470, 3.79097],
    ),
    metal(
        "molybdenum",
        "Mo",
        [3.73308, 3.71315, 3.06499],
        [3.38410, 3.61231, 3.47488],
    ),
    metal(
        "nickel",
        "Ni_palik",
        [1.97935, 1.75363, 1.61718],
        [3.77548, 3.21235, 2.59936],
    ),
    metal(
        "rhodium",
        "Rh",
        [2.15958, 1.96008, 1.72249],
        [5.68055, 4.95567, 4.38999],
    ),
    metal(
        "silver",
        "Ag",
        [0.12847, 0.12353, 0.15089],
        [4.06488, 3.28632, 2.39175],
    ),
    metal(
        "sodium",
        "Na_palik",
        [0.04924, 0.05929, 0.06796],
        [2.67087, 2.22457, 1.75292],
    ),
    metal(
        "titanium-carbide",
        "TiC",
        [3.07641, 2.99179, 2.84575],
        [2.72835, 2.47894, 2.39081],
    ),
    metal(
        "titanium-nitride",
        "TiN",
        [1.37753, 1.21487, 1.50334],
        [2.85700, 2.04326, 1.23723],
    ),
    metal(
        "tungsten",
        "W",
        [3.63723, 3.48044, 3.29960],
        [2.91696, 2.74586, 2.50897],
    ),
    metal(
        "vanadium",
        "V_palik",
        [3.54860, 3.69945, 3.06205],
        [2.87645, 3.05156, 3.41550],
    ),
    metal(
        "vanadium-nitride",
        "VN",
        [2.38908, 2.23421, 2.13622],
        [2.54568, 2.16529, 1.78943],
    ),
];

/// The names of [`METALS`].
pub const NAMES: &[&str] = &names();

/// The metal called `name`.
pub fn find(name: &str) -> Option<&'static Metal> {
    METALS.iter().find(|m| m.name == name)
}

const fn metal(name: &'static str, source: &'static str, eta: [f64; 3], k: [f64; 3]) -> Metal {
    Metal {
        name,
        source,
        eta,
        k,
    }
}

const fn names() -> [&'static str; METALS.len()] {
    let mut out = [""; METALS.len()];
    let mut i = 0;
    while i < out.len() {
        out[i] = METALS[i].name;
        i += 1;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_found_and_unique() {
        for (i, name) in NAMES.iter().enumerate() {
            assert_eq!(find(name).unwrap().name, *name);
            assert!(!NAMES[..i].contains(name));
        }
        assert_eq!(
            find("aluminum").unwrap().eta,
            find("aluminium").unwrap().eta
        );
        assert!(find("unobtainium").is_none());
    }

    #[test]
    fn gold_is_yellow_and_silver_is_bright() {
        // Reflectance at normal incidence ((η−1)² + k²) / ((η+1)² + k²).
        let r = |m: &Metal, c: usize| {
            let (n, k2) = (m.eta[c], m.k[c] * m.k[c]);
            ((n - 1.0).powi(2) + k2) / ((n + 1.0).powi(2) + k2)
        };
        let gold = find("gold").unwrap();
        assert!(r(gold, 0) > r(gold, 1) && r(gold, 1) > r(gold, 2));
        let silver = find("silver").unwrap();
        assert!((0..3).all(|c| r(silver, c) > 0.9));
    }
}
