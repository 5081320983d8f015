//! Mutations of files: bits, bytes of meaning to some format, pieces cut out, doubled or taken from another file, and
//! the largest numbers that a field can hold.

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

/// A small generator of its own (splitmix64).
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform among 0, ..., `end - 1`; 0 of nothing.
    pub fn below(&mut self, end: usize) -> usize {
        usize::try_from(self.next() % end.max(1) as u64).unwrap()
    }

    /// A place, half the time near the start or the end, where formats keep their sizes.
    fn place(&mut self, length: usize) -> usize {
        let near = length.min(256);
        match self.below(4) {
            0 => self.below(near),
            1 => length.saturating_sub(1 + self.below(near)),
            _ => self.below(length),
        }
    }
}

/// A copy of `original` with one to eight mutations, some with pieces of `other`.
pub fn mutated(original: &[u8], other: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = original.to_vec();
    for _ in 0..1 << random.below(4) {
        let at = random.place(bytes.len());
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
                let from = random.place(other.len());
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
