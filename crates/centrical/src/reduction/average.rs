//! Second pass: the mean of each plateau from the samples of its window, a part at a time.

mod cells;
mod samples;
mod strips;

use nalgebra::{Matrix3, Vector3};

use super::error::ReductionError;
use super::locate::{ClockAgreement, Located, Timing};
use super::plateau::{Arc, LeftOut};
use super::record::RecordSlice;
use super::survey::Blocks;
use super::terms::{Shape, TURNING, Triangle, Window};
use crate::model::Position;
use crate::statistics::{may_be_piled_up, piled_up, whole};
pub(super) use cells::{Cells, Markov, Weights};
pub(super) use samples::CELLS;
use samples::Samples;
use strips::{Fitted, Strips};

/// The average of a plateau whose samples are added part by part, in the order of time. Little of a judged part is kept.
#[derive(Debug, Clone)]
pub struct Averaging<'a> {
    index: usize,
    window: &'a Window,
    blocks: &'a Blocks,
    /// Parts of the window that are not added yet, from and to [s], the next one last.
    open: Vec<[f64; 2]>,
    fitted: Fitted,
    /// Triangle and coefficients of all samples so far.
    fit: Option<(Triangle, Vec<Vector3<f64>>)>,
    /// Rejected samples.
    left_out: LeftOut,
    /// Stamp of the last one [s].
    last: Option<f64>,
    /// Why the plateau has no average.
    refused: Option<ReductionError>,
}

/// The fit of one plateau; the cells hold what its covariance needs.
#[derive(Debug, Clone)]
pub struct PlateauFit {
    pub(super) window: [f64; 2],
    pub(super) samples: usize,
    pub(super) rejected: usize,
    pub(super) left_out: LeftOut,
    pub(super) mean: Vector3<f64>,
    pub(super) once_per_revolution: [Vector3<f64>; 2],
    pub(super) shape: Shape,
    /// Last digit of the readings [m/s^2].
    pub(super) digit: Vector3<f64>,
    /// Variance of a sample about the fit [m^2/s^4]; zero where the readings show rounding alone.
    pub(super) variance: Vector3<f64>,
    /// Settling at the start of the window [m/s^2].
    pub(super) settling: Vector3<f64>,
    /// Coefficients of the Legendre polynomials 1 to 3 where the unit turns [m/s^2].
    pub(super) turning: [Vector3<f64>; TURNING],
    /// Residuals and design, summed by cell.
    pub(super) cells: Cells,
    /// Takes readings to the axes and the unit in which the noise is alike on all plateaus: the identity on an arm.
    pub(super) noise_axes: Matrix3<f64>,
}

/// A mounting with its plateaus located and averaged, before the noise of the session is known.
#[derive(Debug, Clone)]
pub struct ReducedMounting {
    pub(super) plateaus: Vec<PlateauFit>,
    pub(super) timing: Timing,
    settling_time: Option<f64>,
    unscheduled: Vec<[f64; 2]>,
}

impl Located {
    /// Averages a plateau from the samples of its window; others are ignored.
    ///
    /// # Errors
    /// [`ReductionError`] if the samples are not steady, or do not separate the mean from the once-per-revolution term.
    pub fn average(&self, plateau: usize, samples: RecordSlice) -> Result<PlateauFit, ReductionError> {
        Averaging::new(self, plateau).finish(samples)
    }

    /// Averages all plateaus from the record.
    ///
    /// # Errors
    /// As [`Self::average`].
    pub fn averaged(self, record: RecordSlice) -> Result<ReducedMounting, ReductionError> {
        let average = |plateau| self.average(plateau, record);
        let plateaus = (0..self.windows.len()).map(average).collect::<Result<_, _>>()?;
        Ok(ReducedMounting::new(self, plateaus))
    }
}

impl<'a> Averaging<'a> {
    /// Begins with no samples.
    pub fn new(located: &'a Located, index: usize) -> Self {
        Self::in_parts(located, index, parts(located.windows[index].span, located.blocks.interval))
    }

    /// Begins with no samples, for these parts of the window, from and to [s], in the order of time.
    pub fn in_parts(located: &'a Located, index: usize, parts: Vec<[f64; 2]>) -> Self {
        let (window, blocks) = (&located.windows[index], &located.blocks);
        let open = parts.into_iter().rev().collect();
        let (fitted, left_out) = (Fitted::default(), LeftOut::default());
        Self { index, window, blocks, open, fitted, fit: None, left_out, last: None, refused: None }
    }

    /// The parts of the window whose samples are to be added, from and to [s], in the order of time.
    pub fn open_parts(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.open.iter().rev().copied()
    }

    /// The first of them.
    pub fn next_part(&self) -> Option<[f64; 2]> {
        self.open.last().copied()
    }

    /// Adds the samples of the next part, without the `repeated` ones that had the stamp of the one before; samples outside the part
    /// are ignored. They are judged by the fit of all samples so far.
    pub fn add(&mut self, samples: RecordSlice, repeated: usize) {
        if let Some(part) = self.open.pop().filter(|_| self.refused.is_none()) {
            self.refused = self.judge(samples.between(part), repeated).err();
        }
    }

