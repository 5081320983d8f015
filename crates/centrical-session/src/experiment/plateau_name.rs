//! Plateaus as people name them.

use std::fmt;
use std::num::ParseIntError;
use std::str::FromStr;

use centrical::SetPoint;

use super::session::Session;
use crate::error::{Error, Place};

/// A plateau as people name it: `4:3`, the third plateau of the fourth mounting.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PlateauName {
    /// Number of the mounting, from 1.
    pub mounting: usize,
    /// Number of the plateau in the mounting's schedule, from 1.
    pub plateau: usize,
}

impl PlateauName {
    /// Name of the set point of that index.
    pub fn of(session: &Session, set_point: usize) -> Self {
        Self::among(&session.experiment.set_points, set_point)
    }

    /// The same in the schedule of all mountings.
    pub(crate) fn among(set_points: &[SetPoint], set_point: usize) -> Self {
        let mounting = set_points[set_point].mounting;
        let plateau = set_points[..=set_point].iter().filter(|other| other.mounting == mounting).count();
        Self { mounting: mounting + 1, plateau }
    }

    /// Index of its set point in the experiment.
    ///
    /// # Errors
    /// [`Error::Table`] if the session has no such plateau.
    pub fn set_point(self, session: &Session) -> Result<usize, Error> {
        let set_points = session.experiment.set_points.iter().enumerate();
        let mut there = set_points.filter(|(_, set_point)| set_point.mounting + 1 == self.mounting);
        let found = self.plateau.checked_sub(1).and_then(|skipped| there.nth(skipped));
        found.map(|(index, _)| index).ok_or_else(|| {
            let found = format!("no plateau {self}");
            Error::content(&session.file, Place::Whole, found, "the numbers of a mounting and of one of its plateaus")
        })
    }
}

impl fmt::Display for PlateauName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.mounting, self.plateau)
    }
}

impl FromStr for PlateauName {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = |_: ParseIntError| format!("found {text:?}, expected MOUNTING:PLATEAU such as 4:3");
        let (mounting, plateau) = text.split_once(':').unwrap_or((text, ""));
        Ok(Self { mounting: mounting.parse().map_err(wrong)?, plateau: plateau.parse().map_err(wrong)? })
    }
}
