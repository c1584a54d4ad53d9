//! [`Measured`], a measurement ready to be evaluated and drawn from.

use super::adaptive::AdaptiveTable;
use super::channel::ToRgb;
use super::grid::GridTable;
use super::klems::KlemsTable;
use super::measurement::{Component, Data, Measurement, Side};
use super::metadata::{Found, Gamut, Repair};
use super::repair::repair;
use super::tree::TreeTable;
use crate::part::colour::only_where;
use crate::part::geometry::above;
use crate::{BrdfError, Number};
use gonio_num::{Real, Vec3};
use std::path::Path;

/// How a measurement is made ready.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LoadOptions {
    /// What is done with negative values.
    pub negative: Repair,
    /// What is done with missing values.
    pub missing: Missing,
    /// What is evaluated.
    pub select: Select,
}

/// [`Repair`] of missing values, filled unless stated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Missing(pub Repair);

impl Default for Missing {
    fn default() -> Self {
        Self(Repair::Fill)
    }
}

/// What of a measurement is evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Select {
    /// The reflection on the front; if there is none, the only other component.
    #[default]
    Front,
    /// One side. The reflection on the back is turned over about the y axis, so that it is seen from +z.
    One(Side),
    /// Every side that there is, each where it belongs.
    All,
}

/// A measurement with its colours projected to linear RGB and its sampling prepared.
#[derive(Debug, Clone)]
pub struct Measured {
    measurement: Measurement,
    to_rgb: ToRgb,
    options: LoadOptions,
    found: Found,
    parts: Vec<Part>,
    /// Whether the one part is of the back and evaluated from the front.
    turned_over: bool,
}

#[derive(Debug, Clone)]
struct Part {
    side: Side,
    table: Table,
}

#[derive(Debug, Clone)]
enum Table {
    Grid(Box<GridTable>),
    Klems(Box<KlemsTable>),
    Tree(Box<TreeTable>),
    Adaptive(Box<AdaptiveTable>),
}

/// The same expression for each kind of table.
macro_rules! each_table {
    ($table:expr, $t:ident => $body:expr) => {
        match $table {
            Table::Grid($t) => $body,
            Table::Klems($t) => $body,
            Table::Tree($t) => $body,
            Table::Adaptive($t) => $body,
        }
    };
}

impl Table {
    fn new(
        component: &Component,
        to_rgb: &ToRgb,
        gamut: &mut Gamut,
    ) -> Result<Self, (String, String)> {
        Ok(match &component.data {
            Data::Grid(grid) => Self::Grid(Box::new(GridTable::new(grid, to_rgb, gamut))),
            Data::Klems(klems) => Self::Klems(Box::new(KlemsTable::new(klems, to_rgb, gamut))),
            Data::TensorTree(tree) => Self::Tree(Box::new(TreeTable::new(tree, to_rgb, gamut)?)),
            Data::Adaptive(all) => Self::Adaptive(Box::new(AdaptiveTable::new(all, to_rgb, gamut))),
        })
    }
}

impl Measured {
    /// Makes a measurement ready. `path` is the file that errors name.
    ///
    /// # Errors
    /// If the measurement is not consistent ([`Measurement::check`]), has a value that is infinite or refused by `options`, lacks the
    /// component that is asked for, or is too fine to be drawn from.
    pub fn new(
        path: &Path,
        mut measurement: Measurement,
        options: LoadOptions,
    ) -> Result<Self, BrdfError> {
        measurement.check()?;
        let mut found = Found {
            unused: measurement.unused.clone(),
            notes: measurement.notes.clone(),
            ..Found::default()
        };
        let sides = selected(path, &measurement, options.select)?;
        repair(
            path,
            &mut measurement,
            options.negative,
            options.missing.0,
            &mut found,
        )?;
        let to_rgb = ToRgb::new(&measurement.channels);
        let mut gamut = Gamut::default();
        let mut parts = Vec::new();
        for component in &measurement.components {
            if !sides.contains(&component.side) {
                found.unused.push(component.side.name().into());
                continue;
            }
            let table = Table::new(component, &to_rgb, &mut gamut);
            let table = table.map_err(|(is, expected)| BrdfError::Format {
                path: path.into(),
                place: component.side.name().into(),
                found: is,
                expected,
            })?;
            let side = component.side;
            parts.push(Part { side, table });
        }
        found.out_of_gamut = gamut.clipped;
        found.unused.extend(to_rgb.unused(&measurement.channels));
        let turned_over = parts.len() == 1
            && parts[0].side == Side::ReflectionBack
            && options.select != Select::All;
        Ok(Self {
            measurement,
            to_rgb,
            options,
            found,
            parts,
            turned_over,
        })
    }

    /// The measurement, its values repaired.
    pub fn measurement(&self) -> &Measurement {
        &self.measurement
    }

    /// What was seen and done.
    pub fn found(&self) -> &Found {
        &self.found
    }

    /// What was asked for.
    pub fn options(&self) -> LoadOptions {
        self.options
    }

