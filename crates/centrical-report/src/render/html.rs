//! One HTML file: no network, no scripts, legible on a telephone, on paper and in the dark.

use std::fmt::Write;

use super::frame::head;
use crate::document::{Align, Block, Column, Document, Layer, Opening, Row, Section, Table, TableKind, Tone};
use crate::figure::Figure;
use crate::plot::Escaped;

const STYLE: &str = include_str!("html/style.css");

/// The page of a document. The same document gives the same bytes.
pub fn html(document: &Document) -> String {
    let mut html = head(document.language.code(), &document.title, &format!("<style>{STYLE}</style>"));
    html.push_str("<body><main>\n");
    opening(&mut html, &document.opening);
    let (first, further): (Vec<_>, Vec<_>) = document.sections.iter().partition(|part| part.layer == Layer::First);
    let (verdicts, text): (Vec<&Section>, Vec<_>) = first.into_iter().partition(|part| part.tone != Tone::Plain);
    if !verdicts.is_empty() {
        html.push_str("<div class=\"verdicts\">\n");
        for part in verdicts {
            section(&mut html, part);
        }
        html.push_str("</div>\n");
    }
    for part in text {
        section(&mut html, part);
    }
    if !further.is_empty() {
        contents(&mut html, &document.contents, &further);
        for (n, part) in further.into_iter().enumerate() {
            folded(&mut html, n, part);
        }
    }
    let _ = write!(html, "<footer>{}</footer>\n</main></body></html>\n", Escaped(&document.margins.foot));
    html
}

fn opening(html: &mut String, opening: &Opening) {
    let (kind, title) = (Escaped(&opening.kind), Escaped(&opening.title));
    let _ = write!(html, "<header><p class=\"kind\">{kind}</p><h1>{title}</h1>");
    for (n, line) in (1..).zip(&opening.lines) {
        let _ = write!(html, "<p>{}", Escaped(line));
        if n == opening.lines.len() && !opening.date.is_empty() {
            let _ = write!(html, ", <time>{}</time>", Escaped(&opening.date));
        }
        html.push_str("</p>");
    }
    html.push_str("</header>\n");
}

/// What a reader may open.
fn contents(html: &mut String, title: &str, sections: &[&Section]) {
    let entry =
        |(n, section): (usize, &&Section)| format!("<li><a href=\"#part-{n}\">{}</a></li>", Escaped(heading(section)));
    let entries: String = sections.iter().enumerate().map(entry).collect();
    let _ = writeln!(html, "<nav><h2>{}</h2><ul>{entries}</ul></nav>", Escaped(title));
}

/// A section that is opened by its heading, or by a way to what is inside.
fn folded(html: &mut String, n: usize, section: &Section) {
    let _ = writeln!(html, "<details><summary><h2>{}</h2></summary><div id=\"part-{n}\">", Escaped(heading(section)));
    let is_heading = |part: &Block| matches!(part, Block::Heading(..));
    section.blocks.iter().filter(|part| !is_heading(part)).for_each(|part| block(html, part));
    html.push_str("</div></details>\n");
}

/// The heading that a section begins with.
fn heading(section: &Section) -> &str {
    section
        .blocks
        .iter()
        .find_map(|part| if let Block::Heading(text, _) = part { Some(text.as_str()) } else { None })
        .unwrap_or_default()
}

fn section(html: &mut String, section: &Section) {
    html.push_str(match section.tone {
        Tone::Plain => "<section>",
        Tone::Neutral => "<section class=\"verdict\">",
        Tone::Good => "<section class=\"verdict good\">",
        Tone::Bad => "<section class=\"verdict bad\">",
    });
    for part in &section.blocks {
        block(html, part);
        if section.tone == Tone::Plain && matches!(part, Block::Heading(..)) {
            html.push('\n');
        }
    }
    html.push_str("</section>\n");
}

