//! What the files of one mounting show: plateaus, the readings there, and the coarse scale and bias of a raw output.

use std::path::PathBuf;

use centrical::reduction::SteadyStretch;
use centrical::{OnProgress, STANDARD_GRAVITY, advance};
use centrical_table::ColumnName;

use super::column_names::{Label, SAMPLES};
use super::file_roles::{FileColumns, Group, counts};
use crate::error::Error;
use crate::experiment::Folder;
use crate::record::{Column, Columns, RecordReader, Scale, read_telemetry};
use crate::units::Dimension;

/// The part of a plateau over which readings are averaged: its middle, which clocks that differ by seconds share.
const MIDDLE: [f64; 2] = [0.35, 0.65];

/// Samples of a reading are thinned to this step [s] where plateaus are sought in them.
const STEP: f64 = 0.05;

/// Samples per second of what counts them, until a rate is stated.
pub(super) const NOMINAL_RATE: f64 = 100.0;

/// The files of a mounting and what they show.
#[derive(Debug)]
pub(super) struct SeenMounting {
    pub group: Group,
    pub plateaus: Vec<SeenPlateau>,
    /// Samples per second; of a count of samples, by the length of the telemetry.
    pub rate: Option<f64>,
    /// Whether nothing tells the seconds of the plateaus: their windows are samples at [`NOMINAL_RATE`].
    pub is_counted: bool,
}

/// A plateau, and what is known of it.
#[derive(Debug, Clone)]
pub(super) struct SeenPlateau {
    pub window: [f64; 2],
    /// By the telemetry [rad/s], with its standard uncertainty.
    pub speed: Option<[f64; 2]>,
    /// Mean readings, in their unit as it is written.
    pub readings: Option<[f64; 3]>,
}

/// Reads the files of a mounting. Where the record and the telemetry have no clock in common, since one of them counts samples, the
/// plateaus of the readings are those of the telemetry in their order, if there are as many.
pub(super) fn sight(group: Group, progress: OnProgress) -> Result<SeenMounting, Error> {
    let is_counted = group.records[0].is_counted();
    let trace = match &group.telemetry {
        Some(telemetry) => Some(read_telemetry(&telemetry.path, &columns_of(telemetry))?),
        None => None,
    };
    let mut columns = columns_of_records(&group.records);
    if let Some(trace) = trace.as_ref().filter(|_| is_counted) {
        let samples = Seen::of(&group, &columns, &[], false, progress)?.samples;
        let length = length(&trace.t);
        if samples > 1 && length > 0.0 {
            columns.time.scale = Scale::factor(length / (samples - 1) as f64);
        }
    }
    let length = trace.as_ref().map(|trace| length(&trace.t));
    let stretches = trace.map(|trace| SteadyStretch::all(&trace.t, &trace.omega));
    let has_clock = !is_counted && group.telemetry.as_ref().is_some_and(|telemetry| !telemetry.is_counted());
    let windows: Vec<[f64; 2]> = match &stretches {
        Some(stretches) if has_clock => stretches.iter().map(|stretch| stretch.window).collect(),
        _ => {
            let thinned = Seen::of(&group, &columns, &[], true, progress)?.thinned;
            let (times, magnitudes): (Vec<f64>, Vec<f64>) = thinned.into_iter().unzip();
            SteadyStretch::all(&times, &magnitudes).iter().map(|stretch| stretch.window).collect()
        }
    };
    let mut plateaus: Vec<SeenPlateau> = match &stretches {
        Some(stretches) => stretches.iter().map(SeenPlateau::of_telemetry).collect(),
        None => windows.iter().map(|window| SeenPlateau { window: *window, speed: None, readings: None }).collect(),
    };
    let seen = Seen::of(&group, &columns, &windows, false, progress)?;
    if let Some(length) = length.filter(|_| has_clock)
        && let Some(group) = in_unit_of_time(&group, seen.length() / length)
    {
        return sight(group, progress);
    }
    if seen.sums.len() == plateaus.len() {
        for (plateau, (sum, count)) in plateaus.iter_mut().zip(&seen.sums) {
            plateau.readings = (*count > 0).then(|| sum.map(|sum| sum / *count as f64));
        }
    }
    let is_counted = group.telemetry.as_ref().map_or(is_counted, FileColumns::is_counted);
    Ok(SeenMounting { group, plateaus, rate: seen.rate(), is_counted })
}

fn length(times: &[f64]) -> f64 {
    times.last().zip(times.first()).map_or(0.0, |(last, first)| last - first)
}

