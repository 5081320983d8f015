//! The radii of the seats.
//!
//! Readings and speed show the radius of the proof mass along the arm. It differs from that of the reference point by the
//! place of the proof mass, which turns its sign from position to position. The mean over the mountings of a seat is that of
//! the seat to a few millimetres, and drawings have round numbers.

use super::attitude::Attitude;

/// What radii are rounded to [m].
const ROUND: f64 = 5e-3;

/// Without the same number of mountings in all positions: the relative gap between radii of two seats.
const GAP: f64 = 0.15;

/// The radius of the seat of every mounting [m], from the radii of the proof masses along the arm.
pub(super) fn seats(attitudes: &[Option<Attitude>], radii: &[Option<f64>]) -> Vec<Option<f64>> {
    let seen: Vec<usize> = (0..radii.len()).filter(|&m| radii[m].is_some() && attitudes[m].is_some()).collect();
    let radius = |m: usize| radii[m].unwrap_or_default();
    let fellows = |m: usize| seen.iter().filter(move |&&n| attitudes[n] == attitudes[m]);
    let rank = |m: usize| fellows(m).filter(|&&n| (radius(n), n) < (radius(m), m)).count();
    let is_regular = seen.iter().all(|&m| fellows(m).count() == fellows(seen[0]).count());
    let groups = if is_regular { seen.iter().map(|&m| rank(m)).collect() } else { by_gaps(&seen, radius) };
    let mut seats = vec![None; radii.len()];
    for (&m, group) in seen.iter().zip(&groups) {
        let same: Vec<f64> = seen.iter().zip(&groups).filter(|(_, g)| *g == group).map(|(&n, _)| radius(n)).collect();
        let mean = same.iter().sum::<f64>() / same.len() as f64;
        seats[m] = Some((mean / ROUND).round() * ROUND);
    }
    seats
}

/// Groups of radii that follow each other without a gap.
fn by_gaps(seen: &[usize], radius: impl Fn(usize) -> f64) -> Vec<usize> {
    let mut sorted: Vec<usize> = (0..seen.len()).collect();
    sorted.sort_by(|&a, &b| radius(seen[a]).total_cmp(&radius(seen[b])));
    let mut groups = vec![0; seen.len()];
    for pair in sorted.windows(2) {
        let (small, large) = (radius(seen[pair[0]]), radius(seen[pair[1]]));
        groups[pair[1]] = groups[pair[0]] + usize::from(large - small > GAP * large);
    }
    groups
}
