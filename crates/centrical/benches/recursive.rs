//! One plateau's update of the recursive filter, 30 states and 3 readings, and beside it the same update in
//! covariance form (Joseph), which works with squares and so keeps half of the digits.

#[path = "../tests/common/mod.rs"]
mod common;

use centrical::ThirdPosition;
use centrical::fit::filter::{Factor, Filter, Lifetimes, Readings};
use centrical::{Calibration, Data, MeasurementModel, PairRelation};
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

fn main() {
    divan::main();
}

fn model() -> MeasurementModel {
    common::kozlov(common::experiment(ThirdPosition::AxisOneUp, PairRelation::Common, &[1.0, 0.5]))
}

fn readings(model: &MeasurementModel) -> Vec<Readings> {
    let data = common::observations(model, &common::truth(model, 1.0, &mut common::Random::new(1)));
    let set_points = &model.experiment().set_points;
    data.iter().map(|o| Readings::new(o, &model.linearise_at_zero(&set_points[o.set_point])).unwrap()).collect()
}

/// A plateau of the last position at the largest speed taken up by the source's filter.
#[divan::bench]
fn one_plateau(bencher: divan::Bencher) {
    let model = model();
    let readings = readings(&model);
    let order: Vec<usize> = (0..readings.len()).collect();
    let lifetimes = Lifetimes::new(&model, &order);
    let mut filter = Filter::new(&lifetimes);
    readings.iter().enumerate().for_each(|(place, readings)| _ = filter.update(place, readings).unwrap());
    assert_eq!(filter.carried().len(), 30);
    let last = readings.len() - 1;
    bencher.bench_local(|| filter.update(last, &readings[last]));
}

/// The rotations alone, all 30 columns full.
#[divan::bench]
fn one_update_30_states_3_readings(bencher: divan::Bencher) {
    let (columns, misfit) = full_rows();
    let mut factor = Factor::new(30);
    (0..10).for_each(|_| _ = factor.update(&columns, &misfit));
    bencher.bench_local(|| factor.update(&columns, &misfit));
}

/// `K = P A^T S^-1`, `P <- (E - K A) P (E - K A)^T + K K^T`, dense, without allocation.
#[divan::bench]
fn one_joseph_update_30_states_3_readings(bencher: divan::Bencher) {
    let (columns, misfit) = full_rows();
    let mut joseph = Joseph::new(30, &columns);
    bencher.bench_local(|| joseph.update(&misfit));
}

/// The test of a plateau: two singular value decompositions.
#[divan::bench]
fn one_innovation(bencher: divan::Bencher) {
    let model = model();
    let readings = readings(&model);
    let lifetimes = Lifetimes::new(&model, &(0..readings.len()).collect::<Vec<_>>());
    let mut filter = Filter::new(&lifetimes);
    readings.iter().enumerate().for_each(|(place, readings)| _ = filter.update(place, readings).unwrap());
    let last = readings.len() - 1;
    bencher.bench_local(|| filter.innovation(last, &readings[last]));
}

/// The iterated filter on the exact model, 49 unknowns from 108 plateaus.
#[divan::bench]
fn iterated_filter_49_parameters_108_plateaus(bencher: divan::Bencher) {
    let model = model();
    let data = common::observations(&model, &common::truth(&model, 1.0, &mut common::Random::new(1)));
    let data = Data::new(&model, data).unwrap();
    bencher.bench(|| Calibration::recursive(&data));
}

fn full_rows() -> (Vec<(usize, Vector3<f64>)>, Vector3<f64>) {
    let mut random = common::Random::new(2);
    let columns = (0..30).map(|j| (j, Vector3::from_fn(|_, _| random.normal()))).collect();
    (columns, Vector3::from_fn(|_, _| random.normal()))
}

struct Joseph {
    a: DMatrix<f64>,
    p: DMatrix<f64>,
    x: DVector<f64>,
    p_at: DMatrix<f64>,
    k: DMatrix<f64>,
    e_ka: DMatrix<f64>,
    half: DMatrix<f64>,
}

impl Joseph {
    fn new(n: usize, columns: &[(usize, Vector3<f64>)]) -> Self {
        Self {
            a: DMatrix::from_fn(3, n, |i, j| columns[j].1[i]),
            p: DMatrix::identity(n, n),
            x: DVector::zeros(n),
            p_at: DMatrix::zeros(n, 3),
            k: DMatrix::zeros(n, 3),
            e_ka: DMatrix::zeros(n, n),
            half: DMatrix::zeros(n, n),
        }
    }

    fn update(&mut self, misfit: &Vector3<f64>) {
        let a_t = self.a.transpose();
        self.p_at.gemm(1.0, &self.p, &a_t, 0.0);
        let s = &self.a * &self.p_at + Matrix3::identity();
        let s = s.fixed_view::<3, 3>(0, 0).try_inverse().unwrap();
        self.k.gemm(1.0, &self.p_at, &s, 0.0);
        let innovation = misfit - &self.a * &self.x;
        self.x.gemv(1.0, &self.k, &innovation, 1.0);
        self.e_ka.fill_with_identity();
        self.e_ka.gemm(-1.0, &self.k, &self.a, 1.0);
        self.half.gemm(1.0, &self.e_ka, &self.p, 0.0);
        self.p.gemm(1.0, &self.k, &self.k.transpose(), 0.0);
        self.p.gemm(1.0, &self.half, &self.e_ka.transpose(), 1.0);
    }
}
