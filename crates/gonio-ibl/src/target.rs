//! [`Target`]: what a renderer expects of prefiltered light.
//!
//! | target | roughness of level k of n | faces and axes | spherical harmonics | table |
//! |---|---|---|---|---|
//! | `gltf` | k/(n−1) | OpenGL's, world as it is | irradiance, orthonormal | (scale, bias), row 0 at roughness 0 |
//! | `filament` | 1 − √(1 − k/(n−1)) | OpenGL's | irradiance/π, times the basis's constants | (bias, whole, sheen), row 0 at roughness 1 |
//! | `three` | 0, and of its `roughnessToMip` | atlas `CubeUV` | radiance, orthonormal | (scale, bias) |
//! | `unreal` | 2^((1 − (n − 2 − k))/1.2) | x forward, y right, z up | radiance, with the Condon–Shortley sign | (scale, bias) |
//! | `unity` | 1.7/1.4 − √(2.89/1.96 − 2.8/1.96 · k/6) | x right, y up, z forward | irradiance/π, times the constants | (bias, whole) over √μ |
//! | `custom` | k/(n−1) | OpenGL's | as [`crate::harmonics`] | (scale, bias) |
//!
//! Sources, and what they say; `PMREMGenerator.js`, glTF-IBL-Sampler, `ibl.glsl` and Unreal Engine's files by what is published of them, the others read:
//!
//! - glTF: Khronos' glTF-IBL-Sampler (`lib/source/lib.cpp`) and glTF-Sample-Viewer (`source/Renderer/shaders/ibl.glsl`: R F₀ + G at (n·v, roughness)).
//!   `extensions/2.0/Vendor/EXT_lights_image_based/README.md` says "irradiance", refers to Ramamoorthi & Hanrahan 2001, and leaves the basis's sign open.
//!   The sample that its authors made, `2.0/EnvironmentTest/glTF-IBL/EnvironmentTest.gltf` of glTF-Sample-Models, has a positive coefficient of y under light
//!   from above: no sign. Babylon.js (`packages/dev/core/src/Maths/sphericalPolynomial.ts`, `SH3ylmBasisConstants`) reads them with the
//!   Condon–Shortley sign: for it negate coefficients 1, 3, 5 and 7.
//! - Filament: `libs/ibl/src/CubemapSH.cpp` (`computeIrradianceSH3Bands`: A_l/π and the squared constants), `shaders/src/surface_light_indirect.fs`
//!   (`Irradiance_SphericalHarmonics`, mix(dfg.x, dfg.y, f0) at (n·v, roughness), lod = n p (2 − p)), `tools/cmgen/src/cmgen.cpp` and
//!   `libs/ibl/src/CubemapIBL.cpp` (rows from rough to smooth; cmgen's rows lie one texel beside where the shader looks them up, ours don't).
//! - three.js: `src/math/SphericalHarmonics3.js` (order and constants of `getIrradianceAt`), `src/renderers/shaders/ShaderChunk/cube_uv_reflection_fragment.glsl.js`
//!   (`getUV`, `roughnessToMip`), `src/extras/PMREMGenerator.js`.
//! - Unreal Engine: `ReflectionEnvironmentShared.ush` (`ComputeReflectionCaptureRoughnessFromMip` with the largest mip n − 1), `SHCommon.ush`
//!   (`SHBasisFunction3`, `CalcDiffuseTransferSH3`), `BRDF.ush` (`EnvBRDF`).
//! - Unity: `com.unity.render-pipelines.core/ShaderLibrary/ImageBasedLighting.hlsl` (`MipmapLevelToPerceptualRoughness`) and `EntityLighting.hlsl` (`SHEvalLinearL0L1`,
//!   `SHEvalLinearL2`), `Common.hlsl` (`Remap01ToHalfTexelCoord`), and `com.unity.render-pipelines.high-definition/Runtime/Material/PreIntegratedFGD/PreIntegratedFGD.hlsl`
//!   (lerp(x, y, F₀) at (√(n·v), roughness), both from the middle of the first texel to that of the last).

