//! [`Measurement`], what a file holds: numbers, what they stand for, and where they come from.

use super::adaptive::Adaptive;
use super::channel::{Channel, wavelengths};
use super::grid::Grid;
use super::klems::Klems;
use super::metadata::Metadata;
use super::tree::TensorTree;
use super::values::Values;
use crate::BrdfError;
use gonio_num::Vec3;

/// From which side light comes and on which side it is seen. Front is +z.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Side {
    /// Both on the front.
    ReflectionFront,
    /// Both on the back.
    ReflectionBack,
    /// Light comes from the front, is seen from the back.
    TransmissionFront,
    /// Light comes from the back, is seen from the front.
    TransmissionBack,
}

impl Side {
    /// All of them.
    pub const ALL: [Self; 4] = [
        Self::ReflectionFront,
        Self::ReflectionBack,
        Self::TransmissionFront,
        Self::TransmissionBack,
    ];

    /// Its name in files and parameters.
    pub fn name(self) -> &'static str {
        match self {
            Self::ReflectionFront => "reflection-front",
            Self::ReflectionBack => "reflection-back",
            Self::TransmissionFront => "transmission-front",
            Self::TransmissionBack => "transmission-back",
        }
    }

    /// By name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|s| s.name() == name)
    }

    /// Whether light comes from +z.
    pub fn from_front(self) -> bool {
        matches!(self, Self::ReflectionFront | Self::TransmissionFront)
    }

    /// Whether it is seen from +z.
    pub fn to_front(self) -> bool {
        matches!(self, Self::ReflectionFront | Self::TransmissionBack)
    }

    /// Whether light passes through.
    pub fn transmits(self) -> bool {
        self.from_front() != self.to_front()
    }
}

/// How the numbers are laid out over the two directions.
///
/// Each layout takes directions with z ≥ 0: a component's side says which signs they have.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[allow(clippy::large_enum_variant)] // there are few of them
pub enum Data {
    /// At the nodes of a grid of angles, linear between.
    Grid(Grid),
    /// Constant over pairs of patches.
    Klems(Klems),
    /// Constant over squares of varying size.
    TensorTree(TensorTree),
    /// At the nodes of a square that visible microfacet normals are drawn from, linear between.
    Adaptive(Adaptive),
}

impl Data {
    /// Its name for people.
    pub fn name(&self) -> String {
        match self {
            Self::Grid(g) => format!("grid, {}", g.parameterization().name()),
            Self::Klems(k) => {
                if k.incoming() == k.outgoing() {
                    format!("patches, {}", k.incoming().name())
                } else {
                    format!("patches, {} → {}", k.incoming().name(), k.outgoing().name())
                }
            }
            Self::TensorTree(t) => format!("tensor tree of rank {}", t.rank()),
            Self::Adaptive(_) => "adaptive, by visible microfacet normals".into(),
        }
    }

    /// Its size for people.
    pub fn size(&self) -> String {
        match self {
            Self::Grid(g) => g
                .shape()
                .iter()
                .map(usize::to_string)
                .collect::<Vec<_>>()
                .join(" × "),
            Self::Klems(k) => format!("{} × {} patches", k.incoming().len(), k.outgoing().len()),
            Self::TensorTree(t) => format!(
                "{} leaves, squares down to 2^-{}",
                t.leaves().len() / t.channels(),
                t.depth()
            ),
            Self::Adaptive(a) => {
                let [width, height] = a.shape();
                let t = a.tables();
                let (phis, thetas) = (t.phi_i.len(), t.theta_i.len());
                format!("{phis} × {thetas} directions of the viewer, {height} × {width} nodes")
            }
        }
    }

    /// Numbers for each cell.
    pub fn channels(&self) -> usize {
        match self {
            Self::Grid(g) => g.channels(),
            Self::Klems(k) => k.channels(),
            Self::TensorTree(t) => t.channels(),
            Self::Adaptive(a) => a.channels(),
        }
    }

    /// All numbers.
    pub fn values(&self) -> &Values {
        match self {
            Self::Grid(g) => g.values(),
            Self::Klems(k) => k.values(),
            Self::TensorTree(t) => t.leaves(),
            Self::Adaptive(a) => a.values(),
        }
    }

    /// The same layout with other numbers, as many.
    pub(super) fn with_values(&self, values: Values) -> Self {
        match self {
            Self::Grid(g) => Self::Grid(g.with_values(values)),
            Self::Klems(k) => Self::Klems(k.with_values(values)),
            Self::TensorTree(t) => Self::TensorTree(t.with_leaves(values)),
            Self::Adaptive(a) => Self::Adaptive(a.with_values(values)),
        }
    }

    /// Whether it depends on the difference of the azimuths only.
    pub fn is_isotropic(&self) -> bool {
        match self {
            Self::Grid(g) => g.parameterization().is_isotropic(),
            Self::Klems(_) => false,
            Self::TensorTree(t) => t.rank() == 3,
            Self::Adaptive(a) => a.is_isotropic(),
        }
    }

    /// Whether the layout makes it the same with the directions exchanged.
    pub fn is_reciprocal(&self) -> bool {
        match self {
            Self::Grid(g) => {
                use super::grid::Boundary::{Mirrored, Periodic};
                let half_turn = |period: f64| (period - std::f64::consts::PI).abs() < 1e-9;
                g.parameterization().is_half()
                    && g.axes().last().is_some_and(|axis| match axis.boundary() {
                        Periodic(period) | Mirrored(period) => half_turn(period),
                        super::grid::Boundary::Clamped => axis.len() == 1,
                    })
            }
            _ => false,
        }
    }

