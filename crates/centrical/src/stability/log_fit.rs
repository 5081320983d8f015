//! Least squares on logarithms of variances that are non-negative sums of known shares.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::log_moments::{LogMoments, MomentModel};
use super::stochastic_terms::STOCHASTIC;
use crate::linalg::least_squares::LeastSquares;

/// Variances to be described by `v = A theta`, theta >= 0.
pub(super) struct LogFit {
    /// Averaging factors.
    pub(super) factors: Vec<usize>,
    /// Logarithms of the variances.
    pub(super) logarithms: DVector<f64>,
    /// A: the variance at each factor of each term of size 1.
    pub(super) shares: DMatrix<f64>,
    pub(super) moments: MomentModel,
}

/// A fitted model.
#[derive(Clone)]
pub(super) struct Model {
    pub(super) theta: [f64; STOCHASTIC],
    pub(super) chi_squared: f64,
}

/// Where the residuals of the logarithms are centred and how they are whitened.
struct Weights {
    mean: DVector<f64>,
    factor: Cholesky<f64, Dyn>,
}

impl LogFit {
    /// The best model of all terms.
    pub(super) fn best(&self) -> Option<Model> {
        self.fit([true; STOCHASTIC])
    }

    /// By how much chi-squared grows if term `k` is denied, all others being free to take its place.
    ///
    /// Both fits at the weights of the model without it: those that hold if it is absent.
    pub(super) fn cost_of_absence(&self, model: &Model, k: usize) -> Option<f64> {
        let mut others = [true; STOCHASTIC];
        others[k] = false;
        let reduced = self.fit(others)?;
        let weights = self.weights(&reduced.theta)?;
        let whole = self.minimise([true; STOCHASTIC], &self.nothing(), &weights, &model.theta);
        Some(reduced.chi_squared - whole.chi_squared)
    }

    /// Standard deviations of the active theta by D, the whitened derivative of the logarithms.
    pub(super) fn standard_deviations(&self, model: &Model) -> Option<[f64; STOCHASTIC]> {
        let weights = self.weights(&model.theta)?;
        let (design, _) = self.linearise(&model.theta, &self.nothing(), &weights);
        let deviations = LeastSquares::of_columns(design)?.standard_uncertainties();
        Some(std::array::from_fn(|k| deviations[k]))
    }

    /// The theta_k at which chi-squared, the active terms refitted, is 1.645^2 above its least.
    pub(super) fn upper_bound(&self, model: &Model, k: usize) -> f64 {
        const RISE: f64 = 1.645 * 1.645;
        let Some(weights) = self.weights(&model.theta) else { return f64::INFINITY };
        let share = self.shares.column(k);
        let total = self.variances(&model.theta);
        let scale = total.iter().zip(&share).map(|(v, a)| v / a).fold(f64::INFINITY, f64::min);
        let mut others = [true; STOCHASTIC];
        others[k] = false;
        let is_below = |theta: f64| {
            let fit = self.minimise(others, &(share * theta), &weights, &model.theta);
            fit.chi_squared < model.chi_squared + RISE
        };
        let mut lower = model.theta[k];
        let mut upper = lower.max(scale);
        while is_below(upper) {
            lower = upper;
            upper *= 2.0;
        }
        while upper - lower > 1e-6 * upper {
            let middle = 0.5 * (lower + upper);
            if is_below(middle) { lower = middle } else { upper = middle }
        }
        upper
    }

    /// The best model of the active terms, the weights being those of the model itself.
    fn fit(&self, is_active: [bool; STOCHASTIC]) -> Option<Model> {
        const ROUNDS: usize = 50;
        let relative =
            DMatrix::from_fn(self.factors.len(), STOCHASTIC, |j, k| self.shares[(j, k)] / self.logarithms[j].exp());
        let ones = DVector::from_element(self.factors.len(), 1.0);
        let mut theta = non_negative(&relative, &ones, is_active);
        let mut model = None;
        for _ in 0..ROUNDS {
            let weights = self.weights(&theta)?;
            let next = self.minimise(is_active, &self.nothing(), &weights, &theta);
            let change = (self.variances(&next.theta) - self.variances(&theta)).component_div(&self.variances(&theta));
            theta = next.theta;
            model = Some(next);
            if change.amax() < 1e-9 {
                break;
            }
        }
        model
    }

