//! What pages have in common: their head, and tables that a script sorts.

use std::fmt::Write;

use crate::plot::Escaped;

/// A page up to its body; `style` is what its head has beside the title.
pub(super) fn head(code: &str, title: &str, style: &str) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"{code}\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\
         <meta name=\"color-scheme\" content=\"light dark\"><link rel=\"icon\" href=\"data:,\">\
         <title>{}</title>{style}</head>\n",
        Escaped(title)
    )
}

/// The title of a column, by what it holds.
#[derive(Debug, Clone, Copy)]
pub(super) enum Column<'t> {
    /// Words.
    Words(&'t str),
    /// Numbers, which stand right and are sorted as such.
    Number(&'t str),
}

impl Column<'_> {
    /// The class of its cells, as an attribute.
    pub fn class(self) -> &'static str {
        match self {
            Self::Words(_) => "",
            Self::Number(_) => " class=\"number\"",
        }
    }
}

/// A table that the script of the page sorts, and finds by its `id` if it has one; `rows` writes its rows.
pub(super) fn sortable(body: &mut String, id: &str, columns: &[Column], rows: impl FnOnce(&mut String)) {
    let id = if id.is_empty() { String::new() } else { format!(" id=\"{id}\"") };
    let _ = write!(body, "<div class=\"scroll\"><table{id} class=\"sortable\"><thead><tr>");
    for column in columns {
        // Writing to a String cannot fail.
        let (Column::Words(title) | Column::Number(title)) = column;
        let _ = write!(body, "<th scope=\"col\"{}>{}</th>", column.class(), Escaped(title));
    }
    body.push_str("</tr></thead><tbody>\n");
    rows(body);
    body.push_str("</tbody></table></div>\n");
}
