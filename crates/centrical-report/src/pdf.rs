//! PDF documents of running text and tables on A4, with embedded fonts for Latin, Greek and Cyrillic.

mod font;
mod layout;
mod write;

pub(crate) use layout::{Align, Column, Layout};
pub(crate) use write::{Furniture, write};
