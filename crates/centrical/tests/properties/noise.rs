//! Noise analysis against noise of known coefficients.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};

use centrical::stability::{
    Analysis, Coefficient, Estimator, NoiseError, NoiseTerm, NoiseTerms, Phase, PowerLaw, Spectrum,
};
use centrical::{Stopped, unwatched};

use super::noise_source::Recipe;

const TAU0: f64 = 0.01;
const READINGS: usize = 12_000;
const SEEDS: usize = 60;

/// Outcomes of one term over the seeds.
#[derive(Default)]
struct Tally {
    determined: usize,
    within_two_sigma: usize,
    bound_holds: usize,
    /// Sum of the squared errors over the squared stated uncertainties.
    normalised: f64,
}

/// Outcomes of the five terms, and the number of records whose chi-squared is as it should be.
fn tally(recipe: &Recipe) -> ([Tally; 5], usize) {
    let (mut tallies, mut consistent): ([Tally; 5], usize) = Default::default();
    for seed in 0..SEEDS {
        let fit = NoiseTerms::of(&phase(recipe, READINGS, seed), &unwatched).unwrap();
        consistent += usize::from(fit.is_consistent());
        for ((tally, coefficient), truth) in tallies.iter_mut().zip(fit.coefficients).zip(recipe.coefficients()) {
            match coefficient {
                Coefficient::Determined { value, standard_uncertainty } => {
                    let error = (value - truth) / standard_uncertainty;
                    tally.determined += 1;
                    tally.within_two_sigma += usize::from(error.abs() < 2.0);
                    tally.normalised += error * error;
                }
                Coefficient::NotDetermined { upper_bound } => tally.bound_holds += usize::from(upper_bound >= truth),
            }
        }
    }
    (tallies, consistent)
}

fn phase(recipe: &Recipe, n: usize, seed: usize) -> Phase {
    Phase::integrate(&recipe.readings(n, TAU0, seed), TAU0, &unwatched).unwrap()
}

/// Most successes in `n` trials of probability `p` that come by chance once in a thousand or more often.
fn most(n: usize, p: f64) -> usize {
    let mut term = (1.0 - p).powf(n as f64);
    let (mut sum, mut k) = (term, 0);
    while sum < 0.999 {
        k += 1;
        term *= (n - k + 1) as f64 / k as f64 * p / (1.0 - p);
        sum += term;
    }
    k
}

/// Every term that stands out is found in every record and lies where its uncertainty says; no other is claimed.
///
/// Allowed by chance once in a thousand tests: results beyond two sigma (5 %) and false terms (0.3 %: 9 in chi-squared
/// is three sigma). The uncertainties allow for every other term, so where these are absent they are wide; but never
/// four times.
#[test]
fn terms_are_recovered_within_their_uncertainty_and_absent_ones_are_not_claimed() {
    let none = Recipe::default();
    let recipes = [
        Recipe { white: 1e-3, ..none },
        Recipe { random_walk: 1e-3, ..none },
        Recipe { quantisation: 1e-4, bias_instability: 1e-3, ..none },
        Recipe { white: 1e-3, bias_instability: 4e-3, ..none },
        Recipe { white: 1e-3, random_walk: 5e-3, ..none },
        Recipe { quantisation: 2e-4, white: 1e-3, random_walk: 5e-3, ramp: 8e-3, ..none },
        Recipe { white: 1e-3, ramp: 5e-4, ..none },
    ];
    for recipe in recipes {
        let (tallies, consistent) = tally(&recipe);
        assert!(SEEDS - consistent <= most(SEEDS, 0.001), "{recipe:?}: {consistent} fit");
        for ((tally, truth), term) in tallies.iter().zip(recipe.coefficients()).zip(NoiseTerm::ALL) {
            let what = format!("{term:?} of {recipe:?}");
            if truth == 0.0 {
                assert!(tally.determined <= most(SEEDS, 0.003), "{what}: claimed {} times", tally.determined);
                continue;
            }
            assert_eq!(tally.determined, SEEDS, "{what}: records that show it");
            let beyond = SEEDS - tally.within_two_sigma;
            assert!(beyond <= most(SEEDS, 0.05), "{what}: {beyond} beyond two sigma");
            assert!(tally.normalised / SEEDS as f64 > 1.0 / 16.0, "{what}: uncertainty too wide");
        }
    }
}

