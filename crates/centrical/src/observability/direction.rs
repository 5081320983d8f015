//! Null directions in their simplest form: few terms, small whole ratios where they are whole.

use nalgebra::{DMatrix, DVector, SVD};

use super::combination::sum_text;
use crate::model::Parameters;

/// Largest whole number that a ratio of the geometry is taken for.
const LARGEST_WHOLE: f64 = 12.0;

/// Some tens of components, each below rounding, together stay below this multiple of it.
const ZEROS: f64 = 10.0;

/// Components of a null vector above this are never taken for rounding, however small the gap.
pub(super) const TAKES_PART: f64 = 1e-6;

/// Longest sum that is still read.
const READABLE: usize = 8;

/// A combination of unknowns along which the predicted data do not change.
#[derive(Debug, Clone, PartialEq)]
pub struct NullDirection {
    terms: Vec<(usize, f64)>,
}

impl NullDirection {
    /// From indices and components.
    pub(super) fn new(terms: Vec<(usize, f64)>) -> Self {
        Self { terms }
    }

    /// First component positive; small whole numbers if all ratios are ratios of such, or else the first one 1.
    pub(super) fn in_simple_ratios(mut terms: Vec<(usize, f64)>) -> Self {
        let first = terms.first().map_or(1.0, |(_, c)| *c);
        let smallest = terms.iter().map(|(_, c)| c.abs()).fold(f64::INFINITY, f64::min).copysign(first);
        let multiplier = (1..=12).map(f64::from).find(|n| terms.iter().all(|(_, c)| is_small_whole(n * c / smallest)));
        for (_, component) in &mut terms {
            *component = multiplier.map_or(*component / first, |n| (n * *component / smallest).round());
        }
        Self { terms }
    }

    /// Non-zero components: (index of the parameter, component in its unit), by index.
    pub fn terms(&self) -> &[(usize, f64)] {
        &self.terms
    }

    /// Component along parameter `j`, zero if it takes no part.
    pub fn component(&self, j: usize) -> f64 {
        self.terms.iter().find(|(index, _)| *index == j).map_or(0.0, |(_, component)| *component)
    }

    /// Its components along coefficients of the error model, those alone that change a reading at 1 g by a twentieth of the most that
    /// one of them does.
    pub(super) fn of_coefficients(&self, parameters: &Parameters, gravity: f64) -> Self {
        const CHIEF: f64 = 0.05;
        let change = |&(j, c): &(usize, f64)| (c * gravity.powi(1 - parameters[j].power_of_acceleration)).abs();
        let coefficients = || self.terms.iter().filter(|(j, _)| parameters[*j].is_of_instrument());
        let most = coefficients().map(change).fold(0.0, f64::max);
        Self::in_simple_ratios(coefficients().filter(|term| change(term) >= CHIEF * most).copied().collect())
    }

    /// The direction as people write it: `dR_2[A] + dR_1[B] - drho_22`. Where the ratios are not whole in SI but are
    /// with accelerations in `gravity` [m/s^2], those are written, and it is said.
    pub fn text(&self, parameters: &Parameters, gravity: f64) -> String {
        let in_g = |&(j, c): &(usize, f64)| (j, c / gravity.powi(parameters[j].power_of_acceleration));
        let in_g = Self::in_simple_ratios(self.terms.iter().map(in_g).collect());
        if !self.is_whole() && in_g.is_whole() {
            return format!("{} (accelerations in g)", shortened(&in_g.terms, parameters));
        }
        shortened(&self.terms, parameters)
    }

    fn is_whole(&self) -> bool {
        self.terms.iter().all(|(_, c)| c.fract() == 0.0)
    }
}

/// The first terms of a sum too long to be read.
fn shortened(terms: &[(usize, f64)], parameters: &Parameters) -> String {
    if terms.len() <= READABLE {
        return sum_text(terms, parameters);
    }
    format!("{} + ... ({} terms)", sum_text(&terms[..READABLE - 2], parameters), terms.len())
}

/// Simplest basis of the null space `basis` (`p x k`, orthonormal, scaled columns); components below `rounding`
/// count as zero, and `norms` lead back to units.
pub(super) fn simplest(basis: &DMatrix<f64>, norms: &DVector<f64>, rounding: f64) -> Vec<NullDirection> {
    if basis.ncols() == 0 {
        return Vec::new();
    }
    let space = NullSpace { basis, rounding };
    let mut vectors = space.echelon();
    space.sparsen(&mut vectors);
    let mut directions: Vec<NullDirection> = vectors.iter().map(|v| in_units(v, norms)).collect();
    directions.sort_by_key(|d| d.terms.iter().map(|(index, _)| *index).collect::<Vec<_>>());
    directions
}

struct NullSpace<'b> {
    basis: &'b DMatrix<f64>,
    rounding: f64,
}

