//! Steady stretches of a signal, without its schedule.

use centrical::reduction::{Staircase, SteadyStretch};
use centrical::unwatched;

use crate::common::Random;

/// A staircase with ramps, settling and noise: as many stretches as it has, each where it is, within five standard uncertainties.
#[test]
fn stretches_of_a_noisy_staircase() {
    for seed in 0..20 {
        let mut random = Random::new(seed);
        let set = [0.0, 14.0, 19.8, 28.0, 62.65, 0.0];
        let (mut t, mut y) = (Vec::new(), Vec::new());
        let mut now = 0.0;
        let (noise, rate) = (1e-3, 20.0);
        for (n, &level) in set.iter().enumerate() {
            let before = if n == 0 { level } else { set[n - 1] };
            let (ramp, stay) = (if n == 0 { 0.0 } else { 6.0 }, 10.0 + random.below(20) as f64);
            let start = now;
            while now < start + ramp + stay {
                let part = ((now - start) / ramp).min(1.0);
                let settling = if part < 1.0 { 0.0 } else { 1e-3 * level * (-(now - start - ramp) / 0.4).exp() };
                let ideal = if n == 0 { level } else { before + part * (level - before) };
                t.push(now);
                y.push(ideal + settling + noise * random.normal());
                now += 1.0 / rate;
            }
        }
        let found = SteadyStretch::all(&t, &y);
        assert_eq!(Staircase::of(&t, &y, &unwatched).unwrap().map(|s| s.stretches), Some(set.len()));
        assert_eq!(found.len(), set.len(), "seed {seed}: {found:?}");
        for (stretch, set) in found.iter().zip(set) {
            assert!(stretch.window[1] - stretch.window[0] > 8.0, "{stretch:?}");
            let sigma = stretch.standard_uncertainty.max(noise / 20.0);
            assert!((stretch.value - set).abs() < 5.0 * sigma, "seed {seed}: {stretch:?} is not {set}");
        }
    }
}

/// Nothing stands still in a ramp, and nothing is found in nothing.
#[test]
fn no_stretches() {
    let t: Vec<f64> = (0..2000).map(|n| f64::from(n) * 0.05).collect();
    assert!(SteadyStretch::all(&t, &t).is_empty());
    assert!(SteadyStretch::all(&[], &[]).is_empty());
    assert!(SteadyStretch::all(&t[..3], &[1.0; 3]).is_empty());
}

/// White noise, a random walk, a drift and a sine about zero are not staircases.
#[test]
fn noise_is_no_staircase() {
    for seed in 0..20 {
        let mut random = Random::new(100 + seed);
        let t: Vec<f64> = (0..30_000).map(|n| f64::from(n) * 0.01).collect();
        let mut walk = 0.0;
        let white: Vec<f64> = t.iter().map(|_| random.normal()).collect();
        let mut step = || {
            walk += random.normal();
            walk
        };
        let walked: Vec<f64> = t.iter().map(|_| step()).collect();
        let sine: Vec<f64> = t.iter().zip(&white).map(|(t, w)| 30.0 * (t / 7.0).sin() + w).collect();
        let drift: Vec<f64> = t.iter().zip(&white).map(|(t, w)| 9.8 + 1e-3 * (w + t / 10.0)).collect();
        for (name, y) in [("white", white), ("walk", walked), ("sine", sine), ("drift", drift)] {
            assert_eq!(Staircase::of(&t, &y, &unwatched).unwrap(), None, "{name}, seed {seed}");
        }
    }
}
