//! The tilt seen while spinning is the one of the fit, and drift is seen where it is.

use std::cell::Cell;

use centrical::PairRelation;
use centrical::ThirdPosition;
use centrical::reduction::{NoiseModel, PlateauMean, Record, ReducedMounting, ScheduledPlateau};
use centrical::simulate::{Equipment, Machine, Sensor, Simulation};
use centrical::uncertainty::{OncePerRevolution, TiltComparison};
use centrical::{Calibration, Data, MeasurementModel};
use nalgebra::Vector3;

use crate::common::{experiment, kozlov};

const SPEED_ERROR: f64 = 1e-5;

fn means(model: &MeasurementModel, truth: &[f64], seed: u64) -> Vec<PlateauMean> {
    let equipment = Equipment {
        machine: Machine { plateau: 8.0, speed_error: SPEED_ERROR, settling: 1e-3, ..Machine::default() },
        sensor: Sensor { white: 2e-3, ..Sensor::default() },
        ..Equipment::default()
    };
    let experiment = model.experiment();
    let simulation = Simulation::new(model, truth, &equipment, seed).expect("the equipment is within its bounds");
    let of_mounting = |m: usize| {
        let record = simulation.mounting(m).records().fold(Record::default(), |mut whole, stretch| {
            whole.t.extend(stretch.t);
            whole.f_z.iter_mut().zip(stretch.f_z).for_each(|(column, values)| column.extend(values));
            whole
        });
        let schedule: Vec<ScheduledPlateau> = (experiment.set_points.iter().filter(|s| s.mounting == m))
            .map(|s| ScheduledPlateau { omega: s.omega, nominal_z: experiment.nominal(s) })
            .collect();
        record.reduce(None, &schedule).unwrap_or_else(|error| panic!("{seed}, {m}: {error}"))
    };
    let reduced: Vec<ReducedMounting> = (0..experiment.mountings.len()).map(of_mounting).collect();
    let noise = NoiseModel::pool(&reduced);
    reduced.iter().flat_map(|mounting| mounting.means(&noise)).collect()
}

/// The comparison for a session whose true tilt has that size [rad]; `change` is done to every term.
fn comparison(tilt: [f64; 2], seed: u64, change: impl Fn(&mut [Vector3<f64>; 2])) -> TiltComparison {
    let model = kozlov(experiment(ThirdPosition::AxisOneDown, PairRelation::Common, &[1.0, 0.5]));
    let mut truth = Simulation::draw_truth(&model, 1.0, seed);
    truth[..2].copy_from_slice(&tilt);
    let means = means(&model, &truth, seed);
    let observations = means.iter().enumerate().map(|(set_point, mean)| mean.observation(set_point)).collect();
    let data = Data::new(&model, observations).expect("sound plateaus");
    let calibration = Calibration::exact(&data).expect("the session determines everything");
    let spins = |set_point: &usize| !model.experiment().set_points[*set_point].is_rest();
    let terms: Vec<OncePerRevolution> = (0..means.len())
        .filter(spins)
        .map(|set_point| {
            let mut quadratures = means[set_point].once_per_revolution;
            change(&mut quadratures);
            OncePerRevolution { set_point, quadratures, covariance: means[set_point].once_per_revolution_covariance }
        })
        .collect();
    calibration.tilt_while_spinning(&terms).expect("the tilt is determined")
}

/// Vibration at the rate of rotation in one plateau is that of one plateau: it is named, and left out. Where all plateaus scatter, none is,
/// and the uncertainty is that of the scatter.
#[test]
fn a_disturbed_plateau_is_left_out() {
    let tilt = [3e-4, -4e-4];
    let clean = comparison(tilt, 5, |_| ());
    assert!(clean.disturbed.is_empty(), "{clean:?}");
    let count = Cell::new(0);
    let vibrates = |nth: fn(usize) -> bool, size: f64| {
        count.set(0);
        let count = &count;
        move |quadratures: &mut [Vector3<f64>; 2]| {
            if nth(count.replace(count.get() + 1)) {
                quadratures[0].x += size;
            }
        }
    };
    for size in [0.02, 0.5] {
        let found = comparison(tilt, 5, vibrates(|n| n == 7, size));
        assert!(found.disturbed.len() == 1 && found.plateaus + 1 == clean.plateaus, "{found:?}");
        assert!((found.spinning - clean.spinning).abs() < clean.spinning_uncertainty, "{found:?}");
        assert!((found.spinning_uncertainty / clean.spinning_uncertainty - 1.0).abs() < 0.1, "{found:?}");
        assert!(found.probability > 1e-3, "{found:?}");
    }
    let found = comparison(tilt, 5, vibrates(|n| n % 2 == 0, 0.02));
    assert!(found.disturbed.is_empty() && found.scatter_probability < 1e-9, "{found:?}");
    assert!(found.spinning_uncertainty > 10.0 * clean.spinning_uncertainty, "{found:?}");
}

/// Over sessions of large, small and no tilt: both chi^2 as they should be, the Earth's rotation and the unit's errors
/// notwithstanding.
#[test]
fn the_tilt_seen_while_spinning_is_that_of_the_fit() {
    const SESSIONS: u64 = 12;
    let (mut of_difference, mut scatter, mut freedom) = (0.0, 0.0, 0.0);
    for seed in 0..SESSIONS {
        let size = [1e-3, 2e-5, 0.0][seed as usize % 3];
        let found = comparison([0.6 * size, -0.8 * size], seed, |_| ());
        if size == 1e-3 {
            assert!((found.spinning - size).abs() < 5.0 * found.spinning_uncertainty, "{found:?}");
            assert!(found.spinning_uncertainty < 0.01 * size && found.reversed < 0.05 * size, "{found:?}");
        }
        of_difference += found.chi_squared;
        scatter += found.scatter_chi_squared;
        freedom += found.plateaus as f64 - 1.0;
    }
    // chi^2 of 12 degrees is beyond 32.9 once in a thousand; the scatter's relative deviation is sqrt(2 / freedom), five
    // of them for the tails that squares of small amplitudes have.
    assert!(of_difference < 32.9, "{of_difference}");
    assert!((scatter / freedom - 1.0).abs() < 5.0 * (2.0_f64 / freedom).sqrt(), "{scatter} of {freedom}");
}

/// A tilt that only the spinning axis has, and an arm that turns the other way, do not agree.
#[test]
fn another_tilt_or_sense_of_rotation_is_seen() {
    let larger = comparison([6e-4, -8e-4], 3, |m| m.iter_mut().for_each(|part| *part *= 1.05));
    assert!(larger.probability < 1e-6, "{larger:?}");
    let backwards = comparison([6e-4, -8e-4], 3, |[_, s]| *s = -*s);
    assert!(backwards.probability < 1e-6 && backwards.reversed > 0.95e-3 && backwards.spinning < 1e-4, "{backwards:?}");
}
