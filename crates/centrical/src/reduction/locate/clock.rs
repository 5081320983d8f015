//! The centrifuge's clock against the unit's, from the ramps that both recorded.

use std::ops::Range;

use crate::reduction::plateau::ScheduledPlateau;
use crate::reduction::survey::Blocks;
use crate::statistics::{MAD, median};

/// Telemetry of the centrifuge, on its own clock.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SpeedTrace {
    /// Time on the centrifuge's clock [s], not decreasing.
    pub t: Vec<f64>,
    /// Speed [rad/s], either sign.
    pub omega: Vec<f64>,
}

/// More passages than these are noise: a telemetry has a few for each ramp.
const MOST_PASSAGES: usize = 1000;

/// How the ramps of the telemetry agree with those of the record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClockAgreement {
    /// The unit's time less the centrifuge's: median over the ramps that agree, and its standard uncertainty from their scatter [s], infinite for
    /// a single ramp. `None` if no ramp is in both.
    pub offset: Option<[f64; 2]>,
    /// Ramps of the record in the time that the telemetry covers.
    pub ramps: usize,
    /// Ramps of the record that the telemetry has at the same time, up to the offset of the clocks.
    pub agreeing: usize,
    /// Speed of the telemetry over that of the schedule at which they agree: 1 unless the unit is wrong.
    pub scale: f64,
    /// Seconds of the record in a second of the telemetry at which they agree: 1 unless a clock is wrong.
    pub rate: f64,
    /// First and last time of the telemetry, the record's clock [s].
    pub span: [f64; 2],
}

impl ClockAgreement {
    /// Whether the telemetry is of this record: two of three ramps at least are in both, by clocks of the same rate.
    pub fn is_of_the_record(&self) -> bool {
        self.agreeing > 0 && 3 * self.agreeing >= 2 * self.ramps && self.rate == 1.0
    }
}

/// The offset of the clocks, and how far the ramps bear it out. Where fewer than half of the ramps agree, other units of
/// the speed and other rates of the clock are tried, and taken if most ramps agree then.
pub(super) fn compare(
    ramps: &[Ramp],
    width: f64,
    schedule: &[ScheduledPlateau],
    telemetry: &SpeedTrace,
) -> ClockAgreement {
    let (offset, agreeing) = self::offset(ramps, width, telemetry, 1.0);
    let mut best = (offset, 1.0, 1.0, agreeing);
    if 2 * best.3 < ramps.len() {
        let scaled = scale_of(schedule, telemetry).map(|scale| (scale, self::offset(ramps, width, telemetry, scale)));
        if let Some((scale, (offset, agreeing))) = scaled.filter(|(_, (_, agreeing))| *agreeing > best.3) {
            best = (offset, scale, 1.0, agreeing);
        }
    }
    if 2 * best.3 < ramps.len() {
        let stretched = rate_of(ramps, width, telemetry, best.1);
        if let Some((rate, agreeing)) = stretched.filter(|(_, n)| *n > best.3 && 4 * n >= 3 * ramps.len() && *n >= 3) {
            best = (None, best.1, rate, agreeing);
        }
    }
    let (offset, scale, rate, agreeing) = best;
    let shift = offset.map_or(0.0, |[seconds, _]| seconds);
    let span = [telemetry.t.first(), telemetry.t.last()].map(|t| rate * t.copied().unwrap_or(f64::NAN) + shift);
    let is_covered = |ramp: &&Ramp| rate != 1.0 || offset.is_none() || (span[0]..=span[1]).contains(&ramp.t);
    let covered = ramps.iter().filter(is_covered).count();
    ClockAgreement { offset, ramps: covered, agreeing, scale, rate, span }
}

/// Fastest speed of the telemetry, a lone report left out, over that of the schedule.
fn scale_of(schedule: &[ScheduledPlateau], telemetry: &SpeedTrace) -> Option<f64> {
    let fastest = schedule.iter().map(|p| p.omega.abs()).fold(0.0, f64::max);
    let neighbours =
        telemetry.omega.windows(3).map(|three| median(&mut [three[0].abs(), three[1].abs(), three[2].abs()]));
    let scale = neighbours.filter(|omega| omega.is_finite()).fold(0.0, f64::max) / fastest;
    (scale.is_finite() && scale > 0.0).then_some(scale)
}

