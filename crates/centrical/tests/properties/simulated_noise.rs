//! Statistics of each term of the simulated noise, against the formula that its setting promises.
//!
//! Bounds are five standard errors of the statistic under that formula, so that a wrong factor of a few percent fails
//! and no honest seed does.

use centrical::ThirdPosition::AxisOneUp;
use centrical::reduction::Record;
use centrical::simulate::{Chance, Coloured, Equipment, Machine, Recorder, Sensor, Simulation};
use centrical::{MeasurementModel, PairRelation, SetPoint};

use crate::common::{experiment, kozlov};

/// A unit at rest.
fn at_rest() -> MeasurementModel {
    let mut experiment = experiment(AxisOneUp, PairRelation::Common, &[1.0]);
    experiment.set_points = (0..6).map(|mounting| SetPoint::at_rest(mounting, 0.0)).collect();
    kozlov(experiment)
}

fn rest(seed: u64, mounting: usize, duration: f64, sensor: Sensor, recorder: Recorder) -> Record {
    let equipment = Equipment {
        machine: Machine { plateau: duration, ..Machine::default() },
        sensor,
        recorder,
        ..Equipment::default()
    };
    let (model, x) = (at_rest(), vec![0.0; 49]);
    let simulation = Simulation::new(&model, &x, &equipment, seed).unwrap();
    let level = model.reading(&model.experiment().set_points[mounting], &x);
    let mut whole = Record::default();
    for stretch in simulation.mounting(mounting).records() {
        whole.t.extend(stretch.t);
        for axis in 0..3 {
            whole.f_z[axis].extend(stretch.f_z[axis].iter().map(|f| f - level[axis]));
        }
    }
    whole
}

/// Noise alone of all three newtonometers, sampled at 100 Hz.
fn noise(seed: u64, samples: usize, sensor: Sensor) -> Record {
    rest(seed, 0, (samples as f64 - 0.5) / 100.0, sensor, Recorder::default())
}

/// Mean of `a(n) a(n + lag)`.
fn covariance(a: &[f64], lag: usize) -> f64 {
    let n = a.len() - lag;
    (0..n).map(|i| a[i] * a[i + lag]).sum::<f64>() / n as f64
}

fn assert_near(found: f64, expected: f64, standard_error: f64, what: &str) {
    assert!((found - expected).abs() < 5.0 * standard_error, "{what}: {found:e}, expected {expected:e}");
}

#[test]
fn white_noise_is_white() {
    let n = 200_000;
    let record = noise(1, n, Sensor { white: 2e-3, ..Sensor::default() });
    let root = (n as f64).sqrt();
    for f in &record.f_z {
        assert_near(covariance(f, 0), 4e-6, 4e-6 * 2.0_f64.sqrt() / root, "variance");
        for lag in [1, 2, 3, 10, 100] {
            assert_near(covariance(f, lag), 0.0, 4e-6 / root, "covariance");
        }
        let fourth = f.iter().map(|x| x.powi(4)).sum::<f64>() / n as f64;
        assert_near(fourth, 3.0 * 16e-12, 16e-12 * 96.0_f64.sqrt() / root, "fourth moment of a normal law");
        assert_near(f.iter().sum::<f64>() / n as f64, 0.0, 2e-3 / root, "mean");
    }
    let cross = (0..n).map(|i| record.f_z[0][i] * record.f_z[1][i]).sum::<f64>() / n as f64;
    assert_near(cross, 0.0, 4e-6 / root, "covariance of newtonometers");
}

#[test]
fn coloured_noise_has_its_variance_and_correlation_time() {
    let n = 1_000_000;
    let record = noise(2, n, Sensor { coloured: Coloured { deviation: 1e-3, time: 0.5 }, ..Sensor::default() });
    // Independent pieces: the duration over the correlation time of the squares' and products' sums.
    let standard_error = 1e-6 * (2.0 * 0.5 / (n as f64 / 100.0)).sqrt() * 2.0_f64.sqrt();
    for f in &record.f_z {
        for lag in [0, 1, 25, 50, 100, 400] {
            let expected = 1e-6 * (-(lag as f64) / 50.0).exp();
            assert_near(covariance(f, lag), expected, standard_error, &format!("lag {lag}"));
        }
    }
}

