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

/// The seconds of the first column of a text, and its stamps; or what is wrong with it.
fn dated(text: &str, name: ColumnName) -> Result<(Vec<f64>, Vec<String>), String> {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("m01.csv");
    fs::write(&file, text).unwrap();
    let field = |name: ColumnName, rule| Field { name, expected: "a number".to_owned(), rule };
    let fields = [
        field(name, Rule::Ascending { stamps: true }),
        field(ColumnName::Row, Rule::Any),
        field(ColumnName::Number(3), Rule::Any),
    ];
    let message = |error: centrical_table::Error| error.to_string().split_once("m01.csv, ").unwrap().1.to_owned();
    let mut reader = TableReader::open(&file, Extent::Whole, &fields, "a record").map_err(message)?;
    reader.keep_stamps();
    let (mut times, mut texts) = (Vec::new(), Vec::new());
    while reader.next_batch().map_err(message)?.is_some() {
        for (rows, stamps) in reader.take_stamps().iter().zip(reader.batch()).map(|(stamps, rows)| (rows, stamps)) {
            let text = |row| String::from_utf8(stamps.text(row).unwrap().into_owned()).unwrap();
            texts.extend((0..rows[0].len()).map(text));
            times.extend_from_slice(&rows[0]);
        }
    }
    Ok((times, texts))
}

/// A column of dates and one of times of the day are one time, over midnight too.
#[test]
fn dates_beside_times_of_the_day() {
    // 2026-10-05T23:59:59.75Z, by `date`.
    const LAST: f64 = 1_791_244_799.75;
    let name = |name: &str| ColumnName::Name(name.to_owned());
    let both = |date: ColumnName, time: ColumnName| ColumnName::DateAndTime(Box::new([date, time]));
    let of_names = || both(name("Date"), name("Time"));
    for (delimiter, days, decimal) in [
        (";", ["2026-10-05", "2026-10-06"], ","),
        (",", ["2026/10/05", "2026/10/06"], "."),
        ("\t", ["05.10.2026", "06.10.2026"], ","),
        (" ", ["5.10.2026", "6.10.2026"], "."),
    ] {
        let rows =
            [[days[0], "23:59:59", "75", "1"], [days[1], "00:00:00", "00", "2"], [days[1], "00:00:00", "25", "3"]];
        let row = |[date, time, fraction, reading]: [&str; 4]| {
            format!("{date}{delimiter}{time}{decimal}{fraction}{delimiter}{reading}{delimiter}0\n")
        };
        let rows: String = rows.map(row).concat();
        let header = ["Date", "Time", "f1", "f2"].join(delimiter);
        let (times, texts) = dated(&format!("{header}\n{rows}"), of_names()).unwrap();
        assert_eq!(times, [LAST, LAST + 0.25, LAST + 0.5], "{delimiter}");
        assert_eq!(texts[0], format!("{} 23:59:59{decimal}75", days[0]));
        let numbers = both(ColumnName::Number(1), ColumnName::Number(2));
        assert_eq!(dated(&rows, numbers).unwrap().0, times, "{delimiter}");
    }
    let midnight = "Date;Time;f1\n2026-10-05;23:59:59,75;1\n2026-10-06;00:00:00,25;2\n";
    for (text, column, expected) in [
        (
            midnight,
            name("Time"),
            "line 3, Time: found 0.25 after 86399.75, expected a time that does not run backwards: after midnight a time of the day \
             needs a date, as in time = { date = \"Date\", column = \"Time\" } under [columns]",
        ),
        (
            "Date;Time;f1\n2026-10-05;10:00:01;1\n2026-10-05;10:00:00;2\n",
            of_names(),
            "line 3, Date and Time: found 1791194400 after 1791194401, expected a time that does not run backwards",
        ),
        (
            "Date;Time;f1\n05/10/2026;10:00:01;1\n",
            of_names(),
            "line 2, Date and Time: found \"05/10/2026 10:00:01\", expected a date and a time of the day, such as 2026-10-05 and \
             10:00:00.25",
        ),
        (
            "Day;Time;f1\n05.10.2026;10:00:01;1\n",
            of_names(),
            "line 1, Date: found columns \"Day, Time, f1\", expected a column of this name",
        ),
        (
            midnight,
            both(name("Time"), name("Time")),
            "line 1, Time and Time: found column 2 asked for twice, expected a column of its own for every quantity",
        ),
        (
            "Time;f1;f2\n604799.75;1;1\n0.25;2;2\n",
            name("Time"),
            "line 3, Time: found 0.25 after 604799.75, expected a time that does not run backwards: a week ends at 604800, add 604800 to \
             the times after it",
        ),
        (
            "Time;f1;f2\n4294967290;1;1\n4;2;2\n",
            name("Time"),
            "line 3, Time: found 4 after 4294967290, expected a time that does not run backwards: a counter of 32 bits ends at \
             4294967296, add 4294967296 to the times after it",
        ),
        (
            "Time;f1;f2\n2026-10-25T02:59:59.75;1;1\n2026-10-25T02:00:00.00;2;2\n",
            name("Time"),
            "line 3, Time: found 1792893600 after 1792897199.75, expected a time that does not run backwards: after an hour that comes \
             twice, as summer time ends, stamps need UTC or an offset",
        ),
        (
            "Time;f1;f2\n0.75;1;1\n0.25;2;2\n",
            name("Time"),
            "line 3, Time: found 0.25 after 0.75, expected a time that does not run backwards",
        ),
    ] {
        assert_eq!(dated(text, column).unwrap_err(), expected);
    }
    let error = TableReader::open(
        &data("stamps.tdms"),
        Extent::Whole,
        &[Field { name: of_names(), expected: "a time".to_owned(), rule: Rule::Ascending { stamps: true } }],
        "a record",
    );
    let message = error.err().unwrap().to_string();
    let expected = "Date and Time: found a date and a time, which text, Parquet and Arrow alone have in two columns, expected one column of \
         timestamps, or of seconds";
    assert!(message.ends_with(expected), "{message}");
}

