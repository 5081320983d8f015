//! The server: it listens, holds every request to its limits, and sends what a site answers.

mod events;
mod guard;
mod metrics;
mod response;

use std::convert::Infallible;
use std::io::ErrorKind;
use std::net::{TcpListener, ToSocketAddrs};
use std::path::Path;
use std::sync::Arc;
use std::thread;
use std::time::Duration;

use centrical_session::{Error, Place};
use hyper::body::Incoming;
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper::{Method, Request, Response};
use hyper_util::rt::{TokioIo, TokioTimer};
use tokio::runtime::Builder;
use tokio::sync::{Semaphore, oneshot};
use tokio::time::timeout;

use self::events::Events;
use self::guard::Guard;
use self::metrics::Metrics;
use self::response::{Body, answered, refused, with_metrics};
use crate::site::{Query, Site};

/// Connections at a time.
const CONNECTIONS: usize = 256;

/// Time for the head of a request, and between two requests of a connection.
const HEAD_TIME: Duration = Duration::from_secs(10);

/// Longest head of a request [bytes].
const LONGEST_HEAD: usize = 16 << 10;

/// Headers of a request.
const MOST_HEADERS: usize = 64;

/// Life of a connection: a viewer that never reads loses it, and a browser opens the next one by itself.
const LIFE: Duration = Duration::from_secs(3600);

/// A server that is bound to its address and not yet started.
#[derive(Debug)]
pub struct Server {
    listener: TcpListener,
    guard: Guard,
}

impl Server {
    /// Binds to `address`, such as `127.0.0.1:8080`. Requests have to name an address, `localhost` or one of `names` as their
    /// host, so that a foreign name that resolves to this machine sees nothing.
    ///
    /// # Errors
    /// [`Error`] when the address is invalid, is in use, or may not be opened.
    pub fn bind(address: &str, names: &[String]) -> Result<Self, Error> {
        let listener = bound(address)?;
        let at = listener.local_addr().map_err(|error| failed(address, &error))?;
        Ok(Self { listener, guard: Guard::new(at, names) })
    }

    /// The address of the page.
    pub fn url(&self) -> String {
        format!("http://{}/", self.guard.address())
    }

    /// Whether other machines may reach it.
    pub fn is_open(&self) -> bool {
        !self.guard.address().ip().is_loopback()
    }

    /// Serves `site` on a thread of its own, until the program ends.
    ///
    /// # Errors
    /// [`Error`] when the system has no further thread.
    pub fn start(self, site: impl Site) -> Result<(), Error> {
        std::mem::forget(self.begin(site)?);
        Ok(())
    }

    /// Serves `site` on a thread of its own, until the value that is given is dropped.
    ///
    /// # Errors
    /// As [`Server::start`].
    pub fn begin(self, site: impl Site) -> Result<Running, Error> {
        let Self { listener, guard } = self;
        let address = guard.address().to_string();
        let failed = |error: std::io::Error| failed(&address, &error);
        listener.set_nonblocking(true).map_err(failed)?;
        let runtime = Builder::new_current_thread().enable_all().build().map_err(failed)?;
        let (running, ended) = oneshot::channel();
        let serve = move || {
            runtime.block_on(async move {
                // It was bound, so that the runtime takes it.
                if let Ok(listener) = tokio::net::TcpListener::from_std(listener) {
                    tokio::spawn(accept(listener, Arc::new(Host::new(site, guard))));
                    // The sender says nothing: it goes.
                    let _ = ended.await;
                }
            });
        };
        thread::Builder::new().name("centrical live".to_owned()).spawn(serve).map_err(failed)?;
        Ok(Running { _running: running })
    }
}

/// A server that runs until this is dropped.
#[derive(Debug)]
pub struct Running {
    _running: oneshot::Sender<Infallible>,
}

/// What all connections share.
struct Host<S> {
    site: Arc<S>,
    guard: Guard,
    metrics: Metrics,
    events: Events,
}

impl<S: Site> Host<S> {
    fn new(site: S, guard: Guard) -> Self {
        Self { site: Arc::new(site), guard, metrics: Metrics::default(), events: Events::default() }
    }

    async fn answer(&self, request: Request<Incoming>) -> Response<Body> {
        self.metrics.request();
        if let Err(refusal) = self.guard.check(&request) {
            self.metrics.refused(refusal);
            return refused(refusal);
        }
        let is_head = request.method() == Method::HEAD;
        let query = Query::of(request.uri().query());
        match request.uri().path() {
            "/events" if self.site.has_panel() && !is_head => response::events(self.events.subscribe(query.language())),
            "/metrics" => with_metrics(&self.metrics.text(self.site.metrics()), is_head),
            path => {
                // A report takes some ten milliseconds: the events of others go on.
                let (site, path, language) = (Arc::clone(&self.site), path.to_owned(), query.language());
                let answer = tokio::task::spawn_blocking(move || site.answer(&path, &query)).await;
                answered(answer.ok().flatten(), language, is_head)
            }
        }
    }
}

async fn accept<S: Site>(listener: tokio::net::TcpListener, host: Arc<Host<S>>) {
    let places = Arc::new(Semaphore::new(CONNECTIONS));
    tokio::spawn(events::follow(Arc::clone(&host.site), host.events.clone()));
    loop {
        let Ok((stream, _)) = listener.accept().await else {
            // Out of file descriptors: others will be closed.
            tokio::time::sleep(Duration::from_millis(100)).await;
            continue;
        };
        let Ok(place) = Arc::clone(&places).try_acquire_owned() else {
            host.metrics.refused(guard::Refusal::Crowded);
            continue;
        };
        let host = Arc::clone(&host);
        tokio::spawn(async move {
            let _place = place;
            host.metrics.connection(1);
            let service = service_fn(|request| async { Ok::<_, Infallible>(host.answer(request).await) });
            let mut http = http1::Builder::new();
            http.timer(TokioTimer::new()).header_read_timeout(HEAD_TIME).max_buf_size(LONGEST_HEAD);
            http.max_headers(MOST_HEADERS).half_close(false);
            let served = timeout(LIFE, http.serve_connection(TokioIo::new(stream), service)).await;
            if let Ok(Err(error)) = served {
                host.metrics.broken(&error);
            }
            host.metrics.connection(-1);
        });
    }
}

fn failed(address: &str, error: &std::io::Error) -> Error {
    unusable(address, &error.to_string(), "an address of this machine")
}

/// Listens at `address`.
fn bound(address: &str) -> Result<TcpListener, Error> {
    let expected = "an address and a port of this machine, such as 127.0.0.1:8080";
    let refused = |found: &str, expected: &str| unusable(address, found, expected);
    let mut addresses = address.to_socket_addrs().map_err(|_| refused("no address with a port", expected))?;
    let first = addresses.next().ok_or_else(|| refused("no address with a port", expected))?;
    TcpListener::bind(first).map_err(|error| match error.kind() {
        ErrorKind::AddrInUse => refused("a port in use by another program", "a free port, or port 0 for any"),
        ErrorKind::PermissionDenied => refused("a port that only the administrator may open", "a port of 1024 or more"),
        _ => refused(&error.to_string(), expected),
    })
}

/// The error of an address, with what was found and what was expected of it.
fn unusable(address: &str, found: &str, expected: &str) -> Error {
    let place = format!("--serve {address}");
    Error::content(Path::new(&place), Place::Whole, found, expected)
}
