//! Binary formats: columns of numbers, a block of rows of each at a time.

mod arrays;
pub(crate) mod arrow;
mod columnar;
#[cfg(feature = "hdf5")]
pub(crate) mod hdf5;
pub(crate) mod mat;
pub(crate) mod npy;
mod panics;
pub(crate) mod parquet;
