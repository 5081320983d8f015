//! Which files there are, what they hold, and which belong together.

use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use centrical_table::{
    ColumnName, Error as TableError, Extent, Field, Rule, TableReader, TextForm, binary_columns, is_ending_of_table,
    text_form, unit_beside_name,
};

use super::column_names::{Label, SAMPLES, What, sort_by_axis, what};
use crate::error::{Error, Place};

/// Folders are searched to this depth.
const DEPTH: usize = 3;

/// The files of one mounting.
#[derive(Debug, Clone)]
pub(super) struct Group {
    /// The record, or one file for each newtonometer.
    pub records: Vec<FileColumns>,
    pub telemetry: Option<FileColumns>,
}

/// A file and the columns of it.
#[derive(Debug, Clone, Default)]
pub(super) struct FileColumns {
    pub path: PathBuf,
    pub form: Option<TextForm>,
    pub time: Option<Label>,
    pub readings: Vec<Label>,
    pub speed: Option<Label>,
    /// A column with the name of a time that is not read as one.
    pub unread_time: Option<String>,
    /// The number of the row.
    count: Option<Label>,
    /// Rates of turn about axes of the unit, until all columns are taken.
    rates: Vec<Label>,
    /// Whether its readings are named as those of a gyroscope often are: `gx`, `gy`, `gz`.
    is_like_gyroscope: bool,
}

/// The mountings that the files are of, in the natural order of their names, and why other files are not used.
pub(super) fn groups(inputs: &[PathBuf]) -> Result<(Vec<Group>, Vec<TableError>), Error> {
    let mut paths = Vec::new();
    for input in inputs {
        collect(input, DEPTH, true, &mut paths)?;
    }
    paths.sort_by(|a, b| natural(a, b));
    paths.dedup();
    let (mut files, mut unused) = (Vec::new(), Vec::new());
    for path in paths {
        match columns_of(path)? {
            Ok(file) => files.push(file),
            Err(file) => unused.push(file),
        }
    }
    let (records, telemetry): (Vec<_>, Vec<_>) = files.into_iter().partition(|file| !file.readings.is_empty());
    let (gyroscopes, others): (Vec<_>, Vec<_>) = records.into_iter().partition(|file| file.is_like_gyroscope);
    let records = if others.is_empty() {
        gyroscopes
    } else {
        let found = "rates of turn by the names of its columns";
        unused.extend(gyroscopes.iter().map(|file| file.unused(found, "readings or the speed of the arm")));
        others
    };
    let (joined, apart) = joined(records);
    unused.extend(apart.iter().map(|file| {
        let names = file.form.as_ref().map_or(String::new(), |form| format!(" in columns {}", form.names.join(", ")));
        file.unused(&format!("one reading{names}"), "three, or two more files whose names differ in the axis")
    }));
    let mut groups: Vec<Group> = joined.into_iter().map(|records| Group { records, telemetry: None }).collect();
    let expected = "a record of the same name or number";
    unused.extend(pair(&mut groups, telemetry).iter().map(|file| file.unused("a speed", expected)));
    Ok((groups, unused))
}

impl FileColumns {
    /// Whether its rows have no time but their number.
    pub(super) fn is_counted(&self) -> bool {
        self.time.as_ref().is_none_or(Label::is_count)
    }

    /// Columns that have no names, of these numbers from 0, in their usual order; the time may be known.
    fn take_by_number(&mut self, numbers: &[usize]) {
        let mut labels = numbers.iter().copied().map(Label::numbered);
        if self.time.is_none() && matches!(labels.len(), 2 | 4..) {
            self.time = labels.next();
        }
        match labels.len() {
            1 if self.time.is_some() => self.speed = labels.next(),
            3.. => self.readings = labels.take(3).collect(),
            _ => {}
        }
    }

    fn take(&mut self, label: Label, holds: What) {
        match holds {
            What::Time if self.time.is_none() => self.time = Some(label),
            What::Speed if self.speed.is_none() => self.speed = Some(label),
            What::Rate => self.rates.push(label),
            What::Reading => self.readings.push(label),
            What::Count if self.count.is_none() => self.count = Some(label),
            What::Time | What::Speed | What::Count | What::Other => {}
        }
    }

