//! The documents as others read them: the page in headless Chromium, the certificate by poppler's pdftotext.
//!
//! Needs the programs `chromium` and `pdftotext` (Debian: chromium, poppler-utils); run with `--ignored`.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use tempfile::TempDir;

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/ta-200").join(name)
}

/// A folder with all documents of the example.
fn documents(language: &str) -> TempDir {
    let folder = TempDir::new().unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_centrical"));
    command.arg("calibrate").arg(example("")).arg("--out").arg(folder.path()).args(["--language", language]);
    let run = command.arg("--laboratory").arg(example("laboratory.toml")).output().unwrap();
    assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
    folder
}

/// What a page does to the document's title once it is loaded: counts and widths, for the test to read.
const PROBE: &str = "<script>onload=()=>{const d=document.getElementById('f').contentDocument;\
const s=[...d.querySelectorAll('figure svg')];\
const empty=s.filter(x=>{const b=x.getBBox();return b.width<50||b.height<50||x.querySelectorAll('path,rect,line').length<4});\
const small=[...d.querySelectorAll('p,td,th,h1,h2,h3,figcaption')].filter(x=>x.getBoundingClientRect().right>d.documentElement.clientWidth+1&&!x.closest('.scroll'));\
document.title='figures '+s.length+' empty '+empty.length+' wide '+d.documentElement.scrollWidth+' of '+d.documentElement.clientWidth+' outside '+small.length}</script>";

/// Title that the probe leaves, and everything Chromium says on the console.
fn probe(page: &str, width: u32) -> (String, String) {
    let folder = TempDir::new().unwrap();
    let escaped = page.replace('&', "&amp;").replace('"', "&quot;");
    let frame = format!("<iframe id=f style=\"border:0;width:{width}px;height:900px\" srcdoc=\"{escaped}\"></iframe>");
    let file = folder.path().join("probe.html");
    fs::write(&file, format!("<!DOCTYPE html><meta charset=utf-8><title>-</title>{PROBE}<body>{frame}")).unwrap();
    let flags = "--headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking \
                 --disable-component-update --disable-sync --enable-logging=stderr --dump-dom";
    let mut command = Command::new("chromium");
    command.args(flags.split_whitespace()).arg(format!("--user-data-dir={}", folder.path().join("profile").display()));
    let run = command.arg(format!("file://{}", file.display())).output().expect("chromium is installed");
    let dom = String::from_utf8_lossy(&run.stdout).into_owned();
    let title = dom.split_once("<title>").and_then(|(_, rest)| rest.split_once("</title>")).map(|(title, _)| title);
    let console = String::from_utf8_lossy(&run.stderr);
    let console = console.lines().filter(|line| line.contains("CONSOLE")).collect::<Vec<_>>().join("\n");
    (title.unwrap_or("no title").to_owned(), console)
}

/// Every plot present and drawn, nothing wider than the page, nothing said on the console.
#[test]
#[ignore = "needs chromium"]
fn the_page_in_a_browser() {
    for language in ["en", "ru"] {
        let folder = documents(language);
        let page = fs::read_to_string(folder.path().join("report.html")).unwrap();
        for width in [1280, 400] {
            let (title, console) = probe(&page, width);
            // 8 single figures and 12 records.
            let words: Vec<&str> = title.split(' ').collect();
            assert_eq!(words[..4], ["figures", "20", "empty", "0"], "{language} {width}: {title}");
            assert_eq!(words[5], words[7], "{language}: wider than {width}: {title}");
            assert_eq!(words[9], "0", "{language} {width}: {title}");
            assert_eq!(console, "");
        }
    }
}

/// Every item that ISO/IEC 17025, 7.8.2.1 and 7.8.4.1 ask for, in the text of the certificate.
#[test]
#[ignore = "needs pdftotext"]
fn the_certificate_has_every_item() {
    let folder = documents("en");
    let mut command = Command::new("pdftotext");
    let run = command.arg("-layout").arg(folder.path().join("certificate.pdf")).arg("-").output();
    let text = String::from_utf8(run.expect("pdftotext is installed").stdout).unwrap();
    let items = [
        ("7.8.2.1 a, title", "Calibration certificate"),
        ("b, laboratory", "Centrifuge Laboratory, Institute of Inertial Metrology"),
        ("b, address", "Leninskiye Gory 1, 119991 Moscow, RU"),
        ("c, place", "the laboratory’s premises"),
        ("d, end", "End of certificate"),
        ("e, customer", "Northern Navigation Works"),
        ("e, address", "Embankment 12, 190000 Saint Petersburg, RU"),
        ("f, method", "by the method of A. V. Kozlov"),
        ("f, procedure", "CL-MP-07, edition 3"),
        ("g, item", "Unit of three newtonometers"),
        ("g, model", "TA-200"),
        ("g, serial number", "0001"),
        ("g, condition", "No visible damage, complete"),
        ("h, receipt", "2026-10-01"),
        ("i, performance", "2026-10-05 – 2026-10-07"),
        ("j, issue", "2026-10-09"),
        ("l, item only", "The results relate only to the item calibrated"),
        ("m, results with sign and unit", "−3.9525 ± 0.0040 mg"),
        ("n, deviations", "Additions, deviations, exclusions"),
        ("o, authorised", "A. Ivanova"),
        ("7.8.4.1 a, coverage", "coverage factor k = 2"),
        ("b, conditions", "20.3 ± 0.5 °C"),
        ("c, traceability", "GET 94-2001"),
        ("d, adjustment", "Before and after adjustment"),
        ("e, conformity", "conforms"),
        ("7.8.6, rule", "guarded acceptance"),
    ];
    for (item, expected) in items {
        assert!(text.contains(expected), "{item}: {expected:?} is not in\n{text}");
    }
    let pages: Vec<&str> = text.split('\u{c}').filter(|page| !page.trim().is_empty()).collect();
    for (n, page) in pages.iter().enumerate() {
        assert!(page.contains(&format!("page {} of {}", n + 1, pages.len())), "page {}", n + 1);
        assert!(page.contains("Certificate no. CL-2026-0117"), "page {}", n + 1);
    }
}
