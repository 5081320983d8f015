//! Renderers of documents: each draws the same content in a form of its own. The pages of a store, which are a list and no document,
//! stand beside them.

mod frame;
mod history;
mod html;
mod live;
mod pdf;
mod results;

pub use self::history::{
    Indexed, ListedUnit, PageKind, StoreCharts, UnitDue, due_comment, due_of_page, history_due_page, history_index,
    history_model_page, history_station_page, history_unit_page, no_unit_history_page,
};
pub use self::html::html;
pub use self::live::{LIVE_SCRIPT, LIVE_STYLE, live_page, live_panel};
pub use self::pdf::{letters_without_glyph, pdf};
pub use self::results::{ListedResult, compared_page, not_found, results_page, unchosen_page};