/// Half the mean square of the difference of neighbouring means over `m` samples (no overlap), and how many.
fn allan_variance(f: &[f64], m: usize) -> (f64, usize) {
    let means: Vec<f64> = f.chunks_exact(m).map(|chunk| chunk.iter().sum::<f64>() / m as f64).collect();
    let differences = means.windows(2).map(|pair| (pair[1] - pair[0]).powi(2));
    (differences.sum::<f64>() / (2 * (means.len() - 1)) as f64, means.len() - 1)
}

/// The Allan deviation of the bias instability is flat at `0.664 B` (IEEE Std 952), but for the octaves of correlation time
/// below 8 samples that are not simulated: white to an average of `m` samples, of variance `2 q (4 + 2 + 1 + ...) / m`.
#[test]
fn bias_instability_has_its_floor() {
    let b = 1e-4;
    let record = noise(3, 1 << 19, Sensor { bias_instability: b, ..Sensor::default() });
    let q = b * b * std::f64::consts::LN_2 / std::f64::consts::PI;
    for m in [64, 128, 256, 512, 1024, 2048] {
        let expected = 2.0 * q - 2.0 * q * 8.0 / m as f64;
        let of_axes: Vec<(f64, usize)> = record.f_z.iter().map(|f| allan_variance(f, m)).collect();
        let mean = of_axes.iter().map(|(v, _)| v).sum::<f64>() / 3.0;
        // Differences share means: 3 of 2 in the variance of their squares; and 1 % for the ripple of the octaves.
        let standard_error = expected * (2.0 * 1.5 / (3 * of_axes[0].1) as f64).sqrt();
        assert!((mean - expected).abs() < 4.0 * standard_error + 0.01 * expected, "{m}: {mean:e} of {expected:e}");
    }
}

#[test]
fn random_walk_grows_as_time() {
    let k = 1e-4;
    let record = noise(4, 1 << 19, Sensor { random_walk: k, ..Sensor::default() });
    for f in &record.f_z {
        assert_eq!(f[0], 0.0);
        let steps: Vec<f64> = f.chunks_exact(1000).map(|chunk| chunk[0]).collect();
        let increments: Vec<f64> = steps.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let expected = k * k * 10.0;
        let standard_error = expected * (2.0 / increments.len() as f64).sqrt();
        assert_near(covariance(&increments, 0), expected, standard_error, "variance in 10 s");
        assert_near(covariance(&increments, 1), 0.0, standard_error, "independent increments");
    }
}

/// One slope a record and newtonometer, of the deviation that is set.
#[test]
fn drift_is_a_slope() {
    let drift = 1e-6;
    let mut slopes = Vec::new();
    for mounting in 0..6 {
        for seed in 0..40 {
            let record = rest(seed, mounting, 100.0, Sensor { drift, ..Sensor::default() }, Recorder::default());
            for f in &record.f_z {
                slopes.push(f[10_000] / 100.0);
                assert!((f[5_000] - 0.5 * f[10_000]).abs() < 1e-12);
            }
        }
    }
    let standard_error = drift * drift * (2.0 / slopes.len() as f64).sqrt();
    assert_near(covariance(&slopes, 0), drift * drift, standard_error, "variance of the slopes");
}

