//! Stamps are written as they were read: type, unit, adjustment to UTC and integers as pyarrow writes them, texts as NumPy does.

use std::fs::{self, File};
use std::path::Path;

use centrical_table::{ColumnName, Decimals, Extent, Field, Rows, Rule, Stamps, TableReader, TableWriter};
use parquet::basic::{LogicalType, TimeUnit, Type};
use parquet::column::reader::ColumnReader;
use parquet::file::reader::{FileReader, SerializedFileReader};

use crate::formats::data;

/// Columns of the generator, each a unit of time.
const COLUMNS: [&str; 8] = ["s", "s_utc", "ms", "ms_utc", "us", "us_utc", "ns", "ns_utc"];

/// Writes a column of time to a table of its own.
fn copy(input: &Path, column: &str, output: &Path) {
    let name = ColumnName::Name(column.to_owned());
    let fields = [Field { name, expected: "a time".to_owned(), rule: Rule::Ascending { stamps: true } }];
    let mut reader = TableReader::open(input, Extent::Whole, &fields, "a record").unwrap();
    reader.keep_stamps();
    let mut writer = TableWriter::create(output, &["t"], [Decimals::SHORTEST]).unwrap();
    while reader.next_batch().unwrap().is_some() {
        let stamps: Vec<Stamps> = reader.take_stamps();
        for (rows, stamps) in reader.batch().iter().zip(&stamps) {
            let rows: &Rows = rows;
            writer.write_stamped(stamps, [&rows[0]]).unwrap();
        }
    }
    writer.finish().unwrap();
}

/// Type and values of an integer column of a Parquet file, as the library reads them.
fn integers(file: &Path, column: &str) -> (Option<LogicalType>, Vec<i64>) {
    let reader = SerializedFileReader::new(File::open(file).unwrap()).unwrap();
    let columns = reader.metadata().file_metadata().schema_descr().columns().to_vec();
    let place = columns.iter().position(|own| own.name() == column).unwrap();
    assert_eq!(columns[place].physical_type(), Type::INT64, "{column}");
    let mut values = Vec::new();
    for group in 0..reader.num_row_groups() {
        let rows = reader.get_row_group(group).unwrap();
        let ColumnReader::Int64ColumnReader(mut column) = rows.get_column_reader(place).unwrap() else { panic!() };
        let mut levels = Vec::new();
        column.read_records(usize::MAX >> 1, Some(&mut levels), None, &mut values).unwrap();
    }
    (columns[place].logical_type_ref().cloned(), values)
}

/// The lines of a text, the header left out.
fn lines(file: &Path) -> Vec<String> {
    fs::read_to_string(file).unwrap().lines().skip(1).map(str::to_owned).collect()
}

/// A column of the texts that NumPy wrote.
fn texts(column: &str) -> Vec<String> {
    let place = COLUMNS.iter().position(|own| *own == column).unwrap();
    lines(&data("stamps_of_units.txt")).iter().map(|line| line.split(',').nth(place).unwrap().to_owned()).collect()
}

#[test]
fn to_parquet_with_equal_types_and_integers() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("t.parquet");
    for name in ["stamps_of_units.feather", "stamps_of_units.parquet"] {
        for column in COLUMNS {
            copy(&data(name), column, &output);
            // Of a column of seconds, pyarrow makes milliseconds.
            let expected = integers(&data("stamps_of_units.parquet"), column);
            assert_eq!(expected.1.len(), 300);
            assert!(integers(&output, "t") == expected, "{name}, {column}");
        }
    }
}

#[test]
fn to_text_with_all_digits() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("t.csv");
    for name in ["stamps_of_units.feather", "stamps_of_units.parquet"] {
        for column in COLUMNS.iter().filter(|column| name.ends_with("feather") || !column.starts_with('s')) {
            copy(&data(name), column, &output);
            assert_eq!(lines(&output), texts(column), "{name}, {column}");
            // From text to text nothing changes.
            copy(&output, "t", &folder.path().join("again.csv"));
            assert_eq!(fs::read(folder.path().join("again.csv")).unwrap(), fs::read(&output).unwrap());
        }
    }
}

#[test]
fn from_text_to_parquet_in_nanoseconds() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("t.parquet");
    for column in COLUMNS {
        copy(&data("stamps_of_units.txt"), column, &output);
        let (of_pyarrow, ticks) = integers(&data("stamps_of_units.parquet"), column);
        let Some(LogicalType::Timestamp(of_pyarrow)) = of_pyarrow else { panic!("{of_pyarrow:?}") };
        let factor = match of_pyarrow.unit {
            TimeUnit::MILLIS => 1_000_000,
            TimeUnit::MICROS => 1_000,
            TimeUnit::NANOS => 1,
        };
        let expected: Vec<i64> = ticks.iter().map(|ticks| ticks * factor).collect();
        let is_utc = column.ends_with("utc");
        assert_eq!(of_pyarrow.is_adjusted_to_u_t_c, is_utc);
        let form = Some(LogicalType::timestamp(is_utc, TimeUnit::NANOS));
        assert!(integers(&output, "t") == (form, expected), "{column}");
    }
}

#[test]
fn timestamps_of_tdms() {
    let folder = tempfile::tempdir().unwrap();
    let [text, table] = ["t.csv", "t.parquet"].map(|name| folder.path().join(name));
    copy(&data("stamps.tdms"), "t", &text);
    copy(&data("stamps.tdms"), "t", &table);
    // The same microseconds as Python writes them; npTDMS writes them as fractions of 2^-64 s.
    let expected =
        lines(&data("stamps.csv")).into_iter().map(|line| format!("{}000Z", line.split(',').next().unwrap()));
    let expected: Vec<String> = expected.collect();
    assert_eq!(lines(&text), expected);
    let (form, ticks) = integers(&table, "t");
    assert_eq!(form, Some(LogicalType::timestamp(true, TimeUnit::NANOS)));
    let of_text = expected.iter().map(|text| text.parse::<jiff::Timestamp>().unwrap().as_nanosecond());
    assert!(ticks.iter().map(|ticks| i128::from(*ticks)).eq(of_text));
}
