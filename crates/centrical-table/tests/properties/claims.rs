//! Files that claim to hold more than they can are refused before anything is set aside for it.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use centrical_table::ColumnName;
use flate2::Compression;
use flate2::write::GzEncoder;

use crate::record::{named, numbered, read_record};

fn message(name: &str, content: &[u8], columns: &[ColumnName; 4]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join(name);
    fs::write(&file, content).unwrap();
    let error = read_record(&file, columns).expect_err("the file can not be right");
    error.to_string().replace(&format!("{}/", folder.path().display()), "")
}

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}

#[test]
fn rows_packed_into_nothing() {
    let mut packed = GzEncoder::new(Vec::new(), Compression::best());
    packed.write_all(b"t,f1,f2,f3\n").unwrap();
    packed.write_all(&b"0,0,0,0\n".repeat(3_000_000)).unwrap();
    let packed = packed.finish().unwrap();
    let message = message("bomb.csv.gz", &packed, &named());
    let start = format!("bomb.csv.gz: found a file of {} bytes that unpacks to more than", packed.len());
    assert!(message.starts_with(&start), "{message}");
}

#[test]
fn an_array_longer_than_its_file() {
    let array = |shape: &str| {
        let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({shape}), }}\n");
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend(u16::try_from(header.len()).unwrap().to_le_bytes());
        bytes.extend(header.as_bytes());
        bytes.extend([0; 64]);
        bytes
    };
    assert_eq!(
        message("m.npy", &array("1152921504606846976, 4"), &numbered()),
        "m.npy, column 1: found a damaged array (failed to fill whole buffer), expected an array as long as it says"
    );
    assert_eq!(
        message("m.npy", &array("2000, 60000"), &numbered()),
        "m.npy, column 1: found a damaged array (480000 bytes a row), expected an array as long as it says"
    );
    assert_eq!(
        message("m.npy", &array("18446744073709551615, 18446744073709551615"), &numbered()),
        "m.npy: found an array of another shape, expected a vector, a matrix or records"
    );
}

#[test]
fn a_page_larger_than_its_column() {
    // The first page of a Parquet file stands after the four bytes `PAR1`: 0x15, type, 0x15, size unpacked.
    let mut bytes = fs::read(data("snappy.parquet")).unwrap();
    assert_eq!((bytes[4], bytes[6]), (0x15, 0x15));
    let size = 7..7 + 1 + bytes[7..].iter().take_while(|byte| **byte >= 0x80).count();
    // 2^31 - 1 as a zigzag number in groups of seven bits takes five bytes: those after it are lost to it.
    let huge = [0xfe, 0xff, 0xff, 0xff, 0x0f, 0x15];
    bytes.splice(size.start..size.start + huge.len(), huge);
    let message = message("m.parquet", &bytes, &named());
    assert!(message.contains("that claims to hold 2147483647"), "{message}");
}

#[test]
#[cfg(feature = "hdf5")]
fn a_number_of_megabytes() {
    // The type of an HDF5 number of 8 bytes: class and bit field, then its size.
    let double = [0x11, 0x20, 0x3f, 0x00, 8, 0, 0, 0];
    let mut bytes = fs::read(data("v110_rows.h5")).unwrap();
    let at = bytes.windows(double.len()).position(|window| window == double).unwrap();
    bytes[at + 6] = 0x80;
    // The checksum at the end of the object's header, over its 264 bytes from 179, as it is then.
    bytes[443..447].copy_from_slice(&[0x9d, 0x2e, 0x91, 0x95]);
    let message = message("m.h5", &bytes, &numbered());
    assert_eq!(message, "m.h5, column 1: found elements of 8388616 bytes, expected numbers");
}
