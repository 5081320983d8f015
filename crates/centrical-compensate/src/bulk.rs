//! Many readings at once: in place or from one array to another, in vectors, and on all cores where there is `std`.

mod columns;
mod outside;
mod rows;

pub use outside::Outside;
