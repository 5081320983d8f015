//! Running text and tables, broken into lines and pages.

use centrical_session::harmless_line;
use pdf_writer::{Content, Name, Str};

use super::font::{Font, Weight};
use crate::document::{Align, Column, Fact, Row, Table};

/// A4 and its margins, points.
pub(super) const PAGE: (f32, f32) = (595.28, 841.89);
pub(super) const LEFT: f32 = 56.0;
pub(super) const TOP: f32 = 74.0;
pub(super) const BOTTOM: f32 = 66.0;
/// Width of the text.
pub(super) const WIDTH: f32 = PAGE.0 - 2.0 * LEFT;

/// Name of the picture in the resources of a page.
pub(super) const PICTURE: &[u8] = b"P0";

const SIZE: f32 = 9.5;
/// Distance of baselines over the size.
const LEADING: f32 = 1.38;
/// Lines of a row on one page, below the head of its table.
const MOST_LINES: usize = 48;
/// Height up to which a table stays whole: a third of a page.
const WHOLE: f32 = (PAGE.1 - TOP - BOTTOM) / 3.0;
/// Free space between columns.
const GUTTER: f32 = 8.0;

/// Pages that grow from above.
pub(super) struct Layout {
    pub(super) pages: Vec<Content>,
    pub(super) fonts: [Font; 2],
    /// Letters of the text that the font lacks.
    pub(super) lacking: String,
    /// Upper edge of what comes next, from the foot of the page.
    y: f32,
}

impl Layout {
    pub fn new() -> Self {
        let mut layout = Self { pages: Vec::new(), fonts: Weight::ALL.map(Font::new), lacking: String::new(), y: 0.0 };
        layout.break_page();
        layout
    }

    /// A picture at the head of the page, on the right, of the pixels' proportions; returns its height.
    pub fn picture(&mut self, width: u32, height: u32) -> f32 {
        const MOST: (f32, f32) = (130.0, 48.0);
        #[allow(clippy::cast_precision_loss, reason = "thousands of pixels at most")]
        let (columns, rows) = (width.max(1) as f32, height.max(1) as f32);
        let scale = (MOST.0 / columns).min(MOST.1 / rows);
        let (width, height) = (scale * columns, scale * rows);
        let (x, y) = (LEFT + WIDTH - width, self.y - height);
        self.page().save_state().transform([width, 0.0, 0.0, height, x, y]).x_object(Name(PICTURE)).restore_state();
        height
    }

    /// The document's title, in no less than `height`.
    pub fn title(&mut self, text: &str, height: f32) {
        let end = self.y - height;
        self.lines(text, Weight::Bold, 20.0, LEFT, WIDTH);
        self.y = self.y.min(end);
        self.space(4.0);
    }

    /// A heading that stays with the `lines` after it.
    pub fn heading(&mut self, text: &str, lines: u8) {
        self.space(11.0);
        self.keep(18.0 + 10.0 * f32::from(lines));
        self.lines(text, Weight::Bold, 11.5, LEFT, WIDTH);
        self.space(3.0);
    }

    /// A paragraph.
    pub fn paragraph(&mut self, text: &str) {
        self.lines(text, Weight::Regular, SIZE, LEFT, WIDTH);
        self.space(4.0);
    }

    /// Names on the left, what they stand for on the right.
    pub fn facts(&mut self, facts: &[Fact]) {
        let columns = [0.32, 0.68].map(|share| Column { title: String::new(), share, align: Align::Left });
        for (name, value) in facts {
            self.row(&columns, &[name.clone(), value.clone()], Weight::Regular);
        }
        self.space(3.0);
    }

