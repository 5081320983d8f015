//! Responses, with what keeps a page to itself.

use std::convert::Infallible;
use std::sync::Arc;

use centrical_report::{Language, not_found};
use http_body_util::combinators::UnsyncBoxBody;
use http_body_util::{BodyExt, Full, StreamBody};
use hyper::body::{Bytes, Frame};
use hyper::header::{ALLOW, CACHE_CONTROL, CONTENT_LENGTH, CONTENT_SECURITY_POLICY, CONTENT_TYPE, HeaderValue};
use hyper::http::response::Builder;
use hyper::{Response, StatusCode};
use tokio::sync::watch::Receiver;
use tokio_stream::StreamExt;
use tokio_stream::wrappers::WatchStream;

use super::guard::Refusal;
use crate::site::Answer;

/// What is sent.
pub type Body = UnsyncBoxBody<Bytes, Infallible>;

/// Nothing from elsewhere, no script but the page's own file; styles stand in the drawings too.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; connect-src 'self'; img-src 'self' data:; \
                      form-action 'self'; base-uri 'none'; frame-ancestors 'none'";

/// Of a report or a page of a store, which is one file with its style and any script in it.
const POLICY_OF_DOCUMENT: &str = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:; \
                                  form-action 'none'; base-uri 'none'; frame-ancestors 'none'";

/// The answer of a site; without one, "not found" in the language that is asked for.
pub fn answered(answer: Option<Answer>, language: Language, is_head: bool) -> Response<Body> {
    match answer {
        Some(Answer::Page(text)) => whole(begun(StatusCode::OK, POLICY), "text/html; charset=utf-8", text, is_head),
        Some(Answer::Document(text)) => {
            whole(begun(StatusCode::OK, POLICY_OF_DOCUMENT), "text/html; charset=utf-8", text, is_head)
        }
        Some(Answer::File(media_type, text)) => whole(begun(StatusCode::OK, POLICY), media_type, text, is_head),
        Some(Answer::Failed(text)) => {
            whole(begun(StatusCode::SERVICE_UNAVAILABLE, POLICY), "text/plain; charset=utf-8", text + "\n", is_head)
        }
        None => {
            let text = format!("{}\n", not_found(language));
            whole(begun(StatusCode::NOT_FOUND, POLICY), "text/plain; charset=utf-8", text, is_head)
        }
    }
}

/// Metrics.
pub fn with_metrics(text: &str, is_head: bool) -> Response<Body> {
    whole(begun(StatusCode::OK, POLICY), "text/plain; version=0.0.4; charset=utf-8", text.to_owned(), is_head)
}

/// A refusal.
pub fn refused(refusal: Refusal) -> Response<Body> {
    let mut builder = begun(refusal.status(), POLICY).header("connection", "close");
    if refusal == Refusal::Method {
        builder = builder.header(ALLOW, "GET, HEAD");
    }
    let remedy = match refusal {
        Refusal::Host => ", expected an address, localhost or a name of --serve-name",
        Refusal::Method | Refusal::CrossSite | Refusal::Target | Refusal::Crowded => "",
    };
    whole(builder, "text/plain; charset=utf-8", format!("refused: {}{remedy}\n", refusal.label()), false)
}

/// The events of a panel, the newest first.
pub fn events(panels: Receiver<Arc<str>>) -> Response<Body> {
    let newest = WatchStream::new(panels).filter(|panel| !panel.is_empty());
    let frames = newest.map(|panel| Ok(Frame::data(Bytes::from(panel.as_bytes().to_vec()))));
    built(
        begun(StatusCode::OK, POLICY).header(CONTENT_TYPE, "text/event-stream"),
        StreamBody::new(frames).boxed_unsync(),
    )
}

fn begun(status: StatusCode, policy: &'static str) -> Builder {
    Response::builder()
        .status(status)
        .header(CONTENT_SECURITY_POLICY, policy)
        .header(CACHE_CONTROL, "no-store")
        .header("x-content-type-options", "nosniff")
        .header("x-frame-options", "DENY")
        .header("cross-origin-resource-policy", "same-origin")
        .header("referrer-policy", "no-referrer")
}

fn whole(builder: Builder, media_type: &'static str, text: String, is_head: bool) -> Response<Body> {
    let builder = builder.header(CONTENT_TYPE, media_type).header(CONTENT_LENGTH, HeaderValue::from(text.len()));
    built(builder, Full::new(if is_head { Bytes::new() } else { Bytes::from(text) }).boxed_unsync())
}

fn built(builder: Builder, body: Body) -> Response<Body> {
    // The headers are constants: they are valid.
    builder.body(body).unwrap_or_default()
}
