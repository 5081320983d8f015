//! The report, as a reader sees it.

use std::fs;
use std::process::Command;

use serde_json::{Value, json};

use crate::chromium::{Scheme, look, print};
use crate::documents;

/// Figures of the example's page in their order, with how many drawings each has: a panel for each position, a panel
/// for each newtonometer, a strip for each record.
const FIGURES: [(&str, usize); 10] = [
    ("before", 3),
    ("after", 3),
    ("prediction", 1),
    ("positions", 6),
    ("residuals", 1),
    ("normalised", 1),
    ("correlation", 1),
    ("singular-values", 1),
    ("convergence", 1),
    ("records", 12),
];

fn list(found: &Value, name: &str) -> Vec<String> {
    found[name].as_array().unwrap().iter().map(|text| text.as_str().unwrap().to_owned()).collect()
}

/// What must hold of every page at every width and in every scheme.
fn is_sound(found: &Value, console: &str, scheme: Scheme, what: &str) {
    assert_eq!(console, "", "{what}");
    assert_eq!(found["width"], found["client"], "{what}: the page is wider than its window");
    for defect in ["outside", "cut", "clashes", "faint_text", "faint_marks"] {
        assert_eq!(list(found, defect), Vec::<String>::new(), "{what}: {defect}");
    }
    assert!(found["texts"].as_u64().unwrap() > 300, "{what}: contrast was looked at");
    assert_eq!(found["ground"].as_f64().unwrap() < 0.1, scheme == Scheme::Dark, "{what}: ground");
}

fn is_drawn(figure: &Value, what: &str) {
    let id = &figure["id"];
    for drawing in figure["drawings"].as_array().unwrap() {
        let number = |name: &str| drawing[name].as_f64().unwrap();
        assert!(number("width") > 150.0 && number("height") > 150.0, "{what}, {id}: {drawing}");
        assert!(number("shapes") >= 8.0 && number("data") >= 3.0, "{what}, {id}: {drawing}");
        // Positions have no values.
        assert!(number("hover") >= 3.0 || id == "positions", "{what}, {id}: nothing on hover, {drawing}");
        assert_ne!(drawing["label"], "", "{what}, {id}");
    }
}

/// Every figure present, drawn and with its sentence; nothing outside, cut, on top of another or faint; nothing said on
/// the console: in both languages, at both widths, in light and dark.
#[test]
#[ignore = "needs chromium"]
fn the_page_in_a_browser() {
    for language in ["en", "ru"] {
        let folder = documents(language, |text| text);
        let page = fs::read_to_string(folder.path().join("report.html")).unwrap();
        // Closed, as it comes, and with every section opened.
        for (width, scheme) in [(1280, Scheme::Light), (390, Scheme::Dark)] {
            let (found, console) = look(&page, width, scheme);
            is_sound(&found, &console, scheme, &format!("{language}, {width} px, {scheme:?}, closed"));
        }
        let page = page.replace("<details>", "<details open>");
        for (width, scheme) in [(1280, Scheme::Light), (1280, Scheme::Dark), (390, Scheme::Light), (390, Scheme::Dark)]
        {
            let what = format!("{language}, {width} px, {scheme:?}");
            let (found, console) = look(&page, width, scheme);
            is_sound(&found, &console, scheme, &what);
            let figures = found["figures"].as_array().unwrap();
            let drawn = figures.iter().map(|f| (f["id"].as_str().unwrap(), f["drawings"].as_array().unwrap().len()));
            assert_eq!(drawn.collect::<Vec<_>>(), FIGURES, "{what}");
            for figure in figures {
                is_drawn(figure, &what);
                let caption = figure["caption"].as_str().unwrap();
                assert!(caption.ends_with('.') && caption.split(' ').count() >= 8, "{what}: {figure}");
                let smallest = figure["smallest_text"].as_f64().unwrap();
                assert!(smallest >= 8.0, "{what}, {}: text of {smallest} px", figure["id"]);
            }
        }
    }
}

/// The probe has power: each spoiled page is found out.
#[test]
#[ignore = "needs chromium"]
fn the_probe_finds_what_is_wrong() {
    let folder = documents("en", |text| text);
    let page = fs::read_to_string(folder.path().join("report.html")).unwrap();
    let spoiled = |from: &str, to: &str| {
        assert!(page.contains(from), "{from}");
        look(&page.replace(from, to).replace("<details>", "<details open>"), 400, Scheme::Light)
    };
    let (found, _) = spoiled("<footer>", "<div style=\"width:700px\">wide</div><footer>");
    assert!(!list(&found, "outside").is_empty() && found["width"] != found["client"]);
    let (found, _) = spoiled("--soft:#57606a", "--soft:#a7b0ba");
    assert!(!list(&found, "faint_text").is_empty());
    let (found, _) = spoiled(".plot .s0{stroke:#0072b2", ".plot .s0{stroke:#d0e0ff");
    assert!(!list(&found, "faint_marks").is_empty());
    let (found, _) = spoiled("figure .plot:not(.panel) text{font-size:18px}", "figure .plot text{font-size:34px}");
    assert!(!list(&found, "clashes").is_empty() && !list(&found, "cut").is_empty());
    let (_, console) = spoiled("<footer>", "<script>console.error('no')</script><footer>");
    assert!(console.contains("no"));
    let (found, _) = spoiled("<figure id=\"after\">", "<figure id=\"after\"><svg viewBox=\"0 0 9 9\"></svg>");
    let after = found["figures"].as_array().unwrap().iter().find(|f| f["id"] == "after").unwrap();
    assert_eq!((after["drawings"][0]["shapes"].clone(), after["drawings"].as_array().unwrap().len()), (json!(0), 4));
}

/// On paper: light whatever the screen, no figure lost, nothing cut off at the right.
#[test]
#[ignore = "needs chromium and poppler"]
fn the_page_on_paper() {
    let folder = documents("en", |text| text);
    let page = folder.path().join("report.html");
    for scheme in [Scheme::Light, Scheme::Dark] {
        let pdf = folder.path().join("page.pdf");
        print(&page, scheme, &pdf);
        let text = crate::certificate::text_of(&pdf);
        for title in [
            "Calibration acceptable",
            "G2₃₃",
            "Position 6",
            "Newtonometer 3",
            "Residuals by plateau",
            "Mounting 12",
            "SHA-256",
        ] {
            assert!(text.contains(title), "{scheme:?}: {title}");
        }
        let pages = text.matches('\u{c}').count();
        assert!((6..=16).contains(&pages), "{pages} pages");
        let shades = shades(&pdf, folder.path());
        assert!(shades.iter().all(|mean| *mean > 0.8), "{scheme:?}: mean shades of the pages {shades:?}");
    }
}

/// Mean shade of each page, 0 black to 1 white.
fn shades(pdf: &std::path::Path, folder: &std::path::Path) -> Vec<f64> {
    let mut command = Command::new("pdftoppm");
    let run = command.args(["-r", "20", "-gray"]).arg(pdf).arg(folder.join("sheet")).output();
    assert!(run.expect("pdftoppm is installed").status.success());
    let mut files: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|file| file.extension().is_some_and(|extension| extension == "pgm"));
    files.sort();
    let shade = |file: &std::path::PathBuf| {
        let bytes = fs::read(file).unwrap();
        // After a header of three lines, one byte a pixel.
        let header: usize = bytes.split_inclusive(|b| *b == b'\n').take(3).map(<[u8]>::len).sum();
        let pixels = &bytes[header..];
        pixels.iter().map(|b| f64::from(*b)).sum::<f64>() / (255.0 * pixels.len() as f64)
    };
    files.iter().map(shade).collect()
}
