//! `centrical report` and the documents of `calibrate --out`.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use centrical_session::{CalibrationResult, result_beside};

use crate::program;
use crate::session::{Copy, example};

/// A calibrated copy: `calibrate --out .` with the laboratory's data.
fn calibrated(language: &str) -> Copy {
    let copy = Copy::new();
    let laboratory = example().join("laboratory.toml");
    let run = copy.calibrate(&["--out", ".", "--laboratory", laboratory.to_str().unwrap(), "--language", language]);
    assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
    copy
}

/// Files of a folder and of its folders, by name, with their bytes.
fn contents(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut files = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = PathBuf::from(path.file_name().unwrap());
        if path.is_dir() {
            files.extend(contents(&path).into_iter().map(|(inner, bytes)| (name.join(inner), bytes)));
        } else {
            files.insert(name, fs::read(path).unwrap());
        }
    }
    files
}

/// `calibrate --out` leaves result, report, certificates and plots at once, and `report` makes the same of the result.
#[test]
fn calibrate_writes_everything_and_report_writes_the_same() {
    let copy = calibrated("en");
    let files = contents(&copy.out());
    let mut expected = vec!["certificate.pdf".to_owned(), "certificate.xml".to_owned()];
    let whole = ["convergence", "correlation", "normalised", "prediction", "residuals", "singular-values"];
    expected.extend(whole.map(|plot| format!("plots/{plot}.svg")));
    let parts = [("after", 3), ("before", 3), ("records", 12)];
    expected.extend(parts.iter().flat_map(|(plot, n)| (1..=*n).map(move |k| format!("plots/{plot}-{k:02}.svg"))));
    expected.extend(["report.html".to_owned(), "result.json".to_owned()]);
    expected.sort();
    let names: Vec<&str> = files.keys().map(|name| name.to_str().unwrap()).collect();
    assert_eq!(names, expected);
    for (name, bytes) in files.iter().filter(|(name, _)| name.starts_with("plots")) {
        let svg = std::str::from_utf8(bytes).unwrap();
        assert!(svg.starts_with("<svg") && svg.contains("<title>"), "{}", name.display());
    }
    let laboratory = example().join("laboratory.toml");
    let arguments = ["--html", "h", "--pdf", "p", "--dcc", "d", "--code", "source", "--laboratory"];
    let run = copy.run(&[&["report", "result.json"], &arguments[..], &[laboratory.to_str().unwrap()]].concat());
    assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
    let again = contents(&copy.out());
    for (file, copied) in [("report.html", "h"), ("certificate.pdf", "p"), ("certificate.xml", "d")] {
        assert!(again[Path::new(file)] == again[Path::new(copied)], "{file} differs");
    }
    assert_eq!(again.keys().filter(|name| name.starts_with("source")).count(), 4);
}

/// The same bytes from another folder, another day and any number of threads: all documents and all source code.
#[test]
fn the_same_bytes() {
    let documents = |threads: &str| {
        let copy = Copy::new();
        let laboratory = example().join("laboratory.toml");
        let (session, laboratory) = (copy.session(), laboratory.to_str().unwrap().to_owned());
        let run = |arguments: &[&str]| {
            let mut command = program::centrical();
            let run =
                command.args(arguments).current_dir(copy.out()).env("RAYON_NUM_THREADS", threads).output().unwrap();
            assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
        };
        run(&["calibrate", session.to_str().unwrap(), "--out", ".", "--laboratory", &laboratory]);
        run(&["report", "result.json", "--code", "source"]);
        contents(&copy.out())
    };
    let (one, two) = (documents("1"), documents("2"));
    assert_eq!(one.keys().collect::<Vec<_>>(), two.keys().collect::<Vec<_>>());
    for (name, bytes) in &one {
        assert!(*bytes == two[name], "{} differs", name.display());
    }
}