use crate::{Harmonics, IblError};
use gonio_num::Vec3;
use serde::Serialize;
use std::f64::consts::{FRAC_1_PI, PI};
use std::str::FromStr;

/// A renderer, or a family of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Target {
    /// glTF viewers after Khronos' sample renderer.
    Gltf,
    /// three.js.
    Three,
    /// Filament.
    Filament,
    /// Unreal Engine.
    Unreal,
    /// Unity.
    Unity,
    /// Gonio's own conventions.
    Custom,
}

/// How a table's columns and rows are laid out, and what its channels hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct TableLayout {
    /// R = bias, G = whole, so that E = lerp(R, G, F₀); else R = whole − bias, G = bias, so that E = F₀ R + G.
    pub multiple_scattering: bool,
    /// Column x is at √μ instead of μ.
    pub root_cosine: bool,
    /// Row 0 is the roughest.
    pub rough_first: bool,
    /// The middles of the outermost texels are at 0 and 1 instead of half a texel inside.
    pub end_to_end: bool,
}

/// What stands for 0 at the end of a table: there the reflectance is that of its limit to single precision, for a mirror as well as along the surface.
const NEARLY_NONE: f64 = 1e-3;

impl TableLayout {
    /// The numbers along an axis of `n` texels: roughness, and μ or √μ, in (0, 1].
    pub fn nodes(self, n: usize) -> Vec<f64> {
        (0..n)
            .map(|k| match self.end_to_end {
                true if n > 1 => (k as f64 / (n - 1) as f64).max(NEARLY_NONE),
                _ => (k as f64 + 0.5) / n as f64,
            })
            .collect()
    }
}

