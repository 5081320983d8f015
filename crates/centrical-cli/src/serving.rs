//! Pages for browsers: where they are served, and until when.

use std::sync::atomic::Ordering;
use std::thread;
use std::time::Duration;

use centrical_live::{Server, Site};
use centrical_session::Error;

use crate::interruption::asked_to_end;
use crate::output::say;

/// Where pages are served.
#[derive(Debug, clap::Args)]
pub struct Serving {
    /// Show the watch in browsers at this address; other machines see it only where they can reach the address [default: 127.0.0.1:8080]
    #[arg(long, value_name = "ADDRESS", num_args = 0..=1, default_missing_value = USUAL, conflicts_with = "once")]
    serve: Option<String>,
    /// A name of this machine by which browsers call it, beside localhost and addresses; may be repeated
    #[arg(long, value_name = "NAME", requires = "serve")]
    serve_name: Vec<String>,
}

/// The usual address.
pub const USUAL: &str = "127.0.0.1:8080";

impl Serving {
    /// Binds to the address, if pages are asked for.
    pub fn bind(&self) -> Result<Option<Server>, Error> {
        self.serve.as_ref().map(|address| Server::bind(address, &self.serve_name)).transpose()
    }
}

/// Serves on a thread of its own; the address of the page.
pub fn serve(server: Server, site: impl Site) -> Result<String, Error> {
    let url = server.url();
    if server.is_open() {
        say("Warning: the page is open to every machine that reaches this address; it has no password\n");
    }
    server.start(site)?;
    say(&format!("The page is at {url}\n"));
    Ok(url)
}

/// Waits until the user has seen enough.
pub fn remain(url: &str) {
    say(&format!("{url} stays until Ctrl-C\n"));
    while !asked_to_end().load(Ordering::Relaxed) {
        thread::sleep(Duration::from_millis(50));
    }
}
