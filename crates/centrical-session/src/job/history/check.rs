//! What a store holds that a laboratory may not have meant: one unit under two names, one session twice, days that cannot be, copies that are
//! missing or were changed.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::time::SystemTime;

use centrical::OnProgress;
use centrical_table::Source;

use crate::document::{CalibrationResult, Doubt, DoubtKind, HistoryList};
use crate::error::{Error, ErrorKind};
use crate::job::series::last_rows;
use crate::record::Input;
use crate::settings::read_result;
use crate::store::{Depth, Row, Selection, Status, Store, sha256};

/// Tomorrow in days from 1970-01-01: a station may be east of here.
fn tomorrow() -> i64 {
    let passed = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    i64::try_from(passed.as_secs() / 86_400 + 1).unwrap_or(i64::MAX)
}

/// The calibrations that a selection picks, by unit and day, with the doubts about them. `progress` is asked again and again.
///
/// # Errors
/// [`Error`] if the folder is not a store, a part is damaged, or a copy cannot be read. [`Error::Stopped`].
pub fn check_store(folder: &Path, selection: Selection, progress: OnProgress) -> Result<HistoryList, Error> {
    let store = Store::open(folder)?;
    // Numbers are held against copies alone.
    let depth = if store.keeps_results() { Depth::Whole } else { selection.depth };
    let selection = Selection { depth, ..selection };
    let rows = store.rows(selection, progress)?.collect::<Result<Vec<_>, _>>()?;
    let done: Vec<&Row> = rows.iter().filter(|row| row.status == Status::Done).collect();
    let mut doubts = two_spellings(&done);
    let Copies { doubts: of_copies, measured } = Copies::read(&store, &done, progress)?;
    doubts.extend(twice(&done, &measured));
    let latest = tomorrow();
    doubts.extend(done.iter().filter_map(|row| day(row, latest)));
    doubts.extend(of_copies);
    let mut list = HistoryList::new(&folder.display().to_string(), without_superseded(folder, rows)?);
    list.doubts = Some(doubts);
    Ok(list)
}

/// Units, and stations, whose names differ in no more than spaces, hyphens, case, leading zeros, and Cyrillic for Latin letters.
fn two_spellings(rows: &[&Row]) -> Vec<Doubt> {
    let mut units: BTreeMap<(String, String), BTreeSet<String>> = BTreeMap::new();
    let mut stations: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for Row { unit_model, unit_serial, station, .. } in rows {
        let unit = (spelling(unit_model), spelling(unit_serial));
        units.entry(unit).or_default().insert(format!("{unit_model:?} {unit_serial:?}"));
        stations.entry(spelling(station)).or_default().insert(format!("station {station:?}"));
    }
    let several = units.into_values().chain(stations.into_values()).filter(|names| names.len() > 1);
    several.map(|names| Doubt { kind: DoubtKind::Spelling, of: names.into_iter().collect() }).collect()
}

/// A name without what is mistaken: small Latin letters and digits alone, without leading zeros. A name of other characters is its own.
pub fn spelling(name: &str) -> String {
    let letters = name.chars().flat_map(char::to_lowercase).filter(|c| c.is_alphanumeric());
    let latin = |c: char| LOOKALIKES.iter().find(|(cyrillic, _)| *cyrillic == c).map_or(c, |(_, latin)| *latin);
    let letters: String = letters.map(latin).collect();
    match letters.trim_start_matches('0') {
        _ if letters.is_empty() => name.to_owned(),
        "" => "0".to_owned(),
        spelling => spelling.to_owned(),
    }
}

/// Cyrillic letters, and the Latin ones whose capitals look the same.
const LOOKALIKES: [(char, char); 12] = [
    ('а', 'a'),
    ('в', 'b'),
    ('е', 'e'),
    ('к', 'k'),
    ('м', 'm'),
    ('н', 'h'),
    ('о', 'o'),
    ('р', 'p'),
    ('с', 'c'),
    ('т', 't'),
    ('у', 'y'),
    ('х', 'x'),
];

/// Results of the same files, and results of one unit of the same day from other files. A result whose `measured` is known is of the same files as
/// another with the same: a session that is copied under another title differs in its experiment file alone.
fn twice(rows: &[&Row], measured: &BTreeMap<&str, String>) -> Vec<Doubt> {
    let mut by_files: BTreeMap<&str, Vec<&Row>> = BTreeMap::new();
    let mut by_day: BTreeMap<(&str, &str, i64), Vec<&Row>> = BTreeMap::new();
    for row in rows {
        by_files.entry(&row.inputs).or_default().push(row);
        if let Some(measured) = measured.get(row.key.as_str()) {
            by_files.entry(measured).or_default().push(row);
        }
        if let Some(day) = row.day {
            by_day.entry((&row.unit_model, &row.unit_serial, day)).or_default().push(row);
        }
    }
    let is_same = |a: &Row, b: &Row| {
        let of = |row: &Row| measured.get(row.key.as_str());
        a.inputs == b.inputs || of(a).is_some_and(|files| of(b) == Some(files))
    };
    let same_files = by_files.iter().filter(|(files, rows)| !files.is_empty() && rows.len() > 1);
    let same_files: BTreeSet<Vec<String>> = same_files.map(|(_, rows)| keys(rows)).collect();
    let is_part = |group: &[String], of: &[String]| group.len() < of.len() && group.iter().all(|key| of.contains(key));
    let whole = same_files.iter().filter(|group| !same_files.iter().any(|other| is_part(group, other)));
    let same_day = by_day.values().filter(|rows| rows.iter().any(|row| !is_same(row, rows[0]))).map(|rows| keys(rows));
    let doubt = |kind| move |of| Doubt { kind, of };
    whole.cloned().map(doubt(DoubtKind::SameInputs)).chain(same_day.map(doubt(DoubtKind::SameDay))).collect()
}