/// The rate by which most ramps agree, and their number: from the first ramp and every later one.
fn rate_of(ramps: &[Ramp], width: f64, telemetry: &SpeedTrace, scale: f64) -> Option<(f64, usize)> {
    let passages = passages_of(ramps, telemetry, scale);
    let agree = |rate: f64, shift: f64| {
        let is_there =
            |(ramp, times): (&Ramp, &Vec<f64>)| times.iter().any(|t| (rate * t + shift - ramp.t).abs() < width);
        ramps.iter().zip(&passages).filter(|pair| is_there(*pair)).count()
    };
    let (first, last) = (0, ramps.len().checked_sub(1)?);
    if passages.iter().map(Vec::len).sum::<usize>() > MOST_PASSAGES {
        return None;
    }
    let pairs = passages[first].iter().flat_map(|a| passages[last].iter().map(move |b| (*a, *b)));
    let rates = pairs.filter(|(a, b)| b > a).map(|(a, b)| {
        let rate = (ramps[last].t - ramps[first].t) / (b - a);
        (rate, agree(rate, ramps[first].t - rate * a))
    });
    rates.max_by_key(|(_, agreeing)| *agreeing)
}

/// Estimates the offset: on every ramp the square of the speed, and with it the force, passes the middle between
/// two plateaus at one instant. `None` if no ramp of the record is in the telemetry. With it the number of ramps that agree.
fn offset(ramps: &[Ramp], width: f64, telemetry: &SpeedTrace, scale: f64) -> (Option<[f64; 2]>, usize) {
    let mut offsets = passages_of(ramps, telemetry, scale);
    for (ramp, offsets) in ramps.iter().zip(&mut offsets) {
        for passage in offsets.iter_mut() {
            *passage = ramp.t - *passage;
        }
    }
    // One passage may have several partners (the same speeds run twice): the right offset is the one most ramps have.
    let best = partners(&offsets, width).max_by(|(a, m), (b, n)| m.cmp(n).then(b.abs().total_cmp(&a.abs())));
    let Some((best, _)) = best else { return (None, 0) };
    let closest =
        |of_ramp: &Vec<f64>| of_ramp.iter().copied().min_by(|a, b| (a - best).abs().total_cmp(&(b - best).abs()));
    let mut agreeing: Vec<f64> = offsets.iter().filter_map(closest).filter(|o| (o - best).abs() < width).collect();
    let seconds = median(&mut agreeing);
    let mut scatter: Vec<f64> = agreeing.iter().map(|offset| (offset - seconds).abs()).collect();
    let ramps = agreeing.len();
    // Standard deviation of a median of normal values: sqrt(pi / 2) of the mean's.
    let one = (std::f64::consts::FRAC_PI_2).sqrt() * MAD * median(&mut scatter);
    let standard_uncertainty = if ramps > 1 { one / (ramps as f64).sqrt() } else { f64::INFINITY };
    (Some([seconds, standard_uncertainty]), ramps)
}

/// Every offset, in order, with the number of ramps that have one within `width` of it.
fn partners(offsets: &[Vec<f64>], width: f64) -> impl Iterator<Item = (f64, usize)> {
    let of_ramps = offsets.iter().enumerate();
    let all = of_ramps.flat_map(|(ramp, offsets)| offsets.iter().map(move |offset| (*offset, ramp)));
    let mut all: Vec<(f64, usize)> = all.collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut inside, mut count) = (vec![0_usize; offsets.len()], 0);
    let (mut from, mut to) = (0, 0);
    (0..all.len()).map(move |n| {
        let guess = all[n].0;
        while let Some((_, ramp)) = all.get(to).filter(|(offset, _)| offset - guess < width) {
            inside[*ramp] += 1;
            count += usize::from(inside[*ramp] == 1);
            to += 1;
        }
        while guess - all[from].0 >= width {
            inside[all[from].1] -= 1;
            count -= usize::from(inside[all[from].1] == 0);
            from += 1;
        }
        (guess, count)
    })
}

