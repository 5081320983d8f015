//! The filter over plateaus: states enter with their position, retire with it, and come back by smoothing.
//!
//! The unknowns carried are ordered by the end of their lifetimes, so that those to retire next stand in front. Their
//! rows of the triangle, `R_rr x_r + R_ra x_a = b_r`, are all that the data of the past say about them given the
//! others. They are laid aside as they are. The rest of the triangle is the marginal information about the states that
//! go on. Nothing is lost and nothing repeated: the rows laid aside and the last triangle together are the triangle of
//! one batch, in which back substitution smooths every retired state.

use nalgebra::{DMatrix, DVector, Vector3};

use super::super::data::Data;
use super::lifetimes::Lifetimes;
use crate::linalg::factor::Factor;
use crate::model::plateau::{Design, Readings};
use crate::model::{FitError, Linearisation};
use crate::observability::Observability;

/// A square-root information filter over the plateaus of an order.
///
/// Its arithmetic per plateau and its memory depend on the number of states carried, not on the plateaus or positions behind
/// it. Beside it there are two lists to look up or append to: where each unknown is, and the archive of retired
/// rows, which the filter never reads.
#[derive(Debug, Clone)]
pub struct Filter<'a> {
    lifetimes: &'a Lifetimes,
    /// Place in the order of the latest plateau.
    place: usize,
    carried: Vec<usize>,
    /// State of each unknown, if carried.
    slots: Vec<Option<usize>>,
    /// Squared length of the column of each state in the readings so far: what its entries are small beside.
    lengths: Vec<f64>,
    factor: Factor,
    archive: Vec<Row>,
    /// Columns of a plateau by state, kept for its memory.
    scratch: Vec<(usize, Vector3<f64>)>,
    /// Sum of squared norms of the whitened readings of the model.
    magnitude: f64,
}

/// One whitened equation `sum coefficient x = misfit`.
#[derive(Debug, Clone, PartialEq)]
struct Row {
    /// Unknowns.
    columns: Vec<usize>,
    /// Their coefficients.
    coefficients: Vec<f64>,
    /// Right side.
    misfit: f64,
}

/// One pass of the filter over all plateaus, and the smoothing back.
pub(in crate::fit) fn smoothed(data: &Data, linearisations: &[Linearisation]) -> Result<Design, FitError> {
    let order: Vec<usize> = data.observations().iter().map(|o| o.set_point).collect();
    let lifetimes = Lifetimes::new(data.model(), &order);
    let mut filter = Filter::new(&lifetimes);
    for (place, (observation, linearisation)) in data.observations().iter().zip(linearisations).enumerate() {
        filter.update(place, &Readings::new(observation, linearisation)?)?;
    }
    Ok(filter.smoothed())
}

impl<'a> Filter<'a> {
    /// A filter that knows nothing, before the first plateau of the order.
    pub fn new(lifetimes: &'a Lifetimes) -> Self {
        let mut filter = Self {
            lifetimes,
            place: 0,
            carried: Vec::new(),
            slots: vec![None; lifetimes.unknowns()],
            lengths: Vec::new(),
            factor: Factor::new(0),
            archive: Vec::new(),
            scratch: Vec::new(),
            magnitude: 0.0,
        };
        filter.carry(lifetimes.carried(0), &[]);
        filter
    }

    /// Takes up the plateau at `place` of the order and returns by how much chi^2 grows. Places may be left out, not
    /// gone back to.
    ///
    /// # Errors
    /// [`FitError::Retired`] when an unknown that the plateau sees is not carried there: the place is behind the
    /// filter, or the plateau is not the one of the order.
    pub fn update(&mut self, place: usize, readings: &Readings) -> Result<f64, FitError> {
        self.advance(place)?;
        self.scratch.clear();
        for (column, derivative) in &readings.columns {
            let slot = self.slot(*column, place)?;
            self.scratch.push((slot, *derivative));
        }
        for (slot, derivative) in &self.scratch {
            self.lengths[*slot] += derivative.norm_squared();
        }
        self.magnitude += readings.magnitude.powi(2);
        Ok(self.factor.update(&self.scratch, &readings.misfit))
    }

    /// Goes on to `place`: retires the unknowns whose last plateau is behind and takes in those that begin.
    ///
    /// # Errors
    /// [`FitError::Retired`] when the place is behind the filter.
    pub fn advance(&mut self, place: usize) -> Result<(), FitError> {
        if place < self.place {
            return Err(FitError::Retired { place });
        }
        while self.place < place {
            self.place += 1;
            if self.lifetimes.changes_at(self.place) {
                let next = self.lifetimes.carried(self.place);
                let returned = self.retire(&next);
                self.carry(next, &returned);
            }
        }
        Ok(())
    }

    /// Unknowns carried now, in the order of the states of [`Filter::factor`].
    pub fn carried(&self) -> &[usize] {
        &self.carried
    }

    /// Information about the unknowns carried, relative to the point of linearisation.
    pub fn factor(&self) -> &Factor {
        &self.factor
    }

    /// Squared lengths of the columns of the states.
    pub(super) fn lengths(&self) -> &[f64] {
        &self.lengths
    }

