//! Intervals of the deviations hold the true ones as often as they say, at every tau.

use centrical::stability::{Deviation, Estimator, Phase, PowerLaw};
use centrical::unwatched;

use super::noise_source::Recipe;

const TAU0: f64 = 0.01;
const READINGS: usize = 4000;
const COLUMNS: usize = 300;
const LEVEL: f64 = 0.683;

/// White, flicker and random-walk noise from tau0 to a quarter of the record, where few averages are left to show the law.
///
/// The truth is the mean of the variances over the columns: widths are tested here, values elsewhere. Coverage over all tau is
/// known to about 1 %, the variances at neighbouring tau being correlated; at one tau it is known to 2.7 %. The intervals take
/// variances for chi^2 distributed; with one to four degrees of freedom, at the longest tau, they hold the truth more often.
#[test]
fn intervals_cover_at_every_tau() {
    let none = Recipe::default();
    let recipes =
        [Recipe { white: 1.0, ..none }, Recipe { bias_instability: 1.0, ..none }, Recipe { random_walk: 1.0, ..none }];
    for recipe in recipes {
        let phase = |seed| Phase::integrate(&recipe.readings(READINGS, TAU0, seed), TAU0, &unwatched).unwrap();
        let phases: Vec<Phase> = (0..COLUMNS).map(phase).collect();
        for estimator in [Estimator::Allan, Estimator::OverlappingAllan, Estimator::OverlappingHadamard] {
            let found: Vec<Vec<Deviation>> = phases
                .iter()
                .map(|phase| phase.deviations(estimator, &phase.octaves(3), LEVEL, &unwatched).unwrap())
                .collect();
            let taus = found[0].len();
            assert_eq!(taus, 11);
            let mut all = 0;
            for k in 0..taus {
                let at_tau = || found.iter().map(|points| &points[k]);
                let truth = (at_tau().map(|point| point.value * point.value).sum::<f64>() / COLUMNS as f64).sqrt();
                let covered = at_tau().filter(|point| point.lower <= truth && truth <= point.upper).count();
                let share = covered as f64 / COLUMNS as f64;
                // Four standard deviations below.
                assert!(share > LEVEL - 4.0 * 0.027, "{estimator:?}, {recipe:?}, m = 2^{k}: {share}");
                // Phase noise would give the longest tau a hundred times the freedom.
                assert!(at_tau().all(|point| point.law <= PowerLaw::White), "{estimator:?}, {recipe:?}, m = 2^{k}");
                all += covered;
            }
            let share = all as f64 / (taus * COLUMNS) as f64;
            assert!((0.66..0.71).contains(&share), "{estimator:?}, {recipe:?}: {share}");
        }
    }
}

/// A law that rules longer tau only is followed: random walk below white noise, white noise below quantisation.
#[test]
fn a_change_of_the_law_is_followed() {
    let cases = [
        (Recipe { white: 1e-3, random_walk: 1e-3, ..Recipe::default() }, [PowerLaw::White, PowerLaw::RandomWalk]),
        (Recipe { quantisation: 2e-4, white: 1e-3, ..Recipe::default() }, [PowerLaw::WhitePhase, PowerLaw::White]),
    ];
    for (recipe, expected) in cases {
        for seed in 0..20 {
            let phase = Phase::integrate(&recipe.readings(65_536, TAU0, seed), TAU0, &unwatched).unwrap();
            let found = phase.deviations(Estimator::OverlappingAllan, &[1, 1024], LEVEL, &unwatched).unwrap();
            assert_eq!([found[0].law, found[1].law], expected, "{recipe:?}, {seed}");
        }
    }
}
