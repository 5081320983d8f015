//! What holds for every plot and document.

mod palette;
mod plot;
mod russian;
