//! The parameters of `openpbr`: their entries, their values, and the slabs that they make.

use crate::model::eon::Eon;
use crate::model::rough_dielectric::RoughDielectric;
use crate::model::sheen_ltc::SheenLtc;
use crate::model::torrance_sparrow::TorranceSparrow;
use crate::model::{Model, components};
use crate::part::colour::{cast, grey};
use crate::part::dielectric::Boundary;
use crate::part::fresnel::{Fresnel, ThinFilm};
use crate::part::interreflection::Interreflection;
use crate::part::masking::Masking;
use crate::part::rough::RoughSurface;
use crate::{BrdfError, ModelSpec, Number, ParameterInfo};
use gonio_num::Real;

const fn unit(name: &'static str, default: f64, meaning: &'static str) -> ParameterInfo {
    ParameterInfo::number(name, "", (0.0, 1.0), Some(default), meaning)
}

const fn colour(name: &'static str, default: f64, meaning: &'static str) -> ParameterInfo {
    ParameterInfo::colour(name, (0.0, 1.0), Some([default; 3]), meaning)
}

const fn index(name: &'static str, default: f64, meaning: &'static str) -> ParameterInfo {
    ParameterInfo::number(name, "", (1.0, 4.0), Some(default), meaning)
}

/// What the registry lists, by the specification's names.
pub(super) const PARAMETERS: &[ParameterInfo] = &[
    unit("base_weight", 1.0, "scale of base_color"),
    colour(
        "base_color",
        0.8,
        "albedo of the diffuse base, F0 of the metal",
    ),
    unit("base_metalness", 0.0, "0 dielectric, 1 metal"),
    unit(
        "base_diffuse_roughness",
        0.0,
        "roughness of the diffuse base, as in `eon`",
    ),
    ParameterInfo::number(
        "specular_weight",
        "",
        (0.0, 10.0),
        Some(1.0),
        "scale of the dielectric's F0, by its index, and of the metal's reflectance (there at most 1)",
    ),
    colour(
        "specular_color",
        1.0,
        "tint of the dielectric's reflection from outside; of the metal's near 82°",
    ),
    unit(
        "specular_roughness",
        0.3,
        "perceptual roughness of dielectric and metal",
    ),
    unit(
        "specular_roughness_anisotropy",
        0.0,
        "a: alpha_t = r² √(2/(1 + (1 − a)²)) along the tangent, alpha_b = (1 − a) alpha_t",
    ),
    index("specular_ior", 1.5, "index of refraction of the dielectric"),
    unit(
        "transmission_weight",
        0.0,
        "share of the dielectric that is translucent",
    ),
    colour(
        "transmission_color",
        1.0,
        "what is left after transmission_depth; where that is 0, tint of what passes the boundary",
    ),
    ParameterInfo::number(
        "transmission_depth",
        "",
        (0.0, 1e9),
        Some(0.0),
        "distance after which transmission_color is left, in units of the scene",
    ),
    unit(
        "subsurface_weight",
        0.0,
        "share of the opaque dielectric that scatters below its surface, here in the limit of no distance",
    ),
    colour(
        "subsurface_color",
        0.8,
        "albedo of what scatters below the surface",
    ),
    ParameterInfo::number(
        "subsurface_scatter_anisotropy",
        "",
        (-1.0, 1.0),
        Some(0.0),
        "thin-walled: −1 scatters all back, 1 all through",
    ),
    unit("coat_weight", 0.0, "share of the surface that is coated"),
    colour(
        "coat_color",
        1.0,
        "what passes the coat twice, down and up, at normal incidence",
    ),
    unit("coat_roughness", 0.0, "perceptual roughness of the coat"),
    unit(
        "coat_roughness_anisotropy",
        0.0,
        "as specular_roughness_anisotropy",
    ),
    index("coat_ior", 1.6, "index of refraction of the coat"),
    unit(
        "coat_darkening",
        1.0,
        "how much of the darkening by reflection inside the coat is kept",
    ),
    unit(
        "fuzz_weight",
        0.0,
        "share of the surface that is covered by fibres",
    ),
    colour("fuzz_color", 1.0, "scale of what the fibres reflect"),
    unit(
        "fuzz_roughness",
        0.5,
        "how far the fibres lean, as in `sheen-ltc`",
    ),
    unit(
        "thin_film_weight",
        0.0,
        "share of the base that is covered by a film",
    ),
    ParameterInfo::number(
        "thin_film_thickness",
        "µm",
        (0.0, 5.0),
        Some(0.5),
        "thickness of the film",
    ),
    index("thin_film_ior", 1.4, "index of refraction of the film"),
    ParameterInfo::choice(
        "geometry_thin_walled",
        &["off", "on"],
        Some("off"),
        "on: a sheet without an inside, the same from either side",
    ),
];