#[test]
fn output_is_saturated_and_quantised() {
    let sensor = Sensor { white: 2e-3, quantum: 1e-3, range: Some(9.807), ..Sensor::default() };
    let (model, x) = (at_rest(), vec![0.0; 49]);
    let equipment = Equipment { sensor, ..Equipment::default() };
    let simulation = Simulation::new(&model, &x, &equipment, 5).unwrap();
    let record = simulation.mounting(0).records().next().unwrap();
    // Newtonometer 3 stands upright: 9.80665 m/s^2 with 2 mm/s^2 of noise against a limit at +0.35 mm/s^2.
    let saturated = record.f_z[2].iter().filter(|f| **f >= 9.807 - 1e-12).count() as f64 / record.f_z[2].len() as f64;
    // P(noise > -0.15 mm/s^2): what rounds to the limit or is cut to it.
    assert_near(saturated, 0.530, (0.25_f64 / 1001.0).sqrt(), "share at the limit");
    for f in record.f_z.iter().flatten() {
        assert!(*f <= 9.807 + 1e-12 && (f / 1e-3 - (f / 1e-3).round()).abs() < 1e-6);
    }
}

#[test]
fn spikes_come_as_often_and_as_large_as_set() {
    let spikes = Chance { probability: 2e-3, size: 10.0 };
    let recorder = Recorder { spikes, ..Recorder::default() };
    let record = rest(6, 0, 2e4, Sensor::default(), recorder);
    let n = record.t.len() as f64;
    let hit = |axis: usize| record.f_z[axis].iter().filter(|f| **f != 0.0).copied().collect::<Vec<f64>>();
    for axis in 0..3 {
        let sizes = hit(axis);
        let expected = n * 2e-3 / 3.0;
        assert_near(sizes.len() as f64, expected, expected.sqrt(), "spikes of a newtonometer");
        let standard_error = 100.0 * (2.0 / expected).sqrt();
        assert_near(covariance(&sizes, 0), 100.0, standard_error, "their mean square");
    }
    let together = (0..record.t.len()).filter(|&i| record.f_z.iter().filter(|f| f[i] != 0.0).count() > 1).count();
    assert_eq!(together, 0, "one newtonometer at a time");
}

#[test]
fn gaps_and_repeats_come_as_set() {
    let gaps = Chance { probability: 1e-3, size: 4.0 };
    let recorder = Recorder { gaps, repeats: 1e-3, ..Recorder::default() };
    let record = rest(7, 0, 2e4, Sensor { white: 1e-3, ..Sensor::default() }, recorder);
    let steps: Vec<f64> = record.t.windows(2).map(|pair| ((pair[1] - pair[0]) * 100.0).round()).collect();
    let n = 2e6;
    let repeated = steps.iter().filter(|s| **s == 0.0).count() as f64;
    assert_near(repeated, n * 1e-3, (n * 1e-3_f64).sqrt() * 1.1, "repeats");
    let lost: Vec<f64> = steps.iter().filter(|s| **s > 1.0).map(|s| s - 1.0).collect();
    assert_near(lost.len() as f64, n * 1e-3, (n * 1e-3_f64).sqrt() * 1.1, "gaps");
    let mean = lost.iter().sum::<f64>() / lost.len() as f64;
    // Geometric law of mean 4: variance 12.
    assert_near(mean, 4.0, (12.0_f64 / 2e3).sqrt(), "length of a gap");
    let twin = steps.iter().position(|s| *s == 0.0).unwrap();
    assert!(record.f_z.iter().all(|f| f[twin] == f[twin + 1]), "a repeated sample is repeated whole");
}

/// Switching one imperfection on leaves the others' draws as they were.
#[test]
fn imperfections_do_not_disturb_each_other() {
    let white = Sensor { white: 1e-3, ..Sensor::default() };
    let alone = noise(8, 1000, white);
    let with_walk = noise(8, 1000, Sensor { random_walk: 1e-5, ..white });
    let walk = noise(8, 1000, Sensor { random_walk: 1e-5, ..Sensor::default() });
    for axis in 0..3 {
        for i in 0..1000 {
            let sum = alone.f_z[axis][i] + walk.f_z[axis][i];
            assert!((with_walk.f_z[axis][i] - sum).abs() < 1e-14);
        }
    }
}
