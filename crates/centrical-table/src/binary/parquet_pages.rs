//! Pages of a Parquet column, of sizes that their file can hold.
//!
//! Every size in a Parquet file is a claim. The library believes the size of an uncompressed page and the length
//! of a dictionary, and would set aside gigabytes for a damaged file of a few kilobytes: both are checked here.

use std::io::{self, BufRead, BufReader, Read};
use std::sync::Arc;

use bytes::Bytes;
use parquet::column::page::{Page, PageMetadata, PageReader};
use parquet::errors::{ParquetError, Result};
use parquet::file::metadata::RowGroupMetaData;
use parquet::file::reader::{ChunkReader, Length};
use parquet::file::serialized_reader::SerializedPageReader;

use crate::source::{Source, SourceReader};

/// Largest page that needs no packed bytes to back it [bytes]; writers make pages of 1 MiB.
const LARGEST_PAGE: i64 = 64 << 20;

/// Compression that a page may claim above that: noise of a sensor compresses by less than ten.
const LARGEST_RATIO: i64 = 256;

/// A file that is read page by page, every read starting at the header of a page.
pub(super) struct Pages(pub Source);

/// A file to be read on from a place, not beyond its end: what the library does not know it passes over as often as the file
/// claims, billions of times where nothing is left to be passed over.
pub(super) struct Strict(BufReader<SourceReader>);

impl Read for Strict {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        match self.0.read(bytes)? {
            0 if !bytes.is_empty() => Err(io::ErrorKind::UnexpectedEof.into()),
            read => Ok(read),
        }
    }
}

impl Length for Source {
    fn len(&self) -> u64 {
        self.length()
    }
}

impl ChunkReader for Source {
    type T = BufReader<SourceReader>;

    fn get_read(&self, start: u64) -> Result<Self::T> {
        Ok(BufReader::new(self.reader_at(start)))
    }

    fn get_bytes(&self, start: u64, length: usize) -> Result<Bytes> {
        let end = start.checked_add(length as u64).filter(|end| *end <= self.length());
        let end = end.ok_or_else(|| general(format!("{length} bytes from {start} of {}", self.length())))?;
        let mut bytes = Vec::with_capacity(length);
        self.reader_at(start).take(end - start).read_to_end(&mut bytes)?;
        if bytes.len() == length { Ok(bytes.into()) } else { Err(io::Error::from(io::ErrorKind::UnexpectedEof).into()) }
    }
}

impl Length for Pages {
    fn len(&self) -> u64 {
        self.0.length()
    }
}

impl ChunkReader for Pages {
    type T = Strict;

    fn get_read(&self, start: u64) -> Result<Self::T> {
        let mut read = self.0.get_read(start)?;
        match page_sizes(read.fill_buf()?) {
            Some((plain, packed)) if plain <= LARGEST_PAGE.saturating_add(LARGEST_RATIO * packed.max(0)) => {
                Ok(Strict(read))
            }
            Some((plain, packed)) => Err(general(format!("a page of {packed} bytes that claims to hold {plain}"))),
            None => Err(general("no header of a page where one should be".to_owned())),
        }
    }

    fn get_bytes(&self, start: u64, length: usize) -> Result<Bytes> {
        self.0.get_bytes(start, length)
    }
}

/// Uncompressed and compressed size, fields 2 and 3 of a page header: Thrift compact protocol, where each field
/// is the byte 0x15 (next field, 32-bit integer) and a zigzag number in groups of seven bits.
fn page_sizes(header: &[u8]) -> Option<(i64, i64)> {
    let mut bytes = header.iter().copied();
    let mut field = || {
        let mut zigzag = 0;
        (bytes.next()? == 0x15).then_some(())?;
        for shift in (0..35).step_by(7) {
            let byte = bytes.next()?;
            zigzag |= i64::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                return Some((zigzag >> 1) ^ -(zigzag & 1));
            }
        }
        None
    };
    let _type = field()?;
    Some((field()?, field()?))
}

/// Pages of one column of one row group.
pub(super) struct Checked(SerializedPageReader<Pages>);

impl Checked {
    /// The pages of `column` in `group`.
    pub fn new(pages: &Arc<Pages>, group: &RowGroupMetaData, column: usize) -> Result<Self> {
        let column = group.column(column);
        let start = column.dictionary_page_offset().unwrap_or_else(|| column.data_page_offset());
        let end = start.checked_add(column.compressed_size());
        let length = i64::try_from(pages.len()).unwrap_or(i64::MAX);
        if start < 0 || column.compressed_size() < 0 || end.is_none_or(|end| end > length) {
            return Err(general(format!("a column from byte {start} to {end:?} of {length}")));
        }
        let rows = usize::try_from(group.num_rows()).map_err(|_| general("a negative number of rows".to_owned()))?;
        Ok(Self(SerializedPageReader::new(Arc::clone(pages), column, rows, None)?))
    }
}

impl PageReader for Checked {
    fn get_next_page(&mut self) -> Result<Option<Page>> {
        let page = self.0.get_next_page()?;
        match &page {
            // Values of a dictionary take four bytes or more.
            Some(Page::DictionaryPage { buf, num_values, .. }) if *num_values as usize > buf.len() / 4 => {
                Err(general(format!("a dictionary of {} bytes that claims {num_values} values", buf.len())))
            }
            _ => Ok(page),
        }
    }

    fn peek_next_page(&mut self) -> Result<Option<PageMetadata>> {
        Err(general("pages are read in order".to_owned()))
    }

    /// Lists are read from our own tables alone, whose writer never splits a record; one that is split is a list too many.
    fn at_record_boundary(&mut self) -> Result<bool> {
        Ok(true)
    }

    fn skip_next_page(&mut self) -> Result<()> {
        Err(general("pages are read in order".to_owned()))
    }
}

impl Iterator for Checked {
    type Item = Result<Page>;

    fn next(&mut self) -> Option<Self::Item> {
        self.get_next_page().transpose()
    }
}

fn general(message: String) -> ParquetError {
    ParquetError::General(message)
}
