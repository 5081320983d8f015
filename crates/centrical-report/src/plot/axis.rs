//! From values to lengths along an axis, and where its ticks stand.

use super::series::{Axis, Scale};
use crate::number::{power_of_ten, superscript};

/// An axis laid out over a length.
pub(super) struct Ruler {
    scale: Scale,
    /// Ends in the scale's own measure: values, or their decimal logarithms.
    low: f64,
    high: f64,
    length: f64,
}

/// A tick: where it stands, and its text unless it is a minor one.
pub(super) struct Tick {
    pub(super) position: f64,
    pub(super) text: Option<String>,
}

impl Ruler {
    /// Lays the axis over `length`, spanning `values` (those that the scale can place) or the range it was given.
    pub(super) fn new(axis: &Axis, values: impl Iterator<Item = f64>, length: f64) -> Self {
        let given = axis.range.map(|(low, high)| (measure(axis.scale, low), measure(axis.scale, high)));
        let is_usable = |ends: &(f64, f64)| ends.0.is_finite() && ends.1.is_finite() && ends.0 < ends.1;
        let (low, high) = given.filter(is_usable).unwrap_or_else(|| span(axis.scale, values));
        Self { scale: axis.scale, low, high, length }
    }

    /// Distance of `value` from the low end; none if the scale has no place for it.
    pub(super) fn position(&self, value: f64) -> Option<f64> {
        let position = (measure(self.scale, value) - self.low) / (self.high - self.low) * self.length;
        position.is_finite().then_some(position)
    }

    /// About `most` ticks, and the power of ten that their texts leave to the axis label.
    pub(super) fn ticks(&self, most: usize) -> (Vec<Tick>, i32) {
        match self.scale {
            Scale::Linear => self.linear_ticks(most),
            Scale::Log => (self.log_ticks(most), 0),
        }
    }

    fn linear_ticks(&self, most: usize) -> (Vec<Tick>, i32) {
        let step = nice_step((self.high - self.low) / most.max(1) as f64);
        let largest = exponent(self.low.abs().max(self.high.abs()));
        let power = if (-2..5).contains(&largest) { 0 } else { largest };
        let decimals = usize::try_from(power - exponent(step)).unwrap_or(0);
        let first = (self.low / step - 1e-9).ceil();
        let ticks = (0..=2 * most)
            .map(|k| (first + k as f64) * step)
            .take_while(|value| *value <= self.high + 1e-9 * step)
            .map(|value| {
                let text = format!("{:.decimals$}", value / 10_f64.powi(power));
                // A rounded zero keeps no sign.
                let is_zero = text.trim_matches(['-', '0', '.']).is_empty();
                let text = if is_zero { "0".to_owned() } else { text.replace('-', "\u{2212}") };
                Tick { position: self.at(value), text: Some(text) }
            })
            .collect();
        (ticks, power)
    }

    /// Decades, every k-th named; their multiples are minor ticks, named too where decades are few.
    fn log_ticks(&self, most: usize) -> Vec<Tick> {
        let (first, last) = (whole(self.low.floor()), whole(self.high.ceil()));
        let inside = whole(self.high.floor()) - whole(self.low.ceil());
        let every = inside.max(0) / i32::try_from(most.max(1)).unwrap_or(1) + 1;
        let named: &[u8] = match self.high - self.low {
            span if span < 1.2 => &[1, 2, 3, 4, 5, 6, 8],
            span if span < 2.5 => &[1, 2, 5],
            _ => &[1],
        };
        let digits: &[u8] = if every == 1 { &[1, 2, 3, 4, 5, 6, 7, 8, 9] } else { &[1] };
        let ticks = (first..=last).flat_map(|decade| digits.iter().map(move |&digit| (decade, digit)));
        ticks
            .map(|(decade, digit)| {
                let is_named = named.contains(&digit) && decade.rem_euclid(every) == 0;
                let text = is_named.then(|| if digit == 1 { power_of_ten(decade) } else { power_times(digit, decade) });
                (f64::from(decade) + f64::from(digit).log10(), text)
            })
            .filter(|(at, _)| (self.low - 1e-9..=self.high + 1e-9).contains(at))
            .map(|(at, text)| Tick { position: self.at(at), text })
            .collect()
    }