/// A term too weak to be found is not named, and its upper bound covers it in 95 % of the records.
#[test]
fn a_weak_term_is_bounded_not_named() {
    let weak = [
        (NoiseTerm::RandomWalk, Recipe { white: 1e-3, random_walk: 2e-4, ..Recipe::default() }),
        (NoiseTerm::BiasInstability, Recipe { white: 1e-3, bias_instability: 5e-4, ..Recipe::default() }),
    ];
    for (term, recipe) in weak {
        let tally = &tally(&recipe).0[term as usize];
        let missed = SEEDS - tally.determined - tally.bound_holds;
        assert!(tally.determined <= SEEDS / 20, "{term:?} named {} times", tally.determined);
        assert!(missed <= most(SEEDS, 0.05), "{term:?}: {missed} bounds miss");
    }
}

/// 68 % of the intervals hold the true deviation, for each noise and each estimator that converges for it.
#[test]
fn confidence_intervals_cover() {
    const LEVEL: f64 = 0.683;
    let none = Recipe::default();
    let cases = [
        (NoiseTerm::Quantisation, Recipe { quantisation: 1.0, ..none }, PowerLaw::WhitePhase),
        (NoiseTerm::White, Recipe { white: 1.0, ..none }, PowerLaw::White),
        (NoiseTerm::BiasInstability, Recipe { bias_instability: 1.0, ..none }, PowerLaw::Flicker),
        (NoiseTerm::RandomWalk, Recipe { random_walk: 1.0, ..none }, PowerLaw::RandomWalk),
    ];
    let estimators = [Estimator::Allan, Estimator::OverlappingAllan, Estimator::Total];
    for (term, recipe, law) in cases {
        for estimator in estimators {
            let mut covered = [0; 2];
            for seed in 0..4 * SEEDS {
                let found = phase(&recipe, 1024, seed).deviations(estimator, &[16, 32], LEVEL, &unwatched).unwrap();
                for (covered, point) in covered.iter_mut().zip(found) {
                    let truth = term.allan_variance(1.0, point.tau).sqrt();
                    *covered += usize::from(point.lower <= truth && truth <= point.upper);
                }
            }
            for covered in covered {
                // A wrong power law at some seeds costs a little on top of chance.
                let missed = 4 * SEEDS - covered;
                assert!(missed <= most(4 * SEEDS, 1.0 - LEVEL + 0.03), "{estimator:?}, {law:?}: {missed} missed");
                assert!(covered <= most(4 * SEEDS, LEVEL + 0.08), "{estimator:?}, {law:?}: {covered} covered");
            }
        }
    }
}

/// Degrees of freedom stated for the windowed totals of white readings, against `2 mean^2 / variance` over records.
#[test]
fn degrees_of_freedom_of_the_windowed_totals() {
    let (records, m, readings) = (400, 16, 256);
    let recipe = Recipe { white: 1.0, ..Recipe::default() };
    let phases: Vec<Phase> = (0..records).map(|seed| phase(&recipe, readings, seed)).collect();
    for estimator in [Estimator::ModifiedTotal, Estimator::HadamardTotal] {
        let values: Vec<f64> = phases.iter().map(|phase| estimator.variance(phase, m).unwrap().0).collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len() as f64;
        let observed = 2.0 * mean * mean / variance;
        let stated = estimator.degrees_of_freedom(PowerLaw::White, m, readings + 1);
        // The variance of 400 chi^2 of this freedom is itself known to sqrt((2 + 12 / edf) / 400) = 8 %.
        assert!((stated / observed - 1.0).abs() < 0.25, "{estimator:?}: observed {observed}, stated {stated}");
    }
}

