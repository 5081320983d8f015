//! Where the scheduled plateaus are in a surveyed record, and which part of each is averaged.

mod align;
mod block_fit;
mod clock;
mod evidence;
mod hypothesis;
mod path;
mod rests;
mod rotation;
mod tachometer;
mod turning;
mod window;

use std::ops::Range;

use nalgebra::Vector3;

use super::error::ReductionError;
use super::plateau::ScheduledPlateau;
use super::survey::{Blocks, Survey};
use super::terms::{Interval, Shape, Window};
pub use clock::{ClockAgreement, SpeedTrace};
use hypothesis::Line;
pub use tachometer::{PulseTrain, SpeedReading};

/// What telemetry or a counter of revolutions says of the plateaus of a record.
#[derive(Debug, Clone, Default)]
pub(super) struct Timing {
    /// How the ramps agree with those of the record; `None` where nothing shows the speeds.
    pub agreement: Option<ClockAgreement>,
    /// Median speed on each plateau by the telemetry [rad/s].
    pub speeds: Vec<Option<f64>>,
    /// Speed on each plateau with its scatter.
    pub readings: Vec<Option<SpeedReading>>,
}

impl Timing {
    /// Of plateaus whose speeds nothing shows.
    pub fn unknown(plateaus: usize) -> Self {
        Self { speeds: vec![None; plateaus], readings: vec![None; plateaus], ..Self::default() }
    }
}

/// The plateaus of a mounting, found in its record.
#[derive(Debug, Clone)]
pub struct Located {
    pub(super) blocks: Blocks,
    /// In the order of the schedule.
    pub(super) windows: Vec<Window>,
    /// Time constant of the settling, common to the mounting [s].
    pub(super) settling_time: Option<f64>,
    pub(super) timing: Timing,
    /// Plateaus that the schedule does not have, from and to [s].
    pub(super) unscheduled: Vec<[f64; 2]>,
    /// Schedule and ramps of the record.
    schedule: Vec<ScheduledPlateau>,
    ramps: Vec<clock::Ramp>,
}

impl Survey {
    /// Finds the scheduled plateaus of a surveyed record.
    ///
    /// # Errors
    /// [`ReductionError`] if the record is too short, a scheduled plateau is not in it, or a recording mistake explains it better.
    pub fn locate(&self, schedule: &[ScheduledPlateau]) -> Result<Located, ReductionError> {
        let blocks = self.blocks()?;
        let align::Aligned { cores, unscheduled } = align::align(&blocks, schedule)?;
        let ramps = clock::Ramp::all(&blocks, schedule, &cores);
        let window::Windows { plateaus: windows, settling_time } = window::refine(&blocks, schedule, &cores)?;
        let (timing, schedule) = (Timing::unknown(schedule.len()), schedule.to_vec());
        Ok(Located { blocks, windows, settling_time, timing, unscheduled, schedule, ramps })
    }

    /// Finds the rests of a surveyed record without a schedule: wherever the unit stood still. With `turning`, what turns slowly between them
    /// as well, in arcs.
    ///
    /// # Errors
    /// [`ReductionError::TooShort`] if the record is too short.
    pub fn locate_rests(&self, turning: bool) -> Result<Located, ReductionError> {
        let blocks = self.blocks()?;
        let mut rests = rests::rests(&blocks);
        rests.retain(|rest| !turning || turning::is_still(&blocks, rest));
        let arcs = if turning { turning::arcs(&blocks, &rests) } else { Vec::new() };
        Ok(Located::without_schedule(blocks, &rests, &arcs))
    }

    /// Stretches of a surveyed record, from and to [s], as if they were rests.
    pub(super) fn locate_spans(&self, spans: &[[f64; 2]]) -> Result<Located, ReductionError> {
        let located = Located::without_schedule(self.blocks()?, &[], &[]);
        let window = |span: &[f64; 2]| {
            let shape = Shape { start: span[0], omega: 0.0, settling: None, turning: None };
            Window { span: *span, shape }
        };
        Ok(Located { windows: spans.iter().map(window).collect(), ..located })
    }
}