/// The files with a unit of time where they state none. `ratio` is the length of the record over that of its telemetry: a unit that explains it,
/// or a count of samples, is taken.
fn in_unit_of_time(group: &Group, ratio: f64) -> Option<Group> {
    const UNITS: [&str; 5] = ["ms", "us", "ns", "min", "h"];
    /// Record and telemetry begin and end together, but for a tenth.
    const ABOUT: f64 = 0.1;
    let unit_of = |ratio: f64| {
        let is_near = |unit: &&str| {
            let factor = Dimension::Time.factor(unit).unwrap_or(f64::NAN);
            (ratio * factor - 1.0).abs() < ABOUT
        };
        UNITS.into_iter().find(is_near)
    };
    let is_open = |file: &FileColumns| file.time.as_ref().is_some_and(|time| time.unit.is_none());
    let take = |file: &mut FileColumns, unit| {
        if let Some(time) = &mut file.time {
            time.unit = Some(unit);
            time.unit_guess =
                Some("the file names no unit; in s the record and its telemetry would not be equally long");
        }
    };
    let mut group = group.clone();
    if group.records.iter().all(is_open) {
        let is_count = |file: &FileColumns| file.time.as_ref().is_some_and(|time| counts(&file.path, &time.column));
        let samples = || (ratio > 1.0 + ABOUT && group.records.iter().all(is_count)).then_some(SAMPLES);
        if let Some(unit) = unit_of(ratio).or_else(samples) {
            group.records.iter_mut().for_each(|file| take(file, unit));
            return Some(group);
        }
    }
    let telemetry = group.telemetry.as_mut().filter(|file| is_open(file))?;
    take(telemetry, unit_of(1.0 / ratio)?);
    Some(group)
}

/// What a pass over a record collects.
#[derive(Default)]
struct Seen {
    sums: Vec<([f64; 3], usize)>,
    /// Times and magnitudes, thinned.
    thinned: Vec<(f64, f64)>,
    first: Option<f64>,
    last: f64,
    samples: usize,
}

impl Seen {
    /// Sums the readings in the middle of every window, or keeps thinned magnitudes.
    fn of(
        group: &Group,
        columns: &Columns,
        windows: &[[f64; 2]],
        is_thinned: bool,
        progress: OnProgress,
    ) -> Result<Self, Error> {
        let mut seen = Self { sums: vec![([0.0; 3], 0); windows.len()], ..Self::default() };
        let middle = |[start, end]: &[f64; 2]| MIDDLE.map(|part| start + part * (end - start));
        let middles: Vec<[f64; 2]> = windows.iter().map(middle).collect();
        let files: Vec<_> = group.records.iter().map(|file| file.path.clone()).collect();
        let sources = Folder::default().open_record(&files)?;
        let mut reader = RecordReader::open_all(sources, centrical_table::Extent::Whole, columns)?;
        while let Some(batch) = reader.next_batch()? {
            advance(progress, 0)?;
            for rows in batch {
                for (n, &t) in rows[0].iter().enumerate() {
                    let f = [rows[1][n], rows[2][n], rows[3][n]];
                    seen.take(t, f, &middles, is_thinned);
                }
            }
        }
        Ok(seen)
    }

    fn take(&mut self, t: f64, f: [f64; 3], middles: &[[f64; 2]], is_thinned: bool) {
        self.first.get_or_insert(t);
        (self.last, self.samples) = (t, self.samples + 1);
        if f.iter().any(|f| !f.is_finite()) {
            return;
        }
        if is_thinned && self.thinned.last().is_none_or(|(last, _)| t - last >= STEP) {
            self.thinned.push((t, f.iter().map(|f| f * f).sum::<f64>().sqrt()));
        }
        // The plateaus follow each other in time.
        let plateau = middles.partition_point(|middle| middle[1] < t);
        if middles.get(plateau).is_some_and(|middle| middle[0] <= t) {
            let (sum, count) = &mut self.sums[plateau];
            sum.iter_mut().zip(f).for_each(|(sum, f)| *sum += f);
            *count += 1;
        }
    }

    fn length(&self) -> f64 {
        self.first.map_or(0.0, |first| self.last - first)
    }

    fn rate(&self) -> Option<f64> {
        let time = self.length();
        (time > 0.0).then(|| (self.samples - 1) as f64 / time)
    }
}

/// Columns of a record whose readings stay in the unit that the file has.
fn columns_of_records(records: &[FileColumns]) -> Columns {
    let mut columns = columns_of(&records[0]);
    let raw = |label: &Label| Column {
        name: label.column.clone(),
        unit: label.unit.unwrap_or("as it is").to_owned(),
        scale: Scale::factor(1.0),
    };
    if records.len() == 3 {
        for (column, record) in columns.f.iter_mut().zip(records) {
            *column = raw(&record.readings[0]);
        }
    } else {
        for (column, label) in columns.f.iter_mut().zip(&records[0].readings) {
            *column = raw(label);
        }
    }
    columns
}

/// What takes the numbers of a column to SI, as far as its unit is known.
fn factor(label: &Label, dimension: Dimension) -> f64 {
    let of_unit = || label.unit.and_then(|unit| dimension.factor(unit)).unwrap_or(1.0);
    if label.is_count() { 1.0 / NOMINAL_RATE } else { of_unit() }
}

