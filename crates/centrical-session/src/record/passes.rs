//! The two passes of a reduction over the record in a file, in memory that does not grow with it. A record that is not too
//! long is read once.

use std::path::Path;

use centrical::reduction::{Record, RecordSlice, Survey};
use centrical_table::{Block, Extent, Index};
use rayon::prelude::*;

use super::kept::Kept;
use super::{Columns, Wanted, stretch};
use crate::error::Error;

/// Samples of the windows that are averaged at a time, however many threads there are: their times are written out, 8 bytes each, and
/// what is judged one by one is copied.
const AT_A_TIME: usize = 1_500_000;

/// What is done with the samples of windows.
pub(crate) trait Windows: Sync {
    /// A window that is under way, and what comes of it.
    type Window: Send;
    type Mean: Send;

    /// Windows, in ascending order, each in parts that are easily held: from and to [s].
    fn parts(&self) -> Vec<Vec<[f64; 2]>>;

    /// Begins a window.
    fn begin(&self, window: usize) -> Self::Window;

    /// Takes the samples of the next part; so many with the stamp of the one before are not among them.
    fn add(&self, window: &mut Self::Window, part: [f64; 2], samples: RecordSlice, repeated: usize);

    /// Ends a window.
    fn end(&self, window: Self::Window) -> Self::Mean;
}

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

    pub fn file(&self) -> &'a Path {
        self.file
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

    /// Second pass: what comes of the windows. Of a record that is not kept, a part of a window at a time is held.
    pub fn windows<W: Windows>(&self, kept: &Kept, windows: &W) -> Result<Vec<W::Mean>, Error> {
        let parts = windows.parts();
        if kept.is_whole {
            (self.progress)(std::fs::metadata(self.file).map_or(0, |file| file.len()));
            return Ok(kept_windows(kept, windows, &parts));
        }
        match &kept.index {
            Some(index) => self.windows_reread(index, windows, &parts),
            None => self.windows_in_order(windows, &parts),
        }
    }

    /// Part after part: while one is worked on, the next is read.
    fn windows_reread<W: Windows>(
        &self,
        index: &Index,
        windows: &W,
        parts: &[Vec<[f64; 2]>],
    ) -> Result<Vec<W::Mean>, Error> {
        let fields = self.wanted.fields();
        let mut record = index.reread(self.file, &fields)?;
        let mut read = |part: [f64; 2], samples: &mut Record| {
            let raw = self.raw_range(part);
            samples.clear();
            record.read(raw, &mut |first_row, block| {
                self.wanted.to_si(first_row, block);
                samples.extend(stretch(block).between(part));
                self.wanted.give_back(block);
            })?;
            (self.progress)(index.bytes(raw));
            Ok::<(), Error>(())
        };
        let steps: Vec<(usize, [f64; 2])> =
            (parts.iter().enumerate()).flat_map(|(k, parts)| parts.iter().map(move |part| (k, *part))).collect();
        let [mut samples, mut next] = [Record::default(), Record::default()];
        steps.first().map_or(Ok(()), |(_, part)| read(*part, &mut samples))?;
        let mut means = Vec::with_capacity(parts.len());
        let mut window = None;
        for (i, (k, part)) in steps.iter().enumerate() {
            let following = steps.get(i + 1);
            let window_of_part = window.get_or_insert_with(|| windows.begin(*k));
            let ((), was_read) = rayon::join(
                || windows.add(window_of_part, *part, samples.as_slice(), 0),
                || following.map_or(Ok(()), |(_, part)| read(*part, &mut next)),
            );
            was_read?;
            std::mem::swap(&mut samples, &mut next);
            if following.is_none_or(|(next, _)| next != k) {
                means.extend(window.take().map(|window| windows.end(window)));
            }
        }
        Ok(means)
    }

    /// What the first column has in a window. The rounding of its scale is made up for by a part in 10^12.
    fn raw_range(&self, window: [f64; 2]) -> [f64; 2] {
        let [from, to] = window.map(|t| self.wanted.columns[0].scale.raw(t));
        let slack = 1e-12 * from.abs().max(to.abs());
        [from - slack, to + slack]
    }

    fn windows_in_order<W: Windows>(&self, windows: &W, parts: &[Vec<[f64; 2]>]) -> Result<Vec<W::Mean>, Error> {
        let begin =
            |k: usize| UnderWay { window: Some(windows.begin(k)), added: 0, samples: Record::default(), mean: None };
        let mut under_way: Vec<UnderWay<W>> = (0..parts.len()).map(begin).collect();
        let mut visit = |stretch: RecordSlice| {
            for (of, parts) in under_way.iter_mut().zip(parts) {
                while let Some(part) = parts.get(of.added) {
                    of.samples.extend(stretch.between(*part));
                    // A part is full once a later sample has come.
                    if stretch.t.last().is_none_or(|last| *last <= part[1]) {
                        break;
                    }
                    of.add(windows, parts);
                }
            }
        };
        self.wanted.read(self.file, Extent::Whole, self.progress, &mut |blocks| {
            for block in blocks {
                visit(stretch(block));
            }
        })?;
        let end = |(mut of, parts): (UnderWay<W>, &Vec<[f64; 2]>)| {
            while of.added < parts.len() {
                of.add(windows, parts);
            }
            of.mean
        };
        Ok(under_way.into_iter().zip(parts).filter_map(end).collect())
    }
}

