//! How long one waits for the compensation of a record in memory.

use centrical_compensate::{Compensation, Monomial, Term};
use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use rayon::prelude::*;

/// Ten minutes at 10 kHz.
const READINGS: usize = 6_000_000;
/// Readings in a task of the compensation on all threads.
const TASK: usize = 16 * 1024;

fn main() {
    divan::main();
}

/// The source's model with coefficients of ordinary size: 1e-3, 1e-5 /g, 1e-7 /g^2.
fn kozlov() -> Vec<Term> {
    let mut terms = Vec::new();
    for i in 0..3 {
        terms.push(Term::power(i, i, 0, 0.05));
        terms.extend((0..=i).map(|j| Term::power(i, j, 1, 1e-3)));
        terms.extend((0..3).map(|j| Term::power(i, j, 2, 1e-6)));
        terms.push(Term::power(i, i, 3, 1e-9));
    }
    terms
}

/// The same and a product of components: no fast form.
fn with_products() -> Vec<Term> {
    let mut terms = kozlov();
    terms.push(Term { axis: 0, monomial: Monomial::product(&[0, 1]), coefficient: 1e-6 });
    terms
}

/// Readings over 200 g.
fn readings() -> [Vec<f64>; 3] {
    [3999, 4001, 4003].map(|period| (0..READINGS).map(|k| (k % period) as f64 - 2000.0).map(|f| 0.97 * f).collect())
}

fn in_place(f: &mut [Vec<f64>; 3]) -> [&mut [f64]; 3] {
    f.each_mut().map(Vec::as_mut_slice)
}

#[divan::bench(sample_count = 40, args = ["kozlov", "with products"])]
fn one_thread(bencher: Bencher, model: &str) {
    let terms = if model == "kozlov" { kozlov() } else { with_products() };
    let compensation = Compensation::new(&terms, 2000.0).unwrap();
    let bencher = bencher.counter(ItemsCount::new(READINGS)).with_inputs(readings);
    bencher.bench_local_refs(|f| compensation.apply_all(in_place(f)).unwrap());
}

#[divan::bench(sample_count = 40)]
fn all_threads(bencher: Bencher) {
    let terms = kozlov();
    let compensation = Compensation::new(&terms, 2000.0).unwrap();
    let bencher = bencher.counter(ItemsCount::new(READINGS)).with_inputs(readings);
    bencher.bench_local_refs(|f| compensation.apply_all_parallel(in_place(f)).unwrap());
}

/// What the memory alone allows: every number of the same arrays read and written, on all threads.
#[divan::bench(sample_count = 40)]
fn reference_memory_all_threads(bencher: Bencher) {
    let factor = black_box(1.000_001);
    let bencher = bencher.counter(ItemsCount::new(READINGS)).with_inputs(readings);
    bencher.bench_local_refs(|f| {
        f.par_iter_mut().for_each(|axis| axis.par_chunks_mut(TASK).for_each(|task| scale(task, factor)));
    });
}

/// The same on one thread.
#[divan::bench(sample_count = 40)]
fn reference_memory_one_thread(bencher: Bencher) {
    let factor = black_box(1.000_001);
    let bencher = bencher.counter(ItemsCount::new(READINGS)).with_inputs(readings);
    bencher.bench_local_refs(|f| f.iter_mut().for_each(|axis| scale(axis, factor)));
}

fn scale(f: &mut [f64], factor: f64) {
    for f in f {
        *f *= factor;
    }
}

/// Rows of three, as arrays of shape `(n, 3)` have them, from one array to another.
#[divan::bench(sample_count = 40)]
fn rows_on_all_threads(bencher: Bencher) {
    let terms = kozlov();
    let compensation = Compensation::new(&terms, 2000.0).unwrap();
    let [f1, f2, f3] = readings();
    let rows: Vec<[f64; 3]> = f1.into_iter().zip(f2).zip(f3).map(|((f1, f2), f3)| [f1, f2, f3]).collect();
    let mut forces = vec![[0.0; 3]; rows.len()];
    let bencher = bencher.counter(ItemsCount::new(READINGS));
    bencher.bench_local(|| compensation.apply_rows_to_parallel(&rows, &mut forces).unwrap());
}
