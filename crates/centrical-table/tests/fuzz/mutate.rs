//! Mutations of files: bits, bytes of meaning to some format, pieces cut out, doubled or taken from another file, and
//! the largest numbers that a field can hold.

use crate::random::Random;

/// Bytes at either end that are damaged more often.
const NEAR: usize = 256;

/// Words of the formats: of texts, of Thrift and flat buffers, of headers.
const WORDS: [&[u8]; 24] = [
    b",",
    b";",
    b"\t",
    b"\n",
    b"\r\n",
    b"\"",
    b"'",
    b"#",
    b"nan",
    b"1e999",
    b"-0",
    b"[",
    b"]",
    b"{",
    b"}",
    b"=",
    b"\0",
    b"\xff",
    b"\xef\xbb\xbf",
    b"PAR1",
    b"\x93NUMPY",
    b"null",
    b"mounting",
    b"t,f1,f2,f3\n",
];

/// Numbers at the ends of their ranges, as fields of 1 to 8 bytes or of variable length.
const ENDS: [&[u8]; 10] = [
    b"\x7f",
    b"\x80",
    b"\xff\x7f",
    b"\xff\xff\xff\x7f",
    b"\x00\x00\x00\x80",
    b"\xff\xff\xff\xff",
    b"\xfe\xff\xff\xff\x0f",
    b"\xff\xff\xff\xff\xff\xff\xff\x7f",
    b"\xff\xff\xff\xff\xff\xff\xff\xff",
    b"\x00\x00\x00\x00\x00\x00\x00\x00",
];

/// A copy of `original` with one to eight mutations, some with pieces of `other`.
pub fn mutated(original: &[u8], other: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = original.to_vec();
    for _ in 0..1 << random.below(4) {
        let at = random.place(bytes.len(), NEAR);
        let end = |random: &mut Random, length: usize| (at + 1 + random.below(64)).min(length);
        match random.below(9) {
            _ if bytes.is_empty() => bytes.extend_from_slice(other),
            0 => bytes[at] ^= 1 << random.below(8),
            1 => bytes[at] = u8::try_from(random.below(256)).unwrap(),
            2 => bytes.truncate(at),
            3 => drop(bytes.drain(at..end(random, bytes.len()))),
            4 => {
                let piece = bytes[at..end(random, bytes.len())].to_vec();
                bytes.splice(at..at, piece);
            }
            5 => overwrite(&mut bytes, at, ENDS[random.below(ENDS.len())]),
            6 => {
                let word = WORDS[random.below(WORDS.len())];
                bytes.splice(at..at, word.iter().copied());
            }
            7 => overwrite(&mut bytes, at, WORDS[random.below(WORDS.len())]),
            _ => {
                let from = random.place(other.len(), NEAR);
                let piece = &other[from.min(other.len())..(from + random.below(256)).min(other.len())];
                overwrite(&mut bytes, at, piece);
            }
        }
    }
    bytes
}

fn overwrite(bytes: &mut Vec<u8>, at: usize, piece: &[u8]) {
    let end = (at + piece.len()).min(bytes.len());
    bytes.splice(at..end, piece.iter().copied());
}
