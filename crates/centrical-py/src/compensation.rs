//! Readings to specific force by rows, on all threads where there are many.

use centrical_compensate::{Compensation, Term};
use centrical_session::OutputSummary;
use rayon::prelude::*;

/// Rows that are quicker one by one than as vectors.
const FEW: usize = 4;

/// Rows in a task.
const TASK: usize = 16 * 1024;

/// An owned compensation: certified once, used in every call.
pub type Owned = Compensation<Vec<Term>>;

/// Compensates `readings` into `forces`, of one length; the number of readings that are numbers and that no force gives. Readings in
/// the unit of an `output` are taken to m/s^2 first.
pub fn rows_to(
    compensation: &Owned,
    output: Option<&OutputSummary>,
    readings: &[[f64; 3]],
    forces: &mut [[f64; 3]],
    is_parallel: bool,
) -> usize {
    if output.is_some() {
        forces.copy_from_slice(readings);
        return rows(compensation, output, forces, is_parallel);
    }
    if readings.len() <= FEW {
        return readings.iter().zip(forces).map(|(reading, force)| one_by_one(compensation, *reading, force)).sum();
    }
    let outside = if is_parallel {
        compensation.apply_rows_to_parallel(readings, forces)
    } else {
        compensation.apply_rows_to(readings, forces)
    };
    let outside = outside.map_or(0, |outside| outside.count);
    // Readings that were not numbers are not out of range.
    if outside == 0 { 0 } else { outside - not_numbers(readings) }
}

/// The same in place, where readings that are not numbers have to be counted beforehand.
pub fn rows(compensation: &Owned, output: Option<&OutputSummary>, f: &mut [[f64; 3]], is_parallel: bool) -> usize {
    let task = |f: &mut [[f64; 3]]| {
        if let Some(output) = output {
            for row in &mut *f {
                *row = output.readings(*row);
            }
        }
        let missing = not_numbers(f);
        compensation.apply_rows(f).count - missing
    };
    if is_parallel && f.len() > TASK { f.par_chunks_mut(TASK).map(task).sum() } else { task(f) }
}

/// The same of one reading, to the bit.
fn one_by_one(compensation: &Owned, reading: [f64; 3], force: &mut [f64; 3]) -> usize {
    let applied = compensation.apply(reading);
    *force = applied.unwrap_or([f64::NAN; 3]);
    usize::from(applied.is_err() && reading.iter().all(|f| !f.is_nan()))
}

fn not_numbers(rows: &[[f64; 3]]) -> usize {
    rows.iter().filter(|row| row.iter().any(|f| f.is_nan())).count()
}
