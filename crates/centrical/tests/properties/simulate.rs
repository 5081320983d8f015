use std::f64::consts::TAU;

use centrical::ThirdPosition::{AxisOneDown, AxisOneUp};
use centrical::reduction::Record;
use centrical::simulate::{Equipment, Machine, Recorder, Simulation, SimulationError, Tachometer};
use centrical::{
    ErrorModel, Experiment, Extension, Group, MeasurementModel, PairRelation, Parameter, SetPoint, Site, rotation,
};
use nalgebra::Vector3;

use crate::common::{Random, everything, experiment, kozlov, truth};

/// The whole record of a mounting.
fn record(simulation: &Simulation, mounting: usize) -> Record {
    simulation.mounting(mounting).records().fold(Record::default(), |mut whole, stretch| {
        whole.t.extend(stretch.t);
        for (column, values) in whole.f_z.iter_mut().zip(stretch.f_z) {
            column.extend(values);
        }
        whole
    })
}

fn row(record: &Record, n: usize) -> Vector3<f64> {
    Vector3::from_fn(|axis, _| record.f_z[axis][n])
}

/// The experiment with the latitude at which the plumb line's Earth rate is what the tilted axis has.
fn at_latitude_of_the_axis(mut experiment: Experiment, tilt: [f64; 2]) -> Experiment {
    let latitude = experiment.site.latitude.unwrap();
    let rate = rotation(&Vector3::new(tilt[0], tilt[1], 0.0)) * Vector3::new(0.0, latitude.cos(), latitude.sin());
    experiment.site.latitude = Some(rate.z.asin());
    experiment
}

/// The mean over whole revolutions of a perfect sensor's record is the plateau model's reading, to rounding, with
/// every extension and further terms, both ways round and at rest.
#[test]
fn mean_of_a_record_is_the_reading() {
    const STEPS: usize = 16;
    let mut random = Random::new(21);
    for (third, sense) in [(AxisOneUp, 1.0), (AxisOneDown, -1.0)] {
        let full = everything(experiment(third, PairRelation::Opposite, &[1.0, 0.5]));
        let mut x = truth(&full, 1.0, &mut random);
        while let Some(parameter) = full.of_history(&x) {
            x[full.parameters().find(&parameter.name).unwrap()] = 0.0;
        }
        // The scale of a mounting acts on all of the nominal force, a thousandth of what it knows wrongly of the rate of the Earth: 1e-9 m/s^2.
        let scales = full.parameters().iter().enumerate().filter(|(_, p)| p.group == Group::MountingScale);
        scales.for_each(|(j, _)| x[j] = 0.0);
        for set_point in full.experiment().set_points.iter().step_by(3) {
            let set_point = SetPoint { omega: sense * set_point.omega, ..*set_point };
            let mut one = full.experiment().clone();
            one.set_points = vec![set_point];
            // A second angle of rest, whose tilt differs, is not in it.
            let simulated = everything(one.clone());
            let value = |parameter: &Parameter| x[full.parameters().find(&parameter.name).unwrap()];
            let x: Vec<f64> = simulated.parameters().iter().map(value).collect();
            let rate = if set_point.is_rest() { 100.0 } else { STEPS as f64 * set_point.omega.abs() / TAU };
            let equipment = Equipment {
                machine: Machine { plateau: 40.5 / rate, ..Machine::default() },
                recorder: Recorder { rate, ..Recorder::default() },
                ..Equipment::default()
            };
            let record = record(&Simulation::new(&simulated, &x, &equipment, 5).unwrap(), set_point.mounting);
            assert_eq!(record.t.len(), 41);
            let mean = (0..2 * STEPS).map(|n| row(&record, n)).sum::<Vector3<f64>>() / (2 * STEPS) as f64;
            let expected = everything(at_latitude_of_the_axis(one, [x[0], x[1]])).reading(&set_point, &x);
            // The periodic Coriolis term times the tilt through the squares: 1e-5 /g of (300 ug)^2, below 1e-11 m/s^2.
            let error = (mean - expected).amax();
            // Effects on the nominal force know the rate of the Earth along the plumb line: 1e-12 of the reading.
            assert!(error <= 1e-11 * expected.amax() + 1e-11, "{set_point:?}: {error:e} of {:e}", expected.amax());
        }
    }
}

