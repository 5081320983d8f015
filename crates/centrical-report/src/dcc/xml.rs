//! A writer of XML that cannot leave an element open or a character unescaped.

use std::fmt::Write;

use crate::language::Language;
use crate::plot::Escaped;

/// A document that grows.
pub(super) struct Xml {
    text: String,
    depth: usize,
}

impl Xml {
    pub fn new() -> Self {
        Self { text: "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n".to_owned(), depth: 0 }
    }

    /// An element with children.
    pub fn element(&mut self, name: &str, children: impl FnOnce(&mut Self)) {
        self.element_with(name, &[], children);
    }

    /// An element with attributes and children.
    pub fn element_with(&mut self, name: &str, attributes: &[(&str, &str)], children: impl FnOnce(&mut Self)) {
        self.indent();
        let _ = write!(self.text, "<{name}");
        for (key, value) in attributes {
            let _ = write!(self.text, " {key}=\"{}\"", Escaped(value));
        }
        self.text.push_str(">\n");
        self.depth += 1;
        children(self);
        self.depth -= 1;
        self.indent();
        let _ = writeln!(self.text, "</{name}>");
    }

    /// An element of a kind, as its `refType` says, with children.
    pub fn kind(&mut self, name: &str, kind: &str, children: impl FnOnce(&mut Self)) {
        self.element_with(name, &[("refType", kind)], children);
    }

    /// An element that holds text alone.
    pub fn leaf(&mut self, name: &str, text: &str) {
        self.indent();
        let _ = writeln!(self.text, "<{name}>{}</{name}>", Escaped(text));
    }

    /// An element that holds text alone, if there is any.
    pub fn optional(&mut self, name: &str, text: Option<&str>) {
        if let Some(text) = text.filter(|text| !text.trim().is_empty()) {
            self.leaf(name, text);
        }
    }

    /// An element of `dcc:content`, the text being in one language.
    pub fn content(&mut self, name: &str, text: &str, language: Language) {
        self.element(name, |xml| {
            xml.indent();
            let _ = writeln!(xml.text, "<dcc:content lang=\"{}\">{}</dcc:content>", language.code(), Escaped(text));
        });
    }

    /// The finished document.
    pub fn into_text(self) -> String {
        self.text
    }

    fn indent(&mut self) {
        self.text.extend(std::iter::repeat_n("  ", self.depth));
    }
}
