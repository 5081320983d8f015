//! Our own output, pinned: it detects change and proves nothing.

#[path = "../../examples/rank_table.rs"]
mod rank_table;

/// The document shows the table as it is computed.
#[test]
fn document_shows_the_rank_table() {
    let document = include_str!("../../../../docs/source-and-findings.md");
    assert!(document.contains(&rank_table::table()), "{}", rank_table::table());
}
