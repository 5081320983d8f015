//! Batches of units compared: whether their means differ (B. L. Welch, Biometrika 38, 1951).

use crate::statistics::f_tail;

/// Welch's test of equal means, whatever the scatters of the batches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BatchTest {
    /// Welch's F.
    pub variance_ratio: f64,
    /// Its degrees of freedom.
    pub degrees_of_freedom: [f64; 2],
    /// Probability of so large an F if the means are equal.
    pub probability: f64,
}

impl BatchTest {
    /// The test of values in batches. Batches of one value or without scatter are left out; `None` unless two are left.
    pub fn of(batches: &[Vec<f64>]) -> Option<BatchTest> {
        let described = batches.iter().filter_map(|values| {
            let n = values.len() as f64;
            let mean = values.iter().sum::<f64>() / n;
            let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
            (values.len() > 1 && variance > 0.0 && variance.is_finite()).then(|| (n, mean, n / variance))
        });
        let batches: Vec<(f64, f64, f64)> = described.collect();
        let k = batches.len() as f64;
        if k < 2.0 {
            return None;
        }
        let total: f64 = batches.iter().map(|(_, _, w)| w).sum();
        let grand = batches.iter().map(|(_, mean, w)| w * mean).sum::<f64>() / total;
        let between = batches.iter().map(|(_, mean, w)| w * (mean - grand).powi(2)).sum::<f64>() / (k - 1.0);
        let doubt: f64 = batches.iter().map(|(n, _, w)| (1.0 - w / total).powi(2) / (n - 1.0)).sum();
        let variance_ratio = between / (1.0 + 2.0 * (k - 2.0) / (k * k - 1.0) * doubt);
        let degrees_of_freedom = [k - 1.0, (k * k - 1.0) / (3.0 * doubt)];
        let probability = f_tail(variance_ratio, degrees_of_freedom[0], degrees_of_freedom[1]);
        Some(BatchTest { variance_ratio, degrees_of_freedom, probability })
    }
}
