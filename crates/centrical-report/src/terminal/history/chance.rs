//! Small probabilities.

/// A small probability, which may be too small for a number.
pub fn chance(probability: f64) -> String {
    if probability < 1e-300 { "below 1e-300".to_owned() } else { format!("{probability:.1e}") }
}