    fn judge(&mut self, record: RecordSlice, repeated: usize) -> Result<(), ReductionError> {
        if record.t.is_empty() {
            return Ok(());
        }
        let samples = Samples::cut_out(record, repeated, self.window, self.blocks);
        let mut strips = Strips::of(&samples, std::mem::take(&mut self.fitted));
        let so_far = self.fit.take().map(|(_, coefficients)| coefficients);
        let mut fit = self.fit_from(&samples, &mut strips, &so_far.unwrap_or_else(|| samples.fit_of_medians()));
        if strips.rejects_a_tone() {
            // A tone at half the sampling rate has two levels and the median takes one, at a third two of three: the mean is between them.
            strips.take_all();
            let (_, of_all) = strips.fitted.solve().ok_or_else(|| self.singular(samples.len()))?;
            fit = self.fit_from(&samples, &mut strips, &of_all);
        }
        let mut fit = fit?;
        if strips.keeps_tails(&fit.1) {
            fit = self.fit_from(&samples, &mut strips, &fit.1)?;
        }
        self.fit = Some(fit);
        check_range(&samples, &strips, self.index)?;
        self.left_out += samples.left_out(self.last, samples.len() - strips.good(), strips.stuck_and_unreadable());
        self.last = samples.t.last().copied();
        self.fitted = strips.fitted;
        Ok(())
    }

    /// The fit of the samples that are good by it, from one with these coefficients.
    fn fit_from(
        &self,
        samples: &Samples,
        strips: &mut Strips,
        coefficients: &[Vector3<f64>],
    ) -> Result<(Triangle, Vec<Vector3<f64>>), ReductionError> {
        strips.judge(coefficients, false);
        let mut once_out = false;
        loop {
            let good = strips.good();
            if 2 * good <= samples.len() {
                return Err(samples.unsteady(self.index, good));
            }
            let (triangle, coefficients) = strips.fitted.solve().ok_or_else(|| self.singular(samples.len()))?;
            if !strips.judge(&coefficients, once_out) {
                return Ok((triangle, coefficients));
            }
            // From the second fit on, a rejected sample stays out: the set shrinks, and the loop ends.
            once_out = true;
        }
    }

    /// Ends the plateau, with `samples` for the parts that are still open.
    ///
    /// # Errors
    /// [`ReductionError`] if the samples are not steady, or do not separate the mean from the once-per-revolution term.
    pub fn finish(mut self, samples: RecordSlice) -> Result<PlateauFit, ReductionError> {
        while !self.open.is_empty() {
            self.add(samples, 0);
        }
        self.refused.map_or(Ok(()), Err)?;
        let Self { window: Window { span: window, shape }, blocks, fitted, left_out, .. } = self;
        let none = ReductionError::Unsteady { index: self.index, window: *window, samples: 0, good: 0 };
        let (triangle, coefficients) = self.fit.ok_or(none)?;
        let (good, terms, zero) = (fitted.good(), coefficients.len(), Vector3::zeros());
        let squares: Vector3<f64> = fitted.sums(&coefficients).map(|(_, sums)| sums.squares).sum();
        let width = (window[1] - window[0]) / CELLS as f64;
        // Of two neighbouring readings the variance is that of rounding alone, whatever the noise is.
        let spread = fitted.ranges().zip_map(&blocks.digit, |range, digit| if range < 1.5 * digit { 0.0 } else { 1.0 });
        Ok(PlateauFit {
            window: *window,
            samples: good,
            rejected: fitted.bad(),
            left_out,
            mean: coefficients[terms - 1],
            once_per_revolution: if shape.omega == 0.0 { [zero; 2] } else { [coefficients[0], coefficients[1]] },
            turning: if shape.turning.is_some() { std::array::from_fn(|k| coefficients[k]) } else { [zero; TURNING] },
            settling: shape.settling.map_or(zero, |_| coefficients[terms - 2]),
            shape: *shape,
            digit: blocks.digit,
            variance: spread.component_mul(&squares) / good as f64,
            cells: Cells::gather(fitted.sums(&coefficients), &triangle, terms, width, blocks.interval),
            noise_axes: Matrix3::identity(),
        })
    }

    /// Why the samples of a plateau, this number of them, do not separate the terms of its fit.
    fn singular(&self, samples: usize) -> ReductionError {
        let (index, Window { span: window, shape }) = (self.index, *self.window);
        let (omega, interval) = (shape.omega, self.blocks.interval);
        if 2.0 * samples as f64 * interval < window[1] - window[0] {
            ReductionError::Interrupted { index, window, samples, interval }
        } else {
            ReductionError::RevolutionAliased { index, omega, interval }
        }
    }
}