/// Verdict first, then the parameters; nothing from the network; every plot with its sentence.
#[test]
fn the_page_is_whole_and_alone() {
    let copy = calibrated("en");
    let page = fs::read_to_string(copy.out().join("report.html")).unwrap();
    let place = |text: &str| page.find(text).unwrap_or_else(|| panic!("{text} is not in the page"));
    assert!(place("Calibration acceptable") < place("G0₁₁") && place("G0₁₁") < place("<details>"));
    assert!(place("Unit within its limits") < place("G0₁₁"), "what is said of the unit stands apart, first too");
    let addresses = page.matches("http").count();
    assert_eq!(
        addresses,
        page.matches("xmlns=\"http://www.w3.org/2000/svg\"").count(),
        "nothing but the SVG name space"
    );
    assert!(!page.contains("<script"));
    assert_eq!(page.matches("<figure").count(), 10);
    assert_eq!(page.matches("<figcaption>").count(), 10);
    for name in ["δ₃[6]", "G2₃₃", "dρ₂₂"] {
        place(name);
    }
}

#[test]
fn russian_has_its_words_and_commas() {
    let copy = calibrated("ru");
    let page = fs::read_to_string(copy.out().join("report.html")).unwrap();
    for part in [
        "lang=\"ru\"",
        "Калибровка принята",
        "Прибор в пределах допусков",
        "05.10.2026",
        "Смещение нуля",
        "9,81523 м/с²",
        "мкg/g²",
        "Неопределённость по ходу сеанса",
    ] {
        assert!(page.contains(part), "{part}");
    }
    assert!(!page.contains("Пригоден"), "nothing is said of the fitness of the unit");
    let body = &page[page.find("<main>").unwrap()..page.find("<figure").unwrap()];
    let text: String = body.split('<').filter_map(|piece| piece.split_once('>')).map(|(_, text)| text).collect();
    let has_point = |pair: &[char]| pair[0].is_ascii_digit() && pair[1] == '.' && pair[2].is_ascii_digit();
    let letters: Vec<char> = text.replace("0.1.0", "").replace("0.0.0", "").replace("05.10.2026", "").chars().collect();
    let found = letters.windows(3).position(has_point);
    assert!(found.is_none(), "a decimal point in {:?}", found.map(|k| &letters[k.saturating_sub(20)..k + 5]));
    let dcc = fs::read_to_string(copy.out().join("certificate.xml")).unwrap();
    assert!(dcc.contains("<dcc:content lang=\"ru\">Параметры</dcc:content>"));
}

/// A file without a whole line of a history is refused.
#[test]
fn a_history_has_lines() {
    let copy = calibrated("en");
    for text in ["", "[[[[", "    "] {
        fs::write(copy.out().join("h.jsonl"), text).unwrap();
        let run = copy.run(&["report", "result.json", "--history", "h.jsonl", "--html", "h.html"]);
        let message = String::from_utf8(run.stderr).unwrap();
        assert_eq!(run.status.code(), Some(2), "{message}");
        assert!(message.contains("h.jsonl: found no whole line, expected the history of a watch"), "{message}");
    }
    // That of another unit would be drawn as if it led to this result.
    let watch = copy.run(&["watch", copy.session().to_str().unwrap(), "--once", "--quiet", "0", "--out", "w"]);
    assert!(watch.status.success(), "{watch:?}");
    let history = fs::read_to_string(copy.out().join("w/watch-history.jsonl")).unwrap();
    let report = |file: &str| copy.run(&["report", "result.json", "--history", file, "--html", "h.html"]);
    assert!(report("w/watch-history.jsonl").status.success());
    let last: serde_json::Value = serde_json::from_str(history.lines().last().unwrap()).unwrap();
    let mut other = last.clone();
    let scale = other["estimates"].as_array_mut().unwrap().iter_mut().find(|e| e["name"] == "G0_11").unwrap();
    scale["value"] = 1e-2.into();
    fs::write(copy.out().join("h.jsonl"), format!("{other}\n")).unwrap();
    let message = String::from_utf8(report("h.jsonl").stderr).unwrap();
    assert!(message.contains("found the history of another session"), "{message}");
}