#[test]
fn the_power_law_is_identified() {
    let none = Recipe::default();
    let cases = [
        (Recipe { quantisation: 1.0, ..none }, PowerLaw::WhitePhase),
        (Recipe { white: 1.0, ..none }, PowerLaw::White),
        (Recipe { bias_instability: 1.0, ..none }, PowerLaw::Flicker),
        (Recipe { random_walk: 1.0, ..none }, PowerLaw::RandomWalk),
    ];
    for (recipe, law) in cases {
        let phase = phase(&recipe, READINGS, 1);
        for estimator in [Estimator::OverlappingAllan, Estimator::OverlappingHadamard] {
            let found = phase.deviations(estimator, &[1, 4, 16, READINGS / 20], 0.683, &unwatched).unwrap();
            let (short, long) = found.split_at(3);
            assert!(short.iter().all(|d| d.law == law && d.is_identified), "{estimator:?}, {law:?}: {short:?}");
            assert!(matches!(long, [d] if !d.is_identified), "{estimator:?}, {law:?}: {long:?}");
        }
    }
}

/// Gaps of every length, a tenth of the record, leave every deviation within its interval at three sigma.
#[test]
fn gaps_do_not_move_the_deviations() {
    let recipe = Recipe { white: 1e-3, random_walk: 1e-3, ..Recipe::default() };
    let whole = recipe.readings(READINGS, TAU0, 3);
    let mut gapped = whole.clone();
    (1..READINGS).step_by(29).for_each(|k| gapped[k] = f64::NAN);
    gapped[5000..5800].fill(f64::NAN);
    let missing = gapped.iter().filter(|y| y.is_nan()).count();
    let (whole, gapped) =
        (Phase::integrate(&whole, TAU0, &unwatched).unwrap(), Phase::integrate(&gapped, TAU0, &unwatched).unwrap());
    assert_eq!(gapped.gaps().longest, 800);
    assert_eq!(gapped.gaps().missing, missing);
    for estimator in [Estimator::OverlappingAllan, Estimator::ModifiedAllan, Estimator::OverlappingHadamard] {
        let factors = whole.octaves(8);
        let expected = whole.deviations(estimator, &factors, 0.683, &unwatched).unwrap();
        let found = gapped.deviations(estimator, &factors, 0.997, &unwatched).unwrap();
        assert_eq!(expected.len(), found.len());
        for (expected, found) in expected.iter().zip(found) {
            assert!(found.lower < expected.value && expected.value < found.upper, "{estimator:?}: {found:?}");
            assert!(found.terms < expected.terms);
        }
    }
}

#[test]
fn the_spectrum_of_white_readings_is_flat_and_its_integral_the_variance() {
    let recipe = Recipe { white: 1e-3, ..Recipe::default() };
    let readings = recipe.readings(1 << 16, TAU0, 5);
    let spectrum = Spectrum::of(&readings, TAU0, 1024, &unwatched).unwrap();
    assert_eq!(spectrum.segments, 127);
    let (lower, upper) = spectrum.interval(0.95).unwrap();
    // One-sided: twice N^2. The ends of the band have half the freedom and the mean is taken off.
    let inner = &spectrum.density[2..512];
    let missed = inner.iter().filter(|s| !(*s * lower..*s * upper).contains(&2e-6)).count();
    assert!(missed <= most(inner.len(), 0.05), "{missed} of {} missed", inner.len());
    let power = spectrum.density.iter().sum::<f64>() / (1024.0 * TAU0);
    let variance = readings.iter().map(|y| y * y).sum::<f64>() / readings.len() as f64;
    // The variance of 65536 Gaussian readings is known to sqrt(2 / 65536) = 0.6 %; the tapered ends see fewer.
    assert!((power / variance - 1.0).abs() < 0.02);
}

