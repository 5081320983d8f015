//! Damaged and mutated files through every parser of the crate; those of tables are tried where they are.

#[path = "../../../centrical-table/tests/fuzz/fuzz.rs"]
mod fuzz;
#[path = "../../../centrical-table/tests/fuzz/mutate.rs"]
mod mutate;
mod parsers;
#[path = "../../../centrical-table/tests/fuzz/random.rs"]
mod random;

use parsers::parsers;

#[test]
#[ignore = "takes half a minute: a job of its own"]
fn mutated_files_are_read_or_refused() {
    fuzz::mutate_for(20, parsers());
}

#[test]
fn damaged_files_are_read_or_refused() {
    fuzz::try_kept(parsers());
}