/// Time and speed of a file.
fn columns_of(file: &FileColumns) -> Columns {
    let usual = Columns::default();
    let column = |label: &Option<Label>, usual: &Column, dimension: Dimension| match label {
        Some(label) => Column {
            name: label.column.clone(),
            unit: label.unit.unwrap_or(&usual.unit).to_owned(),
            scale: Scale::factor(factor(label, dimension)),
        },
        None => Column { name: ColumnName::Row, scale: Scale::factor(1.0 / NOMINAL_RATE), ..usual.clone() },
    };
    let time = column(&file.time, &usual.time, Dimension::Time);
    Columns { telemetry_time: time.clone(), speed: column(&file.speed, &usual.speed, Dimension::Speed), time, ..usual }
}

impl SeenMounting {
    /// The files of the record.
    pub(super) fn records(&self) -> impl Iterator<Item = &PathBuf> {
        self.group.records.iter().map(|file| &file.path)
    }

    /// Takes speeds, which counted as in rad/s, to the unit that their file does not name.
    pub(super) fn take_speed_unit(&mut self, unit: &'static str) {
        let Some(speed) = self.group.telemetry.as_mut().and_then(|file| file.speed.as_mut()) else { return };
        if speed.unit.is_some() {
            return;
        }
        let factor = Dimension::Speed.factor(unit).unwrap_or(1.0);
        speed.unit = Some(unit);
        speed.unit_guess = Some("the file names no unit; in others the arm would be centimetres or many metres long");
        let speeds = self.plateaus.iter_mut().filter_map(|plateau| plateau.speed.as_mut());
        speeds.flatten().for_each(|value| *value *= factor);
    }

    /// Mean readings at rest and at the fastest plateau, where both are seen.
    pub(super) fn extremes(&self) -> Option<Extremes> {
        let rest = self.plateaus.iter().find(|plateau| plateau.is_rest() == Some(true))?.readings?;
        let speed = |plateau: &&SeenPlateau| plateau.speed.map_or(0.0, |[omega, _]| omega.abs());
        let fastest = self.plateaus.iter().max_by(|a, b| speed(a).total_cmp(&speed(b)))?;
        let omega = speed(&fastest);
        (omega > 0.0).then_some(Extremes { rest, fast: fastest.readings?, omega })
    }
}

impl SeenPlateau {
    fn of_telemetry(stretch: &SteadyStretch) -> Self {
        let speed = Some([stretch.value, stretch.standard_uncertainty]);
        Self { window: stretch.window, speed, readings: None }
    }

    /// Whether the arm is at rest, by the telemetry.
    pub(super) fn is_rest(&self) -> Option<bool> {
        /// A creep that no schedule asks for [rad/s].
        const CREEP: f64 = 0.02;
        self.speed.map(|[omega, _]| omega.abs() < CREEP)
    }
}

/// Mean readings of a mounting at rest and at its fastest speed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Extremes {
    pub rest: [f64; 3],
    pub fast: [f64; 3],
    /// The fastest speed [rad/s].
    pub omega: f64,
}

/// Raw output per m/s^2, and raw output at no force.
#[derive(Debug, Clone, Copy)]
pub(super) struct Raw {
    pub scale: [f64; 3],
    pub bias: [f64; 3],
}

impl Extremes {
    /// In m/s^2.
    pub(super) fn in_si(&self, raw: &Raw) -> Option<Self> {
        let si = |f: [f64; 3]| [0, 1, 2].map(|j| (f[j] - raw.bias[j]) / raw.scale[j]);
        let si = Self { rest: si(self.rest), fast: si(self.fast), omega: self.omega };
        si.rest.iter().chain(&si.fast).all(|f| f.is_finite()).then_some(si)
    }

    /// Radius of the proof mass along the arm [m].
    pub(super) fn radius(&self) -> f64 {
        (0..3).map(|j| (self.fast[j] - self.rest[j]).powi(2)).sum::<f64>().sqrt() / self.omega.powi(2)
    }
}

impl Raw {
    /// Scale and bias from gravity. In most mountings an axis is horizontal: the median of its readings at rest is its bias;
    /// where it is vertical it reads most beside that, which is 1 g. None before three mountings, or without an axis vertical.
    pub(super) fn by_gravity(extremes: &[Option<Extremes>]) -> Option<Self> {
        let rests: Vec<[f64; 3]> = extremes.iter().flatten().map(|e| e.rest).collect();
        if rests.len() < 3 {
            return None;
        }
        let of_axis = |j: usize| {
            let mut readings: Vec<f64> = rests.iter().map(|rest| rest[j]).collect();
            readings.sort_by(f64::total_cmp);
            let bias = readings[readings.len() / 2];
            let most = readings.iter().map(|reading| (reading - bias).abs()).fold(0.0, f64::max);
            (most / STANDARD_GRAVITY, bias)
        };
        let [x, y, z] = [0, 1, 2].map(of_axis);
        let raw = Self { scale: [x.0, y.0, z.0], bias: [x.1, y.1, z.1] };
        let largest = raw.scale.iter().copied().fold(0.0, f64::max);
        raw.scale.iter().all(|scale| *scale > 0.1 * largest).then_some(raw)
    }
}
