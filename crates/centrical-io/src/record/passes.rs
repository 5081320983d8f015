//! The two passes of a reduction over the record in a file, in memory that does not grow with it. A record that is not too
//! long is read once.

use std::path::Path;

use centrical::reduction::{Record, RecordSlice, Survey};
use rayon::prelude::*;

use super::kept::Kept;
use super::{Columns, Wanted, stretch};
use crate::error::Error;
use crate::table::{Block, Extent, Index};

/// Samples of the windows that are averaged at a time, however many threads there are: a window without its repeated stamps is
/// a copy, of 32 bytes a sample.
const AT_A_TIME: usize = 1_500_000;

/// The record in a file.
pub(crate) struct RecordFile<'a> {
    file: &'a Path,
    wanted: Wanted<'a>,
    /// Told of bytes as they are read.
    progress: &'a (dyn Fn(u64) + Sync),
}

impl<'a> RecordFile<'a> {
    pub fn new(file: &'a Path, columns: &'a Columns, progress: &'a (dyn Fn(u64) + Sync)) -> Self {
        Self { file, wanted: columns.of_record(), progress }
    }

    /// First pass: all of the record, its stretches condensed on all threads, and its samples kept if they are not too
    /// many.
    pub fn survey(&self, kept: &mut Kept) -> Result<Survey, Error> {
        let mut beginning = Record::default();
        let mut survey: Option<Survey> = None;
        kept.begin();
        kept.index = self.wanted.read(self.file, Extent::Whole, self.progress, &mut |blocks: &mut [Block]| {
            if let Some(survey) = &mut survey {
                let condense = || blocks.par_iter().map(|block| survey.condense(stretch(block))).collect();
                let keep = || blocks.iter().for_each(|block| kept.extend(stretch(block)));
                let (condensed, ()): (Vec<_>, ()) = rayon::join(condense, keep);
                for stretch in condensed {
                    survey.append(stretch);
                }
            } else {
                for block in blocks {
                    kept.extend(stretch(block));
                    beginning.extend(stretch(block));
                }
                if beginning.t.len() >= Survey::BEGINNING {
                    survey = Some(begin(&std::mem::take(&mut beginning)));
                }
            }
        })?;
        let mut survey = survey.unwrap_or_else(|| begin(&beginning));
        survey.finish();
        Ok(survey)
    }

    /// Second pass: calls `average` with the number of each window, from and to [s], in ascending order, its samples, and
    /// how many with the stamp of the one before are not among them. Of a record that is not kept, one window at a time is held.
    pub fn windows<T: Send>(
        &self,
        kept: &Kept,
        windows: &[[f64; 2]],
        average: &(dyn Fn(usize, RecordSlice, usize) -> T + Sync),
    ) -> Result<Vec<T>, Error> {
        if kept.is_whole {
            let of = |(k, window): (usize, &[f64; 2])| {
                kept.between(*window, |samples, repeated| average(k, samples, repeated))
            };
            let numbered: Vec<(usize, &[f64; 2])> = windows.iter().enumerate().collect();
            let mut averaged = Vec::with_capacity(windows.len());
            let mut rest = numbered.as_slice();
            while !rest.is_empty() {
                let mut samples = 0;
                let is_beyond = |(_, window): &(usize, &[f64; 2])| {
                    samples += kept.samples_in(**window);
                    samples > AT_A_TIME
                };
                let (together, later) = rest.split_at(rest.iter().position(is_beyond).unwrap_or(rest.len()).max(1));
                averaged.par_extend(together.par_iter().copied().map(of));
                rest = later;
            }
            (self.progress)(std::fs::metadata(self.file).map_or(0, |file| file.len()));
            return Ok(averaged);
        }
        match &kept.index {
            Some(index) => {
                let one = |(k, window): (usize, &[f64; 2])| {
                    self.samples(index, *window).map(|samples| average(k, samples.as_slice(), 0))
                };
                windows.iter().enumerate().map(one).collect()
            }
            None => self.windows_in_order(windows, average),
        }
    }

    /// The samples of one window.
    fn samples(&self, index: &Index, window: [f64; 2]) -> Result<Record, Error> {
        let raw = self.raw_range(window);
        let mut samples = Record::default();
        index.read(self.file, &self.wanted.fields(), raw, &mut |first_row, block| {
            self.wanted.to_si(first_row, block);
            samples.extend(stretch(block).between(window));
            self.wanted.give_back(block);
        })?;
        (self.progress)(index.bytes(raw));
        Ok(samples)
    }

