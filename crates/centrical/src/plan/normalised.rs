//! The source's normalised experiment [K5.5] as a preset.

use std::f64::consts::PI;

use nalgebra::{Matrix3, Vector3};

use crate::model::position::{Position, ThirdPosition};
use crate::model::{
    Centrifuge, Experiment, Mounting, PairRelation, ReferencePoint, STANDARD_GRAVITY, SetPoint, Site, Unit,
};

/// The normalised experiment [K5.5]: six positions, `R* Omega*^2 / g = 10`, speeds `Omega* sqrt(m)`.
#[derive(Debug, Clone, PartialEq)]
pub struct Normalised {
    /// Which way newtonometer 1 points in positions 3 and 4.
    pub third: ThirdPosition,
    /// Relation of `dR` in a pair.
    pub pair_relation: PairRelation,
    /// `rho0` in units of `R*`.
    pub rho: Matrix3<f64>,
    /// Mounting radii in units of `R*`.
    pub radii: Vec<f64>,
    /// `m`: multiples of `Omega*^2`; 0 is rest.
    pub levels: Vec<f64>,
    /// Angles `alpha_3` at rest [rad].
    pub rest_angles: Vec<f64>,
    /// `R*` [m].
    pub arm: f64,
    /// `g` [m/s^2].
    pub gravity: f64,
}

/// `R* Omega*^2 / g`.
const LOAD: f64 = 10.0;

impl Default for Normalised {
    /// `m = 0..3`, radii `R*` and `R*/2`, rest at 0 and pi, the source's pair relation, no spread of proof masses,
    /// `R* = 0.5 m`, standard gravity.
    fn default() -> Self {
        Self {
            third: ThirdPosition::AxisOneUp,
            pair_relation: PairRelation::Opposite,
            rho: Matrix3::zeros(),
            radii: vec![1.0, 0.5],
            levels: vec![0.0, 1.0, 2.0, 3.0],
            rest_angles: vec![0.0, PI],
            arm: 0.5,
            gravity: STANDARD_GRAVITY,
        }
    }
}

impl Normalised {
    /// `Omega*` [rad/s].
    pub fn unit_speed(&self) -> f64 {
        (LOAD * self.gravity / self.arm).sqrt()
    }

    /// The experiment in SI units, ordered by position, then radius, then speed.
    pub fn experiment(&self) -> Experiment {
        let positions = Position::kozlov_2017(self.third);
        let mountings: Vec<Mounting> = (0..positions.len())
            .flat_map(|position| self.radii.iter().map(move |radius| (position, radius)))
            .map(|(position, radius)| Mounting { position, arm_y: Vector3::x() * (radius * self.arm) })
            .collect();
        let set_points = (0..mountings.len()).flat_map(|mounting| self.schedule(mounting)).collect();
        Experiment {
            site: Site { gravity: self.gravity, latitude: None },
            unit: Unit { rho_z: self.rho * self.arm, reference: ReferencePoint::FirstProofMass },
            centrifuge: Centrifuge::default(),
            positions,
            pair_relation: self.pair_relation,
            mountings,
            set_points,
        }
    }

    fn schedule(&self, mounting: usize) -> Vec<SetPoint> {
        let mut schedule = Vec::new();
        for &m in &self.levels {
            if m == 0.0 {
                schedule.extend(self.rest_angles.iter().map(|&angle| SetPoint::at_rest(mounting, angle)));
            } else {
                schedule.push(SetPoint::spinning(mounting, self.unit_speed() * m.sqrt()));
            }
        }
        schedule
    }
}
