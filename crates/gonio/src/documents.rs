//! The Rust of the README and the book, compiled and run as tests of the documentation.

macro_rules! documents {
    ($($name:ident: $path:literal,)*) => {
        $(#[doc = include_str!(concat!("../../../", $path))] pub struct $name;)*
    };
}

documents! {
    Readme: "README.md",
    ReadmeOfGonio: "crates/gonio/README.md",
    ReadmeOfRender: "crates/gonio-render/README.md",
    Light: "book/src/theory/light.md",
    SolidAngle: "book/src/theory/solid-angle.md",
    SphericalCoordinates: "book/src/theory/spherical-coordinates.md",
    DifferentialSolidAngle: "book/src/theory/differential-solid-angle.md",
    Radiance: "book/src/theory/radiance.md",
    Reflection: "book/src/theory/brdf.md",
    ReflectionEquation: "book/src/theory/reflection-equation.md",
    Fresnel: "book/src/theory/fresnel.md",
    Library: "book/src/library.md",
    Verification: "book/src/verification.md",
}
