//! The pages of the repository name what there is, and the design page stays readable.

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

/// Every page, by its path from the root, with its text.
fn pages() -> Vec<(String, String)> {
    let mut names: Vec<String> = ["README.md", "CONTRIBUTING.md"].map(str::to_owned).into();
    let folders = ["docs", "examples"].map(|folder| below(&root().join(folder)));
    names.extend(folders.into_iter().flatten().filter(|name| has_extension(name, "md")));
    names.into_iter().map(|name| (name.clone(), fs::read_to_string(root().join(&name)).unwrap())).collect()
}

/// Files and folders (with a slash at the end) below a folder, by their paths from the root.
fn below(folder: &Path) -> Vec<String> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap().map(Result::unwrap) {
        let name = entry.path().strip_prefix(root()).unwrap().to_string_lossy().into_owned();
        if entry.file_type().unwrap().is_dir() {
            if !["target", ".git"].contains(&name.as_str()) {
                found.extend(below(&entry.path()));
                found.push(name + "/");
            }
        } else {
            found.push(name);
        }
    }
    found
}

/// The code spans of a page.
fn spans(text: &str) -> impl Iterator<Item = &str> {
    text.lines().flat_map(|line| line.split('`').skip(1).step_by(2))
}

/// A path in a code span may leave out its beginning: `fit/gain.rs`.
#[test]
fn paths_in_pages_exist() {
    let there = below(&root());
    let is_path = |span: &&str| {
        let is_named = [".rs", ".md", ".toml", ".py", "/"].iter().any(|end| span.ends_with(end));
        span.contains('/') && !span.contains([' ', ':']) && is_named
    };
    let mut missing = Vec::new();
    for (page, text) in pages() {
        for path in spans(&text).filter(is_path) {
            if !there.iter().any(|name| name == path || name.ends_with(&format!("/{path}"))) {
                missing.push(format!("{page}: {path}"));
            }
        }
    }
    assert!(missing.is_empty(), "{missing:#?}");
}

#[test]
fn links_in_pages_lead_somewhere() {
    for (page, text) in pages() {
        let folder = root().join(&page).parent().unwrap().to_owned();
        for target in text.split("](").skip(1).filter_map(|rest| rest.split([')', '#']).next()) {
            assert!(target.starts_with("http") || folder.join(target).exists(), "{page}: {target}");
        }
    }
}

/// What the column "in the code" names is in the code.
#[test]
fn names_in_the_glossary_exist() {
    let files = below(&root().join("crates")).into_iter().filter(|name| has_extension(name, "rs"));
    let sources: String = files.map(|name| fs::read_to_string(root().join(name)).unwrap()).collect();
    let code = sources.lines().filter(|line| !line.trim_start().starts_with("//"));
    let words: HashSet<&str> = code.flat_map(|line| line.split(|c: char| !c.is_alphanumeric() && c != '_')).collect();
    let glossary = fs::read_to_string(root().join("docs/glossary.md")).unwrap();
    let columns = glossary.lines().filter_map(|line| line.split('|').nth(3));
    let names =
        columns.flat_map(spans).filter(|span| !span.contains(['/', '.', '-'])).flat_map(|span| span.split("::"));
    let missing: Vec<&str> = names.filter(|name| !words.contains(name)).collect();
    assert!(missing.is_empty(), "{missing:?}");
}

#[test]
fn the_design_page_is_short_and_its_sentences_too() {
    let text = fs::read_to_string(root().join("docs/design.md")).unwrap();
    assert!(text.lines().count() <= 180);
    let prose: Vec<&str> = text.lines().map(|line| if line.starts_with(['#', '|']) { ". " } else { line }).collect();
    for sentence in prose.join(" ").split(". ").flat_map(|part| part.split("? ")) {
        assert!(sentence.split_whitespace().count() <= 35, "{sentence}");
    }
}

fn has_extension(name: &str, extension: &str) -> bool {
    Path::new(name).extension().is_some_and(|found| found == extension)
}
