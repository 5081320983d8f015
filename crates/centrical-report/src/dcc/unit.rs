//! Units of the result in the notation of D-SI: `m/s^2` is `\metre\second\tothe{-2}`.

use std::fmt;

/// Powers of metre, second and radian.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Unit([i32; 3]);

/// Names in results, and in D-SI.
const NAMES: [(&str, &str); 3] = [("m", "\\metre"), ("s", "\\second"), ("rad", "\\radian")];

impl Unit {
    /// The unit that a result names by a fraction of powers; what is not known counts as one.
    pub fn parse(text: &str) -> Self {
        let mut powers = [0; 3];
        for (part, sign) in text.split('/').zip(std::iter::once(1).chain(std::iter::repeat(-1))) {
            let (name, power) = part.split_once('^').unwrap_or((part, "1"));
            if let Some(k) = NAMES.iter().position(|(known, _)| *known == name) {
                powers[k] += sign * power.parse().unwrap_or(1);
            }
        }
        Self(powers)
    }

    /// Unit of a product.
    pub fn times(self, other: Self) -> Self {
        Self([0, 1, 2].map(|k| self.0[k] + other.0[k]))
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0 == [0; 3] {
            return f.write_str("\\one");
        }
        for ((_, name), power) in NAMES.iter().zip(self.0) {
            match power {
                0 => {}
                1 => f.write_str(name)?,
                _ => write!(f, "{name}\\tothe{{{power}}}")?,
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::Unit;

    #[test]
    fn units_of_results() {
        let shown = |text| Unit::parse(text).to_string();
        assert_eq!(shown("m/s^2"), "\\metre\\second\\tothe{-2}");
        assert_eq!(shown("s^2/m"), "\\metre\\tothe{-1}\\second\\tothe{2}");
        assert_eq!(shown("s^4/m^2"), "\\metre\\tothe{-2}\\second\\tothe{4}");
        assert_eq!((shown("1").as_str(), shown("rad").as_str()), ("\\one", "\\radian"));
        assert_eq!(Unit::parse("m/s^2").times(Unit::parse("s^2/m")).to_string(), "\\one");
    }
}