    /// With all columns taken: three readings, or one, or none.
    fn settled(mut self) -> Self {
        take_time(&mut self);
        take_count(&mut self);
        take_rates(&mut self);
        if self.readings.len() != 3 && self.speed.is_some() {
            // Telemetry with other columns beside the speed.
            self.readings.clear();
        }
        self.readings.truncate(3);
        if self.readings.len() == 2 {
            self.readings.clear();
        }
        sort_by_axis(&mut self.readings);
        self
    }

    fn unused(&self, found: &str, expected: &str) -> TableError {
        TableError::content(&self.path, Place::Whole, found, expected)
    }
}

fn collect(path: &Path, depth: usize, is_named: bool, paths: &mut Vec<PathBuf>) -> Result<(), Error> {
    let failed = |error| Error::reading(path, error, "a folder of records, or a record");
    let metadata = fs::metadata(path).map_err(failed)?;
    if !metadata.is_dir() {
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
        if is_named || metadata.is_file() && is_ending_of_table(&ending) {
            paths.push(path.to_owned());
        }
        return Ok(());
    }
    if depth == 0 {
        return Ok(());
    }
    for entry in fs::read_dir(path).map_err(failed)? {
        let entry = entry.map_err(failed)?.path();
        let is_hidden = entry.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
        if !is_hidden {
            collect(&entry, depth - 1, false, paths)?;
        }
    }
    Ok(())
}

/// The columns of a file; or why it is neither a record nor telemetry.
fn columns_of(path: PathBuf) -> Result<Result<FileColumns, TableError>, Error> {
    let (file, names) = match text_form(&path)? {
        Some(form) => {
            let names = match form.names.join(", ") {
                names if names.is_empty() => format!("{} columns without names", form.first_row.len()),
                names => format!("columns {names}"),
            };
            (of_text(path, form), names)
        }
        None => match binary_columns(&path) {
            Ok(columns) => {
                let names = columns.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
                (of_binary(path, &columns), format!("columns {names}"))
            }
            Err(error) => return Ok(Err(error)),
        },
    };
    let is_used = file.speed.is_some() || !file.readings.is_empty();
    let expected = "a time and three readings, or a time and a speed such as \"speed (rpm)\"";
    Ok(if is_used { Ok(file) } else { Err(file.unused(&names, expected)) })
}

/// Columns of a text by their names and units; without a header by their number.
fn of_text(path: PathBuf, form: TextForm) -> FileColumns {
    let unit = |index: usize| form.units.get(index).copied().flatten();
    let mut file = FileColumns { path, ..FileColumns::default() };
    let label = |index: usize| {
        form.names.get(index).map_or_else(|| Label::numbered(index), |name| Label::of_text(name, unit(index)))
    };
    let stamps = form.stamps.map(|stamps| stamps.column);
    let stamp = |time: usize| match form.dates {
        Some(dates) => label(time).on_dates(label(dates)),
        None => label(time),
    };
    let has_values = |index: &usize| form.dates != Some(*index) && !form.has_word(*index);
    if form.names.is_empty() {
        file.time = stamps.map(stamp);
        let others = (0..form.first_row.len()).filter(has_values).filter(|index| stamps != Some(*index));
        file.take_by_number(&others.collect::<Vec<_>>());
    }
    for index in (0..form.names.len()).filter(has_values) {
        let own = label(index);
        let holds = what(&form.names[index], own.unit);
        if stamps == Some(index) { file.take(stamp(index), What::Time) } else { file.take(own, holds) }
    }
    file.form = Some(form);
    file.settled()
}