/// At rest an instant has the tilt of its angle, where no latitude is stated the Earth's rotation is that of the unknown, and speeds are off by
/// their offset.
#[test]
fn an_instant_has_tilts_by_angle_the_earth_rate_and_the_offset_of_speeds() {
    const STEPS: u8 = 4;
    let mut without_latitude = experiment(AxisOneUp, PairRelation::Common, &[1.0]);
    without_latitude.site.latitude = None;
    let extensions = [Extension::AngleTilt, Extension::EarthRate, Extension::SpeedOffset];
    let model = MeasurementModel::new(without_latitude, ErrorModel::kozlov_2017(), &extensions);
    let mut x = vec![0.0; model.parameters().len()];
    let values = [("angle_tilt_1[2]", 3e-3), ("angle_tilt_2[2]", -2e-3), ("earth_rate", 5e-5), ("speed_offset", -1e-3)];
    for (name, value) in values {
        x[model.parameters().find(name).unwrap()] = value;
    }
    for s in &model.experiment().set_points {
        let steps = if s.is_rest() { 1 } else { STEPS };
        let at = |step: u8| {
            let angle = s.angle + TAU * f64::from(step) / f64::from(STEPS);
            model.reading_at(s.mounting, &x, [angle, s.omega, 0.0])
        };
        let mean = (0..steps).map(at).sum::<Vector3<f64>>() / f64::from(steps);
        assert!((mean - model.reading(s, &x)).amax() < 1e-10, "{s:?}: {mean}");
    }
}

/// What the plateau model leaves out by taking the Earth rate along the plumb line: for a tilt of a milliradian
/// below half a microgravity up to 200 g, and there.
#[test]
fn earth_rate_along_the_tilted_axis_is_below_half_a_ug() {
    let model = kozlov(experiment(AxisOneUp, PairRelation::Common, &[1.0]));
    let mut x = vec![0.0; 49];
    x[0] = 1e-3;
    let corrected = kozlov(at_latitude_of_the_axis(model.experiment().clone(), [x[0], 0.0]));
    let difference = |s: &SetPoint| (model.reading(s, &x) - corrected.reading(s, &x)).amax();
    let worst = model.experiment().set_points.iter().map(difference).fold(0.0, f64::max);
    assert!((0.1e-5..0.5e-5).contains(&worst), "{worst} m/s^2");
}

/// Reference-frame kinematics, derived apart: the place of each proof mass in Earth-fixed axes, differentiated
/// twice by differences, with gravity's reaction and the Coriolis acceleration there.
#[test]
fn reading_at_an_instant_is_newton_in_the_reference_frame() {
    let mut random = Random::new(22);
    let model = kozlov(experiment(AxisOneUp, PairRelation::Common, &[1.0]));
    let mut x = truth(&model, 30.0, &mut random);
    x[28..].fill(0.0); // a perfect unit: f' = f
    let experiment = model.experiment();
    let angle = |t: f64| 0.7 + 31.0 * t + 12.0 * t * t;
    for (m, mounting) in experiment.mountings.iter().enumerate() {
        let turn = 2 + 3 * mounting.position;
        let shift = 20 + 2 * (mounting.position / 2);
        let b_zy =
            rotation(&Vector3::new(x[turn], x[turn + 1], x[turn + 2])) * experiment.positions[mounting.position].p_zy;
        let mut rho = experiment.unit.rho_z;
        rho[(1, 1)] += x[26];
        rho[(2, 2)] += x[27];
        let r0 = mounting.arm_y + Vector3::new(x[shift], x[shift + 1], 0.0);
        let c_yx = |t: f64| rotation(&(Vector3::z() * angle(t))) * rotation(&Vector3::new(x[0], x[1], 0.0));
        let expected = Vector3::from_fn(|i, _| {
            let r_y = r0 + b_zy.transpose() * rho.column(i);
            let place = |t: f64| c_yx(t).transpose() * r_y;
            specific_force(&place, experiment).dot(&(b_zy * c_yx(0.0)).row(i).transpose())
        });
        let found = model.reading_at(m, &x, [angle(0.0), 31.0, 24.0]);
        let error = (found - expected).amax();
        // Truncation: sixth derivative of the circle over 90, Omega^6 r h^4 / 90; rounding 8 eps r / h^2. h = 3e-4.
        assert!(error < 2e-7 * found.amax(), "mounting {m}: {error:e} of {:e}", found.amax());
        let without_acceleration = model.reading_at(m, &x, [angle(0.0), 31.0, 0.0]);
        assert!((found - without_acceleration).amax() > 0.1, "the tangential part has been seen");
    }
}

/// Acceleration in Earth-fixed axes, with the Coriolis term of their rotation, less gravity, at time 0.
fn specific_force(place: &dyn Fn(f64) -> Vector3<f64>, experiment: &Experiment) -> Vector3<f64> {
    let h = 3e-4;
    let sum = |n: f64| place(n * h) + place(-n * h);
    let odd = |n: f64| place(n * h) - place(-n * h);
    let acceleration = (16.0 * sum(1.0) - sum(2.0) - 30.0 * place(0.0)) / (12.0 * h * h);
    let velocity = (8.0 * odd(1.0) - odd(2.0)) / (12.0 * h);
    let latitude = experiment.site.latitude.unwrap();
    let earth = Vector3::new(0.0, latitude.cos(), latitude.sin()) * Site::EARTH_RATE;
    acceleration + 2.0 * earth.cross(&velocity) + Vector3::z() * experiment.site.gravity
}