    /// Lines about negative and missing values.
    pub fn warnings(&self) -> Vec<String> {
        self.found
            .warnings(self.options.negative, self.options.missing.0)
    }

    /// The sides that are evaluated.
    pub fn sides(&self) -> Vec<Side> {
        self.parts.iter().map(|p| p.side).collect()
    }

    /// Whether light may pass through.
    pub fn transmits(&self) -> bool {
        self.parts.iter().any(|p| p.side.transmits())
    }

    /// Whether its layout makes it depend on the difference of the azimuths only.
    pub fn is_isotropic(&self) -> bool {
        self.data().all(|d| d.is_isotropic())
    }

    /// Whether its layout makes it the same with the directions exchanged.
    pub fn is_reciprocal(&self) -> bool {
        self.data().all(|d| d.is_reciprocal())
    }

    fn data(&self) -> impl Iterator<Item = &Data> {
        self.parts
            .iter()
            .filter_map(|p| self.measurement.component(p.side))
            .map(|c| &c.data)
    }

    /// Whether it is grey: then it can be evaluated with any number of colour components.
    pub fn is_grey(&self) -> bool {
        let weights = &self.to_rgb.weights;
        weights.iter().all(|w| w[0] == w[1] && w[1] == w[2])
    }

    /// All channels at a pair of directions in sr⁻¹, where [`Measurement::channels`] says what each is; 0 where nothing was measured.
    pub fn eval_spectrum(&self, wi: Vec3<f64>, wo: Vec3<f64>) -> Vec<f64> {
        let (wi, wo) = (self.turn(wi), self.turn(wo));
        let evaluated = self.parts.iter().any(|p| accepts(p.side, wi, wo));
        if evaluated {
            self.measurement.eval(wi, wo)
        } else {
            vec![0.0; self.measurement.channels.len()]
        }
    }

    /// The grid that is alone and of the reflection on the front: the case that batches run fast.
    #[inline(always)]
    fn grid_alone(&self) -> Option<&GridTable> {
        match &self.parts[..] {
            [
                Part {
                    side: Side::ReflectionFront,
                    table: Table::Grid(grid),
                },
            ] => Some(grid),
            _ => None,
        }
    }

    /// The adaptive table that is alone and of the reflection on the front, which has batches of its own.
    #[inline(always)]
    pub(crate) fn adaptive_alone(&self) -> Option<&AdaptiveTable> {
        match &self.parts[..] {
            [
                Part {
                    side: Side::ReflectionFront,
                    table: Table::Adaptive(all),
                },
            ] => Some(all),
            _ => None,
        }
    }

    /// f in sr⁻¹, linear RGB; 0 where nothing was measured.
    #[inline(always)]
    pub fn eval<R: Number>(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; 3] {
        match self.grid_alone() {
            Some(grid) => only_where::<R, 3>(above(wi, wo), grid.eval(wi, wo)),
            None => self.eval_parts(wi, wo),
        }
    }

    // Called, not inlined, as its like below: every kind of table in every kernel of a batch would take the compiler minutes.
    #[inline(never)]
    fn eval_parts<R: Number>(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; 3] {
        let (wi, wo) = (self.turn(wi), self.turn(wo));
        let mut sum = [R::zero(); 3];
        for part in &self.parts {
            let f = each_table!(&part.table, t => t.eval(raised(wi), raised(wo)));
            let f = only_where::<R, 3>(accepts(part.side, wi, wo), f);
            for k in 0..3 {
                sum[k] = sum[k] + f[k];
            }
        }
        sum
    }

    /// Density per solid angle with which [`Measured::sample`] draws `wi` for this `wo`.
    #[inline(always)]
    pub fn pdf<R: Number>(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        match self.grid_alone() {
            Some(grid) => R::select(above(wi, wo), grid.pdf(wi, wo), R::zero()),
            None => self.pdf_parts(wi, wo),
        }
    }

    #[inline(never)]
    fn pdf_parts<R: Number>(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        let (wi, wo) = (self.turn(wi), self.turn(wo));
        let mut sum = R::zero();
        for part in &self.parts {
            let p = each_table!(&part.table, t => t.pdf(raised(wi), raised(wo)));
            let share = self.share(part, wo);
            sum = sum + R::select(accepts(part.side, wi, wo), share * p, R::zero());
        }
        sum
    }

    /// [`Measured::eval`] and [`Measured::pdf`] at once, the same to the bit.
    #[inline(always)]
    pub fn eval_and_pdf<R: Number>(&self, wi: Vec3<R>, wo: Vec3<R>) -> ([R; 3], R) {
        match self.adaptive_alone() {
            Some(all) => {
                let (f, pdf) = all.eval_and_pdf(wi, wo);
                let both = above(wi, wo);
                (only_where::<R, 3>(both, f), R::select(both, pdf, R::zero()))
            }
            None => (self.eval(wi, wo), self.pdf(wi, wo)),
        }
    }

