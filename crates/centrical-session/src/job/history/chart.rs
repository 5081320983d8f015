//! Control charts of one parameter over sessions.

use std::borrow::Borrow;

use centrical::history::{Control, Rule};

use super::calibrated::{Calibrated, Finder};
use super::no_history::{FEWEST, NoHistory};
use crate::document::{CHART_SCHEMA, ChartReport, ChartRule, ChartSignal, Program};

/// The rules of single values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum RuleSet {
    /// The eight rules of L. S. Nelson (1984).
    #[default]
    Nelson,
    /// The four rules of the Western Electric handbook (1956).
    WesternElectric,
}

/// Where the limits of a chart come from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ChartLimits {
    /// From the first acceptable sessions, by their number.
    Accepted(usize),
    /// Stated: mean and standard deviation, SI.
    Stated(f64, f64),
}

/// The request for control charts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChartRequest {
    /// Where their limits come from.
    pub limits: ChartLimits,
    /// The rules of single values.
    pub rules: RuleSet,
    /// The last sessions that the report has; all if absent. Limits, means and sums are of all.
    pub last: Option<usize>,
}

/// Weight of the newest value, and limits in standard deviations: one false signal in 370 values.
const EWMA: (f64, f64) = (0.2, 2.86);

/// Reference value and decision interval in standard deviations: one false signal in 370 values.
const CUSUM: (f64, f64) = (0.5, 4.77);

/// The charts of parameter `name` over `calibrations` of one model of units at one station, in the order of time.
///
/// # Errors
/// As [`chart`], and for calibrations of several models or stations.
pub fn chart_of_one(calibrations: &[Calibrated], name: &str, request: ChartRequest) -> Result<ChartReport, NoHistory> {
    NoHistory::refuse_several_models(calibrations.iter())?;
    NoHistory::refuse_several_stations(calibrations.iter())?;
    chart(calibrations, name, request)
}

/// The charts of parameter `name` over `calibrations`, in the order of time.
///
/// # Errors
/// [`NoHistory`] when no session determines the parameter, or limits cannot be had.
pub fn chart(
    calibrations: &[impl Borrow<Calibrated>],
    name: &str,
    request: ChartRequest,
) -> Result<ChartReport, NoHistory> {
    let mut finder = Finder::new(name);
    let all = calibrations.iter().map(Borrow::borrow);
    let of: Vec<(&Calibrated, usize)> = all.filter_map(|c| Some((c, finder.place(c)?))).collect();
    let mut values: Vec<f64> = of.iter().map(|(c, place)| c.values[*place]).collect();
    let Some((one, place)) = of.first() else { return Err(NoHistory::Unknown(name.to_owned())) };
    let (control, accepted) = match request.limits {
        ChartLimits::Stated(centre, deviation) => (Control { centre, deviation }, 0),
        ChartLimits::Accepted(expected) => {
            let acceptable = of.iter().zip(&values).filter(|((c, _), _)| c.acceptable).map(|(_, value)| *value);
            let accepted: Vec<f64> = acceptable.take(expected).collect();
            if accepted.len() < expected.max(FEWEST) {
                return Err(NoHistory::TooFew { found: accepted.len(), expected });
            }
            (Control::of(&accepted).ok_or(NoHistory::Equal(accepted.len()))?, accepted.len())
        }
    };
    let ranges = Control::moving_ranges(&values);
    let (mut means, mut sums) = (control.ewma(&values, EWMA.0, EWMA.1), control.cusum(&values, CUSUM.0, CUSUM.1));
    let beyond = ranges.iter().enumerate().filter(|(_, range)| **range > control.range_limit()).map(|(n, _)| n + 1);
    let named = |rule: ChartRule, words| move |session| ChartSignal { session, rule, words };
    let mut all: Vec<ChartSignal> = single_values(&values, control, request.rules);
    all.extend(beyond.map(named(ChartRule::MovingRange, "a step beyond the limit of the moving range")));
    all.extend(means.signals.iter().copied().map(named(ChartRule::Ewma, "the weighted mean is beyond its limits")));
    all.extend(sums.signals.iter().copied().map(named(ChartRule::Cusum, "the cumulative sum is beyond its limit")));
    all.sort_by_key(|signal| signal.session);
    let first = values.len() - request.last.unwrap_or(values.len()).min(values.len());
    let all = all.into_iter().filter(|signal| signal.session >= first);
    let all = all.map(|signal| ChartSignal { session: signal.session - first, ..signal }).collect();
    Ok(ChartReport {
        schema: CHART_SCHEMA,
        program: Program::this(),
        name: name.to_owned(),
        unit: one.parameters[*place].unit.clone(),
        group: one.parameters[*place].group,
        accepted,
        centre: control.centre,
        deviation: control.deviation,
        limits: control.limits(),
        range_limit: control.range_limit(),
        sessions: of[first..].iter().map(|(calibrated, _)| calibrated.past()).collect(),
        ranges: ranges.get(first..).unwrap_or_default().to_vec(),
        values: values.split_off(first),
        ewma: means.means.split_off(first),
        ewma_half_widths: means.half_widths.split_off(first),
        cusum_upper: sums.upper.split_off(first),
        cusum_lower: sums.lower.split_off(first),
        cusum_limit: CUSUM.1,
        signals: all,
    })
}

fn single_values(values: &[f64], control: Control, rules: RuleSet) -> Vec<ChartSignal> {
    let (named, rules): (fn(usize) -> ChartRule, _) = match rules {
        RuleSet::Nelson => (ChartRule::Nelson, Rule::NELSON.as_slice()),
        RuleSet::WesternElectric => (ChartRule::WesternElectric, Rule::WESTERN_ELECTRIC.as_slice()),
    };
    let number = |rule: Rule| 1 + rules.iter().position(|other| *other == rule).unwrap_or_default();
    let signal =
        |(session, rule): (usize, Rule)| ChartSignal { session, rule: named(number(rule)), words: rule.words() };
    control.signals(values, rules).into_iter().map(signal).collect()
}
