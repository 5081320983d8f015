//! What pages have in common: their head, tables that a script sorts, and what a command shows.

use std::fmt::Write;

use crate::plot::Escaped;
use crate::terminal::{Align, Emphasis, Part, Screen, Table};

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

/// The titles of columns as cells of a row.
pub(super) fn titles(columns: &[Column]) -> String {
    let title = |column: &Column| {
        let (Column::Words(title) | Column::Number(title)) = column;
        format!("<th scope=\"col\"{}>{}</th>", column.class(), Escaped(title))
    };
    columns.iter().map(title).collect()
}

/// A table that the script of the page sorts, and finds by its `id` if it has one; `rows` writes its rows.
pub(super) fn sortable(body: &mut String, id: &str, columns: &[Column], rows: impl FnOnce(&mut String)) {
    let id = if id.is_empty() { String::new() } else { format!(" id=\"{id}\"") };
    // Writing to a String cannot fail.
    let _ = writeln!(
        body,
        "<div class=\"scroll\"><table{id} class=\"sortable\"><thead><tr>{}</tr></thead><tbody>",
        titles(columns)
    );
    rows(body);
    body.push_str("</tbody></table></div>\n");
}

/// Writes the parts of `screen`.
pub(super) fn shown(body: &mut String, screen: &Screen) {
    for part in screen.parts() {
        match part {
            Part::Gap => {}
            Part::Table(table) => whole_table(body, table),
            // Writing to a String cannot fail.
            Part::Words { mark: None, words, .. } => _ = writeln!(body, "<p>{}</p>", Escaped(words)),
            Part::Words { mark: Some((emphasis, mark)), words, .. } => {
                _ = marked(body, *emphasis, mark, words.trim_start());
            }
        }
    }
}

fn marked(body: &mut String, emphasis: Emphasis, mark: &str, words: &str) -> std::fmt::Result {
    let class = match emphasis {
        Emphasis::Heading => {
            let heading = sentence_case(mark);
            return writeln!(body, "<h2>{}</h2>\n<p class=\"note\">{}</p>", Escaped(&heading), Escaped(words));
        }
        Emphasis::Acceptable => " class=\"good\"",
        Emphasis::NotAcceptable => " class=\"bad\"",
        Emphasis::Warning => "",
    };
    writeln!(body, "<p><strong{class}>{}</strong> {}</p>", Escaped(mark), Escaped(words))
}

/// A heading in capitals as a sentence begins.
fn sentence_case(heading: &str) -> String {
    let first = heading.chars().take(1);
    first.chain(heading.chars().skip(1).flat_map(char::to_lowercase)).collect()
}

fn whole_table(body: &mut String, table: &Table) {
    let columns: Vec<(usize, Column)> = table
        .columns()
        .map(|(place, title, align)| {
            (place, if align == Align::Right { Column::Number(title) } else { Column::Words(title) })
        })
        .collect();
    let shown: Vec<Column> = columns.iter().map(|(_, title)| *title).collect();
    sortable(body, "", &shown, |body| {
        for row in table.rows() {
            body.push_str("<tr>");
            for (n, (place, title)) in columns.iter().enumerate() {
                let (cell, class) = (row[*place].to_string(), title.class());
                let _ = match n {
                    0 => write!(body, "<th scope=\"row\"{class}>{}</th>", Escaped(&cell)),
                    _ => write!(body, "<td{class}>{}</td>", Escaped(&cell)),
                };
            }
            body.push_str("</tr>\n");
        }
    });
}
