//! What a user waits for: `cargo bench -p centrical --bench observe`.

use centrical::plan::Normalised;
use centrical::{ErrorModel, MeasurementModel, Study, Weight};

fn main() {
    divan::main();
}

/// The source's experiment [K5.5] with m = 0..20: 264 plateaus, 49 unknowns, printed pair relation.
fn model() -> MeasurementModel {
    let plan = Normalised { levels: (0..=20).map(f64::from).collect(), ..Normalised::default() };
    let mut experiment = plan.experiment();
    experiment.centrifuge.speed_uncertainty = 1e-5;
    MeasurementModel::new(experiment, ErrorModel::kozlov_2017(), &[])
}

fn study() -> Study {
    let model = model();
    let weights = Weight::equal(model.experiment().set_points.len(), 1e-4);
    Study::at_zero(model, weights).expect("the experiment is complete")
}

/// Rank, null directions, correlated groups. To stay below 20 ms.
#[divan::bench]
fn observe_264_plateaus_49_parameters(bencher: divan::Bencher) {
    bencher.bench(|| {
        let study = study();
        let seen = study.observability();
        (seen.null_directions().len(), seen.correlated_groups().len())
    });
}

/// The reasons in words.
#[divan::bench]
fn reasons(bencher: divan::Bencher) {
    let study = study();
    bencher.bench(|| study.reasons());
}

/// The whole catalogue of additions.
#[divan::bench(sample_count = 10)]
fn remedies(bencher: divan::Bencher) {
    let study = study();
    bencher.bench(|| study.remedies());
}

/// The source's conditions, each with the experiment without it.
#[divan::bench(sample_count = 10)]
fn conditions(bencher: divan::Bencher) {
    let study = study();
    bencher.bench(|| study.conditions());
}
