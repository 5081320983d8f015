//! The macro of `pastey` under the name by which `pulp` calls it.

pub use pastey::paste;
