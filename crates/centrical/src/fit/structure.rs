//! The structure of a design: rank and null space, which hold for any number of fits of one experiment.

use nalgebra::{DMatrix, DVector};

use super::data::Data;
use super::departure::departs;
use super::filter;
use crate::linalg::least_squares::{LeastSquares, Own};
use crate::model::plateau::Design;
use crate::model::{FitError, Linearisation, Parameter, Prior};
use crate::observability::Observability;

/// Null directions are as wide as the hold, to rounding; a weak direction is wider by this factor.
const WIDER: f64 = 1.001;

/// How the whitened equations of all plateaus, linearised at a point, are brought together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Assembly {
    /// Stacked as they are.
    Batch,
    /// Rotated into a triangle by the filter, plateau by plateau, and smoothed back.
    Filter,
}

impl Assembly {
    /// The equations of the plateaus and of the priors, linearised at `x`.
    pub fn design(self, data: &Data, x: &[f64], linearisations: &[Linearisation]) -> Result<Design, FitError> {
        let design = match self {
            Self::Batch => Design::of(data.observations(), linearisations, data.unknowns())?,
            Self::Filter => filter::smoothed(data, linearisations)?,
        };
        Ok(design.with_priors(data.model().priors(), data.model().influences().len(), x))
    }

    /// Unknowns that few of the equations with `priors` contain, as long as the equations stand as they are: attitudes of single rests; those
    /// of all positions where the equations determine all unknowns, since then each position's own do so.
    pub fn own(self, data: &Data, priors: &[Prior], determine_all: bool) -> Vec<Own> {
        let set_points: Vec<usize> = data.observations().iter().map(|observation| observation.set_point).collect();
        match self {
            Self::Batch if determine_all => data.model().unknowns_of_positions(&set_points, priors),
            Self::Batch => data.model().attitudes_of_single_rests(&set_points, priors),
            Self::Filter => Vec::new(),
        }
    }
}

/// What a design determines and what it loses, decided on `H` at `X = 0`. It depends on the plateaus and their weights,
/// never on the readings, and holds for any number of fits of one experiment.
#[derive(Debug, Clone)]
pub struct Structure {
    /// How the equations are brought together, at zero and at every later point.
    pub(super) assembly: Assembly,
    pub(super) observability: Observability,
    /// What the data determine without the priors, if there are any.
    pub(super) of_data: Option<Observability>,
    pub(super) held: Held,
    /// Of the observations at `X = 0`.
    pub(super) linearisations: Vec<Linearisation>,
    /// The equations at `X = 0`, all directions held that are, from which every fit starts.
    pub(super) start: LeastSquares,
}

/// What holds directions of equations that would run away.
#[derive(Debug, Clone)]
pub(super) struct Held {
    /// Unknowns that few equations contain.
    own: Vec<Own>,
    /// Orthonormal basis of the null space in typical units, `(p + q) x (p - rank)`.
    pub null_basis: DMatrix<f64>,
    /// Orthonormal directions in typical units that the data determine, but only to where the model is no longer linear.
    weak_basis: DMatrix<f64>,
    /// Typical magnitudes of the unknowns.
    pub typical: DVector<f64>,
}

/// Which directions are held about zero, with a standard deviation of [`Parameter::NULL_HOLD`] typical magnitudes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Hold {
    /// The null directions.
    pub null: bool,
    /// The weak ones: to find a point where the model can be linearised, never in an estimate.
    pub weak: bool,
}

impl Hold {
    pub const NULL: Self = Self { null: true, weak: false };
    pub const WEAK: Self = Self { null: false, weak: true };
    pub const ALL: Self = Self { null: true, weak: true };

    /// The same without the weak directions.
    pub fn of_null(self) -> Self {
        Self { weak: false, ..self }
    }
}

impl Structure {
    /// Structure of the design that the plateaus make with their weights.
    ///
    /// # Errors
    /// [`FitError`] when numbers overflow.
    pub fn of(data: &Data) -> Result<Self, FitError> {
        Self::by(Assembly::Batch, data).map(|(structure, _)| structure)
    }

    /// The structure, and the equations at `X = 0` that it was decided on.
    pub(super) fn by(assembly: Assembly, data: &Data) -> Result<(Self, Design), FitError> {
        let linearisations = data.linearised_at_zero();
        let design = assembly.design(data, &vec![0.0; data.unknowns()], &linearisations)?;
        Ok((Self::decided(assembly, data, linearisations, &design)?, design))
    }

    /// The structure decided on the equations at `X = 0`, those of the priors and influences among them.
    fn decided(
        assembly: Assembly,
        data: &Data,
        linearisations: Vec<Linearisation>,
        design: &Design,
    ) -> Result<Self, FitError> {
        let model = data.model();
        let (columns, influences) = (model.parameters().len(), model.influences().len());
        // The influences have proper distributions of their own: they take part in no null direction.
        let plateaus = design.rows.nrows() - influences - model.priors().len();
        let with = |priors: &[Prior]| {
            let rows = design.rows.view((0, 0), (plateaus + priors.len(), columns)).into_owned();
            let own = assembly.own(data, priors, false);
            (Observability::of(rows, &own, 0), own)
        };
        let of_data = (!model.priors().is_empty()).then(|| with(&[]).0);
        let (observability, own) = with(model.priors());
        let (held, start) = Held::at_zero(assembly, data, &observability, own, &linearisations, design)?;
        Ok(Self { assembly, observability, of_data, held, linearisations, start })
    }

