//! Messages as users see them, pinned: each names the file, the place, what was found and what was expected.

#[path = "../common/record.rs"]
mod record;
mod table_messages;
