//! Measurement results: method, software, standards, influence conditions, parameters with their covariance, reading
//! errors.

use centrical_session::{CalibrationResult, Condition, Laboratory, ParameterEstimate, Unit};
use nalgebra::Vector3;
use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::administrative::{identification, software};
use super::xml::Xml;
use crate::evaluation::{Expanded, ReadingError, equation, expanded, expanded_of_normal, reading_errors};
use crate::language::Language;

/// Probability that the expanded uncertainties cover.
const COVERAGE_PROBABILITY: f64 = 0.95;

/// The results, the parameters with their `units`.
pub(super) fn list(
    xml: &mut Xml,
    (result, units): (&CalibrationResult, &[Unit]),
    laboratory: &Laboratory,
    language: Language,
) {
    let messages = language.messages();
    xml.element("dcc:measurementResults", |xml| {
        xml.element("dcc:measurementResult", |xml| {
            xml.content("dcc:name", messages.results, language);
            methods(xml, laboratory, language);
            xml.element("dcc:usedSoftware", |xml| software(xml, result, language));
            equipment(xml, laboratory, language);
            influences(xml, result, laboratory, language);
            xml.element("dcc:results", |xml| {
                parameters(xml, result, units, language);
                covariance(xml, result, units, language);
                errors(xml, result, language);
            });
        });
    });
}

fn methods(xml: &mut Xml, laboratory: &Laboratory, language: Language) {
    let messages = language.messages();
    xml.element("dcc:usedMethods", |xml| {
        xml.element("dcc:usedMethod", |xml| {
            xml.content("dcc:name", messages.method, language);
            let deviations = laboratory.method.deviations.as_deref().unwrap_or(messages.none);
            let text = format!("{} {}: {deviations}.", messages.method_text, messages.deviations);
            xml.content("dcc:description", &text, language);
            xml.optional("dcc:reference", laboratory.method.procedure.as_deref());
        });
        xml.element_with("dcc:usedMethod", &[("refType", "basic_methodMeasurementUncertainty")], |xml| {
            xml.content("dcc:name", messages.uncertainty, language);
            xml.content("dcc:description", messages.uncertainty_statement, language);
            xml.leaf("dcc:norm", "JCGM 100:2008");
        });
    });
}

fn equipment(xml: &mut Xml, laboratory: &Laboratory, language: Language) {
    let messages = language.messages();
    if laboratory.standard.is_empty() {
        return;
    }
    xml.element("dcc:measuringEquipments", |xml| {
        for standard in &laboratory.standard {
            xml.element("dcc:measuringEquipment", |xml| {
                xml.content("dcc:name", &standard.name, language);
                let text = format!(
                    "{}: {}. {}: {}",
                    messages.standard_certificate, standard.certificate, messages.traceable_to, standard.traceable_to
                );
                xml.content("dcc:description", &text, language);
                xml.element("dcc:identifications", |xml| {
                    identification(xml, "calibrationLaboratory", &standard.identification);
                });
            });
        }
    });
}

fn influences(xml: &mut Xml, result: &CalibrationResult, laboratory: &Laboratory, language: Language) {
    let (messages, environment) = (language.messages(), &laboratory.environment);
    // Offset and factor that take the laboratory's unit to SI.
    let celsius = |c: Condition| (c, 273.15, 1.0, "\\kelvin");
    let conditions = [
        ("basic_temperature", messages.temperature, Some(celsius(environment.temperature))),
        ("basic_humidityRelative", messages.humidity, environment.humidity.map(|c| (c, 0.0, 0.01, "\\one"))),
        ("basic_pressure", messages.pressure, environment.pressure.map(|c| (c, 0.0, 1e3, "\\pascal"))),
    ];
    xml.element("dcc:influenceConditions", |xml| {
        for (kind, name, condition) in conditions {
            let Some((Condition { value, range }, offset, factor, unit)) = condition else { continue };
            influence(xml, (kind, name), language, |xml| {
                for (end, bound) in [("Min", value - range), ("Max", value + range)] {
                    xml.element_with("dcc:quantity", &[("refType", &format!("{kind}{end}"))], |xml| {
                        // To the laboratory's own digits: no conversion knows more.
                        let si = format!("{:.9e}", bound * factor + offset).parse().unwrap_or(f64::NAN);
                        real(xml, si, unit, None);
                    });
                }
            });
        }
        influence(xml, ("centrical_gravity", messages.gravity), language, |xml| {
            xml.element("dcc:quantity", |xml| {
                real(xml, result.model.gravity, &Unit::ACCELERATION.d_si(), None);
            });
        });
        influence(xml, ("centrical_speedUncertainty", messages.speed_uncertainty), language, |xml| {
            xml.element("dcc:quantity", |xml| real(xml, result.model.speed_uncertainty, "\\one", None));
        });
    });
}

fn influence(xml: &mut Xml, (kind, name): (&str, &str), language: Language, data: impl FnOnce(&mut Xml)) {
    xml.element_with("dcc:influenceCondition", &[("refType", kind)], |xml| {
        xml.content("dcc:name", name, language);
        xml.element("dcc:data", data);
    });
}

/// A number of D-SI with its expanded uncertainty.
fn real(xml: &mut Xml, value: f64, unit: &str, expanded: Option<Expanded>) {
    xml.element("si:real", |xml| {
        xml.leaf("si:value", &number(value));
        xml.leaf("si:unit", unit);
        if let Some(expanded) = expanded {
            xml.element("si:measurementUncertaintyUnivariate", |xml| {
                xml.element("si:expandedMU", |xml| {
                    xml.leaf("si:valueExpandedMU", &number(expanded.uncertainty));
                    xml.leaf("si:coverageFactor", &expanded.factor.to_string());
                    xml.leaf("si:coverageProbability", &COVERAGE_PROBABILITY.to_string());
                    xml.leaf("si:distribution", if expanded.is_normal() { "normal" } else { "t-distribution" });
                });
            });
        }
    });
}

