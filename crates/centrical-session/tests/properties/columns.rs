//! Columns of records, whatever takes them to SI.

use std::path::Path;

use centrical_session::{Column, ColumnName, Columns, Record, RecordReader, Scale, unwatched};

fn read(name: &str, columns: &Columns) -> Record {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../centrical-table/tests/data");
    RecordReader::open(&data.join(name), columns).and_then(|reader| reader.into_record(&unwatched)).unwrap()
}

#[test]
fn counts_are_scaled() {
    let mut columns = Columns::default();
    columns.f.iter_mut().for_each(|column| column.scale = Scale { offset: 0.0, factor: 1.0 / 8192.0 });
    assert_eq!(read("counts.mat", &columns), read("record.csv", &Columns::default()));
}

#[test]
fn time_as_a_count_of_samples() {
    let name = ColumnName::Name("n".to_owned());
    let time = Column { name, unit: "samples".to_owned(), scale: Scale::factor(1.0 / 128.0) };
    let mut columns = Columns { time, ..Columns::default() };
    let reference = read("record.csv", &Columns::default());
    assert_eq!(read("counter.csv", &columns), reference);
    columns.time.name = ColumnName::Row;
    let record = read("counter.csv", &columns);
    assert_eq!(record.f_z, reference.f_z);
    assert!(record.t.iter().enumerate().all(|(row, t)| *t == row as f64 / 128.0));
}