    /// All numbers at a pair of directions, each with z ≥ 0.
    pub(super) fn lookup(&self, wi: Vec3<f64>, wo: Vec3<f64>, out: &mut [f64]) {
        match self {
            Self::Grid(g) => g.interpolate(wi, wo, out),
            Self::Klems(k) => k.lookup(wi, wo, out),
            Self::TensorTree(t) => t.lookup(wi, wo, out),
            Self::Adaptive(a) => a.lookup(wi, wo, out),
        }
    }

    /// Where a number stands, for people.
    pub(super) fn place(&self, at: usize) -> String {
        let cell = at / self.channels();
        match self {
            Self::Grid(g) => format!("node {:?}", g.place(cell)),
            Self::Klems(k) => {
                let n = k.incoming().len();
                format!("incoming patch {}, outgoing {}", cell % n, cell / n)
            }
            Self::TensorTree(_) => format!("leaf {cell}"),
            Self::Adaptive(a) => {
                let [slice, _, row, column] = a.place(at);
                format!("direction {slice} of the viewer, row {row}, column {column}")
            }
        }
    }

    /// The channel of a number.
    pub(super) fn channel(&self, at: usize) -> usize {
        match self {
            Self::Adaptive(a) => a.place(at)[1],
            _ => at % self.channels(),
        }
    }
}

/// A measurement of one side.
#[derive(Debug, Clone, PartialEq)]
pub struct Component {
    /// Which side.
    pub side: Side,
    /// Its numbers, in sr⁻¹.
    pub data: Data,
    /// Standard uncertainty of each number in sr⁻¹, if it is known; laid out as they are.
    pub uncertainty: Option<Values>,
}

impl Component {
    /// Of the reflection on the front, without uncertainty.
    pub fn reflection(data: Data) -> Self {
        Self {
            side: Side::ReflectionFront,
            data,
            uncertainty: None,
        }
    }
}

/// What a file holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurement {
    /// One entry for each side that was measured, each side once.
    pub components: Vec<Component>,
    /// What the numbers of each cell stand for.
    pub channels: Vec<Channel>,
    /// Where it comes from.
    pub metadata: Metadata,
    /// What was done to the numbers on reading.
    pub notes: Vec<String>,
    /// What the file has and this structure hasn't.
    pub unused: Vec<String>,
}

impl Measurement {
    /// Of one component, after checks.
    ///
    /// # Errors
    /// As [`Measurement::check`].
    pub fn new(
        components: Vec<Component>,
        channels: Vec<Channel>,
        metadata: Metadata,
    ) -> Result<Self, BrdfError> {
        let this = Self {
            components,
            channels,
            metadata,
            notes: Vec::new(),
            unused: Vec::new(),
        };
        this.check()?;
        Ok(this)
    }

    /// Checks that there is a component, each side once, and that its channels are as many as declared, with wavelengths that increase.
    ///
    /// # Errors
    /// What was found and what was expected.
    pub fn check(&self) -> Result<(), BrdfError> {
        let bad = |parameter: &str, found: String, expected: String| BrdfError::Parameter {
            model: "table".into(),
            parameter: parameter.into(),
            found,
            expected,
        };
        if self.components.is_empty() {
            return Err(bad("components", "none".into(), "at least one".into()));
        }
        for (k, component) in self.components.iter().enumerate() {
            let again = self.components[..k]
                .iter()
                .any(|c| c.side == component.side);
            if again {
                let name = component.side.name();
                return Err(bad(
                    "components",
                    format!("{name} twice"),
                    "each once".into(),
                ));
            }
            if component.data.channels() != self.channels.len() {
                return Err(bad(
                    "channels",
                    format!("{} in the data", component.data.channels()),
                    format!("{}, as declared", self.channels.len()),
                ));
            }
            if let Some(u) = &component.uncertainty
                && u.len() != component.data.values().len()
            {
                return Err(bad(
                    "uncertainty",
                    format!("{} numbers", u.len()),
                    format!("{}", component.data.values().len()),
                ));
            }
        }
        let lambda = wavelengths(&self.channels);
        if lambda.windows(2).any(|p| p[0] >= p[1]) {
            return Err(bad(
                "channels",
                format!("wavelengths {lambda:?}"),
                "wavelengths that increase".into(),
            ));
        }
        Ok(())
    }

    /// The component of a side.
    pub fn component(&self, side: Side) -> Option<&Component> {
        self.components.iter().find(|c| c.side == side)
    }

    /// All channels at a pair of directions, on the side that their signs say; 0 where there is no such component.
    pub fn eval(&self, wi: Vec3<f64>, wo: Vec3<f64>) -> Vec<f64> {
        let mut out = vec![0.0; self.channels.len()];
        let above = |v: Vec3<f64>| Vec3::new(v.x, v.y, v.z.abs());
        for c in &self.components {
            let (i, o) = (c.side.from_front(), c.side.to_front());
            if wi.z != 0.0 && wo.z != 0.0 && (wi.z > 0.0) == i && (wo.z > 0.0) == o {
                c.data.lookup(above(wi), above(wo), &mut out);
            }
        }
        out
    }
}