    /// A table. One that is not long stays whole; of another the head, and the name of a group that goes on, are repeated on
    /// every page.
    pub fn table(&mut self, table: &Table) {
        let columns = &table.columns;
        let head: Vec<String> = columns.iter().map(|column| column.title.clone()).collect();
        let height_of_head = self.height_of(columns, &head, Weight::Bold);
        let heights: Vec<f32> = table.rows.iter().map(|row| self.height_of_row(columns, row)).collect();
        let whole = height_of_head + heights.iter().sum::<f32>();
        self.keep(if whole < WHOLE { whole } else { height_of_head + 2.0 * SIZE * LEADING });
        self.head(columns, &head);
        let mut group = None;
        for (n, (row, height)) in table.rows.iter().zip(&heights).enumerate() {
            // The name of a group stays with its first row.
            let is_group = matches!(row, Row::Group(_));
            let needed = height + if is_group { heights.get(n + 1).copied().unwrap_or(0.0) } else { 0.0 };
            if self.y - needed < BOTTOM {
                self.break_page();
                self.head(columns, &head);
                if let Some(name) = group.filter(|_| !is_group) {
                    self.group(name);
                }
            }
            match row {
                Row::Group(name) => {
                    group = Some(name);
                    self.group(name);
                }
                Row::Cells(cells) => {
                    self.row(columns, cells, Weight::Regular);
                    self.rule(0.25);
                }
            }
        }
        self.space(6.0);
    }

    /// The name of a group of rows, across the table.
    fn group(&mut self, name: &str) {
        self.row(&across(), &[name.to_owned()], Weight::Bold);
        self.rule(0.25);
    }

    fn height_of_row(&self, columns: &[Column], row: &Row) -> f32 {
        match row {
            Row::Group(name) => self.height_of(&across(), std::slice::from_ref(name), Weight::Bold),
            Row::Cells(cells) => self.height_of(columns, cells, Weight::Regular),
        }
    }

    /// A line for a signature with who signs beside it, a line for the date, and under them free room for a mark.
    pub fn signature(&mut self, [name, role, word, date, mark]: [&str; 5]) {
        const SMALL: f32 = 8.0;
        const ROOM: f32 = 62.0;
        const FROM: f32 = LEFT + 190.0;
        let date_line = (LEFT + WIDTH - 90.0, LEFT + WIDTH);
        let broken = |text, weight| self.broken(text, weight, SIZE, date_line.0 - GUTTER - FROM).into_iter();
        let signs = broken(name, Weight::Bold).map(|line| (line, Weight::Bold));
        let signs = signs.chain(broken(role, Weight::Regular).map(|line| (line, Weight::Regular)));
        let signs: Vec<(String, Weight)> = signs.take(MOST_LINES).collect();
        let height = (26.0 + ROOM).max(12.0 * signs.len() as f32);
        self.keep(38.0 + height);
        self.space(26.0);
        let y = self.y;
        for (from, to) in [(LEFT, LEFT + 170.0), date_line] {
            self.page().set_line_width(0.5).move_to(from, y).line_to(to, y).stroke();
        }
        self.text(word, Weight::Regular, SMALL, LEFT, y - 10.0);
        self.text(date, Weight::Regular, SMALL, date_line.0, y - 10.0);
        for (n, (line, weight)) in (0_u16..).zip(&signs) {
            self.text(line, *weight, SIZE, FROM, y - 12.0 * f32::from(n));
        }
        self.text(mark, Weight::Regular, SMALL, LEFT, y - 26.0);
        self.space(height);
    }

    /// Free space, none at the head of a page.
    pub fn space(&mut self, height: f32) {
        if self.y < PAGE.1 - TOP {
            self.y -= height;
        }
    }

    /// A rule across the text at the present height.
    pub fn rule(&mut self, width: f32) {
        let y = self.y + 1.5;
        self.page().set_line_width(width).move_to(LEFT, y).line_to(LEFT + WIDTH, y).stroke();
    }

    /// Goes on to the next page if less than `height` is left.
    pub fn keep(&mut self, height: f32) {
        if self.y - height < BOTTOM {
            self.break_page();
        }
    }

    fn head(&mut self, columns: &[Column], head: &[String]) {
        self.row(columns, head, Weight::Bold);
        self.rule(0.8);
    }

