//! What all pages of a store have: names of files, frame, drawings.

use std::fmt::Write;

use centrical_session::sha256;

use crate::plot::{Escaped, Plot, STYLE as PLOT_STYLE};
use crate::render::frame::head;

const STYLE: &str = include_str!("../html/style.css");
const LIST_STYLE: &str = include_str!("../html/list.css");
const SCRIPT: &str = include_str!("../html/list.js");

/// What a page of a store is about, beside `index.html`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PageKind {
    /// A unit: model and serial number.
    Unit,
    /// A model of units.
    Model,
    /// A station.
    Station,
}

impl PageKind {
    /// The file of a page. It stays the same whatever comes into the store, so that a link to it stays good; names that no file can have
    /// do not make two pages one.
    pub fn file(self, names: &[&str]) -> String {
        let kind = match self {
            Self::Unit => "unit",
            Self::Model => "model",
            Self::Station => "station",
        };
        let last = names.last().copied().unwrap_or_default();
        let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '-' };
        let readable: String = last.chars().take(READABLE).map(plain).collect();
        let hash = sha256(names.join("\0").as_bytes());
        let parts = [kind, &readable, &hash[..12]];
        format!("{}.html", parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join("-"))
    }
}

/// Letters of a name that the name of its file repeats.
const READABLE: usize = 40;

/// The beginning of a page that is not the list.
pub(super) fn opening(kind: &str, title: &str) -> String {
    format!(
        "<header><p class=\"kind\">{kind}</p><h1>{}</h1><p><a href=\"index.html\">all calibrations</a></p></header>\n",
        Escaped(title)
    )
}

/// The serial number of a unit, with a link to its page where `has_page` says by its file that there is one.
pub(super) fn linked_serial(unit_model: &str, unit_serial: &str, has_page: impl Fn(&str) -> bool) -> String {
    let (file, serial) = (PageKind::Unit.file(&[unit_model, unit_serial]), Escaped(unit_serial));
    if has_page(&file) { format!("<a href=\"{file}\">{serial}</a>") } else { serial.to_string() }
}

/// A cell with a verdict.
pub(super) fn verdict(is_good: bool, good: &str, bad: &str) -> String {
    if is_good { format!("<td class=\"good\">{good}</td>") } else { format!("<td class=\"bad\">{bad}</td>") }
}

/// Drawings side by side.
pub(super) fn panels(body: &mut String, plots: impl IntoIterator<Item = Plot>) {
    body.push_str("<div class=\"panels\">\n");
    for plot in plots {
        let _ = writeln!(body, "<figure>{}</figure>", plot.to_svg_in_page());
    }
    body.push_str("</div>\n");
}

/// A whole page.
pub(super) fn page(title: &str, body: &str) -> String {
    let head = head("en", title, &format!("<style>{STYLE}{LIST_STYLE}{PLOT_STYLE}</style>"));
    format!("{head}<body><main class=\"wide\">\n{body}<script>{SCRIPT}</script></main></body></html>\n")
}