macro_rules! values {
    ($($(#[$doc:meta])* number $number:ident,)* $($(#[$cdoc:meta])* colour $colour:ident,)*) => {
        /// The values, each in the range of its entry in the registry.
        #[derive(Debug, Clone, Copy)]
        pub(super) struct Values<R: Real, const N: usize> {
            $(pub $number: R,)*
            $(pub $colour: [R; N],)*
        }

        impl<R: Real, const N: usize> Values<R, N> {
            pub fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
                Ok(Self {
                    $($number: spec.real(stringify!($number)),)*
                    $($colour: spec.colour(stringify!($colour))?,)*
                })
            }

            pub fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> Values<S, N> {
                Values {
                    $($number: f(self.$number),)*
                    $($colour: cast(self.$colour, f),)*
                }
            }

            pub fn set(&mut self, parameter: &str, value: [R; 3]) {
                match parameter {
                    $(stringify!($number) => self.$number = value[0],)*
                    $(stringify!($colour) => self.$colour = components(value),)*
                    _ => {}
                }
            }
        }
    };
}
values! {
    number base_weight,
    number base_metalness,
    number base_diffuse_roughness,
    number specular_weight,
    number specular_roughness,
    number specular_roughness_anisotropy,
    number specular_ior,
    number transmission_weight,
    number transmission_depth,
    number subsurface_weight,
    number subsurface_scatter_anisotropy,
    number coat_weight,
    number coat_roughness,
    number coat_roughness_anisotropy,
    number coat_ior,
    number coat_darkening,
    number fuzz_weight,
    number fuzz_roughness,
    number thin_film_weight,
    number thin_film_thickness,
    number thin_film_ior,
    colour base_color,
    colour specular_color,
    colour transmission_color,
    colour subsurface_color,
    colour coat_color,
    colour fuzz_color,
}

/// The slabs in the order of [`Values::slabs`].
pub(super) mod slab {
    pub const FUZZ: usize = 0;
    pub const COAT: usize = 1;
    pub const METAL: usize = 2;
    pub const METAL_FILM: usize = 3;
    pub const GLOSS: usize = 4;
    pub const GLOSS_FILM: usize = 5;
    pub const DIFFUSE: usize = 6;
    pub const SUBSURFACE: usize = 7;
    pub const BODY: usize = 8;
    pub const COUNT: usize = 9;
}

/// The largest √F₀ of an index of 4.
const MOST_ROOT: f64 = 0.6;

impl<R: Real, const N: usize> Values<R, N> {
    /// C = base_weight · base_color.
    pub fn base(&self) -> [R; N] {
        self.base_color.map(|c| c * self.base_weight)
    }

    /// The index of the dielectric over that of what is above it, changed so that F₀ is multiplied by specular_weight; at least 1: under a
    /// denser coat the inverse is taken, since the coat keeps steep directions away.
    ///
    /// - `outside`: index of what is above it
    fn index_above(&self, outside: R) -> R {
        let ratio = self.specular_ior / outside;
        let ratio = ratio.max(ratio.recip());
        let root = (ratio - R::one()) / (ratio + R::one());
        let root = (root * self.specular_weight.safe_sqrt()).min(R::lit(MOST_ROOT));
        (R::one() + root) / (R::one() - root)
    }

    /// Index of the dielectric's reflection, with the coat above it where there is one.
    pub fn gloss_ior(&self) -> R {
        let bare = self.specular_ior;
        let coated = bare / self.coat_ior;
        self.index_above(bare / self.coat_weight.lerp(bare, coated))
    }

    /// Index of the body over that of the outside: a coat of parallel faces doesn't change how light is bent.
    pub fn body_ior(&self) -> R {
        crate::part::dielectric::contrasted(self.index_above(R::one()))
    }

    /// Roughness of the base, as it looks through the coat.
    pub fn roughness(&self) -> R {
        let (r, c) = (self.specular_roughness, self.coat_roughness);
        let both = (r * r * r * r + R::lit(2.0) * c * c * c * c).min(R::one());
        self.coat_weight.lerp(r, both.sqrt().sqrt())
    }

    fn surface(roughness: R, anisotropy: R) -> RoughSurface<R> {
        let one = R::one();
        let b = one - anisotropy;
        let along = roughness * roughness * (R::lit(2.0) / (one + b * b)).sqrt();
        RoughSurface::ggx_of_slopes(Masking::SmithCorrelated, along, b * along)
    }

    /// The facets of dielectric and metal.
    pub fn base_surface(&self) -> RoughSurface<R> {
        Self::surface(self.roughness(), self.specular_roughness_anisotropy)
    }

    /// The facets of the coat.
    pub fn coat_surface(&self) -> RoughSurface<R> {
        Self::surface(self.coat_roughness, self.coat_roughness_anisotropy)
    }

    /// Reflectance of the metal without its film and weight.
    pub fn metal_fresnel(&self) -> Fresnel<R, N> {
        Fresnel::F82Tint {
            f0: self.base(),
            tint: self.specular_color,
        }
    }

    fn film(&self, eta: [R; N], k: [R; N]) -> Fresnel<R, N> {
        Fresnel::ThinFilm(ThinFilm {
            thickness_nm: self.thin_film_thickness * R::lit(1000.0),
            ior: self.thin_film_ior,
            eta,
            k,
        })
    }

    /// Reflectance of the dielectric under the film.
    pub fn gloss_film(&self) -> Fresnel<R, N> {
        self.film(grey(self.gloss_ior()), grey(R::zero()))
    }

    /// Reflectance of the metal under the film, of an index that has the colours at normal and at grazing incidence (Gulbrandsen 2014,
    /// "Artist Friendly Metallic Fresnel").
    fn metal_film(&self) -> Fresnel<R, N> {
        let one = R::one();
        let (mut eta, mut k) = (self.base(), self.specular_color);
        for (eta, k) in eta.iter_mut().zip(&mut k) {
            let r = eta.clamp(R::lit(1e-3), R::lit(0.999));
            let edge = k.saturate();
            let root = r.sqrt();
            let n = edge.lerp((one + root) / (one - root), (one - r) / (one + r));
            let k2 = (r * (n + one).sq() - (n - one).sq()) / (one - r);
            *eta = n;
            *k = k2.safe_sqrt();
        }
        self.film(eta, k)
    }

    /// σ of the body, or 0 where the colour is reached at once.
    fn absorption(&self) -> [R; N] {
        let deep = self.transmission_depth.gt(R::zero());
        let over = self.transmission_depth.max(R::lit(1e-9)).recip();
        self.transmission_color
            .map(|t| R::select(deep, -t.max(R::lit(1e-9)).ln() * over, R::zero()))
    }

    /// What tints what passes the boundary.
    fn passage(&self) -> [R; N] {
        let deep = self.transmission_depth.gt(R::zero());
        self.transmission_color
            .map(|t| R::select(deep, R::one(), t))
    }
}

impl<R: Number, const N: usize> Values<R, N> {
    /// The reflection functions of the slabs.
    pub fn slabs(&self, thin_walled: bool) -> Box<[Model<R, N>; slab::COUNT]> {
        let base = self.base_surface();
        let facets = |surface, fresnel, word| {
            Model::TorranceSparrow(TorranceSparrow {
                surface,
                interreflection: Interreflection::new(word, &surface, &fresnel),
                fresnel,
            })
        };
        // What a film does is computed for RGB.
        let film = |fresnel, bare| if N == 3 { fresnel } else { bare };
        let gloss = Fresnel::Dielectric {
            ior: self.gloss_ior(),
        };
        let metal = self.metal_fresnel();
        let coat = Fresnel::Dielectric { ior: self.coat_ior };
        let body = if thin_walled {
            facets(base, Fresnel::None, "kulla-conty")
        } else {
            let boundary = Boundary {
                ior: self.body_ior(),
                reflectance: grey(R::one()),
                transmittance: self.passage(),
                absorption: self.absorption(),
            };
            Model::RoughDielectric(RoughDielectric::with_interreflection(base, boundary))
        };
        let rough = if thin_walled {
            self.base_diffuse_roughness
        } else {
            R::zero()
        };
        Box::new([
            Model::SheenLtc(SheenLtc {
                color: self.fuzz_color,
                roughness: self.fuzz_roughness,
            }),
            facets(self.coat_surface(), coat, "none"),
            facets(base, metal, "kulla-conty"),
            facets(base, film(self.metal_film(), metal), "kulla-conty"),
            facets(base, gloss, "none"),
            facets(base, film(self.gloss_film(), gloss), "none"),
            Model::Eon(Eon::new(self.base(), self.base_diffuse_roughness)),
            Model::Eon(Eon::new(self.subsurface_color, rough)),
            body,
        ])
    }
}
