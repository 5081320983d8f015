//! Measurement results: method, software, standards, influence conditions, parameters with their covariance, reading
//! errors.

use centrical_session::{
    CalibrationResult, Condition, Laboratory, OutputSummary, OutputUnit, ParameterEstimate, Symbol, UnitOfMeasure,
};
use nalgebra::Vector3;
use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::administrative::{identification, software};
use super::xml::Xml;
use crate::document::{covered, method_text, uncertainty_holds};
use crate::evaluation::{COVERAGE_PROBABILITY, Expanded, ReadingError, equation, expanded, reading_errors};
use crate::language::Language;
use crate::number::converted;

/// The results, with the units of the parameters and of those in other axes.
pub(super) fn list(
    xml: &mut Xml,
    result: &CalibrationResult,
    [units, of_axes]: [&[UnitOfMeasure]; 2],
    laboratory: &Laboratory,
    language: Language,
) {
    let messages = language.messages();
    xml.element("dcc:measurementResults", |xml| {
        xml.element("dcc:measurementResult", |xml| {
            xml.content("dcc:name", messages.results, language);
            methods(xml, result, laboratory, language);
            xml.element("dcc:usedSoftware", |xml| software(xml, result, language));
            equipment(xml, laboratory, language);
            influences(xml, result, laboratory, language);
            xml.element("dcc:results", |xml| {
                nominal(xml, result, language);
                parameters(xml, result, units, language);
                covariance(xml, result, units, language);
                other_axes(xml, result, of_axes, language);
                errors(xml, result, language);
            });
        });
    });
}

fn methods(xml: &mut Xml, result: &CalibrationResult, laboratory: &Laboratory, language: Language) {
    let messages = language.messages();
    xml.element("dcc:usedMethods", |xml| {
        xml.element("dcc:usedMethod", |xml| {
            xml.content("dcc:name", messages.method, language);
            let deviations = laboratory.method.deviations.as_deref().unwrap_or(messages.none);
            let covered = covered(result, language).into_iter().filter(|(_, text)| !text.is_empty());
            let covered: Vec<String> = covered.map(|(name, text)| format!(" {name}: {text}.")).collect();
            let method = method_text(&result.model, language);
            let text = format!("{method} {}: {deviations}.{}", messages.deviations, covered.concat());
            xml.content("dcc:description", &text, language);
            xml.optional("dcc:reference", laboratory.method.procedure.as_deref());
        });
        xml.kind("dcc:usedMethod", "basic_methodMeasurementUncertainty", |xml| {
            xml.content("dcc:name", messages.uncertainty, language);
            let text = format!("{} {}", messages.uncertainty_statement, uncertainty_holds(result, language));
            xml.content("dcc:description", &text, language);
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
        ("centrical_unitTemperature", messages.unit_temperature, environment.unit_temperature.map(celsius)),
    ];
    xml.element("dcc:influenceConditions", |xml| {
        for (kind, name, condition) in conditions {
            let Some((Condition { value, range }, offset, factor, unit)) = condition else { continue };
            influence(xml, (kind, name), language, |xml| {
                for (end, bound) in [("Min", value - range), ("Max", value + range)] {
                    xml.kind("dcc:quantity", &format!("{kind}{end}"), |xml| {
                        real(xml, converted(bound * factor + offset), unit, None);
                    });
                }
            });
        }
        let speed = result.model.has_arm().then_some(result.model.speed_uncertainty);
        let numbers = [
            ("centrical_gravity", messages.gravity, Some(result.model.gravity), &*UnitOfMeasure::ACCELERATION.d_si()),
            ("centrical_speedUncertainty", messages.speed_uncertainty, speed, "\\one"),
        ];
        for (kind, name, value, unit) in numbers {
            let Some(value) = value else { continue };
            influence(xml, (kind, name), language, |xml| {
                xml.kind("dcc:quantity", kind, |xml| real(xml, value, unit, None));
            });
        }
    });
}

fn influence(xml: &mut Xml, (kind, name): (&str, &str), language: Language, data: impl FnOnce(&mut Xml)) {
    xml.kind("dcc:influenceCondition", kind, |xml| {
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
                    xml.leaf("si:coverageProbability", &coverage_probability());
                    xml.leaf(
                        "si:distribution",
                        if expanded.degrees_of_freedom.is_none() { "normal" } else { "t-distribution" },
                    );
                });
            });
        }
    });
}

