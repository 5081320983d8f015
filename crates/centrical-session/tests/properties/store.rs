//! A store of calibrations: nothing is lost, nothing stands twice, whoever writes.

use std::fs;
use std::path::Path;
use std::sync::Barrier;
use std::thread;
use std::time::Instant;

use centrical::Group;
use centrical_session::{Depth, Row, RowPrior, Selection, SharedInfluence, Store, TermSummary, unwatched};
use centrical_table::{Cell, Kind, TypedColumn, TypedWriter};
use tempfile::TempDir;

/// A term of the error model.
const TERM: &str = "K_2[f1*f3*|f3|]";

/// A row of `p` parameters with numbers of their own.
fn row(n: usize, p: usize) -> Row {
    let number = |j: usize| ((n * 7919 + j * 104_729) as f64).sin();
    let uncertainty = move |j: usize| 1.0 + number(j);
    let covariance =
        move |i: usize, j: usize| uncertainty(i) * uncertainty(j) * if i == j { 1.0 } else { number(i + j) };
    Row {
        key: format!("{n:064x}"),
        unit_model: "TA".to_owned(),
        unit_serial: format!("{:04}", n % 1000),
        date: "2026-10-05".to_owned(),
        day: i64::try_from(n % 3000).ok(),
        station: if n.is_multiple_of(2) { "A".to_owned() } else { String::new() },
        range: vec![1.0, 2.0, 3.0],
        chi_squared: number(0),
        acceptable: true,
        objections: if n.is_multiple_of(3) { vec!["residuals".to_owned()] } else { Vec::new() },
        parameters: (0..p).map(|j| if j == 0 { TERM.to_owned() } else { format!("p_{j}") }).collect(),
        units: vec!["m/s^2".to_owned(); p],
        groups: vec![Group::Bias; p],
        values: (0..p).map(number).collect(),
        standard_uncertainties: (0..p).map(uncertainty).collect(),
        covariance: (0..p).flat_map(|i| (0..=i).map(move |j| covariance(i, j))).collect(),
        terms: vec![TermSummary { name: TERM.to_owned(), axis: 2, powers: [1, 0, 2], sign_of: Some(3) }],
        shared_known: true,
        priors_known: n.is_multiple_of(2),
        priors: (0..n % 3).map(|k| prior(k, (0..p).map(number).collect())).collect(),
        shared: vec![SharedInfluence { source: "radius".to_owned(), changes: (0..p).map(number).collect() }; 2],
        ..Row::default()
    }
}

fn prior(k: usize, changes: Vec<f64>) -> RowPrior {
    RowPrior { parameter: format!("p_{k}"), mean: k as f64, standard_uncertainty: 2.0, changes }
}

fn all(store: &Store, depth: Depth) -> Vec<Row> {
    let rows = store.rows(Selection { depth, ..Selection::default() }, &unwatched).unwrap();
    let mut rows: Vec<Row> = rows.collect::<Result<_, _>>().unwrap();
    rows.sort_by(|a, b| a.key.cmp(&b.key));
    rows
}

fn parts(folder: &Path) -> usize {
    fs::read_dir(folder.join("rows")).unwrap().count()
}

#[test]
fn rows_come_back_as_they_were() {
    let folder = TempDir::new().unwrap();
    let store = Store::create(folder.path()).unwrap();
    let mut rows: Vec<Row> = (0..300).map(|n| row(n, 5)).collect();
    rows[8].day = None;
    rows[9].shared.clear();
    assert_eq!(store.add(rows.clone()).unwrap().new, 300);
    assert_eq!(all(&store, Depth::Whole), rows);
    let again = store.add(rows.clone()).unwrap();
    assert_eq!((again.new, again.known), (0, 300));
    let selection = Selection { unit_serial: Some("0042".to_owned()), ..Selection::default() };
    let found: Vec<Row> = store.rows(selection, &unwatched).unwrap().collect::<Result<_, _>>().unwrap();
    assert_eq!(found.iter().map(|row| row.key.as_str()).collect::<Vec<_>>(), [rows[42].key.as_str()]);
    assert!(found[0].values.is_empty(), "a summary has no values");
    assert_eq!(store.row(&rows[9].key).unwrap().as_ref(), Some(&rows[9]));
    assert!(store.row("0").unwrap().is_none());
}