impl Target {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Gltf,
        Self::Three,
        Self::Filament,
        Self::Unreal,
        Self::Unity,
        Self::Custom,
    ];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Gltf => "gltf",
            Self::Three => "three",
            Self::Filament => "filament",
            Self::Unreal => "unreal",
            Self::Unity => "unity",
            Self::Custom => "custom",
        }
    }

    /// How many levels it uses of a cube of edge `size`, a power of two.
    pub fn levels(self, size: usize) -> usize {
        let whole = size.ilog2() as usize + 1;
        match self {
            // UNITY_SPECCUBE_LOD_STEPS = 6.
            Self::Unity => whole.min(7),
            // Tiles of `size` down to 16, and six more of 16.
            Self::Three => whole.saturating_sub(4) + 6,
            _ => whole,
        }
    }

    /// Perceptual roughness of level `k` of `n`; 0: the picture itself.
    pub fn roughness(self, k: usize, n: usize) -> f64 {
        let last = n.saturating_sub(1).max(1) as f64;
        let lod = k as f64 / last;
        match self {
            Self::Gltf | Self::Custom => lod,
            Self::Filament => 1.0 - (1.0 - lod).max(0.0).sqrt(),
            // Its formula gives a rounding of 0 there.
            Self::Unity if k == 0 => 0.0,
            Self::Unity => {
                let step = (k as f64 / 6.0).min(1.0);
                (1.7 / 1.4 - (2.89 / 1.96 - 2.8 / 1.96 * step).max(0.0).sqrt()).clamp(0.0, 1.0)
            }
            Self::Unreal => {
                let from_1x1 = n as f64 - 2.0 - k as f64;
                let roughness = ((1.0 - from_1x1) / 1.2).exp2_exact();
                // Below 0.01 it copies the picture; the last mips would be above 1.
                if roughness < 0.01 {
                    0.0
                } else {
                    roughness.min(1.0)
                }
            }
            Self::Three => match k {
                0 => 0.0,
                // The last six have 16² texels: mips 3, 2, 1, 0, −1, −2.
                k if k + 6 >= n => THREE_ROUGH[k + 6 - n],
                // Mips above 4: mip = −2 log₂(1.16 r).
                k => (-0.5 * (4 + n - 7 - k) as f64).exp2_exact() / 1.16,
            },
        }
    }

    /// The world direction that the target calls (x, y, z).
    pub fn to_world(self, d: Vec3<f64>) -> Vec3<f64> {
        match self {
            // Forward +x is the world's −z, right +y its +x, up +z its +y.
            Self::Unreal => Vec3::new(d.y, d.z, -d.x),
            // Left-handed: forward +z is the world's −z.
            Self::Unity => Vec3::new(d.x, d.y, -d.z),
            _ => d,
        }
    }

    /// The layout of its table.
    pub fn table(self) -> TableLayout {
        TableLayout {
            multiple_scattering: matches!(self, Self::Filament | Self::Unity),
            root_cosine: self == Self::Unity,
            rough_first: self == Self::Filament,
            end_to_end: self == Self::Unity,
        }
    }

    /// What its coefficients mean, as one sentence.
    pub fn harmonics_meaning(self) -> &'static str {
        match self {
            Self::Gltf => {
                "irradiance [W m⁻²], orthonormal basis without the Condon–Shortley sign: irradianceCoefficients of EXT_lights_image_based as its sample file has them; Babylon.js reads coefficients 1, 3, 5 and 7 with the opposite sign"
            }
            Self::Three => {
                "radiance, orthonormal basis without the Condon–Shortley sign: SphericalHarmonics3.coefficients; its shader makes irradiance of it"
            }
            Self::Filament => {
                "irradiance/π times the basis's constants: multiply by 1, y, z, x, xy, yz, 3z² − 1, zx, x² − y²"
            }
            Self::Unreal => {
                "radiance, orthonormal basis with the Condon–Shortley sign, of x forward, y right, z up: FSHVectorRGB"
            }
            Self::Unity => {
                "irradiance/π times the basis's constants, of x right, y up, z forward: SphericalHarmonicsL2[rgb, i], multiply by 1, y, z, x, xy, yz, 3z² − 1, zx, x² − y²"
            }
            Self::Custom => "orthonormal basis without the Condon–Shortley sign, z the polar axis",
        }
    }

    /// Whether its coefficients are of irradiance (else of radiance).
    pub fn harmonics_are_irradiance(self) -> bool {
        matches!(self, Self::Gltf | Self::Filament | Self::Unity)
    }

    /// The coefficients as the target wants them, of `radiance` in Gonio's convention; `irradiance` chooses for `custom`.
    pub fn harmonics(self, radiance: &Harmonics, irradiance: bool) -> Vec<[f64; 3]> {
        let bands = radiance.bands();
        let wanted = if self.harmonics_are_irradiance() || (self == Self::Custom && irradiance) {
            radiance.irradiance()
        } else {
            radiance.clone()
        };
        let turned = Harmonics::of_function(bands, |d| wanted.evaluate(self.to_world(d)));
        let constants = constants(bands);
        turned
            .coefficients()
            .iter()
            .enumerate()
            .map(|(i, c)| {
                let factor = match self {
                    Self::Filament | Self::Unity => constants[i] * FRAC_1_PI,
                    Self::Unreal => {
                        let l = crate::harmonics::band_of(i);
                        let m = i.abs_diff(l * l + l);
                        if m % 2 == 1 { -1.0 } else { 1.0 }
                    }
                    _ => 1.0,
                };
                c.map(|v| v * factor)
            })
            .collect()
    }
}

/// Perceptual roughness of three.js's mips 3, 2, 1, 0, −1, −2: the points 0.305 at 3, 0.4 at 2, 0.8 at −1 and 1 at −2 of its
/// `roughnessToMip`, which is linear between them.
const THREE_ROUGH: [f64; 6] = [0.305, 0.4, 1.6 / 3.0, 2.0 / 3.0, 0.8, 1.0];

/// The constants of the basis's polynomials (1, y, z, x, xy, yz, 3z² − 1, zx, x² − y²) in bands 0 to 2; from band 3 on there is no
/// such convention, and they are 1.
fn constants(bands: usize) -> Vec<f64> {
    let mut constants = vec![1.0; bands * bands];
    let c1 = (0.75 * FRAC_1_PI).sqrt();
    let c2 = (3.75 * FRAC_1_PI).sqrt();
    let c20 = (0.3125 * FRAC_1_PI).sqrt();
    let known = [0.5 / PI.sqrt(), c1, c1, c1, c2, c2, c20, c2, 0.5 * c2];
    for (c, k) in constants.iter_mut().zip(known) {
        *c = k;
    }
    constants
}