/// Columns of another table by their names; those of a matrix by their number.
fn of_binary(path: PathBuf, columns: &[ColumnName]) -> FileColumns {
    const STAMPS: Rule = Rule::Ascending { stamps: true };
    let mut file = FileColumns { path, ..FileColumns::default() };
    let numbered = columns.iter().filter(|column| matches!(column, ColumnName::Number(_))).count();
    file.take_by_number(&(0..numbered).collect::<Vec<_>>());
    for column in columns {
        let ColumnName::Name(name) = column else { continue };
        let label = Label::of_text(name, unit_beside_name(name));
        if opens(&file.path, &[(column, Rule::Any)]) {
            let holds = what(name, label.unit);
            file.take(label, holds);
        } else if opens(&file.path, &[(column, STAMPS)]) {
            file.take(label, What::Time);
        } else if what(name, label.unit) == What::Time {
            file.unread_time = Some(name.clone());
        }
    }
    let of_rule = |rule| columns.iter().find(|column| opens(&file.path, &[(column, rule)]));
    if file.time.is_none()
        && let Some((dates, times)) = of_rule(Rule::Date).zip(of_rule(Rule::TimeOfDay))
    {
        let [dates, times] = [dates, times].map(|column| Label::usual(&column.to_string()));
        let both = times.on_dates(dates);
        // Formats without dates take both for numbers.
        file.time = opens(&file.path, &[(&both.column, STAMPS)]).then_some(both);
    }
    // The time of a waveform is that of a reading, and asked for by any name.
    let waveform = Label::usual("t");
    if let (None, Some(reading)) = (&file.time, file.readings.first())
        && opens(&file.path, &[(&reading.column, Rule::Any), (&waveform.column, STAMPS)])
    {
        file.time = Some(waveform);
    }
    file.settled()
}

/// Whether columns of a file hold what their rules ask for.
fn opens(path: &Path, columns: &[(&ColumnName, Rule)]) -> bool {
    open(path, columns).is_ok()
}

fn open(path: &Path, columns: &[(&ColumnName, Rule)]) -> Result<TableReader, TableError> {
    let field = |(name, rule): &(&ColumnName, Rule)| Field {
        name: (*name).clone(),
        expected: "a number".to_owned(),
        rule: *rule,
    };
    TableReader::open(path, Extent::Whole, &columns.iter().map(field).collect::<Vec<_>>(), "a table")
}

/// A first column that rises from row to row, with others behind it, is the time by another name.
fn take_time(file: &mut FileColumns) {
    let enough = if file.speed.is_some() { 1 } else { 4 };
    if file.time.is_none() && file.readings.len() >= enough && rises(&file.path, &file.readings[0].column) {
        let guess = Some("the first column, which rises from row to row");
        file.time = Some(Label { guess, ..file.readings.remove(0) });
    }
}

/// Whole numbers in steps of one that stand for a time count samples.
fn take_count(file: &mut FileColumns) {
    let is_open = file.time.as_ref().is_none_or(|time| time.guess.is_some() && time.unit.is_none());
    let Some(label) = file.time.clone().or(file.count.take()).filter(|_| is_open) else { return };
    if counts(&file.path, &label.column) {
        file.time = Some(Label { unit: Some(SAMPLES), ..label });
    }
}

/// Whether a column of a file is whole numbers in steps of one in its first rows.
pub(super) fn counts(path: &Path, column: &ColumnName) -> bool {
    steps(path, column).is_some_and(|steps| steps.iter().all(|step| *step == 1.0))
}

/// Rates of turn: one is the speed if that is missing; three without a unit may be readings in g.
fn take_rates(file: &mut FileColumns) {
    let rates = std::mem::take(&mut file.rates);
    match rates.as_slice() {
        [rate] if file.speed.is_none() && file.readings.len() != 3 => file.speed = Some(rate.clone()),
        [_, _, _] if file.readings.is_empty() && file.speed.is_none() && rates.iter().all(|r| r.unit.is_none()) => {
            file.is_like_gyroscope = true;
            let guess = Some("their names may be those of a gyroscope, too");
            file.readings = rates.into_iter().map(|label| Label { guess, ..label }).collect();
        }
        _ => {}
    }
}

/// Whether a column of a file rises in all of its first rows.
fn rises(path: &Path, column: &ColumnName) -> bool {
    steps(path, column).is_some_and(|steps| steps.iter().all(|step| *step > 0.0))
}