/// A certificate without the laboratory's data is refused, as is a laboratory file with a mistake, by place.
#[test]
fn certificates_need_the_laboratory() {
    let copy = calibrated("en");
    assert_eq!(copy.run(&["report", "result.json", "--pdf", "c.pdf"]).status.code(), Some(2));
    let text = fs::read_to_string(example().join("laboratory.toml")).unwrap();
    fs::write(copy.out().join("laboratory.toml"), text.replace("[customer]", "[costumer]")).unwrap();
    let run = copy.run(&["report", "result.json", "--pdf", "c.pdf", "--laboratory", "laboratory.toml"]);
    let message = String::from_utf8(run.stderr).unwrap();
    assert_eq!(run.status.code(), Some(2));
    assert!(message.contains("laboratory.toml, line ") && message.contains("costumer"), "{message}");
    fs::write(copy.out().join("laboratory.toml"), text.replace("\"df_3\"", "\"df_9\"")).unwrap();
    let arguments = ["report", "result.json", "--html", "r.html", "--pdf", "c.pdf", "--laboratory", "laboratory.toml"];
    let run = copy.run(&arguments);
    let message = String::from_utf8(run.stderr).unwrap();
    assert_eq!(run.status.code(), Some(2));
    let expected = "laboratory.toml, [[decision.limit]] 3, parameter: found \"df_9\", expected one of";
    assert!(message.contains(expected), "{message}");
    assert!(!copy.out().join("c.pdf").exists() && !copy.out().join("r.html").exists());
}

/// A result that is not acceptable says so first, in the page and by the exit code.
#[test]
fn a_bad_result_is_called_bad() {
    let copy = calibrated("en");
    let file = copy.out().join("result.json");
    let mut result: serde_json::Value = serde_json::from_slice(&fs::read(&file).unwrap()).unwrap();
    result["fit"]["chi_squared"] = 1000.0.into();
    fs::write(&file, result.to_string()).unwrap();
    let run = copy.run(&["report", "result.json", "--html", "bad.html"]);
    assert_eq!(run.status.code(), Some(1));
    let page = fs::read_to_string(copy.out().join("bad.html")).unwrap();
    assert!(
        page.contains("Calibration not acceptable")
            && page.contains("Unit: no limits given")
            && page.contains("residuals are larger")
            && page.contains("1000.0")
    );
}

