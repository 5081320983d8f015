//! How much a packed file may unpack to, and whether it is what was packed.

use std::io::{self, Read};

use crc32fast::Hasher;

/// Bytes that may be packed into nothing.
const ALLOWANCE: u64 = 64 << 20;

/// Compression above that: the noise of a sensor packs by less than ten.
const LARGEST_RATIO: u64 = 100;

/// What comes out of a packed file or a member of an archive, read to its end only if that is where it should be.
pub(crate) struct Unpacked<R> {
    input: R,
    /// Bytes that may still come, and how many it was at first.
    left: u64,
    most: u64,
    sum: Option<Sum>,
    /// Bytes that it is stated to be.
    stated: Option<u64>,
}

/// A CRC-32 on the way to the one that was written with the bytes.
struct Sum {
    hasher: Hasher,
    written: u32,
}

/// Bytes to which `packed` ones may unpack.
pub(crate) fn most_bytes(packed: u64) -> u64 {
    LARGEST_RATIO.saturating_mul(packed).saturating_add(ALLOWANCE)
}

impl<R: Read> Unpacked<R> {
    /// What `input` gives of `packed` bytes, with the CRC-32 that it should have, if one is written.
    pub fn new(input: R, packed: u64, crc_32: Option<u32>) -> Self {
        let most = most_bytes(packed);
        let sum = crc_32.map(|written| Sum { hasher: Hasher::new(), written });
        Self { input, left: most, most, sum, stated: None }
    }

    /// The same where the number of bytes is stated.
    pub fn holding(self, stated: Option<u64>) -> Self {
        Self { stated, ..self }
    }
}

impl<R: Read> Read for Unpacked<R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let read = self.input.read(bytes)?;
        self.left = self.left.checked_sub(read as u64).ok_or_else(|| {
            let most = self.most;
            io::Error::new(io::ErrorKind::InvalidData, format!("it unpacks to more than {most} bytes"))
        })?;
        let unpacked = self.most - self.left;
        if let Some(stated) =
            self.stated.filter(|stated| unpacked > *stated || read == 0 && !bytes.is_empty() && unpacked < *stated)
        {
            let found = format!("it unpacks to {unpacked} bytes where {stated} are stated");
            return Err(io::Error::new(io::ErrorKind::InvalidData, found));
        }
        if let Some(sum) = &mut self.sum {
            sum.hasher.update(&bytes[..read]);
            if read == 0 && !bytes.is_empty() && sum.hasher.clone().finalize() != sum.written {
                return Err(io::Error::new(
                    io::ErrorKind::InvalidData,
                    "its bytes do not give the CRC-32 written with them",
                ));
            }
        }
        Ok(read)
    }
}
