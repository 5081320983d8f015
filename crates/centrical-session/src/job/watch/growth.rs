//! A record as it stands while it grows: its size, its last minutes, and whether it has stopped.

use std::path::{Path, PathBuf};
use std::time::Duration;

use centrical::reduction::{Record, ReducedMounting};

use super::quiet::Sight;
use crate::document::{LiveRecord, seconds_since_1970};

/// Stretch at the end that is shown [s].
const SHOWN: f64 = 300.0;

/// Points that are shown of it.
const POINTS: usize = 300;

/// The record of a mounting as it stands.
#[derive(Debug, Clone)]
pub struct Growth {
    /// Mounting, from 0.
    pub mounting: usize,
    file: PathBuf,
    sight: Sight,
    /// Every plateau of the mounting has begun: it may stop. So does a file at once that appears whole.
    shows_all: bool,
    samples: usize,
    t: Vec<f64>,
    f: [Vec<f64>; 3],
    clock_offset: Option<(f64, Option<f64>)>,
}

impl Growth {
    /// A record that is seen for the first time.
    pub(super) fn new(mounting: usize, file: &Path, sight: Sight) -> Self {
        Self {
            mounting,
            file: file.to_owned(),
            sight,
            shows_all: false,
            samples: 0,
            t: Vec::new(),
            f: Default::default(),
            clock_offset: None,
        }
    }

    /// Notes what it looks like from outside.
    pub(super) fn look_again(&mut self, sight: Sight) {
        self.sight = sight;
    }

    /// Notes its samples: the means of short stretches of the last minutes.
    pub fn show(&mut self, record: &Record) {
        let n = record.t.len();
        let from = record.t.last().map_or(0, |end| record.t.partition_point(|t| *t < end - SHOWN));
        let stretch = (n - from).div_ceil(POINTS).max(1);
        let thinned = |column: &[f64]| column[from..].chunks(stretch).map(mean).collect::<Vec<f64>>();
        self.samples = n;
        self.t = thinned(&record.t);
        self.f = [0, 1, 2].map(|i| thinned(&record.f_z[i]));
        let is_number = |k: &usize| self.f.iter().all(|column| column[*k].is_finite());
        let kept: Vec<usize> = (0..self.t.len()).filter(is_number).collect();
        self.t = kept.iter().map(|&k| self.t[k]).collect();
        self.f = [0, 1, 2].map(|i| kept.iter().map(|&k| self.f[i][k]).collect());
    }

    /// Notes what was found in it, of `scheduled` plateaus.
    pub fn find(&mut self, reduced: &ReducedMounting, scheduled: usize) {
        self.shows_all = reduced.plateau_count() == scheduled;
        let offset = reduced.clock_agreement().and_then(|agreement| agreement.offset);
        self.clock_offset = offset.map(|[seconds, u]| (seconds, u.is_finite().then_some(u)));
    }

    /// Its file.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// Time since it changed, if it has stopped for `after` in the midst of its schedule.
    pub fn frozen(&self, after: Duration) -> Option<Duration> {
        (!self.shows_all && self.sight.stood >= after).then_some(self.sight.stood)
    }

    /// As whoever looks at the watch sees it.
    pub fn live(&self, frozen_after: Duration) -> LiveRecord {
        LiveRecord {
            file: self.file.display().to_string(),
            bytes: self.sight.bytes,
            changed: self.sight.changed.map(seconds_since_1970),
            frozen: self.frozen(frozen_after).is_some(),
            samples: self.samples,
            t: self.t.clone(),
            f: self.f.clone(),
            clock_offset: self.clock_offset,
        }
    }
}

/// The mean of the finite values; NaN without any.
fn mean(values: &[f64]) -> f64 {
    let numbers = values.iter().filter(|value| value.is_finite());
    let (count, sum) = numbers.fold((0.0, 0.0), |(count, sum), value| (count + 1.0, sum + value));
    sum / count
}