/// The verdict on the unit is not that on the calibration: limits that are not kept end with exit code 1, stated, in every
/// document; a limit is shown as it was written and never rounded outwards.
#[test]
fn a_unit_outside_its_limits() {
    let copy = calibrated("en");
    let text = fs::read_to_string(example().join("laboratory.toml")).unwrap();
    let limits = "[[decision.limit]]\ngroup = \"bias\"\nwithin = \"3.0343 mg\"\n\n\
                  [[decision.limit]]\nparameter = \"G1_11\"\nhigh = \"-16 ug/g^2\"\n\n\
                  [[decision.limit]]\nreading = \"compensated\"\nwithin = \"10 mg\"\n";
    let text = format!("{}{limits}", &text[..text.find("[[decision.limit]]").unwrap()]);
    fs::write(copy.out().join("tight.toml"), text).unwrap();
    let arguments = ["--html", "t.html", "--pdf", "t.pdf", "--dcc", "t.xml", "--laboratory", "tight.toml"];
    let run = copy.run(&[&["report", "result.json"], &arguments[..]].concat());
    assert_eq!(run.status.code(), Some(1), "{}", String::from_utf8_lossy(&run.stderr));
    let said = String::from_utf8_lossy(&run.stdout).into_owned();
    let line = "UNIT NOT WITHIN ITS LIMITS  df₁: −3.9524 ± 0.0040 mg; limits −3.0343 … 3.0343 mg";
    assert!(said.contains(line) && said.contains("df₂: ") && !said.contains("G1₁₁"), "{said}");
    // 3.0344 mg with U = 0.017 mg: outside by the guarded rule.
    assert!(said.contains("df₃: 3.034 ± 0.017 mg"), "{said}");
    let page = fs::read_to_string(copy.out().join("t.html")).unwrap();
    assert!(page.contains("Calibration acceptable") && page.contains("Unit not within its limits"));
    assert!(fs::read_to_string(copy.out().join("t.xml")).unwrap().contains("<dcc:conformity>fail</dcc:conformity>"));
    let tight = copy.out().join("tight.toml");
    let run = copy.calibrate(&["--laboratory", tight.to_str().unwrap()]);
    let said = String::from_utf8_lossy(&run.stdout).into_owned();
    assert!(run.status.code() == Some(1) && said.contains("ACCEPTABLE  no check") && said.contains(line), "{said}");
    // A value within its limits by less than U is not accepted, and not called outside.
    let text = fs::read_to_string(&tight).unwrap();
    let guarded = "[[decision.limit]]\nparameter = \"df_1\"\nwithin = \"3.954 mg\"\n";
    let text = format!("{}{guarded}", &text[..text.find("[[decision.limit]]").unwrap()]);
    fs::write(copy.out().join("guarded.toml"), text).unwrap();
    let arguments = ["--html", "g.html", "--dcc", "g.xml", "--laboratory", "guarded.toml"];
    let run = copy.run(&[&["report", "result.json"], &arguments[..]].concat());
    let said = String::from_utf8_lossy(&run.stdout).into_owned();
    let line =
        "UNIT WITHIN ITS LIMITS BY LESS THAN U, NOT ACCEPTED  df₁: −3.9524 ± 0.0040 mg; limits −3.954 … 3.954 mg";
    assert!(run.status.code() == Some(1) && said.contains(line), "{said}");
    assert!(fs::read_to_string(copy.out().join("g.html")).unwrap().contains("Unit not shown to be within its limits"));
    let digital = fs::read_to_string(copy.out().join("g.xml")).unwrap();
    for words in
        ["noPass</dcc:conformity>", "with a probability of less than 80 %", "No adjustment or repair of the unit"]
    {
        assert!(digital.contains(words), "{words}");
    }
    // A quantity of another dimension is refused by place.
    let wrong = fs::read_to_string(&tight).unwrap().replace("3.0343 mg", "3 urad");
    fs::write(&tight, wrong).unwrap();
    let run = copy.run(&["report", "result.json", "--html", "u.html", "--laboratory", "tight.toml"]);
    let message = String::from_utf8_lossy(&run.stderr).into_owned();
    assert!(
        run.status.code() == Some(2) && message.contains("[[decision.limit]] 1, within: found \"3 urad\""),
        "{message}"
    );
}

/// chi^2 far below its expectation stands in the report and not on the terminal alone; the worst of the mountings is shown by
/// its own probability and by that of the worst of twelve.
#[test]
fn chances_are_said_as_they_are() {
    let copy = calibrated("en");
    let page = fs::read_to_string(copy.out().join("report.html")).unwrap();
    assert!(page.contains("p = 0.050 (F test); corrected for the number of mountings, 12: 0.604"));
    assert!(!page.contains("Residuals are smaller"));
    let file = copy.out().join("result.json");
    let mut result: serde_json::Value = serde_json::from_slice(&fs::read(&file).unwrap()).unwrap();
    result["fit"]["chi_squared"] = 100.0.into();
    result["validity"]["probability"] = 1.0.into();
    fs::write(&file, result.to_string()).unwrap();
    assert_eq!(copy.run(&["report", "result.json", "--html", "small.html"]).status.code(), Some(0));
    let page = fs::read_to_string(copy.out().join("small.html")).unwrap();
    assert!(page.contains("Residuals are smaller than the stated uncertainties allow"));
}