impl NullSpace<'_> {
    /// Reduced echelon form: each vector has a pivot where all others are zero.
    fn echelon(&self) -> Vec<DVector<f64>> {
        let of_pivots = self.basis.select_rows(&pivots(self.basis));
        // Pivots are rows far from dependent, so the square system has a solution.
        let Some(echelon) = of_pivots.transpose().lu().solve(&self.basis.transpose()) else { return Vec::new() };
        echelon.row_iter().map(|row| self.cleaned(row.transpose())).collect()
    }

    /// Replaces a vector by its sum with a multiple of another as long as that has fewer terms. What a sum cancels may come back when it is made
    /// anew: counted there, the terms of all vectors become fewer with each step, and the steps end.
    fn sparsen(&self, vectors: &mut [DVector<f64>]) {
        let mut improved = true;
        while improved {
            improved = false;
            for i in 0..vectors.len() {
                for j in (0..vectors.len()).filter(|&j| j != i) {
                    let Some(factor) = self.best_factor(&vectors[i], &vectors[j]) else { continue };
                    let sum = self.cleaned(&vectors[i] - &vectors[j] * factor);
                    if count_terms(&sum) < count_terms(&vectors[i]) {
                        vectors[i] = sum;
                        improved = true;
                    }
                }
            }
        }
    }

    /// The multiple of `b` to take from `a` that leaves fewest terms, if fewer than `a` has.
    fn best_factor(&self, a: &DVector<f64>, b: &DVector<f64>) -> Option<f64> {
        let common = (0..a.len()).filter(|&p| a[p] != 0.0 && b[p] != 0.0);
        let terms = |factor: f64| a.iter().zip(b).filter(|(x, y)| !self.cancels(**x, factor * **y)).count();
        let factors = common.map(|p| a[p] / b[p]).map(|factor| (terms(factor), factor));
        let (fewest, factor) = factors.min_by_key(|(count, _)| *count)?;
        (fewest < count_terms(a)).then_some(factor)
    }

    /// Whether `x - y` is nothing but rounding.
    fn cancels(&self, x: f64, y: f64) -> bool {
        (x - y).abs() <= self.rounding * (1.0 + x.abs().max(y.abs()))
    }

    /// Zeros where there is only rounding, unit largest component, and the others made anew from the basis: they are
    /// then as exact as the basis, however often the vector was added to others.
    fn cleaned(&self, mut v: DVector<f64>) -> DVector<f64> {
        v /= v.amax();
        let zeros: Vec<usize> = (0..v.len()).filter(|&p| v[p].abs() <= self.rounding).collect();
        let k = self.basis.ncols();
        let rows = zeros.len().max(k);
        let outside = SVD::new(self.basis.select_rows(&zeros).resize_vertically(rows, 0.0), false, true);
        let coordinates = self.basis.tr_mul(&v);
        let mut inside = DVector::zeros(k);
        for (s, direction) in outside.singular_values.iter().zip(outside.v_t.iter().flat_map(|v_t| v_t.row_iter())) {
            if *s <= self.rounding * ZEROS {
                inside += direction.transpose() * (direction * &coordinates)[0];
            }
        }
        let mut exact = self.basis * inside;
        for p in zeros {
            exact[p] = 0.0;
        }
        let largest = exact.amax();
        if largest > 0.0 { exact / largest } else { v }
    }
}

fn count_terms(v: &DVector<f64>) -> usize {
    v.iter().filter(|c| **c != 0.0).count()
}

/// As many independent rows as there are columns, the longest remaining one each time, the first of equally long
/// ones: lengths and with them the choice do not depend on the basis, only on the null space.
fn pivots(basis: &DMatrix<f64>) -> Vec<usize> {
    let mut rows = basis.clone();
    let mut pivots = Vec::with_capacity(basis.ncols());
    for _ in 0..basis.ncols() {
        let lengths: Vec<f64> = rows.row_iter().map(|row| row.norm()).collect();
        let longest = lengths.iter().copied().fold(0.0, f64::max);
        let pivot = lengths.iter().position(|length| *length >= (1.0 - TAKES_PART) * longest).unwrap_or(0);
        let unit = rows.row(pivot).transpose() / longest;
        rows -= (&rows * &unit) * unit.transpose();
        pivots.push(pivot);
    }
    pivots.sort_unstable();
    pivots
}

/// To physical units.
fn in_units(v: &DVector<f64>, norms: &DVector<f64>) -> NullDirection {
    let components = v.iter().zip(norms.iter()).enumerate();
    let terms = components.filter(|(_, (c, _))| **c != 0.0).map(|(j, (c, n))| (j, c / n)).collect();
    NullDirection::in_simple_ratios(terms)
}

/// A ratio of the geometry, not of chance: a small whole number to the accuracy of a singular vector.
fn is_small_whole(ratio: f64) -> bool {
    ratio.abs() < LARGEST_WHOLE + 0.5 && (ratio - ratio.round()).abs() < TAKES_PART
}
