//! Which files there are, what they hold, and which belong together.

use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use centrical_table::{ColumnName, Extent, Field, Rule, TableReader, TextForm, text_form};

use crate::error::Error;
use crate::quantity::Dimension;

/// Folders are searched to this depth.
const DEPTH: usize = 3;

/// Endings of files that may hold records.
const ENDINGS: [&str; 19] = [
    "csv", "tsv", "txt", "dat", "asc", "lvm", "log", "gz", "zst", "parquet", "pq", "arrow", "feather", "npy", "npz",
    "mat", "h5", "hdf5", "tdms",
];

/// The files of one mounting.
#[derive(Debug, Clone)]
pub(super) struct Group {
    /// The record, or one file for each newtonometer.
    pub records: Vec<FileColumns>,
    pub telemetry: Option<FileColumns>,
}

/// A file and the columns of it.
#[derive(Debug, Clone)]
pub(super) struct FileColumns {
    pub path: PathBuf,
    pub form: Option<TextForm>,
    pub time: Option<Label>,
    pub readings: Vec<Label>,
    pub speed: Option<Label>,
}

/// A column, and its unit if the file names it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Label {
    pub column: ColumnName,
    pub unit: Option<&'static str>,
}

/// The mountings that the files are of, in the natural order of their names.
pub(super) fn groups(inputs: &[PathBuf]) -> Result<Vec<Group>, Error> {
    let mut paths = Vec::new();
    for input in inputs {
        collect(input, DEPTH, true, &mut paths)?;
    }
    paths.sort_by(|a, b| natural(a, b));
    paths.dedup();
    let mut files = Vec::new();
    for path in paths {
        files.extend(columns_of(path)?);
    }
    let (records, telemetry): (Vec<_>, Vec<_>) = files.into_iter().partition(|file| !file.readings.is_empty());
    let mut groups: Vec<Group> =
        joined(records).into_iter().map(|records| Group { records, telemetry: None }).collect();
    pair(&mut groups, telemetry);
    Ok(groups)
}

