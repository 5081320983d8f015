//! What a store holds that a laboratory may not have meant: one unit under two names, one session twice, days that cannot be, copies that are
//! missing or were changed.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::time::SystemTime;

use centrical::OnProgress;
use centrical_table::Source;

use crate::document::{Doubt, DoubtKind, HistoryList};
use crate::error::{Error, ErrorKind};
use crate::record::Input;
use crate::store::{Row, Selection, Status, Store};

/// Days from 1970-01-01; a day more, since a station may be east of here.
pub fn today() -> i64 {
    let passed = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    i64::try_from(passed.as_secs() / 86_400 + 1).unwrap_or(i64::MAX)
}

/// The calibrations that a selection picks, by unit and day, with the doubts about them. `today` in days from 1970-01-01; `progress` is
/// asked again and again.
///
/// # Errors
/// [`Error`] if the folder is no store, a part is damaged, or a copy cannot be read. [`Error::Stopped`].
pub fn check_store(
    folder: &Path,
    selection: Selection,
    today: i64,
    progress: OnProgress,
) -> Result<HistoryList, Error> {
    let store = Store::open(folder)?;
    let rows = store.rows(selection, progress)?.collect::<Result<Vec<_>, _>>()?;
    let done: Vec<&Row> = rows.iter().filter(|row| row.status == Status::Done).collect();
    let mut doubts = two_spellings(&done);
    doubts.extend(twice(&done));
    doubts.extend(done.iter().filter_map(|row| day(row, today)));
    doubts.extend(copies(&store, &done, progress)?);
    let mut list = HistoryList::new(&folder.display().to_string(), rows);
    list.doubts = Some(doubts);
    Ok(list)
}

/// Units whose names differ in no more than spaces, hyphens, case, and Cyrillic for Latin letters.
fn two_spellings(rows: &[&Row]) -> Vec<Doubt> {
    let mut by_spelling: BTreeMap<(String, String), BTreeSet<(&str, &str)>> = BTreeMap::new();
    for row in rows {
        let spelling = (spelling(&row.unit_model), spelling(&row.unit_serial));
        by_spelling.entry(spelling).or_default().insert((&row.unit_model, &row.unit_serial));
    }
    let several = by_spelling.into_values().filter(|names| names.len() > 1);
    let named = |(model, serial): &(&str, &str)| format!("{model:?} {serial:?}");
    several.map(|names| Doubt { kind: DoubtKind::Spelling, of: names.iter().map(named).collect() }).collect()
}

/// A name without what is mistaken: small Latin letters and digits alone.
pub fn spelling(name: &str) -> String {
    let letters = name.chars().flat_map(char::to_lowercase).filter(|c| c.is_alphanumeric());
    letters.map(|c| LOOKALIKES.iter().find(|(cyrillic, _)| *cyrillic == c).map_or(c, |(_, latin)| *latin)).collect()
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

/// Results of the same inputs, and results of one unit of the same day from other inputs.
fn twice(rows: &[&Row]) -> Vec<Doubt> {
    let mut by_inputs: BTreeMap<&str, Vec<&Row>> = BTreeMap::new();
    let mut by_day: BTreeMap<(&str, &str, i64), Vec<&Row>> = BTreeMap::new();
    for row in rows {
        by_inputs.entry(&row.inputs).or_default().push(row);
        if let Some(day) = row.day {
            by_day.entry((&row.unit_model, &row.unit_serial, day)).or_default().push(row);
        }
    }
    let same_inputs = by_inputs.iter().filter(|(inputs, rows)| !inputs.is_empty() && rows.len() > 1);
    let same_day = by_day.values().filter(|rows| rows.iter().any(|row| row.inputs != rows[0].inputs));
    let doubt = |kind| {
        move |rows: &Vec<&Row>| {
            let mut keys: Vec<String> = rows.iter().map(|row| row.key.clone()).collect();
            keys.sort();
            Doubt { kind, of: keys }
        }
    };
    let same_inputs = same_inputs.map(|(_, rows)| rows).map(doubt(DoubtKind::SameInputs));
    same_inputs.chain(same_day.map(doubt(DoubtKind::SameDay))).collect()
}

fn day(row: &Row, today: i64) -> Option<Doubt> {
    let kind = match row.day {
        None => DoubtKind::NoDay,
        Some(day) if day > today => DoubtKind::Ahead,
        Some(_) => return None,
    };
    Some(Doubt { kind, of: vec![row.key.clone()] })
}

/// Copies that are missing or not as they were added. A store that keeps none has none to miss.
fn copies(store: &Store, rows: &[&Row], progress: OnProgress) -> Result<Vec<Doubt>, Error> {
    let mut doubts = Vec::new();
    if !store.keeps_results() {
        return Ok(doubts);
    }
    for row in rows {
        let copy = Source::open(&store.result_file(&row.key), "the copy of a result").map_err(Error::from);
        let kind = match copy.and_then(|copy| Input::of(Path::new(""), &copy, progress)) {
            Ok(copy) if copy.sha256 == row.key => continue,
            Ok(_) => DoubtKind::Changed,
            Err(error) if error.kind() == ErrorKind::Missing => DoubtKind::Missing,
            Err(error) => return Err(error),
        };
        doubts.push(Doubt { kind, of: vec![row.key.clone()] });
    }
    Ok(doubts)
}