#[test]
fn a_line_stands_at_its_frequency_with_its_power() {
    let (frequency, amplitude) = (12.5, 0.3);
    let readings: Vec<f64> =
        (0..1 << 14).map(|k| amplitude * (std::f64::consts::TAU * frequency * TAU0 * f64::from(k)).sin()).collect();
    let spectrum = Spectrum::of(&readings, TAU0, 2048, &unwatched).unwrap();
    let peak =
        (0..spectrum.density.len()).max_by(|&a, &b| spectrum.density[a].total_cmp(&spectrum.density[b])).unwrap();
    assert_eq!(spectrum.frequency[peak], frequency);
    let power = spectrum.density[peak] * spectrum.resolution;
    assert!((power / (amplitude * amplitude / 2.0) - 1.0).abs() < 1e-9);
}

/// The record reaches the estimators the same whether as readings, as phase or with time stamps.
#[test]
fn readings_phase_and_time_stamps_agree() {
    let readings = Recipe { white: 1.0, ramp: 1.0, ..Recipe::default() }.readings(500, TAU0, 2);
    let times: Vec<f64> = (0..500).map(|k| 7.0 + TAU0 * f64::from(k)).collect();
    let stamped = Analysis::of(&times, &readings, &Estimator::ALL, &unwatched).unwrap();
    let direct = Phase::integrate(&readings, TAU0, &unwatched).unwrap();
    let given = Phase::new(direct.points().to_vec(), TAU0).unwrap();
    for (estimator, of_stamped) in stamped.deviations {
        assert_eq!(estimator.variance(&direct, 8).unwrap(), estimator.variance(&given, 8).unwrap());
        let stamped = of_stamped.iter().find(|deviation| deviation.factor == 8).unwrap();
        let direct = direct.deviations(estimator, &[8], Analysis::CONFIDENCE, &unwatched).unwrap()[0].value;
        // The square is the variance.
        assert!(((direct / stamped.value).powi(2) - 1.0).abs() < 1e-9);
    }
}

#[test]
fn what_cannot_be_analysed_is_an_error() {
    assert!(NoiseTerms::of(&Phase::integrate(&[1.0; 100], TAU0, &unwatched).unwrap(), &unwatched).is_err());
    assert!(NoiseTerms::of(&Phase::integrate(&[1.0, 2.0, 3.0], TAU0, &unwatched).unwrap(), &unwatched).is_err());
    let every_other: Vec<f64> = (0..1000).map(|k| if k % 2 == 0 { f64::NAN } else { f64::from(k % 7) }).collect();
    assert_eq!(
        NoiseTerms::of(&Phase::integrate(&every_other, TAU0, &unwatched).unwrap(), &unwatched).unwrap_err().to_string(),
        "found 499 of 999 readings missing, expected at most a tenth missing in each stretch"
    );
    assert!(Spectrum::of(&[1.0; 100], TAU0, 200, &unwatched).is_err());
    assert!(Spectrum::of(&[f64::NAN; 100], TAU0, 16, &unwatched).is_err());
    let phase = Phase::integrate(&[1.0, 2.0, 3.0], TAU0, &unwatched).unwrap();
    assert!(phase.deviations(Estimator::Allan, &[1], 1.0, &unwatched).is_err());
    assert!(phase.deviations(Estimator::ModifiedTotal, &[0, 5, 99], 0.5, &unwatched).unwrap().is_empty());
}

/// Records that no noise term describes are analysed all the same, and the misfit shows in chi-squared.
#[test]
fn what_is_no_such_noise_shows_as_misfit() {
    let hum = |k: i32| (f64::from(k) * 0.3).sin() + 1e-2 * (f64::from(k) * 1.7).cos();
    let readings: Vec<f64> = (0..5000).map(hum).collect();
    assert!(
        !NoiseTerms::of(&Phase::integrate(&readings, TAU0, &unwatched).unwrap(), &unwatched).unwrap().is_consistent()
    );
}

