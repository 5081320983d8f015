//! From pages to the bytes of a file: fonts embedded, streams compressed, no date, no random identifier.

use std::borrow::Cow;
use std::collections::BTreeMap;

use centrical_session::harmless_line;
use miniz_oxide::deflate::compress_to_vec_zlib;
use pdf_writer::types::{CidFontType, FontFlags, SystemInfo, UnicodeCmap};
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref, Str, TextStr};

use super::archive::{Archive, PRODUCER, identifier};
use super::font::{Font, Weight};
use super::layout::{BOTTOM, LEFT, Layout, PAGE, PICTURE, TOP, WIDTH, encoded, show};
use crate::document::{Document, Margins, Picture};

/// Level of zlib: the best that is still quick.
const COMPRESSION: u8 = 8;

const SYSTEM: SystemInfo = SystemInfo { registry: Str(b"Adobe"), ordering: Str(b"Identity"), supplement: 0 };

/// The file.
pub(super) fn write(mut layout: Layout, document: &Document) -> Vec<u8> {
    let count = layout.pages.len();
    for (n, page) in (1..).zip(&mut layout.pages) {
        let [page_word, of] = document.margins.page;
        furnish(page, &layout.fonts[0], &document.margins, &format!("{page_word} {n} {of} {count}"));
    }
    let mut next = 0;
    let mut new = || {
        next += 1;
        Ref::new(next)
    };
    let (catalog, tree, info) = (new(), new(), new());
    let (title, attachment) = (harmless_line(&document.title).into_owned(), document.attachment.as_ref());
    let mut pdf = Pdf::new();
    let archive = Archive::new(&mut pdf, &title, attachment, COMPRESSION, &mut new);
    let mut entries = pdf.catalog(catalog);
    entries.pages(tree).lang(TextStr(document.language.code()));
    archive.enter(&mut entries, attachment);
    entries.finish();
    pdf.document_info(info).title(TextStr(&title)).producer(TextStr(PRODUCER));
    let picture = document.opening.picture.as_ref().map(|picture| draw(&mut pdf, picture, new()));
    let fonts: Vec<(Weight, Ref)> = Weight::ALL
        .into_iter()
        .zip(&layout.fonts)
        .map(|(weight, font)| (weight, embed(&mut pdf, weight, font, &mut new)))
        .collect();
    let contents: Vec<Vec<u8>> = layout.pages.into_iter().map(|page| page.finish().into_vec()).collect();
    let carried = attachment.map_or(&[][..], |attachment| &attachment.bytes);
    pdf.set_file_id(identifier(contents.iter().map(Vec::as_slice).chain([title.as_bytes(), carried])));
    let resources = Resources { fonts, picture };
    let pages: Vec<Ref> = contents.iter().map(|page| one_page(&mut pdf, page, tree, &resources, &mut new)).collect();
    pdf.pages(tree).count(i32::try_from(pages.len()).unwrap_or(i32::MAX)).kids(pages);
    pdf.finish()
}

/// Head and foot of a page.
fn furnish(page: &mut Content, font: &Font, margins: &Margins, number: &str) {
    let (high, low) = (PAGE.1 - TOP + 22.0, BOTTOM - 24.0);
    let mut line = |left: &str, right: &str, y: f32| {
        let right = fitted(font, right, 0.5 * WIDTH);
        let from = LEFT + WIDTH - font.width(&right, SMALL);
        let left = fitted(font, left, from - LEFT - APART);
        for (text, x) in [(left, LEFT), (right, from)] {
            show(page, &encoded(font, &text), Weight::Regular, SMALL, x, y);
        }
    };
    line(&margins.head[0], &margins.head[1], high);
    line(&margins.foot, number, low);
    for y in [high - 6.0, low + 12.0] {
        page.set_line_width(0.5).move_to(LEFT, y).line_to(LEFT + WIDTH, y).stroke();
    }
}

/// Size of the texts in margins [points].
const SMALL: f32 = 8.0;

/// Least distance between two texts of a line [points].
const APART: f32 = 12.0;

/// A text of a margin, or its beginning where it is too wide.
fn fitted<'t>(font: &Font, text: &'t str, width: f32) -> Cow<'t, str> {
    if font.width(text, SMALL) <= width {
        return Cow::Borrowed(text);
    }
    let cut = |end: usize| format!("{}…", text[..end].trim_end());
    let fits = text.char_indices().map(|(end, _)| cut(end)).take_while(|cut| font.width(cut, SMALL) <= width);
    fits.last().unwrap_or_default().into()
}

/// What pages show.
struct Resources {
    fonts: Vec<(Weight, Ref)>,
    picture: Option<Ref>,
}