    /// What the design determines.
    pub fn observability(&self) -> &Observability {
        &self.observability
    }

    /// Number of combinations that priors alone determine.
    pub(super) fn lost_by_data(&self) -> usize {
        self.of_data.as_ref().map_or(0, |data| data.lost().saturating_sub(self.observability.lost()))
    }
}

impl Held {
    /// Equations of unknowns with these `typical` magnitudes; influences, which the observability does not count, stand last.
    pub fn new(observability: &Observability, own: Vec<Own>, typical: DVector<f64>) -> Self {
        let mut null_basis = observability.null_basis().resize_vertically(typical.len(), 0.0);
        null_basis.row_iter_mut().zip(typical.iter()).for_each(|(mut row, typical)| row /= *typical);
        let (null_basis, weak_basis) = (orthonormal(&own, null_basis), DMatrix::zeros(typical.len(), 0));
        Self { own, null_basis, weak_basis, typical }
    }

    /// The equations at `X = 0` with that `design`, and what holds them.
    fn at_zero(
        assembly: Assembly,
        data: &Data,
        observability: &Observability,
        own: Vec<Own>,
        linearisations: &[Linearisation],
        design: &Design,
    ) -> Result<(Self, LeastSquares), FitError> {
        let zero = DVector::zeros(data.unknowns());
        let mut held = Self::new(observability, own, data.typical());
        if observability.lost() == 0 {
            let all = Self { own: assembly.own(data, data.model().priors(), true), ..held.clone() };
            let start = all.equations(design, &zero, Hold::ALL).0;
            if start.inverse().norm() < Parameter::NULL_HOLD {
                return Ok((all, start));
            }
        }
        held.weak_basis = held.weak(data, linearisations, design)?;
        let start = held.equations(design, &zero, Hold::ALL).0;
        Ok((held, start))
    }

    /// Directions that the data determine, to more than [`Parameter::NULL_HOLD`] typical magnitudes, and along which the model departs from its
    /// linearisation at `X = 0` within one standard uncertainty.
    fn weak(&self, data: &Data, linearisations: &[Linearisation], design: &Design) -> Result<DMatrix<f64>, FitError> {
        let (equations, _) = self.equations(design, &DVector::zeros(data.unknowns()), Hold::NULL);
        let mut weak = DMatrix::zeros(data.unknowns(), 0);
        for direction in equations.wider_than(WIDER * Parameter::NULL_HOLD) {
            if departs(data, linearisations, &direction.component_mul(&self.typical))? {
                weak.extend([direction]);
            }
        }
        Ok(orthonormal(&self.own, weak))
    }

    /// Whether it holds any direction.
    pub fn holds(&self, hold: Hold) -> bool {
        hold.null && self.null_basis.ncols() > 0 || hold.weak && self.weak_basis.ncols() > 0
    }

    /// The equations that hold directions, one each: its component in typical units is zero.
    pub fn rows(&self, hold: Hold) -> DMatrix<f64> {
        let bases = [(hold.null, &self.null_basis), (hold.weak, &self.weak_basis)];
        let held: Vec<_> = bases.iter().filter(|(held, _)| *held).flat_map(|(_, basis)| basis.column_iter()).collect();
        let mut rows = DMatrix::zeros(held.len(), self.typical.len());
        for (mut row, direction) in rows.row_iter_mut().zip(held) {
            row.copy_from(&(direction.transpose() * (1.0 / Parameter::NULL_HOLD)));
        }
        rows
    }

    /// The whitened equations and their misfit, with one equation more for each direction that is held.
    pub fn equations(&self, design: &Design, x: &DVector<f64>, hold: Hold) -> (LeastSquares, DVector<f64>) {
        let held = self.rows(hold);
        let (n, p, m) = (design.rows.nrows(), design.rows.ncols(), held.nrows());
        let mut rows = DMatrix::zeros(n + m, p);
        rows.rows_mut(0, n).copy_from(&design.rows);
        rows.column_iter_mut().zip(self.typical.iter()).for_each(|(mut column, typical)| column *= *typical);
        let mut misfit = DVector::zeros(n + m);
        misfit.rows_mut(0, n).copy_from(&design.misfit);
        misfit.rows_mut(n, m).copy_from(&(-&held * x.component_div(&self.typical)));
        rows.rows_mut(n, m).copy_from(&held);
        (LeastSquares::eliminating(&self.own, rows, self.typical.clone()), misfit)
    }
}

/// Orthonormal basis of the span of directions in typical units, which are independent, without the unknowns that are
/// eliminated: these are determined where all else is held.
fn orthonormal(own: &[Own], mut directions: DMatrix<f64>) -> DMatrix<f64> {
    for &j in own.iter().flat_map(|own| &own.columns) {
        directions.row_mut(j).fill(0.0);
    }
    if directions.ncols() == 0 { directions } else { directions.qr().q() }
}