    /// Gauss-Newton with halved steps: the best active terms at given weights, `known` variance added to theirs.
    fn minimise(
        &self,
        is_active: [bool; STOCHASTIC],
        known: &DVector<f64>,
        weights: &Weights,
        start: &[f64; STOCHASTIC],
    ) -> Model {
        const STEPS: usize = 50;
        let cost = |theta: &[f64; STOCHASTIC]| self.residual(theta, known, weights).norm_squared();
        let mut theta = *start;
        for k in 0..STOCHASTIC {
            theta[k] *= f64::from(u8::from(is_active[k]));
        }
        let mut chi_squared = cost(&theta);
        if !chi_squared.is_finite() {
            theta = *start;
            chi_squared = f64::INFINITY;
        }
        for _ in 0..STEPS {
            let (design, target) = self.linearise(&theta, known, weights);
            let goal = non_negative(&design, &target, is_active);
            let along = |share: f64| std::array::from_fn(|k| theta[k] + share * (goal[k] - theta[k]));
            let shares = std::iter::successors(Some(1.0), |share| Some(0.5 * share)).take(30);
            let Some((lower, better)) =
                shares.map(|share| (cost(&along(share)), along(share))).find(|(lower, _)| *lower < chi_squared)
            else {
                break;
            };
            let is_settled = chi_squared - lower < 1e-10 * (1.0 + lower);
            (chi_squared, theta) = (lower, better);
            if is_settled {
                break;
            }
        }
        Model { theta, chi_squared }
    }

    /// Whitened derivative of the logarithms and the target that theta itself should meet.
    fn linearise(
        &self,
        theta: &[f64; STOCHASTIC],
        known: &DVector<f64>,
        weights: &Weights,
    ) -> (DMatrix<f64>, DVector<f64>) {
        let total = self.variances(theta) + known;
        let mut design = DMatrix::from_fn(self.factors.len(), STOCHASTIC, |j, k| self.shares[(j, k)] / total[j]);
        weights.factor.l_dirty().solve_lower_triangular_mut(&mut design);
        let target = self.residual(theta, known, weights) + &design * DVector::from_row_slice(theta);
        (design, target)
    }

    /// `L^-1 (ln s^2 - mean - ln v)`, L the Cholesky factor of the covariance.
    fn residual(&self, theta: &[f64; STOCHASTIC], known: &DVector<f64>, weights: &Weights) -> DVector<f64> {
        let total = self.variances(theta) + known;
        let mut residual = &self.logarithms - &weights.mean - total.map(f64::ln);
        weights.factor.l_dirty().solve_lower_triangular_mut(&mut residual);
        residual
    }

    fn variances(&self, theta: &[f64; STOCHASTIC]) -> DVector<f64> {
        &self.shares * DVector::from_row_slice(theta)
    }

    fn weights(&self, theta: &[f64; STOCHASTIC]) -> Option<Weights> {
        let LogMoments { mean, covariance } = self.moments.moments(theta);
        Some(Weights { mean, factor: covariance.cholesky()? })
    }

    fn nothing(&self) -> DVector<f64> {
        DVector::zeros(self.factors.len())
    }
}

/// `min |D theta - t|` over theta >= 0 with only the active terms: the best of the subsets' least-squares
/// solutions that are positive, or zero. With four terms there are fifteen, so trying all is exact and simple.
fn non_negative(design: &DMatrix<f64>, target: &DVector<f64>, is_active: [bool; STOCHASTIC]) -> [f64; STOCHASTIC] {
    let mut best = (target.norm_squared(), [0.0; STOCHASTIC]);
    for bits in 1..1_usize << STOCHASTIC {
        let subset: Vec<usize> = (0..STOCHASTIC).filter(|&k| bits >> k & 1 == 1).collect();
        if !subset.iter().all(|&k| is_active[k]) {
            continue;
        }
        let columns = design.select_columns(&subset);
        let Some(equations) = LeastSquares::of_columns(columns.clone()) else { continue };
        let solution = equations.solve(target.clone());
        let square = (columns * &solution - target).norm_squared();
        if square < best.0 && solution.iter().all(|theta| *theta > 0.0) {
            best = (square, [0.0; STOCHASTIC]);
            subset.iter().zip(&solution).for_each(|(&k, value)| best.1[k] = *value);
        }
    }
    best.1
}
