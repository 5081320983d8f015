//! `centrical watch --serve` and `centrical view`: what they answer, and what they refuse.

use std::fs::{self, OpenOptions};
use std::io::{Read, Write};
use std::net::TcpListener;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant, SystemTime};

use serde_json::Value;

use crate::program;
use crate::served::{Served, until};
use crate::session::{Copy, example};

fn watch(copy: &Copy, further: &[&str]) -> Command {
    let mut command = program::centrical();
    command.arg("watch").arg(copy.session()).args(["--serve", "127.0.0.1:0", "--interval", "0.05"]);
    command.args(further).current_dir(copy.out());
    command
}

/// A session without records yet.
fn empty() -> Copy {
    let copy = Copy::new();
    let records = copy.session().join("records");
    fs::remove_dir_all(&records).unwrap();
    fs::create_dir(&records).unwrap();
    copy
}

/// A record appears whole, as a logger does that shows whole files only.
fn bring(copy: &Copy, number: usize) {
    let (name, records) = (format!("m{number:02}.csv"), copy.session().join("records"));
    fs::copy(example().join("records").join(&name), records.join("coming")).unwrap();
    fs::rename(records.join("coming"), records.join(&name)).unwrap();
}

fn state(served: &Served) -> Value {
    serde_json::from_str(&served.get("/state.json").1).unwrap()
}

fn history(out: &Path) -> Vec<Value> {
    let text = fs::read_to_string(out.join("watch-history.jsonl")).unwrap_or_default();
    text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect()
}

/// Everything in a folder: names and bytes.
fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let file = |entry: fs::DirEntry| (entry.file_name().into_string().unwrap(), fs::read(entry.path()).unwrap());
    let mut files: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| file(entry.unwrap())).collect();
    files.sort();
    files
}

/// The value of a metric.
fn metric(served: &Served, name: &str) -> f64 {
    let text = served.get("/metrics").1;
    let line = text.lines().find_map(|line| line.strip_prefix(name)).unwrap_or_else(|| panic!("no {name} in {text}"));
    line.trim().parse().unwrap()
}

/// The state is that of the history, over a kill and a restart to the end; then the page of the finished session stays.
#[test]
fn the_state_is_that_of_the_history_over_a_kill() {
    let copy = empty();
    let mut served = Served::start(&mut watch(&copy, &["--target", "bias=0.05"]));
    assert_eq!((state(&served)["arrived"].as_u64(), state(&served)["rank"].as_u64()), (Some(0), Some(0)));
    let page = served.get("/").1;
    assert!(page.contains("No plateau has arrived yet."));
    // Without scripts it is loaded again, and says of when it is.
    assert!(page.contains("<noscript><meta http-equiv=\"refresh\" content=\"10\"></noscript></head>"), "{page}");
    let (_, time) = page.split_once("<noscript><p id=\"state\">As of ").unwrap();
    let (time, _) = time.split_once(" UTC. ").unwrap();
    let time = time.split(':').fold(0, |sum, part| 60 * sum + part.parse::<u64>().unwrap());
    let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap().as_secs() % 86_400;
    assert!((86_400 + now - time) % 86_400 < 60, "{time} {now}");
    for number in 1..=3 {
        bring(&copy, number);
    }
    until("eighteen plateaus", || state(&served)["arrived"].as_u64() >= Some(18));
    let (shown, kept) = (state(&served), history(&copy.out()));
    let arrived = usize::try_from(shown["arrived"].as_u64().unwrap()).unwrap();
    assert_eq!(
        (&shown["rank"], &shown["last"]["innovation"]),
        (&kept[arrived - 1]["rank"], &kept[arrived - 1]["innovation"])
    );
    assert!(served.get("/").1.contains(&format!("data-value=\"{}\"", kept[arrived - 1]["innovation"]["squared"])));
    served.kill();

    for number in 4..=12 {
        bring(&copy, number);
    }
    let mut served = Served::start(&mut watch(&copy, &["--target", "bias=0.05", "--quiet", "0"]));
    assert!(state(&served)["arrived"].as_u64() >= Some(18), "the state before the kill is not there at once");
    until("the end", || state(&served)["status"] == "complete");
    let (shown, kept) = (state(&served), history(&copy.out()));
    assert_eq!((shown["arrived"].as_u64(), kept.len()), (Some(108), 108));
    assert_eq!((shown["rank"].as_u64(), &shown["acceptable"]), (Some(49), &Value::Bool(true)));
    // The largest uncertainty of a group is that of its members in the history.
    let bias = shown["groups"].as_array().unwrap().iter().find(|group| group["group"] == "bias").unwrap();
    let members = kept[107]["estimates"].as_array().unwrap().iter();
    let of_bias = members.filter(|estimate| estimate["name"].as_str().unwrap().starts_with("df_"));
    let largest = of_bias.map(|estimate| estimate["standard_uncertainty"].as_f64().unwrap()).fold(0.0, f64::max);
    let expected = largest * bias["scale"].as_f64().unwrap();
    assert!((bias["largest"].as_f64().unwrap() / expected - 1.0).abs() < 1e-12);
    assert_eq!((&bias["is_met"], metric(&served, "centrical_plateaus_arrived")), (&Value::Bool(true), 108.0));
    // The telemetry of the example is a witness of its speeds.
    assert!(shown["speeds"].as_array().unwrap().len() >= 84, "{}", shown["speeds"]);
    assert!(!shown["record"]["clock_offset"].is_null());
    assert_eq!(served.interrupt(), Some(0));
}

