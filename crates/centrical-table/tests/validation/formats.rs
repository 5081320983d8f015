//! Every format against the text that the same program wrote, bit by bit.

use std::fs;
use std::path::{Path, PathBuf};

use centrical_table::ColumnName;

use crate::record::{Record, named, numbered, read_record};

/// A file as it is kept or, with `CENTRICAL_GENERATED`, as those programs wrote it just now into that folder.
pub fn data(name: &str) -> PathBuf {
    let kept = || Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    std::env::var_os("CENTRICAL_GENERATED").map_or_else(kept, PathBuf::from).join(name)
}

/// The reference, by the standard library's own parser.
fn reference() -> Record {
    let text = fs::read_to_string(data("record.csv")).unwrap();
    let mut record = Record::default();
    for line in text.lines().skip(1) {
        let row: Vec<f64> = line.split(',').map(|field| field.parse().unwrap()).collect();
        record.iter_mut().zip(row).for_each(|(column, value)| column.push(value));
    }
    assert_eq!(record[0].len(), 300);
    record
}

/// The record of a file with readings in counts of 8192 to the m/s^2.
fn read_counts(name: &str) -> Record {
    let mut record = read_record(&data(name), &named()).unwrap();
    record[1..].iter_mut().flatten().for_each(|count| *count /= 8192.0);
    record
}

#[test]
fn text_is_read_to_the_last_bit() {
    assert_eq!(read_record(&data("record.csv"), &named()).unwrap(), reference());
}

#[test]
fn text_of_every_kind() {
    for name in ["record.csv.gz", "record.csv.zst", "comma.csv", "savetxt.txt", "extra.csv"] {
        assert_eq!(read_record(&data(name), &named()).unwrap(), reference(), "{name}");
    }
}

#[test]
fn frames_of_pandas_and_polars() {
    let names = [
        "pandas.csv",
        "pandas.parquet",
        "pandas.feather",
        "polars.csv",
        "polars.parquet",
        "polars.arrow",
        "polars.arrows",
    ];
    for name in names {
        assert_eq!(read_record(&data(name), &named()).unwrap(), reference(), "{name}");
    }
}

#[test]
fn arrow_files_and_streams() {
    for name in ["uncompressed.feather", "lz4.feather", "zstd.feather", "wide.arrows", "plain.arrows"] {
        assert_eq!(read_record(&data(name), &named()).unwrap(), reference(), "{name}");
    }
    assert_eq!(read_record(&data("plain.arrows"), &numbered()).unwrap(), reference());
    assert_eq!(read_counts("counts.feather"), reference());
}

#[test]
fn arrow_that_is_no_record() {
    let cases = [
        ("null.feather", ", f2: found 1 values missing, expected a value in every row, NaN where a reading is missing"),
        ("text.arrows", ", f2: found a column without numbers, expected a number in m/s^2"),
    ];
    for (name, expected) in cases {
        let file = data(name);
        let error = read_record(&file, &named()).unwrap_err();
        assert_eq!(error.to_string(), format!("{}{expected}", file.display()));
    }
    // The length of a packed column stands before its frame of LZ4: here 97 numbers, and one more that is not there.
    let mut bytes = fs::read(data("lz4.feather")).unwrap();
    let frame = bytes.windows(4).position(|word| word == [4, 0x22, 0x4d, 0x18]).unwrap();
    bytes[frame - 8] += 8;
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("m01.arrow");
    fs::write(&file, bytes).unwrap();
    let error = read_record(&file, &named()).unwrap_err().to_string();
    assert!(error.contains("it unpacks to 776 bytes where 784 are stated"), "{error}");
}

#[test]
fn text_without_a_header() {
    for name in ["headerless.txt", "headerless.tsv"] {
        assert_eq!(read_record(&data(name), &numbered()).unwrap(), reference(), "{name}");
    }
}

#[test]
fn arrays_with_names() {
    for name in ["record.npy", "plain.npz", "packed.npz", "plain.mat", "packed.mat"] {
        assert_eq!(read_record(&data(name), &named()).unwrap(), reference(), "{name}");
    }
}

#[test]
fn matrices() {
    for name in ["rows.npy", "columns.npy", "big_endian.npy", "matrix.npz", "matrix.mat"] {
        assert_eq!(read_record(&data(name), &numbered()).unwrap(), reference(), "{name}");
    }
}

