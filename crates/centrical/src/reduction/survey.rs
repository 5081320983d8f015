//! First pass: a record, stretch by stretch, becomes blocks. A reader of a file needs to hold little of it.

mod block;
mod blocks;

use nalgebra::Vector3;

use super::error::ReductionError;
use super::record::{Record, RecordSlice};
use block::{Block, Grid, SAMPLES};
pub(super) use blocks::Blocks;

/// The blocks of a record, gathered stretch by stretch.
#[derive(Debug, Clone)]
pub struct Survey {
    grid: Grid,
    blocks: Vec<Block>,
    /// Samples of the block that the next stretch may continue, and its number.
    open: Record,
    number: usize,
    /// Stated resolution of the readings [m/s^2]; 0 if it is not stated.
    resolution: f64,
}

/// A condensed stretch: its first and last block may be incomplete, and keep their samples.
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

impl Survey {
    /// Samples that a survey needs to begin, if the record has them: their times give the sampling interval.
    pub const BEGINNING: usize = 4096;

    /// Begins with the first times of a record; those after the first [`Survey::BEGINNING`] are ignored.
    pub fn new(times: &[f64]) -> Self {
        let grid = Grid::new(&times[..times.len().min(Self::BEGINNING)]);
        Self { grid, blocks: Vec::new(), open: Record::default(), number: 0, resolution: 0.0 }
    }

    /// The survey of a record in memory.
    ///
    /// # Errors
    /// [`ReductionError`] if the record is invalid: lengths, times.
    pub fn of(record: RecordSlice) -> Result<Self, ReductionError> {
        check(record)?;
        let mut survey = Self::new(record.t);
        survey.append(survey.condense(record));
        survey.finish();
        Ok(survey)
    }

    /// The same with the smallest step of the readings stated [m/s^2]. Readings that stand still by no more than their
    /// rounding are not taken for stuck.
    #[must_use]
    pub fn with_resolution(self, resolution: f64) -> Self {
        Self { resolution, ..self }
    }

    /// Condenses a stretch: nearly all the work, independent of other stretches.
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

    /// Adds samples to a block, which may be the open one.
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

    /// The range of the readings, block by block.
    pub fn extremes(&self) -> impl Iterator<Item = Extremes> {
        let extremes = |block: &Block| Extremes { t: self.grid.middle(block.number), low: block.low, high: block.high };
        self.blocks.iter().map(extremes)
    }

    /// Ends the first pass.
    pub fn finish(&mut self) {
        self.close();
    }

    /// The blocks of all stretches together.
    pub(super) fn blocks(&self) -> Result<Blocks, ReductionError> {
        Blocks::new(&self.grid, &self.blocks, self.resolution)
    }
}

/// Refuses an invalid record: columns of different lengths, too few samples, time that runs backwards.
fn check(record: RecordSlice) -> Result<(), ReductionError> {
    let times = record.t.len();
    let readings = record.f_z.map(<[f64]>::len);
    if readings != [times; 3] {
        return Err(ReductionError::UnequalColumns { times, readings });
    }
    let expected = 3 * SAMPLES;
    if times < expected {
        return Err(ReductionError::TooShort { found: times, expected });
    }
    let mut before = f64::NEG_INFINITY;
    for (i, &found) in record.t.iter().enumerate() {
        if !found.is_finite() || found < before {
            return Err(ReductionError::Time { sample: i + 1, found, before });
        }
        before = found;
    }
    Ok(())
}
