//! Recording mistakes: exchanged axes, reversed signs, a wrong unit.

use std::fmt;

use nalgebra::{Matrix3, Vector3};

use super::plateau::ScheduledPlateau;
use crate::model::STANDARD_GRAVITY;

/// How the readings of a record differ from the expected ones: `found = factor permutation expected`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mistake {
    /// The newtonometer that column `i` really holds.
    pub source: [u8; 3],
    /// Its sign.
    pub sign: [i8; 3],
    /// Size of the readings over that of the expected ones.
    pub factor: f64,
}

impl Mistake {
    /// Mistakes of the columns alone: orders of the axes and signs.
    pub fn of_columns() -> impl Iterator<Item = Self> {
        Self::all().into_iter().filter(|mistake| mistake.factor == 1.0)
    }

    /// Every mistake: orders of the axes, signs and units, but for the record as it stands.
    pub(super) fn all() -> Vec<Self> {
        const ORDERS: [[u8; 3]; 6] = [[0, 1, 2], [1, 0, 2], [0, 2, 1], [2, 1, 0], [1, 2, 0], [2, 0, 1]];
        let mut all = Vec::with_capacity(144);
        for source in ORDERS {
            for signs in 0..8_u8 {
                let sign = [0, 1, 2].map(|axis| if signs >> axis & 1 == 1 { -1 } else { 1 });
                for factor in [1.0, 1.0 / STANDARD_GRAVITY, STANDARD_GRAVITY] {
                    all.push(Self { source, sign, factor });
                }
            }
        }
        all.retain(|mistake| mistake.count() > 0);
        all
    }

    /// Exchanges, reversed signs and wrong units.
    pub(super) fn count(&self) -> i32 {
        let moved = (0..3).filter(|axis| usize::from(self.source[*axis]) != *axis).count();
        let reversed = self.sign.iter().filter(|sign| **sign < 0).count();
        let units = usize::from(self.factor != 1.0);
        i32::try_from(moved.saturating_sub(1) + reversed + units).unwrap_or(i32::MAX)
    }

    /// Whether another mounting of the unit would give the same readings: a proper rotation, in the right unit.
    fn is_turn(&self) -> bool {
        let row = |i: usize| Vector3::ith(usize::from(self.source[i]), f64::from(self.sign[i]));
        self.factor == 1.0 && Matrix3::from_columns(&[row(0), row(1), row(2)]).determinant() > 0.0
    }

    /// The reading in place of the expected `f_z`.
    pub fn reading(&self, f_z: &Vector3<f64>) -> Vector3<f64> {
        let row = |i: usize| Vector3::ith(usize::from(self.source[i]), self.factor * f64::from(self.sign[i]));
        Matrix3::from_columns(&[row(0), row(1), row(2)]).transpose() * f_z
    }

    /// A scheduled plateau as it would be read.
    pub(super) fn scheduled(&self, plateau: &ScheduledPlateau) -> ScheduledPlateau {
        ScheduledPlateau { nominal_z: self.reading(&plateau.nominal_z), ..*plateau }
    }
}

impl fmt::Display for Mistake {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let moved: Vec<usize> = (0..3).filter(|axis| usize::from(self.source[*axis]) != *axis).collect();
        let mut parts = Vec::new();
        if let [i, j] = moved[..] {
            parts.push(format!("axes {0} and {1} exchanged (f{1} as f{0} and f{0} as f{1})", i + 1, j + 1));
        } else if !moved.is_empty() {
            let named = moved.iter().map(|i| format!("f{} as f{}", self.source[*i] + 1, i + 1));
            parts.push(format!("axes exchanged in turn ({})", named.collect::<Vec<_>>().join(", ")));
        }
        for axis in (0..3).filter(|axis| self.sign[*axis] < 0) {
            parts.push(format!("f{} with the sign reversed", axis + 1));
        }
        if self.factor < 1.0 {
            parts.push("the unit g taken for m/s^2".to_owned());
        } else if self.factor > 1.0 {
            parts.push("the unit m/s^2 taken for g".to_owned());
        }
        if self.is_turn() {
            parts.push("or another mounting of the unit".to_owned());
        }
        out.write_str(&parts.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::Mistake;

    #[test]
    fn all_other_signs_and_orders_are_tried() {
        let up = Vector3::new(1.0, 2.0, 3.0);
        let all: Vec<Vector3<f64>> = Mistake::of_columns().map(|mistake| mistake.reading(&up)).collect();
        assert_eq!(all.len(), 47);
        assert!(!all.contains(&up));
        assert!(all.iter().enumerate().all(|(n, one)| !all[..n].contains(one)));
    }
}
