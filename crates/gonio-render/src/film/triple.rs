//! [`Triple`] and [`Nearest`]: what a film sums or chooses for the layers that are asked for.

use super::binned;

/// Sums of three numbers that are not negative, functions of the set of what was added as all sums of a film are.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Triple {
    pub(super) digits: [[u64; 2]; 3],
    pub(super) tops: [u8; 3],
}

impl Triple {
    /// Adds numbers that are finite and not negative.
    #[inline]
    pub fn add(&mut self, values: [f32; 3]) {
        for (c, value) in values.into_iter().enumerate() {
            binned::add(&mut self.digits[c], &mut self.tops[c], f64::from(value));
        }
    }

    pub fn merge(&mut self, other: &Self) {
        for c in 0..3 {
            let others = (&other.digits[c], other.tops[c]);
            binned::merge(&mut self.digits[c], &mut self.tops[c], others);
        }
    }

    pub fn value(&self) -> [f64; 3] {
        std::array::from_fn(|c| binned::value(&self.digits[c], self.tops[c]))
    }

    /// Whether sums read from a file can be those of at most `count` triples.
    pub fn is_sound(&self, count: u32) -> bool {
        (0..3).all(|c| binned::is_sound(&self.digits[c], self.tops[c], count))
    }
}

/// What a pixel's material is: that of the sample nearest to the pixel's middle, and of equally near ones the least. Whatever the order
/// of the samples, it is the same one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Nearest {
    /// The bits of its squared distance to the middle, in pixels: for numbers that are not negative their order is that of the numbers.
    pub(super) distance: u32,
    /// 1 and the index of the material; 0 where no surface was met.
    pub(super) material: u32,
}

impl Default for Nearest {
    /// Further away than any.
    fn default() -> Self {
        Self {
            distance: f32::INFINITY.to_bits(),
            material: 0,
        }
    }
}

impl Nearest {
    /// - `distance`: squared, to the pixel's middle, in pixels
    /// - `material`: of the first surface, if there is one
    pub fn new(distance: f32, material: Option<u32>) -> Self {
        Self {
            distance: distance.to_bits(),
            material: material.map_or(0, |m| m.saturating_add(1)),
        }
    }

    pub fn merge(&mut self, other: Self) {
        *self = other.min(*self);
    }

    /// Whether what is read from a file can be one.
    pub fn is_sound(&self) -> bool {
        self.distance <= f32::INFINITY.to_bits()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triples_add_up_in_any_order() {
        let values = [[1.0, 0.0, 1e-30], [0.3, 1e20, 7.0], [1e8, 2.0, 0.1]];
        let of = |order: [usize; 3]| {
            let mut sum = Triple::default();
            order.into_iter().for_each(|k| sum.add(values[k]));
            sum
        };
        let whole = of([0, 1, 2]);
        assert_eq!(of([2, 0, 1]), whole);
        let (mut a, mut b) = (Triple::default(), Triple::default());
        a.add(values[1]);
        b.add(values[0]);
        b.add(values[2]);
        a.merge(&b);
        assert_eq!(a, whole);
        assert!(whole.is_sound(3));
        assert!(
            !Triple {
                tops: [99; 3],
                ..whole
            }
            .is_sound(3)
        );
        // Each component loses less than 2⁻³² of its largest number, three times.
        for (c, sum) in whole.value().into_iter().enumerate() {
            let exact: f64 = values.iter().map(|v| f64::from(v[c])).sum();
            assert!(
                (sum - exact).abs() <= 3.0 * 2.0_f64.powi(-32) * exact,
                "{sum} {exact}"
            );
        }
    }

    #[test]
    fn the_nearest_sample_decides() {
        let mut found = Nearest::default();
        assert_eq!(found.material, 0);
        for next in [
            Nearest::new(0.2, Some(4)),
            Nearest::new(0.1, Some(7)),
            Nearest::new(0.3, None),
            Nearest::new(0.1, Some(2)),
        ] {
            found.merge(next);
        }
        assert_eq!((found.distance, found.material), (0.1_f32.to_bits(), 3));
        found.merge(Nearest::new(0.0, None));
        assert_eq!(found.material, 0);
        assert!(found.is_sound() && !Nearest::new(f32::NAN, None).is_sound());
    }
}
