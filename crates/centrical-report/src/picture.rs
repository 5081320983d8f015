//! Pictures for documents, from PNG files.

use std::io::Cursor;
use std::path::Path;

use centrical_session::{Error, Place, read_bytes};
use png::{ColorType, Decoder, Limits, Transformations};

use crate::document::Picture;

/// Largest file of a picture [bytes].
const LARGEST_FILE: u64 = 1 << 20;

/// Largest number of pixels on a side.
const LARGEST_SIDE: u32 = 2048;

/// Memory that a decoder may take [bytes].
const LARGEST_MEMORY: usize = 32 << 20;

/// The picture in a PNG file; what is transparent in it is laid on white.
///
/// # Errors
/// [`Error`] when the file is not there, is not a PNG file or is larger than a mark on a certificate is.
pub(crate) fn read_picture(file: &Path) -> Result<Picture, Error> {
    let expected = format!("a PNG picture of up to {LARGEST_SIDE} pixels a side in 1 MB at most");
    let bytes = read_bytes(file, LARGEST_FILE, &expected)?;
    decode(Cursor::new(bytes)).map_err(|found| Error::content(file, Place::Whole, found, expected))
}

/// The picture, or what is wrong with it.
fn decode(input: Cursor<Vec<u8>>) -> Result<Picture, String> {
    let mut decoder = Decoder::new_with_limits(input, Limits { bytes: LARGEST_MEMORY });
    decoder.set_transformations(Transformations::EXPAND | Transformations::STRIP_16);
    let mut reader = decoder.read_info().map_err(|error| error.to_string())?;
    let (width, height) = reader.info().size();
    if width > LARGEST_SIDE || height > LARGEST_SIDE {
        return Err(format!("a picture of {width} x {height} pixels"));
    }
    let size = reader.output_buffer_size().ok_or_else(|| format!("a picture of {width} x {height} pixels"))?;
    let mut samples = vec![0; size];
    let frame = reader.next_frame(&mut samples).map_err(|error| error.to_string())?;
    let samples = &samples[..frame.buffer_size()];
    let pixels = match frame.color_type {
        ColorType::Rgb => samples.to_vec(),
        ColorType::Grayscale => samples.iter().flat_map(|&grey| [grey; 3]).collect(),
        ColorType::GrayscaleAlpha => samples.chunks_exact(2).flat_map(|p| on_white([p[0]; 3], p[1])).collect(),
        ColorType::Rgba => samples.chunks_exact(4).flat_map(|p| on_white([p[0], p[1], p[2]], p[3])).collect(),
        ColorType::Indexed => return Err("a palette that was not expanded".to_owned()),
    };
    Ok(Picture { width, height, pixels })
}

/// A colour of some opacity laid on white.
fn on_white(colour: [u8; 3], opacity: u8) -> [u8; 3] {
    let mixed = |c: u8| (u32::from(c) * u32::from(opacity) + 255 * (255 - u32::from(opacity)) + 127) / 255;
    colour.map(|c| u8::try_from(mixed(c)).unwrap_or(u8::MAX))
}