/// Whatever is asked: nothing but what the site has, nothing is written, and every refusal is counted.
#[test]
fn hostile_requests_are_refused_and_counted() {
    let copy = Copy::new();
    let served = Served::start(&mut watch(&copy, &["--quiet", "0"]));
    until("the end", || state(&served)["status"] == "complete");
    // The plot is the last file that a watch writes.
    until("the plot", || copy.out().join("watch-history.svg").exists());
    let before = contents(&copy.out());
    let host = format!("Host: {}", served.address);
    let asked = |head: &str| served.raw(format!("{head}\r\nConnection: close\r\n\r\n").as_bytes());
    let status = |head: &str| asked(head).get(9..12).map(str::to_owned).unwrap_or_default();

    for path in [
        "/../Cargo.toml",
        "/..%2f..%2fetc/passwd",
        "//etc/passwd",
        "/watch.json",
        "/result.json",
        "/live.js/",
        "/%00",
        "/?lang=%3Cscript%3E",
    ] {
        let found = status(&format!("GET {path} HTTP/1.1\r\n{host}"));
        assert_eq!(found, if path.starts_with("/?") { "200" } else { "404" }, "{path}");
    }
    for method in ["POST", "PUT", "DELETE", "OPTIONS", "TRACE", "CONNECT", "PROPFIND"] {
        let target = if method == "CONNECT" { "elsewhere:443" } else { "/" };
        assert_eq!(status(&format!("{method} {target} HTTP/1.1\r\n{host}\r\nContent-Length: 0")), "405", "{method}");
    }
    for foreign in ["Host: evil.example", "Host: evil.example:80", "Host:", "X: y", &format!("{host}\r\n{host}")] {
        assert_eq!(status(&format!("GET /state.json HTTP/1.1\r\n{foreign}")), "421", "{foreign}");
    }
    for site in ["cross-site", "same-site"] {
        assert_eq!(status(&format!("GET /state.json HTTP/1.1\r\n{host}\r\nSec-Fetch-Site: {site}")), "403");
    }
    let long = "a".repeat(2000);
    assert_eq!(status(&format!("GET /{long} HTTP/1.1\r\n{host}")), "414");
    assert_eq!(status(&format!("GET http://evil.example/ HTTP/1.1\r\n{host}")), "414");
    for head in [
        format!("GET / HTTP/1.1\r\n{host}\r\nX: {}", "a".repeat(1 << 20)),
        format!("GET / HTTP/1.1\r\n{host}{}", "\r\nX: y".repeat(1000)),
        "\x16\x03\x01\x02\x00\x01\x00\x01\u{7f}".to_owned(),
        format!("GET / HTTP/9.9\r\n{host}"),
    ] {
        let found = status(&head);
        assert!(found.is_empty() || found.starts_with('4'), "{found}");
    }
    // A body that never comes, and a head that comes a byte a second.
    let begun = Instant::now();
    let mut slow = served.connect();
    slow.write_all(b"GET / HTTP/1.1\r\n").unwrap();
    let mut rest = Vec::new();
    slow.read_to_end(&mut rest).unwrap();
    assert!(begun.elapsed() < Duration::from_secs(20), "a slow head is waited for");

    let counted = |reason: &str| metric(&served, &format!("centrical_http_refused_total{{reason=\"{reason}\"}}"));
    assert_eq!([counted("method"), counted("host"), counted("cross-site"), counted("target")], [7.0, 5.0, 2.0, 2.0]);
    assert!(counted("slow") >= 1.0 && counted("malformed") >= 2.0);
    assert_eq!(contents(&copy.out()), before);
    assert_eq!(served.get("/state.json").0, 200);
}