fn parameters(xml: &mut Xml, result: &CalibrationResult, units: &[Unit], language: Language) {
    let messages = language.messages();
    xml.element_with("dcc:result", &[("refType", "centrical_parameters")], |xml| {
        xml.content("dcc:name", messages.parameters, language);
        xml.content("dcc:description", &equation(result), language);
        xml.element("dcc:data", |xml| {
            xml.element("dcc:list", |xml| {
                for (parameter, unit) in result.parameters.iter().zip(units) {
                    xml.element("dcc:quantity", |xml| one_parameter(xml, result, (parameter, *unit), language));
                }
            });
        });
    });
}

fn one_parameter(
    xml: &mut Xml,
    result: &CalibrationResult,
    (parameter, unit): (&ParameterEstimate, Unit),
    language: Language,
) {
    let messages = language.messages();
    xml.content("dcc:name", &parameter.name, language);
    xml.content("dcc:description", (messages.words.group)(parameter.group), language);
    match (parameter.value, expanded(result, parameter)) {
        (Some(value), Some(expanded)) => real(xml, value, &unit.d_si(), Some(expanded)),
        // Never a number that looks like a result.
        _ => xml.content("dcc:noQuantity", messages.not_determined, language),
    }
}

/// The estimable parameters as one vector with its covariance matrix.
fn covariance(xml: &mut Xml, result: &CalibrationResult, units: &[Unit], language: Language) {
    let all = &result.parameters;
    let shown: Vec<usize> = (0..all.len()).filter(|&j| all[j].estimable).collect();
    if shown.is_empty() {
        return;
    }
    let joined = |text: &dyn Fn(usize) -> String| shown.iter().map(|&j| text(j)).collect::<Vec<_>>().join(" ");
    xml.element_with("dcc:result", &[("refType", "centrical_covariance")], |xml| {
        xml.content("dcc:name", language.messages().covariance, language);
        xml.element("dcc:data", |xml| {
            xml.element("dcc:quantity", |xml| {
                xml.element("si:realListXMLList", |xml| {
                    xml.leaf("si:labelXMLList", &joined(&|j| all[j].name.clone()));
                    xml.leaf("si:valueXMLList", &joined(&|j| number(all[j].value.unwrap_or(f64::NAN))));
                    xml.leaf("si:unitXMLList", &joined(&|j| units[j].d_si()));
                    xml.element("si:measurementUncertaintyMultivariateXMLList", |xml| {
                        xml.element("si:ellipsoidalRegionMUXMLList", |xml| {
                            xml.element("si:covarianceMatrixXMLList", |xml| {
                                for &j in &shown {
                                    xml.element("si:columnXMLList", |xml| {
                                        xml.element("si:covarianceXMLList", |xml| {
                                            let entry = |i: usize| number(result.covariance[i][j].unwrap_or(f64::NAN));
                                            xml.leaf("si:valueXMLList", &joined(&entry));
                                            let unit = |i: usize| units[i].times(units[j]).d_si();
                                            xml.leaf("si:unitXMLList", &joined(&unit));
                                        });
                                    });
                                }
                            });
                            xml.leaf("si:coverageFactorXMLList", &ellipsoid_factor(shown.len()));
                            xml.leaf("si:coverageProbabilityXMLList", &COVERAGE_PROBABILITY.to_string());
                            xml.leaf("si:distributionXMLList", "normal");
                        });
                    });
                });
            });
        });
    });
}

/// `k` of the ellipsoid that holds a normal vector of `dimension` with probability 0.95: the root of the quantile of
/// chi^2 (JCGM 102, 6.5).
fn ellipsoid_factor(dimension: usize) -> String {
    let quantile = ChiSquared::new(dimension as f64).map_or(f64::NAN, |law| law.inverse_cdf(COVERAGE_PROBABILITY));
    format!("{:.4}", quantile.sqrt())
}

/// Reading errors by plateau, as received and compensated.
fn errors(xml: &mut Xml, result: &CalibrationResult, language: Language) {
    let messages = language.messages();
    let Some(errors) = reading_errors(result).filter(|errors| !errors.is_empty()) else { return };
    xml.element_with("dcc:result", &[("refType", "centrical_readingErrors")], |xml| {
        xml.content("dcc:name", messages.residual_error, language);
        xml.element("dcc:data", |xml| {
            for axis in 0..3 {
                xml.element("dcc:list", |xml| {
                    xml.content("dcc:name", &format!("{} {}", messages.axis, axis + 1), language);
                    let mut column = |name: &str, of: fn(&ReadingError) -> Vector3<f64>| {
                        xml.element("dcc:quantity", |xml| {
                            xml.content("dcc:name", name, language);
                            xml.element("si:realListXMLList", |xml| {
                                let values: Vec<String> = errors.iter().map(|error| number(of(error)[axis])).collect();
                                xml.leaf("si:valueXMLList", &values.join(" "));
                                xml.leaf("si:unitXMLList", &Unit::ACCELERATION.d_si());
                            });
                        });
                    };
                    column(messages.specific_force, |e| e.force);
                    column(messages.before, |e| e.before);
                    column(messages.after, |e| e.after);
                    column(messages.compensation_uncertainty, |e| e.prediction.map(expanded_of_normal));
                });
            }
        });
    });
}

/// A decimal of D-SI: the shortest that gives the same double.
fn number(value: f64) -> String {
    if value.is_finite() { format!("{value:e}") } else { "NaN".to_owned() }
}
