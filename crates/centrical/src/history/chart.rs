//! Control charts: individuals and moving range, EWMA, CUSUM, and the rules by which a chart gives a signal.
//!
//! D. C. Montgomery, "Introduction to Statistical Quality Control", chapters 6 and 9; L. S. Nelson, Journal of Quality Technology 16
//! (1984) for the eight rules; 1, 5, 6 and 2 in the form of eight points are those of the Western Electric handbook (1956).

/// Expected range of two normal values, in standard deviations: `d2 = 2 / sqrt(pi)`.
const D2: f64 = std::f64::consts::FRAC_2_SQRT_PI;

/// Upper limit of the moving range over its mean: `D4 = 1 + 3 d3 / d2` of two values.
const D4: f64 = 3.266_532_165_590_083;

/// What a process is like while it is in control.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Control {
    /// Mean.
    pub centre: f64,
    /// Standard deviation from value to value.
    pub deviation: f64,
}

impl Control {
    /// From values that were accepted: the mean, and the mean moving range over `d2 = 1.128`. `None` below two values, or when they do
    /// not vary.
    pub fn of(accepted: &[f64]) -> Option<Self> {
        let ranges = Self::moving_ranges(accepted);
        let centre = accepted.iter().sum::<f64>() / accepted.len() as f64;
        let deviation = ranges.iter().sum::<f64>() / ranges.len() as f64 / D2;
        (deviation > 0.0 && deviation.is_finite()).then_some(Self { centre, deviation })
    }

    /// Limits of single values, `centre -+ 3 deviation`.
    pub fn limits(&self) -> [f64; 2] {
        [self.centre - 3.0 * self.deviation, self.centre + 3.0 * self.deviation]
    }

    /// Upper limit of the moving range.
    pub fn range_limit(&self) -> f64 {
        D4 * D2 * self.deviation
    }

    /// The size of each step between neighbours.
    pub fn moving_ranges(values: &[f64]) -> Vec<f64> {
        values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect()
    }

    /// The chart of exponentially weighted means, with `lambda` in (0, 1] and limits of `width` standard deviations; 0.2 and 2.86 give as few false signals as
    /// limits of three standard deviations of single values (one in 370).
    pub fn ewma(&self, values: &[f64], lambda: f64, width: f64) -> Ewma {
        let (mut mean, mut kept) = (self.centre, 1.0);
        let mut chart = Ewma { means: Vec::new(), half_widths: Vec::new(), signals: Vec::new() };
        for (i, value) in values.iter().enumerate() {
            mean += lambda * (value - mean);
            kept *= (1.0 - lambda).powi(2);
            let half_width = width * self.deviation * (lambda / (2.0 - lambda) * (1.0 - kept)).sqrt();
            if (mean - self.centre).abs() > half_width {
                chart.signals.push(i);
            }
            chart.means.push(mean);
            chart.half_widths.push(half_width);
        }
        chart
    }

    /// The chart of sums, with the reference value `k` and the decision interval `h`, both in standard deviations; 0.5 and 4.77 give one false signal
    /// in 370.
    pub fn cusum(&self, values: &[f64], reference: f64, decision: f64) -> Cusum {
        let mut chart = Cusum { upper: Vec::new(), lower: Vec::new(), signals: Vec::new() };
        let (mut upper, mut lower) = (0.0_f64, 0.0_f64);
        for (i, value) in values.iter().enumerate() {
            let z = (value - self.centre) / self.deviation;
            upper = (upper + z - reference).max(0.0);
            lower = (lower - z - reference).max(0.0);
            if upper.max(lower) > decision {
                chart.signals.push(i);
            }
            chart.upper.push(upper);
            chart.lower.push(lower);
        }
        chart
    }

    /// Where `rules` give a signal: the index of the last of the values of each, and the rule, in the order of the values.
    pub fn signals(&self, values: &[f64], rules: &[Rule]) -> Vec<(usize, Rule)> {
        let z: Vec<f64> = values.iter().map(|value| (value - self.centre) / self.deviation).collect();
        let at = |i: usize, rule: Rule| (i + 1).checked_sub(rule.span()).is_some_and(|start| rule.holds(&z[start..=i]));
        let pairs = (0..z.len()).flat_map(|i| rules.iter().map(move |rule| (i, *rule)));
        pairs.filter(|(i, rule)| at(*i, *rule)).collect()
    }
}

/// A chart of exponentially weighted means, `z_i = lambda x_i + (1 - lambda) z_(i-1)` from the centre on.
#[derive(Debug, Clone, PartialEq)]
pub struct Ewma {
    /// The means.
    pub means: Vec<f64>,
    /// Half of the distance between the limits at each: `L sigma sqrt(lambda / (2 - lambda) (1 - (1 - lambda)^(2 i)))`.
    pub half_widths: Vec<f64>,
    /// Indices of the means outside.
    pub signals: Vec<usize>,
}

