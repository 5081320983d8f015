//! The few things about SVG text that every drawing needs.

use std::fmt::{self, Display};

use centrical_session::harmless_line;

/// Text with the characters that mean something to XML replaced; those that are not shown, among them what XML forbids, by U+FFFD.
pub(crate) struct Escaped<'a>(pub(crate) &'a str);

impl Display for Escaped<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for c in harmless_line(self.0).chars() {
            match c {
                '&' => f.write_str("&amp;")?,
                '<' => f.write_str("&lt;")?,
                '>' => f.write_str("&gt;")?,
                '"' => f.write_str("&quot;")?,
                c => write!(f, "{c}")?,
            }
        }
        Ok(())
    }
}

/// The beginning of a drawing on a ground, with its title at a place and a style of its own.
pub(crate) fn opened(class: &str, style: &str, size: (f64, f64), title: &str, place: (f64, f64)) -> String {
    let (width, height, x, y, title) = (Px(size.0), Px(size.1), Px(place.0), Px(place.1), Escaped(title));
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"{class}\" role=\"img\" viewBox=\"0 0 {width} {height}\" \
         aria-label=\"{title}\"><style>{style}</style><rect class=\"ground\" width=\"{width}\" height=\"{height}\"/>\
         <text class=\"title\" x=\"{x}\" y=\"{y}\">{title}</text>"
    )
}

/// A length in pixels, to a tenth, held within what renderers draw.
pub(crate) struct Px(pub(crate) f64);

impl Display for Px {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let tenths = (self.0.clamp(-1e5, 1e5) * 10.0).round() / 10.0;
        // Adding zero turns a negative zero positive.
        write!(f, "{}", tenths + 0.0)
    }
}

/// A value as a person reads it: five significant digits.
pub(super) struct Value(pub(super) f64);

impl Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = self.0.abs();
        if self.0 < 0.0 {
            f.write_str("\u{2212}")?;
        }
        if size == 0.0 || (1e-3..1e5).contains(&size) {
            let decimals = [1e4, 1e3, 1e2, 1e1, 1e0, 1e-1, 1e-2].iter().take_while(|power| size < **power).count();
            write!(f, "{size:.decimals$}")
        } else {
            write!(f, "{size:.4e}")
        }
    }
}