/// A schedule with everything in it: rests at several angles between speeds up and down, both ways round.
fn tour(sense: f64) -> MeasurementModel {
    let mut experiment = experiment(AxisOneUp, PairRelation::Common, &[1.0]);
    let stops = [(0.0, 0.3), (14.0, 0.0), (31.0, 0.0), (0.0, 2.9), (0.0, 6.0), (9.0, 0.0), (0.0, 1.2)];
    experiment.set_points = stops
        .iter()
        .map(|&(omega, angle)| SetPoint { mounting: 0, omega: sense * omega, angle, ..SetPoint::default() })
        .collect();
    kozlov(experiment)
}

fn rough_machine() -> Machine {
    Machine { plateau: 3.0, plateau_spread: 1.0, speed_error: 1e-3, settling: 0.01, ..Machine::default() }
}

/// After every ramp to rest the arm stands at the angle that was set, whatever the settling and speed errors before.
#[test]
fn the_arm_stops_at_the_angle_set() {
    let mut random = Random::new(23);
    for sense in [1.0, -1.0] {
        let model = tour(sense);
        let x = truth(&model, 1.0, &mut random);
        let equipment = Equipment { machine: rough_machine(), ..Equipment::default() };
        let simulation = Simulation::new(&model, &x, &equipment, 8).unwrap();
        let (record, plateaus) = (record(&simulation, 0), simulation.mounting(0).plateaus());
        assert_eq!(plateaus.len(), 7);
        let timed = plateaus.iter().zip(&model.experiment().set_points);
        for (([from, to], _), set_point) in timed.filter(|(_, s)| s.is_rest()) {
            let inside = |t: f64| t > from + 1e-6 && t < to - 1e-6;
            let rows: Vec<usize> = (0..record.t.len()).filter(|&n| inside(record.t[n])).collect();
            assert!(rows.len() > 290);
            for &n in &rows {
                let error = (row(&record, n) - model.reading(set_point, &x)).amax();
                assert!(error < 1e-12, "{set_point:?} at {} s: {error:e}", record.t[n]);
            }
        }
    }
}

/// Plateaus last what they should, hold the speeds they say once settled, and the speed never jumps.
#[test]
fn plateaus_are_where_the_truth_says() {
    let model = tour(1.0);
    let x = vec![0.0; 49];
    let tachometer = Tachometer { rate: 1000.0, ..Tachometer::default() };
    let equipment = Equipment { machine: rough_machine(), tachometer, ..Equipment::default() };
    let simulated = Simulation::new(&model, &x, &equipment, 9).unwrap().mounting(0);
    let (plateaus, telemetry) = (simulated.plateaus(), simulated.telemetry());
    for pair in plateaus.windows(2) {
        assert!((pair[1].0[0] - pair[0].0[1] - 4.0).abs() < 1e-9, "a ramp lasts 4 s");
    }
    assert_eq!(simulated.duration(), plateaus[6].0[1]);
    for (&([start, end], omega), set_point) in plateaus.iter().zip(&model.experiment().set_points) {
        let error = omega - set_point.omega;
        assert!(error.abs() < 5e-3 * set_point.omega + 1e-12 && (set_point.is_rest() || error != 0.0));
        // Before a rest up to a revolution longer.
        assert!((3.0..4.0 + TAU / 9.0).contains(&(end - start)));
        let settled = start.midpoint(end);
        let left = 0.01 * (-(settled - start) / 0.4_f64).exp();
        let n = telemetry.t.partition_point(|t| *t < settled);
        // The tachometer believes the set point.
        assert!((telemetry.omega[n] - set_point.omega * (1.0 + left)).abs() < 1e-4 * set_point.omega + 1e-12);
    }
    let jumps = telemetry.omega.windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0, f64::max);
    // The steepest: 31 rad/s in 4 s along the cubic is 1.5 31 / 4 rad/s^2; a speed error of 1e-3 is 0.03 rad/s more.
    assert!(jumps < 1e-3 * 1.5 * 31.1 / 4.0 + 31.0 * 3e-3, "{jumps} rad/s");
}