/// Numbers of one unit.
fn real_list(xml: &mut Xml, values: &[String], unit: &str) {
    xml.element("si:realListXMLList", |xml| {
        xml.leaf("si:valueXMLList", &values.join(" "));
        xml.leaf("si:unitXMLList", unit);
    });
}

fn parameters(xml: &mut Xml, result: &CalibrationResult, units: &[UnitOfMeasure], language: Language) {
    let messages = language.messages();
    xml.kind("dcc:result", "centrical_parameters", |xml| {
        xml.content("dcc:name", messages.parameters, language);
        let text = format!("{}. {}", equation(result), messages.axes_defined);
        xml.content("dcc:description", &text, language);
        xml.element("dcc:data", |xml| {
            xml.element("dcc:list", |xml| {
                for (parameter, unit) in result.parameters.iter().zip(units) {
                    let kind = format!("basic_measuredValue centrical_{}", camel_case(parameter.group.name()));
                    xml.kind("dcc:quantity", &kind, |xml| {
                        one_parameter(xml, result, (parameter, *unit), language);
                    });
                }
            });
        });
    });
}

/// `cross-coupling` as `crossCoupling`, which a refType may be.
fn camel_case(words: &str) -> String {
    let mut parts = words.split(|c: char| !c.is_ascii_alphanumeric());
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |name, part| {
        let (head, tail) = part.split_at(part.len().min(1));
        format!("{name}{}{tail}", head.to_ascii_uppercase())
    })
}

/// The nominal scale and bias of a unit that does not put out an acceleration.
fn nominal(xml: &mut Xml, result: &CalibrationResult, language: Language) {
    let messages = language.messages();
    let Some(OutputSummary { unit, scale, bias }) = result.raw_output() else { return };
    // Counts are a number; what has no symbol in D-SI is named in words alone.
    let raw = if OutputUnit::named(unit) == OutputUnit::Counts {
        Some("")
    } else {
        Symbol::of(unit).and_then(|symbol| symbol.d_si)
    };
    let Some(raw) = raw else { return };
    let per_force = format!("{raw}\\metre\\tothe{{-1}}\\second\\tothe{{2}}");
    let raw = if raw.is_empty() { "\\one" } else { raw };
    xml.kind("dcc:result", "centrical_nominalOutput", |xml| {
        xml.content("dcc:name", messages.nominal_output, language);
        xml.content("dcc:description", messages.nominal_output_text, language);
        xml.element("dcc:data", |xml| {
            let rows = [
                ("centrical_nominalScale", messages.nominal_scale, scale, per_force.as_str()),
                ("centrical_nominalBias", messages.nominal_bias, bias, raw),
            ];
            for (kind, name, numbers, unit) in rows {
                xml.kind("dcc:quantity", &format!("basic_nominalValue {kind}"), |xml| {
                    xml.content("dcc:name", name, language);
                    real_list(xml, &numbers.map(number), unit);
                });
            }
        });
    });
}