#[test]
fn arrays_of_integer_counts() {
    for name in ["counts.npz", "counts.mat"] {
        assert_eq!(read_counts(name), reference(), "{name}");
    }
}

#[test]
#[cfg(feature = "hdf5")]
fn hdf5() {
    for name in ["named.h5", "v110.h5", "matlab73.mat"] {
        assert_eq!(read_record(&data(name), &named()).unwrap(), reference(), "{name}");
    }
    for name in ["matrix.h5", "v110_rows.h5", "v110_early.h5", "unlimited.h5"] {
        assert_eq!(read_record(&data(name), &numbered()).unwrap(), reference(), "{name}");
    }
    assert_eq!(read_counts("counts.h5"), reference());
}

/// Of what h5py writes the library has no reader for one index of chunks, nor for the form of HDF5 2.0.
#[test]
#[cfg(feature = "hdf5")]
fn hdf5_that_cannot_be_read() {
    let cases = [
        (
            "unlimited_v110.h5",
            "chunks indexed by a B-tree of version 2, expected another index: at most one unlimited dimension, or a file for \
             earlier versions (in h5py libver=\"earliest\")",
        ),
        (
            "unlimited_v200.h5",
            "a data layout of version 5, expected 4 or before: a file for HDF5 1.14 or earlier versions (in h5py \
             libver=\"earliest\")",
        ),
    ];
    for (name, expected) in cases {
        let file = data(name);
        let error = read_record(&file, &numbered()).unwrap_err();
        assert_eq!(error.to_string(), format!("{}, column 1: found {expected}", file.display()));
    }
}

#[test]
#[cfg(not(feature = "hdf5"))]
fn hdf5_is_a_feature() {
    let file = data("named.h5");
    let error = read_record(&file, &named()).unwrap_err();
    let expected = "found HDF5, expected another format (this program was built without the feature hdf5)";
    assert_eq!(error.to_string(), format!("{}: {expected}", file.display()));
}

#[test]
fn columns_of_matrices_by_name() {
    let of = |matrix: &str| [1, 2, 3, 4].map(|number| ColumnName::Name(format!("{matrix}(:,{number})")));
    for (name, matrix) in [("matrix.mat", "data"), ("matrix.npz", "arr_0")] {
        assert_eq!(read_record(&data(name), &of(matrix)).unwrap(), reference(), "{name}");
    }
    #[cfg(feature = "hdf5")]
    assert_eq!(read_record(&data("matrix.h5"), &of("data")).unwrap(), reference());
}

/// A matrix with few rows and thousands of columns is a table on its side.
#[test]
fn matrices_on_their_side() {
    const ROWS: u32 = 1200;
    let value = |row: u32, column: u32| f64::from(row + ROWS * column);
    let expected = [0, 1, 2, 3].map(|column| (0..ROWS).map(|row| value(row, column)).collect::<Vec<f64>>());
    let folder = tempfile::tempdir().unwrap();
    for by_columns in [false, true] {
        let truth = if by_columns { "True" } else { "False" };
        let header = format!("{{'descr': '<f8', 'fortran_order': {truth}, 'shape': (4, {ROWS}), }}\n");
        let mut file = b"\x93NUMPY\x01\x00".to_vec();
        file.extend_from_slice(&u16::try_from(header.len()).unwrap().to_le_bytes());
        file.extend_from_slice(header.as_bytes());
        let places: Vec<(u32, u32)> = if by_columns {
            (0..ROWS).flat_map(|row| (0..4).map(move |column| (row, column))).collect()
        } else {
            (0..4).flat_map(|column| (0..ROWS).map(move |row| (row, column))).collect()
        };
        file.extend(places.iter().flat_map(|(row, column)| value(*row, *column).to_le_bytes()));
        let path = folder.path().join("side.npy");
        fs::write(&path, file).unwrap();
        assert_eq!(read_record(&path, &numbered()).unwrap(), expected, "{truth}");
    }
    // One row of many numbers is a column.
    let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': (1, {ROWS}), }}\n");
    let length = u16::try_from(header.len()).unwrap().to_le_bytes();
    let numbers: Vec<u8> = expected[0].iter().flat_map(|number| number.to_le_bytes()).collect();
    let path = folder.path().join("row.npy");
    fs::write(&path, [b"\x93NUMPY\x01\x00".as_slice(), &length, header.as_bytes(), &numbers].concat()).unwrap();
    let name = centrical_table::binary_columns(&path).unwrap();
    assert_eq!(name, [ColumnName::Number(1)]);
}