#[test]
fn what_is_not_estimable_is_nothing_in_the_file_and_nan_again() {
    let folder = TempDir::new().unwrap();
    let store = Store::create(folder.path()).unwrap();
    let mut one = row(1, 3);
    (one.values[1], one.standard_uncertainties[1]) = (f64::NAN, f64::NAN);
    store.add(vec![one]).unwrap();
    let read = &all(&store, Depth::Values)[0];
    assert!(read.values[1].is_nan() && !read.values[0].is_nan());
    assert_eq!(read.values.len(), 3);
}

#[test]
fn small_parts_are_merged_and_a_kill_in_between_shows_nothing_twice() {
    let folder = TempDir::new().unwrap();
    let store = Store::create(folder.path()).unwrap();
    for n in 0..31 {
        store.add(vec![row(n, 2)]).unwrap();
    }
    assert_eq!(parts(folder.path()), 31);
    let kept = folder.path().join("kept");
    fs::create_dir(&kept).unwrap();
    for entry in fs::read_dir(folder.path().join("rows")).unwrap().map(Result::unwrap) {
        fs::copy(entry.path(), kept.join(entry.file_name())).unwrap();
    }
    store.add(vec![row(31, 2)]).unwrap();
    assert_eq!(parts(folder.path()), 1);
    // As a kill after the rename leaves it: the merged part, the old ones, and a file in the making.
    for entry in fs::read_dir(&kept).unwrap().map(Result::unwrap) {
        fs::copy(entry.path(), folder.path().join("rows").join(entry.file_name())).unwrap();
    }
    fs::write(folder.path().join("rows/x.parquet.0123456789.tmp"), "PAR1").unwrap();
    fs::create_dir_all(folder.path().join("results")).unwrap();
    fs::write(folder.path().join("results/x.json.0123456789.tmp"), "{").unwrap();
    assert_eq!(all(&store, Depth::Whole), (0..32).map(|n| row(n, 2)).collect::<Vec<_>>());
    store.add(vec![row(5, 2)]).unwrap();
    let left = fs::read_dir(folder.path().join("results")).unwrap().count();
    assert_eq!((parts(folder.path()), left), (1, 0), "the next writer removes what is left");
    assert_eq!(all(&store, Depth::Whole).len(), 32);
}

#[test]
fn a_damaged_part_and_a_newer_one_are_errors_that_name_the_file() {
    let folder = TempDir::new().unwrap();
    let store = Store::create(folder.path()).unwrap();
    store.add((0..200).map(|n| row(n, 4)).collect()).unwrap();
    let part = fs::read_dir(folder.path().join("rows")).unwrap().next().unwrap().unwrap().path();
    let whole = fs::read(&part).unwrap();
    let message = |bytes: &[u8]| {
        fs::write(&part, bytes).unwrap();
        let rows = store.rows(Selection { depth: Depth::Whole, ..Selection::default() }, &unwatched);
        rows.and_then(|mut rows| rows.find_map(Result::err).map_or(Ok(()), Err)).unwrap_err().to_string()
    };
    assert!(message(&whole[..whole.len() / 2]).contains(".parquet: found damaged Parquet"));
    let mut zeros = whole.clone();
    zeros[1000..9000].fill(0);
    assert!(message(&zeros).contains("row group"), "{}", message(&zeros));
    let at = whole.windows(16).position(|bytes| bytes == b"centrical-rows/2").unwrap();
    let mut newer = whole.clone();
    newer[at + 15] = b'3';
    assert!(message(&newer).contains("found schema \"centrical-rows/3\", expected schema \"centrical-rows/2\""));
}

