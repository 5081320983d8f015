//! Least squares by orthogonal factorisation, never by normal equations.
//!
//! - [`least_squares`]: all equations at once, unknowns that few contain before; the fit and all that is asked of it.
//! - [`factor`]: three equations more, by rotations, for weights of any range; the filter.
//! - [`fold`]: many equations more, by reflections, in the time that a search of plans has.

pub(crate) mod factor;
pub(crate) mod fold;
pub(crate) mod least_squares;
