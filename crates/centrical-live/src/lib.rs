//! The live page of a watch, and finished results, for the browsers of a laboratory.
//!
//! A [`Site`] answers paths with bytes and has a panel that changes; the [`Server`] sends them. It only reads: no request writes
//! anything. Whoever watches a session is not held up: the server has a thread of its own and sees only files.
//!
//! ```no_run
//! use std::path::Path;
//!
//! use centrical_live::{Server, Watched};
//!
//! let server = Server::bind("127.0.0.1:8080", &[])?;
//! println!("{}", server.url());
//! server.start(Watched::new(Path::new("watched")))?;
//! # Ok::<(), centrical_session::Error>(())
//! ```

mod http;
mod site;

pub use http::{Running, Server};
pub use site::{Answer, Query, Results, Site, Stored, Watched};
