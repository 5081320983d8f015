//! A frozen part of each released version of the rows of a store: read for ever.

use std::fs;
use std::path::Path;

use centrical_session::{Depth, Row, Selection, Store, unwatched};
use tempfile::TempDir;

/// The rows of a frozen part, read from a store that has it alone.
fn read(part: &str) -> Vec<Row> {
    let folder = TempDir::new().unwrap();
    let store = Store::create(folder.path()).unwrap();
    let frozen = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(part);
    fs::copy(frozen, folder.path().join("rows").join(part)).unwrap();
    let rows = store.rows(Selection { depth: Depth::Whole, ..Selection::default() }, &unwatched).unwrap();
    let rows: Vec<Row> = rows.collect::<Result<_, _>>().unwrap();
    // A newer row beside it does not change it, nor does a merge of both.
    let newer = (0..31).map(|n| Row { key: format!("{n:064x}"), ..Row::default() });
    newer.for_each(|row| assert_eq!(store.add(vec![row]).unwrap().new, 1));
    assert_eq!(fs::read_dir(folder.path().join("rows")).unwrap().count(), 1, "merged");
    for row in &rows {
        assert_eq!(store.row(&row.key).unwrap().as_ref(), Some(row));
    }
    rows
}

/// `centrical calibrate examples/ta-200 --store`, by the program before priors had columns.
#[test]
fn rows_of_version_1() {
    let rows = read("rows-1.parquet");
    let [row] = rows.as_slice() else { panic!("{} rows", rows.len()) };
    assert_eq!(row.key, "b15694bbaeebbc59c088a7d967fd1585fcea430bfd517c61aec49474799e2ed7");
    assert_eq!((row.unit_model.as_str(), row.unit_serial.as_str(), row.day), ("TA-200", "0001", Some(20731)));
    assert_eq!((row.values.len(), row.covariance.len(), row.terms.len()), (49, 1225, 21));
    assert_eq!(row.chi_squared, 298.826_757_889_556);
    assert!(row.acceptable && row.shared_known && !row.priors_known && row.priors.is_empty());
}