    /// A row; one that is higher than a page goes on on the next.
    fn row(&mut self, columns: &[Column], cells: &[String], weight: Weight) {
        let room = |column: &Column| column.share * WIDTH - GUTTER;
        let broken = columns.iter().zip(cells).map(|(column, cell)| self.broken(cell, weight, SIZE, room(column)));
        let broken: Vec<Vec<String>> = broken.collect();
        let count = broken.iter().map(Vec::len).max().unwrap_or(0).max(1);
        for from in (0..count).step_by(MOST_LINES) {
            let height = count.saturating_sub(from).min(MOST_LINES) as f32 * SIZE * LEADING + 2.0;
            self.keep(height);
            let mut x = LEFT;
            for (column, lines) in columns.iter().zip(&broken) {
                for (n, line) in (0_u16..).zip(lines.iter().skip(from).take(MOST_LINES)) {
                    let shift = match column.align {
                        Align::Left => 0.0,
                        Align::Right => room(column) - self.font(weight).width(line, SIZE),
                    };
                    let y = self.y - SIZE - f32::from(n) * SIZE * LEADING;
                    self.text(line, weight, SIZE, x + shift, y);
                }
                x += column.share * WIDTH;
            }
            self.y -= height;
        }
    }

    fn height_of(&self, columns: &[Column], cells: &[String], weight: Weight) -> f32 {
        let lines =
            |(column, cell): (&Column, &String)| self.broken(cell, weight, SIZE, column.share * WIDTH - GUTTER).len();
        let most = columns.iter().zip(cells).map(lines).max().unwrap_or(0);
        most as f32 * SIZE * LEADING + 2.0
    }

    fn lines(&mut self, text: &str, weight: Weight, size: f32, x: f32, width: f32) {
        for line in self.broken(text, weight, size, width) {
            self.keep(size * LEADING);
            self.text(&line, weight, size, x, self.y - size);
            self.y -= size * LEADING;
        }
    }

    /// The text in lines no wider than `width`; a longer word is cut.
    fn broken(&self, text: &str, weight: Weight, size: f32, width: f32) -> Vec<String> {
        let font = self.font(weight);
        let mut lines = Vec::new();
        let mut line = String::new();
        for word in text.split(' ').flat_map(|word| cut(word, |piece| font.width(piece, size) <= width)) {
            let longer = if line.is_empty() { word.clone() } else { format!("{line} {word}") };
            if font.width(&longer, size) > width && !line.is_empty() {
                lines.push(std::mem::replace(&mut line, word));
            } else {
                line = longer;
            }
        }
        lines.push(line);
        lines
    }

    /// One line of text with its baseline at `y`.
    fn text(&mut self, text: &str, weight: Weight, size: f32, x: f32, y: f32) {
        self.lacking += &self.font(weight).lacks(text);
        let glyphs = encoded(self.font(weight), text);
        show(self.page(), &glyphs, weight, size, x, y);
    }

    fn font(&self, weight: Weight) -> &Font {
        &self.fonts[usize::from(weight == Weight::Bold)]
    }

    fn page(&mut self) -> &mut Content {
        if self.pages.is_empty() {
            self.pages.push(Content::new());
        }
        let last = self.pages.len() - 1;
        &mut self.pages[last]
    }

    fn break_page(&mut self) {
        self.pages.push(Content::new());
        self.y = PAGE.1 - TOP;
    }
}

/// One column across the text.
fn across() -> [Column; 1] {
    [Column { title: String::new(), share: 1.0, align: Align::Left }]
}

/// Pieces of a word that fit, in order: the whole of it if it does.
fn cut(word: &str, fits: impl Fn(&str) -> bool) -> Vec<String> {
    let mut pieces = vec![String::new()];
    for c in word.chars() {
        let last = pieces.len() - 1;
        let longer = format!("{}{c}", pieces[last]);
        if fits(&longer) || pieces[last].is_empty() {
            pieces[last] = longer;
        } else {
            pieces.push(c.to_string());
        }
    }
    pieces
}

/// Glyphs of a text, two bytes each.
pub(super) fn encoded(font: &Font, text: &str) -> Vec<u8> {
    harmless_line(text).chars().flat_map(|c| font.glyph(c).to_be_bytes()).collect()
}

pub(super) fn show(page: &mut Content, glyphs: &[u8], weight: Weight, size: f32, x: f32, y: f32) {
    page.begin_text();
    page.set_font(Name(weight.resource()), size);
    page.next_line(x, y);
    page.show(Str(glyphs));
    page.end_text();
}
