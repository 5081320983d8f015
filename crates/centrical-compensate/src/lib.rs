//! From a unit's readings back to specific force: the inverse of the error model, without `std` or allocation.
//!
//! # Conventions
//! - A reading is `f' = f + E(f)`, `E(f)` a sum of monomial [`Term`]s [K4.1], [K4.2]; three newtonometers, instrument
//!   axes, m/s^2 throughout.
//! - [`Compensation::new`] certifies that the inverse is unique over the range asked for, by bounds on the
//!   coefficients alone; only then are readings inverted. A reading that no force within the range gives is refused.
//! - The result is exact to rounding: the remainder of Newton's iteration is below the last place of the range.
//! - One reading or many, one thread or all, narrow vectors or wide, with `std` or without: the same bytes.
//!
//! ```
//! use centrical_compensate::{Compensation, Term, reading};
//!
//! // A scale error of 0.1 % on axis 1, and 2e-6 s^2/m of its square.
//! let terms = [Term::power(0, 0, 1, 1e-3), Term::power(0, 0, 2, 2e-6)];
//! let compensation = Compensation::new(&terms, 2000.0)?;
//! let f = compensation.apply(reading(&terms, [9.81, 0.0, -150.0]))?;
//! assert!((f[0] - 9.81).abs() < 1e-14);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![no_std]
#![allow(
    clippy::inline_always,
    reason = "what is not inlined into the function with the wide vectors is compiled for the narrow ones"
)]

#[cfg(feature = "std")]
extern crate std;

mod bulk;
mod certificate;
mod compensation;
mod error;
mod inverse;
mod linear;
mod model;
mod monomial;
mod separable;
mod term;
mod vectors;

pub use bulk::Outside;
pub use certificate::{Certificate, GAIN_CHANGE_LIMIT, START_REGION};
pub use compensation::Compensation;
pub use error::{NotInvertible, OutOfRange, UnequalLengths, UnequalRows};
pub use linear::Linear;
pub use monomial::Monomial;
pub use term::{Term, gain, reading};
