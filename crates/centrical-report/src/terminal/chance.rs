//! Probabilities.

/// A probability to three places, a small one as [`chance`] has it.
pub fn chance_to_three_places(probability: f64) -> String {
    if probability < 1e-3 { chance(probability) } else { format!("{probability:.3}") }
}

/// A probability as a person reads it; a small one may be too small for a number.
pub fn chance(probability: f64) -> String {
    match probability {
        0.01.. => format!("{probability:.2}"),
        1e-300.. => format!("{probability:.1e}"),
        _ => "below 1e-300".to_owned(),
    }
}
