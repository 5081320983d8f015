//! The fonts: glyphs and widths.

use centrical_session::harmless_line;
use ttf_parser::Face;

/// Weight of a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Weight {
    /// Text.
    Regular,
    /// Headings.
    Bold,
}

impl Weight {
    pub(super) const ALL: [Self; 2] = [Self::Regular, Self::Bold];

    /// Name in the resources of a page.
    pub(super) fn resource(self) -> &'static [u8] {
        match self {
            Self::Regular => b"F0",
            Self::Bold => b"F1",
        }
    }

    pub(super) fn post_script_name(self) -> &'static [u8] {
        match self {
            Self::Regular => b"NotoSans-Regular",
            Self::Bold => b"NotoSans-Bold",
        }
    }

    /// The font file.
    pub(super) fn data(self) -> &'static [u8] {
        match self {
            Self::Regular => include_bytes!("../../../fonts/NotoSans-Regular.ttf"),
            Self::Bold => include_bytes!("../../../fonts/NotoSans-Bold.ttf"),
        }
    }
}

/// A font that is ready to set text.
pub(super) struct Font {
    /// The parsed file; `None` only if the shipped file were damaged, and then text has no glyphs.
    pub face: Option<Face<'static>>,
}

impl Font {
    pub fn new(weight: Weight) -> Self {
        Self { face: Face::parse(weight.data(), 0).ok() }
    }

    /// Glyph of a character; that of a question mark if the font has none, since an archive takes no empty box (ISO 19005-2,
    /// 6.2.11.8).
    pub fn glyph(&self, c: char) -> u16 {
        let glyph = |c| self.face.as_ref().and_then(|face| face.glyph_index(c)).map(|glyph| glyph.0);
        glyph(c).or_else(|| glyph('?')).unwrap_or(0)
    }

    /// Letters of a text that the font lacks, each once.
    pub fn lacks(&self, text: &str) -> String {
        let Some(face) = &self.face else { return String::new() };
        let mut lacking = String::new();
        for c in harmless_line(text).chars() {
            if c != char::REPLACEMENT_CHARACTER && face.glyph_index(c).is_none() && !lacking.contains(c) {
                lacking.push(c);
            }
        }
        lacking
    }

    /// Width of a glyph in thousandths of the font's size.
    pub fn advance(&self, glyph: u16) -> f32 {
        let Some(face) = &self.face else { return 500.0 };
        let advance = face.glyph_hor_advance(ttf_parser::GlyphId(glyph)).unwrap_or(0);
        f32::from(advance) * 1000.0 / f32::from(face.units_per_em())
    }

    /// Width of a text at a size.
    pub fn width(&self, text: &str, size: f32) -> f32 {
        text.chars().map(|c| self.advance(self.glyph(c))).sum::<f32>() * size / 1000.0
    }
}

#[cfg(test)]
mod tests {
    use super::{Font, Weight};

    /// What numbers, units and the two languages need; a sign without a glyph would turn a minus into nothing.
    #[test]
    fn no_sign_is_missing() {
        let question = Font::new(Weight::Regular).glyph('?');
        let signs = "\u{2212}\u{202f}₀₁₂₃₄₅₆₇₈₉±·×°′²³⁴⁶⁰¹⁵⁷⁸⁹⁻µχνΩρσδα№–—…’“”«»%ёЁ";
        let letters = ('!'..='~').chain('А'..='я');
        for weight in Weight::ALL {
            let font = Font::new(weight);
            for c in signs.chars().chain(letters.clone()) {
                assert_ne!(font.glyph(c), 0, "{c} in {weight:?}");
                assert!(font.glyph(c) != question || c == '?', "{c} in {weight:?}");
                assert!(font.advance(font.glyph(c)) > 0.0, "{c}");
            }
        }
    }
}
