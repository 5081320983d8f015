//! What a command shows, in HTML: sentences, and tables that the script of the page sorts.

use std::fmt::Write;

use super::frame::{Column, sortable};
use crate::plot::Escaped;
use crate::terminal::{Align, Emphasis, Part, Screen, Table};

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
    let titles: Vec<Column> = columns.iter().map(|(_, title)| *title).collect();
    sortable(body, "", &titles, |body| {
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