/// 2^x by our own functions.
trait Exp2 {
    fn exp2_exact(self) -> f64;
}

impl Exp2 for f64 {
    fn exp2_exact(self) -> f64 {
        gonio_num::Real::exp(self * std::f64::consts::LN_2)
    }
}

impl FromStr for Target {
    type Err = IblError;

    fn from_str(text: &str) -> Result<Self, IblError> {
        Self::ALL
            .into_iter()
            .find(|t| t.name() == text)
            .ok_or_else(|| {
                IblError::parameter(
                    "target",
                    format!("\"{text}\""),
                    "gltf, three, filament, unreal, unity or custom",
                )
            })
    }
}

/// Where a texel of three.js's atlas looks: `tile` counts the levels, (x, y) texels from its lower left corner.
///
/// A tile has two rows of three faces: below +x, +y, +z, above −x, −y, −z. The outermost texels of a face lie beyond its edge, so that
/// interpolation never meets a neighbour.
pub(crate) fn three_direction(face: usize, size: usize, x: usize, y: usize) -> Vec3<f64> {
    let at = |i: usize| 2.0 * (i as f64 - 0.5) / (size as f64 - 2.0) - 1.0;
    let (p, q) = (at(x), at(y));
    let d = match face {
        0 => Vec3::new(1.0, q, p),
        1 => Vec3::new(-p, 1.0, -q),
        2 => Vec3::new(-p, q, 1.0),
        3 => Vec3::new(-1.0, q, -p),
        4 => Vec3::new(-p, -1.0, q),
        _ => Vec3::new(p, q, -1.0),
    };
    d.normalize()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::harmonics::basis;
    use crate::harmonics::directions;

    #[test]
    fn roughness_goes_from_the_picture_to_1() {
        for target in Target::ALL {
            let n = target.levels(256);
            let all: Vec<f64> = (0..n).map(|k| target.roughness(k, n)).collect();
            assert!(all.windows(2).all(|w| w[0] <= w[1]), "{target:?} {all:?}");
            assert!((all[n - 1] - 1.0).abs() < 1e-12, "{target:?} {all:?}");
            if target != Target::Unreal {
                assert_eq!(all[0], 0.0);
            }
        }
        // The runtime's own mapping leads back: Filament's lod = p (2 − p), Unity's 6 p (1.7 − 0.7 p), Unreal's
        // mip = n − 2 − (1 − 1.2 log₂ r), three.js's −2 log₂(1.16 r).
        for k in 1..9 {
            let p = Target::Filament.roughness(k, 9);
            assert!((p * (2.0 - p) * 8.0 - k as f64).abs() < 1e-12);
        }
        for k in 0..7 {
            let p = Target::Unity.roughness(k, 7);
            assert!((6.0 * p * (1.7 - 0.7 * p) - k as f64).abs() < 1e-12);
        }
        let r: f64 = Target::Unreal.roughness(4, 9);
        assert!((9.0 - 2.0 - (1.0 - 1.2 * r.log2()) - 4.0).abs() < 1e-12);
        // Of a cube of 256 texels three.js's level 1 has tiles of 128: mip 7.
        let r: f64 = Target::Three.roughness(1, Target::Three.levels(256));
        assert!((-2.0 * (1.16 * r).log2() - 7.0).abs() < 1e-12);
    }

    /// HDRP reads its table with `Remap01ToHalfTexelCoord`, u (1 − 1/n) + 1/(2n): at a texel's middle u is k/(n − 1). The others read (k + ½)/n.
    #[test]
    fn tables_have_their_nodes_where_the_shader_reads() {
        let n = 64;
        for target in Target::ALL {
            let nodes = target.table().nodes(n);
            for (k, node) in nodes.into_iter().enumerate().skip(1) {
                let middle = (k as f64 + 0.5) / n as f64;
                let read = if target == Target::Unity {
                    let at = node * (1.0 - 1.0 / n as f64) + 0.5 / n as f64;
                    assert!((node - middle).abs() > 1e-4 || 2 * k == n);
                    at
                } else {
                    node
                };
                assert!((read - middle).abs() < 1e-12, "{target:?} {k}");
            }
        }
        assert!(Target::Unity.table().nodes(2) == [1e-3, 1.0]);
        assert!(Target::Unity.table().nodes(1) == [0.5]);
    }

    /// A function of three bands whose coefficients are all different.
    fn example() -> Harmonics {
        let c = (0..9)
            .map(|i| [1.0 + i as f64, 0.5 * i as f64 - 2.0, 0.1])
            .collect();
        Harmonics::new(c).unwrap()
    }

    #[test]
    fn each_targets_own_formula_gives_the_irradiance() {
        let radiance = example();
        let irradiance = radiance.irradiance();
        for target in Target::ALL {
            let c = target.harmonics(&radiance, true);
            for d in directions(50) {
                let truth = irradiance.evaluate(target.to_world(d));
                let (x, y, z) = (d.x, d.y, d.z);
                let poly = [
                    1.0,
                    y,
                    z,
                    x,
                    x * y,
                    y * z,
                    3.0 * z * z - 1.0,
                    z * x,
                    x * x - y * y,
                ];
                let found: f64 = match target {
                    Target::Filament | Target::Unity => {
                        poly.iter().zip(&c).map(|(p, c)| p * c[0]).sum::<f64>() * PI
                    }
                    Target::Gltf | Target::Custom => {
                        basis(3, d).iter().zip(&c).map(|(p, c)| p * c[0]).sum()
                    }
                    // shGetIrradianceAt, its constants to six digits.
                    Target::Three => {
                        let k = [
                            0.886227, 1.023328, 1.023328, 1.023328, 0.858086, 0.858086, 0.247708,
                            0.858086, 0.429043,
                        ];
                        (0..9).map(|i| poly[i] * c[i][0] * k[i]).sum()
                    }
                    // The dot product of the radiance with CalcDiffuseTransferSH of the normal: its basis with signs, times A_l.
                    Target::Unreal => {
                        let signed = [
                            0.282095,
                            -0.488603 * y,
                            0.488603 * z,
                            -0.488603 * x,
                            1.092548 * x * y,
                            -1.092548 * y * z,
                            0.315392 * (3.0 * z * z - 1.0),
                            -1.092548 * x * z,
                            0.546274 * (x * x - y * y),
                        ];
                        (0..9)
                            .map(|i| {
                                let l = crate::harmonics::band_of(i);
                                signed[i] * c[i][0] * crate::harmonics::cosine_factor(l)
                            })
                            .sum()
                    }
                };
                // Published constants have six digits, values are below 50.
                assert!(
                    (found - truth[0]).abs() < 2e-4,
                    "{target:?}: {found} {}",
                    truth[0]
                );
            }
        }
    }

    #[test]
    fn tiles_of_three_look_where_its_shader_looks() {
        // getUV of the shader, inverted at the middle of each face and at a point of the first.
        let axes = [
            (1, 0, 0),
            (0, 1, 0),
            (0, 0, 1),
            (-1, 0, 0),
            (0, -1, 0),
            (0, 0, -1),
        ];
        for (face, (x, y, z)) in axes.into_iter().enumerate() {
            let [a, b] = [7, 8].map(|i| three_direction(face, 16, i, i));
            let middle = (a + b).normalize();
            let axis = Vec3::new(f64::from(x), f64::from(y), f64::from(z));
            assert!((middle - axis).length() < 1e-12, "{face}");
        }
        let d = three_direction(0, 18, 13, 4);
        // u = (z/|x| + 1)/2, v = (y/|x| + 1)/2; the texel's centre is at u (size − 2) + 1.
        assert!(((d.z / d.x + 1.0) * 0.5 * 16.0 + 1.0 - 13.5).abs() < 1e-12);
        assert!(((d.y / d.x + 1.0) * 0.5 * 16.0 + 1.0 - 4.5).abs() < 1e-12);
    }
}
