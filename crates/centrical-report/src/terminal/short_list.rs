//! Lists that are cut short.

/// The first `most` of `names`, and the number of the others.
pub fn short_list(names: &[String], most: usize, between: &str) -> String {
    let first = names.iter().take(most).map(String::as_str).collect::<Vec<_>>().join(between);
    if names.len() > most { format!("{first} and {} more", names.len() - most) } else { first }
}