/// A bit that flips anywhere in a part is found, or it changes nothing that is read.
#[test]
fn a_flipped_bit_is_refused_or_changes_nothing() {
    let folder = TempDir::new().unwrap();
    let store = Store::create(folder.path()).unwrap();
    let rows: Vec<Row> = (0..6).map(|n| row(n, 4)).collect();
    store.add(rows.clone()).unwrap();
    let part = fs::read_dir(folder.path().join("rows")).unwrap().next().unwrap().unwrap().path();
    let whole = fs::read(&part).unwrap();
    let mut refused = 0;
    for at in (0..whole.len()).step_by(3) {
        let mut bytes = whole.clone();
        bytes[at] ^= 1 << (at % 8);
        fs::write(&part, &bytes).unwrap();
        let selection = Selection { depth: Depth::Whole, ..Selection::default() };
        let read = store.rows(selection, &unwatched).and_then(Iterator::collect::<Result<Vec<Row>, _>>);
        match read {
            Ok(mut read) => {
                read.sort_by(|a, b| a.key.cmp(&b.key));
                assert!(read == rows, "byte {at} of {}", whole.len());
            }
            Err(error) => {
                assert!(error.to_string().contains(".parquet"), "{error}");
                refused += 1;
            }
        }
    }
    assert!(refused > whole.len() / 3 / 2, "{refused} of {}", whole.len() / 3);
}

/// A word for the status that another program wrote is no calibration that was done.
#[test]
fn an_unknown_status_is_refused() {
    let folder = TempDir::new().unwrap();
    let store = Store::create(folder.path()).unwrap();
    let columns = [("key", Kind::Text), ("status", Kind::Text)].map(|(name, kind)| TypedColumn { name, kind });
    let file = folder.path().join("rows/part.parquet");
    let mut part = TypedWriter::create(&file, &columns, &[("centrical_schema", "centrical-rows/2")]).unwrap();
    part.write_group(&[vec![Cell::Text("0".repeat(64)), Cell::Text("tried".to_owned())]]).unwrap();
    part.finish().unwrap();
    let error = store.rows(Selection::default(), &unwatched).unwrap().next().unwrap().unwrap_err().to_string();
    let expected = "part.parquet, row 1, status: found \"tried\", expected \"done\" or \"failed\"";
    assert!(error.contains(expected), "{error}");
}

/// Two keys that are not hexadecimal are not one key, and a group that this program does not know is not a bias.
#[test]
fn unknown_keys_and_groups_are_refused() {
    let refused = |key: &str, groups: Vec<Cell>, expected: &str| {
        let folder = TempDir::new().unwrap();
        let store = Store::create(folder.path()).unwrap();
        let columns = [("key", Kind::Text), ("parameters", Kind::Texts), ("groups", Kind::Texts)];
        let columns = columns.map(|(name, kind)| TypedColumn { name, kind });
        let file = folder.path().join("rows/part.parquet");
        let mut part = TypedWriter::create(&file, &columns, &[("centrical_schema", "centrical-rows/2")]).unwrap();
        let names = Cell::Texts(vec!["p".to_owned()]);
        let row = [Cell::Text(key.to_owned()), names];
        part.write_group(&[row.into_iter().chain(groups).collect()]).unwrap();
        part.finish().unwrap();
        let selection = Selection { depth: Depth::Values, ..Selection::default() };
        let error = store.rows(selection, &unwatched).unwrap().next().unwrap().unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    };
    let of = |group: &str| vec![Cell::Texts(vec![group.to_owned()])];
    refused("no-key", of("bias"), "row 1, key: found \"no-key\", expected a SHA-256 of 64 hexadecimal digits");
    refused(&"A".repeat(64), of("bias"), "row 1, key: found ");
    refused(&"0".repeat(64), of("hysteresis"), "row 1, groups: found \"hysteresis\", expected one of bias, scale, ");
}