    /// Draws a direction to the light for the viewer's direction `wo`; (0, 0, 0) where that gives nothing.
    #[inline(always)]
    pub fn sample<R: Number>(&self, wo: Vec3<R>, u: [R; 3]) -> Vec3<R> {
        match self.grid_alone() {
            Some(grid) => {
                let zero = Vec3::new(R::zero(), R::zero(), R::zero());
                let wi = grid.sample(wo, u);
                Vec3::select(above(wi, wo), wi, zero)
            }
            None => self.sample_parts(wo, u),
        }
    }

    #[inline(never)]
    fn sample_parts<R: Number>(&self, wo: Vec3<R>, u: [R; 3]) -> Vec3<R> {
        let wo = self.turn(wo);
        let zero = Vec3::new(R::zero(), R::zero(), R::zero());
        let mut drawn = zero;
        let mut below = R::zero();
        for part in &self.parts {
            let share = self.share(part, wo);
            let chosen = below.le(u[2]) & u[2].lt(below + share);
            let rest = (u[2] - below) / share.max(R::lit(1e-30));
            let u = [
                u[0],
                u[1],
                rest.clamp(R::zero(), R::lit(1.0 - 1.0 / 16_777_216.0)),
            ];
            let wi = each_table!(&part.table, t => t.sample(raised(wo), u));
            // Only half vectors give directions below the horizon, which are nothing.
            let above = wi.z.gt(R::zero());
            let wi = if part.side.from_front() {
                wi
            } else {
                Vec3::new(wi.x, wi.y, -wi.z)
            };
            drawn = Vec3::select(chosen & above & seen(part.side, wo), wi, drawn);
            below = below + share;
        }
        self.turn(drawn)
    }

    /// The luminous albedo, roughly.
    #[inline(never)]
    pub fn albedo<R: Number>(&self, wo: Vec3<R>) -> R {
        let wo = self.turn(wo);
        let mut sum = R::zero();
        for part in &self.parts {
            sum = sum + albedo(part, wo);
        }
        sum
    }

    /// The probability with which a part is drawn from.
    #[inline(never)]
    fn share<R: Number>(&self, part: &Part, wo: Vec3<R>) -> R {
        if self.parts.len() == 1 {
            return R::one();
        }
        let mut sum = R::zero();
        let mut count = R::zero();
        for other in &self.parts {
            sum = sum + albedo(other, wo);
            count = count + R::from_mask(seen(other.side, wo));
        }
        // Even shares where all are black: their samples weigh nothing.
        let some = sum.gt(R::lit(1e-30));
        let even = R::from_mask(seen(part.side, wo)) / count.max(R::one());
        R::select(
            some,
            albedo(part, wo) / R::select(some, sum, R::one()),
            even,
        )
    }

    /// The direction in the frame of the measurement: turned over about the y axis if its back is looked at.
    #[inline(always)]
    fn turn<R: Real>(&self, w: Vec3<R>) -> Vec3<R> {
        if self.turned_over {
            Vec3::new(-w.x, w.y, -w.z)
        } else {
            w
        }
    }
}

/// The luminous albedo of a part; 0 for a viewer on its other side.
#[inline(never)]
fn albedo<R: Number>(part: &Part, wo: Vec3<R>) -> R {
    let a = each_table!(&part.table, t => t.albedo(raised(wo)));
    R::select(seen(part.side, wo), a, R::zero())
}

/// The direction with z ≥ 0.
#[inline(always)]
fn raised<R: Real>(w: Vec3<R>) -> Vec3<R> {
    Vec3::new(w.x, w.y, w.z.abs())
}

/// Whether the viewer is on the side where the component is seen.
#[inline(always)]
fn seen<R: Real>(side: Side, wo: Vec3<R>) -> R::Mask {
    if side.to_front() {
        wo.z.gt(R::zero())
    } else {
        wo.z.lt(R::zero())
    }
}

/// Whether both directions are on the component's sides.
#[inline(always)]
fn accepts<R: Real>(side: Side, wi: Vec3<R>, wo: Vec3<R>) -> R::Mask {
    let light = if side.from_front() {
        wi.z.gt(R::zero())
    } else {
        wi.z.lt(R::zero())
    };
    light & seen(side, wo)
}

/// The sides that are to be evaluated.
fn selected(
    path: &Path,
    measurement: &Measurement,
    select: Select,
) -> Result<Vec<Side>, BrdfError> {
    let all: Vec<Side> = measurement.components.iter().map(|c| c.side).collect();
    let wanted = match select {
        Select::All => return Ok(all),
        Select::One(side) => side,
        Select::Front if all.len() == 1 => return Ok(all),
        Select::Front => Side::ReflectionFront,
    };
    if all.contains(&wanted) {
        return Ok(vec![wanted]);
    }
    let names: Vec<&str> = all.iter().map(|s| s.name()).collect();
    Err(BrdfError::Format {
        path: path.into(),
        place: "components".into(),
        found: names.join(", "),
        expected: format!("{}; choose one with component=…", wanted.name()),
    })
}
