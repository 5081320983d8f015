//! Numbers that independent programs compute.

mod generated_code;