    /// Distance from the low end of a number in the scale's own measure.
    fn at(&self, measure: f64) -> f64 {
        (measure - self.low) / (self.high - self.low) * self.length
    }
}

fn measure(scale: Scale, value: f64) -> f64 {
    match scale {
        Scale::Linear => value,
        Scale::Log => value.log10(),
    }
}

/// Ends of the axis: the data with a margin; one unit or decade about a single value; 0 to 1 without data.
fn span(scale: Scale, values: impl Iterator<Item = f64>) -> (f64, f64) {
    let measures = values.map(|value| measure(scale, value)).filter(|measure| measure.is_finite());
    let (low, high) = measures.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), m| (l.min(m), h.max(m)));
    if low > high {
        return (0.0, 1.0);
    }
    let width = high - low;
    let margin = match scale {
        Scale::Linear if width <= 1e-12 * low.abs().max(high.abs()) => 0.5 * low.abs().max(1e-300),
        Scale::Log if width < 1e-9 => 0.5,
        _ => 0.04 * width,
    };
    if margin < 1e-290 { (low - 1.0, high + 1.0) } else { (low - margin, high + margin) }
}

/// The least of 1, 2, 5 times a power of ten that is not far below `step`.
fn nice_step(step: f64) -> f64 {
    let step = 0.75 * step;
    let power = 10_f64.powi(exponent(step));
    let times = [1.0, 2.0, 5.0].into_iter().find(|times| times * power >= step * (1.0 - 1e-9)).unwrap_or(10.0);
    times * power
}

/// Power of ten of the leading digit.
fn exponent(value: f64) -> i32 {
    if value > 0.0 { whole((value.log10() + 1e-9).floor()) } else { 0 }
}

/// Decimal exponents of doubles are far inside i32.
#[allow(clippy::cast_possible_truncation)]
fn whole(value: f64) -> i32 {
    value as i32
}

fn power_times(digit: u8, exponent: i32) -> String {
    match exponent {
        -1 => format!("0.{digit}"),
        0 => digit.to_string(),
        1 => format!("{digit}0"),
        _ => format!("{digit}·10{}", superscript(exponent)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(axis: &Axis, values: &[f64]) -> (Vec<String>, i32) {
        let (ticks, power) = Ruler::new(axis, values.iter().copied(), 100.0).ticks(6);
        (ticks.into_iter().filter_map(|tick| tick.text).collect(), power)
    }

    #[test]
    fn linear_ticks_are_round_and_their_power_goes_to_the_label() {
        assert_eq!(texts(&Axis::linear(""), &[0.0, 1.0]).0, ["0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        let (ticks, power) = texts(&Axis::linear(""), &[-3e-6, 3e-6]);
        assert_eq!((ticks.join(" ").as_str(), power), ("−3 −2 −1 0 1 2 3", -6));
        assert_eq!(texts(&Axis::linear("").with_range(0.0, 12000.0), &[]).0[1], "2000");
    }

    #[test]
    fn log_ticks_are_decades_and_digits_where_decades_are_few() {
        assert_eq!(texts(&Axis::log(""), &[0.01, 1000.0]).0, ["10⁻²", "10⁻¹", "1", "10", "10²", "10³"]);
        assert_eq!(texts(&Axis::log("").with_range(1.0, 10.0), &[]).0, ["1", "2", "3", "4", "5", "6", "8", "10"]);
        let wide = texts(&Axis::log(""), &[1e-12, 1e12]).0;
        assert!(wide.len() <= 7 && wide.contains(&"1".to_owned()), "{wide:?}");
    }

    #[test]
    fn data_without_extent_still_have_an_axis() {
        for values in [&[][..], &[0.0], &[5.0], &[-1.0, f64::NAN]] {
            for axis in [Axis::linear(""), Axis::log("")] {
                let ruler = Ruler::new(&axis, values.iter().copied(), 100.0);
                assert!(ruler.low < ruler.high, "{values:?}");
            }
        }
    }
}
