//! A PDF file of running text and tables on A4, with embedded fonts for Latin, Greek and Cyrillic.

mod archive;
mod colour;
mod font;
mod layout;
mod write;

use self::font::{Font, Weight};
use self::layout::Layout;
use crate::document::{Block, Document};

/// Letters of a text that a PDF file cannot show, each once.
pub fn letters_without_glyph(text: &str) -> String {
    Font::new(Weight::Bold).lacks(text)
}

/// The file of a document. The same document gives the same bytes.
///
/// # Errors
/// Letters of its text that the font lacks.
pub fn pdf(document: &Document) -> Result<Vec<u8>, String> {
    let mut layout = Layout::new();
    let room = document.opening.picture.as_ref().map(|picture| layout.picture(picture.width, picture.height));
    layout.title(&document.opening.title, room.unwrap_or(0.0));
    for line in &document.opening.lines {
        layout.paragraph(line);
    }
    for part in document.sections.iter().flat_map(|section| &section.blocks) {
        block(&mut layout, part);
    }
    let lacking = layout.lacking.clone();
    if lacking.is_empty() { Ok(write::write(layout, document)) } else { Err(lacking) }
}

fn block(layout: &mut Layout, block: &Block) {
    match block {
        Block::Heading(text, lines) => layout.heading(text, *lines),
        Block::Subheading(text) => layout.heading(text, 4),
        Block::Paragraph(text) | Block::Note(text) => layout.paragraph(text),
        Block::List(items) | Block::Formulas(items) => {
            for item in items {
                layout.paragraph(&format!("– {item}"));
            }
        }
        Block::Facts(facts) => layout.facts(facts),
        Block::Table(table) => layout.table(table),
        // Drawings are SVG, which a PDF does not take as it is.
        Block::Figure(figure) => layout.paragraph(&figure.caption),
        Block::Signature { name, role, word, date, mark } => layout.signature([name, role, word, date, mark]),
    }
}
