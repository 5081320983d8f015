//! Numbers that independent programs compute.

mod generated_code;
#[path = "../../../centrical/tests/common/random.rs"]
mod random;