/// Each edit of a row, and the column and the words of the error.
#[test]
fn rows_that_contradict_themselves_are_refused() {
    type Edit = fn(&mut Row);
    let edits: [(Edit, &str); 14] = [
        (|r| r.values.truncate(4), "values: found a list of 4, expected 5"),
        (|r| r.standard_uncertainties.clear(), "standard_uncertainties: found a list of 0, expected 5"),
        (|r| r.values.insert(0, 0.5), "values: found a list of 6, expected 5"),
        (|r| r.values[3] = 1e308, "values: found 1e308 of p_3, expected a value"),
        (|r| r.values[3] = f64::NAN, "expected a number where there is a value"),
        (|r| r.standard_uncertainties[3] = -1.0, "standard_uncertainties: found -1e0 of p_3, expected zero or more"),
        (|r| r.covariance[9] = -1.0, "covariance: found -1e0 of p_3 and p_3, expected "),
        (|r| r.covariance[6] = 1e3, " at most, by the standard uncertainties"),
        (|r| r.covariance.clear(), "covariance: found a list of 0, expected 15"),
        (|r| r.units[3] = "mg".to_owned(), "units: found \"mg\" of p_3, expected \"m/s^2\""),
        (|r| r.parameters[3] = "p_2".to_owned(), "parameters: found \"p_2\" twice"),
        (|r| r.terms[0].powers = [0, 0, 2], "term_powers: found K_2[f3*|f3|] as the term K_2[f1*f3*|f3|]"),
        (|r| r.terms[0].axis = 0, "term_axes: found newtonometer 0 of "),
        (|r| r.shared[0].changes.truncate(4), "shared_changes: found 4 changes for each, expected 5"),
    ];
    for (edit, expected) in edits {
        let folder = TempDir::new().unwrap();
        let store = Store::create(folder.path()).unwrap();
        let mut rows: Vec<Row> = (1..4).map(|n| Row { shared: row(n, 5).shared[..1].to_vec(), ..row(n, 5) }).collect();
        for row in &mut rows {
            row.unit_serial = "1".to_owned();
        }
        rows.sort_by_key(|row| row.day);
        edit(&mut rows[1]);
        store.add(rows).unwrap();
        let all = store.rows(Selection { depth: Depth::Whole, ..Selection::default() }, &unwatched).unwrap();
        let message = all.collect::<Result<Vec<_>, _>>().unwrap_err().to_string();
        assert!(message.contains(".parquet, row 2, ") && message.contains(expected), "{message}, not {expected}");
    }
}

#[test]
fn sixteen_writers_at_once_lose_nothing() {
    let folder = TempDir::new().unwrap();
    let together = Barrier::new(16);
    thread::scope(|scope| {
        for writer in 0..16 {
            let (folder, together) = (&folder, &together);
            scope.spawn(move || {
                let store = Store::create(folder.path()).unwrap();
                together.wait();
                for n in 0..20 {
                    store.add((0..3).map(|k| row(writer * 10 + n + k, 2)).collect()).unwrap();
                    let keys = all(&store, Depth::Summary);
                    assert!(keys.windows(2).all(|pair| pair[0].key != pair[1].key));
                }
            });
        }
    });
    let store = Store::open(folder.path()).unwrap();
    assert_eq!(all(&store, Depth::Whole), (0..172).map(|n| row(n, 2)).collect::<Vec<_>>());
}

/// 10^5 rows of 49 parameters: run it alone, in release, under `time -v`.
#[test]
#[ignore = "a GB on the disk"]
fn a_hundred_thousand_rows() {
    let folder = std::env::var_os("CENTRICAL_STORE").map_or_else(|| TempDir::new().unwrap().keep(), Into::into);
    let store = Store::create(&folder).unwrap();
    let time = |what: &str, begun: Instant| println!("{what}: {:.2} s", begun.elapsed().as_secs_f64());
    let begun = Instant::now();
    for batch in 0..100 {
        store.add((0..1000).map(|n| row(1000 * batch + n, 49)).collect()).unwrap();
    }
    time("100 batches of 1000", begun);
    let begun = Instant::now();
    store.add(vec![row(100_000, 49)]).unwrap();
    time("one more", begun);
    let begun = Instant::now();
    assert_eq!(store.rows(Selection::default(), &unwatched).unwrap().flatten().count(), 100_001);
    time("all summaries", begun);
    let begun = Instant::now();
    let of_unit = Selection { depth: Depth::Whole, unit_serial: Some("0042".to_owned()), ..Selection::default() };
    assert_eq!(store.rows(of_unit, &unwatched).unwrap().flatten().count(), 100);
    time("one unit, whole", begun);
    let bytes: u64 = fs::read_dir(folder.join("rows")).unwrap().map(|e| e.unwrap().metadata().unwrap().len()).sum();
    println!("{} bytes a row in {} parts", bytes / 100_001, parts(&folder));
}