fn one_page(pdf: &mut Pdf, content: &[u8], tree: Ref, shown: &Resources, new: &mut impl FnMut() -> Ref) -> Ref {
    let (id, stream) = (new(), new());
    let mut page = pdf.page(id);
    page.media_box(Rect::new(0.0, 0.0, PAGE.0, PAGE.1)).parent(tree).contents(stream);
    let mut resources = page.resources();
    let mut dictionary = resources.fonts();
    for (weight, font) in &shown.fonts {
        dictionary.pair(Name(weight.resource()), *font);
    }
    dictionary.finish();
    if let Some(picture) = shown.picture {
        resources.x_objects().pair(Name(PICTURE), picture);
    }
    resources.finish();
    page.finish();
    pdf.stream(stream, &compress_to_vec_zlib(content, COMPRESSION)).filter(Filter::FlateDecode);
    id
}

/// The pixels of a picture.
fn draw(pdf: &mut Pdf, picture: &Picture, id: Ref) -> Ref {
    let packed = compress_to_vec_zlib(&picture.pixels, COMPRESSION);
    let side = |pixels: u32| i32::try_from(pixels).unwrap_or(i32::MAX);
    let mut image = pdf.image_xobject(id, &packed);
    image.filter(Filter::FlateDecode);
    image.width(side(picture.width)).height(side(picture.height)).bits_per_component(8);
    image.color_space().device_rgb();
    id
}

/// The font whole, addressed by glyph, with a map back to characters so that text can be searched and copied.
fn embed(pdf: &mut Pdf, weight: Weight, font: &Font, new: &mut impl FnMut() -> Ref) -> Ref {
    let (id, cid, descriptor, file, cmap) = (new(), new(), new(), new(), new());
    let name = Name(weight.post_script_name());
    pdf.type0_font(id).base_font(name).encoding_predefined(Name(b"Identity-H")).descendant_font(cid).to_unicode(cmap);
    let glyphs = font.face.as_ref().map_or(0, ttf_parser::Face::number_of_glyphs);
    let mut cid_font = pdf.cid_font(cid);
    cid_font.subtype(CidFontType::Type2).base_font(name).system_info(SYSTEM).font_descriptor(descriptor);
    cid_font.cid_to_gid_map_predefined(Name(b"Identity"));
    cid_font.widths().consecutive(0, (0..glyphs).map(|glyph| font.advance(glyph)));
    cid_font.finish();
    describe(pdf, descriptor, file, name, font);
    let data = compress_to_vec_zlib(weight.data(), COMPRESSION);
    let mut stream = pdf.stream(file, &data);
    stream.filter(Filter::FlateDecode);
    stream.pair(Name(b"Length1"), i32::try_from(weight.data().len()).unwrap_or(i32::MAX));
    stream.finish();
    let mut map = UnicodeCmap::new(Name(b"Characters"), SYSTEM);
    for (glyph, c) in characters(font) {
        map.pair(glyph, c);
    }
    pdf.cmap(cmap, &map.finish());
    id
}

fn describe(pdf: &mut Pdf, id: Ref, file: Ref, name: Name, font: &Font) {
    let Some(face) = &font.face else { return };
    let scale = |value: i16| f32::from(value) * 1000.0 / f32::from(face.units_per_em());
    let bounds = face.global_bounding_box();
    let mut descriptor = pdf.font_descriptor(id);
    descriptor.name(name).flags(FontFlags::SYMBOLIC).italic_angle(0.0).stem_v(if face.is_bold() {
        140.0
    } else {
        80.0
    });
    descriptor.bbox(Rect::new(scale(bounds.x_min), scale(bounds.y_min), scale(bounds.x_max), scale(bounds.y_max)));
    descriptor.ascent(scale(face.ascender())).descent(scale(face.descender()));
    descriptor.cap_height(scale(face.capital_height().unwrap_or(face.ascender()))).font_file2(file);
}

/// The first character of every glyph.
fn characters(font: &Font) -> BTreeMap<u16, char> {
    let mut characters = BTreeMap::new();
    let subtables = font.face.iter().filter_map(|face| face.tables().cmap).flat_map(|cmap| cmap.subtables);
    for subtable in subtables.filter(ttf_parser::cmap::Subtable::is_unicode) {
        subtable.codepoints(|code| {
            if let (Some(c), Some(glyph)) = (char::from_u32(code), subtable.glyph_index(code)) {
                characters.entry(glyph.0).or_insert(c);
            }
        });
    }
    characters
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The name of a laboratory that is wider than the page ends before the number of the certificate.
    #[test]
    fn a_text_of_a_margin_is_cut_to_its_width() {
        let font = Font::new(Weight::Regular);
        assert_eq!(fitted(&font, "Laboratory", WIDTH), "Laboratory");
        let long = "Всероссийский институт метрологии ".repeat(10);
        for width in [0.0, 40.0, 0.5 * WIDTH, WIDTH] {
            let cut = fitted(&font, &long, width);
            assert!(font.width(&cut, SMALL) <= width && (cut.ends_with('…') || cut.is_empty()), "{cut}");
            assert!(width < 40.0 || font.width(&cut, SMALL) > width - 3.0 * SMALL, "{cut}");
        }
    }
}
