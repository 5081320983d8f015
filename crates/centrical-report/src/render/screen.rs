//! What a command shows, in HTML: sentences, and tables that the script of the page sorts.

use std::fmt::Write;

use crate::plot::Escaped;
use crate::terminal::{Align, Emphasis, Part, Screen, Table};

/// Writes the parts of `screen`.
pub(super) fn shown(body: &mut String, screen: &Screen) {
    for part in screen.parts() {
        let _ = match part {
            Part::Gap => Ok(()),
            Part::Table(table) => whole_table(body, table),
            Part::Words { mark: None, words, .. } => writeln!(body, "<p>{}</p>", Escaped(words)),
            Part::Words { mark: Some((emphasis, mark)), words, .. } => {
                marked(body, *emphasis, mark, words.trim_start())
            }
        };
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

fn whole_table(body: &mut String, table: &Table) -> std::fmt::Result {
    let class = |align| if align == Align::Right { " class=\"number\"" } else { "" };
    body.push_str("<div class=\"scroll\"><table class=\"sortable\"><thead><tr>");
    let columns: Vec<_> = table.columns().collect();
    for &(_, title, align) in &columns {
        write!(body, "<th scope=\"col\"{}>{}</th>", class(align), Escaped(title))?;
    }
    body.push_str("</tr></thead><tbody>\n");
    for row in table.rows() {
        body.push_str("<tr>");
        for (n, &(j, _, align)) in columns.iter().enumerate() {
            let cell = row[j].to_string();
            match n {
                0 => write!(body, "<th scope=\"row\"{}>{}</th>", class(align), Escaped(&cell))?,
                _ => write!(body, "<td{}>{}</td>", class(align), Escaped(&cell))?,
            }
        }
        body.push_str("</tr>\n");
    }
    writeln!(body, "</tbody></table></div>")
}
