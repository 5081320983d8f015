//! The two passes over a record, from stretches of any length: whoever reads a file needs to hold little of it.

use nalgebra::Vector3;

use super::block::Block;
use super::blocks::{Blocks, Grid, whole};
use super::clock::{self, ClockOffset, SpeedTrace};
use super::plateau_fit::{Plateau, PlateauFit};
use super::record::{Record, RecordSlice};
use super::window::{self, Windows};
use super::{ReducedMounting, ReductionError, ScheduledPlateau, alignment};

/// Samples of a part of a window.
const MOST: f64 = 1e6;

/// First pass: a record, stretch by stretch, becomes blocks.
#[derive(Debug, Clone)]
pub struct Survey {
    grid: Grid,
    blocks: Vec<Block>,
    /// Samples of the block that the next stretch may go on with, and its number.
    open: Record,
    number: usize,
}

/// A stretch condensed: its first and last block may be parts, and keep their samples.
#[derive(Debug, Clone)]
pub struct Condensed {
    first: (usize, Record),
    whole: Vec<Block>,
    last: Option<(usize, Record)>,
}

/// Lowest and highest readings about an instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extremes {
    /// The instant [s].
    pub t: f64,
    /// Lowest readings of newtonometers 1, 2, 3 [m/s^2].
    pub low: Vector3<f64>,
    /// Highest readings [m/s^2].
    pub high: Vector3<f64>,
}

/// Second pass: the plateaus are found, and wait for their samples.
#[derive(Debug, Clone)]
pub struct Located {
    blocks: Blocks,
    windows: Windows,
    speeds: Vec<Option<f64>>,
    clock_offset: Option<ClockOffset>,
}

impl Survey {
    /// Samples that a survey wants to see before it begins, if the record has them: their times tell the sampling
    /// interval.
    pub const BEGINNING: usize = 4096;

    /// Begins with the first times of a record; all but [`Survey::BEGINNING`] of them are left aside.
    pub fn new(times: &[f64]) -> Self {
        let grid = Grid::new(&times[..times.len().min(Self::BEGINNING)]);
        Self { grid, blocks: Vec::new(), open: Record::default(), number: 0 }
    }

    /// Condenses a stretch: nearly all the work, and nothing of it depends on other stretches.
    pub fn condense(&self, stretch: RecordSlice) -> Condensed {
        let mut parts = self.grid.divide(stretch);
        let of = |part: Option<(usize, RecordSlice)>| {
            part.map(|(number, samples)| {
                let mut record = Record::default();
                record.extend(samples);
                (number, record)
            })
        };
        let first = of(parts.next()).unwrap_or_default();
        let mut whole = Vec::new();
        let mut last = None;
        for part in parts {
            if let Some((number, samples)) = last.replace(part) {
                whole.push(Block::of(number, samples));
            }
        }
        Condensed { first, whole, last: of(last) }
    }

    /// Adds the next stretch, in the order of the record.
    pub fn append(&mut self, stretch: Condensed) {
        let (number, samples) = stretch.first;
        self.go_on(number, &samples);
        if let Some((number, samples)) = stretch.last {
            self.close();
            self.blocks.extend(stretch.whole);
            self.go_on(number, &samples);
        }
    }

    /// Goes on with a block, which may be the one that is open.
    fn go_on(&mut self, number: usize, samples: &Record) {
        if number != self.number {
            self.close();
            self.number = number;
        }
        self.open.extend(samples.as_slice());
    }

    fn close(&mut self) {
        if !self.open.t.is_empty() {
            self.blocks.push(Block::of(self.number, self.open.as_slice()));
            self.open.clear();
        }
    }

    /// What the record looks like, block by block.
    pub fn extremes(&self) -> impl Iterator<Item = Extremes> {
        let extremes = |block: &Block| Extremes { t: self.grid.middle(block.number), low: block.low, high: block.high };
        self.blocks.iter().map(extremes)
    }

    /// Ends the first pass.
    pub fn finish(&mut self) {
        self.close();
    }

    /// Finds the scheduled plateaus, all stretches being in.
    ///
    /// # Errors
    /// [`ReductionError`] if the record is too short or a scheduled plateau is not in it.
    pub fn locate(
        &self,
        telemetry: Option<&SpeedTrace>,
        schedule: &[ScheduledPlateau],
    ) -> Result<Located, ReductionError> {
        let blocks = Blocks::new(&self.grid, &self.blocks)?;
        let cores = alignment::align(&blocks, schedule)?;
        let clock_offset = telemetry.and_then(|telemetry| clock::offset(&blocks, schedule, &cores, telemetry));
        let windows = window::refine(&blocks, schedule, &cores)?;
        let speed = |window: &window::Window| clock::median_speed(telemetry?, clock_offset.as_ref()?, window.span);
        let speeds = windows.plateaus.iter().map(speed).collect();
        Ok(Located { blocks, windows, speeds, clock_offset })
    }
}

impl Located {
    /// The window of each plateau, from and to, the record's clock [s], in the order of the schedule.
    pub fn windows(&self) -> Vec<[f64; 2]> {
        self.windows.plateaus.iter().map(|window| window.span).collect()
    }

    /// The window of a plateau in parts, from and to [s], of so many samples that they are easily held.
    pub fn parts(&self, plateau: usize) -> Vec<[f64; 2]> {
        let [from, to] = self.windows.plateaus[plateau].span;
        let count = whole(((to - from) / (MOST * self.blocks.interval)).ceil()).max(1);
        let end = |k: usize| if k == count { to } else { from + (to - from) * (k as f64 / count as f64) };
        (0..count).map(|k| [if k == 0 { from } else { end(k).next_up() }, end(k + 1)]).collect()
    }

    /// A plateau that is to be averaged, part by part.
    pub fn plateau(&self, plateau: usize) -> Plateau<'_> {
        Plateau::new(plateau, &self.windows.plateaus[plateau], &self.blocks)
    }

    /// Averages a plateau from the samples of its window, so many with the stamp of the one before having been left out of them;
    /// other samples are left aside.
    ///
    /// # Errors
    /// [`ReductionError`] if the samples are not steady, or do not tell the mean from the once-per-revolution term.
    pub fn average(&self, plateau: usize, samples: RecordSlice, repeated: usize) -> Result<PlateauFit, ReductionError> {
        let mut of_parts = self.plateau(plateau);
        for (k, part) in self.parts(plateau).into_iter().enumerate() {
            of_parts.add(part, samples, if k == 0 { repeated } else { 0 })?;
        }
        of_parts.finish()
    }

    /// The mounting, its plateaus being averaged, in the order of the schedule.
    pub fn into_mounting(self, plateaus: Vec<PlateauFit>) -> ReducedMounting {
        ReducedMounting {
            plateaus,
            speeds: self.speeds,
            settling_time: self.windows.settling_time,
            clock_offset: self.clock_offset,
        }
    }
}
