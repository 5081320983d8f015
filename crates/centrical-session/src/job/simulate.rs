//! A session as a laboratory would deliver it, of a unit whose truth is known.

mod session;
mod session_text;

pub use self::session::simulate_session;
