//! The whole analysis of one series of readings.

use super::deviation::Deviation;
use super::error::NoiseError;
use super::estimator::Estimator;
use super::faults::{is_fine, named, refuse_faults, refuse_held};
use super::grid::Grid;
use super::jump::refuse_jump;
use super::phase::{BridgedGaps, Phase};
use super::spectrum::Spectrum;
use super::spikes::{last_digit, leave_out_spikes};
use super::terms::NoiseTerms;
use crate::progress::{OnProgress, advance};

/// The noise of a series of readings.
#[derive(Debug, Clone)]
pub struct Analysis {
    /// Mean of the readings used [unit of the readings].
    pub mean: f64,
    /// Sampling interval [s].
    pub interval: f64,
    /// Readings used.
    pub samples: usize,
    /// Readings left out as spikes.
    pub spikes: usize,
    /// Samples left out as repeated.
    pub repeated: usize,
    /// Missing readings that were bridged, spikes among them.
    pub gaps: BridgedGaps,
    /// Deviations by estimator, at averaging factors 1, 2, 4, ...
    pub deviations: Vec<(Estimator, Vec<Deviation>)>,
    /// The spectrum, or why it could not be computed.
    pub spectrum: Result<Spectrum, NoiseError>,
    /// The noise terms, or why they could not be fitted.
    pub terms: Result<NoiseTerms, NoiseError>,
}

impl Analysis {
    /// Level of confidence of the intervals: one standard deviation of a normal law.
    pub const CONFIDENCE: f64 = 0.683;

    /// Analyses the readings `y`, taken at the times `t` [s], with the given estimators. `progress` is asked again and again: many times
    /// a second, however long the series.
    ///
    /// # Errors
    /// [`NoiseError`] if the readings are not a series: too few, or hardly any two of them evenly spaced;
    /// [`NoiseError::Stopped`].
    pub fn of(
        t: &[f64],
        y: &[f64],
        estimators: &[Estimator],
        progress: OnProgress<()>,
    ) -> Result<Analysis, NoiseError> {
        advance(progress, ())?;
        let mut grid = Grid::of(t, y, progress)?;
        let is_fine = is_fine(&grid.readings, progress)?;
        let held = refuse_held(&grid.readings, is_fine);
        let spikes = leave_out_spikes(&mut grid.readings, progress)?;
        let phase = Phase::integrate(&grid.readings, grid.interval, progress)?;
        let seen = || grid.readings.iter().filter(|y| y.is_finite());
        let samples = seen().count();
        let families = estimators.iter().map(|e| Ok((*e, family(&phase, *e, progress)?)));
        Ok(Analysis {
            mean: seen().sum::<f64>() / samples as f64,
            interval: grid.interval,
            samples,
            spikes,
            repeated: grid.repeated,
            gaps: phase.gaps(),
            deviations: families.collect::<Result<_, NoiseError>>()?,
            spectrum: unless_stopped(Spectrum::of(
                &grid.readings,
                grid.interval,
                segment(grid.readings.len()),
                progress,
            ))?,
            terms: unless_stopped(
                held.and_then(|()| refuse_faults(&grid.readings, is_fine))
                    .map_err(|fault| named(fault, y))
                    .and_then(|()| terms(&phase, &grid, t[0], progress)),
            )?,
        })
    }

    /// The noise terms that may be quoted: those that describe the deviations.
    pub fn quotable(&self) -> Option<&NoiseTerms> {
        self.terms.as_ref().ok().filter(|terms| terms.is_consistent())
    }
}

/// The noise terms, unless a jump stands behind those that are slower than white noise; the grid begins at `start` [s].
fn terms(phase: &Phase, grid: &Grid, start: f64, progress: OnProgress<()>) -> Result<NoiseTerms, NoiseError> {
    let terms = NoiseTerms::of(phase, progress);
    if !terms.as_ref().is_ok_and(NoiseTerms::is_white) {
        let lacking = grid.readings.iter().position(|y| y.is_finite()).unwrap_or(0);
        refuse_jump(phase, last_digit(&grid.readings), start + lacking as f64 * grid.interval, progress)?;
    }
    terms
}

/// What a part of the analysis gave, or why it could not; a part that was stopped stops the whole.
fn unless_stopped<T>(outcome: Result<T, NoiseError>) -> Result<Result<T, NoiseError>, NoiseError> {
    match outcome {
        Err(stopped @ NoiseError::Stopped(_)) => Err(stopped),
        outcome => Ok(outcome),
    }
}

/// Deviations at 1, 2, 4, ... sampling intervals, to half the record.
///
/// Estimators whose work is the product of record and averaging time stop where it would take more than some seconds.
fn family(phase: &Phase, estimator: Estimator, progress: OnProgress<()>) -> Result<Vec<Deviation>, NoiseError> {
    /// Operations that take some seconds, each of some 20 ns.
    const WORK: usize = 1 << 26;
    let is_product = matches!(estimator, Estimator::ModifiedTotal | Estimator::TimeTotal | Estimator::HadamardTotal);
    let longest = if is_product { WORK / phase.points().len() } else { usize::MAX };
    let factors: Vec<usize> = phase.octaves(2).into_iter().filter(|m| *m <= longest).collect();
    phase.deviations(estimator, &factors, Analysis::CONFIDENCE, progress)
}

/// Length of the spectrum's segments: a power of two such that about 16 of them fit half overlapping; a density then has
/// about 30 degrees of freedom. Segments longer than 2^17 show nothing more.
fn segment(readings: usize) -> usize {
    let eighth = (readings / 8).max(8);
    1 << eighth.ilog2().min(17)
}
