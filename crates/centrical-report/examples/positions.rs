//! Prints the drawing of the source's six positions, `docs/figures/positions.svg`.

use centrical::{Position, ThirdPosition};
use centrical_report::Language;

fn main() {
    print!(
        "{}",
        centrical_report::positions_figure(&Position::kozlov_2017(ThirdPosition::AxisOneUp), Language::English)
    );
}
