//! Headless Chromium.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;
use tempfile::TempDir;

/// What the reader prefers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scheme {
    Light,
    Dark,
}

/// Everything that was found in a page, and everything Chromium says on the console.
pub fn look(page: &str, width: u32, scheme: Scheme) -> (Value, String) {
    let folder = TempDir::new().unwrap();
    let escaped = page.replace('&', "&amp;").replace('"', "&quot;");
    let probe = include_str!("probe.js");
    let text = format!(
        "<!DOCTYPE html><meta charset=utf-8><meta name=color-scheme content=\"light dark\"><script>{probe}</script>\
         <body onload=look()><pre id=found>{{}}</pre>\
         <iframe id=page style=\"border:0;width:{width}px;height:900px\" srcdoc=\"{escaped}\"></iframe>"
    );
    let file = folder.path().join("probe.html");
    fs::write(&file, text).unwrap();
    let run = chromium(folder.path(), scheme, &["--dump-dom", &format!("file://{}", file.display())]);
    let dom = String::from_utf8_lossy(&run.stdout).into_owned();
    let found = dom.split_once("<pre id=\"found\">").and_then(|(_, rest)| rest.split_once("</pre>"));
    let found = found.map_or("", |(found, _)| found).replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&");
    let console = String::from_utf8_lossy(&run.stderr);
    let console = console.lines().filter(|line| line.contains("CONSOLE")).collect::<Vec<_>>().join("\n");
    (serde_json::from_str(&found).unwrap_or_else(|error| panic!("{error}: {found}\n{console}")), console)
}

/// The page printed, a PDF file.
pub fn print(page: &Path, scheme: Scheme, pdf: &Path) {
    let folder = TempDir::new().unwrap();
    let to = format!("--print-to-pdf={}", pdf.display());
    let run = chromium(folder.path(), scheme, &[&to, "--no-pdf-header-footer", &format!("file://{}", page.display())]);
    assert!(pdf.exists(), "{}", String::from_utf8_lossy(&run.stderr));
}

fn chromium(profile: &Path, scheme: Scheme, arguments: &[&str]) -> Output {
    let flags = "--headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking \
                 --disable-component-update --disable-sync --enable-logging=stderr --window-size=1400,1000";
    let mut command = Command::new("chromium");
    command.args(flags.split_whitespace()).arg(format!("--user-data-dir={}", profile.join("profile").display()));
    // Blink counts dark as 0 and light as 1.
    command.arg(format!("--blink-settings=preferredColorScheme={}", u8::from(scheme == Scheme::Light)));
    command.args(arguments).output().expect("chromium is installed")
}
