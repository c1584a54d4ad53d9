//! [`Cube`], six square pictures around a point, and where their texels look.
//!
//! Faces are in the order +x, −x, +y, −y, +z, −z. With s to the right and t downwards over a face, a = 2s − 1, b = 2t − 1,
//! a texel looks along
//!
//! ```text
//! +x (1, −b, −a)   −x (−1, −b, a)   +y (a, 1, b)   −y (a, −1, −b)   +z (a, −b, 1)   −z (−a, −b, −1)
//! ```
//!
//! in the world (right-handed, +y up), as OpenGL, Vulkan, Direct3D and WebGPU look cube maps up (OpenGL 4.6 specification,
//! table 8.19). Source: Greene 1986, "Environment Mapping and Other Applications of World Projections".

use gonio_num::{Real, Vec3};

/// Names of the faces, in order, as files carry them.
pub const FACES: [&str; 6] = ["px", "nx", "py", "ny", "pz", "nz"];

/// Six square pictures of radiance.
#[derive(Debug, Clone, PartialEq)]
pub struct Cube {
    /// Texels along an edge.
    pub size: usize,
    /// Face after face, row after row from the top left: 6 · size² of them.
    pub texels: Vec<[f32; 3]>,
}

/// The direction, of length ≥ 1, at (a, b) in \[−1, 1]² of a face.
#[inline(always)]
pub fn towards(face: usize, a: f64, b: f64) -> Vec3<f64> {
    match face {
        0 => Vec3::new(1.0, -b, -a),
        1 => Vec3::new(-1.0, -b, a),
        2 => Vec3::new(a, 1.0, b),
        3 => Vec3::new(a, -1.0, -b),
        4 => Vec3::new(a, -b, 1.0),
        _ => Vec3::new(-a, -b, -1.0),
    }
}

/// The face that a direction meets, and (a, b) in \[−1, 1]² there.
#[inline(always)]
pub fn place(d: Vec3<f64>) -> (usize, f64, f64) {
    let (x, y, z) = (d.x.abs(), d.y.abs(), d.z.abs());
    if x >= y && x >= z {
        let over = 1.0 / x;
        if d.x > 0.0 {
            (0, -d.z * over, -d.y * over)
        } else {
            (1, d.z * over, -d.y * over)
        }
    } else if y >= z {
        let over = 1.0 / y;
        if d.y > 0.0 {
            (2, d.x * over, d.z * over)
        } else {
            (3, d.x * over, -d.z * over)
        }
    } else {
        let over = 1.0 / z;
        if d.z > 0.0 {
            (4, d.x * over, -d.y * over)
        } else {
            (5, -d.x * over, -d.y * over)
        }
    }
}

/// The unit direction of the centre of texel (x, y) of a face of `size`².
#[inline(always)]
pub fn centre(face: usize, size: usize, x: usize, y: usize) -> Vec3<f64> {
    let at = |i: usize| (2 * i + 1) as f64 / size as f64 - 1.0;
    towards(face, at(x), at(y)).normalize()
}

/// Solid angle \[sr] of the rectangle from (a0, b0) to (a1, b1) of a face.
///
/// Ω = F(a1, b1) − F(a0, b1) − F(a1, b0) + F(a0, b0) with F(a, b) = atan(ab / √(1 + a² + b²)).
pub fn solid_angle(a0: f64, a1: f64, b0: f64, b1: f64) -> f64 {
    let f = |a: f64, b: f64| Real::atan2(a * b, (1.0 + a * a + b * b).sqrt());
    f(a1, b1) - f(a0, b1) - f(a1, b0) + f(a0, b0)
}

impl Cube {
    /// A cube of one colour.
    pub fn filled(size: usize, rgb: [f32; 3]) -> Self {
        Self {
            size,
            texels: vec![rgb; 6 * size * size],
        }
    }

    /// The texel (x, y) of a face.
    ///
    /// # Panics
    /// Outside the cube.
    pub fn get(&self, face: usize, x: usize, y: usize) -> [f32; 3] {
        assert!(x < self.size && y < self.size, "texel outside the face");
        self.texels[(face * self.size + y) * self.size + x]
    }

    /// One face as a picture.
    ///
    /// # Panics
    /// If `face` > 5.
    pub fn face(&self, face: usize) -> gonio_image::Image {
        let n = self.size * self.size;
        gonio_image::Image {
            width: self.size,
            height: self.size,
            pixels: self.texels[face * n..(face + 1) * n].to_vec(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn places_and_directions_are_inverse() {
        for face in 0..6 {
            for (a, b) in [(0.0, 0.0), (0.5, -0.25), (-0.9, 0.9), (0.99, 0.01)] {
                let (f, p, q) = place(towards(face, a, b));
                assert_eq!(f, face);
                assert!(
                    (p - a).abs() < 1e-15 && (q - b).abs() < 1e-15,
                    "{face} {a} {b}: {p} {q}"
                );
            }
        }
    }

    #[test]
    fn solid_angles_add_up_to_the_sphere() {
        let n = 8;
        let at = |i: usize| 2.0 * i as f64 / n as f64 - 1.0;
        let mut sum = 0.0;
        for y in 0..n {
            for x in 0..n {
                sum += solid_angle(at(x), at(x + 1), at(y), at(y + 1));
            }
        }
        assert!((6.0 * sum - 4.0 * PI).abs() < 1e-13);
    }
}
