//! What takes the raw data of a TDMS channel to its unit: a chain of scales in its properties.

use super::metadata::{Properties, Value};

/// The input of a scale that is the raw data.
const RAW: f64 = u32::MAX as f64;

/// Scales of a channel, and coefficients of a scale, at most.
const MOST: f64 = 32.0;

/// Polynomials, one after the other, the lowest power first. None: the numbers are as they are meant.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Scaling(Vec<Vec<f64>>);

impl Scaling {
    /// The scaling that properties state, if any; `daqmx` is the scale that the driver's raw data stand for. A scale neither
    /// linear nor polynomial is an error: its name.
    pub fn of(properties: &Properties, daqmx: Option<u32>) -> Result<Option<Self>, String> {
        let number = |name: &str| match properties.get(name) {
            Some(Value::Number(number)) => Some(*number),
            _ => None,
        };
        let text = |name: &str| match properties.get(name) {
            Some(Value::Text(text)) => Some(text.as_str()),
            _ => None,
        };
        let Some(count) = number("NI_Number_Of_Scales").filter(|count| *count >= 1.0) else { return Ok(None) };
        if count > MOST {
            return Err(format!("{count} scales"));
        }
        if text("NI_Scaling_Status") == Some("scaled") {
            return Ok(Some(Self::default()));
        }
        let (mut chain, mut index) = (Vec::new(), count - 1.0);
        loop {
            let key = |rest: &str| format!("NI_Scale[{index}]_{rest}");
            let kind = text(&key("Scale_Type"));
            let source = match kind {
                // A scale without a type is the driver's.
                None if daqmx.is_some_and(|daqmx| f64::from(daqmx) == index) => break,
                Some("Linear") => {
                    let of = |name: &str| number(&key(name)).ok_or_else(|| format!("a linear scale without {name}"));
                    chain.push(vec![of("Linear_Y_Intercept")?, of("Linear_Slope")?]);
                    number(&key("Linear_Input_Source"))
                }
                Some("Polynomial") => {
                    let count =
                        number(&key("Polynomial_Coefficients_Size")).filter(|count| (0.0..=MOST).contains(count));
                    let count = count.ok_or("a polynomial scale without the number of its coefficients")?;
                    let of = |k: u32| number(&key(&format!("Polynomial_Coefficients[{k}]")));
                    let all = (0..).take_while(|k| f64::from(*k) < count).map(of).collect::<Option<Vec<f64>>>();
                    chain.push(all.ok_or("a polynomial scale without a coefficient")?);
                    number(&key("Polynomial_Input_Source"))
                }
                Some("AdvancedAPI") => number(&key("AdvancedAPI_Input_Source")),
                other => return Err(format!("a scale of type {}", other.unwrap_or("unknown"))),
            };
            // Inputs are earlier scales; anything else could go in circles.
            match source.unwrap_or(RAW) {
                raw if raw == RAW => break,
                earlier if earlier < index && earlier >= 0.0 => index = earlier,
                other => return Err(format!("scale {index} with the input {other}")),
            }
        }
        chain.reverse();
        Ok(Some(Self(chain)))
    }

    /// Scales values in place.
    pub fn apply(&self, values: &mut [f64]) {
        for polynomial in &self.0 {
            for value in &mut *values {
                *value = polynomial.iter().rev().fold(0.0, |sum, coefficient| sum * *value + coefficient);
            }
        }
    }
}
