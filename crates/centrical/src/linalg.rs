//! Least squares by orthogonal factorisation, never by normal equations.

pub mod least_squares;
