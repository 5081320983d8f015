//! Pictures for documents, from PNG files.

use std::path::Path;

use centrical_session::{Error, Place, Source};
use zune_core::bytestream::ZCursor;
use zune_core::colorspace::ColorSpace;
use zune_core::options::DecoderOptions;
use zune_png::PngDecoder;

use crate::document::Picture;

/// Largest file of a picture [bytes].
const LARGEST_FILE: u64 = 1 << 20;

/// Largest number of pixels on a side.
const LARGEST_SIDE: usize = 2048;

/// The picture in a PNG file; what is transparent in it is laid on white.
///
/// # Errors
/// [`Error`] when the file is not there, is not a PNG file or is larger than a mark on a certificate is.
pub(crate) fn read_picture(file: &Path) -> Result<Picture, Error> {
    let expected = format!("a PNG picture of up to {LARGEST_SIDE} pixels a side in 1 MB at most");
    let bytes = Source::open(file, &expected)?.bytes(LARGEST_FILE, &expected)?;
    decode(&bytes).map_err(|found| Error::content(file, Place::Whole, found, expected))
}

/// The picture, or what is wrong with it.
fn decode(bytes: &[u8]) -> Result<Picture, String> {
    let options = DecoderOptions::new_safe()
        .set_strict_mode(true)
        .set_max_width(LARGEST_SIDE)
        .set_max_height(LARGEST_SIDE)
        .png_set_confirm_crc(true)
        .png_set_strip_to_8bit(true)
        .png_set_add_alpha_channel(true);
    let mut decoder = PngDecoder::new_with_options(ZCursor::new(bytes), options);
    let samples = decoder.decode_raw().map_err(|error| error.to_string().trim().to_owned())?;
    let (width, height) = decoder.dimensions().ok_or("a picture without a size")?;
    let pixels: Vec<u8> = match decoder.colorspace() {
        Some(ColorSpace::RGBA) => samples.chunks_exact(4).flat_map(|p| on_white([p[0], p[1], p[2]], p[3])).collect(),
        Some(ColorSpace::LumaA) => samples.chunks_exact(2).flat_map(|p| on_white([p[0]; 3], p[1])).collect(),
        other => return Err(format!("colours of the kind {other:?}")),
    };
    if pixels.len() != 3 * width * height {
        return Err(format!("{} samples of {width} x {height} pixels", pixels.len()));
    }
    let side = |pixels: usize| u32::try_from(pixels).map_err(|error| error.to_string());
    Ok(Picture { width: side(width)?, height: side(height)?, pixels })
}

/// A colour of some opacity laid on white.
fn on_white(colour: [u8; 3], opacity: u8) -> [u8; 3] {
    let mixed = |c: u8| (u32::from(c) * u32::from(opacity) + 255 * (255 - u32::from(opacity)) + 127) / 255;
    colour.map(|c| u8::try_from(mixed(c)).unwrap_or(u8::MAX))
}