/// Viewers are served the newest state while one never reads, and the watch goes on.
#[test]
fn a_viewer_that_never_reads_holds_nobody_up() {
    let copy = empty();
    let served = Served::start(&mut watch(&copy, &[]));
    let ask = format!("GET /events HTTP/1.1\r\nHost: {}\r\n\r\n", served.address);
    let viewers: Vec<_> = (0..100).map(|_| served.connect()).collect();
    for mut viewer in &viewers {
        viewer.write_all(ask.as_bytes()).unwrap();
    }
    for number in 1..=2 {
        bring(&copy, number);
    }
    until("nine plateaus", || state(&served)["arrived"].as_u64() >= Some(9));
    // All but the first read; everything comes that has not been skipped.
    for viewer in &viewers[1..] {
        let (mut viewer, mut text, mut bytes) = (viewer, String::new(), vec![0; 1 << 16]);
        while !text.contains("id=\"arrived\" data-value=\"9\"") && !text.contains("id=\"arrived\" data-value=\"1") {
            let n = viewer.read(&mut bytes).unwrap();
            assert!(n > 0, "the events ended: {text}");
            text.push_str(&String::from_utf8_lossy(&bytes[..n]));
        }
    }
    assert!(metric(&served, "centrical_http_connections") >= 100.0);
    let status = fs::read_to_string(format!("/proc/{}/status", served.child.id())).unwrap();
    let resident = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap();
    let kib: u64 = resident.trim().trim_end_matches("kB").trim().parse().unwrap();
    assert!(kib < 100_000, "{kib} kiB with 100 viewers");
}

#[test]
fn names_of_files_never_become_markup() {
    let copy = empty();
    copy.edit("experiment.toml", |text| {
        let title = "title = \"<img src=x onerror=alert(1)>\"";
        let old = text.lines().find(|line| line.starts_with("title")).unwrap().to_owned();
        text.replace(&old, title)
    });
    let served = Served::start(&mut watch(&copy, &[]));
    for path in ["/", "/?lang=ru"] {
        let (status, page) = served.get(path);
        assert!(
            status == 200 && page.contains("&lt;img src=x onerror=alert(1)&gt;") && !page.contains("<img"),
            "{page}"
        );
    }
}

