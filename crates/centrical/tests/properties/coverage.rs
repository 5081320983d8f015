//! The intervals of the exact fit cover what they say, and those of the linear fit do not.

use centrical::PairRelation;
use centrical::TypeB;
use centrical::uncertainty::Degrees;
use centrical::uncertainty::MonteCarlo;

use crate::uncertainty::{Case, STATED};

/// How far the worst parameter may be off.
struct Tolerance {
    coverage: f64,
    bias: f64,
    spread: f64,
    weighted_square: f64,
}

impl Tolerance {
    /// Five standard deviations of chance over `runs`: among 49 parameters and four figures once in ten thousand.
    fn of_chance(runs: usize) -> Self {
        let n = runs as f64;
        Self {
            coverage: 5.0 * (0.95 * 0.05 / n).sqrt(),
            bias: 5.0 / n.sqrt(),
            spread: 5.0 / (2.0 * n).sqrt(),
            weighted_square: 5.0 * (2.0 * 49.0 / n).sqrt(),
        }
    }
}

/// The figure of `monte_carlo` that is out of tolerance, if any.
fn fault(monte_carlo: &MonteCarlo, tolerance: &Tolerance) -> Option<String> {
    assert_eq!(monte_carlo.failures, 0);
    assert_eq!(monte_carlo.parameters.iter().flatten().count(), 49);
    for (j, p) in monte_carlo.parameters.iter().flatten().enumerate() {
        let (bias, spread) = (p.bias / p.stated, p.standard_deviation / p.stated);
        if (p.coverage - 0.95).abs() > tolerance.coverage {
            return Some(format!("coverage of parameter {j}: {}", p.coverage));
        }
        if bias.abs() > tolerance.bias {
            return Some(format!("bias of parameter {j}: {bias} standard uncertainties"));
        }
        if (spread - 1.0).abs() > tolerance.spread {
            return Some(format!("spread of parameter {j}: {spread} of the stated"));
        }
    }
    let mean = monte_carlo.weighted_square.mean;
    ((mean - 49.0).abs() > tolerance.weighted_square).then(|| format!("weighted squared error: {mean}"))
}

fn check(runs: usize, tolerance: &Tolerance) {
    let case = Case::new(PairRelation::Common);
    for stated in [TypeB::default(), STATED] {
        let monte_carlo = case.monte_carlo(runs, &stated, false);
        assert_eq!(fault(&monte_carlo, tolerance), None);
        if stated == TypeB::default() {
            let mean = monte_carlo.chi_squared.mean;
            // Kolmogorov's distance is beyond 2.3/sqrt(n) once in twenty thousand.
            for square in [&monte_carlo.weighted_square, &monte_carlo.chi_squared] {
                let distance = square.distance_from_chi_squared();
                assert!(distance < 2.3 / (runs as f64).sqrt(), "{distance} from chi^2");
            }
            assert!((mean - 275.0).abs() < 5.0 * (2.0 * 275.0 / runs as f64).sqrt(), "chi^2 {mean}");
        }
        let linear = case.monte_carlo(runs.min(10_000), &stated, true);
        assert!(fault(&linear, tolerance).is_some(), "the linear fit should fail");
    }
}

#[test]
fn intervals_cover() {
    const RUNS: usize = 600;
    check(RUNS, &Tolerance::of_chance(RUNS));
}

/// 95 % intervals within 0.7, bias within 0.05 sigma, the budget within 3 % of the scatter, the weighted square within
/// 0.5. Four times ten thousand runs: in ten thousand 0.7 is 3.2 standard deviations of chance, which one of 98 intervals
/// is beyond once in eight times (with this seed `dR_2[C]` is, by 0.74, and by 0.13 in forty thousand); now it is 6.4.
#[test]
#[ignore = "long: 80,000 calibrations and 20,000 linear ones"]
fn intervals_cover_over_four_times_ten_thousand_runs() {
    check(40_000, &Tolerance { coverage: 0.007, bias: 0.05, spread: 0.03, weighted_square: 0.5 });
}

/// The factor falls with the degrees of freedom, without a step, to that of the normal law; it does so at once, for any number of them.
#[test]
fn coverage_factors_of_very_many_degrees() {
    for coverage in [0.5, 0.6827, 0.95, 0.9973] {
        let normal = Degrees::Infinite.coverage_factor(coverage);
        let factors =
            (0..400).map(|n| Degrees::Finite(10_f64.powf(2.5 + 0.05 * f64::from(n))).coverage_factor(coverage));
        let factors: Vec<f64> = factors.collect();
        // The expansion from 1e3 degrees on and the iteration below have eight digits.
        assert!(factors.windows(2).all(|pair| pair[0] >= pair[1] - 1e-7), "{factors:?}");
        assert!(factors.iter().all(|factor| (factor - normal).abs() < 5e-2) && factors[399] == normal);
    }
}
