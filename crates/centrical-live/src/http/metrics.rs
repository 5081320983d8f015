//! What the server counts, in Prometheus' text.

use std::fmt::Write;
use std::sync::atomic::{AtomicI64, AtomicU64, Ordering};

use super::guard::Refusal;

/// Counts since the server was started.
#[derive(Debug, Default)]
pub struct Metrics {
    requests: AtomicU64,
    refused: [AtomicU64; Refusal::ALL.len()],
    malformed: AtomicU64,
    slow: AtomicU64,
    connections: AtomicI64,
}

impl Metrics {
    /// A request has come.
    pub fn request(&self) {
        self.requests.fetch_add(1, Ordering::Relaxed);
    }

    /// One was refused.
    pub fn refused(&self, why: Refusal) {
        let known = Refusal::ALL.iter().zip(&self.refused);
        known.filter(|(refusal, _)| **refusal == why).for_each(|(_, count)| _ = count.fetch_add(1, Ordering::Relaxed));
    }

    /// A connection has begun or ended.
    pub fn connection(&self, change: i64) {
        self.connections.fetch_add(change, Ordering::Relaxed);
    }

    /// A connection broke at what came over it.
    pub fn broken(&self, error: &hyper::Error) {
        if error.is_timeout() {
            self.slow.fetch_add(1, Ordering::Relaxed);
        } else if error.is_parse() {
            self.malformed.fetch_add(1, Ordering::Relaxed);
        }
    }

    /// The text, after the metrics of the site.
    pub fn text(&self, mut text: String) -> String {
        let of = |count: &AtomicU64| count.load(Ordering::Relaxed);
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "# HELP centrical_http_requests_total Requests.\n# TYPE centrical_http_requests_total counter"
        );
        let _ = writeln!(text, "centrical_http_requests_total {}", of(&self.requests));
        let _ = writeln!(
            text,
            "# HELP centrical_http_refused_total Requests that were refused.\n# TYPE centrical_http_refused_total counter"
        );
        for (refusal, count) in Refusal::ALL.iter().zip(&self.refused) {
            let _ = writeln!(text, "centrical_http_refused_total{{reason=\"{}\"}} {}", refusal.label(), of(count));
        }
        let _ = writeln!(text, "centrical_http_refused_total{{reason=\"malformed\"}} {}", of(&self.malformed));
        let _ = writeln!(text, "centrical_http_refused_total{{reason=\"slow\"}} {}", of(&self.slow));
        let open = self.connections.load(Ordering::Relaxed);
        let _ = writeln!(
            text,
            "# HELP centrical_http_connections Open connections.\n# TYPE centrical_http_connections gauge\ncentrical_http_connections {open}"
        );
        text
    }
}