impl Located {
    /// Of rests and of arcs that turn, in the order of time.
    fn without_schedule(blocks: Blocks, rests: &[Range<usize>], arcs: &[Range<usize>]) -> Self {
        let cores = |turns: bool, ranges: &[Range<usize>]| -> Vec<(bool, Range<usize>)> {
            ranges.iter().map(|range| (turns, range.clone())).collect()
        };
        let mut cores = [cores(false, rests), cores(true, arcs)].concat();
        cores.sort_by_key(|(_, core)| core.start);
        let width = blocks.width;
        let windows = cores.iter().map(|(turns, core)| {
            // The block at either end may hold the onset of the motion.
            let (first, last) = if *turns { (core.start, core.end - 1) } else { (core.start + 1, core.end - 2) };
            let span = [blocks.t[first] - 0.5 * width, blocks.t[last] + 0.5 * width];
            let interval = Interval { middle: 0.5 * (span[0] + span[1]), half: 0.5 * (span[1] - span[0]) };
            let shape = Shape { start: span[0], omega: 0.0, settling: None, turning: turns.then_some(interval) };
            Window { span, shape }
        });
        let windows: Vec<Window> = windows.collect();
        let schedule = cores.iter().map(|(_, core)| ScheduledPlateau { omega: 0.0, nominal_z: blocks.level(core) });
        Self {
            schedule: schedule.collect(),
            timing: Timing::unknown(windows.len()),
            unscheduled: Vec::new(),
            ramps: Vec::new(),
            blocks,
            windows,
            settling_time: None,
        }
    }

    /// Takes the speeds of the plateaus from telemetry; its clock is found by the ramps.
    pub fn time_telemetry(&mut self, telemetry: &SpeedTrace) {
        if let Some(offset) = self.compare(telemetry) {
            let (margin, step) = (self.margin(&telemetry.t), telemetry.step());
            let median = |window: &Window| clock::median_speed(telemetry, offset, window.span);
            self.timing.speeds = self.windows.iter().map(median).collect();
            self.read(|window| telemetry.speed(offset, window, margin, step));
        }
    }

    /// The same from a counter of revolutions, in place of telemetry; pulses of another record leave the offset as telemetry has it.
    pub fn time_pulses(&mut self, pulses: &PulseTrain) {
        let of_telemetry = self.timing.agreement.and_then(|agreement| agreement.offset);
        if let Some(offset) = self.compare(&pulses.trace()) {
            let margin = self.margin(&[]);
            self.read(|window| pulses.speed(offset, window, margin));
        } else if let Some(agreement) = &mut self.timing.agreement {
            agreement.offset = of_telemetry;
        }
    }

    /// Compares the clock of a trace of speeds with that of the record: their offset [s] if the trace is of the record. Readings of another
    /// source are given up.
    fn compare(&mut self, trace: &SpeedTrace) -> Option<f64> {
        let agreement = clock::compare(&self.ramps, self.blocks.width, &self.schedule, trace);
        self.timing.agreement = Some(agreement);
        self.timing.readings.fill(None);
        agreement.offset.filter(|_| agreement.is_of_the_record()).map(|[seconds, _]| seconds)
    }

    /// The speeds of all plateaus that spin.
    fn read(&mut self, speed: impl Fn(&Window) -> Option<SpeedReading>) {
        let spinning = self.windows.iter().zip(&self.schedule);
        self.timing.readings =
            spinning.map(|(window, plateau)| speed(window).filter(|_| plateau.omega != 0.0)).collect();
    }

    /// What the offset of the clocks leaves uncertain at the ends of a window: a block, and the time between two reports [s].
    fn margin(&self, times: &[f64]) -> f64 {
        let interval = match times {
            [first, .., last] => (last - first) / (times.len() - 1) as f64,
            _ => 0.0,
        };
        self.blocks.width + interval
    }

    /// Standard deviation of a sample from one to the next [m/s^2].
    pub(super) fn sample_noise(&self) -> &Vector3<f64> {
        &self.blocks.sample_noise
    }

    /// Logarithm of the density of the levels that were found about the nominal ones, by the law by which real units differ from these; of
    /// several schedules that a record fits, the likeliest has the greatest. `None` if all plateaus have the same speed.
    pub fn log_likelihood(&self) -> Option<f64> {
        let Blocks { t, .. } = &self.blocks;
        let seen = |window: &Window| {
            let [from, to] = window.span;
            self.blocks.level(&(t.partition_point(|t| *t < from)..t.partition_point(|t| *t <= to)))
        };
        let nominal = Line::through(self.schedule.iter().map(|plateau| (plateau.omega, plateau.nominal_z)))?;
        let seen = self.schedule.iter().zip(&self.windows).map(|(plateau, window)| (plateau.omega, seen(window)));
        Some(Line::through(seen)?.log_likelihood(&nominal))
    }

    /// The window of each plateau, from and to, the record's clock [s], in the order of the schedule.
    pub fn windows(&self) -> Vec<[f64; 2]> {
        self.windows.iter().map(|window| window.span).collect()
    }
}
