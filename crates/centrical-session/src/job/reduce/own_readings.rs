//! Readings of two mountings at once: of a record that was copied or named twice the noise would count for half.

use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap};
use std::path::Path;

use centrical::reduction::{PlateauMean, RepeatedRests};
use centrical::uncertainty::Level;
use centrical::{Mounting, SetPoint};

use crate::error::{Error, Place};
use crate::experiment::Session;
use crate::reduced::{Reduced, ReducedPlateau};

/// The readings from which a mean was taken.
struct Readings<'a> {
    /// Hash of the bytes of the file.
    sha256: &'a str,
    file: &'a Path,
    /// From, to [s], the record's clock; without bounds of a table of rests.
    window: [f64; 2],
    /// Which mounting, or which `[[tumble]]` behind them, from 0.
    owner: usize,
}

/// Refuses readings that two mountings, or two `[[tumble]]`, have in common.
pub(super) fn refuse_shared_readings(session: &Session, reduced: &Reduced) -> Result<(), Error> {
    let mut all = readings(session, reduced);
    all.sort_by(|a, b| a.sha256.cmp(b.sha256).then(a.window[0].total_cmp(&b.window[0])));
    for pair in all.windows(2) {
        let (one, other) = (&pair[0], &pair[1]);
        if one.sha256 == other.sha256 && one.owner != other.owner && other.window[0] < one.window[1] {
            let (first, second) = if one.owner < other.owner { (one, other) } else { (other, one) };
            let found = format!("the readings of {}, {}", named(session, first), first.file.display());
            let expected = format!("readings of its own for {}", named(session, second));
            return Err(Error::content(second.file, Place::Whole, found, expected));
        }
    }
    Ok(())
}

/// Refuses rests that count twice; `file` is the last record or table of rests.
pub(crate) fn refuse_repeated_rests(session: &Session, reduced: &Reduced, file: &Path) -> Result<(), Error> {
    let set_points = session.experiment.set_points.iter().zip(&reduced.plateaus);
    let is_rest = |set_point: &SetPoint| !session.experiment.is_on_arm(set_point.mounting);
    let rests: Vec<&ReducedPlateau> =
        set_points.filter(|(set_point, _)| is_rest(set_point)).map(|(_, plateau)| plateau).collect();
    // White noise is too much where the noise is blue, or a table hums.
    let least_noise = |plateau: &ReducedPlateau| {
        let white = plateau.seen.as_ref().map(|seen| seen.white_variance).unwrap_or_default();
        white.inf(&plateau.covariance.diagonal()).map(f64::sqrt)
    };
    let means: Vec<_> = rests.iter().map(|plateau| (plateau.mean, least_noise(plateau))).collect();
    let Some(RepeatedRests { first: (earlier, later), count }) = RepeatedRests::among(&means) else { return Ok(()) };
    let named = |rest: usize| {
        let at = rests[rest].window().map_or_else(String::new, |[from, _]| format!(" at {from:.1} s"));
        format!("rest {}{at}", rest + 1)
    };
    let found = format!(
        "the readings of earlier rests in {count} others, in {} first those of {}",
        named(later),
        named(earlier)
    );
    Err(Error::content(file, Place::Whole, found, "readings of its own for each rest: a record counts once"))
}

/// Refuses records of one mounting whose means are more alike than the noise allows: copies that were trimmed, shifted or rounded. The `means` of
/// the first `count` mountings are asked for where two of these have the same schedule. Among records of the same schedule, neighbours in the
/// order of their largest mean are compared.
pub(crate) fn refuse_copies<'m>(
    session: &Session,
    count: usize,
    means: &dyn Fn() -> Cow<'m, [Vec<PlateauMean>]>,
) -> Result<(), Error> {
    let experiment = &session.experiment;
    let place = |mounting: &Mounting| -> Vec<u64> {
        std::iter::once(mounting.position as u64).chain(mounting.arm_y.iter().map(|r| r.to_bits())).collect()
    };
    let mut keys: Vec<Vec<u64>> = experiment.mountings.iter().take(count).map(place).collect();
    for set_point in &experiment.set_points {
        if let Some(key) = keys.get_mut(set_point.mounting) {
            key.extend([set_point.omega, set_point.angle].map(f64::to_bits));
        }
    }
    let mut alike: BTreeMap<Vec<u64>, Vec<usize>> = BTreeMap::new();
    for (number, key) in keys.into_iter().enumerate() {
        alike.entry(key).or_default().push(number);
    }
    let pairs: usize = alike.values().map(|numbers| numbers.len() - 1).sum();
    if pairs == 0 {
        return Ok(());
    }
    let means = means();
    for mut numbers in alike.into_values() {
        let size = |number: &usize| means[*number].iter().map(|mean| mean.mean.amax()).fold(0.0, f64::max);
        numbers.sort_by(|a, b| size(a).total_cmp(&size(b)));
        for pair in numbers.windows(2) {
            let (first, second) = (pair[0].min(pair[1]), pair[0].max(pair[1]));
            let chance =
                PlateauMean::chance_of_likeness(&means[first], &means[second]).map(|chance| pairs as f64 * chance);
            if let Some(chance) = chance.filter(|chance| Level::Objection.is_passed_by(*chance)) {
                let file = |number: usize| session.mountings[number].records.first().unwrap_or(&session.file);
                let chance = if chance > 0.0 { format!("of {chance:.0e}") } else { "below 1e-300".to_owned() };
                let found = format!(
                    "the readings of mounting {}, {}: two records have means so alike with a probability {chance}",
                    first + 1,
                    file(first).display()
                );
                let expected = format!("readings of its own for mounting {}", second + 1);
                return Err(Error::content(file(second), Place::Whole, found, expected));
            }
        }
    }
    Ok(())
}

fn readings<'a>(session: &'a Session, reduced: &'a Reduced) -> Vec<Readings<'a>> {
    let hashes: HashMap<&Path, &str> =
        session.files().into_iter().zip(&reduced.inputs).map(|(file, input)| (file, input.sha256.as_str())).collect();
    let arm = session.mountings.len();
    let of_rests = session
        .rest_tables
        .iter()
        .enumerate()
        .flat_map(|(n, table)| vec![(arm + n, table.files().next()); table.count()]);
    let of_mountings = session.mountings.iter().enumerate().map(|(n, files)| (n, files.records.first()));
    let owners: Vec<_> = of_mountings.chain(of_rests).collect();
    let set_points = session.experiment.set_points.iter().zip(&reduced.plateaus);
    let of_mean = set_points.filter_map(|(set_point, plateau)| {
        let (owner, file) = owners[set_point.mounting];
        let window = plateau.window().or_else(|| (owner >= arm).then_some([f64::NEG_INFINITY, f64::INFINITY]))?;
        let file = file?.as_path();
        Some(Readings { sha256: hashes.get(file)?, file, window, owner })
    });
    of_mean.collect()
}

fn named(session: &Session, readings: &Readings) -> String {
    match (readings.owner + 1).checked_sub(session.mountings.len()).filter(|number| *number > 0) {
        Some(number) => format!("[[tumble]] {number}"),
        None => format!("mounting {}", readings.owner + 1),
    }
}
