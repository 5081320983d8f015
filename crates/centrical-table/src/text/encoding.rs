//! The encodings of text: which one a text has, and what its bytes mean.
//!
//! Digits, delimiters and ends of lines are the same bytes in UTF-8 and in every encoding of one byte a character. Rows are
//! read as they are; only names and units are decoded. UTF-16 is turned into UTF-8 on its way.

use std::borrow::Cow;
use std::fmt;
use std::io::{self, Read};

use encoding_rs::{CoderResult, Decoder, UTF_16BE, UTF_16LE, WINDOWS_1251, WINDOWS_1252};

/// Bytes at the start of a text that show whether it is UTF-16.
pub(crate) const SIGHT: usize = 1024;

/// The encoding of a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TextEncoding {
    /// UTF-8, or nothing but ASCII.
    Utf8,
    /// UTF-16, the low byte first.
    Utf16Le,
    /// UTF-16, the high byte first.
    Utf16Be,
    /// Windows-1251: Cyrillic.
    Windows1251,
    /// Windows-1252: Western European, Latin-1 included.
    Windows1252,
}

impl TextEncoding {
    /// Those of one byte a character.
    pub const OF_BYTES: [Self; 2] = [Self::Windows1251, Self::Windows1252];

    /// UTF-16, if a text that begins so has it: by its mark, or as every digit and delimiter has a zero byte on the same side.
    pub fn utf_16(start: &[u8]) -> Option<Self> {
        match start {
            [0xff, 0xfe, ..] => return Some(Self::Utf16Le),
            [0xfe, 0xff, ..] => return Some(Self::Utf16Be),
            _ => {}
        }
        let pairs = start.as_chunks::<2>().0;
        let zeros = |side: usize| pairs.iter().filter(|pair| pair[side] == 0).count();
        // Some characters, none of them of a table, have a zero byte on the other side.
        let (is_most, is_rare) = (|zeros: usize| 3 * zeros > pairs.len(), |zeros: usize| 50 * zeros <= pairs.len());
        match [zeros(0), zeros(1)] {
            [high, low] if is_most(low) && is_rare(high) => Some(Self::Utf16Le),
            [high, low] if is_most(high) && is_rare(low) => Some(Self::Utf16Be),
            _ => None,
        }
    }

    /// The encoding of a text that is not UTF-16: one of one byte a character if it is not UTF-8. Cyrillic words are runs of letters
    /// beyond ASCII; in Western ones such letters and signs stand alone.
    pub fn of_bytes(text: &[u8]) -> Self {
        let Err(error) = std::str::from_utf8(text) else { return Self::Utf8 };
        if error.error_len().is_none() {
            // Cut within a character.
            return Self::Utf8;
        }
        let is_letter = |byte: &u8| *byte >= 0xc0;
        let letters = text.iter().filter(|byte| is_letter(byte)).count();
        let runs = text.windows(2).filter(|pair| pair.iter().all(is_letter)).count();
        if 2 * runs > letters { Self::Windows1251 } else { Self::Windows1252 }
    }

    /// The text of some bytes.
    pub fn decode(self, bytes: &[u8]) -> Cow<'_, str> {
        match self {
            Self::Windows1251 => WINDOWS_1251.decode_without_bom_handling(bytes).0,
            Self::Windows1252 => WINDOWS_1252.decode_without_bom_handling(bytes).0,
            // What was UTF-16 is UTF-8 already.
            Self::Utf8 | Self::Utf16Le | Self::Utf16Be => String::from_utf8_lossy(bytes),
        }
    }
}

impl fmt::Display for TextEncoding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Utf8 => "UTF-8",
            Self::Utf16Le | Self::Utf16Be => "UTF-16",
            Self::Windows1251 => "Windows-1251",
            Self::Windows1252 => "Windows-1252 or Latin-1",
        })
    }
}

/// A text in UTF-8, made from UTF-16 where its beginning shows it; and that encoding.
pub(crate) fn in_utf_8(mut input: Box<dyn Read + Send>) -> io::Result<(Box<dyn Read + Send>, Option<TextEncoding>)> {
    let mut start = Vec::new();
    (&mut input).take(SIGHT as u64).read_to_end(&mut start)?;
    let encoding = TextEncoding::utf_16(&start);
    let whole = io::Cursor::new(start).chain(input);
    Ok(match encoding {
        Some(encoding) => (Box::new(FromUtf16::new(whole, encoding)), Some(encoding)),
        None => (Box::new(whole), None),
    })
}