impl PlateauFit {
    /// The fit of a rest in a hand or on a soft table, of readings whose white noise is `sample_noise` [m/s^2]: noise in the direction `along`
    /// of the readings changes the size of the force. What trembles is the attitude: it moves the reading across that direction, and is in
    /// other axes of the instrument in every attitude. So the noise is alike in axes along and across, and along in units of that
    /// white noise which falls there, `sum u_i^2 sigma_i^2` for the direction `u`.
    pub(super) fn of_rest(self, along: &Vector3<f64>, sample_noise: &Vector3<f64>) -> Self {
        let noise = along.component_mul(sample_noise).norm();
        let upright = Position::free("", along).p_zy.transpose();
        let noise_axes = if noise > 0.0 { upright / noise } else { upright };
        Self { noise_axes, ..self }
    }

    /// Whether the unit turns slowly.
    pub(super) fn turns(&self) -> bool {
        self.shape.turning.is_some()
    }

    /// How the unit turns: derivatives of the reading by those of the polynomials, over the size of the reading. With the half length `h`, in
    /// the middle `P_1' = 1/h`, `P_3' = -3/2h`; on average `P_2'' = 3/h^2`, `P_3'' = 0`.
    pub(super) fn arc(&self) -> Option<Arc> {
        let half = self.shape.turning?.half;
        let ([p1, p2, p3], size) = (self.turning, self.mean.norm());
        Some(Arc { rate: (p1 - p3 * 1.5).norm() / (half * size), bend_z: p2 * (3.0 / (half * half * size)) })
    }

    /// A covariance in the axes of the noise, as one of readings.
    pub(super) fn in_readings(&self, covariance: &Matrix3<f64>) -> Matrix3<f64> {
        // The axes are a rotation and a unit.
        let unit = self.noise_axes.row(0).norm_squared();
        let back = self.noise_axes.transpose() / unit;
        let covariance = back * covariance * back.transpose();
        // Symmetric to the last digit, as a table of plateaus holds it.
        (covariance + covariance.transpose()) * 0.5
    }

    /// Derivative of the settling's law by the logarithm of its time constant, one value a cell.
    pub(super) fn settling_rate(&self) -> Option<Vec<f64>> {
        let settling = self.shape.settling?;
        Some((0..CELLS).map(|cell| settling.rate((cell as f64 + 0.5) * self.cells.width)).collect())
    }
}

impl ReducedMounting {
    /// The mounting of located plateaus, averaged, in the order of the schedule.
    pub fn new(located: Located, plateaus: Vec<PlateauFit>) -> Self {
        let Located { timing, settling_time, unscheduled, .. } = located;
        Self { plateaus, timing, settling_time, unscheduled }
    }

    /// A record of rests, those that are steady.
    pub(super) fn of_rests(located: Located, rests: Vec<PlateauFit>) -> Self {
        Self { timing: Timing::unknown(rests.len()), ..Self::new(located, rests) }
    }

    /// Number of its plateaus.
    pub fn plateau_count(&self) -> usize {
        self.plateaus.len()
    }

    /// Plateaus that the record shows and the schedule does not have, from and to, the record's clock [s].
    pub fn unscheduled(&self) -> &[[f64; 2]] {
        &self.unscheduled
    }

    /// Time constant of the settling after a ramp [s]; `None` if the record shows no settling.
    pub fn settling_time(&self) -> Option<f64> {
        self.settling_time
    }

    /// How the ramps of the telemetry, or of the counter of revolutions, agree with those of the record.
    pub fn clock_agreement(&self) -> Option<ClockAgreement> {
        self.timing.agreement
    }
}

/// A window in parts, from and to [s], each short enough to be held in memory.
fn parts([from, to]: [f64; 2], interval: f64) -> Vec<[f64; 2]> {
    /// Most samples of a part.
    const PART: f64 = 1e6;
    let count = whole(((to - from) / (PART * interval)).ceil()).max(1);
    let end = |k: usize| if k == count { to } else { from + (to - from) * (k as f64 / count as f64) };
    (0..count).map(|k| [if k == 0 { from } else { end(k).next_up() }, end(k + 1)]).collect()
}

/// Refuses good readings that pile up at the end of their range: the part cut off is missing in the mean.
fn check_range(samples: &Samples, strips: &Strips, index: usize) -> Result<(), ReductionError> {
    let is_noisy = |axis: &usize| samples.white[*axis] > samples.digit[*axis] && samples.repeat_rate[*axis] < 1.0;
    let looked_at = (0..3).filter(is_noisy).filter(|axis| may_be_piled_up(strips.most_at_an_end(*axis)));
    for axis in looked_at {
        let mut readings = strips.good_readings(axis);
        // A sensor that is slower than its recorder gives each reading several times: it counts once.
        if samples.repeat_rate[axis] > 0.5 {
            readings.dedup();
        }
        if let Some((value, piled_up)) = piled_up(readings) {
            let (window, samples) = (samples.window.span, samples.len());
            return Err(ReductionError::Saturated { index, window, axis, value, samples, piled_up });
        }
    }
    Ok(())
}