/// Times at which the telemetry passes the middle of each ramp, by its own clock [s].
fn passages_of(ramps: &[Ramp], telemetry: &SpeedTrace, scale: f64) -> Vec<Vec<f64>> {
    let level = |n: usize| scale * scale * ramps[n].square;
    let mut found = vec![Vec::new(); ramps.len()];
    for is_rising in [false, true] {
        let mut order: Vec<usize> = (0..ramps.len()).filter(|n| ramps[*n].rising == is_rising).collect();
        order.sort_by(|a, b| level(*a).total_cmp(&level(*b)));
        let reports = telemetry.t.iter().zip(&telemetry.omega).map(|(t, omega)| (*t, omega * omega));
        let mut before: Option<(f64, f64)> = None;
        for (t, square) in reports.filter(|(t, square)| t.is_finite() && square.is_finite()) {
            let Some((t_0, square_0)) = before.replace((t, square)) else { continue };
            // Upwards the middle may be where the telemetry arrives, downwards too.
            let below = |square: f64| order.partition_point(|n| level(*n) < square);
            let through = |square: f64| order.partition_point(|n| level(*n) <= square);
            let passed = if is_rising { through(square_0)..through(square) } else { below(square)..below(square_0) };
            for &n in order.get(passed).unwrap_or_default() {
                let (value_0, value) = (square_0 - level(n), square - level(n));
                found[n].push(t_0 + (t - t_0) * value_0 / (value_0 - value));
            }
        }
    }
    found
}

/// Median speed by the telemetry, whose clock is off by `offset` [s], in a window of the unit's time [rad/s].
pub(super) fn median_speed(telemetry: &SpeedTrace, offset: f64, window: [f64; 2]) -> Option<f64> {
    let [from, to] = window.map(|t| t - offset);
    let inside = telemetry.t.partition_point(|t| *t < from)..telemetry.t.partition_point(|t| *t <= to);
    let mut speeds: Vec<f64> = telemetry.omega.get(inside)?.iter().copied().filter(|omega| omega.is_finite()).collect();
    (!speeds.is_empty()).then(|| median(&mut speeds))
}

/// A passage through the middle between two plateaus.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ramp {
    /// Square of the speed in the middle [rad^2/s^2].
    square: f64,
    rising: bool,
    /// Instant on the unit's clock [s].
    t: f64,
}

impl Ramp {
    /// The ramps of a record.
    pub fn all(blocks: &Blocks, schedule: &[ScheduledPlateau], cores: &[Range<usize>]) -> Vec<Self> {
        (1..cores.len()).filter_map(|k| Self::find(blocks, schedule, cores, k)).collect()
    }

    /// The ramp before plateau `k`.
    fn find(blocks: &Blocks, schedule: &[ScheduledPlateau], cores: &[Range<usize>], k: usize) -> Option<Self> {
        let (before, after) = (schedule[k - 1].omega.powi(2), schedule[k].omega.powi(2));
        let level = |core: &Range<usize>| blocks.f_z[usize::midpoint(core.start, core.end)];
        let (from, to) = (level(&cores[k - 1]), level(&cores[k]));
        let way = to - from;
        let part = |i: usize| (blocks.f_z[i] - from).dot(&way) / way.norm_squared() - 0.5;
        let ramp = cores[k - 1].end - 1..cores[k].start + 1;
        let t = passages(ramp.map(|i| (blocks.t[i], part(i)))).next();
        // Plateaus of one speed have no middle.
        t.filter(|_| before != after).map(|t| Self { square: 0.5 * (before + after), rising: after > before, t })
    }
}

/// Times at which a function passes zero upwards, by linear interpolation.
fn passages(values: impl Iterator<Item = (f64, f64)>) -> impl Iterator<Item = f64> {
    let mut before: Option<(f64, f64)> = None;
    values.filter(|(t, value)| t.is_finite() && value.is_finite()).filter_map(move |(t, value)| {
        let (t_0, value_0) = before.replace((t, value))?;
        (value_0 < 0.0 && value >= 0.0).then(|| t_0 + (t - t_0) * value_0 / (value_0 - value))
    })
}
