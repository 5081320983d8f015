//! Which blocks of a record belong to which scheduled plateau: by order, level and steadiness.

use std::ops::Range;

use nalgebra::Vector3;
use rayon::prelude::*;

use super::evidence::{Candidate, Evidence};
use super::path::Trellis;
use super::{hypothesis, rotation};
use crate::reduction::error::{ReductionError, Stretch};
use crate::reduction::plateau::ScheduledPlateau;
use crate::reduction::survey::Blocks;

/// More rounds than it takes.
const ROUNDS: usize = 8;

/// The core of each scheduled plateau, in blocks; not in a record that was taken down by mistake.
pub(super) fn align(blocks: &Blocks, schedule: &[ScheduledPlateau]) -> Result<Vec<Range<usize>>, ReductionError> {
    let other = |schedule: &[ScheduledPlateau]| by_schedule(blocks, schedule).ok();
    match by_schedule(blocks, schedule) {
        Ok(cores) => {
            hypothesis::recognise(blocks, schedule, Some(&cores), other)?;
            rotation::check(blocks, schedule, &cores)?;
            Ok(cores)
        }
        Err(error) => {
            hypothesis::recognise(blocks, schedule, None, other)?;
            Err(error)
        }
    }
}

/// The core of each scheduled plateau, in blocks.
fn by_schedule(blocks: &Blocks, schedule: &[ScheduledPlateau]) -> Result<Vec<Range<usize>>, ReductionError> {
    let evidence = Evidence::new(blocks);
    let candidates: Vec<Candidate> = schedule.par_iter().map(|plateau| evidence.of(plateau)).collect();
    let between = evidence.in_transition();
    let mut trellis = Trellis::new(schedule.len(), blocks.len());
    let on = |k: usize, from: usize, density: &mut [f64]| candidates[k].density(evidence.noise(), from, density);
    let mut cores = trellis.best_path(&between, on);
    if let Some(index) = missing(&cores) {
        let ScheduledPlateau { omega, nominal_z } = schedule[index];
        let stretches = evidence.steady_stretches().into_iter();
        let seen = stretches.map(|range| stretch(blocks, range, &cores, &candidates)).collect();
        return Err(ReductionError::PlateauNotFound { index, count: schedule.len(), omega, level_z: nominal_z, seen });
    }
    // Now that it is known where the plateaus are, the changes on each tell their own noise, far below that of a
    // sample; and so again, until nothing of the ramps is left in it.
    for _ in 0..ROUNDS {
        let own = candidates.par_iter().zip(&cores).map(|(candidate, core)| candidate.noise_of_change(core));
        let own: Vec<Vector3<f64>> = own.collect();
        let on = |k: usize, from: usize, density: &mut [f64]| candidates[k].density(&own[k], from, density);
        let next = trellis.best_path(&between, on);
        if next == cores || missing(&next).is_some() {
            break;
        }
        cores = next;
    }
    Ok(cores)
}

/// A plateau that was passed over, or got what a ramp has at its turn.
fn missing(cores: &[Range<usize>]) -> Option<usize> {
    cores.iter().position(|core| core.len() < 3)
}

/// A steady stretch, and what it was taken for.
fn stretch(blocks: &Blocks, range: Range<usize>, cores: &[Range<usize>], candidates: &[Candidate]) -> Stretch {
    let half = 0.5 * blocks.width;
    let middle = usize::midpoint(range.start, range.end);
    Stretch {
        window: [blocks.t[range.start] - half, blocks.t[range.end - 1] + half],
        level_z: blocks.level(&range),
        plateau: cores.iter().position(|core| core.contains(&middle)),
        resembles: (0..cores.len()).filter(|k| candidates[*k].has_level(middle)).collect(),
    }
}
