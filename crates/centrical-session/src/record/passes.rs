//! The two passes of a reduction over the record in a file, in memory that does not grow with it. A record that is not too
//! long is read once.

use centrical::reduction::{Averaging, Located, PlateauFit, Record, ReductionError, Survey};
use centrical::{OnProgress, advance};
use centrical_table::{Extent, Source};
use rayon::prelude::*;

use super::columns::Columns;
use super::reader::{RecordIndex, RecordReader, stretch};
use super::sample_cache::SampleCache;
use crate::error::Error;

/// Samples of the plateaus that are averaged at a time, whatever the number of threads: their times are written out, 8 bytes each,
/// and what is judged one by one is copied.
const SAMPLES_AT_A_TIME: usize = 1_500_000;

/// The mean of a plateau, or why it is missing.
type Mean = Result<PlateauFit, ReductionError>;

/// The record in a file.
pub(crate) struct RecordFile<'a> {
    /// One, or three of the newtonometers.
    sources: Vec<Source>,
    columns: &'a Columns,
    /// Bytes as they are read.
    progress: OnProgress<'a>,
}

impl<'a> RecordFile<'a> {
    pub fn new(sources: Vec<Source>, columns: &'a Columns, progress: OnProgress<'a>) -> Self {
        Self { sources, columns, progress }
    }

    /// First pass: surveys the record, its stretches condensed on all threads, and keeps its samples if they are not too
    /// many. The survey, and how many readings of each newtonometer were interpolated to the stamps of another one, if any.
    pub fn survey(&self, cache: &mut SampleCache) -> Result<(Survey, Option<[u64; 3]>), Error> {
        let mut record = RecordReader::open_all(self.sources.clone(), Extent::Whole, self.columns)?;
        let mut beginning = Record::default();
        let mut survey: Option<Survey> = None;
        cache.begin();
        while let Some(batch) = record.next_batch()? {
            if let Some(survey) = &mut survey {
                let condense = || batch.par_iter().map(|rows| survey.condense(stretch(rows))).collect();
                let keep = || batch.iter().for_each(|rows| cache.extend(stretch(rows)));
                let (condensed, ()): (Vec<_>, ()) = rayon::join(condense, keep);
                for stretch in condensed {
                    survey.append(stretch);
                }
            } else {
                for rows in batch {
                    cache.extend(stretch(rows));
                    beginning.extend(stretch(rows));
                }
                if beginning.t.len() >= Survey::BEGINNING {
                    survey = Some(begin(&std::mem::take(&mut beginning)));
                }
            }
            advance(self.progress, record.newly_read())?;
        }
        advance(self.progress, record.newly_read())?;
        let interpolated = record.interpolated();
        cache.index = record.into_index();
        let mut survey = survey.unwrap_or_else(|| begin(&beginning));
        survey.finish();
        Ok((survey, interpolated))
    }

    /// Second pass: the means of the plateaus. Of a record that is not kept, a part of a plateau at a time is held.
    pub fn means(&self, cache: &SampleCache, located: &Located) -> Result<Vec<Mean>, Error> {
        let plateaus: Vec<Averaging> = (0..located.windows().len()).map(|k| Averaging::new(located, k)).collect();
        match &cache.index {
            _ if cache.is_whole => {
                advance(self.progress, self.sources.iter().map(Source::length).sum())?;
                self.means_of_cache(cache, plateaus)
            }
            Some(index) => self.means_reread(index, plateaus),
            None => self.means_in_order(plateaus),
        }
    }

    /// The means of the plateaus of a record that is kept.
    fn means_of_cache(&self, cache: &SampleCache, mut plateaus: Vec<Averaging>) -> Result<Vec<Mean>, Error> {
        let mut means = Vec::with_capacity(plateaus.len());
        while !plateaus.is_empty() {
            let mut samples = 0;
            let is_beyond = |plateau: &Averaging| {
                samples += plateau.open_parts().map(|part| cache.samples_in(part)).max().unwrap_or(0);
                samples > SAMPLES_AT_A_TIME
            };
            let later = plateaus.split_off(plateaus.iter().position(is_beyond).unwrap_or(plateaus.len()).max(1));
            // Times are written to the same memory again and again: memory that is asked for anew is faulted in anew, page by page.
            means.par_extend(plateaus.into_par_iter().map_init(Vec::new, |times, mut plateau| {
                while let Some(part) = plateau.next_part() {
                    let (samples, repeated) = cache.between(part, times);
                    plateau.add(samples, repeated);
                }
                plateau.finish(Record::default().as_slice())
            }));
            plateaus = later;
            advance(self.progress, 0)?;
        }
        Ok(means)
    }

    /// Part after part: while one is worked on, the next is read.
    fn means_reread(&self, index: &RecordIndex, mut plateaus: Vec<Averaging>) -> Result<Vec<Mean>, Error> {
        let mut record = index.parts();
        let mut read = |part: [f64; 2], samples: &mut Record| {
            Ok::<(), Error>(advance(self.progress, record.read(part, samples)?)?)
        };
        let parts: Vec<(usize, [f64; 2])> = (plateaus.iter().enumerate())
            .flat_map(|(k, plateau)| plateau.open_parts().map(move |part| (k, part)))
            .collect();
        let [mut samples, mut next] = [Record::default(), Record::default()];
        parts.first().map_or(Ok(()), |(_, part)| read(*part, &mut samples))?;
        for (i, (k, _)) in parts.iter().enumerate() {
            let ((), was_read) = rayon::join(
                || plateaus[*k].add(samples.as_slice(), 0),
                || parts.get(i + 1).map_or(Ok(()), |(_, part)| read(*part, &mut next)),
            );
            was_read?;
            std::mem::swap(&mut samples, &mut next);
        }
        Ok(plateaus.into_iter().map(|plateau| plateau.finish(Record::default().as_slice())).collect())
    }

    /// All of the record once more, where it can only be read from its start.
    fn means_in_order(&self, mut plateaus: Vec<Averaging>) -> Result<Vec<Mean>, Error> {
        let mut record = RecordReader::open_all(self.sources.clone(), Extent::Whole, self.columns)?;
        let mut gathered: Vec<Record> = plateaus.iter().map(|_| Record::default()).collect();
        while let Some(batch) = record.next_batch()? {
            for stretch in batch.iter().map(stretch) {
                for (plateau, samples) in plateaus.iter_mut().zip(&mut gathered) {
                    while let Some(part) = plateau.next_part() {
                        samples.extend(stretch.between(part));
                        // A part is complete once a later sample has been read.
                        if stretch.t.last().is_none_or(|last| *last <= part[1]) {
                            break;
                        }
                        plateau.add(samples.as_slice(), 0);
                        samples.clear();
                    }
                    if plateau.next_part().is_none() {
                        *samples = Record::default();
                    }
                }
            }
            advance(self.progress, record.newly_read())?;
        }
        advance(self.progress, record.newly_read())?;
        let plateaus = plateaus.into_iter().zip(gathered);
        Ok(plateaus.map(|(plateau, samples)| plateau.finish(samples.as_slice())).collect())
    }
}

fn begin(beginning: &Record) -> Survey {
    let mut survey = Survey::new(&beginning.t);
    survey.append(survey.condense(beginning.as_slice()));
    survey
}
