//! What a user waits for who asks for a session: samples a second on one core.

use centrical::plan::Normalised;
use centrical::simulate::{Equipment, Simulation};
use centrical::{ErrorModel, Extension, Law, MeasurementModel};
use divan::Bencher;
use divan::counter::ItemsCount;

fn main() {
    divan::main();
}

/// One mounting of five plateaus at 1 kHz, 100 s each, with ramps: half a million samples.
fn simulate(bencher: Bencher, extensions: &[Extension], equipment: &Equipment) {
    let mut experiment = Normalised::default().experiment();
    experiment.site.latitude = Some(0.97);
    let model = MeasurementModel::new(experiment, ErrorModel::kozlov_2017(), extensions);
    let truth = Simulation::draw_truth(&model, 1.0, 1);
    let mut equipment = *equipment;
    equipment.recorder.rate = 1000.0;
    equipment.machine.plateau = 100.0;
    equipment.machine.settling = 1e-3;
    let simulation = Simulation::new(&model, &truth, &equipment, 1).expect("sound equipment");
    let mounting = simulation.mounting(0);
    let samples = mounting.records().map(|stretch| stretch.t.len()).sum::<usize>();
    bencher
        .counter(ItemsCount::new(samples))
        .bench(|| mounting.records().map(|stretch| stretch.f_z[2][0]).sum::<f64>());
}

fn noisy() -> Equipment {
    let mut equipment = Equipment::default();
    equipment.sensor.white = 2e-3;
    equipment.sensor.coloured.deviation = 1e-3;
    equipment.sensor.bias_instability = 1e-4;
    equipment.sensor.random_walk = 1e-6;
    equipment.sensor.quantum = 1e-4;
    equipment.recorder.spikes.probability = 1e-4;
    equipment.recorder.gaps.probability = 1e-3;
    equipment
}

#[divan::bench(sample_count = 10)]
fn record_of_a_perfect_sensor(bencher: Bencher) {
    simulate(bencher, &[], &Equipment::default());
}

#[divan::bench(sample_count = 10)]
fn record_with_every_noise(bencher: Bencher) {
    simulate(bencher, &[], &noisy());
}

#[divan::bench(sample_count = 10)]
fn record_with_every_noise_of_an_elastic_unit(bencher: Bencher) {
    simulate(bencher, &[Extension::ElasticTurn(Law::Speed)], &noisy());
}
