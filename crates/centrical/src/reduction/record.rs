//! A mounting's continuous record, whole or a stretch of it.

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
    /// All of it.
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
}

impl<'a> RecordSlice<'a> {
    /// Samples that have the stamp of the one before, in ascending order; `before` is the stamp before the first.
    #[must_use]
    pub fn repeated(&self, before: f64) -> Vec<usize> {
        let next = self.t.get(1..).unwrap_or_default();
        // All are compared side by side first: repeated stamps are rare.
        let count = self.t.iter().zip(next).filter(|(t, next)| next <= t).count();
        if count == 0 && self.t.first().is_none_or(|first| *first > before) {
            return Vec::new();
        }
        let is_repeated = |i: &usize| self.t[*i] <= i.checked_sub(1).map_or(before, |i| self.t[i]);
        (0..self.t.len()).filter(is_repeated).collect()
    }

    /// The record without these samples, given in ascending order. They are few as a rule: each stretch between them is copied
    /// at once.
    #[must_use]
    pub fn without(&self, samples: &[usize]) -> Record {
        let room = || Vec::with_capacity(self.t.len() - samples.len());
        let mut record = Record { t: room(), f_z: [room(), room(), room()] };
        let mut start = 0;
        for &i in samples {
            record.extend(self.part(start..i));
            start = i + 1;
        }
        record.extend(self.part(start..self.t.len()));
        record
    }

    /// Samples `from..to`.
    #[must_use]
    pub fn part(&self, range: std::ops::Range<usize>) -> RecordSlice<'a> {
        RecordSlice { t: &self.t[range.clone()], f_z: self.f_z.map(|f| &f[range.clone()]) }
    }

    /// The samples from the time `span[0]` to the time `span[1]`, both included.
    #[must_use]
    pub fn between(&self, span: [f64; 2]) -> RecordSlice<'a> {
        let from = self.t.partition_point(|t| *t < span[0]);
        let to = self.t.partition_point(|t| *t <= span[1]);
        self.part(from..to.max(from))
    }
}
