//! The unit: places of the proof masses, and what its raw output is.

use std::path::Path;

use centrical::{ReferencePoint, Unit};
use nalgebra::Matrix3;

use super::form::{RawTable, UnitTable};
use super::toml_path::TomlPath;
use crate::error::{Error, quoted};
use crate::record::Scale;
use crate::units::Dimension;

/// Proof masses and the reference point.
pub(crate) fn geometry(file: &Path, table: &UnitTable) -> Result<Unit, Error> {
    /// No unit is larger [m].
    const LARGEST: f64 = 1.0;
    let at = TomlPath::table(file, "unit");
    let mut rho_z = Matrix3::zeros();
    for (j, point) in table.proof_masses.iter().flatten().enumerate() {
        rho_z.set_column(j, &at.point("proof_masses", point, LARGEST)?.into());
    }
    let reference = match table.reference.as_deref() {
        None | Some("first-proof-mass") => ReferencePoint::FirstProofMass,
        Some("own-axes") => ReferencePoint::OwnAxes,
        Some(other) => {
            return Err(at.unexpected("reference", quoted(other.as_bytes()), "\"first-proof-mass\" or \"own-axes\""));
        }
    };
    let (agrees, expected) = match reference {
        ReferencePoint::FirstProofMass => (
            rho_z.column(0).iter().all(|c| *c == 0.0),
            "the first point at zero (reference = \"first-proof-mass\"), or reference = \"own-axes\"",
        ),
        ReferencePoint::OwnAxes => (
            rho_z.diagonal().iter().all(|c| *c == 0.0),
            "coordinate j of point j at zero (reference = \"own-axes\"), or reference = \"first-proof-mass\"",
        ),
    };
    if agrees {
        Ok(Unit { rho_z, reference })
    } else {
        let found: Vec<Vec<f64>> = rho_z.column_iter().map(|c| c.iter().copied().collect()).collect();
        Err(at.unexpected("proof_masses", format!("{found:?}"), expected))
    }
}

/// What the unit puts out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OutputUnit {
    /// Whole counts.
    Counts,
    /// Volts.
    Volts,
    /// A unit of acceleration.
    Acceleration,
}

/// Raw output: its kind, its name under `output_unit`, and the key of its scale and bias.
pub(crate) const RAW_OUTPUT: [(OutputUnit, &str, &str); 2] =
    [(OutputUnit::Counts, "counts", "counts"), (OutputUnit::Volts, "V", "volts")];

impl OutputUnit {
    /// The kind of the unit that a session names.
    pub fn named(name: &str) -> Self {
        RAW_OUTPUT.iter().find(|(_, raw, _)| *raw == name).map_or(Self::Acceleration, |(kind, ..)| *kind)
    }
}

/// What takes the raw output of each newtonometer to m/s^2.
pub(crate) fn output(file: &Path, table: &UnitTable) -> Result<[Scale; 3], Error> {
    let at = TomlPath::table(file, "unit");
    let unit = table.output_unit.as_str();
    let kind = OutputUnit::named(unit);
    for ((of, own, key), coarse) in RAW_OUTPUT.into_iter().zip([&table.counts, &table.volts]) {
        match coarse {
            Some(coarse) if kind == of => return from_raw(file, key, coarse),
            None if kind == of => {
                let expected = format!("{key} = {{ scale = [...], bias = [...] }}: {key} per m/s^2 and {key} at none");
                return Err(at.unexpected(key, "no such key", expected));
            }
            Some(_) => {
                let expected = format!("no {key}, or output_unit = {own:?}");
                return Err(at.unexpected(key, format!("{key} and output_unit = {unit:?}"), expected));
            }
            None => {}
        }
    }
    let factor = Dimension::Acceleration.factor(unit).ok_or_else(|| {
        let expected = format!("\"counts\", \"V\" or one of {}", Dimension::Acceleration.unit_list());
        at.unexpected("output_unit", quoted(unit.as_bytes()), expected)
    })?;
    Ok([Scale::factor(factor); 3])
}

/// `f = (raw - bias) / scale`, raw in counts or volts.
fn from_raw(file: &Path, key: &str, table: &RawTable) -> Result<[Scale; 3], Error> {
    let at = TomlPath::table(file, &format!("unit.{key}"));
    let mut scales = [Scale::factor(1.0); 3];
    for (j, scale) in scales.iter_mut().enumerate() {
        let (bias, per_unit) = (table.bias[j], table.scale[j]);
        if !bias.is_finite() {
            return Err(at.unexpected("bias", format!("{bias:?}"), format!("finite {key}")));
        }
        // A converter of 64 bits over a thousandth of a g makes 2e21 counts per m/s^2.
        if !(1e-24..=1e24).contains(&per_unit.abs()) {
            return Err(at.unexpected("scale", format!("{per_unit:?}"), format!("{key} per m/s^2, not zero")));
        }
        *scale = Scale { offset: bias, factor: 1.0 / per_unit };
    }
    Ok(scales)
}