/// The seconds of a date and a time of the day of a binary table, and their stamps as text.
fn of_two_columns(file: &str, [date, time]: [&str; 2]) -> Result<(Vec<f64>, Vec<String>), String> {
    let name = ColumnName::DateAndTime(Box::new([date, time].map(|name| ColumnName::Name(name.to_owned()))));
    let field = |name, rule| Field { name, expected: "a number".to_owned(), rule };
    let reading = field(ColumnName::Name("f1".to_owned()), Rule::Any);
    let fields = [field(name, Rule::Ascending { stamps: true }), reading];
    let message = |error: centrical_table::Error| error.to_string().split_once(", ").unwrap().1.to_owned();
    let mut reader = TableReader::open(&data(file), Extent::Whole, &fields, "a record").map_err(message)?;
    reader.keep_stamps();
    let (mut times, mut texts) = (Vec::new(), Vec::new());
    while reader.next_batch().map_err(message)?.is_some() {
        for (stamps, rows) in reader.take_stamps().iter().zip(reader.batch()) {
            assert_eq!(rows.len(), 2);
            texts.extend((0..rows[0].len()).map(|row| String::from_utf8(stamps.text(row).unwrap().into()).unwrap()));
            times.extend_from_slice(&rows[0]);
        }
    }
    Ok((times, texts))
}

/// Dates and times of the day as pyarrow writes them, in every type that it has; the texts are those of the record, by `record.csv`.
#[test]
fn dates_beside_times_of_the_day_in_parquet_and_arrow() {
    // 2026-10-06T00:00:00Z, by `date`.
    const MIDNIGHT: f64 = 1_791_244_800.0;
    let t: Vec<f64> =
        lines(&data("record.csv")).iter().map(|line| line.split(',').next().unwrap().parse().unwrap()).collect();
    for (file, date) in [("dates.parquet", "Date"), ("dates.feather", "Date"), ("dates.feather", "Date64")] {
        for (time, resolution) in [("Time", 1e9), ("Time us", 1e6), ("Time ms", 1e3), ("Time s", 1.0)] {
            if file.ends_with("parquet") && time == "Time s" {
                // To Parquet pyarrow writes milliseconds of it.
                continue;
            }
            let (times, texts) = of_two_columns(file, [date, time]).unwrap();
            let expected: Vec<f64> = t.iter().map(|t| MIDNIGHT + (t * resolution).floor() / resolution).collect();
            assert_eq!(times, expected, "{file}, {date}, {time}");
            let last = ["2026-10-05T23:59:59.500000000", "2026-10-05T23:59:59.000000000"];
            assert_eq!(texts[0], last[usize::from(time == "Time s")], "{file}, {date}, {time}");
        }
    }
    for (columns, expected) in [
        (["Date", "f1"], "f1: found DOUBLE, expected times of the day"),
        (["f1", "Time"], "f1: found DOUBLE, expected dates"),
        (["Time", "Date"], "Time: found Time, expected dates"),
        (["Day", "Time"], "Day: found columns "),
    ] {
        let message = of_two_columns("dates.parquet", columns).unwrap_err();
        assert!(message.starts_with(expected), "{message}");
    }
    let message = of_two_columns("dates.feather", ["Date", "f1"]).unwrap_err();
    assert_eq!(message, "f1: found a column without numbers, expected times of the day");
}
