//! What a column holds, by its unit and its name in English, German or Russian.

use std::path::Path;

use centrical_table::{ColumnName, text_form, unit_of_word};

use crate::units::Dimension;

/// The unit of a count of samples.
pub(super) const SAMPLES: &str = "samples";

/// A column, and its unit if the file names it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Label {
    pub column: ColumnName,
    pub unit: Option<&'static str>,
    /// Why the column is likely and not found.
    pub guess: Option<&'static str>,
    /// The same of its unit.
    pub unit_guess: Option<&'static str>,
}

impl Label {
    /// A column of a text with its name and the unit beside it; a name may hold the unit, too.
    pub fn of_text(name: &str, unit: Option<&'static str>) -> Self {
        let found = unit.or_else(|| unit_in_name(name));
        let is_in_turns = has(&name.to_lowercase(), &["drehzahl", "оборот"]);
        let turns = (found.is_none() && is_in_turns).then_some("rpm");
        Self {
            column: ColumnName::Name(name.to_owned()),
            unit: found.or(turns),
            guess: None,
            unit_guess: turns.map(|_| "revolutions by its name; \"rad/s\" and \"deg/s\" are others"),
        }
    }

    /// The same with the dates of its times of the day in another column.
    pub fn on_dates(self, dates: Self) -> Self {
        Self { column: ColumnName::DateAndTime(Box::new([dates.column, self.column])), ..self }
    }

    /// A column of a text without a header.
    pub fn numbered(index: usize) -> Self {
        let guess = Some("no header names the columns; this is their usual order");
        Self { column: ColumnName::Number(index + 1), unit: None, guess, unit_guess: None }
    }

    /// Whether it counts samples.
    pub fn is_count(&self) -> bool {
        self.unit == Some(SAMPLES)
    }

    /// A column of a table that is asked for the usual names.
    pub fn usual(name: &str) -> Self {
        Self { column: ColumnName::Name(name.to_owned()), unit: None, guess: None, unit_guess: None }
    }
}

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum What {
    Time,
    Speed,
    /// A rate of turn about an axis of the unit.
    Rate,
    Reading,
    /// The number of a row.
    Count,
    Other,
}

/// What a column holds, by its unit, else by its name.
pub(super) fn what(name: &str, unit: Option<&str>) -> What {
    let name = name.to_lowercase();
    let word: String = name.chars().take_while(|c| !"([,".contains(*c)).collect::<String>().trim().to_owned();
    let numbers = ["no", "n", "№", "index", "sample", "samples"];
    if unit.is_none() && (numbers.contains(&word.as_str()) || word.starts_with("__index_level")) {
        return What::Count;
    }
    if has(&word, &["temp", "темп", "status", "flag", "marker", "humid", "press"]) {
        return What::Other;
    }
    let is_of = |dimension: Dimension| unit.is_some_and(|unit| dimension.factor(unit).is_some());
    if is_of(Dimension::Time) {
        What::Time
    } else if is_of(Dimension::Acceleration) || unit == Some("V") {
        What::Reading
    } else if is_rate(&word) {
        What::Rate
    } else if is_of(Dimension::Speed) {
        What::Speed
    } else if has(&word, &["time", "zeit", "врем", "stamp"]) || word == "t" {
        What::Time
    } else if has(&word, &["omega", "ω", "speed", "rpm", "rate", "drehzahl", "об/мин", "скор", "оборот"])
    {
        What::Speed
    } else {
        What::Reading
    }
}

/// Puts three readings in the order of their axes where their names differ in nothing else: `acc_z`, `acc_y`, `acc_x`. Else, unless
/// their names differ first by the axes in their order, it is a guess that they stand in it.
pub(super) fn sort_by_axis(readings: &mut [Label]) {
    let names: Vec<Vec<char>> =
        readings.iter().map(|label| label.column.to_string().to_lowercase().chars().collect()).collect();
    let [a, b, c] = names.as_slice() else { return };
    let shortest = a.len().min(b.len()).min(c.len());
    let differing = (0..shortest).map(|n| [a[n], b[n], c[n]]).filter(|[a, b, c]| a != b || b != c);
    let mut orders: Vec<Option<[usize; 3]>> = differing.map(order_of_axes).collect();
    let first = orders.first().copied().flatten();
    orders.dedup();
    let is_of_one_length = [b, c].iter().all(|other| other.len() == a.len());
    if let ([Some(order)], true) = (&orders[..], is_of_one_length) {
        let sorted: Vec<Label> = order.iter().map(|n| readings[*n].clone()).collect();
        readings.clone_from_slice(&sorted);
    } else if first != Some([0, 1, 2]) {
        let guess = "the order in which they stand; their names show no axis";
        for label in readings {
            label.guess.get_or_insert(guess);
        }
    }
}

/// Where the first, second and third of three axes stand.
fn order_of_axes(letters: [char; 3]) -> Option<[usize; 3]> {
    let order_in = |axes: [char; 3]| {
        let [first, second, third] = axes.map(|axis| letters.iter().position(|letter| *letter == axis));
        Some([first?, second?, third?])
    };
    [['x', 'y', 'z'], ['1', '2', '3'], ['0', '1', '2']].into_iter().find_map(order_in)
}

/// The column of time of a table as text, if its header names one.
pub fn time_column(file: &Path) -> Option<String> {
    let form = text_form(file).ok()??;
    let unit = |index: usize| form.units.get(index).copied().flatten();
    let is_time = |(index, name): &(usize, &String)| what(name, Label::of_text(name, unit(*index)).unit) == What::Time;
    form.names.iter().enumerate().find(is_time).map(|(_, name)| name.clone())
}

