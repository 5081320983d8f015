//! What holds for every plot.

mod palette;
mod plot;
