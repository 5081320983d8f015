//! Rests in free attitudes as text for the terminal.

use centrical_session::{CalibrationResult, MICRO_G, PlateauSummary, Turning};

use super::screen::Screen;
use crate::language::next_rest_brings;
use crate::number::{counted, two_digits};

/// A lag that a filter or a recorder may well have [s].
const LAG: f64 = 0.1;

/// How many rests there are, how long they are, and how well the size of gravity is met in them.
pub(super) fn rests(screen: &mut Screen, result: &CalibrationResult) {
    let rests: Vec<&PlateauSummary> = result.rests().collect();
    if rests.is_empty() {
        return;
    }
    screen.gap();
    let known: Vec<f64> = result.model.positions.iter().filter_map(|position| position.attitude_uncertainty).collect();
    screen.head("TUMBLE", if known.is_empty() { "in attitudes that only gravity shows" } else { "" });
    found(screen, &rests, result.turning.as_ref());
    if !known.is_empty() {
        attitudes(screen, &known, rests.len());
    }
    if let Some(misfit) = GravityMisfit::of(&rests) {
        let [rms, worst] = [misfit.root_mean_square, misfit.largest].map(|size| size / MICRO_G);
        screen.say(2, &format!("size of the compensated force less gravity: {rms:.0} ug RMS, {worst:.0} ug at most"));
        if let Some(turning) = &result.turning {
            slow_rotation(screen, turning);
        }
        cautions(screen, result, !known.is_empty());
    }
    next_attitude(screen, result);
}

/// Number and lengths of the rests.
fn found(screen: &mut Screen, rests: &[&PlateauSummary], turning: Option<&Turning>) {
    let are_arcs = turning.is_some_and(|turning| turning.arcs == rests.len());
    let lengths = rest_lengths(rests);
    let lengths = lengths.map(|[shortest, longest]| format!(", of {shortest:.1} s to {longest:.1} s"));
    let count = counted(rests.len(), if are_arcs { "arc" } else { "rest" });
    screen.say(2, &format!("{count}{}", lengths.unwrap_or_default()));
    if let Some(least) = least_rest(rests) {
        screen.say(2, &format!("at this sampling rate a rest below {least:.1} s may be taken for motion"));
    }
}

/// Attitudes that are `known`, with their standard uncertainties [rad], of those of all rests.
fn attitudes(screen: &mut Screen, known: &[f64], all: usize) {
    let (low, high) = known.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), u| (low.min(*u), high.max(*u)));
    let degrees = |u: f64| format!("{:.2} deg", u.to_degrees());
    let uncertain = if low < high { format!("{} to {}", degrees(low), degrees(high)) } else { degrees(low) };
    let others = match all - known.len() {
        0 => String::new(),
        others => format!(", {others} in attitudes that only gravity shows"),
    };
    screen.say(2, &format!("{} in attitudes known to {uncertain}{others}", known.len()));
}

fn slow_rotation(screen: &mut Screen, turning: &Turning) {
    let text = format!(
        "{} of slow rotation, at {} deg/s and less, with {:.0} % of the weight; {} mm from its axes, where the acceleration along the vertical is uncertain by {} ug at most in an arc",
        counted(turning.arcs, "arc"),
        two_digits(turning.rate.to_degrees()),
        100.0 * turning.share,
        two_digits(1e3 * turning.radius),
        two_digits(turning.acceleration / MICRO_G)
    );
    screen.sentence(2, 4, &text);
    let shortened = two_digits(shortened_by_lag(turning) / 1e-6);
    let text = format!(
        "readings that lag by {LAG} s would be too small by {shortened} ppm at that rate; no uncertainty holds that"
    );
    screen.sentence(2, 4, &text);
}

/// What the residuals do not exclude, and what gravity does not show.
fn cautions(screen: &mut Screen, result: &CalibrationResult, has_known: bool) {
    if let Some(between) = &result.between_rests {
        let [scatter, drift] = [between.scatter, between.drift].map(|size| two_digits(size / MICRO_G));
        let text = format!(
            "not excluded, and in the uncertainties: scatter of {scatter} ug from rest to rest, biases that drift by {drift} ug"
        );
        screen.sentence(2, 4, &text);
    }
    // The size of gravity is the same for a triad and its mirror image.
    if !result.model.has_arm() && !result.attitudes_show_columns() {
        let shows = if has_known { "these attitudes, in any order, show" } else { "gravity shows" };
        screen.sentence(2, 4, &format!("{shows} neither the sign of an axis nor which column is which: check them"));
    }
}

/// Which attitude to add, and what it would bring.
fn next_attitude(screen: &mut Screen, result: &CalibrationResult) {
    let Some(next) = &result.next_attitude else { return };
    screen.sentence(2, 4, &format!("next rest: {}: {}", next.text, next_rest_brings(next)));
}

/// What the size of the compensated force misses of gravity, over the rests [m/s^2].
struct GravityMisfit {
    pub root_mean_square: f64,
    pub largest: f64,
}

impl GravityMisfit {
    /// That of `rests`; `None` of rests that do not determine the coefficients: they have no compensated force.
    fn of(rests: &[&PlateauSummary]) -> Option<Self> {
        let misfits: Vec<f64> = rests.iter().filter_map(|rest| misfit(rest)).collect();
        let square: f64 = misfits.iter().map(|misfit| misfit * misfit).sum();
        let largest = misfits.iter().fold(0.0_f64, |most, misfit| most.max(misfit.abs()));
        (!misfits.is_empty()).then(|| Self { root_mean_square: (square / misfits.len() as f64).sqrt(), largest })
    }
}

/// Residual along the specific force.
fn misfit(rest: &PlateauSummary) -> Option<f64> {
    let force = rest.specific_force?;
    let size = force.iter().map(|f| f * f).sum::<f64>().sqrt();
    Some(force.iter().zip(rest.residual).map(|(f, residual)| f / size * residual).sum())
}

/// The shortest and the longest rest [s]; `None` where none has a length.
fn rest_lengths(rests: &[&PlateauSummary]) -> Option<[f64; 2]> {
    let lengths = rests.iter().filter_map(|rest| rest.window).map(|[from, to]| to - from);
    let [shortest, longest] = lengths.fold([f64::INFINITY, 0.0], |[low, high]: [f64; 2], t| [low.min(t), high.max(t)]);
    (longest > 0.0).then_some([shortest, longest])
}

/// Rests that are sure to be found have four blocks of eight samples [s]; `None` where that is below the second that a rest has at least.
fn least_rest(rests: &[&PlateauSummary]) -> Option<f64> {
    const SAMPLES: f64 = 32.0;
    let spans = rests.iter().filter_map(|rest| Some((rest.window?, rest.samples.saturating_sub(1))));
    let (time, steps) = spans.fold((0.0, 0), |(time, all), ([from, to], steps)| (time + to - from, all + steps));
    Some(SAMPLES * time / steps as f64).filter(|least| *least > 1.0 && steps > 0)
}

/// By how much readings that lag by [`LAG`] are too small in slow rotation, relative: the size of a force that turns at a rate w is
/// shortened by `(w tau)^2 / 2` where readings lag by tau.
fn shortened_by_lag(turning: &Turning) -> f64 {
    0.5 * (turning.rate * LAG).powi(2)
}
