//! From standard to expanded uncertainty: degrees of freedom and coverage factors (GUM, annex G).

use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

/// Degrees of freedom of a standard uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Degrees {
    /// The uncertainty itself is taken as exact.
    Infinite,
    /// A finite number.
    Finite(f64),
}

impl Degrees {
    /// Welch-Satterthwaite: `nu_eff = u_c^4 / sum u_i^4 / nu_i` over independent contributions `u_i` (GUM, G.2b).
    ///
    /// Contributions are pairs of standard uncertainty and degrees of freedom. Valid for one output quantity whose inputs
    /// are independent and about normal; several parameters jointly have no such number.
    pub fn effective(contributions: &[(f64, Degrees)]) -> Degrees {
        let variance: f64 = contributions.iter().map(|(u, _)| u * u).sum();
        let doubt: f64 = contributions
            .iter()
            .map(|(u, degrees)| match degrees {
                Degrees::Infinite => 0.0,
                Degrees::Finite(nu) => u.powi(4) / nu,
            })
            .sum();
        if doubt > 0.0 { Degrees::Finite(variance * variance / doubt) } else { Degrees::Infinite }
    }

    /// Coverage factor `k = t_p(nu)`: the interval of `k` standard uncertainties on both sides covers with probability
    /// `coverage`, in (0, 1) (GUM, G.3.2 and table G.2). Degrees are used as they are, not truncated to an integer.
    pub fn coverage_factor(self, coverage: f64) -> f64 {
        let upper = 0.5 + 0.5 * coverage;
        let z = || Normal::standard().inverse_cdf(upper);
        match self {
            Degrees::Finite(nu) if nu > MANY => nearly_normal(z(), nu),
            Degrees::Finite(nu) => StudentsT::new(0.0, 1.0, nu).map_or(f64::NAN, |t| t.inverse_cdf(upper)),
            Degrees::Infinite => z(),
        }
    }
}

/// Quantile of t from that of the normal law, the first terms of R. A. Fisher's and E. A. Cornish's expansion (Technometrics 2, 1960).
fn nearly_normal(z: f64, nu: f64) -> f64 {
    let terms = [
        (z.powi(3) + z) / 4.0,
        (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / 96.0,
        (3.0 * z.powi(7) + 19.0 * z.powi(5) + 17.0 * z.powi(3) - 15.0 * z) / 384.0,
    ];
    terms.into_iter().rfold(0.0, |sum, term| (sum + term) / nu) + z
}

/// Degrees beyond which the expansion has eight digits and more. The iteration for t loses digits there, and does not end beyond 1e7.
const MANY: f64 = 1e3;
