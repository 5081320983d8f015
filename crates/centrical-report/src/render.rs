//! Renderers of documents: each draws the same content in a form of its own. The pages of a store, which are a list and no document,
//! stand beside them.

mod history;
mod html;
mod pdf;

pub use self::history::{HistoryPages, history_index, history_station_page, history_unit_page};
pub use self::html::html;
pub use self::pdf::pdf;
