//! What a site is, and what it answers.

use centrical_report::Language;
use centrical_session::Error;

/// Pages without a server: what a path is answered with. A site has no panel and no metrics unless it says so.
pub trait Site: Send + Sync + 'static {
    /// The answer to a path; `None` without such a page.
    fn answer(&self, path: &str, query: &Query) -> Option<Answer>;

    /// Whether there is a panel that changes, and events of it.
    fn has_panel(&self) -> bool {
        false
    }

    /// A number that changes with the files that the panel is made of.
    fn stamp(&self) -> u64 {
        0
    }

    /// The panel as it is now; `None` while there is nothing to show.
    fn panel(&self, _: Language) -> Option<String> {
        None
    }

    /// Metrics in Prometheus' text.
    fn metrics(&self) -> String {
        String::new()
    }
}

/// An answer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Answer {
    /// A page that takes style and script from the server.
    Page(String),
    /// A page that is whole in itself.
    Document(String),
    /// A file with its media type.
    File(&'static str, String),
    /// What cannot be shown at present, and why.
    Failed(String),
}

impl From<Result<Self, Error>> for Answer {
    /// The answer, or what the error says.
    fn from(answer: Result<Self, Error>) -> Self {
        answer.unwrap_or_else(|error| Self::Failed(error.to_string()))
    }
}

/// The query of a request.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Query(Vec<(String, String)>);

impl Query {
    /// Reads a query; what has no form is left out.
    pub fn of(text: Option<&str>) -> Self {
        let pairs = text.unwrap_or("").split('&').filter_map(|pair| pair.split_once('='));
        Self(pairs.map(|(name, value)| (name.to_owned(), value.to_owned())).collect())
    }

    /// A value.
    pub fn get(&self, name: &str) -> Option<&str> {
        self.0.iter().find(|(known, _)| known == name).map(|(_, value)| value.as_str())
    }

    /// The language that is asked for.
    pub fn language(&self) -> Language {
        if self.get("lang") == Some("ru") { Language::Russian } else { Language::English }
    }
}
