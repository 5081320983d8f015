//! The formats of tables by the endings of their files: a format is read by its first bytes, and written by the name of the file.

use std::path::Path;

/// How a table is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TableFormat {
    /// Text.
    #[default]
    Csv,
    /// Parquet.
    Parquet,
}

/// A format: its name, the endings of its files, whether it is read, and how it is written, if it is.
type NamedFormat = (&'static str, &'static [&'static str], bool, Option<TableFormat>);

const FORMATS: [NamedFormat; 10] = [
    ("text", &["csv", "tsv", "txt", "dat", "asc", "lvm", "log"], true, Some(TableFormat::Csv)),
    ("packed text", &["gz", "zst"], true, None),
    ("Parquet", &["parquet", "pq"], true, Some(TableFormat::Parquet)),
    ("Arrow", &["arrow", "arrows", "feather"], true, None),
    ("NumPy", &["npy", "npz"], true, None),
    ("MATLAB", &["mat"], true, None),
    ("HDF5", &["h5", "hdf5"], true, None),
    ("TDMS", &["tdms"], true, None),
    ("workbook", &["xlsx"], cfg!(feature = "xlsx"), None),
    ("other workbook", &["xls", "ods"], false, None),
];

impl TableFormat {
    /// The format that the name of a file asks for: Parquet where it ends in `.parquet` or `.pq`, otherwise text.
    pub fn of(file: &Path) -> Self {
        named(file).and_then(|(.., written)| *written).unwrap_or_default()
    }

    /// How names of such files end.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Parquet => "parquet",
        }
    }
}

/// Whether names of tables that are read end so, without the dot.
pub fn is_ending_of_table(ending: &str) -> bool {
    of_ending(ending).is_some_and(|(_, _, is_read, _)| *is_read)
}

/// The format that the name of a file asks for where that is not written: text under such a name would deceive.
pub fn not_written(file: &Path) -> Option<&'static str> {
    named(file).filter(|(.., written)| written.is_none()).map(|(name, ..)| *name)
}

fn named(file: &Path) -> Option<&'static NamedFormat> {
    of_ending(file.extension()?.to_str()?)
}

fn of_ending(ending: &str) -> Option<&'static NamedFormat> {
    FORMATS.iter().find(|(_, endings, ..)| endings.iter().any(|known| known.eq_ignore_ascii_case(ending)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is written is read, and what is read under a name that is not written is not written as text.
    #[test]
    fn an_ending_is_of_one_format() {
        let endings: Vec<&str> = FORMATS.iter().flat_map(|(_, endings, ..)| endings.iter().copied()).collect();
        assert!((1..endings.len()).all(|n| !endings[..n].contains(&endings[n])));
        assert!(FORMATS.iter().all(|(_, _, is_read, written)| *is_read || written.is_none()));
        assert_eq!(
            ["a.PQ", "a.parquet", "a.csv", "a.new"].map(|name| TableFormat::of(Path::new(name)).extension()),
            ["parquet", "parquet", "csv", "csv"]
        );
        assert_eq!(
            ["a.csv.gz", "a.arrows", "a.xlsx", "a.csv"].map(|name| not_written(Path::new(name))),
            [Some("packed text"), Some("Arrow"), Some("workbook"), None]
        );
        assert_eq!(
            ["TDMS", "arrows", "ods", "xlsx", "toml"].map(is_ending_of_table),
            [true, true, false, cfg!(feature = "xlsx"), false]
        );
    }
}