/// Coefficients scale as their units say.
#[test]
fn coefficients_follow_the_units_of_reading_and_time() {
    let recipe = Recipe { quantisation: 2e-4, white: 1e-3, random_walk: 5e-3, ..Recipe::default() };
    let readings = recipe.readings(READINGS, TAU0, 4);
    let scaled: Vec<f64> = readings.iter().map(|y| 1e12 * y).collect();
    let fit = |readings: &[f64], tau0| {
        NoiseTerms::of(&Phase::integrate(readings, tau0, &unwatched).unwrap(), &unwatched).unwrap()
    };
    let (plain, scaled) = (fit(&readings, TAU0), fit(&scaled, 4.0 * TAU0));
    for (term, factor) in [(NoiseTerm::Quantisation, 4e12), (NoiseTerm::White, 2e12), (NoiseTerm::RandomWalk, 5e11)] {
        let (
            Coefficient::Determined { value: a, standard_uncertainty: u_a },
            Coefficient::Determined { value: b, standard_uncertainty: u_b },
        ) = (plain.coefficient(term), scaled.coefficient(term))
        else {
            panic!("{term:?} is not determined")
        };
        assert!((b / a / factor - 1.0).abs() < 1e-6 && (u_b / u_a / factor - 1.0).abs() < 1e-6, "{term:?}");
    }
}

/// A sine among white noise stands out at its frequency with its amplitude; noise alone, red or white, shows no line in
/// 200 records (expected: a fifth of one).
#[test]
fn lines_are_found_with_their_amplitude() {
    let recipe = Recipe { white: 1e-3, ..Recipe::default() };
    let mut readings = recipe.readings(16_384, TAU0, 7);
    let rate = std::f64::consts::TAU * 0.123_4;
    readings.iter_mut().enumerate().for_each(|(k, y)| *y += 5e-3 * (rate * k as f64).sin());
    let spectrum = Spectrum::of(&readings, TAU0, 2048, &unwatched).unwrap();
    let lines = spectrum.lines();
    assert_eq!(lines.len(), 1, "{lines:?}");
    assert!((lines[0].frequency * TAU0 - 0.123_4).abs() < 1.0 / 2048.0);
    // Noise of 0.01 a sample leaves an amplitude uncertain by 0.01 sqrt(2 / 16384), 2.2 %.
    assert!((lines[0].amplitude / 5e-3 - 1.0).abs() < 0.066, "{lines:?}");
    let red = Recipe { white: 1e-3, random_walk: 1e-3, ..Recipe::default() };
    let found: usize = (0..200)
        .map(|seed| {
            let recipe = if seed % 2 == 0 { &red } else { &recipe };
            Spectrum::of(&recipe.readings(8192, TAU0, 100 + seed), TAU0, 512, &unwatched).unwrap().lines().len()
        })
        .sum();
    assert!(found <= 2, "{found} lines in noise");
}

/// Bands keep the power: white noise has its density in each of them.
#[test]
fn bands_of_white_noise_have_its_density() {
    let readings = Recipe { white: 1e-3, ..Recipe::default() }.readings(65_536, TAU0, 8);
    let spectrum = Spectrum::of(&readings, TAU0, 4096, &unwatched).unwrap();
    let bands = spectrum.bands(2.0);
    assert!(bands.len() > 15 && bands.is_sorted_by(|a, b| a.0 < b.0));
    for (frequency, density) in bands.iter().filter(|(frequency, _)| *frequency > 8.0 / (4096.0 * TAU0)) {
        // One-sided: twice N^2. Some 30 segments and 4 bins and more: 15 % is three standard deviations.
        assert!((density / 2e-6 - 1.0).abs() < 0.25, "{frequency} {density}");
    }
}

