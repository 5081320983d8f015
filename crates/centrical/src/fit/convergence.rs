//! How the uncertainties shrink as the session goes on: those of all unknowns after each plateau.
//!
//! Square-root information form: the triangular factor `R` of the whitened design starts from a standard deviation of
//! [`NULL_HOLD`] typical magnitudes for every unknown and from the priors, and the plateaus of each stage add their whitened rows by a
//! QR factorisation. The uncertainties are the lengths of the rows of `R^-1`. The attitude of a rest is an unknown of that rest alone: it is
//! eliminated with it, so that the time is linear in rests.

use nalgebra::{DMatrix, DVector, Matrix3};

use super::assembly::Assembly;
use super::calibration::Calibration;
use crate::linalg::elimination::{Elimination, Own};
use crate::linalg::least_squares::LeastSquares;
use crate::model::{Linearisation, NULL_HOLD};

/// The uncertainties at some stage of the session.
#[derive(Debug, Clone, PartialEq)]
pub struct Checkpoint {
    /// Plateaus used so far.
    pub plateaus: usize,
    /// Standard uncertainty of every unknown, SI, in the order of the model's parameters; `None` of attitudes of single rests.
    pub standard_uncertainty: Vec<Option<f64>>,
}

impl Calibration<'_> {
    /// Standard uncertainties at no more than `most` evenly spread stages of the session; the last stage has all plateaus.
    pub fn convergence(&self, most: usize) -> Vec<Checkpoint> {
        let (observations, fit) = (self.data().observations(), self.fit());
        let parameters = self.data().model().parameters().len();
        let (typical, slots) = (self.data().typical(), self.slots());
        let kept: Vec<usize> = (0..typical.len()).filter(|&j| slots[j].is_some()).collect();
        let sizes = DVector::from_iterator(kept.len(), kept.iter().map(|&j| typical[j]));
        let p = kept.len();
        let every = observations.len().div_ceil(most.max(1)).max(1);
        let mut prior = vec![0.0; typical.len()];
        self.data()
            .model()
            .priors()
            .iter()
            .for_each(|p| prior[p.parameter] = typical[p.parameter] / p.standard_uncertainty);
        let start = kept.iter().map(|&j| if j < parameters { prior[j].hypot(1.0 / NULL_HOLD) } else { 1.0 });
        let mut triangle = DMatrix::from_diagonal(&DVector::from_iterator(p, start));
        let mut checkpoints = Vec::new();
        let mut plateaus = 0;
        let linearisations = self.data().linearised(&fit.unknowns());
        for (linearisations, covariances) in linearisations.chunks(every).zip(fit.observation_covariances.chunks(every))
        {
            let mut stack = triangle.resize_vertically(p + 3 * linearisations.len(), 0.0);
            for (n, (linearisation, covariance)) in linearisations.iter().zip(covariances).enumerate() {
                let rows = whitened_rows(linearisation, covariance, (&typical, &prior), (&slots, p));
                stack.rows_mut(p + 3 * n, 3).copy_from(&rows);
            }
            let equations = LeastSquares::new(stack, sizes.clone());
            triangle = equations.triangle().clone();
            plateaus += linearisations.len();
            let of_kept = equations.standard_uncertainties();
            let standard_uncertainty = slots[..parameters].iter().map(|slot| slot.map(|slot| of_kept[slot])).collect();
            checkpoints.push(Checkpoint { plateaus, standard_uncertainty });
        }
        checkpoints
    }

    /// The place of each unknown among those that are kept from plateau to plateau; `None` of attitudes of single rests.
    fn slots(&self) -> Vec<Option<usize>> {
        let mut is_kept = vec![true; self.data().unknowns()];
        let own = Assembly::Batch.own(self.data(), &[]);
        for &j in own.iter().flat_map(|own| &own.columns) {
            is_kept[j] = false;
        }
        let mut next = 0..;
        is_kept.into_iter().map(|is_kept| if is_kept { next.next() } else { None }).collect()
    }
}

/// Three rows of one plateau at the fit, whitened, in typical units, of the `count` unknowns that have slots; the others are eliminated,
/// with their priors: weights of a typical magnitude, 0 without one.
fn whitened_rows(
    linearisation: &Linearisation,
    covariance: &Matrix3<f64>,
    (typical, prior): (&DVector<f64>, &[f64]),
    (slots, count): (&[Option<usize>], usize),
) -> DMatrix<f64> {
    let own = linearisation.by_unknowns().filter(|(column, _)| slots[*column].is_none()).count();
    let mut rows = DMatrix::zeros(3 + own, count + own);
    // A fit accepts positive definite covariances only.
    let Some(factor) = covariance.cholesky() else { return DMatrix::zeros(3, count) };
    let mut next = 0..;
    for (column, derivative) in linearisation.by_unknowns() {
        let Some(whitened) = factor.l_dirty().solve_lower_triangular(derivative) else { continue };
        let place = slots[column].unwrap_or_else(|| {
            let own = next.next().unwrap_or_default();
            rows[(3 + own, count + own)] = prior[column];
            count + own
        });
        rows.fixed_view_mut::<3, 1>(0, place).copy_from(&(whitened * typical[column]));
    }
    Elimination::of(rows, &[Own { columns: (count..count + own).collect(), rows: (0..3 + own).collect() }]).1
}
