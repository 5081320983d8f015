//! Stamps go through a table as they came, whatever is between.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use centrical_table::{ColumnName, Decimals, Error, Extent, Field, Rule, TableReader, TableWriter};

/// Copies time and one reading.
fn copy(input: &Path, output: &Path) -> Result<(), Error> {
    let field = |(name, rule): (&str, Rule)| Field {
        name: ColumnName::Name(name.to_owned()),
        expected: "a number".to_owned(),
        rule,
    };
    let fields = [("t", Rule::Ascending { stamps: true }), ("f1", Rule::Any)].map(field);
    let mut reader = TableReader::open(input, Extent::Whole, &fields, "a record")?;
    reader.keep_stamps();
    let mut writer = TableWriter::create(output, &["t", "f1"], [Decimals::SHORTEST; 2])?;
    while reader.next_batch()?.is_some() {
        let stamps = reader.take_stamps();
        for (rows, stamps) in reader.batch().iter().zip(&stamps) {
            writer.write_stamped(stamps, [&rows[0], &rows[1]])?;
        }
    }
    writer.finish()
}

/// More rows than a row group of Parquet has, and as many sets as come; the digits are those of nanoseconds.
#[test]
fn stamps_come_back_from_parquet() {
    let folder = tempfile::tempdir().unwrap();
    let [text, table, again] = ["a.csv", "a.parquet", "b.csv"].map(|name| folder.path().join(name));
    for zone in ["Z", ""] {
        let mut lines = String::from("t,f1\n");
        for k in 0..300_000_u64 {
            let (second, rest) = (k / 5000, k % 5000 * 200_000 + k % 7);
            writeln!(lines, "2026-10-05T10:00:{second:02}.{rest:09}{zone},{}.5", k % 977).unwrap();
        }
        fs::write(&text, &lines).unwrap();
        copy(&text, &table).unwrap();
        copy(&table, &again).unwrap();
        assert!(fs::read_to_string(&again).unwrap() == lines, "{zone}");
    }
}

/// Numbers, and times of the day, stay numbers; the bytes are those of rows without stamps.
#[test]
fn what_has_no_date_is_seconds() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    fs::write(path("clock.csv"), "t,f1\n10:00:00.25,1\n10:00:01,2\n").unwrap();
    fs::write(path("number.csv"), "t,f1\n36000.25,1\n36001,2\n").unwrap();
    for name in ["clock", "number"] {
        copy(&path(&format!("{name}.csv")), &path(&format!("{name}.parquet"))).unwrap();
    }
    let mut writer = TableWriter::create(&path("plain.parquet"), &["t", "f1"], [Decimals::SHORTEST; 2]).unwrap();
    writer.write(&[[&[36000.25, 36001.0], &[1.0, 2.0]]]).unwrap();
    writer.finish().unwrap();
    let plain = fs::read(path("plain.parquet")).unwrap();
    assert!(["clock.parquet", "number.parquet"].iter().all(|name| fs::read(path(name)).unwrap() == plain));
    // A table without rows has a schema.
    TableWriter::create(&path("empty.parquet"), &["t"], [Decimals::SHORTEST]).unwrap().finish().unwrap();
    assert!(fs::read(path("empty.parquet")).unwrap().ends_with(b"PAR1"));
}

#[test]
fn a_column_has_one_kind_of_stamps() {
    let folder = tempfile::tempdir().unwrap();
    let [text, table, again] = ["a.csv", "a.parquet", "b.csv"].map(|name| folder.path().join(name));
    for second in ["2026-10-05T10:00:01,2", "1791194401.5,2"] {
        fs::write(&text, format!("t,f1\n2026-10-05T10:00:00Z,1\n{second}\n")).unwrap();
        let error = copy(&text, &table).unwrap_err().to_string();
        let expected = "cannot be written: row 2 has no date, or an offset from UTC where the first row has none, or none where it has one";
        assert_eq!(error, format!("{}: {expected}", table.display()));
        assert!(!table.exists());
        copy(&text, &again).unwrap();
        assert_eq!(fs::read(&again).unwrap(), fs::read(&text).unwrap());
    }
}