/// Sums of deviations beyond a reference, upwards and downwards, in standard deviations.
#[derive(Debug, Clone, PartialEq)]
pub struct Cusum {
    /// `C+_i = max(0, C+_(i-1) + z_i - k)`.
    pub upper: Vec<f64>,
    /// `C-_i = max(0, C-_(i-1) - z_i - k)`.
    pub lower: Vec<f64>,
    /// Indices at which either is beyond the decision interval.
    pub signals: Vec<usize>,
}

/// A rule for single values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Rule {
    /// Nelson 1, Western Electric 1: a value beyond three standard deviations.
    Beyond,
    /// Nelson 2: nine values in a row on one side of the centre.
    Nine,
    /// Nelson 3: six values in a row that rise, or fall.
    SixSteady,
    /// Nelson 4: fourteen values in a row that rise and fall in turn.
    FourteenAlternating,
    /// Nelson 5, Western Electric 2: two of three in a row beyond two standard deviations, on one side.
    TwoOfThree,
    /// Nelson 6, Western Electric 3: four of five in a row beyond one standard deviation, on one side.
    FourOfFive,
    /// Nelson 7: fifteen values in a row within one standard deviation.
    FifteenWithin,
    /// Nelson 8: eight values in a row beyond one standard deviation, on either side.
    EightBeyond,
    /// Western Electric 4: eight values in a row on one side of the centre.
    Eight,
}

impl Rule {
    /// The rules of L. S. Nelson.
    pub const NELSON: [Self; 8] = [
        Self::Beyond,
        Self::Nine,
        Self::SixSteady,
        Self::FourteenAlternating,
        Self::TwoOfThree,
        Self::FourOfFive,
        Self::FifteenWithin,
        Self::EightBeyond,
    ];

    /// The rules of the Western Electric handbook.
    pub const WESTERN_ELECTRIC: [Self; 4] = [Self::Beyond, Self::TwoOfThree, Self::FourOfFive, Self::Eight];

    /// The rule in words.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Beyond => "a value beyond three standard deviations",
            Self::Nine => "nine values in a row on one side of the centre",
            Self::SixSteady => "six values in a row rise, or fall",
            Self::FourteenAlternating => "fourteen values in a row rise and fall in turn",
            Self::TwoOfThree => "two of three values beyond two standard deviations on one side",
            Self::FourOfFive => "four of five values beyond one standard deviation on one side",
            Self::FifteenWithin => "fifteen values in a row within one standard deviation",
            Self::EightBeyond => "eight values in a row beyond one standard deviation on either side",
            Self::Eight => "eight values in a row on one side of the centre",
        }
    }

    /// How many values in a row it looks at.
    const fn span(self) -> usize {
        match self {
            Self::Beyond => 1,
            Self::Nine => 9,
            Self::SixSteady => 6,
            Self::FourteenAlternating => 14,
            Self::TwoOfThree => 3,
            Self::FourOfFive => 5,
            Self::FifteenWithin => 15,
            Self::EightBeyond | Self::Eight => 8,
        }
    }

    /// Whether the values `z`, in standard deviations from the centre and [`Rule::span`] of them, give a signal.
    fn holds(self, z: &[f64]) -> bool {
        let beyond = |sign: f64, limit: f64| z.iter().filter(|z| sign * **z > limit).count();
        let either_side = |limit: f64, count: usize| {
            // The last value is one of them: the signal belongs to it.
            let last = z[z.len() - 1];
            [1.0, -1.0].into_iter().any(|sign| sign * last > limit && beyond(sign, limit) >= count)
        };
        let steps = || z.windows(2).map(|pair| pair[1] - pair[0]);
        match self {
            Self::Beyond => z[0].abs() > 3.0,
            Self::Nine => either_side(0.0, 9),
            Self::Eight => either_side(0.0, 8),
            Self::SixSteady => steps().all(|step| step > 0.0) || steps().all(|step| step < 0.0),
            Self::FourteenAlternating => {
                let steps: Vec<f64> = steps().collect();
                steps.windows(2).all(|pair| pair[0] * pair[1] < 0.0)
            }
            Self::TwoOfThree => either_side(2.0, 2),
            Self::FourOfFive => either_side(1.0, 4),
            Self::FifteenWithin => z.iter().all(|z| z.abs() < 1.0),
            Self::EightBeyond => z.iter().all(|z| z.abs() > 1.0),
        }
    }
}
