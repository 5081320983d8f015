//! The address that a server listens at.

use std::io::ErrorKind;
use std::net::{TcpListener, ToSocketAddrs};
use std::path::Path;

use centrical_session::{Error, Place};

/// Listens at `address`.
///
/// # Errors
/// [`Error`] with the address, what was found and what was expected.
pub fn bound(address: &str) -> Result<TcpListener, Error> {
    let expected = "an address and a port of this machine, such as 127.0.0.1:8080";
    let refused = |found: &str, expected: &str| refused(address, found, expected);
    let mut addresses = address.to_socket_addrs().map_err(|_| refused("no address with a port", expected))?;
    let first = addresses.next().ok_or_else(|| refused("no address with a port", expected))?;
    TcpListener::bind(first).map_err(|error| match error.kind() {
        ErrorKind::AddrInUse => refused("a port in use by another program", "a free port, or port 0 for any"),
        ErrorKind::PermissionDenied => refused("a port that only the administrator may open", "a port of 1024 or more"),
        _ => refused(&error.to_string(), expected),
    })
}

/// The error of an address, with what was found and what was expected of it.
pub fn refused(address: &str, found: &str, expected: &str) -> Error {
    let place = format!("--serve {address}");
    Error::content(Path::new(&place), Place::Whole, found, expected)
}
