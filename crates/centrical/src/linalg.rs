//! Least squares by orthogonal factorisation, never by normal equations.

pub(crate) mod factor;
pub(crate) mod least_squares;
