//! From a record of readings to a record of specific forces, in memory that does not grow with it.

use std::path::Path;
use std::sync::mpsc::{Receiver, sync_channel};
use std::thread;

use centrical::reduction::RecordSlice;
use centrical_compensate::Compensation;

use crate::error::{Error, Place};
use crate::record::{Columns, scan_record};
use crate::record_writer::RecordWriter;

/// What became of a record.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Compensated {
    /// Readings.
    pub readings: u64,
    /// Of these, readings that no specific force within the range gives; they are written as NaN.
    pub outside: u64,
    /// The first of those.
    pub first_outside: Option<FirstOutside>,
    /// Decimals of the specific forces as they are written [m/s^2], if they are rounded.
    pub decimals: Option<u32>,
}

/// A reading from out of range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FirstOutside {
    /// Its time [s].
    pub t: f64,
    /// The reading [m/s^2].
    pub reading: [f64; 3],
}

/// Compensates the record in `input` into `output`, CSV or Parquet by its name. The same bytes on any machine.
///
/// Time is written as it was read, to the bit. So are specific forces as Parquet has them; as CSV has them, they are rounded to at
/// most `10^-12` of the range ([`RecordWriter::create_rounded`]).
///
/// # Errors
/// As [`scan_record`] for `input` and [`RecordWriter`] for `output`, which is not touched then.
pub fn compensate_record(
    compensation: &Compensation,
    input: &Path,
    columns: &Columns,
    output: &Path,
) -> Result<Compensated, Error> {
    /// Blocks read ahead: enough that neither side waits for a hiccup of the other.
    const AHEAD: usize = 8;
    let writer = RecordWriter::create_rounded(output, compensation.certificate().range)?;
    let (blocks, received) = sync_channel(AHEAD);
    thread::scope(|scope| {
        let written = scope.spawn(move || write(compensation, input, &received, writer));
        let scanned = scan_record(input, columns, &mut |block| {
            // A writer that has failed no longer listens; its error is told below.
            let _ = blocks.send((block.t.to_vec(), block.f_z.map(<[f64]>::to_vec)));
        });
        drop(blocks);
        let (compensated, writer) = written.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))?;
        scanned?;
        writer.finish()?;
        Ok(compensated)
    })
}

/// A stretch of a record on its way from reader to writer.
type Block = (Vec<f64>, [Vec<f64>; 3]);

/// Compensates and writes blocks until no more come.
fn write(
    compensation: &Compensation,
    input: &Path,
    blocks: &Receiver<Block>,
    mut writer: RecordWriter,
) -> Result<(Compensated, RecordWriter), Error> {
    let mut sum = Compensated { decimals: writer.decimals(), ..Compensated::default() };
    let mut f = [const { Vec::new() }; 3];
    while let Ok((t, readings)) = blocks.recv() {
        for (f, readings) in f.iter_mut().zip(&readings) {
            f.clear();
            f.extend_from_slice(readings);
        }
        let outside = compensation
            .apply_all(f.each_mut().map(Vec::as_mut_slice))
            .map_err(|unequal| Error::content(input, Place::Whole, unequal.to_string(), "columns of equal length"))?;
        let first = || outside.first.map(|k| FirstOutside { t: t[k], reading: readings.each_ref().map(|f| f[k]) });
        sum.readings += t.len() as u64;
        sum.outside += outside.count as u64;
        sum.first_outside = sum.first_outside.or_else(first);
        writer.write(RecordSlice { t: &t, f_z: f.each_ref().map(Vec::as_slice) })?;
    }
    Ok((sum, writer))
}