/// The telemetry's clock is off by an offset and a rate, as it says.
#[test]
fn the_clocks_are_not_synchronised() {
    let model = tour(1.0);
    let x = vec![0.0; 49];
    let tachometer = Tachometer {
        clock_offset: 2.0,
        clock_drift: 1e-4,
        quantum: 1e-2,
        noise: 0.1,
        rate: 20.0,
        ..Tachometer::default()
    };
    let equipment = Equipment { machine: rough_machine(), tachometer, ..Equipment::default() };
    let simulation = Simulation::new(&model, &x, &equipment, 10).unwrap();
    let telemetry = simulation.mounting(0).telemetry();
    let [offset, drift] = simulation.mounting(0).clock();
    assert!(offset.abs() <= 2.0 && offset != 0.0 && drift.abs() < 5e-4 && drift != 0.0);
    for (n, t) in telemetry.t.iter().enumerate() {
        assert!((t - (offset + (1.0 + drift) * n as f64 / 20.0)).abs() < 1e-12);
    }
    let on_grid = |omega: &f64| ((omega / 1e-2).round() * 1e-2 - omega).abs() < 1e-12;
    assert!(telemetry.omega.iter().all(on_grid));
    let resting = &telemetry.omega[..55]; // below 3 s
    let rms = (resting.iter().map(|o| o * o).sum::<f64>() / 55.0).sqrt();
    assert!((0.06..0.14).contains(&rms), "{rms}, four standard errors about 0.1");
    assert_ne!(simulation.mounting(1).clock()[0], offset, "every mounting anew");
}

/// A unit that is turned by the load reads, once settled, what the plateau model says: the deformed branch.
#[test]
fn deformations_follow_the_speed() {
    let mut random = Random::new(24);
    let model = everything(tour(1.0).experiment().clone());
    let x = truth(&model, 1.0, &mut random);
    for (speed, angle) in [(12.0, 0.4), (55.0, 3.0)] {
        let reading = model.reading_at(0, &x, [angle, speed, 0.0]);
        let mut stiff = x.clone();
        let named = |name: &str| model.parameters().iter().position(|p| p.name == name).unwrap();
        stiff[named("elastic_speed_2[1]")] = 0.0;
        let size = x[named("elastic_speed_2[1]")] * speed * speed;
        // Turned about axis 2, newtonometers 1 and 3 see each other's force.
        let effect = reading - model.reading_at(0, &stiff, [angle, speed, 0.0]);
        assert!((effect.z / (size * reading.x)).abs() > 0.9 && (effect.z / (size * reading.x)).abs() < 1.1);
    }
}

/// The same seed gives the same record from any thread; another seed another one; and no two mountings alike.
#[test]
fn records_follow_from_the_seed() {
    let model = kozlov(experiment(AxisOneUp, PairRelation::Common, &[1.0]));
    let x = vec![0.0; 49];
    let mut equipment = Equipment { machine: rough_machine(), ..Equipment::default() };
    equipment.sensor.white = 1e-3;
    equipment.sensor.bias_instability = 1e-4;
    let simulation = |seed| Simulation::new(&model, &x, &equipment, seed).unwrap();
    let first = record(&simulation(1), 2);
    let from_thread = std::thread::scope(|scope| scope.spawn(|| record(&simulation(1), 2)).join().unwrap());
    assert_eq!(first, from_thread);
    assert_ne!(first.f_z[0], record(&simulation(2), 2).f_z[0]);
    assert_ne!(first.f_z[0][..100], record(&simulation(1), 3).f_z[0][..100]);
    assert_ne!(first.f_z[0][..100], first.f_z[1][..100]);
}

/// What cannot be simulated is refused by name.
#[test]
fn nonsense_is_refused() {
    let model = kozlov(experiment(AxisOneUp, PairRelation::Common, &[1.0]));
    let refusal = |x: &[f64], equipment: &Equipment| Simulation::new(&model, x, equipment, 1).unwrap_err().to_string();
    let perfect = Equipment::default();
    assert_eq!(
        Simulation::new(&model, &[0.0; 3], &perfect, 1).unwrap_err(),
        SimulationError::TruthLength { found: 3, expected: 49 }
    );
    let mut x = vec![0.0; 49];
    x[2] = f64::NAN;
    assert_eq!(refusal(&x, &perfect), "truth of delta_1[1]: found NaN, expected a finite number");
    x[2] = 0.0;
    let mut equipment = perfect;
    equipment.recorder.rate = 0.0;
    assert_eq!(refusal(&x, &equipment), "recorder.rate: found 0, expected a rate above 0, from 1 mHz to 10 MHz");
    let mut equipment = perfect;
    equipment.recorder.gaps.size = 0.5;
    assert_eq!(
        refusal(&x, &equipment),
        "recorder.gaps.length: found 0.5, expected a number of samples, 1 to a million"
    );
    let mut equipment = perfect;
    equipment.recorder.spikes.probability = 1.0;
    assert_eq!(refusal(&x, &equipment), "recorder.spikes.probability: found 1, expected 0 or more and below 1");
}