/// A window whose samples come in the order of the record.
struct UnderWay<W: Windows> {
    window: Option<W::Window>,
    /// Parts that are added, and the samples of the next.
    added: usize,
    samples: Record,
    /// What came of it, after the last part.
    mean: Option<W::Mean>,
}

impl<W: Windows> UnderWay<W> {
    /// Adds the next of its parts.
    fn add(&mut self, windows: &W, parts: &[[f64; 2]]) {
        if let Some(window) = &mut self.window {
            windows.add(window, parts[self.added], self.samples.as_slice(), 0);
        }
        self.samples.clear();
        self.added += 1;
        if self.added == parts.len() {
            self.samples = Record::default();
            self.mean = self.window.take().map(|window| windows.end(window));
        }
    }
}

/// What comes of windows of a record that is kept.
fn kept_windows<W: Windows>(kept: &Kept, windows: &W, parts: &[Vec<[f64; 2]>]) -> Vec<W::Mean> {
    let of = |(k, parts): (usize, &Vec<[f64; 2]>)| {
        let mut window = windows.begin(k);
        for part in parts {
            kept.between(*part, |samples, repeated| windows.add(&mut window, *part, samples, repeated));
        }
        windows.end(window)
    };
    let numbered: Vec<(usize, &Vec<[f64; 2]>)> = parts.iter().enumerate().collect();
    let mut averaged = Vec::with_capacity(parts.len());
    let mut rest = numbered.as_slice();
    while !rest.is_empty() {
        let mut samples = 0;
        let is_beyond = |(_, parts): &(usize, &Vec<[f64; 2]>)| {
            samples += parts.iter().map(|part| kept.samples_in(*part)).max().unwrap_or(0);
            samples > AT_A_TIME
        };
        let (together, later) = rest.split_at(rest.iter().position(is_beyond).unwrap_or(rest.len()).max(1));
        averaged.par_extend(together.par_iter().copied().map(of));
        rest = later;
    }
    averaged
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

    /// The number of a window, its samples without those with the stamp of the one before, and how many these are.
    type Gathering = (usize, Record, usize);

    /// Windows whose samples are gathered.
    struct Gathered;

    impl Windows for Gathered {
        type Window = Gathering;
        type Mean = Gathering;

        fn parts(&self) -> Vec<Vec<[f64; 2]>> {
            // The second in two parts, the last in three; the third begins before the second ends.
            let second = vec![[3.5, 10.0], [10.0_f64.next_up(), 17.25]];
            let last = vec![[20.0, 20.0], [20.0_f64.next_up(), 20.5], [20.5_f64.next_up(), 39.5]];
            vec![vec![[0.0, 3.0]], second, vec![[17.2, 17.3]], last]
        }

        fn begin(&self, window: usize) -> Gathering {
            (window, Record::default(), 0)
        }

        fn add(
            &self,
            (_, record, all_repeated): &mut Gathering,
            part: [f64; 2],
            samples: RecordSlice,
            left_out: usize,
        ) {
            let samples = samples.between(part);
            let repeated = samples.repeated(f64::NEG_INFINITY);
            record.extend(samples.without(&repeated).as_slice());
            *all_repeated += left_out + repeated.len();
        }

        fn end(&self, window: Gathering) -> Gathering {
            window
        }
    }

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
        let samples = |file: &Path, most: usize| -> Vec<Gathering> {
            let (columns, room) = (Columns::default(), Room::of(most));
            let mut kept = Kept::new(&room);
            let record = RecordFile::new(file, &columns, &|_| {});
            record.survey(&mut kept).unwrap();
            assert_eq!(kept.is_whole, most > 0);
            record.windows(&kept, &Gathered).unwrap()
        };
        let all = 40_000 * 32;
        let expected = samples(&plain, all);
        let counts: Vec<(usize, usize)> =
            expected.iter().map(|(_, record, repeated)| (record.t.len(), *repeated)).collect();
        assert_eq!(counts, [(2998, 3), (13_737, 14), (101, 0), (19_482, 19)]);
        assert!(samples(&plain, 0) == expected && samples(&packed, 0) == expected && samples(&packed, all) == expected);
    }
}