fn has(word: &str, parts: &[&str]) -> bool {
    parts.iter().any(|part| word.contains(part))
}

/// Whether a name is that of a gyroscope's axis: `gx`, `gyro_x`, `omega_x [deg/s]`.
fn is_rate(word: &str) -> bool {
    let axis = |c: char| c.is_ascii_whitespace() || "_-.".contains(c);
    let begin = word.split(axis).next().unwrap_or_default();
    let letters: String = word.chars().filter(|c| !axis(*c)).collect();
    let stems = ["g", "gyr", "gyro", "w", "omega", "ω"];
    let of_axis = letters.strip_suffix(['x', 'y', 'z']).is_some_and(|stem| stems.contains(&stem));
    of_axis || ["gyr", "gyro"].contains(&begin)
}

/// The unit that a name holds: `x_mg`, `speed_rpm`, `n 1/min`, or no more than `deg/s`.
fn unit_in_name(name: &str) -> Option<&'static str> {
    let name = name.trim();
    // Names such as `g` and `h` alone are those of quantities.
    let alone = unit_of_word(name).filter(|unit| {
        Dimension::Speed.factor(unit).is_some() || ["s", "ms", "us", "ns"].contains(unit) && name.len() > 1
    });
    let ends = name.match_indices(['_', ' ']).filter_map(|(place, _)| spelled_out(&name[place + 1..]));
    let is_in_rpm = has(&name.to_lowercase(), &["rpm", "об/мин"]);
    alone.or_else(|| ends.into_iter().next()).or(is_in_rpm.then_some("rpm"))
}

/// The unit at the end of a name, where `/` and `^` cannot stand.
fn spelled_out(end: &str) -> Option<&'static str> {
    match end {
        "ms2" | "mps2" | "m_s2" | "mss" => Some("m/s^2"),
        "radps" | "rads" | "rad_s" => Some("rad/s"),
        "degps" | "deg_s" => Some("deg/s"),
        // One letter in the case of its unit: `T_G` and `t_S` are others.
        _ if end.len() == 1 => ["s", "g", "V"].into_iter().find(|unit| *unit == end),
        _ => unit_of_word(end).filter(|unit| !["h", "min"].contains(unit)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_hold_units() {
        let cases = [
            ("rpm", Some("rpm"), What::Speed),
            ("RPM", Some("rpm"), What::Speed),
            ("speed_rpm", Some("rpm"), What::Speed),
            ("n 1/min", Some("rpm"), What::Speed),
            ("deg/s", Some("deg/s"), What::Speed),
            ("Hz", Some("Hz"), What::Speed),
            ("omega", None, What::Speed),
            ("обороты", Some("rpm"), What::Speed),
            ("n", None, What::Count),
            ("temp", None, What::Other),
            ("ms", Some("ms"), What::Time),
            ("t_ms", Some("ms"), What::Time),
            ("t", None, What::Time),
            ("x_mg", Some("mg"), What::Reading),
            ("acc_x_m_s2", Some("m/s^2"), What::Reading),
            ("ax_mps2", Some("m/s^2"), What::Reading),
            ("f1_V", Some("V"), What::Reading),
            ("x_counts", Some("counts"), What::Reading),
            ("f1", None, What::Reading),
            ("g", None, What::Reading),
            ("gx", None, What::Rate),
            ("gyro_x_dps", Some("deg/s"), What::Rate),
            ("omega_z", None, What::Rate),
        ];
        for (name, unit, holds) in cases {
            let label = Label::of_text(name, None);
            assert_eq!((label.unit, what(name, label.unit)), (unit, holds), "{name}");
        }
        let sorted = |names: [&str; 3]| {
            let mut labels = names.map(|name| Label::of_text(name, None));
            sort_by_axis(&mut labels);
            labels.map(|label| label.column.to_string())
        };
        assert_eq!(sorted(["f2", "f3", "f1"]), ["f1", "f2", "f3"]);
        assert_eq!(sorted(["Acc Z [g]", "Acc Y [g]", "Acc X [g]"]), ["Acc X [g]", "Acc Y [g]", "Acc Z [g]"]);
        assert_eq!(sorted(["a2 (z)", "a1 (y)", "a0 (x)"]), ["a0 (x)", "a1 (y)", "a2 (z)"]);
        for as_they_stand in [["up", "left", "fore"], ["a2 (x)", "a1 (y)", "a3 (z)"], ["s3", "s7", "s9"]] {
            assert_eq!(sorted(as_they_stand), as_they_stand);
        }
        let is_guess = |names: [&str; 3]| {
            let mut labels = names.map(|name| Label::of_text(name, None));
            sort_by_axis(&mut labels);
            labels[0].guess.is_some()
        };
        for names in [["up", "left", "fore"], ["a2 (x)", "a1 (y)", "a3 (z)"], ["f(:,2)", "f(:,3)", "f(:,4)"]] {
            assert!(is_guess(names), "{names:?}");
        }
        for names in [["f1", "f2", "f3"], ["z", "y", "x"], ["Acc X", "Acc Y", "Acc Z (up)"], ["AI1", "AI2", "AI3"]] {
            assert!(!is_guess(names), "{names:?}");
        }
        assert_eq!(what("gx", Some("m/s^2")), What::Reading);
        assert_eq!(what("n", Some("rpm")), What::Speed);
    }
}