fn block(html: &mut String, block: &Block) {
    let _ = match block {
        Block::Heading(text, _) => write!(html, "<h2>{}</h2>", Escaped(text)),
        Block::Subheading(text) => writeln!(html, "<h3>{}</h3>", Escaped(text)),
        Block::Paragraph(text) => writeln!(html, "<p>{}</p>", Escaped(text)),
        Block::Note(text) => writeln!(html, "<p class=\"note\">{}</p>", Escaped(text)),
        Block::List(items) => list(html, items, ["<li>", "</li>"]),
        Block::Formulas(items) => list(html, items, ["<li><code>", "</code></li>"]),
        Block::Facts(facts) => {
            let rows = facts.iter().map(|(name, value)| row(name, std::slice::from_ref(value), &|_| ""));
            scrolling(html, "facts", &rows.collect::<String>())
        }
        Block::Table(table) => whole_table(html, table),
        Block::Figure(figure) => draw(html, figure),
        Block::Signature { name, role, word, .. } => {
            writeln!(html, "<p>{}: ____ {}, {}</p>", Escaped(word), Escaped(name), Escaped(role))
        }
    };
}

fn list(html: &mut String, items: &[String], [open, close]: [&str; 2]) -> std::fmt::Result {
    let items = items.iter().map(|item| format!("{open}{}{close}", Escaped(item)));
    writeln!(html, "<ul>{}</ul>", items.collect::<String>())
}

fn whole_table(html: &mut String, table: &Table) -> std::fmt::Result {
    let class = match table.kind {
        TableKind::Numbers => "numbers",
        TableKind::Parameters => "parameters",
        TableKind::Files => "hashes",
    };
    // Numbers stand on the right, what stands on the left beside them is marked.
    let side = |k: usize| {
        let is_marked = table.kind == TableKind::Numbers && k > 0;
        let align = table.columns.get(k).map_or(Align::Right, |column| column.align);
        if is_marked && align == Align::Left { " class=\"left\"" } else { "" }
    };
    let title = |(k, column): (usize, &Column)| format!("<th scope=\"col\"{}>{}</th>", side(k), Escaped(&column.title));
    let cells = table.columns.iter().enumerate().map(title);
    let head = format!("<thead><tr>{}</tr></thead>", cells.collect::<String>());
    let rows = table.rows.iter().map(|shown| match shown {
        Row::Group(name) => {
            let (span, name) = (table.columns.len(), Escaped(name));
            format!("<tr class=\"group\"><th colspan=\"{span}\" scope=\"rowgroup\">{name}</th></tr>")
        }
        Row::Cells(cells) => cells.split_first().map_or(String::new(), |(name, cells)| row(name, cells, &side)),
    });
    scrolling(html, class, &(head + &rows.collect::<String>()))
}

fn scrolling(html: &mut String, class: &str, rows: &str) -> std::fmt::Result {
    writeln!(html, "<div class=\"scroll\"><table class=\"{class}\">{rows}</table></div>")
}

fn row(name: &str, cells: &[String], side: &dyn Fn(usize) -> &'static str) -> String {
    let cells = (1..).zip(cells).map(|(k, cell)| format!("<td{}>{}</td>", side(k), Escaped(cell)));
    format!("<tr><th scope=\"row\">{}</th>{}</tr>", Escaped(name), cells.collect::<String>())
}

fn draw(html: &mut String, figure: &Figure) -> std::fmt::Result {
    write!(html, "<figure id=\"{}\">", figure.name)?;
    let is_one = figure.drawings.len() == 1;
    if !is_one && !figure.title.is_empty() {
        write!(html, "<h3>{}</h3>", Escaped(&figure.title))?;
    }
    let class = if is_one { "one" } else { "strips" };
    writeln!(html, "<div class=\"{class}\">{}</div>", figure.drawings.concat())?;
    writeln!(html, "<figcaption>{}</figcaption></figure>", Escaped(&figure.caption))
}
