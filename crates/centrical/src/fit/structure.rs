//! The structure of a design: rank and null space, which hold for any number of fits of one experiment.

use std::sync::OnceLock;

use nalgebra::{DMatrix, DVector};

use super::assembly::Assembly;
use super::data::Data;
use super::design::Design;
use crate::linalg::elimination::Own;
use crate::linalg::least_squares::LeastSquares;
use crate::model::{FitError, Linearisation, Prior};
use crate::observability::Observability;

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
    /// The equations at `X = 0`, null directions held, factored when the first fit starts from them.
    pub(super) start: OnceLock<LeastSquares>,
}

/// What holds the null directions of equations.
#[derive(Debug, Clone)]
pub(super) struct Held {
    /// Unknowns that few equations contain.
    own: Vec<Own>,
    /// Orthonormal basis of the null space in typical units, `(p + q) x (p - rank)`.
    pub null_basis: DMatrix<f64>,
    /// Typical magnitudes of the unknowns.
    pub typical: DVector<f64>,
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
        Ok((Self::decided(assembly, data, linearisations, &design), design))
    }

    /// The structure decided on the equations at `X = 0`, those of the priors and influences among them.
    fn decided(assembly: Assembly, data: &Data, linearisations: Vec<Linearisation>, design: &Design) -> Self {
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
        let mut held = Held::new(&observability, own, data.typical());
        if observability.lost() == 0 {
            held.own = assembly.own(data, model.priors(), true);
        }
        Self { assembly, observability, of_data, held, linearisations, start: OnceLock::new() }
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
        // What is eliminated is determined where all else is held.
        for &j in own.iter().flat_map(|own| &own.columns) {
            null_basis.row_mut(j).fill(0.0);
        }
        Self { own, null_basis: orthonormal(null_basis), typical }
    }

    /// The whitened equations and their misfit, with one equation more for each null direction: its component is zero, with
    /// weight `null_weight`.
    pub fn equations(&self, design: &Design, x: &DVector<f64>, null_weight: f64) -> (LeastSquares, DVector<f64>) {
        let (n, p, lost) = (design.rows.nrows(), design.rows.ncols(), self.null_basis.ncols());
        let mut rows = DMatrix::zeros(n + lost, p);
        rows.rows_mut(0, n).copy_from(&design.rows);
        rows.column_iter_mut().zip(self.typical.iter()).for_each(|(mut column, typical)| column *= *typical);
        let held = self.null_basis.transpose() * null_weight;
        let mut misfit = DVector::zeros(n + lost);
        misfit.rows_mut(0, n).copy_from(&design.misfit);
        misfit.rows_mut(n, lost).copy_from(&(-&held * x.component_div(&self.typical)));
        rows.rows_mut(n, lost).copy_from(&held);
        (LeastSquares::eliminating(&self.own, rows, self.typical.clone()), misfit)
    }
}

/// Orthonormal basis of the span of the columns, which are independent.
fn orthonormal(columns: DMatrix<f64>) -> DMatrix<f64> {
    if columns.ncols() == 0 { columns } else { columns.qr().q() }
}
