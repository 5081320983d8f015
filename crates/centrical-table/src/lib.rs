//! Tables of numbers in any format, in and out.
//!
//! Columns are chosen by name or number and read in batches of rows of bounded size, whatever the format and length of
//! the file. Files are of any make: nothing in one can make this crate panic, hang or fill the memory. What is wrong with a
//! file is an [`Error`] with the file, the place, what was found and what was expected.
//!
//! # Formats
//! | format | columns |
//! |---|---|
//! | text, also in gzip or Zstandard: any delimiter, decimal commas, comments, lines above the header, a row of units; UTF-8, UTF-16, Windows-1251 and -1252 | by name, or by number without a header |
//! | Parquet (uncompressed, snappy, gzip, lz4, zstd) | by name or number |
//! | Arrow IPC: files (Feather) and streams, plain, lz4 or zstd | by name or number |
//! | TDMS of National Instruments | channels by name or `group/name`; time of waveforms |
//! | workbooks (`.xlsx`) with the feature `xlsx`: the first sheet, as text | by name or number |
//! | NumPy: `.npy` matrices and records, `.npz` | by name; of a matrix by number, or as `f(:,2)` |
//! | MATLAB 5 (`save -v6`, `-v7`) | variables by name; of a matrix the same |
//! | HDF5 and MATLAB 7.3, with the feature `hdf5` | datasets by name; of a matrix the same |
//!
//! The first bytes of a file show its format. CSV and Parquet can be written.
//!
//! # The mean of a column
//! ```
//! use std::path::Path;
//!
//! use centrical_table::{ColumnName, Extent, Field, Rule, TableReader};
//!
//! let name = ColumnName::Name("f1".into());
//! let fields = [Field { name, expected: "a number in m/s^2".into(), rule: Rule::Any }];
//! let (mut sum, mut count) = (0.0, 0);
//! let file = Path::new("../../examples/ta-200/records/m01.csv");
//! let mut table = TableReader::open(file, Extent::Whole, &fields, "a record")?;
//! while let Some(batch) = table.next_batch()? {
//!     for rows in batch {
//!         sum += rows[0].iter().sum::<f64>();
//!         count += rows[0].len();
//!     }
//! }
//! assert!(count > 1000 && (sum / count as f64).abs() < 2000.0);
//! # Ok::<(), centrical_table::Error>(())
//! ```

mod binary;
mod column;
mod error;
mod foreign;
mod reader;
#[cfg(feature = "xlsx")]
mod sheet;
mod source;
mod stamp;
mod text;
mod unpacking;
mod write;

pub use bytes::Bytes;

pub use binary::{Cell, Kind, TypedColumn, TypedReader};
pub use column::{ColumnName, Field, LARGEST_NUMBER, Rows, Rule, TableLines, UnitsFound, is_missing};
pub use error::{Error, Place, quoted, shown_path};
pub use foreign::{cut, escaped, harmless, harmless_line};
pub use reader::{Extent, TableReader, binary_columns, estimate_rows, text_form, to_scale};
pub use source::{Source, SourceReader};
pub use stamp::{StampKind, Stamps};
pub use text::{DecimalSign, Index, Reread, StampColumn, TextEncoding, TextForm, unit_beside_name, unit_of_word};
pub use write::{
    ClaimedFolder, Decimals, Outputs, TableFormat, TableWriter, TypedWriter, abandon_files, claim_folder,
    create_folder, csv_field, holder_of_lock, is_ending_of_table, parquet_bytes, refuse_inputs, write_stream,
    write_table, write_together, write_whole,
};
