//! Messages as users see them, pinned: each names the file, the place, what was found and what was expected.

mod file_messages;
mod foreign_files;
mod plan_messages;
mod rows;
mod sample;
mod schemas;
mod session_messages;
