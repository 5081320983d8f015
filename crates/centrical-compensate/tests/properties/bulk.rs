use centrical_compensate::{Compensation, Outside, Term, UnequalLengths, UnequalRows, reading};
use proptest::prelude::*;

use crate::models::{Model, everything, kozlov};

/// Readings of the model, some of them from beyond its range and one that is not a number, by axes.
fn readings(model: &Model, count: usize) -> [Vec<f64>; 3] {
    let mut columns = [const { Vec::new() }; 3];
    for k in 0..count {
        // A low-discrepancy walk through 1.01 times the range.
        let u = [0.618_034, 0.414_214, 0.732_051].map(|step: f64| 1.01 * (2.0 * (k as f64 * step).fract() - 1.0));
        let mut read = reading(&model.terms, model.at(u));
        if k == 70 {
            read[1] = f64::NAN;
        }
        for (column, f) in columns.iter_mut().zip(read) {
            column.push(f);
        }
    }
    columns
}

fn slices(f: &mut [Vec<f64>; 3]) -> [&mut [f64]; 3] {
    f.each_mut().map(Vec::as_mut_slice)
}

/// What single readings become, and which of them have no answer.
fn one_by_one(compensation: &Compensation<Vec<Term>>, f: &[Vec<f64>; 3]) -> ([Vec<f64>; 3], Outside) {
    let mut answer = f.clone();
    let mut outside = Outside::default();
    for k in 0..f[0].len() {
        let one = compensation.apply([f[0][k], f[1][k], f[2][k]]).unwrap_or_else(|_| {
            outside = Outside { count: outside.count + 1, first: outside.first.or(Some(k)) };
            [f64::NAN; 3]
        });
        for (column, f) in answer.iter_mut().zip(one) {
            column[k] = f;
        }
    }
    (answer, outside)
}

fn rows(f: &[Vec<f64>; 3]) -> Vec<[f64; 3]> {
    (0..f[0].len()).map(|k| [f[0][k], f[1][k], f[2][k]]).collect()
}

fn bits_of_rows(f: &[[f64; 3]]) -> Vec<u64> {
    (0..3).flat_map(|axis| f.iter().map(move |row| row[axis].to_bits())).collect()
}

fn bits(f: &[Vec<f64>; 3]) -> Vec<u64> {
    f.iter().flatten().map(|f| f.to_bits()).collect()
}

/// Many readings become, to the bit, what each becomes alone: in any vectors, by any number of threads.
fn bulk_is_each_alone(model: &Model, count: usize) -> Result<(), TestCaseError> {
    let compensation = Compensation::new(model.terms.clone(), model.range).unwrap();
    bulk_of(&compensation, model, count)?;
    bulk_of(&compensation.in_axes(TURNED), model, count)
}

/// A rotation, exact in binary but for its rounding.
const TURNED: [[f64; 3]; 3] = [[0.6, 0.0, -0.8], [0.0, 1.0, 0.0], [0.8, 0.0, 0.6]];

fn bulk_of(compensation: &Compensation<Vec<Term>>, model: &Model, count: usize) -> Result<(), TestCaseError> {
    let f = readings(model, count);
    let (expected, outside) = one_by_one(compensation, &f);
    let mut swept = f.clone();
    prop_assert_eq!(compensation.apply_all(slices(&mut swept)), Ok(outside));
    prop_assert!(bits(&swept) == bits(&expected));
    let mut in_place = rows(&f);
    prop_assert_eq!(compensation.apply_rows(&mut in_place), outside);
    prop_assert!(bits_of_rows(&in_place) == bits(&expected));
    let mut forces = vec![[0.0; 3]; count];
    prop_assert_eq!(compensation.apply_rows_to(&rows(&f), &mut forces), Ok(outside));
    prop_assert!(bits_of_rows(&forces) == bits(&expected));
    #[cfg(feature = "std")]
    for threads in [1, 2, 5] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut swept = f.clone();
        prop_assert_eq!(pool.install(|| compensation.apply_all_parallel(slices(&mut swept))), Ok(outside));
        prop_assert!(bits(&swept) == bits(&expected), "{threads} threads");
        let mut forces = vec![[0.0; 3]; count];
        prop_assert_eq!(pool.install(|| compensation.apply_rows_to_parallel(&rows(&f), &mut forces)), Ok(outside));
        prop_assert!(bits_of_rows(&forces) == bits(&expected), "{threads} threads");
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    #[test]
    fn fast_form(model in kozlov(), count in 0..300_usize) {
        bulk_is_each_alone(&model, count)?;
    }

    #[test]
    fn any_form(model in everything(), count in 0..300_usize) {
        bulk_is_each_alone(&model, count)?;
    }

    /// More than one task of the parallel form, and a last one that is cut short.
    #[test]
    fn several_tasks(model in kozlov(), count in 40_000..60_000_usize) {
        bulk_is_each_alone(&model, count)?;
    }
}

