//! The live page in Chromium, while another process feeds the records.

use std::fs::{self, OpenOptions};
use std::io::Write;
use std::path::Path;
use std::process::Command;
use std::thread;
use std::time::Duration;

use serde_json::Value;
use tempfile::TempDir;

use crate::browser::Browser;
use crate::served::{Served, until};
use crate::{example, program};

fn session() -> TempDir {
    let folder = TempDir::new().unwrap();
    fs::create_dir_all(folder.path().join("records")).unwrap();
    fs::create_dir_all(folder.path().join("telemetry")).unwrap();
    fs::copy(example("experiment.toml"), folder.path().join("experiment.toml")).unwrap();
    for file in fs::read_dir(example("telemetry")).unwrap() {
        let file = file.unwrap();
        fs::copy(file.path(), folder.path().join("telemetry").join(file.file_name())).unwrap();
    }
    folder
}

fn watch(folder: &Path, address: &str) -> Command {
    let mut command = program::centrical();
    command.arg("watch").arg(folder).arg("--out").arg(folder.join("watched"));
    command.args(["--serve", address, "--interval", "0.1", "--frozen", "2", "--target", "bias=0.05", "--quiet", "60"]);
    command
}

/// A record comes bit by bit, lines in part.
fn feed(folder: &Path, number: usize, tenths: std::ops::Range<usize>) {
    let name = format!("records/m{number:02}.csv");
    let bytes = fs::read(example(&name)).unwrap();
    let place = |tenths: usize| tenths * bytes.len() / 10;
    let mut file = OpenOptions::new().create(true).append(true).open(folder.join(&name)).unwrap();
    for piece in bytes[place(tenths.start)..place(tenths.end)].chunks(bytes.len() / 5 + 1) {
        file.write_all(piece).unwrap();
        thread::sleep(Duration::from_millis(50));
    }
}

fn history(folder: &Path) -> Vec<Value> {
    let text = fs::read_to_string(folder.join("watched/watch-history.jsonl")).unwrap_or_default();
    text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect()
}

/// A number of the page as the server meant it.
fn number(browser: &mut Browser, selector: &str) -> Option<f64> {
    let found = browser.evaluate(&format!("document.querySelector('{selector}')?.dataset.value ?? null"));
    found.as_str().and_then(|text| text.parse().ok())
}

/// Waits until the page has the last plateau of the history, and compares its numbers with those of that line.
fn agrees(browser: &mut Browser, folder: &Path, at_least: usize) {
    until("the plateaus", || history(folder).len() >= at_least);
    let mut kept = Vec::new();
    until("the page", || {
        kept = history(folder);
        number(browser, "#arrived") == Some(kept.len() as f64)
    });
    let last = kept.last().unwrap();
    assert_eq!(number(browser, "#rank-now"), last["rank"].as_f64());
    assert_eq!(number(browser, "#test"), last["innovation"]["squared"].as_f64());
    let members = last["estimates"].as_array().unwrap().iter();
    let of_bias = members.filter(|estimate| estimate["name"].as_str().unwrap().starts_with("df_"));
    let largest = of_bias.filter_map(|estimate| estimate["standard_uncertainty"].as_f64()).reduce(f64::max);
    let shown = number(browser, "[data-group=bias] td[data-value]");
    assert_eq!(shown.is_some(), largest.is_some());
    // In mg.
    let ratio = shown.zip(largest).map_or(1.0, |(shown, largest)| shown / (largest / 9.80665e-3));
    assert!((ratio - 1.0).abs() < 1e-12, "{ratio}");
    assert_eq!(browser.evaluate("document.getElementById('connection').hidden"), Value::Bool(true));
}

/// The numbers of the page are those of the history at each step: as records grow, with the recorder paused, after a killed and
/// restarted watch, in a page that is opened later; and nothing is wider than the screen.
#[test]
#[ignore = "needs Chromium"]
fn the_page_shows_the_history_at_each_step() {
    let folder = session();
    let folder = folder.path();
    let mut served = Served::start(&mut watch(folder, "127.0.0.1:0"));
    let address = served.address.to_string();
    let url = format!("http://{address}/");
    let mut browser = Browser::open(&url);
    until("the page", || number(&mut browser, "#arrived") == Some(0.0));
    feed(folder, 1, 0..10);
    feed(folder, 2, 0..5);
    agrees(&mut browser, folder, 10);

    // The recorder pauses: the age grows by itself, and the alarm shows.
    until("the alarm", || browser.evaluate("document.getElementById('frozen') !== null") == Value::Bool(true));
    let age = "Number(document.getElementById('age').textContent)";
    assert!(browser.evaluate(age).as_f64().unwrap() >= 2.0);
    feed(folder, 2, 5..10);
    until("the end of the alarm", || {
        browser.evaluate("document.getElementById('frozen') !== null") == Value::Bool(false)
    });

    // The watch is killed: the page says so, and takes up again by itself where the next one serves.
    served.kill();
    until("no connection", || browser.evaluate("document.getElementById('connection').hidden") == Value::Bool(false));
    feed(folder, 3, 0..10);
    feed(folder, 4, 0..3);
    let mut served = Served::start(&mut watch(folder, &address));
    agrees(&mut browser, folder, 27);

    // A page that is opened later, in the other language, shows all.
    drop(browser);
    let mut browser = Browser::open(&format!("{url}?lang=ru"));
    agrees(&mut browser, folder, 27);
    assert!(browser.evaluate("document.body.innerText").as_str().unwrap().contains("Сеанс отслеживается"));
    for width in [390, 1280, 1920] {
        browser.resize(width);
        let wide = browser.evaluate("document.documentElement.scrollWidth").as_f64().unwrap();
        assert!(wide <= f64::from(width), "{wide} at {width}");
    }
    let reason = browser.evaluate("document.querySelector('#rank details p').textContent");
    assert!(reason.as_str().unwrap().contains("прибора"), "{reason}");
    // What is open stays open while the events come.
    browser.evaluate("document.querySelector('#rank details').open = true");
    thread::sleep(Duration::from_secs(2));
    assert_eq!(browser.evaluate("document.querySelector('#rank details').open"), Value::Bool(true));
    assert_eq!(served.interrupt(), Some(0));
}