/// UTF-16 as UTF-8. Invalid characters are replaced, and are then not numbers.
struct FromUtf16<R> {
    input: R,
    decoder: Decoder,
    raw: Vec<u8>,
    /// Bytes of `raw` that are not decoded yet.
    from: usize,
    at_end: bool,
    is_finished: bool,
    /// UTF-8 that did not fit.
    rest: Vec<u8>,
}

impl<R: Read> FromUtf16<R> {
    /// The text that `input` gives, in this kind of UTF-16.
    pub fn new(input: R, encoding: TextEncoding) -> Self {
        let of = if encoding == TextEncoding::Utf16Be { UTF_16BE } else { UTF_16LE };
        let (raw, rest) = (Vec::new(), Vec::new());
        let decoder = of.new_decoder_with_bom_removal();
        Self { input, decoder, raw, from: 0, at_end: false, is_finished: false, rest }
    }

    /// Reads more, if all is decoded.
    fn fill(&mut self) -> io::Result<()> {
        const AT_A_TIME: u64 = 1 << 16;
        if self.from == self.raw.len() && !self.at_end {
            self.from = 0;
            self.raw.clear();
            self.at_end = (&mut self.input).take(AT_A_TIME).read_to_end(&mut self.raw)? == 0;
        }
        Ok(())
    }
}

impl<R: Read> Read for FromUtf16<R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        /// Room for any character.
        const LONGEST: usize = 16;
        loop {
            if !self.rest.is_empty() || bytes.is_empty() {
                let count = self.rest.len().min(bytes.len());
                bytes[..count].copy_from_slice(&self.rest[..count]);
                self.rest.drain(..count);
                return Ok(count);
            }
            if self.is_finished {
                return Ok(0);
            }
            self.fill()?;
            let was_at_end = self.at_end;
            let mut few = [0; LONGEST];
            let into = if bytes.len() < LONGEST { &mut few[..] } else { &mut *bytes };
            let (result, read, written, _) = self.decoder.decode_to_utf8(&self.raw[self.from..], into, was_at_end);
            self.from += read;
            // A decoder is not asked again after its end.
            self.is_finished = was_at_end && result == CoderResult::InputEmpty;
            if bytes.len() < LONGEST {
                self.rest.extend_from_slice(&few[..written]);
            } else if written > 0 {
                return Ok(written);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn utf_16(text: &str, encoding: TextEncoding) -> Vec<u8> {
        let bytes = |unit: u16| if encoding == TextEncoding::Utf16Be { unit.to_be_bytes() } else { unit.to_le_bytes() };
        text.encode_utf16().flat_map(bytes).collect()
    }

    #[test]
    fn utf_16_is_known_and_decoded() {
        let text = "\u{feff}Время, с;µ;😀\r\n0,5;1;2\r\n".to_owned() + &"1,25;-3;4\r\n".repeat(20_000);
        for encoding in [TextEncoding::Utf16Le, TextEncoding::Utf16Be] {
            for text in [text.as_str(), &text[3..]] {
                let bytes = utf_16(text, encoding);
                let start = &bytes[..SIGHT];
                assert_eq!(TextEncoding::utf_16(start), Some(encoding));
                let mut again = String::new();
                FromUtf16::new(bytes.as_slice(), encoding).read_to_string(&mut again).unwrap();
                assert_eq!(again, text.trim_start_matches('\u{feff}'));
                let mut slowly = Vec::new();
                let mut reader = FromUtf16::new(&bytes[..200], encoding);
                let mut three = [0; 3];
                while let Ok(read @ 1..) = reader.read(&mut three) {
                    slowly.extend_from_slice(&three[..read]);
                }
                assert!(again.as_bytes().starts_with(&slowly) && slowly.len() >= 100);
            }
        }
        for other in [&b"t;f1\n0;1\n"[..], b"", b"\0\0\0\0", b"a\0\0b", "Время".as_bytes()] {
            assert_eq!(TextEncoding::utf_16(other), None);
        }
    }

    #[test]
    fn encodings_of_bytes_are_told_apart() {
        let cyrillic = WINDOWS_1251.encode("Время, с;Ускорение, м/с^2").0;
        let western = WINDOWS_1252.encode("Zeit;Beschleunigung für Gerät [µg];°C").0;
        assert_eq!(TextEncoding::of_bytes(&cyrillic), TextEncoding::Windows1251);
        assert_eq!(TextEncoding::of_bytes(&western), TextEncoding::Windows1252);
        assert_eq!(TextEncoding::of_bytes("Время".as_bytes()), TextEncoding::Utf8);
        assert_eq!(TextEncoding::Windows1251.decode(&cyrillic), "Время, с;Ускорение, м/с^2");
    }
}
