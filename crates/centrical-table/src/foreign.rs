//! Text of others, made harmless: names, titles and values from files, on their way to a terminal, a comment, a page.

use std::borrow::Cow;

/// Replaces a character that is not shown. Decoders put it in place of bytes that are not text.
const REPLACEMENT: char = '\u{fffd}';

/// Replaces by U+FFFD control characters (except newline and tab), bidirectional marks, zero-width characters and code points that
/// are not characters. Terminals, compilers, browsers and readers of XML act on these instead of showing them. Most texts stay as
/// they are.
pub fn harmless(text: &str) -> Cow<'_, str> {
    without(text, |c| !matches!(c, '\n' | '\t') && is_harmful(c))
}

/// The same on one line: ends of lines and tabulators are blanks.
pub fn harmless_line(text: &str) -> Cow<'_, str> {
    let text = without(text, |c| !matches!(c, '\n' | '\r' | '\t') && is_harmful(c));
    if text.contains(['\n', '\r', '\t']) { Cow::Owned(text.replace(['\n', '\r', '\t'], " ")) } else { text }
}

/// A JSON document with the same characters escaped, so that it is the same to whoever reads it.
pub fn escaped(json: String) -> String {
    let is_left = |c| matches!(c, '\n' | '\t') || !is_harmful(c);
    if json.chars().all(is_left) {
        return json;
    }
    let mut text = String::with_capacity(json.len());
    for c in json.chars() {
        if is_left(c) {
            text.push(c);
        } else {
            text.extend(c.encode_utf16(&mut [0; 2]).iter().map(|unit| format!("\\u{unit:04x}")));
        }
    }
    text
}

/// A text cut to `most` characters, three dots in place of the rest.
pub fn cut(text: &str, most: usize) -> Cow<'_, str> {
    match text.char_indices().nth(most) {
        Some((end, _)) => Cow::Owned(format!("{}...", &text[..end])),
        None => Cow::Borrowed(text),
    }
}

fn without(text: &str, is_left_out: impl Fn(char) -> bool) -> Cow<'_, str> {
    if text.chars().any(&is_left_out) {
        Cow::Owned(text.chars().map(|c| if is_left_out(c) { REPLACEMENT } else { c }).collect())
    } else {
        Cow::Borrowed(text)
    }
}

fn is_harmful(c: char) -> bool {
    let is_invisible = matches!(
        c,
        // Soft hyphen; marks and overrides of direction; no width; line and paragraph separators; invisible operators.
        '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}'
            // Byte order mark, annotations, tags.
            | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e007f}'
    );
    let is_no_character = (c as u32) & 0xfffe == 0xfffe || ('\u{fdd0}'..='\u{fdef}').contains(&c);
    c.is_control() || is_invisible || is_no_character
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_shown_is_replaced() {
        for c in ['\0', '\u{1b}', '\u{7f}', '\u{9b}', '\u{202e}', '\u{2066}', '\u{200b}', '\u{fffe}', '\u{1ffff}', '\r']
        {
            assert_eq!(harmless(&format!("a{c}b")), "a\u{fffd}b", "{c:?}");
        }
        for text in ["Центрифуга", "µg/√Hz", "a\tb\n", "日本", "a\u{301}", "😀"] {
            assert_eq!(harmless(text), text);
        }
        assert_eq!(harmless_line("a\r\nb\u{1b}"), "a  b\u{fffd}");
    }

    #[test]
    fn what_is_not_shown_is_escaped_in_json() {
        assert_eq!(
            escaped("{\n\"\u{9b}\u{202e}\u{e0041}\": \"µ\"}".to_owned()),
            r#"{
"\u009b\u202e\udb40\udc41": "µ"}"#
        );
    }

    #[test]
    fn a_long_text_is_cut_between_characters() {
        assert_eq!(cut("жжж", 3), "жжж");
        assert_eq!(cut("жжжж", 3), "жжж...");
    }
}
