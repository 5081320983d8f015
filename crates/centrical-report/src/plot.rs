//! Line plots as SVG: linear or logarithmic axes, error bars, legend, values on hover.
//!
//! One plot is one self-contained `<svg>` that can stand alone or inside a page. It follows the reader's light or
//! dark scheme. Series differ by colour (Okabe and Ito's palette, safe for colour-blind eyes), by marker shape and by
//! dashes, so the plot survives a grey print.
//!
//! ```
//! use centrical_report::plot::{Axis, Plot, Point, Series};
//!
//! let points = vec![Point::new(1.0, 2.0), Point::new(10.0, 0.7).with_interval(0.6, 0.9)];
//! let svg = Plot::new("Deviation", Axis::log("time, s"), Axis::log("deviation, m/s²"))
//!     .with(Series::markers("measured", points))
//!     .to_svg();
//! assert!(svg.starts_with("<svg"));
//! ```

mod axis;
mod draw;
mod series;
mod svg;

pub(crate) use self::draw::STYLE;
pub use self::series::{Axis, Plot, Point, Series};
pub(crate) use self::svg::{Escaped, Px, opened};

impl Plot {
    /// The plot as an SVG element; the same plot gives the same bytes.
    pub fn to_svg(&self) -> String {
        draw::plot(self, STYLE)
    }

    /// The same for a page that has [`STYLE`] once.
    pub(crate) fn to_svg_in_page(&self) -> String {
        draw::plot(self, "")
    }
}
