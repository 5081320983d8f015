//! The likeliest densities of the components by the contrasts.

use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

use super::contrasts::Group;

/// Steps of the ascent for a candidate, and for the final model.
pub const STEPS: (usize, usize) = (100, 400);

/// Densities by component, and their log-likelihood.
///
/// The densities `L_k` maximise the Gaussian likelihood of the contrasts `y_j ~ N(0, S_j)`, `S_j = sum_k B_jk L_k`, by
/// minorisation and maximisation (Zhou, Hu, Qiao and Lange 2019, J. Comput. Graph. Stat. 28, 350), which never
/// descends and keeps every `L_k` non-negative.
#[derive(Clone)]
pub struct Fit {
    /// Index of the correlation time, and the density.
    pub parts: Vec<(usize, Matrix3<f64>)>,
    pub likelihood: f64,
}

impl Fit {
    /// White noise alone.
    pub fn white(groups: &[Group]) -> Self {
        let count: f64 = groups.iter().map(|group| group.count).sum();
        let power: Matrix3<f64> = groups.iter().map(|group| group.power * group.count).sum();
        let mut fit = Self { parts: vec![(0, power / count)], likelihood: f64::NEG_INFINITY };
        fit.likelihood = fit.log_likelihood(groups);
        fit
    }

    /// With one component more, of the likeliest correlation time out of 1 to `times`: by octaves first, then by
    /// neighbours.
    pub fn with_best_time(&self, times: usize, groups: &[Group]) -> Self {
        let octaves: Vec<usize> = (1..=times).step_by(4).collect();
        let octaves: Vec<Self> = octaves.into_par_iter().map(|time| self.with(time, groups)).collect();
        let best = octaves.into_iter().max_by(|a, b| a.likelihood.total_cmp(&b.likelihood));
        let mut best = best.unwrap_or_else(|| self.clone());
        for step in [2, 1] {
            let time = best.parts[best.parts.len() - 1].0;
            for near in [time.saturating_sub(step), time + step].into_iter().filter(|near| (1..=times).contains(near)) {
                let candidate = self.with(near, groups);
                if candidate.likelihood > best.likelihood {
                    best = candidate;
                }
            }
        }
        best
    }

    /// With one component more. It starts too large: the ascent shrinks a component fast and raises one slowly.
    fn with(&self, time: usize, groups: &[Group]) -> Self {
        let mut fit = self.clone();
        let largest = self.parts.iter().max_by(|a, b| a.1.trace().total_cmp(&b.1.trace()));
        fit.parts.extend(largest.map(|(_, density)| (time, *density)));
        fit.climb(groups, STEPS.0);
        fit
    }

    pub fn climb(&mut self, groups: &[Group], steps: usize) {
        for _ in 0..steps {
            self.step(groups);
        }
        self.likelihood = self.log_likelihood(groups);
    }

    fn covariance(&self, group: &Group) -> Matrix3<f64> {
        self.parts.iter().map(|(time, density)| density * group.gains[*time]).sum()
    }

    fn log_likelihood(&self, groups: &[Group]) -> f64 {
        let of = |group: &Group| match self.covariance(group).cholesky() {
            Some(factor) => -0.5 * group.count * (factor.ln_determinant() + factor.solve(&group.power).trace()),
            None => f64::NEG_INFINITY,
        };
        groups.iter().map(of).sum()
    }

    /// What the log-likelihood of other contrasts gains if these have noise of the same colour, and a scale of their own on each axis.
    pub fn gain_by_scale(&self, groups: &[Group]) -> f64 {
        let (mut count, mut squares) = (0.0, Vector3::zeros());
        for group in groups {
            let Some(factor) = self.covariance(group).cholesky() else { continue };
            let Some(half) = factor.l().solve_lower_triangular(&group.power) else { continue };
            let Some(whitened) = factor.l().solve_lower_triangular(&half.transpose()) else { continue };
            count += group.count;
            squares += whitened.diagonal() * group.count;
        }
        let of_axis = |square: f64| if square > 0.0 { square - 1.0 - square.ln() } else { 0.0 };
        0.5 * count * squares.iter().map(|sum| of_axis(sum / count.max(1.0))).sum::<f64>()
    }

    /// `L_k` becomes the solution of `L A L = L_k B L_k`, `A = sum_j B_jk S_j^-1`, `B = sum_j B_jk S_j^-1 y_j y_j^T
    /// S_j^-1`.
    fn step(&mut self, groups: &[Group]) {
        let mut sums = vec![(Matrix3::zeros(), Matrix3::zeros()); self.parts.len()];
        for group in groups {
            let Some(factor) = self.covariance(group).cholesky() else { continue };
            let inverse = factor.inverse();
            let seen = inverse * group.power * inverse;
            for ((a, b), (time, _)) in sums.iter_mut().zip(&self.parts) {
                let weight = group.gains[*time] * group.count;
                *a += inverse * weight;
                *b += seen * weight;
            }
        }
        for ((a, b), (_, density)) in sums.iter().zip(&mut self.parts) {
            *density = geometric_mean(a, &(*density * b * *density)).unwrap_or(*density);
        }
    }
}

/// The symmetric non-negative `L` with `L a L = b`: `C^-T (C^T b C)^1/2 C^-1` with `a = C C^T`.
fn geometric_mean(a: &Matrix3<f64>, b: &Matrix3<f64>) -> Option<Matrix3<f64>> {
    let c = a.cholesky()?.l();
    let root = (c.transpose() * b * c).symmetric_eigen();
    let half = root.eigenvectors * Matrix3::from_diagonal(&root.eigenvalues.map(|value| value.max(0.0).sqrt().sqrt()));
    let left = c.transpose().solve_upper_triangular(&half)?;
    Some(left * left.transpose())
}