/// A recorder that stops in the midst of a mounting raises the alarm within seconds, on the page and by the command.
#[test]
fn a_frozen_record_raises_the_alarm() {
    let copy = empty();
    let command = "echo \"$CENTRICAL_ALARM $CENTRICAL_MESSAGE\" >> alarms.txt";
    let served = Served::start(&mut watch(&copy, &["--frozen", "1", "--on-alarm", command]));
    let record = fs::read(example().join("records/m01.csv")).unwrap();
    let mut file = OpenOptions::new().create(true).append(true).open(copy.session().join("records/m01.csv")).unwrap();
    file.write_all(&record[..record.len() / 3]).unwrap();
    until("the record", || state(&served)["record"]["samples"].as_u64() > Some(1000));
    file.write_all(&record[record.len() / 3..record.len() / 2]).unwrap();
    let stopped = Instant::now();
    let alarms = copy.out().join("alarms.txt");
    until("the alarm", || alarms.exists() && state(&served)["record"]["frozen"] == true);
    assert!(stopped.elapsed() < Duration::from_secs(5), "{:?}", stopped.elapsed());
    assert!(served.get("/").1.contains("The record has stopped growing"));
    until("the text of the alarm", || fs::read_to_string(&alarms).unwrap().starts_with("frozen "));
    // It goes on: the alarm ends. It grows as long as that is looked for, since a second without a sample would raise the alarm again.
    let mut pieces = record[record.len() / 2..].chunks(128);
    until("the end of the alarm", || {
        file.write_all(pieces.next().unwrap()).unwrap();
        state(&served)["record"]["frozen"] == false
    });
}

#[test]
fn addresses_that_cannot_be_served_are_refused_before_anything_is_done() {
    let copy = Copy::new();
    let session = copy.session();
    let taken = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = taken.local_addr().unwrap().to_string();
    for (address, found) in [
        (address.as_str(), "found a port in use by another program, expected a free port"),
        ("nowhere", "found no address with a port, expected an address and a port"),
        ("127.0.0.1:99999", "found no address with a port, expected an address and a port"),
        ("192.0.2.1:8080", "expected an address and a port of this machine"),
    ] {
        for arguments in
            [&["watch", session.to_str().unwrap(), "--serve", address][..], &["view", ".", "--serve", address]]
        {
            fs::write(copy.out().join("watch-live.json"), "{}").unwrap();
            let run = copy.run(arguments);
            let said = String::from_utf8_lossy(&run.stderr).into_owned();
            assert_eq!(run.status.code(), Some(2), "{arguments:?} {said}");
            assert!(said.contains(&format!("--serve {address}: ")) && said.contains(found), "{said}");
        }
    }
    assert_eq!(copy.left_behind(), ["watch-live.json"]);
}

/// The pages of a store are those that `history page` writes, and follow the store.
#[test]
fn a_store_is_shown_as_its_pages() {
    let copy = Copy::new();
    let run = |arguments: &[&str]| assert!(copy.run(arguments).status.success(), "{arguments:?}");
    assert!(copy.calibrate(&["--out", "first", "-q"]).status.success());
    let first = fs::read_to_string(copy.out().join("first/result.json")).unwrap();
    let of_year = |year: usize| {
        let text = first.replace("\"date\": \"2026-10-05\"", &format!("\"date\": \"{year}-10-05\""));
        assert_ne!(text, first);
        fs::write(copy.out().join(format!("{year}.json")), text).unwrap();
        run(&["history", "add", "store", &format!("{year}.json"), "-q"]);
    };
    of_year(2027);
    of_year(2028);
    let (status, code) = (copy.run(&["view", "store", "first"]), Some(2));
    assert!(
        status.status.code() == code && String::from_utf8_lossy(&status.stderr).contains("expected this store alone")
    );
    let mut command = program::centrical();
    command.args(["view", "store", "--limit", "300 ug", "--serve", "127.0.0.1:0"]).current_dir(copy.out());
    let served = Served::start(&mut command);
    let is_shown_as_written = || {
        run(&["history", "page", "store", "--limit", "300 ug", "--out", "pages", "-q"]);
        let mut pages = 0;
        for (name, bytes) in contents(&copy.out().join("pages")) {
            let written = String::from_utf8(bytes).unwrap();
            // The page of a unit names its origin in the second line, and when it is due in the next.
            let lines = |page: &str| -> Vec<String> {
                page.lines().filter(|line| !line.starts_with("<!-- ")).map(str::to_owned).collect()
            };
            let (status, shown) = served.get(&format!("/{name}"));
            assert!(status == 200 && lines(&shown) == lines(&written), "{name}: {shown}");
            pages += 1;
        }
        assert!(served.get("/").1 == served.get("/index.html").1);
        pages
    };
    assert_eq!(is_shown_as_written(), 5);
    assert_eq!(served.get("/").1.matches("<tr><td>").count(), 2);
    of_year(2029);
    assert_eq!(served.get("/").1.matches("<tr><td>").count(), 3);
    assert_eq!(is_shown_as_written(), 5);
    for path in ["/unit-0001.html", "/rows/x", "/../store/lock", "/compare", "/live"] {
        assert_eq!(served.get(path).0, 404, "{path}");
    }
}

