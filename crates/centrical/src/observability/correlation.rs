//! Groups of parameters that the data hardly separate.

use nalgebra::DMatrix;

/// Two collinear parameters belong to one group when they share half of their variance.
const SHARED_VARIANCE: f64 = 0.5;

/// Parameters, each nearly a combination of the others: its column has a multiple correlation of at
/// least [`CorrelatedGroup::STRONG`] with all other columns, so its standard uncertainty is at least seven times what it
/// would be with the others known. A pair with a correlation of 0.99 is such a group; so are three or more
/// parameters without a pair correlated that much.
#[derive(Debug, Clone, PartialEq)]
pub struct CorrelatedGroup {
    /// Indices of the parameters.
    pub parameters: Vec<usize>,
    /// Multiple correlation of each with all other parameters.
    pub multiple_correlations: Vec<f64>,
    /// The pairs with a correlation of estimates of at least [`CorrelatedGroup::STRONG`] in magnitude.
    pub pairs: Vec<(usize, usize, f64)>,
}

impl CorrelatedGroup {
    /// Correlation from which two estimates count as one: the standard uncertainty of each is then seven times
    /// (`1 / sqrt(1 - 0.99^2)`) what it would be if the other were known.
    pub const STRONG: f64 = 0.99;
}

/// Connected components, by shared variance, of the collinear parameters among the estimable ones; `covariance` is that of
/// unknowns in units of the lengths of their columns.
pub(super) fn groups(covariance: &DMatrix<f64>, is_estimable: impl Fn(usize) -> bool) -> Vec<CorrelatedGroup> {
    let mut left: Vec<usize> = (0..covariance.ncols())
        .filter(|&j| is_estimable(j) && multiple(covariance, j) >= CorrelatedGroup::STRONG)
        .collect();
    let mut groups = Vec::new();
    while !left.is_empty() {
        let mut members = vec![left.remove(0)];
        let mut next = 0;
        while let Some(&member) = members.get(next) {
            let shares = |j: &mut usize| pair(covariance, member, *j).powi(2) >= SHARED_VARIANCE;
            members.extend(left.extract_if(.., shares));
            next += 1;
        }
        members.sort_unstable();
        groups.push(group(covariance, members));
    }
    groups.retain(|group| group.parameters.len() > 1);
    groups
}

fn group(covariance: &DMatrix<f64>, parameters: Vec<usize>) -> CorrelatedGroup {
    let mut pairs = Vec::new();
    for (n, &i) in parameters.iter().enumerate() {
        for &j in &parameters[n + 1..] {
            let correlation = pair(covariance, i, j);
            if correlation.abs() >= CorrelatedGroup::STRONG {
                pairs.push((i, j, correlation));
            }
        }
    }
    let multiple_correlations = parameters.iter().map(|&j| multiple(covariance, j)).collect();
    CorrelatedGroup { parameters, multiple_correlations, pairs }
}

/// Correlation of the estimates `i` and `j`.
fn pair(covariance: &DMatrix<f64>, i: usize, j: usize) -> f64 {
    covariance[(i, j)] / (covariance[(i, i)] * covariance[(j, j)]).sqrt()
}

/// Multiple correlation `sqrt(1 - 1 / C_jj)` of column `j`, of unit length, with all other columns.
fn multiple(covariance: &DMatrix<f64>, j: usize) -> f64 {
    (1.0 - covariance[(j, j)].recip()).max(0.0).sqrt()
}