/// Finite degrees of freedom give a larger coverage factor, which stands beside the result.
#[test]
fn coverage_factors_of_finite_degrees_of_freedom() {
    let copy = calibrated("en");
    let file = copy.out().join("result.json");
    let mut result: serde_json::Value = serde_json::from_slice(&fs::read(&file).unwrap()).unwrap();
    let names: Vec<String> =
        result["parameters"].as_array().unwrap().iter().map(|p| p["name"].as_str().unwrap().to_owned()).collect();
    let bias = names.iter().position(|name| name == "df_1").unwrap();
    result["budget"]["degrees_of_freedom"][bias] = 10.7.into();
    fs::write(&file, result.to_string()).unwrap();
    let laboratory = example().join("laboratory.toml");
    let arguments = ["report", "result.json", "--html", "k.html", "--dcc", "k.xml", "--laboratory"];
    let run = copy.run(&[&arguments[..], &[laboratory.to_str().unwrap()]].concat());
    assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
    // A compensated reading takes the fewest degrees of the coefficients of its newtonometer: 2.28 of 2.00, less by its own noise.
    let expanded = |file: &str| {
        let text = fs::read_to_string(copy.out().join(file)).unwrap();
        let column = text.split("centrical_expandedUncertainty").nth(1).unwrap();
        let values = column.split("<si:valueXMLList>").nth(1).unwrap().split_once('<').unwrap().0;
        values.split(' ').map(|value| value.parse::<f64>().unwrap()).collect::<Vec<_>>()
    };
    for (few, many) in expanded("k.xml").iter().zip(expanded("certificate.xml")) {
        assert!((few / many - 2.28 / 2.0).abs() < 0.003, "{few} {many}");
    }
    let page = fs::read_to_string(copy.out().join("k.html")).unwrap();
    // 0.0020027 mg times 2.28, the factor of ten degrees in EA-4/02, annex E.
    assert!(page.contains("<td>−3.9524 ± 0.0046</td><td>mg</td><td>2.28 (10)</td>"), "k of Student's distribution");
    let dcc = fs::read_to_string(copy.out().join("k.xml")).unwrap();
    assert_eq!(dcc.matches("t-distribution").count(), 1);
    assert_eq!(dcc.matches("<si:coverageProbability>0.9545</si:coverageProbability>").count(), names.len());
}

/// A unit in counts: its nominal scale and bias stand in the result, in every document and in the code, which takes raw output.
#[test]
fn a_unit_in_counts() {
    let copy = Copy::new();
    let form = copy.session().join("experiment.toml");
    let text = fs::read_to_string(&form).unwrap();
    let counts = "output_unit = \"counts\"\ncounts = { scale = [1.0, 1.01, 0.99], bias = [0.5, 0.0, -0.25] }";
    assert!(text.contains("output_unit = \"m/s^2\""));
    fs::write(&form, text.replace("output_unit = \"m/s^2\"", counts)).unwrap();
    let laboratory = example().join("laboratory.toml");
    let run = copy.calibrate(&["--out", ".", "--laboratory", laboratory.to_str().unwrap()]);
    // 1: the scales are off by a hundredth, which the limits of the example do not take.
    assert!(matches!(run.status.code(), Some(0 | 1)), "{}", String::from_utf8_lossy(&run.stderr));
    let result: serde_json::Value = serde_json::from_slice(&fs::read(copy.out().join("result.json")).unwrap()).unwrap();
    let output = serde_json::json!({ "unit": "counts", "scale": [1.0, 1.01, 0.99], "bias": [0.5, 0.0, -0.25] });
    assert_eq!(result["output"], output);
    let page = fs::read_to_string(copy.out().join("report.html")).unwrap();
    assert!(page.contains("Nominal scale S") && page.contains("counts/(m/s²)") && page.contains("<td>−0.25</td>"));
    let dcc = fs::read_to_string(copy.out().join("certificate.xml")).unwrap();
    assert!(dcc.contains("refType=\"basic_nominalValue centrical_nominalScale\""));
    assert!(dcc.contains("<si:unitXMLList>\\metre\\tothe{-1}\\second\\tothe{2}</si:unitXMLList>"));
    copy.run(&["report", "result.json", "--code", "source", "--range", "250 g"]);
    let header = fs::read_to_string(copy.out().join("source/centrical_compensate.h")).unwrap();
    assert!(header.contains("#define CENTRICAL_RANGE 2.4516625e3"), "{header}");
    assert!(header.contains("in counts, by its nominal scale (1e0, 1.01e0, 9.9e-1) per m/s^2"), "{header}");
    assert!(header.contains("int centrical_compensate_raw("));
    // What the numbers reach, and which result they are of.
    assert!(header.contains("#define CENTRICAL_CALIBRATED_RANGE ") && header.contains("an extrapolation"), "{header}");
    assert!(header.contains(" * Calibrated range: ") && header.contains(" * Certified range: 250 g, "), "{header}");
    assert!(
        header.contains(" * Expanded uncertainty (95.45 %) at the calibrated range along axes 1, 2, 3: "),
        "{header}"
    );
    assert!(header.contains(" * From result.json, SHA-256 "), "{header}");
}

