//! Tables of numbers in any format, in and out.
//!
//! Columns are chosen by name or number and handed over in blocks of rows of bounded size, whatever the format and length of
//! the file. Files are of any make: nothing in one can make this crate panic, hang or fill the memory. What is wrong with a
//! file is an [`Error`] with the file, the place, what was found and what was expected.
//!
//! # Formats
//! | format | columns |
//! |---|---|
//! | text, also in gzip or Zstandard: any delimiter, decimal commas, comments | by name, or by number without a header |
//! | Parquet (uncompressed, snappy, gzip, lz4, zstd) | by name or number |
//! | Arrow IPC: files (Feather) and streams, plain, lz4 or zstd | by name or number |
//! | NumPy: `.npy` matrices and records, `.npz` | by name; of a matrix by number |
//! | MATLAB 5 (`save -v6`, `-v7`) | variables by name; of a matrix by number |
//! | HDF5 and MATLAB 7.3, with the feature `hdf5` | datasets by name; of a matrix by number |
//!
//! The format is told by the first bytes. Written are CSV and Parquet.

mod binary;
mod column;
mod error;
mod rows;
mod stamp;
mod table;
mod text;
mod write;

pub use column::{ColumnName, Field, Rule};
pub use error::{Error, Place, quoted};
pub use rows::{Block, Visitor};
pub use table::{Extent, read, read_batches, rows_at_a_glance};
pub use text::{Index, Reread};
pub use write::{
    Decimals, TableFormat, TableWriter, create_folder, parquet_bytes, write_stream, write_table, write_whole,
};