fn keys(rows: &[&Row]) -> Vec<String> {
    let mut keys: Vec<String> = rows.iter().map(|row| row.key.clone()).collect();
    keys.sort();
    keys
}

/// First day of 1980, in days from 1970-01-01: no record that programs read is older.
const EARLIEST: i64 = 3652;

fn day(row: &Row, latest: i64) -> Option<Doubt> {
    let kind = match row.day {
        None => DoubtKind::NoDay,
        Some(day) if day > latest => DoubtKind::Ahead,
        Some(day) if day < EARLIEST => DoubtKind::LongAgo,
        Some(_) => return None,
    };
    Some(Doubt { kind, of: vec![row.key.clone()] })
}

/// What the copies of results say.
struct Copies<'a> {
    /// Copies that are missing or not as they were added. A store that keeps none has none to miss.
    doubts: Vec<Doubt>,
    /// Of what was measured, the hashes of the files in one text, by the key of the result; experiment files are not in it.
    measured: BTreeMap<&'a str, String>,
}

/// Whether a row has the names, the day and the numbers of its copy, to the last digit.
fn is_of(row: &Row, copy: &Row) -> bool {
    let is_same = |(a, b): (&f64, &f64)| a == b || a.is_nan() && b.is_nan();
    let are_same = |a: &[f64], b: &[f64]| a.len() == b.len() && a.iter().zip(b).all(is_same);
    row.unit_model == copy.unit_model
        && row.unit_serial == copy.unit_serial
        && row.station == copy.station
        && row.date == copy.date
        && row.day == copy.day
        && row.parameters == copy.parameters
        && are_same(&row.values, &copy.values)
        && are_same(&row.standard_uncertainties, &copy.standard_uncertainties)
        && are_same(&row.covariance, &copy.covariance)
}

impl<'a> Copies<'a> {
    fn read(store: &Store, rows: &[&'a Row], progress: OnProgress) -> Result<Self, Error> {
        let mut found = Self { doubts: Vec::new(), measured: BTreeMap::new() };
        if !store.keeps_results() {
            return Ok(found);
        }
        for row in rows {
            let file = store.result_file(&row.key);
            let copy = Source::open(&file, COPY).map_err(Error::from);
            let kind = match copy.and_then(|copy| Input::of(Path::new(""), &copy, progress)) {
                Ok(copy) if copy.sha256 == row.key => {
                    let text = read_result(&file, COPY)?;
                    let result = CalibrationResult::parse(&file, &text)?;
                    let is_of_row = is_of(row, &result.row(text.as_bytes()));
                    found.measured.extend(measured(result.inputs).map(|measured| (row.key.as_str(), measured)));
                    if is_of_row {
                        continue;
                    }
                    DoubtKind::RowChanged
                }
                Ok(_) => DoubtKind::Changed,
                Err(error) if error.kind() == ErrorKind::Missing => DoubtKind::Missing,
                Err(error) => return Err(error),
            };
            found.doubts.push(Doubt { kind, of: vec![row.key.clone()] });
        }
        Ok(found)
    }
}

/// What a copy is expected to be.
const COPY: &str = "the copy of a result";

/// The hashes of files other than experiment files, whatever their names and order; `None` without any.
fn measured(files: Vec<Input>) -> Option<String> {
    let mut hashes: Vec<String> = files.into_iter().filter(Input::is_measured).map(|file| file.sha256).collect();
    hashes.sort();
    (!hashes.is_empty()).then(|| sha256(hashes.concat().as_bytes()))
}

/// The calibrations that a selection picks, by unit and day, and the sessions that failed last. `progress` is asked at each row group, with none done.
///
/// # Errors
/// [`Error`] if the folder is not a store, or a part is damaged; [`Error::Stopped`].
pub fn list_store(folder: &Path, selection: Selection, progress: OnProgress) -> Result<HistoryList, Error> {
    let rows = Store::open(folder)?.rows(selection, progress)?.collect::<Result<Vec<_>, _>>()?;
    Ok(HistoryList::new(&folder.display().to_string(), without_superseded(folder, rows)?))
}

/// The rows of the store in `folder` without failures whose session has a later row: a store never takes a row away.
///
/// # Errors
/// [`Error`] when the lines of a series in the folder cannot be read.
pub fn without_superseded(folder: &Path, mut rows: Vec<Row>) -> Result<Vec<Row>, Error> {
    if rows.iter().any(|row| row.status == Status::Failed) {
        let last = last_rows(folder)?;
        // A failure has its session for a title.
        let is_last = |row: &Row| last.get(&row.title).is_none_or(|key| *key == row.key);
        rows.retain(|row| row.status == Status::Done || is_last(row));
    }
    Ok(rows)
}