fn collect(path: &Path, depth: usize, is_named: bool, paths: &mut Vec<PathBuf>) -> Result<(), Error> {
    let failed = |error| Error::reading(path, error, "a folder of records, or a record");
    let metadata = fs::metadata(path).map_err(failed)?;
    if !metadata.is_dir() {
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
        if is_named || metadata.is_file() && ENDINGS.contains(&ending.as_str()) {
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

/// The columns of a file; none if it is neither a record nor telemetry.
fn columns_of(path: PathBuf) -> Result<Option<FileColumns>, Error> {
    match text_form(&path)? {
        Some(form) => Ok(Some(of_text(path, form)).filter(|file| file.speed.is_some() || !file.readings.is_empty())),
        None => Ok(of_binary(&path)),
    }
}

/// Columns by their names and units; without a header by their number.
fn of_text(path: PathBuf, form: TextForm) -> FileColumns {
    let unit = |index: usize| form.units.get(index).copied().flatten();
    let mut file = FileColumns { path, form: None, time: None, readings: Vec::new(), speed: None };
    let stamps = form.stamps.map(|stamps| stamps.column);
    if form.names.is_empty() {
        let numbered = |index: usize| Label { column: ColumnName::Number(index + 1), unit: None };
        let count = form.first_row.len();
        match count {
            2 => (file.time, file.speed) = (Some(numbered(0)), Some(numbered(1))),
            3 => file.readings = (0..3).map(numbered).collect(),
            4.. => (file.time, file.readings) = (Some(numbered(0)), (1..4).map(numbered).collect()),
            _ => {}
        }
    }
    for (index, name) in form.names.iter().enumerate() {
        let label = Label { column: ColumnName::Name(name.clone()), unit: unit(index) };
        match what(name, label.unit) {
            _ if stamps == Some(index) && file.time.is_none() => file.time = Some(label),
            What::Time if file.time.is_none() => file.time = Some(label),
            What::Speed if file.speed.is_none() => file.speed = Some(label),
            What::Reading => file.readings.push(label),
            _ => {}
        }
    }
    if file.readings.len() != 3 && file.speed.is_some() {
        // Telemetry with other columns beside the speed.
        file.readings.clear();
    }
    file.readings.truncate(3);
    if file.readings.len() == 2 {
        file.readings.clear();
    }
    file.form = Some(form);
    file
}

/// What a column holds.
enum What {
    Time,
    Speed,
    Reading,
    Other,
}

/// What a column holds, by its unit, else by its name in English, German or Russian.
fn what(name: &str, unit: Option<&str>) -> What {
    let name = name.to_lowercase();
    let word: String = name.chars().take_while(|c| !"([,".contains(*c)).collect::<String>().trim().to_owned();
    let has = |words: &[&str]| words.iter().any(|part| word.contains(part));
    if has(&["temp", "темп", "status", "flag", "marker", "humid", "press"])
        || ["no", "n", "№", "index", "sample"].contains(&word.as_str())
    {
        return What::Other;
    }
    if let Some(unit) = unit {
        if Dimension::Time.factor(unit).is_some() {
            return What::Time;
        } else if Dimension::Speed.factor(unit).is_some() {
            return What::Speed;
        } else if unit == "V" || Dimension::Acceleration.factor(unit).is_some() {
            return What::Reading;
        }
    }
    if has(&["time", "zeit", "врем", "stamp"]) || word == "t" {
        What::Time
    } else if has(&["omega", "ω", "speed", "rpm", "rate", "drehzahl", "об/мин", "скор", "оборот"]) {
        What::Speed
    } else {
        What::Reading
    }
}

/// A table that is not text is asked for the usual names.
fn of_binary(path: &Path) -> Option<FileColumns> {
    let label = |name: &str| Label { column: ColumnName::Name(name.to_owned()), unit: None };
    let has = |names: &[&str]| {
        let field = |name: &&str| Field {
            name: ColumnName::Name((*name).to_owned()),
            expected: "a number".to_owned(),
            rule: Rule::Any,
        };
        TableReader::open(path, Extent::Whole, &names.iter().map(field).collect::<Vec<_>>(), "a table").is_ok()
    };
    let none =
        FileColumns { path: path.to_owned(), form: None, time: Some(label("t")), readings: Vec::new(), speed: None };
    if has(&["t", "f1", "f2", "f3"]) {
        let speed = has(&["t", "omega"]).then(|| label("omega"));
        return Some(FileColumns { readings: ["f1", "f2", "f3"].map(label).to_vec(), speed, ..none });
    }
    has(&["t", "omega"]).then(|| FileColumns { speed: Some(label("omega")), ..none })
}

/// Records by mounting: files of one newtonometer each, named alike but for the axis, belong together.
fn joined(records: Vec<FileColumns>) -> Vec<Vec<FileColumns>> {
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
    groups.retain(|group| group.len() == 3 || group[0].readings.len() == 3);
    groups
}

/// Telemetry to the mounting of the same number or name; in their order where there are as many.
fn pair(groups: &mut [Group], telemetry: Vec<FileColumns>) {
    for group in groups.iter_mut() {
        if group.records[0].speed.is_some() {
            group.telemetry = Some(group.records[0].clone());
        }
    }
    let in_order = telemetry.len() == groups.len();
    for (index, file) in telemetry.into_iter().enumerate() {
        let same = |group: &Group| {
            let record = &group.records[0].path;
            stem(record) == stem(&file.path)
                || last_number(record).is_some() && last_number(record) == last_number(&file.path)
        };
        let place = groups.iter().position(same).or(in_order.then_some(index));
        if let Some(group) = place.map(|place| &mut groups[place]).filter(|group| group.telemetry.is_none()) {
            group.telemetry = Some(file);
        }
    }
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
