//! A mounting's continuous record, whole or a stretch of it.

use super::ReductionError;
use super::blocks::SAMPLES;

/// One mounting's continuous record, instrument axes.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Record {
    /// Time on the unit's clock [s], not decreasing.
    pub t: Vec<f64>,
    /// Readings of newtonometers 1, 2, 3 [m/s^2]; a reading that is not a number is a missing one.
    pub f_z: [Vec<f64>; 3],
}

/// A stretch of a record: slices of equal length.
#[derive(Debug, Clone, Copy)]
pub struct RecordSlice<'a> {
    /// Time on the unit's clock [s].
    pub t: &'a [f64],
    /// Readings of newtonometers 1, 2, 3 [m/s^2].
    pub f_z: [&'a [f64]; 3],
}

impl Record {
    /// The whole of it.
    pub fn as_slice(&self) -> RecordSlice<'_> {
        RecordSlice { t: &self.t, f_z: self.f_z.each_ref().map(Vec::as_slice) }
    }

    /// Adds a stretch at the end.
    pub fn extend(&mut self, stretch: RecordSlice) {
        self.t.extend_from_slice(stretch.t);
        for (whole, part) in self.f_z.iter_mut().zip(stretch.f_z) {
            whole.extend_from_slice(part);
        }
    }

    /// Empties it.
    pub fn clear(&mut self) {
        self.t.clear();
        self.f_z.iter_mut().for_each(Vec::clear);
    }

    /// Refuses what is no record: columns of different lengths, hardly a sample, time that runs backwards.
    pub(super) fn check(&self) -> Result<(), ReductionError> {
        let times = self.t.len();
        let readings = self.f_z.each_ref().map(Vec::len);
        if readings != [times; 3] {
            return Err(ReductionError::UnequalColumns { times, readings });
        }
        let expected = 3 * SAMPLES;
        if times < expected {
            return Err(ReductionError::TooShort { found: times, expected });
        }
        let mut before = f64::NEG_INFINITY;
        for (i, &found) in self.t.iter().enumerate() {
            if !found.is_finite() || found < before {
                return Err(ReductionError::Time { sample: i + 1, found, before });
            }
            before = found;
        }
        Ok(())
    }
}

impl<'a> RecordSlice<'a> {
    /// Samples `from..to`.
    pub fn part(&self, range: std::ops::Range<usize>) -> RecordSlice<'a> {
        RecordSlice { t: &self.t[range.clone()], f_z: self.f_z.map(|f| &f[range.clone()]) }
    }

    /// The samples from the time `span[0]` to the time `span[1]`, both included.
    pub fn between(&self, span: [f64; 2]) -> RecordSlice<'a> {
        let from = self.t.partition_point(|t| *t < span[0]);
        let to = self.t.partition_point(|t| *t <= span[1]);
        self.part(from..to.max(from))
    }
}