/// The folder goes away under a watch: it ends with the name of the file.
#[test]
fn a_folder_that_vanishes_ends_the_watch() {
    let copy = empty();
    let mut served = Served::start(&mut watch(&copy, &["--out", "watched"]));
    until("the state", || served.get("/state.json").0 == 200);
    fs::remove_dir_all(copy.out().join("watched")).unwrap();
    assert_eq!(served.child.wait().unwrap().code(), Some(2));
}

/// Finished work: the list, a report, two compared, a file of another kind; and the page of a watch that was killed.
#[test]
fn finished_work_is_listed_reported_and_compared() {
    let copy = Copy::new();
    assert_eq!(copy.calibrate(&["--out", "a"]).status.code(), Some(0));
    assert_eq!(copy.calibrate(&["--out", "b", "--method", "recursive"]).status.code(), Some(0));
    fs::create_dir(copy.out().join("c")).unwrap();
    fs::write(copy.out().join("c/result.json"), "{\"<b>\": 1}").unwrap();
    let mut command = program::centrical();
    let mut served = Served::start(command.args(["view", ".", "--serve", "127.0.0.1:0"]).current_dir(copy.out()));
    let (status, list) = served.get("/");
    assert_eq!((status, list.matches("class=\"good\">acceptable").count()), (200, 2), "{list}");
    assert!(list.contains("cannot be read") && !list.contains("<b>"));
    let report = |list: &str, file: &str| {
        let row = list.lines().find(|line| line.contains(file)).unwrap();
        row.split_once("href=\"").unwrap().1.split_once('"').unwrap().0.to_owned()
    };
    let (first, second) = (report(&list, "a/result.json"), report(&list, "b/result.json"));
    assert!(served.get(&first).1.contains("Calibration acceptable"));
    assert!(served.get(&second.replace("lang=en", "lang=ru")).1.contains("Калибровка"), "the language is not followed");
    let id = |page: &str| page["/report/".len()..].split_once('?').unwrap().0.to_owned();
    let (status, compared) = served.get(&format!("/compare?first={}&second={}", id(&first), id(&second)));
    assert!(status == 200 && compared.contains("The results agree."), "{compared}");
    let (status, unchosen) = served.get("/compare?first=0&lang=ru");
    assert!(status == 200 && unchosen.contains("Выберите два результата"), "{unchosen}");
    for (path, expected) in [("/report/0", 404), ("/report/", 404), ("/compare?first=0&second=1", 404), ("/live", 503)]
    {
        assert_eq!(served.get(path).0, expected, "{path}");
    }
    // A later result is in the list without a new start, and those before keep their addresses.
    fs::create_dir(copy.out().join("0")).unwrap();
    fs::copy(copy.out().join("a/result.json"), copy.out().join("0/result.json")).unwrap();
    let list = served.get("/").1;
    assert_eq!(list.matches("class=\"good\">acceptable").count(), 3);
    assert_eq!(report(&list, "./a/result.json"), first);
    assert_eq!(served.interrupt(), Some(0));
    let nothing = copy.run(&["view", "../session/records"]);
    assert_eq!(nothing.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&nothing.stderr).contains("found neither a result nor a watch"));
}
