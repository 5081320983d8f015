//! Whether values that follow one another are more alike than values by chance, as where a machine wanders or swings with the season.
//!
//! J. von Neumann's ratio `d = sum_i (v_(i+1) - v_i)^2 / sum_i v_i^2` of deviations `v = M y` from the means of groups lies between 0 and 4,
//! and near 2 of independent errors. With `A` of `v^T A v = sum_i (v_(i+1) - v_i)^2` and `nu` degrees of freedom (J. Durbin and G. S. Watson,
//! Biometrika 37, 1950, and 38, 1951)
//!
//! `E d = tr(M A) / nu`,  `Var d = 2 (nu tr(M A M A) - tr(M A)^2) / (nu^2 (nu + 2))`,
//!
//! and `d / 4` follows nearly the beta law of that mean and variance.

use std::collections::BTreeMap;

use statrs::distribution::{Beta, ContinuousCDF};

/// Probability of so small a ratio of independent errors: `values` in the order of time, less the means of their `groups`; `None` where
/// the ratio cannot vary.
pub(super) fn succession_probability(values: &[f64], groups: &[usize]) -> Option<f64> {
    let squares: f64 = values.iter().map(|v| v * v).sum();
    let ratio = values.windows(2).map(|pair| (pair[1] - pair[0]).powi(2)).sum::<f64>() / squares;
    let (mean, variance) = moments(groups)?;
    let (mean, variance) = (mean / 4.0, variance / 16.0);
    let sum = mean * (1.0 - mean) / variance - 1.0;
    let law = Beta::new(mean * sum, (1.0 - mean) * sum).ok()?;
    Some(law.cdf((ratio / 4.0).clamp(0.0, 1.0)))
}

/// Mean and variance of the ratio. With the unit vectors `u_g` of the groups `M = E - sum_g u_g u_g^T`, and the traces take one pass.
fn moments(groups: &[usize]) -> Option<(f64, f64)> {
    let n = groups.len();
    let mut counts: BTreeMap<usize, f64> = BTreeMap::new();
    for group in groups {
        *counts.entry(*group).or_default() += 1.0;
    }
    let nu = n.checked_sub(counts.len()).filter(|nu| *nu > 0)? as f64;
    // tr A and tr A^2; sum_g |A u_g|^2; u_g^T A u_h.
    let (mut trace, mut square, mut lengths) = (0.0, 0.0, 0.0);
    let mut products: BTreeMap<(usize, usize), f64> = BTreeMap::new();
    for i in 0..n {
        let neighbours: Vec<usize> = [i.checked_sub(1), Some(i + 1)].into_iter().flatten().filter(|j| *j < n).collect();
        let diagonal = neighbours.len() as f64;
        trace += diagonal;
        square += diagonal * diagonal + diagonal;
        let mut row = BTreeMap::from([(groups[i], diagonal)]);
        for j in neighbours {
            *row.entry(groups[j]).or_default() -= 1.0;
        }
        for (group, sum) in row {
            lengths += sum * sum / counts[&group];
            *products.entry((groups[i], group)).or_default() += sum / (counts[&groups[i]] * counts[&group]).sqrt();
        }
    }
    let trace = trace - counts.keys().filter_map(|group| products.get(&(*group, *group))).sum::<f64>();
    let square = square - 2.0 * lengths + products.values().map(|product| product * product).sum::<f64>();
    let variance = 2.0 * (nu * square - trace * trace) / (nu * nu * (nu + 2.0));
    (variance > 0.0).then_some((trace / nu, variance))
}
