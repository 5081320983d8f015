//! Renderers of documents: each draws the same content in a form of its own.

mod html;
mod pdf;

pub use self::html::html;
pub use self::pdf::pdf;