    /// What the first column has in a window. The rounding of its scale is made up for by a part in 10^12.
    fn raw_range(&self, window: [f64; 2]) -> [f64; 2] {
        let [from, to] = window.map(|t| self.wanted.columns[0].scale.raw(t));
        let slack = 1e-12 * from.abs().max(to.abs());
        [from - slack, to + slack]
    }

    fn windows_in_order<T>(
        &self,
        windows: &[[f64; 2]],
        average: &(dyn Fn(usize, RecordSlice, usize) -> T + Sync),
    ) -> Result<Vec<T>, Error> {
        let mut averaged = Vec::with_capacity(windows.len());
        let mut samples = vec![Record::default(); windows.len()];
        let mut visit = |stretch: RecordSlice| {
            for (window, samples) in windows.iter().zip(&mut samples).skip(averaged.len()) {
                samples.extend(stretch.between(*window));
            }
            // A window is full once a later sample has come.
            while let Some([_, to]) = windows.get(averaged.len())
                && stretch.t.last().is_some_and(|last| last > to)
            {
                let k = averaged.len();
                averaged.push(average(k, std::mem::take(&mut samples[k]).as_slice(), 0));
            }
        };
        self.wanted.read(self.file, Extent::Whole, self.progress, &mut |blocks| {
            for block in blocks {
                visit(stretch(block));
            }
        })?;
        for k in averaged.len()..windows.len() {
            averaged.push(average(k, samples[k].as_slice(), 0));
        }
        Ok(averaged)
    }
}

fn begin(beginning: &Record) -> Survey {
    let mut survey = Survey::new(&beginning.t);
    survey.append(survey.condense(beginning.as_slice()));
    survey
}

#[cfg(test)]
mod tests {
    use std::fs::{self, File};
    use std::io::Write;

    use flate2::{Compression, write::GzEncoder};

    use super::super::kept::Room;
    use super::*;

    /// The samples of windows, of records read once, again by its index, and again from start to end.
    #[test]
    fn a_window_is_the_same_kept_or_read_again() {
        let folder = tempfile::tempdir().unwrap();
        let (plain, packed) = (folder.path().join("record.csv"), folder.path().join("record.csv.gz"));
        // Every thousandth stamp is that of the one before.
        let t = |i: i32| f64::from(i - i32::from(i % 1000 == 999)) * 1e-3;
        let rows = (0..40_000).map(|i| format!("{},{},-{}.5,{}e-3\n", t(i), i % 977, i % 11, i * i % 1009));
        let text: String = std::iter::once("t,f1,f2,f3\n".to_owned()).chain(rows).collect();
        fs::write(&plain, &text).unwrap();
        let mut encoder = GzEncoder::new(File::create(&packed).unwrap(), Compression::fast());
        encoder.write_all(text.as_bytes()).unwrap();
        encoder.finish().unwrap();
        let windows = [[0.0, 3.0], [3.5, 17.25], [17.3, 17.3], [20.0, 39.5]];
        let samples = |file: &Path, most: usize| -> Vec<(usize, Record, usize)> {
            let (columns, room) = (Columns::default(), Room::of(most));
            let mut kept = Kept::new(&room);
            let record = RecordFile::new(file, &columns, &|_| {});
            record.survey(&mut kept).unwrap();
            assert_eq!(kept.is_whole, most > 0);
            let once = |k: usize, samples: RecordSlice, left_out: usize| {
                let repeated = samples.repeated(f64::NEG_INFINITY);
                (k, samples.without(&repeated), left_out + repeated.len())
            };
            record.windows(&kept, &windows, &once).unwrap()
        };
        let all = 40_000 * 32;
        let expected = samples(&plain, all);
        let counts: Vec<(usize, usize)> =
            expected.iter().map(|(_, record, repeated)| (record.t.len(), *repeated)).collect();
        assert_eq!(counts, [(2998, 3), (13_737, 14), (1, 0), (19_482, 19)]);
        assert!(samples(&plain, 0) == expected && samples(&packed, 0) == expected && samples(&packed, all) == expected);
    }
}
