//! The table `[uncertainty]`: what the laboratory states of the quantities that the fit takes as exact. A number without a unit is in SI.

use std::collections::BTreeMap;
use std::path::Path;

use centrical::{Course, Effect, ErrorModel, Experiment, Kind, Law, Parameter, Rival, TypeB};

use super::speeds::Speeds;
use super::toml_path::TomlPath;
use crate::error::{Error, quoted};
use crate::quantity::{Quantity, in_parameter_unit};
use crate::units::Dimension;

/// A quantity beside effects: its name, its dimension, what is beyond reason, and where it is taken.
type Stated = (&'static str, Dimension, f64, fn(&mut TypeB, f64));

/// All of them. Beyond reason a unit was mistaken: for gravity twice its range over the Earth; 0.1 m and rad of what a machine sets, 1 rad,
/// 10 m/s^2, 100 %.
const QUANTITIES: [Stated; 15] = [
    ("gravity", Dimension::Acceleration, 0.1, |t, u| t.gravity = u),
    ("latitude", Dimension::Angle, 1.0, |t, u| t.latitude = u),
    ("radius", Dimension::Length, 0.1, |t, u| t.radius = u),
    ("radius_difference", Dimension::Length, 0.1, |t, u| t.radius_difference = Some(u)),
    ("speed_scale", Dimension::Ratio, 1.0, |t, u| t.speed_scale = u),
    // That of `[centrifuge]`, which has it already.
    ("plateau_speed", Dimension::Ratio, 1.0, |_, _| ()),
    ("rest_angle", Dimension::Angle, 0.1, |t, u| t.rest_angle = u),
    ("proof_masses", Dimension::Length, 0.1, |t, u| t.proof_masses = u),
    ("attitude", Dimension::Angle, 1.0, |t, u| t.attitude = u),
    ("bias_change", Dimension::Acceleration, 10.0, |t, u| t.bias_change = u),
    ("mounting_bias", Dimension::Acceleration, 10.0, |t, u| t.mounting_bias = u),
    ("mounting_scale", Dimension::Ratio, 1.0, |t, u| t.mounting_scale = u),
    ("resolution", Dimension::Acceleration, 10.0, |t, u| t.resolution = u),
    ("reading_noise", Dimension::Acceleration, 10.0, |t, u| t.reading_noise = u),
    ("doubt", Dimension::Ratio, 1.0, |t, u| t.doubt = u),
];

fn is_quantity(name: &str) -> bool {
    QUANTITIES.iter().any(|(own, ..)| *own == name)
}

/// Standard uncertainty of an unknown change of bias [m/s^2]: ten times a typical bias.
pub(crate) const ANY_BIAS: f64 = 0.5;

/// Standard uncertainties of what `experiment` has, SI; `plateau_speed` is the same as `speed_uncertainty` of `[centrifuge]` or absent, and
/// `speed_scale` the same as the scale of measured speeds, where both are stated.
pub(crate) fn type_b(
    file: &Path,
    table: &BTreeMap<String, Quantity>,
    experiment: &Experiment,
    error_model: &ErrorModel,
    speeds: &Speeds,
) -> Result<TypeB, Error> {
    let at = TomlPath::table(file, "uncertainty");
    let mut type_b = TypeB { bias_change: ANY_BIAS, speed_scale: speeds.scale(), ..TypeB::default() };
    for (key, dimension, largest, take) in QUANTITIES {
        let Some(quantity) = table.get(key) else { continue };
        // A laboratory states the same of all its sessions; but the Earth's rotation is left out without a latitude.
        if key == "latitude" && experiment.site.latitude.is_none() {
            return Err(at.unexpected(key, quantity.to_string(), "no such key without a latitude in [site]"));
        }
        let meaning = "a standard uncertainty, zero or more and not beyond reason";
        take(&mut type_b, at.bounded(key, quantity, dimension, (0.0, largest), meaning)?);
    }
    let independent = std::f64::consts::SQRT_2 * type_b.radius;
    if let Some(difference) = type_b.radius_difference.filter(|difference| *difference > independent) {
        let expected = "at most sqrt(2) times radius, the difference of seats measured independently";
        return Err(at.unexpected("radius_difference", format!("{difference} m"), expected));
    }
    let set_uncertainty = speeds.set_uncertainty;
    let plateau_speed =
        table.get("plateau_speed").map(|quantity| at.finite("plateau_speed", quantity, Dimension::Ratio));
    if let Some(speed) = plateau_speed.transpose()?.filter(|speed| *speed != set_uncertainty) {
        let expected = format!("{set_uncertainty}, the speed_uncertainty of [centrifuge], or nothing");
        return Err(at.unexpected("plateau_speed", speed.to_string(), expected));
    }
    let of_measured = speeds.measured.and_then(|measured| measured.scale);
    if let Some(scale) = of_measured.filter(|scale| *scale != type_b.speed_scale) {
        let expected = format!("{scale}, the scale of measured speeds in [centrifuge], or nothing");
        return Err(at.unexpected("speed_scale", type_b.speed_scale.to_string(), expected));
    }
    type_b.effects = effects(&at, table, experiment, error_model)?;
    Ok(type_b)
}

/// Bounds of effects, by the name of the rival with underscores: `arm_turn_load = "0.3 urad at 100 g"`.
fn effects(
    at: &TomlPath,
    table: &BTreeMap<String, Quantity>,
    experiment: &Experiment,
    error_model: &ErrorModel,
) -> Result<[f64; Rival::COUNT], Error> {
    let names: Vec<String> = Rival::COMMON.iter().map(|rival| rival.name().replace('-', "_")).collect();
    let mut bounds = [0.0; Rival::COUNT];
    for (key, quantity) in table.iter().filter(|(key, _)| !is_quantity(key)) {
        let Some(place) = names.iter().position(|name| name == key) else {
            let effects = names.iter().map(String::as_str).filter(|name| !is_quantity(name));
            let known: Vec<&str> = QUANTITIES.iter().map(|(name, ..)| *name).chain(effects).collect();
            let found = format!("the unknown quantity {}", quoted(key.as_bytes()));
            return Err(at.unexpected(key, found, format!("one of {}", known.join(", "))));
        };
        let unknowns = Rival::COMMON[place].parameters(experiment, error_model);
        let Some(unknown) = unknowns.first() else {
            let expected =
                "no such bound: the model has the effect, or the experiment has nothing that it could act on";
            return Err(at.unexpected(key, quantity.to_string(), expected));
        };
        bounds[place] = bound(at, key, quantity, unknown)?;
    }
    Ok(bounds)
}

/// A standard uncertainty in the unit of an effect's unknowns; of an effect that grows with a load or a speed, its value there:
/// "0.3 urad at 100 g".
fn bound(at: &TomlPath, key: &str, quantity: &Quantity, unknown: &Parameter) -> Result<f64, Error> {
    let at_a_place = match quantity {
        Quantity::Text(text) => text.split_once(" at "),
        Quantity::Number(_) => None,
    };
    let value = match (at_a_place, growth(unknown)) {
        (Some((size, place)), Some((of_size, of_place, power))) => {
            let [size, place] = [size, place].map(|part| Quantity::Text(part.trim().to_owned()));
            at.finite(key, &size, of_size)? / at.finite(key, &place, of_place)?.powi(power)
        }
        (_, growth) => in_parameter_unit(quantity, &unknown.unit, unknown.group).map_err(|not| {
            let other = growth.map(|(size, place, _)| format!(", or its size at a place: {}", example(size, place)));
            at.unexpected(key, not.found, not.expected + &other.unwrap_or_default())
        })?,
    };
    let largest = BEYOND_REASON * unknown.typical;
    if value > 0.0 && value <= largest {
        Ok(value)
    } else {
        let expected = format!("a standard uncertainty above 0, and at most {largest:.1e} {}", unknown.unit);
        Err(at.unexpected(key, quantity.to_string(), expected))
    }
}

/// How the size of an effect at a load or a speed is written.
fn example(size: Dimension, place: Dimension) -> String {
    let size = match size {
        Dimension::Angle => "0.3 urad",
        Dimension::Ratio => "0.3 ppm",
        Dimension::Length => "1 um",
        _ => "500 ug",
    };
    format!("\"{size} at {}\"", if place == Dimension::Speed { "10 rev/s" } else { "100 g" })
}

/// A bound of an effect is at most as many of its typical magnitudes: beyond them a unit was mistaken.
const BEYOND_REASON: f64 = 1e6;

/// What an effect that grows is the size of, what it grows with, and to which power.
fn growth(unknown: &Parameter) -> Option<(Dimension, Dimension, i32)> {
    let by = |law: Law| match law {
        Law::Load => (Dimension::Acceleration, 1),
        Law::Speed => (Dimension::Speed, 2),
    };
    let Kind::Effect(effect) = unknown.kind else { return None };
    match effect {
        Effect::ElasticTurn { law, .. } | Effect::ArmTurn { law, .. } => {
            let (place, power) = by(law);
            Some((Dimension::Angle, place, power))
        }
        Effect::ArmStretch { law, .. } => {
            let (place, power) = by(law);
            Some((Dimension::Ratio, place, power))
        }
        Effect::Monomial { monomial, .. } if monomial.degree() > 0 => {
            Some((Dimension::Acceleration, Dimension::Acceleration, i32::from(monomial.degree())))
        }
        Effect::Disturbance { follows: Course::Speed | Course::OwnRate, .. } => {
            Some((Dimension::Acceleration, Dimension::Speed, 1))
        }
        Effect::Disturbance { follows: Course::SquaredSpeed, .. } => {
            Some((Dimension::Acceleration, Dimension::Speed, 2))
        }
        Effect::Disturbance { follows: Course::FourthPowerOfSpeed, .. } => {
            Some((Dimension::Acceleration, Dimension::Speed, 4))
        }
        Effect::Disturbance { follows: Course::Yield, .. } => Some((Dimension::Length, Dimension::Acceleration, 1)),
        _ => None,
    }
}