/// The steps of a column of numbers through its first rows, if there are enough.
fn steps(path: &Path, column: &ColumnName) -> Option<Vec<f64>> {
    /// Noise rises through as many rows by chance once in 10^13 files.
    const ROWS: usize = 16;
    let mut reader = open(path, &[(column, Rule::Any)]).ok()?;
    let values = &reader.next_batch().ok()??.first()?[0];
    let first = &values[..values.len().min(1000)];
    (first.len() >= ROWS).then(|| first.windows(2).map(|pair| pair[1] - pair[0]).collect())
}

/// Records by mounting: files of one newtonometer each, named alike but for the axis, belong together. Second, those that are
/// left.
fn joined(records: Vec<FileColumns>) -> (Vec<Vec<FileColumns>>, Vec<FileColumns>) {
    let mut groups: Vec<Vec<FileColumns>> = Vec::new();
    let mut by_stem: BTreeMap<(PathBuf, String), usize> = BTreeMap::new();
    for record in records {
        if record.readings.len() == 3 {
            groups.push(vec![record]);
            continue;
        }
        let folder = record.path.parent().unwrap_or(Path::new("")).to_owned();
        let stem = stem(&record.path);
        let common = stem.trim_end_matches(|c: char| "xyzXYZ123".contains(c));
        let common = common.trim_end_matches(|c: char| !c.is_alphanumeric() || "afuAFU".contains(c)).to_owned();
        match by_stem.get(&(folder.clone(), common.clone())) {
            Some(&group) if groups[group].len() < 3 => groups[group].push(record),
            _ => {
                by_stem.insert((folder, common), groups.len());
                groups.push(vec![record]);
            }
        }
    }
    let (whole, apart): (Vec<_>, Vec<_>) =
        groups.into_iter().partition(|group| group.len() == 3 || group[0].readings.len() == 3);
    (whole, apart.into_iter().flatten().collect())
}

/// Telemetry to the mounting of the same number or name; in their order where there are as many. The telemetry of no mounting is returned.
fn pair(groups: &mut [Group], telemetry: Vec<FileColumns>) -> Vec<FileColumns> {
    for group in groups.iter_mut() {
        if group.records[0].speed.is_some() {
            group.telemetry = Some(group.records[0].clone());
        }
    }
    let mut left = Vec::new();
    let in_order = telemetry.len() == groups.len();
    for (index, file) in telemetry.into_iter().enumerate() {
        let same = |group: &Group| {
            let record = &group.records[0].path;
            stem(record) == stem(&file.path)
                || last_number(record).is_some() && last_number(record) == last_number(&file.path)
        };
        let place = groups.iter().position(same).or(in_order.then_some(index));
        match place.map(|place| &mut groups[place]).filter(|group| group.telemetry.is_none()) {
            Some(group) => group.telemetry = Some(file),
            None => left.push(file),
        }
    }
    left
}

/// The name without its endings.
fn stem(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    name.split('.').next().unwrap_or_default().to_lowercase()
}

fn last_number(path: &Path) -> Option<u64> {
    let stem = stem(path);
    let digits = stem.trim_end_matches(|c: char| !c.is_ascii_digit());
    let start = digits.rfind(|c: char| !c.is_ascii_digit()).map_or(0, |place| place + 1);
    digits.get(start..)?.parse().ok()
}

/// By name, numbers in it by their value: `m2` before `m10`.
fn natural(a: &Path, b: &Path) -> Ordering {
    let parts = |path: &Path| -> Vec<(u64, String)> {
        let mut parts = vec![(0_u64, String::new())];
        for c in path.to_string_lossy().chars() {
            let (number, text) = parts.last_mut().expect("it begins with one");
            match c.to_digit(10) {
                Some(digit) if text.is_empty() => *number = number.saturating_mul(10).saturating_add(u64::from(digit)),
                Some(digit) => parts.push((u64::from(digit), String::new())),
                None => text.push(c),
            }
        }
        parts
    };
    parts(a).cmp(&parts(b))
}
