use std::fs;
use std::path::Path;

use centrical_compensate::{Compensation, Term};
use centrical_session::{Columns, CompensatedRecord, Record, RecordReader, RecordWriter, compensate_record, unwatched};
use proptest::prelude::*;

/// A record of `rows` rows whose numbers need all their digits.
fn record(rows: usize, seed: f64) -> Record {
    let column = |phase: f64| (0..rows).map(|k| 100.0 * (seed + phase * k as f64).sin()).collect();
    Record { t: (0..rows).map(|k| k as f64 / 3.0).collect(), f_z: [column(1.1), column(1.2), column(1.3)] }
}

fn read(file: &Path) -> Record {
    RecordReader::open(file, &Columns::default()).and_then(|reader| reader.into_record(&unwatched)).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// What is written reads back to the bit, in either format.
    #[test]
    fn records_come_back(rows in 1..40_000_usize, seed in 0.0..1.0_f64) {
        let folder = tempfile::tempdir().unwrap();
        let record = record(rows, seed);
        for name in ["record.csv", "record.parquet"] {
            let file = folder.path().join(name);
            let mut writer = RecordWriter::create(&file).unwrap();
            writer.write(record.as_slice()).unwrap();
            prop_assert!(!file.exists(), "not before it is whole");
            writer.finish().unwrap();
            prop_assert!(read(&file) == record, "{}", name);
        }
    }

    /// A record compensated from file to file is the record compensated in memory.
    #[test]
    fn file_to_file_is_in_memory(rows in 1..60_000_usize, seed in 0.0..1.0_f64) {
        let folder = tempfile::tempdir().unwrap();
        let terms = [Term::power(0, 0, 1, 1e-3), Term::power(1, 2, 2, 1e-5), Term::power(2, 0, 0, 0.1)];
        let compensation = Compensation::new(&terms, 200.0).unwrap();
        let mut record = record(rows, seed);
        let [input, output] = ["in.csv", "out.parquet"].map(|name| folder.path().join(name));
        let mut writer = RecordWriter::create(&input).unwrap();
        writer.write(record.as_slice()).unwrap();
        writer.finish().unwrap();
        let compensated = compensate_record(&compensation, &input, &Columns::default(), &output, &unwatched).unwrap();
        let unit = "m/s^2".to_owned();
        let expected = CompensatedRecord { unit, readings: rows as u64, ..CompensatedRecord::default() };
        prop_assert_eq!(compensated, expected);
        compensation.apply_all(record.f_z.each_mut().map(Vec::as_mut_slice)).unwrap();
        prop_assert!(read(&output) == record);
    }

    /// As text: time to the bit, specific forces to the reported decimals, which are below a part in 10^12 of the range.
    #[test]
    fn text_is_rounded_as_it_says(rows in 1..20_000_usize, seed in 0.0..1.0_f64, range in 150.0..4000.0_f64) {
        let folder = tempfile::tempdir().unwrap();
        let terms = [Term::power(0, 0, 1, 1e-3), Term::power(1, 2, 2, 1e-6), Term::power(2, 0, 0, 0.1)];
        let compensation = Compensation::new(&terms, range).unwrap();
        let mut record = record(rows, seed);
        let [input, output] = ["in.parquet", "out.csv"].map(|name| folder.path().join(name));
        let mut writer = RecordWriter::create(&input).unwrap();
        writer.write(record.as_slice()).unwrap();
        writer.finish().unwrap();
        let compensated = compensate_record(&compensation, &input, &Columns::default(), &output, &unwatched).unwrap();
        let half = 0.5 * 10_f64.powi(-i32::try_from(compensated.decimals.unwrap()).unwrap());
        prop_assert!(half <= 1e-12 * range);
        compensation.apply_all(record.f_z.each_mut().map(Vec::as_mut_slice)).unwrap();
        let back = read(&output);
        prop_assert!(back.t == record.t);
        for (f, back) in record.f_z.iter().flatten().zip(back.f_z.iter().flatten()) {
            prop_assert!((f - back).abs() <= 1.01 * half, "{} as {}", f, back);
        }
    }
}

/// A record that was not finished leaves nothing behind; nor does one that cannot be read.
#[test]
fn nothing_is_left_of_half_a_record() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("half.csv");
    let mut writer = RecordWriter::create(&file).unwrap();
    writer.write(record(10, 0.5).as_slice()).unwrap();
    drop(writer);
    let input = folder.path().join("bad.csv");
    fs::write(&input, "t,f1,f2,f3\n0,1,2,3\n1,1,oops,3\n").unwrap();
    let compensation = Compensation::new(&[], 200.0).unwrap();
    let error =
        compensate_record(&compensation, &input, &Columns::default(), &file, &unwatched).unwrap_err().to_string();
    assert!(error.contains("bad.csv, line 3, f2: found \"oops\""), "{error}");
    let left: Vec<_> = fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(left, ["bad.csv"]);
}

#[test]
fn stamps_go_through_letter_by_letter() {
    let stamps = ["05.10.2026 09:10:00,0100", "05.10.2026 09:10:00,02", "05.10.2026 09:10:1,1000000000"];
    let rows: Vec<String> = stamps.iter().map(|stamp| format!("{stamp};0,5;-0,25;9,75")).collect();
    let iso = ["2026-10-05T09:10:00.0100+03:00", "2026-10-05T09:10:00.02+03:00"];
    let iso_rows: Vec<String> = iso.iter().map(|stamp| format!("{stamp},0.5,-0.25,9.75")).collect();
    let compensation = Compensation::new(&[], 100.0).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let (input, output) = (folder.path().join("in.csv"), folder.path().join("out.csv"));
    for (header, rows, stamps) in [("t;f1;f2;f3", rows, &stamps[..]), ("t,f1,f2,f3", iso_rows, &iso[..])] {
        fs::write(&input, format!("{header}\n{}", rows.join("\n"))).unwrap();
        compensate_record(&compensation, &input, &Columns::default(), &output, &unwatched).unwrap();
        let text = fs::read_to_string(&output).unwrap();
        let quoted = |stamp: &str| if stamp.contains(',') { format!("\"{stamp}\"") } else { stamp.to_owned() };
        let expected: Vec<String> =
            stamps.iter().map(|stamp| format!("{},0.5000000000,-0.2500000000,9.7500000000", quoted(stamp))).collect();
        assert_eq!(text.lines().skip(1).collect::<Vec<_>>(), expected);
        let [before, after] = [&input, &output].map(|file| read(file));
        assert_eq!(before, after);
    }
}
