//! Plateaus whose noise is alike.
//!
//! Drives and bearings shake an arm more the faster it turns, and what jitters in the speed or in the scale of a unit acts along the specific
//! force. So the noise may be that of the speed, or that of the speed and of the axis on which most of the force acts.

use std::collections::BTreeMap;

use crate::reduction::average::PlateauFit;

/// What distinguishes plateaus.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Alike {
    /// By their speeds.
    Speed,
    /// By their speeds and the axis on which most of the specific force acts.
    SpeedAndForce,
}

/// A class of plateaus with noise of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Class {
    /// Speed in parts of an octave; `None` at rest.
    speed: Option<i32>,
    /// Axis on which most of the force acts, where it counts.
    axis: Option<usize>,
}

/// Speeds within a fiftieth of each other are one.
const PER_OCTAVE: f64 = 32.0;

impl Alike {
    /// The class of a plateau.
    #[expect(clippy::cast_possible_truncation)]
    pub fn class(self, plateau: &PlateauFit) -> Class {
        let omega = plateau.shape.omega.abs();
        let speed = (omega > 0.0).then(|| (omega.log2() * PER_OCTAVE).round() as i32);
        let axis = match self {
            Self::Speed => None,
            Self::SpeedAndForce => Some(plateau.mean.iamax()),
        };
        Class { speed, axis }
    }

    /// Indices of the plateaus of each class.
    pub fn classes(self, plateaus: &[&PlateauFit]) -> BTreeMap<Class, Vec<usize>> {
        let mut classes = BTreeMap::<Class, Vec<usize>>::new();
        for (index, plateau) in plateaus.iter().enumerate() {
            classes.entry(self.class(plateau)).or_default().push(index);
        }
        classes
    }
}
