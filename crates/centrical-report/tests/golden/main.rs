//! Our own output, pinned: it detects change and proves nothing.

use centrical::{Position, ThirdPosition};
use centrical_report::Language;
use centrical_report::plot::{Axis, Plot, Point, Series};

/// The drawing in the README is what the program draws.
#[test]
fn positions_of_the_source() {
    let drawn = centrical_report::positions_figure(&Position::kozlov_2017(ThirdPosition::AxisOneUp), Language::English);
    assert_eq!(drawn, include_str!("../../../../docs/figures/positions.svg"), "run `cargo run --example positions`");
}

#[test]
fn a_small_plot_is_unchanged() {
    let measured = [(1.0, 3.0, 2.5, 3.6), (10.0, 1.0, 0.8, 1.3), (100.0, 0.4, 0.2, 0.9)];
    let measured = measured.map(|(x, y, low, high)| Point::new(x, y).with_interval(low, high)).to_vec();
    let model = vec![Point::new(1.0, 3.16), Point::new(100.0, 0.316)];
    let svg = Plot::new("Deviation", Axis::log("averaging time, s"), Axis::log("deviation, m/s²"))
        .with(Series::markers("measured", measured))
        .with(Series::line("model", model))
        .to_svg();
    // One element a line, so that a difference can be read.
    let readable = svg.replace("><", ">\n<");
    assert_eq!(readable, include_str!("plot.svg"), "the drawing has changed:\n{readable}");
}