/// At whichever of its questions the caller stops it, within a pass over the readings or between two.
#[test]
fn an_analysis_ends_when_it_is_stopped() {
    let n = 5000;
    let t: Vec<f64> = (0..n).map(|k| k as f64 * TAU0).collect();
    let y = Recipe { white: 1.0, ..Recipe::default() }.readings(n, TAU0, 1);
    let calls = AtomicUsize::new(0);
    let analysed = |at: usize| {
        calls.store(0, Ordering::Relaxed);
        let asked = |()| {
            let call = calls.fetch_add(1, Ordering::Relaxed) + 1;
            if call >= at { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        Analysis::of(&t, &y, &[Estimator::OverlappingAllan, Estimator::ModifiedTotal], &asked)
    };
    assert!(analysed(usize::MAX).is_ok());
    let all = calls.load(Ordering::Relaxed);
    assert!(all > 200, "{all} questions");
    for at in (1..=4).chain((5..all).step_by(all / 15)).chain([all]) {
        assert_eq!(analysed(at).err(), Some(NoiseError::Stopped(Stopped)), "question {at} of {all}");
        assert!(calls.load(Ordering::Relaxed) <= at + 1);
    }
}

/// The jump that refuses the terms of readings, if one does: its size, its time, and the averaging time.
fn jump(readings: &[f64]) -> Option<(f64, f64, f64)> {
    let t: Vec<f64> = (0..readings.len()).map(|k| 7.0 + k as f64 * TAU0).collect();
    match Analysis::of(&t, readings, &[], &unwatched).unwrap().terms {
        Err(NoiseError::Jump { size, place, time }) => Some((size, place, time)),
        _ => None,
    }
}

/// Noise that changes evenly, however slow: no jump is one in 10,000 records by chance.
#[test]
fn noise_has_no_jump() {
    let none = Recipe::default();
    let recipes = [
        Recipe { random_walk: 1e-3, ..none },
        Recipe { white: 1e-3, random_walk: 1e-3, ..none },
        Recipe { bias_instability: 1e-3, ..none },
        Recipe { white: 1e-3, bias_instability: 4e-3, ..none },
        Recipe { white: 1e-3, random_walk: 5e-3, ramp: 8e-3, ..none },
    ];
    for recipe in recipes {
        let found = (0..SEEDS).filter(|seed| jump(&recipe.readings(READINGS, TAU0, *seed)).is_some()).count();
        assert_eq!(found, 0, "{recipe:?}");
    }
}

/// A jump of twice the standard deviation of a reading, and a warm moment that fades: each was a random walk.
#[test]
fn a_jump_is_no_random_walk() {
    let recipe = Recipe { white: 1e-3, ..Recipe::default() };
    let deviation = recipe.white / TAU0.sqrt();
    for seed in 0..SEEDS {
        let readings = recipe.readings(READINGS, TAU0, seed);
        let at = READINGS / 4 + seed * READINGS / 120;
        let after = |shape: &dyn Fn(f64) -> f64| -> Vec<f64> {
            let shape = |k: usize| if k < at { 0.0 } else { deviation * shape((k - at) as f64 * TAU0) };
            readings.iter().enumerate().map(|(k, y)| y + shape(k)).collect()
        };
        let (size, place, time) = jump(&after(&|_| 2.0)).unwrap_or_else(|| panic!("seed {seed}"));
        // The larger of the means of any places within an eighth of their time.
        let sigma = deviation * (2.0 * TAU0 / time).sqrt();
        assert!((size - 2.0 * deviation).abs() < 5.0 * sigma, "seed {seed}: {size}");
        assert!((place - 7.0 - at as f64 * TAU0).abs() < 0.5 * time, "seed {seed}: {place}, {time}");
        assert!(jump(&after(&|t| 4.0 * (-t / 10.0).exp())).is_some(), "seed {seed}");
    }
}

/// Louder noise in one half of a record is no jump of its mean.
#[test]
fn a_louder_half_is_no_jump() {
    let recipe = Recipe { white: 1e-3, ..Recipe::default() };
    for seed in 0..SEEDS {
        let mut readings = recipe.readings(READINGS, TAU0, seed);
        readings[READINGS / 2..].iter_mut().for_each(|y| *y *= 2.0);
        assert_eq!(jump(&readings), None, "seed {seed}");
    }
}
