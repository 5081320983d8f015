//! Simulated rests in attitudes of their own: the physics against the model, and what the reduction finds of them.

use centrical::ThirdPosition::AxisOneUp;
use centrical::reduction::{Record, Rests};
use centrical::simulate::{Chance, Coloured, Equipment, Hand, Sensor, SimulatedTumble, Simulation};
use centrical::{Experiment, MeasurementModel, Mounting, PairRelation, Position, SetPoint, unwatched};
use nalgebra::Vector3;

use crate::common::{experiment, kozlov};

/// A hand that trembles, knocks and takes its time.
const HAND: Hand = Hand {
    rests: 22,
    rest: 3.0,
    rest_spread: 2.0,
    turn: 0.8,
    turn_spread: 1.0,
    shake: 1.0,
    tremor: Coloured { deviation: 1e-3, time: 0.3 },
    bumps: Chance { probability: 0.1, size: 3.0 },
    bias_change: 5e-3,
};

/// The arm of the usual experiment, and `count` rests, every second one in an attitude that is known.
fn with_rests(count: usize, seed: u64) -> Experiment {
    let mut experiment = experiment(AxisOneUp, PairRelation::Common, &[1.0]);
    for (n, up) in Simulation::draw_attitudes(count, seed, 0).iter().enumerate() {
        let (id, mounting) = (format!("r{}", n + 1), experiment.mountings.len());
        experiment.mountings.push(Mounting { position: experiment.positions.len(), arm_y: Vector3::zeros() });
        let known = Position::known(id.clone(), up, 2e-3);
        experiment.positions.push(if n % 2 == 0 { Position::free(id, up) } else { known });
        experiment.set_points.push(SetPoint::at_rest(mounting, 0.0));
    }
    experiment
}

fn rests(model: &MeasurementModel) -> Vec<SetPoint> {
    let experiment = model.experiment();
    experiment.set_points.iter().filter(|s| !experiment.is_on_arm(s.mounting)).copied().collect()
}

fn tumble<'a>(simulation: &Simulation<'a>, model: &MeasurementModel) -> SimulatedTumble<'a> {
    simulation.tumble(model.experiment().mountings_on_arm().count()..model.experiment().mountings.len())
}

fn record(tumble: &SimulatedTumble) -> Record {
    tumble.records().fold(Record::default(), |mut whole, stretch| {
        whole.t.extend(stretch.t);
        whole.f_z.iter_mut().zip(stretch.f_z).for_each(|(column, values)| column.extend(values));
        whole
    })
}

/// Without noise and tremor every sample of a rest is the reading of the model and the change of the bias; a unit without
/// errors reads the size of gravity in the turns too.
#[test]
fn a_rest_reads_what_the_model_says() {
    let model = kozlov(with_rests(9, 3));
    let hand = Hand { tremor: Coloured::default(), bumps: Chance::default(), shake: 0.0, ..HAND };
    let equipment = Equipment { hand, ..Equipment::default() };
    let truth = Simulation::draw_truth(&model, 1.0, 3);
    let simulation = Simulation::new(&model, &truth, &equipment, 3).unwrap();
    let change = simulation.bias_change(model.experiment().mountings.len() - 1);
    assert!(change.iter().all(|change| *change != 0.0));
    let (tumble_made, set_points) = (tumble(&simulation, &model), rests(&model));
    let (made, samples) = (tumble_made.rests(), record(&tumble_made));
    assert_eq!(made.len(), 9);
    for (([from, to], up_z), set_point) in made.iter().zip(&set_points) {
        let expected = model.reading(set_point, &truth) + change;
        let gravity = model.experiment().site.gravity;
        assert!((up_z * gravity - model.specific_force(set_point, &truth)).amax() < 1e-13);
        let within = samples.t.iter().enumerate().filter(|(_, t)| (from..to).contains(t));
        let mut count = 0;
        for (n, _) in within {
            // Some 30 products of numbers up to 10.
            assert!((0..3).all(|axis| (samples.f_z[axis][n] - expected[axis]).abs() < 1e-13), "{n}");
            count += 1;
        }
        assert!((300..=500).contains(&count), "{count}");
    }
    let perfect = vec![0.0; truth.len()];
    let alone = Equipment { hand: Hand { bias_change: 0.0, ..hand }, ..equipment };
    let simulation = Simulation::new(&model, &perfect, &alone, 3).unwrap();
    let samples = record(&tumble(&simulation, &model));
    for n in 0..samples.t.len() {
        let size = (0..3).map(|axis| samples.f_z[axis][n].powi(2)).sum::<f64>().sqrt();
        assert!((size - model.experiment().site.gravity).abs() < 1e-13, "{size}");
    }
}

