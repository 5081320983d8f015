//! What a user waits for once the data are reduced: the fit.

#[path = "../tests/common/mod.rs"]
mod common;

use centrical::PairRelation;
use centrical::ThirdPosition;

fn main() {
    divan::main();
}

/// 108 plateaus of the [K5.5] experiment up to 200 g, 49 unknowns, exact model, from a start at zero.
#[divan::bench]
fn fit_49_parameters_108_plateaus(bencher: divan::Bencher) {
    let model = common::kozlov(common::experiment(ThirdPosition::AxisOneUp, PairRelation::Common, &[1.0, 0.5]));
    let truth = common::truth(&model, 1.0, &mut common::Random::new(1));
    let observations = common::observations(&model, &truth);
    bencher.bench(|| crate::common::exact(&model, &observations));
}

/// The same by the linear model [K5.3] alone.
#[divan::bench]
fn linear_fit_49_parameters_108_plateaus(bencher: divan::Bencher) {
    let model = common::kozlov(common::experiment(ThirdPosition::AxisOneUp, PairRelation::Common, &[1.0, 0.5]));
    let truth = common::truth(&model, 1.0, &mut common::Random::new(1));
    let observations = common::observations(&model, &truth);
    bencher.bench(|| crate::common::linear(&model, &observations));
}