    /// Place in the order of the latest plateau.
    pub fn place(&self) -> usize {
        self.place
    }

    /// State of an unknown that has to be carried at `place`.
    pub(super) fn slot(&self, column: usize, place: usize) -> Result<usize, FitError> {
        self.slots.get(column).copied().flatten().ok_or(FitError::Retired { place })
    }

    /// Smoothing back: the triangle of all unknowns, retired and carried, as the equations of one batch.
    fn smoothed(&self) -> Design {
        let states = (0..self.factor.states()).map(|j| row(&self.factor, &self.carried, j));
        let all: Vec<Row> = self.archive.iter().cloned().chain(states).collect();
        let mut rows = DMatrix::zeros(all.len(), self.lifetimes.unknowns());
        let mut misfit = DVector::zeros(all.len());
        for (n, row) in all.iter().enumerate() {
            row.columns.iter().zip(&row.coefficients).for_each(|(&column, value)| rows[(n, column)] = *value);
            misfit[n] = row.misfit;
        }
        Design { rows, misfit, rest: self.factor.rest().sqrt(), magnitude: self.magnitude.sqrt() }
    }

    /// Lays aside the rows of the states in front that `next` does not carry any more, and returns those of them that
    /// turn out to say nothing about the retiring states but something about the others.
    fn retire(&mut self, next: &[usize]) -> Vec<Row> {
        let retiring = self.carried.iter().take_while(|column| !next.contains(column)).count();
        let rows: Vec<Row> = (0..retiring).map(|j| row(&self.factor, &self.carried, j)).collect();
        let (kept, returned) = separate(&rows, &self.carried, &self.lengths[..retiring]);
        self.archive.extend(kept);
        returned
    }

    /// Carries `next` from now on: the factor of the states that stay, zeros for those that begin, and the rows that
    /// were returned by the retiring states.
    fn carry(&mut self, next: Vec<usize>, returned: &[Row]) {
        self.slots.fill(None);
        next.iter().enumerate().for_each(|(slot, &column)| self.slots[column] = Some(slot));
        let staying: Vec<usize> = self.carried.iter().filter_map(|&column| self.slots[column]).collect();
        let retired = self.carried.len() - staying.len();
        self.factor = self.factor.rearranged(retired, &staying, next.len());
        let mut lengths = vec![0.0; next.len()];
        staying.iter().zip(&self.lengths[retired..]).for_each(|(&slot, length)| lengths[slot] = *length);
        self.lengths = lengths;
        self.scratch.reserve(next.len());
        self.carried = next;
        for row in returned {
            let columns = row.columns.iter().zip(&row.coefficients);
            let columns: Vec<_> =
                columns.filter_map(|(&c, &value)| Some((self.slots[c]?, Vector3::x() * value))).collect();
            self.factor.update(&columns, &(Vector3::x() * row.misfit));
        }
    }
}

/// Row `j` of a factor with the names of its columns.
fn row(factor: &Factor, carried: &[usize], j: usize) -> Row {
    let (misfit, coefficients) = factor.row(j).split_last().unwrap_or((&0.0, &[]));
    Row { columns: carried[j..].to_vec(), coefficients: coefficients.to_vec(), misfit: *misfit }
}

/// Separates the leading rows of a triangle, those of retiring states with the given squared `lengths` of their
/// columns, into those that determine retiring states and those that only concern the others.
///
/// As a rule every retiring state has been determined and the rows stay as they are. If not, the leading block has
/// singular values that count as zero (columns at unit length, as in [`crate::Observability`]); its left
/// singular vectors turn the rows so that these stand apart. What is dropped with them is lost to a batch
/// as well: a direction that the whole experiment sees by less than the tolerance.
fn separate(rows: &[Row], carried: &[usize], lengths: &[f64]) -> (Vec<Row>, Vec<Row>) {
    let retiring = lengths.len();
    if retiring == 0 {
        return (Vec::new(), Vec::new());
    }
    let dense = DMatrix::from_fn(retiring, carried.len() + 1, |i, j| match j.checked_sub(i) {
        Some(n) if j < carried.len() => rows[i].coefficients[n],
        Some(_) => rows[i].misfit,
        None => 0.0,
    });
    let mut block = dense.columns(0, retiring).into_owned();
    block.column_iter_mut().zip(lengths).filter(|(_, l)| **l > 0.0).for_each(|(mut column, l)| column /= l.sqrt());
    let svd = block.svd(true, false);
    let seen = |n: usize| svd.singular_values[n] > Observability::RANK_TOLERANCE;
    if (0..retiring).all(seen) {
        return (rows.to_vec(), Vec::new());
    }
    let turned = svd.u.as_ref().map_or_else(|| dense.clone(), |u| u.tr_mul(&dense));
    let named = |n: usize, first: usize| Row {
        columns: carried[first..].to_vec(),
        coefficients: (first..carried.len()).map(|j| turned[(n, j)]).collect(),
        misfit: turned[(n, carried.len())],
    };
    let (kept, returned): (Vec<usize>, Vec<usize>) = (0..retiring).partition(|&n| seen(n));
    (kept.into_iter().map(|n| named(n, 0)).collect(), returned.into_iter().map(|n| named(n, retiring)).collect())
}
