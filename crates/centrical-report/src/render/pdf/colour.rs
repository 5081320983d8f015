//! What the colours of a page mean: an ICC profile of sRGB (ICC.1:2010, IEC 61966-2-1), built here so that it is free to ship.

/// Primaries of sRGB adapted to D50, in XYZ; then D50 itself (IEC 61966-2-1; ICC.1:2010, 7.2.16).
const RED: [f64; 3] = [0.436_066, 0.222_488, 0.013_916];
const GREEN: [f64; 3] = [0.385_147, 0.716_873, 0.097_076];
const BLUE: [f64; 3] = [0.143_082, 0.060_608, 0.714_096];
const WHITE: [f64; 3] = [0.964_2, 1.0, 0.824_9];

/// From D65 to D50 by the linear Bradford transform, row by row (ICC.1:2010, annex E).
const ADAPTATION: [f64; 9] =
    [1.047_882, 0.022_919, -0.050_217, 0.029_587, 0.990_479, -0.017_059, -0.009_247, 0.015_076, 0.751_678];

/// `Y = (a X + b)^g` above `d`, `Y = c X` below it: g, a, b, c, d of sRGB.
const CURVE: [f64; 5] = [2.4, 1.0 / 1.055, 0.055 / 1.055, 1.0 / 12.92, 0.040_45];

const HEADER: usize = 128;

/// The profile: three primaries and one curve for all.
pub(super) fn srgb_profile() -> Vec<u8> {
    let curve = [b"para\0\0\0\0\0\x03\0\0", &numbers(&CURVE)[..]].concat();
    let xyz = |point: [f64; 3]| [b"XYZ \0\0\0\0", &numbers(&point)[..]].concat();
    let elements: [(&[&[u8; 4]], Vec<u8>); 7] = [
        (&[b"desc"], text("sRGB")),
        (&[b"cprt"], text("CC0")),
        (&[b"wtpt"], xyz(WHITE)),
        (&[b"chad"], [b"sf32\0\0\0\0", &numbers(&ADAPTATION)[..]].concat()),
        (&[b"rXYZ"], xyz(RED)),
        (&[b"gXYZ"], xyz(GREEN)),
        (&[b"bXYZ"], xyz(BLUE)),
    ];
    let elements = elements.into_iter().chain([(&[b"rTRC", b"gTRC", b"bTRC"][..], curve)]);
    let (mut table, mut data, mut count) = (Vec::new(), Vec::new(), 0_u32);
    // Ten entries of twelve bytes after the header and their number.
    let start = HEADER + 4 + 10 * 12;
    for (names, bytes) in elements {
        for name in names {
            table.extend(name.as_slice());
            table.extend(word(start + data.len()));
            table.extend(word(bytes.len()));
            count += 1;
        }
        data.extend(bytes);
        data.resize(data.len().next_multiple_of(4), 0);
    }
    let mut profile = header(start + data.len());
    profile.extend(count.to_be_bytes());
    profile.extend(table);
    profile.extend(data);
    profile
}

/// A profile of a display, version 4.3, RGB to XYZ, without a date of its own.
fn header(size: usize) -> Vec<u8> {
    let mut header = vec![0; HEADER];
    let mut put = |at: usize, bytes: &[u8]| header[at..at + bytes.len()].copy_from_slice(bytes);
    put(0, &word(size));
    put(8, &[4, 0x30, 0, 0]);
    put(12, b"mntrRGB XYZ ");
    // 2026-01-01, as a date is asked for.
    put(24, &[0x07, 0xea, 0, 1, 0, 1]);
    put(36, b"acsp");
    put(68, &numbers(&WHITE));
    header
}

/// Numbers as s15Fixed16.
fn numbers(values: &[f64]) -> Vec<u8> {
    #[allow(clippy::cast_possible_truncation, reason = "all are below 4")]
    let fixed = |value: &f64| ((value * 65536.0).round() as i32).to_be_bytes();
    values.iter().flat_map(fixed).collect()
}

/// A text in one language, multiLocalizedUnicodeType.
fn text(words: &str) -> Vec<u8> {
    let letters: Vec<u8> = words.encode_utf16().flat_map(u16::to_be_bytes).collect();
    let head = [&b"mluc\0\0\0\0"[..], &word(1), &word(12), b"enUS", &word(letters.len()), &word(28)].concat();
    [head, letters].concat()
}

fn word(number: usize) -> [u8; 4] {
    u32::try_from(number).unwrap_or(u32::MAX).to_be_bytes()
}