#[test]
fn arrays_that_are_no_record() {
    let cases = [
        (
            "rows.npy",
            "t: found columns \"(300 x 4)\", expected a column of this name (for a matrix give [columns] by number)",
        ),
        (
            "matrix.mat",
            "t: found columns \"data (300 x 4)\", expected a column of this name (for a matrix give [columns] by number)",
        ),
    ];
    for (name, expected) in cases {
        let file = data(name);
        let error = read_record(&file, &named()).unwrap_err();
        assert_eq!(error.to_string(), format!("{}, {expected}", file.display()));
    }
    let file = data("plain.npz");
    let error = read_record(&file, &numbered()).unwrap_err();
    let expected =
        "column 1: found columns \"t, f1, f2, f3, other (no numbers)\", expected one array, or [columns] by name";
    assert_eq!(error.to_string(), format!("{}, {expected}", file.display()));
}

#[test]
fn time_as_stamps() {
    // 2026-10-05T10:00:00Z, by `date -d 2026-10-05T10:00:00Z +%s`; stamps carry microseconds.
    const START: f64 = 1_791_194_400.0;
    for name in ["stamps.csv", "stamps.parquet", "stamps.feather"] {
        let record = read_record(&data(name), &named()).unwrap();
        assert_eq!(record[1..], reference()[1..], "{name}");
        for (t, reference) in record[0].iter().zip(&reference()[0]) {
            assert!((t - START - reference).abs() < 1.5e-6, "{name}: {t} for {reference}");
        }
    }
}

#[test]
fn parquet_of_every_compression_and_encoding() {
    for name in ["snappy", "zstd", "gzip", "lz4", "required", "split", "wide"] {
        let record = read_record(&data(&format!("{name}.parquet")), &named()).unwrap();
        assert_eq!(record, reference(), "{name}");
    }
}

#[test]
fn parquet_of_integer_counts() {
    for name in ["counts_int32", "counts_int64"] {
        let record = read_counts(&format!("{name}.parquet"));
        assert_eq!(record, reference(), "{name}");
    }
}

#[test]
fn parquet_that_is_no_record() {
    let cases = [
        ("null", ", row 8, f2: found no value, expected a number in m/s^2"),
        ("brotli", ", t: found Brotli compression, expected Snappy, gzip, LZ4, Zstandard or none"),
        ("text", ", f2: found String, expected a number in m/s^2"),
        ("nan", ", row 251, f3: found NaN, expected a number in m/s^2"),
        ("backwards", ", row 151, t: found -9 after 0.9140625, expected a time that does not run backwards"),
    ];
    for (name, expected) in cases {
        let file = data(&format!("{name}.parquet"));
        let error = read_record(&file, &named()).unwrap_err();
        assert_eq!(error.to_string(), format!("{}{expected}", file.display()));
    }
    let mut columns = named();
    columns[2] = ColumnName::Name("g2".to_owned());
    let file = data("snappy.parquet");
    let error = read_record(&file, &columns).unwrap_err();
    let expected = "g2: found columns \"t, f1, f2, f3\", expected one column of this name";
    assert_eq!(error.to_string(), format!("{}, {expected}", file.display()));
}

#[test]
fn channels_of_tdms() {
    for name in ["plain.tdms", "segments.tdms", "scaled.tdms", "interleaved.tdms", "big_endian.tdms", "daqmx.tdms"] {
        assert_eq!(read_record(&data(name), &named()).unwrap(), reference(), "{name}");
    }
    assert_eq!(read_record(&data("plain.tdms"), &numbered()).unwrap(), reference());
    let full = ["g/t", "g/f1", "g/f2", "g/f3"].map(|name| ColumnName::Name(name.to_owned()));
    assert_eq!(read_record(&data("segments.tdms"), &full).unwrap(), reference());
}

/// 2026-10-05T10:00:00Z.
const START: f64 = 1_791_194_400.0;

#[test]
fn times_of_tdms() {
    let [t, f @ ..] = read_record(&data("stamps.tdms"), &named()).unwrap();
    // To the microseconds that the generator wrote and the 2^-22 s that a number of seconds of this size resolves.
    let is_near = |(own, reference): (&f64, &f64)| (own - START - reference).abs() < 1e-6;
    assert!(t.len() == 300 && t.iter().zip(&reference()[0]).all(is_near));
    assert_eq!(f[..], reference()[1..]);
    let [t, f @ ..] = read_record(&data("waveform.tdms"), &named()).unwrap();
    assert!(t.iter().enumerate().all(|(k, t)| *t == START + 0.25 + k as f64 / 128.0) && t.len() == 300);
    assert_eq!(f[..], reference()[1..]);
}