fn one_parameter(
    xml: &mut Xml,
    result: &CalibrationResult,
    (parameter, unit): (&ParameterEstimate, UnitOfMeasure),
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
fn covariance(xml: &mut Xml, result: &CalibrationResult, units: &[UnitOfMeasure], language: Language) {
    let all = &result.parameters;
    let shown: Vec<usize> = (0..all.len()).filter(|&j| all[j].estimable).collect();
    if shown.is_empty() {
        return;
    }
    xml.kind("dcc:result", "centrical_covariance", |xml| {
        xml.content("dcc:name", language.messages().covariance, language);
        xml.element("dcc:data", |xml| {
            xml.kind("dcc:quantity", "centrical_parameterVector", |xml| {
                let quantity = |j: usize| (all[j].name.as_str(), all[j].value.unwrap_or(f64::NAN), units[j]);
                let quantities: Vec<_> = shown.iter().map(|&j| quantity(j)).collect();
                vector(xml, &quantities, &|i, j| result.covariance[shown[i]][shown[j]].unwrap_or(f64::NAN));
            });
        });
    });
}

/// The error model in other axes, as one vector with its covariance matrix.
fn other_axes(xml: &mut Xml, result: &CalibrationResult, units: &[UnitOfMeasure], language: Language) {
    let messages = language.messages();
    let Some(axes) = &result.axes else { return };
    let quantities = axes.parameters.iter().zip(units).map(|(p, unit)| (p.name.as_str(), p.value, *unit));
    let quantities: Vec<_> = quantities.collect();
    xml.kind("dcc:result", "centrical_otherAxes", |xml| {
        xml.content("dcc:name", &format!("{}: {}", messages.axes, (messages.words.axes)(&axes.name)), language);
        xml.content("dcc:description", messages.axes_text, language);
        xml.element("dcc:data", |xml| {
            xml.kind("dcc:quantity", "centrical_rotationMatrix", |xml| {
                xml.content("dcc:name", messages.axes_matrix, language);
                real_list(xml, axes.matrix.map(|row| row.map(number)).as_flattened(), "\\one");
            });
            xml.kind("dcc:quantity", "centrical_parameterVector", |xml| {
                vector(xml, &quantities, &|i, j| axes.covariance[i][j]);
            });
        });
    });
}

/// Quantities, each a label, a value and a unit, as one vector with its covariance matrix.
fn vector(xml: &mut Xml, quantities: &[(&str, f64, UnitOfMeasure)], covariance: &dyn Fn(usize, usize) -> f64) {
    let all = 0..quantities.len();
    let joined = |text: &dyn Fn(usize) -> String| all.clone().map(text).collect::<Vec<_>>().join(" ");
    xml.element("si:realListXMLList", |xml| {
        xml.leaf("si:labelXMLList", &joined(&|j| quantities[j].0.to_owned()));
        xml.leaf("si:valueXMLList", &joined(&|j| number(quantities[j].1)));
        xml.leaf("si:unitXMLList", &joined(&|j| quantities[j].2.d_si()));
        xml.element("si:measurementUncertaintyMultivariateXMLList", |xml| {
            xml.element("si:ellipsoidalRegionMUXMLList", |xml| {
                xml.element("si:covarianceMatrixXMLList", |xml| {
                    for j in all.clone() {
                        xml.element("si:columnXMLList", |xml| {
                            xml.element("si:covarianceXMLList", |xml| {
                                xml.leaf("si:valueXMLList", &joined(&|i| number(covariance(i, j))));
                                let unit = |i: usize| quantities[i].2.times(quantities[j].2).d_si();
                                xml.leaf("si:unitXMLList", &joined(&unit));
                            });
                        });
                    }
                });
                xml.leaf("si:coverageFactorXMLList", &ellipsoid_factor(quantities.len()));
                xml.leaf("si:coverageProbabilityXMLList", &coverage_probability());
                xml.leaf("si:distributionXMLList", "normal");
            });
        });
    });
}

/// The probability that all expanded uncertainties cover.
fn coverage_probability() -> String {
    format!("{COVERAGE_PROBABILITY:.4}")
}

/// `k` of the ellipsoid that holds a normal vector of `dimension` with that probability: the root of the quantile of
/// chi^2 (JCGM 102, 6.5).
fn ellipsoid_factor(dimension: usize) -> String {
    let quantile = ChiSquared::new(dimension as f64).map_or(f64::NAN, |law| law.inverse_cdf(COVERAGE_PROBABILITY));
    format!("{:.4}", quantile.sqrt())
}

/// Reading errors by plateau, as received and compensated.
fn errors(xml: &mut Xml, result: &CalibrationResult, language: Language) {
    let messages = language.messages();
    let Some(errors) = reading_errors(result).filter(|errors| !errors.is_empty()) else { return };
    xml.kind("dcc:result", "centrical_readingErrors", |xml| {
        xml.content("dcc:name", messages.residual_error, language);
        xml.element("dcc:data", |xml| {
            for axis in 0..3 {
                xml.element("dcc:list", |xml| {
                    xml.content("dcc:name", &format!("{} {}", messages.axis, axis + 1), language);
                    let mut column = |kind: &str, name: &str, of: fn(&ReadingError) -> Vector3<f64>| {
                        xml.kind("dcc:quantity", kind, |xml| {
                            xml.content("dcc:name", name, language);
                            let values: Vec<String> = errors.iter().map(|error| number(of(error)[axis])).collect();
                            real_list(xml, &values, &UnitOfMeasure::ACCELERATION.d_si());
                        });
                    };
                    column("basic_referenceValue centrical_specificForce", messages.specific_force, |e| e.force);
                    if !result.model.nominal_found {
                        column("basic_measurementError centrical_asReceived", messages.before, |e| e.before);
                    }
                    column("basic_measurementError centrical_compensated", messages.after, |e| e.after);
                    column("centrical_expandedUncertainty", messages.compensation_uncertainty, |e| {
                        e.expanded_prediction
                    });
                });
            }
        });
    });
}

/// A decimal of D-SI: the shortest that gives the same double.
fn number(value: f64) -> String {
    if value.is_finite() { format!("{value:e}") } else { "NaN".to_owned() }
}
