//! Binary formats: columns of numbers, some rows of each at a time.

mod arrays;
mod arrow;
mod catch_panic;
mod cells;
mod checksums;
mod columnar;
mod dates;
#[cfg(feature = "hdf5")]
mod hdf5;
mod mat;
mod npy;
mod npy_literal;
mod parquet;
mod parquet_pages;
mod tdms;
mod typed;

#[cfg(feature = "xlsx")]
pub(crate) use self::catch_panic::catch_panic;
pub use self::cells::{Cell, Kind, TypedColumn};
pub use self::checksums::{CHECKSUMS, Checksums};
pub(crate) use self::columnar::ColumnReader;
pub use self::typed::TypedReader;
use crate::column::{ColumnName, Field};
use crate::error::{Error, Place};
use crate::source::Source;

/// The binary formats, recognised by their first bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum BinaryFormat {
    Parquet,
    /// Arrow IPC, as a file or a stream.
    Arrow,
    /// An array of NumPy.
    Npy,
    /// An archive of such arrays.
    Npz,
    /// MATLAB, version 5.
    Mat,
    Hdf5,
    /// MATLAB, version 7.3: HDF5 after a header of its own.
    MatHdf5,
    /// TDMS of National Instruments.
    Tdms,
    /// Its index file, which has no numbers.
    TdmsIndex,
}

impl BinaryFormat {
    /// The format of a file that starts like this, if it is one of them.
    pub fn of(magic: &[u8]) -> Option<Self> {
        const MAGIC: [(&[u8], BinaryFormat); 10] = [
            (b"PAR1", BinaryFormat::Parquet),
            (b"ARROW1", BinaryFormat::Arrow),
            (&arrow::CONTINUATION, BinaryFormat::Arrow),
            (b"\x93NUMPY", BinaryFormat::Npy),
            (b"PK\x03\x04", BinaryFormat::Npz),
            (b"MATLAB 5", BinaryFormat::Mat),
            (b"\x89HDF\r\n\x1a\n", BinaryFormat::Hdf5),
            (b"MATLAB 7", BinaryFormat::MatHdf5),
            (b"TDSm", BinaryFormat::Tdms),
            (tdms::INDEX_MAGIC, BinaryFormat::TdmsIndex),
        ];
        MAGIC.into_iter().find(|(start, _)| magic.starts_with(start)).map(|(_, format)| format)
    }

    /// The columns of a source of this format: by name, of a matrix by number.
    pub fn columns(self, source: &Source) -> Result<Vec<ColumnName>, Error> {
        let named = |names: Vec<String>| names.into_iter().map(ColumnName::Name).collect();
        Ok(match self {
            Self::Parquet => named(parquet::names(source)?),
            Self::Arrow => named(arrow::names(source)?),
            Self::Npy => npy::names(source)?,
            Self::Npz => npy::archive_names(source)?,
            Self::Mat => mat::names(source)?,
            Self::Tdms => named(tdms::names(source)?),
            #[cfg(feature = "hdf5")]
            Self::Hdf5 | Self::MatHdf5 => hdf5::names(source, self == Self::MatHdf5)?,
            #[cfg(not(feature = "hdf5"))]
            Self::Hdf5 | Self::MatHdf5 => return Err(without_hdf5(source)),
            Self::TdmsIndex => return Err(of_index(source)),
        })
    }

    /// Reads `fields` of a source of this format, which can hold `most` rows.
    pub fn open(self, source: &Source, fields: Vec<Field>, most: u64) -> Result<ColumnReader, Error> {
        let dated = fields.iter().find(|field| field.name.date_and_column().0.is_some());
        if let Some(field) = dated.filter(|_| !matches!(self, Self::Parquet | Self::Arrow)) {
            let place = Place::Column(field.name.to_string());
            let found = "a date and a time, which text, Parquet and Arrow alone have in two columns";
            return Err(Error::content(source.name(), place, found, "one column of timestamps, or of seconds"));
        }
        let columns = match self {
            Self::Parquet => {
                let parts = dates::joined(&fields, |fields| parquet::parts(source, fields))?;
                return Ok(ColumnReader::new(source.name(), fields, parts, most));
            }
            Self::Arrow => {
                let parts = dates::joined(&fields, |fields| arrow::parts(source, fields))?;
                return Ok(ColumnReader::new(source.name(), fields, parts, most));
            }
            Self::Npy => npy::columns(source, &fields)?,
            Self::Npz => npy::archive_columns(source, &fields)?,
            Self::Mat => mat::columns(source, &fields)?,
            Self::Tdms => tdms::columns(source, &fields)?,
            Self::TdmsIndex => return Err(of_index(source)),
            #[cfg(feature = "hdf5")]
            Self::Hdf5 | Self::MatHdf5 => hdf5::columns(source, self == Self::MatHdf5, &fields, most)?,
            #[cfg(not(feature = "hdf5"))]
            Self::Hdf5 | Self::MatHdf5 => return Err(without_hdf5(source)),
        };
        Ok(ColumnReader::whole(source.name(), fields, columns, most))
    }
}

fn of_index(source: &Source) -> Error {
    let expected = "the file of the same name that ends in .tdms";
    Error::content(source.name(), Place::Whole, "the index of a TDMS file, without its numbers", expected)
}

#[cfg(not(feature = "hdf5"))]
fn without_hdf5(source: &Source) -> Error {
    let expected = "another format (this program was built without the feature hdf5)";
    Error::content(source.name(), Place::Whole, "HDF5", expected)
}
