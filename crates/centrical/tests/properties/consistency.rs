//! From records to parameters: the whole chain is right to its own statement.

use centrical::ThirdPosition;
use centrical::plan::Normalised;
use centrical::reduction::{NoiseModel, PlateauMean, Record, ReducedMounting, ScheduledPlateau};
use centrical::simulate::{Chance, Coloured, Equipment, Machine, Recorder, Sensor, Simulation};
use centrical::{Fit, MeasurementModel, Observation, PairRelation};
use nalgebra::{DVector, Matrix3};

use crate::common::kozlov;

/// Relative standard deviation of a plateau's speed.
const SPEED_ERROR: f64 = 1e-5;

/// White and coloured noise of a sample [m/s^2].
const WHITE: f64 = 2e-3;
const COLOURED: f64 = 1e-3;

/// Six positions at 0.55 m and 0.3 m, two rests and seven speeds up to 160 g, proof masses centimetres apart.
fn model() -> MeasurementModel {
    let arm = 0.55;
    let mut experiment = Normalised {
        third: ThirdPosition::AxisOneDown,
        pair_relation: PairRelation::Common,
        rho: Matrix3::new(0.0, 0.021, 0.015, 0.0, 0.012, -0.01, 0.0, 0.0105, -0.014) / arm,
        radii: vec![1.0, 0.3 / arm],
        levels: vec![0.0, 1.0, 2.0, 4.0, 8.0, 12.0, 16.0, 20.0],
        arm,
        gravity: 9.81262,
        ..Normalised::default()
    }
    .experiment();
    experiment.site.latitude = Some(52.1_f64.to_radians());
    experiment.centrifuge.speed_uncertainty = SPEED_ERROR;
    kozlov(experiment)
}

/// Spikes, gaps, repeated samples, coloured noise, settling, rounding: all of it in every record.
fn rough() -> Equipment {
    Equipment {
        machine: Machine {
            plateau: 14.0,
            plateau_spread: 1.0,
            ramp: 4.0,
            speed_error: SPEED_ERROR,
            settling: 5e-3,
            settling_time: 0.4,
        },
        sensor: Sensor {
            white: WHITE,
            coloured: Coloured { deviation: COLOURED, time: 0.5 },
            quantum: 1e-4,
            ..Sensor::default()
        },
        recorder: Recorder {
            rate: 250.0,
            spikes: Chance { probability: 2e-4, size: 20.0 },
            gaps: Chance { probability: 1e-3, size: 1.0 },
            repeats: 1e-4,
        },
        ..Equipment::default()
    }
}

fn record(simulation: &Simulation, mounting: usize) -> Record {
    simulation.mounting(mounting).records().fold(Record::default(), |mut whole, stretch| {
        whole.t.extend(stretch.t);
        for (column, values) in whole.f_z.iter_mut().zip(stretch.f_z) {
            column.extend(values);
        }
        whole
    })
}

/// The means of a session from its records.
fn means(model: &MeasurementModel, truth: &[f64], seed: u64) -> Vec<PlateauMean> {
    let (experiment, equipment) = (model.experiment(), rough());
    let simulation = Simulation::new(model, truth, &equipment, seed).expect("the equipment is within its bounds");
    let reduced: Vec<ReducedMounting> = (0..experiment.mountings.len())
        .map(|m| {
            let of_mounting = experiment.set_points.iter().filter(|s| s.mounting == m);
            let schedule: Vec<ScheduledPlateau> =
                of_mounting.map(|s| ScheduledPlateau { omega: s.omega, nominal_z: experiment.nominal(s) }).collect();
            record(&simulation, m).reduce(None, &schedule).unwrap_or_else(|e| panic!("session {seed}, {m}: {e}"))
        })
        .collect();
    let noise = NoiseModel::pool(&reduced);
    reduced.iter().flat_map(|mounting| mounting.means(&noise)).collect()
}

/// Calibration from plateau means, each with the covariance that `covariance` gives it.
fn calibrated(
    model: &MeasurementModel,
    means: &[PlateauMean],
    covariance: impl Fn(&PlateauMean) -> Matrix3<f64>,
) -> Fit {
    let observation = |(set_point, mean): (usize, &PlateauMean)| Observation {
        covariance: covariance(mean),
        ..mean.observation(set_point)
    };
    let observations: Vec<Observation> = means.iter().enumerate().map(observation).collect();
    crate::common::exact(model, &observations).expect("the session determines everything")
}

/// Squared error of all parameters over their stated covariance: as many as there are parameters, on average.
fn weighted_square(fit: &Fit, truth: &[f64]) -> f64 {
    let n = truth.len();
    let error = DVector::from_fn(n, |j, _| fit.value(j).expect("all are determined") - truth[j]);
    // Scaled by the standard uncertainties: they reach from 1e-6 to 1e-13.
    let u: Vec<f64> = (0..n).map(|j| fit.covariance(j, j).expect("all are determined").sqrt()).collect();
    let correlation = nalgebra::DMatrix::from_fn(n, n, |i, j| fit.covariance(i, j).expect("as above") / (u[i] * u[j]));
    let whitened = error.component_div(&DVector::from_vec(u));
    let factor = correlation.cholesky().expect("a covariance is positive definite");
    factor.l().solve_lower_triangular(&whitened).expect("no zero on its diagonal").norm_squared()
}

const SESSIONS: u64 = 12;

/// 12 sessions from records to 49 parameters: chi^2 of 588 degrees of freedom, whose mean a session scatters by
/// sqrt(2 x 49 / 12) = 2.9. The counter-test takes every sample's noise for independent.
#[test]
fn the_error_of_all_parameters_is_as_stated() {
    let model = model();
    let n = model.parameters().len();
    assert_eq!(n, 49);
    let (mut stated, mut without_colour, mut residuals) = (0.0, 0.0, 0.0);
    for seed in 0..SESSIONS {
        let truth = Simulation::draw_truth(&model, 1.0, seed);
        let means = means(&model, &truth, seed);
        let fit = calibrated(&model, &means, |mean| mean.covariance);
        let square = weighted_square(&fit, &truth);
        residuals += fit.reduced_chi_squared().expect("there is redundancy") / SESSIONS as f64;
        stated += square / SESSIONS as f64;
        let independent =
            |mean: &PlateauMean| Matrix3::identity() * ((WHITE * WHITE + COLOURED * COLOURED) / mean.samples as f64);
        let naive = weighted_square(&calibrated(&model, &means, independent), &truth);
        println!("session {seed}: {square:.1}, colour ignored {naive:.1}");
        without_colour += naive / SESSIONS as f64;
    }
    println!("mean {stated:.2} of {n}, chi^2 per degree {residuals:.3}; colour ignored: {without_colour:.1}");
    assert!((stated - 49.0).abs() < 6.0, "mean weighted squared error {stated:.2}");
    assert!(without_colour > 3.0 * 49.0, "colour ignored: {without_colour:.1}");
}
