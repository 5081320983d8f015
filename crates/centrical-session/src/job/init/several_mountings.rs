//! A file of several mountings: a session has one record a mounting, in which the arm pulls in one direction of the unit.

use super::sighting::{NOMINAL_RATE, SeenMounting, SeenPlateau};
use crate::error::{Error, Place};

/// Cosine of the angle between pulls of one mounting at least; gravity, which is not always known, turns them a little.
const ALIKE: f64 = 0.5;

/// Part of the largest pull that shows a direction.
const STRONG: f64 = 0.5;

/// Times that a message names.
const MOST: usize = 20;

/// Refuses a record in which the arm pulls in several directions of the unit, one after the other.
///
/// # Errors
/// [`Error`] with the times at which the file may be split.
pub(super) fn refuse(mounting: &SeenMounting) -> Result<(), Error> {
    let splits = splits(&mounting.plateaus);
    let Some(record) = mounting.records().next().filter(|_| !splits.is_empty()) else { return Ok(()) };
    let time = |t: &f64| if mounting.is_counted { format!("{:.0}", t * NOMINAL_RATE) } else { format!("{t:.0} s") };
    let mut times: Vec<String> = splits.iter().take(MOST).map(time).collect();
    if splits.len() > MOST {
        times.push("and so on".to_owned());
    }
    let unit = if mounting.is_counted { "sample " } else { "" };
    let found =
        format!("several mountings: the arm pulls in {} directions of the unit, one after the other", splits.len() + 1);
    let expected = format!(
        "a file for each mounting, and one of its telemetry: split them at rest, at about {unit}{}, and where only the seat was changed",
        times.join(", ")
    );
    Err(Error::content(record, Place::Whole, found, expected))
}

/// The times halfway between pulls in different directions. Strong pulls show that there are two.
fn splits(plateaus: &[SeenPlateau]) -> Vec<f64> {
    let pulls = pulls(plateaus);
    let largest = pulls.iter().map(|(_, pull)| norm(pull)).fold(0.0, f64::max);
    let strong: Vec<usize> = (0..pulls.len()).filter(|&n| norm(&pulls[n].1) > STRONG * largest).collect();
    let is_alike = |n: usize, m: usize| {
        let (a, b) = (&pulls[n].1, &pulls[m].1);
        a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>() >= ALIKE * norm(a) * norm(b)
    };
    let between = |pair: &[usize]| {
        let [before, after] = [pair[0], pair[1]];
        let last = (before..after).rev().find(|&n| is_alike(n, before)).unwrap_or(before);
        let first = (last + 1..after).find(|&n| is_alike(n, after)).unwrap_or(after);
        f64::midpoint(pulls[last].0[1], pulls[first].0[0])
    };
    strong.windows(2).filter(|pair| !is_alike(pair[0], pair[1])).map(between).collect()
}

/// Windows and pulls of the plateaus: what readings have beside those at rest; without speeds the readings, where some are many times
/// those at rest.
fn pulls(plateaus: &[SeenPlateau]) -> Vec<([f64; 2], [f64; 3])> {
    /// The largest reading beside gravity.
    const MANY: f64 = 5.0;
    let seen = || plateaus.iter().filter_map(|plateau| Some((plateau, plateau.readings?)));
    let rests: Vec<[f64; 3]> = seen().filter(|(plateau, _)| plateau.is_rest() == Some(true)).map(|(_, f)| f).collect();
    if rests.is_empty() {
        let norms = || seen().map(|(_, f)| norm(&f));
        let is_shown = norms().fold(0.0, f64::max) > MANY * norms().fold(f64::INFINITY, f64::min);
        return seen().filter(|_| is_shown).map(|(plateau, f)| (plateau.window, f)).collect();
    }
    let at_rest = [0, 1, 2].map(|j| rests.iter().map(|rest| rest[j]).sum::<f64>() / rests.len() as f64);
    let spinning = seen().filter(|(plateau, _)| plateau.is_rest() == Some(false));
    spinning.map(|(plateau, f)| (plateau.window, [0, 1, 2].map(|j| f[j] - at_rest[j]))).collect()
}

fn norm(f: &[f64; 3]) -> f64 {
    f.iter().map(|f| f * f).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Plateaus of 10 s, each a speed [rad/s] and readings.
    fn plateaus(of: &[(f64, [f64; 3])], has_speeds: bool) -> Vec<SeenPlateau> {
        let plateau = |(k, (speed, readings)): (usize, &(f64, [f64; 3]))| SeenPlateau {
            window: [20.0 * k as f64, 20.0 * k as f64 + 10.0],
            speed: has_speeds.then_some([*speed, 1e-3]),
            readings: Some(*readings),
        };
        of.iter().enumerate().map(plateau).collect()
    }

    #[test]
    fn a_pull_in_another_direction_is_another_mounting() {
        const G: f64 = 9.8;
        // An offset, as of counts, is in all readings.
        for offset in [0.0, 1e4] {
            let seen = |f: [f64; 3]| f.map(|f| f + offset);
            let one = [(0.0, seen([0.0, 0.0, G])), (20.0, seen([-200.0, 0.0, G])), (10.0, seen([-50.0, 0.0, G]))];
            let other = [(20.0, seen([G, -200.0, 0.0])), (-20.0, seen([G, -200.0, 0.0])), (0.0, seen([G, 0.0, 0.0]))];
            let back = [(20.0, seen([200.0, 0.0, G]))];
            // Slower, or on another seat.
            let weak = [(5.0, seen([-40.0, 0.0, G]))];
            assert_eq!(splits(&plateaus(&one, true)), [0.0; 0]);
            assert_eq!(splits(&plateaus(&[one.as_slice(), &other].concat(), true)), [55.0]);
            assert_eq!(splits(&plateaus(&[one.as_slice(), &other, &back].concat(), true)), [55.0, 105.0]);
            assert_eq!(splits(&plateaus(&[one.as_slice(), &weak, &other].concat(), true)), [75.0]);
            // Without speeds an offset hides it.
            let expected = if offset > 0.0 { vec![] } else { vec![55.0] };
            assert_eq!(splits(&plateaus(&[one.as_slice(), &other].concat(), false)), expected);
        }
        // Of a slow arm gravity is large, and pulls are along one line.
        let slow = [(0.0, [0.0, 0.0, G]), (3.0, [-G, 0.0, G]), (5.0, [-2.0 * G, 0.0, G]), (0.0, [0.0, 0.0, G])];
        for has_speeds in [true, false] {
            assert_eq!(splits(&plateaus(&slow, has_speeds)), [0.0; 0]);
        }
    }
}
