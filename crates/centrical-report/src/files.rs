//! The files of commands: which documents are made of what, and what they are called.

mod documents;
mod pages;

pub use self::documents::{
    DocumentRequest, Documents, certificates_in, read_issuer, refuse_outputs, write_all_documents, write_documents,
    write_history_plot, write_noise, write_plots,
};
pub use self::pages::{PagesRequest, StorePages, write_history_pages};