/// Beside a result of another data sheet a result before an adjustment stands relative to the same nominal values: the unit has not changed.
#[test]
fn a_result_before_is_relative_to_the_same_nominal_values() {
    let copy = Copy::new();
    let sheet = |from: &str, to: &str| copy.edit("experiment.toml", |text| text.replace(from, to));
    let counts =
        |scale: &str| format!("output_unit = \"counts\"\ncounts = {{ scale = {scale}, bias = [0.5, 0.0, -0.25] }}");
    let (first, second) = (counts("[1.0, 1.01, 0.99]"), counts("[1.02, 1.01, 0.97]"));
    let results = [("output_unit = \"m/s^2\"", first.as_str(), "before.json"), (&first, &second, "after.json")];
    let results = results.map(|(from, to, name)| {
        sheet(from, to);
        assert!(copy.calibrate(&["-q"]).status.code() != Some(2));
        fs::rename(copy.out().join("result.json"), copy.out().join(name)).unwrap();
        (CalibrationResult::read(&copy.out().join(name)).unwrap(), Path::new(name))
    });
    let [(before, of), (after, file)] = results;
    let beside = result_beside(before.clone(), of, &after, file).unwrap();
    for parameter in after.parameters.iter().filter(|p| p.name.starts_with("df_") || p.name.starts_with('G')) {
        let [was, now] = [&before, &beside].map(|result| result.parameter(&parameter.name).unwrap());
        let u = parameter.standard_uncertainty.unwrap();
        // Windows move by some samples where another scale is looked for.
        let off = (now.value.unwrap() - parameter.value.unwrap()) / u;
        assert!(off.abs() < 0.2, "{}: {off}", parameter.name);
        assert!((now.standard_uncertainty.unwrap() / u - 1.0).abs() < 0.02, "{}", parameter.name);
        assert!(parameter.name != "G0_11" || (was.value.unwrap() - parameter.value.unwrap()).abs() > 1e-2);
    }
    let mut in_volts = after.clone();
    in_volts.output.as_mut().unwrap().unit = "V".to_owned();
    assert!(result_beside(before, of, &in_volts, file).is_err());
}

