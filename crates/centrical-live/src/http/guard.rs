//! What a request has to be before it is answered.

use std::net::{IpAddr, SocketAddr};

use hyper::header::HOST;
use hyper::{Method, Request, StatusCode};

/// Longest path and query [bytes].
const LONGEST_TARGET: usize = 1024;

/// Why a request is refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Refusal {
    /// Another method than GET and HEAD.
    Method,
    /// A host that is neither an address nor a name of this machine: perhaps a foreign name that resolves to it.
    Host,
    /// A page of another site asks.
    CrossSite,
    /// A path that is too long or no path.
    Target,
    /// More connections than places.
    Crowded,
}

impl Refusal {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Method, Self::Host, Self::CrossSite, Self::Target, Self::Crowded];

    /// Its label in the metrics.
    pub fn label(self) -> &'static str {
        match self {
            Self::Method => "method",
            Self::Host => "host",
            Self::CrossSite => "cross-site",
            Self::Target => "target",
            Self::Crowded => "crowded",
        }
    }

    /// Its status.
    pub fn status(self) -> StatusCode {
        match self {
            Self::Method => StatusCode::METHOD_NOT_ALLOWED,
            Self::Host => StatusCode::MISDIRECTED_REQUEST,
            Self::CrossSite => StatusCode::FORBIDDEN,
            Self::Target => StatusCode::URI_TOO_LONG,
            Self::Crowded => StatusCode::SERVICE_UNAVAILABLE,
        }
    }
}

/// Which requests are answered.
#[derive(Debug)]
pub struct Guard {
    address: SocketAddr,
    names: Vec<String>,
}

impl Guard {
    /// For a server at `address` that may be called by `names` too.
    pub fn new(address: SocketAddr, names: &[String]) -> Self {
        Self { address, names: names.iter().map(|name| without_port(name).to_ascii_lowercase()).collect() }
    }

    /// The address.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Whether a request may be answered.
    ///
    /// # Errors
    /// Why not.
    pub fn check<B>(&self, request: &Request<B>) -> Result<(), Refusal> {
        let target = request.uri();
        if !matches!(*request.method(), Method::GET | Method::HEAD) {
            return Err(Refusal::Method);
        }
        let length = target.path().len() + target.query().map_or(0, str::len);
        // The form with scheme and authority is for proxies, which this is not.
        if length > LONGEST_TARGET || target.authority().is_some() || !target.path().starts_with('/') {
            return Err(Refusal::Target);
        }
        let mut hosts = request.headers().get_all(HOST).iter();
        let host = hosts.next().and_then(|host| host.to_str().ok()).ok_or(Refusal::Host)?;
        if hosts.next().is_some() || !self.is_own(host) {
            return Err(Refusal::Host);
        }
        let header = |name: &str| request.headers().get(name).and_then(|value| value.to_str().ok());
        // A link that a person follows is not a script of another page.
        let is_followed = header("sec-fetch-mode") == Some("navigate") && header("sec-fetch-dest") == Some("document");
        match header("sec-fetch-site") {
            None | Some("same-origin" | "none") => Ok(()),
            Some(_) if is_followed => Ok(()),
            Some(_) => Err(Refusal::CrossSite),
        }
    }

    /// Whether a host is this server: any address, as an address cannot be made to resolve elsewhere; of names the known ones. The port is that
    /// of whoever passes requests on, such as a tunnel or a proxy.
    fn is_own(&self, host: &str) -> bool {
        let name = without_port(host).to_ascii_lowercase();
        let bare = name.strip_prefix('[').and_then(|name| name.strip_suffix(']')).unwrap_or(&name);
        bare.parse::<IpAddr>().is_ok() || name == "localhost" || self.names.contains(&name)
    }
}

/// A host without its port.
fn without_port(host: &str) -> &str {
    match host.rsplit_once(':') {
        Some((name, port)) if !port.is_empty() && port.bytes().all(|byte| byte.is_ascii_digit()) => name,
        _ => host,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn checked(host: &str, header: &[(&str, &str)]) -> Result<(), Refusal> {
        let guard = Guard::new("127.0.0.1:8080".parse().unwrap(), &["Lab-PC".to_owned()]);
        let mut request = Request::get("/").header(HOST, host);
        for (name, value) in header {
            request = request.header(*name, *value);
        }
        guard.check(&request.body(()).unwrap())
    }

    #[test]
    fn hosts_are_addresses_and_known_names_at_any_port() {
        for own in [
            "127.0.0.1:8080",
            "localhost:8080",
            "LOCALHOST:9000",
            "localhost",
            "[::1]:8080",
            "192.0.2.7:8080",
            "lab-pc:443",
            "lab-pc",
        ] {
            assert_eq!(checked(own, &[]), Ok(()), "{own}");
        }
        for foreign in ["evil.example:8080", "127.0.0.1.evil.example:8080", "", ":8080", "[::1:8080"] {
            assert_eq!(checked(foreign, &[]), Err(Refusal::Host), "{foreign}");
        }
    }

    #[test]
    fn scripts_of_other_sites_are_refused_and_links_are_not() {
        let own = "localhost:8080";
        assert_eq!(checked(own, &[("sec-fetch-site", "same-origin")]), Ok(()));
        for site in ["cross-site", "same-site", "?"] {
            assert_eq!(checked(own, &[("sec-fetch-site", site)]), Err(Refusal::CrossSite));
            assert_eq!(
                checked(own, &[("sec-fetch-site", site), ("sec-fetch-mode", "navigate"), ("sec-fetch-dest", "iframe")]),
                Err(Refusal::CrossSite)
            );
            let link = [("sec-fetch-site", site), ("sec-fetch-mode", "navigate"), ("sec-fetch-dest", "document")];
            assert_eq!(checked(own, &link), Ok(()));
        }
    }
}
