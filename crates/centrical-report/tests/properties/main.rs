//! What holds for every plot.

mod plot;