/// The reduction finds the rests that were made, and their means are the readings of the model within their covariance: tremor
/// and noise, a tenth of the rests bumped.
#[test]
fn the_means_of_simulated_rests_are_as_uncertain_as_stated() {
    const RECORDS: u64 = 20;
    let sensor = Sensor { white: 0.01, coloured: Coloured { deviation: 2e-3, time: 0.2 }, ..Sensor::default() };
    let equipment = Equipment { hand: HAND, sensor, ..Equipment::default() };
    let (mut squares, mut count) = (0.0, 0.0);
    for seed in 0..RECORDS {
        let model = kozlov(with_rests(22, seed));
        let truth = Simulation::draw_truth(&model, 1.0, seed);
        let simulation = Simulation::new(&model, &truth, &equipment, seed).unwrap();
        let tumble = tumble(&simulation, &model);
        let (made, samples) = (tumble.rests(), record(&tumble));
        let found = Rests::of(&[(samples.as_slice(), None)], &unwatched).unwrap().means.concat();
        // A bump may part one rest in two.
        assert!((22..=26).contains(&found.len()), "{seed}: {}", found.len());
        for rest in &found {
            let is_within = |made: &[f64; 2]| rest.window[0] > made[0] - 0.1 && rest.window[1] < made[1] + 0.1;
            let n = made.iter().position(|made| is_within(&made.0)).expect("a rest that was made");
            let set_point = rests(&model)[n];
            let expected = model.reading(&set_point, &truth) + simulation.bias_change(set_point.mounting);
            let error = rest.mean - expected;
            squares += error.dot(&rest.covariance.cholesky().unwrap().solve(&error));
            count += 3.0;
        }
    }
    let mean = squares / count;
    // Of a mean of squares four standard deviations, and a tenth for weights that are estimates themselves.
    assert!((mean - 1.0).abs() < 4.0 * (2.0 / count).sqrt() + 0.1, "{mean}");
}

/// Rests leave the draws of the unit and the arm as they were, and one imperfection of a hand those of the others.
#[test]
fn each_imperfection_has_draws_of_its_own() {
    let (without, with) = (kozlov(with_rests(0, 7)), kozlov(with_rests(9, 7)));
    let (alone, both) = (Simulation::draw_truth(&without, 1.0, 7), Simulation::draw_truth(&with, 1.0, 7));
    for (parameter, value) in without.parameters().iter().zip(&alone) {
        assert_eq!(both[with.parameters().find(&parameter.name).unwrap()], *value, "{}", parameter.name);
    }
    // A known attitude errs by its uncertainty even if nothing else errs.
    let known = with.parameters().find("theta_1[r2]").unwrap();
    let (exact, free) = (Simulation::draw_truth(&with, 0.0, 7), with.parameters().find("theta_1[r1]").unwrap());
    assert!(exact[known] != 0.0 && exact[known].abs() < 0.01 && exact[free] == 0.0);
    let noisy = Sensor { white: 0.01, ..Sensor::default() };
    let steady =
        Equipment { hand: Hand { tremor: Coloured::default(), ..HAND }, sensor: noisy, ..Equipment::default() };
    let trembling = Equipment { hand: HAND, ..steady };
    let windows = |equipment: &Equipment| {
        let simulation = Simulation::new(&with, &both, equipment, 7).unwrap();
        tumble(&simulation, &with).rests().iter().map(|(window, _)| *window).collect::<Vec<_>>()
    };
    assert_eq!(windows(&steady), windows(&trembling));
}
