//! Records that are read while someone writes them.

use std::fs;

use tempfile::TempDir;

use crate::record::{named, read_growing_record, read_record};

/// Cut anywhere, a text gives the rows whose lines are ended and no other, with both ends of lines.
#[test]
fn a_text_cut_anywhere_gives_its_ended_lines() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("record.csv");
    for end in ["\n", "\r\n"] {
        let mut text = format!("t,f1,f2,f3{end}");
        for k in 0..12 {
            text.extend([format!("{}.125,-9.8{k},0.00{k}e1,1234.5{k}{end}", 10 + k)]);
        }
        fs::write(&file, &text).unwrap();
        let whole = read_record(&file, &named()).unwrap();
        for cut in 0..=text.len() {
            fs::write(&file, &text[..cut]).unwrap();
            let rows = text[..cut].matches('\n').count().saturating_sub(1);
            match read_growing_record(&file) {
                Ok(record) => {
                    (0..4).for_each(|i| assert_eq!(record[i], whole[i][..rows], "cut at {cut}"));
                }
                Err(error) => assert_eq!(rows, 0, "cut at {cut}: {error}"),
            }
        }
    }
}

/// A Parquet file that is there in part is an error, never a shorter record.
#[test]
fn a_parquet_file_in_part_is_refused() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("record.parquet");
    let bytes = fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/zstd.parquet")).unwrap();
    fs::write(&file, &bytes).unwrap();
    assert!(read_growing_record(&file).is_ok());
    for cut in (0..bytes.len()).step_by(7) {
        fs::write(&file, &bytes[..cut]).unwrap();
        assert!(read_growing_record(&file).is_err(), "cut at {cut}");
    }
}
