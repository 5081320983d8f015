//! How many entries stand on one step of a crate's `src/`.

use std::collections::{BTreeMap, BTreeSet};

use super::module_tree::Sources;

/// Entries that a newcomer reads at a glance.
const DOZEN: usize = 12;

/// Every `src/` of more than a dozen modules and every folder of one file: the module and a sentence.
pub fn findings(crate_name: &str, sources: &Sources) -> Vec<(String, String)> {
    let mut steps: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for file in sources.keys() {
        let mut entry = file.strip_suffix(".rs").unwrap_or(file);
        while let Some((folder, name)) = entry.rsplit_once('/') {
            steps.entry(folder).or_default().insert(name);
            entry = folder;
        }
        if !matches!(entry, "lib" | "main") {
            steps.entry("").or_default().insert(entry);
        }
    }
    let mut found = Vec::new();
    for (folder, entries) in steps {
        let place = format!("crates/{}/src/{folder}", crate_name.replace('_', "-"));
        if folder.is_empty() && entries.len() > DOZEN {
            let names = entries.iter().copied().collect::<Vec<_>>().join(", ");
            found.push((crate_name.to_owned(), format!("{place}: {} entries on one step: {names}", entries.len())));
        } else if !folder.is_empty() && entries.len() == 1 {
            let module = format!("{crate_name}::{}", folder.replace('/', "::"));
            found.push((module, format!("{place}/: a folder with one entry: {}", entries.first().expect("one"))));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(files: &[String]) -> Vec<String> {
        let sources: Sources = files.iter().map(|file| (file.clone(), String::new())).collect();
        findings("house", &sources).into_iter().map(|(_, text)| text).collect()
    }

    #[test]
    fn a_folder_with_one_file_is_found() {
        let files = ["lib.rs", "a.rs", "a/b.rs", "c/d.rs", "c/e.rs"].map(str::to_owned);
        assert_eq!(found(&files), ["crates/house/src/a/: a folder with one entry: b"]);
    }

    #[test]
    fn a_thirteenth_module_is_one_too_many_but_a_module_and_its_folder_are_one() {
        let mut files: Vec<String> = (0..12).map(|i| format!("m{i}.rs")).collect();
        files.extend(["lib.rs", "m1/a.rs", "m1/b.rs"].map(str::to_owned));
        assert!(found(&files).is_empty());
        files.push("m12.rs".to_owned());
        assert!(found(&files)[0].starts_with("crates/house/src/: 13 entries on one step: m0, m1, m10"));
    }
}