#[test]
fn text_as_recorders_write_it() {
    let names = ["Время", "Ускорение 1", "Ускорение 2", "Ускорение 3"].map(|name| ColumnName::Name(name.to_owned()));
    for name in ["windows_1251.csv", "utf_16.csv", "utf_16_be.csv", "utf_8_mark.csv"] {
        let [t, f @ ..] = read_record(&data(name), &names).unwrap();
        assert!(t.iter().zip(&reference()[0]).all(|(own, reference)| (own - START - reference).abs() < 1e-6), "{name}");
        assert_eq!(f[..], reference()[1..], "{name}");
    }
    let names = ["Zeit", "Größe 1", "Größe 2", "Größe 3"].map(|name| ColumnName::Name(name.to_owned()));
    assert_eq!(read_record(&data("latin_1.csv"), &names).unwrap(), reference());
}

#[test]
fn tdms_that_is_no_record() {
    let folder = tempfile::tempdir().unwrap();
    let message = |bytes: &[u8], names: [&str; 4]| {
        let file = folder.path().join("record.tdms");
        fs::write(&file, bytes).unwrap();
        let names = names.map(|name| ColumnName::Name(name.to_owned()));
        read_record(&file, &names).unwrap_err().to_string().replace(&file.display().to_string(), "record.tdms")
    };
    let segments = fs::read(data("segments.tdms")).unwrap();
    assert_eq!(
        message(&segments, ["t", "f1", "f2", "f9"]),
        "record.tdms, f9: found 7 rows where t has 300, expected columns of equal length"
    );
    assert_eq!(
        message(&segments, ["t", "f1", "f2", "f4"]),
        "record.tdms, f4: found channels \"notes/f9, g/t, g/f1, g/f2, g/f3\", expected a channel of this name"
    );
    assert_eq!(
        message(b"TDSh\x0e\0\0\0", ["t", "f1", "f2", "f3"]),
        "record.tdms: found the index of a TDMS file, without its numbers, expected the file of the same name that ends in .tdms"
    );
    assert_eq!(
        message(&segments[..40], ["t", "f1", "f2", "f3"]),
        "record.tdms: found a damaged TDMS file (metadata that end within a value), expected a TDMS file that is whole"
    );
    let scaled = fs::read(data("scaled.tdms")).unwrap();
    let at = scaled.windows(6).position(|bytes| bytes == b"Linear").unwrap();
    let mut other = scaled.clone();
    other[at..at + 6].copy_from_slice(b"Strain");
    assert_eq!(
        message(&other, ["t", "f1", "f2", "f3"]),
        "record.tdms, f1: found a scale of type Strain, expected linear and polynomial scales, or data that are scaled already"
    );
}

#[test]
#[cfg(feature = "xlsx")]
fn workbooks() {
    assert_eq!(read_record(&data("typed.xlsx"), &named()).unwrap(), reference());
    let [t, f @ ..] = read_record(&data("dates.xlsx"), &named()).unwrap();
    assert_eq!(f[..], reference()[1..]);
    // A workbook keeps a date to some microseconds; it is read to the millisecond.
    assert!(t.iter().enumerate().all(|(k, t)| (t - START - 0.008 * k as f64).abs() < 1e-6), "{t:?}");
    let error = read_record(&data("formula.xlsx"), &named()).unwrap_err().to_string();
    assert!(error.ends_with("formula.xlsx, line 2, f3: found \"\", expected a number in m/s^2"), "{error}");
    let form = centrical_table::text_form(&data("typed.xlsx")).unwrap().unwrap();
    assert_eq!((form.header_line, form.units_line, form.first_row_line), (Some(3), Some(4), 5));
    assert_eq!(form.above, ["\"A record; typed\";;;;"]);
}

#[test]
#[cfg(not(feature = "xlsx"))]
fn workbooks_are_named() {
    let error = read_record(&data("typed.xlsx"), &named()).unwrap_err().to_string();
    let expected = "typed.xlsx: found a workbook (.xlsx), expected the sheet saved as text (this program was built without the \
                    feature xlsx)";
    assert!(error.ends_with(expected), "{error}");
}