/// The count is that of single readings; NaN is beyond no limit.
#[test]
fn readings_beyond_limits_are_counted() {
    let rows: Vec<[f64; 3]> = (0..200_u8)
        .map(|k| match k {
            70 => [1.0, f64::NAN, -2.0],
            71 => [f64::NAN, 0.0, -3.5],
            k => [f64::from(k % 3), f64::from(k % 5) - 5.0, f64::from(k % 7) - 3.0],
        })
        .collect();
    let columns = [0, 1, 2].map(|axis| rows.iter().map(|row: &[f64; 3]| row[axis]).collect::<Vec<f64>>());
    for limit in [[2.0, 5.0, 3.0], [1.0, 5.0, 3.0], [2.0, 4.0, 3.0], [2.0, 5.0, 2.0], [f64::INFINITY; 3]] {
        let is_beyond = |row: &[f64; 3]| (0..3).any(|axis| row[axis] < -limit[axis] || row[axis] > limit[axis]);
        let expected =
            Outside { count: rows.iter().filter(|row| is_beyond(row)).count(), first: rows.iter().position(is_beyond) };
        assert_eq!(Outside::beyond(limit, columns.each_ref().map(Vec::as_slice)), Ok(expected));
    }
    let unequal = Outside::beyond([1.0; 3], [&[1.0], &[], &[1.0]]);
    assert_eq!(unequal, Err(UnequalLengths { lengths: [1, 0, 1] }));
}

#[test]
fn unequal_lengths_are_refused() {
    let compensation = Compensation::new(Vec::new(), 1.0).unwrap();
    let mut f = [vec![0.5; 4], vec![0.5; 3], vec![0.5; 4]];
    assert_eq!(compensation.apply_all(slices(&mut f)), Err(UnequalLengths { lengths: [4, 3, 4] }));
    let rows = compensation.apply_rows_to(&[[0.5; 3]; 4], &mut [[0.0; 3]; 3]);
    assert_eq!(rows, Err(UnequalRows { readings: 4, forces: 3 }));
}

/// Specific forces in other axes are those in instrument axes, turned back.
#[test]
fn other_axes_turn_the_specific_force() {
    let terms = [Term::power(0, 0, 1, 1e-3), Term::power(0, 0, 2, 2e-6), Term::power(1, 0, 1, 1e-3)];
    let instrument = Compensation::new(terms.as_slice(), 2000.0).unwrap();
    let f = [120.0, -35.0, 9.8];
    let expected = instrument.apply(f).unwrap();
    let turned = instrument.in_axes(TURNED).apply(f).unwrap();
    let back = TURNED.map(|row| (0..3).map(|j| row[j] * turned[j]).sum::<f64>());
    assert!(back.iter().zip(expected).all(|(found, f)| (found - f).abs() < 1e-13 * 120.0), "{back:?} {expected:?}");
    assert!((turned[0] - (0.6 * expected[0] + 0.8 * expected[2])).abs() < 1e-13 * 120.0);
}