/// A file that is not a picture, or too large a picture, is refused by name before anything is written.
#[test]
fn a_logo_is_checked() {
    let copy = calibrated("en");
    let text = fs::read_to_string(example().join("laboratory.toml")).unwrap();
    let text = text.replace("accreditation = ", "logo = \"logo.png\"\naccreditation = ");
    fs::write(copy.out().join("laboratory.toml"), text).unwrap();
    let report = || copy.run(&["report", "result.json", "--pdf", "l.pdf", "--laboratory", "laboratory.toml"]);
    let refused = |what: &str| {
        let run = report();
        let message = String::from_utf8_lossy(&run.stderr).into_owned();
        assert!(run.status.code() == Some(2) && message.contains("logo.png"), "{what}: {message}");
        assert!(message.contains("expected a PNG picture of up to 2048 pixels a side"), "{what}: {message}");
        assert!(!copy.out().join("l.pdf").exists(), "{what}");
    };
    refused("no file");
    fs::write(copy.out().join("logo.png"), "<svg/>").unwrap();
    refused("no PNG");
    fs::write(copy.out().join("logo.png"), vec![0; (1 << 20) + 1]).unwrap();
    refused("too large");
    let pixel = include_bytes!("pixel.png");
    fs::write(copy.out().join("logo.png"), &pixel[..pixel.len() - 20]).unwrap();
    refused("cut short");
    fs::write(copy.out().join("logo.png"), pixel).unwrap();
    assert_eq!(report().status.code(), Some(0));
    assert!(copy.out().join("l.pdf").exists());
    // An output must not take the place of the picture.
    let run = copy.run(&["report", "result.json", "--html", "logo.png", "--laboratory", "laboratory.toml"]);
    assert_eq!(run.status.code(), Some(2));
    assert_eq!(fs::read(copy.out().join("logo.png")).unwrap(), pixel);
}

/// Letters that the font lacks would be question marks on a signed document.
#[test]
fn letters_without_a_glyph_are_refused() {
    let copy = calibrated("en");
    let text = fs::read_to_string(example().join("laboratory.toml")).unwrap();
    fs::write(copy.out().join("l.toml"), text.replace("Northern Navigation Works", "中国 Works")).unwrap();
    let report = |form: &str| copy.run(&["report", "result.json", form, "l", "--laboratory", "l.toml"]);
    let run = report("--pdf");
    let message = String::from_utf8_lossy(&run.stderr).into_owned();
    let said =
        "l.toml, [customer], name: found the letters 中国, expected letters of Latin, Greek and Cyrillic alphabets";
    assert!(run.status.code() == Some(2) && message.contains(said), "{message}");
    assert!(!copy.out().join("l").exists());
    assert_eq!(report("--dcc").status.code(), Some(0));
}

/// Quantities without a stated uncertainty: the documents name them and claim no evaluation by the GUM, and `report` remarks them.
#[test]
fn what_counts_as_exact_is_said() {
    let laboratory = example().join("laboratory.toml");
    let report = |copy: &Copy| {
        assert_eq!(copy.calibrate(&[]).status.code(), Some(0));
        let run = copy.run(&[
            "report",
            "result.json",
            "--html",
            "h",
            "--dcc",
            "d",
            "--laboratory",
            laboratory.to_str().unwrap(),
        ]);
        let read = |file: &str| fs::read_to_string(copy.out().join(file)).unwrap();
        (String::from_utf8_lossy(&run.stderr).into_owned(), read("h"), read("d"))
    };
    let copy = Copy::new();
    let (remark, html, dcc) = report(&copy);
    assert!(remark.contains("COUNT AS EXACT  gravity, latitude, radius"), "{remark}");
    for document in [&html, &dcc] {
        assert!(document.contains("taken as exact and contribute nothing to it: gravity, latitude"), "{document}");
        assert!(document.contains("The statement presupposes that these quantities"), "{document}");
    }
    assert!(!dcc.contains("in accordance with JCGM 100"), "{dcc}");
    // 7.8.6.2 a: to which results the statement applies.
    assert!(dcc.contains("df₁: −0.038760 ± 0.000039 m/s²; limits −0.15 … 0.15 m/s²"), "{dcc}");

    copy.edit("experiment.toml", |text| {
        format!(
            "{text}\n[uncertainty]\ngravity = 1e-6\nlatitude = 1e-6\nradius = 1e-8\nspeed_scale = 1e-9\nrest_angle = 1e-9\n\
             proof_masses = 1e-9\nattitude = 1e-9\n"
        )
    });
    let (remark, html, dcc) = report(&copy);
    assert!(!remark.contains("COUNT AS EXACT"), "{remark}");
    for document in [&html, &dcc] {
        assert!(
            document.contains("in accordance with JCGM 100 (GUM) and EA-4/02. No input quantity is treated as exact.")
        );
        assert!(!document.contains("The statement presupposes"));
    }
}
