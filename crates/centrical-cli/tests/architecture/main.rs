//! The plan of the house, held over the sources of every crate: a parent module names its children, what children share lies in a
//! child, and siblings import each other in one direction only. `CENTRICAL_ARCHITECTURE=crate[::module]` prints instead of failing.

mod imports;
mod layout;
mod module_tree;
mod surface;

use std::{collections::BTreeMap, env, fs, path::Path};

use module_tree::{ModuleTree, Sources};

/// The sources of every crate of the workspace, by its name as Rust writes it.
fn workspace() -> BTreeMap<String, Sources> {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the package lies in crates/");
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(crates).expect("crates/ can be listed").flatten() {
        let name = entry.file_name().into_string().expect("a crate's name is text").replace('-', "_");
        let mut sources = Sources::new();
        read_into(&mut sources, &entry.path().join("src"), "");
        if !sources.is_empty() {
            found.insert(name, sources);
        }
    }
    found
}

fn read_into(sources: &mut Sources, folder: &Path, prefix: &str) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name().into_string().expect("a source file's name is text");
        if entry.path().is_dir() {
            read_into(sources, &entry.path(), &format!("{prefix}{name}/"));
        } else if entry.path().extension().is_some_and(|e| e == "rs") {
            sources.insert(
                format!("{prefix}{name}"),
                fs::read_to_string(entry.path()).expect("a source file can be read"),
            );
        }
    }
}

/// Fails with the findings, or only prints those of the module that the environment asks for.
fn hold(findings: &[(String, String)]) {
    let wanted = env::var("CENTRICAL_ARCHITECTURE").ok();
    let of_interest = |module: &str| match wanted.as_deref() {
        None | Some("report") => true,
        Some(prefix) => module.split(' ').any(|m| m == prefix || m.starts_with(&format!("{prefix}::"))),
    };
    let texts: Vec<&str> = findings.iter().filter(|(module, _)| of_interest(module)).map(|(_, t)| t.as_str()).collect();
    if wanted.is_some() {
        println!("{}\n{} found", texts.join("\n"), texts.len());
    } else {
        assert!(texts.is_empty(), "{}\n{} found", texts.join("\n"), texts.len());
    }
}

#[test]
fn imports_run_one_way() {
    let mut findings = Vec::new();
    for (name, sources) in workspace() {
        for root in ["lib.rs", "main.rs"].into_iter().filter(|root| sources.contains_key(*root)) {
            findings.extend(imports::findings(&ModuleTree::parse(&name, &sources, root)));
        }
    }
    hold(&findings);
}

#[test]
fn folders_hold_two_files_or_more_and_src_a_dozen() {
    let findings: Vec<_> = workspace().iter().flat_map(|(name, sources)| layout::findings(name, sources)).collect();
    hold(&findings);
}

/// Prints, with `--nocapture`, what a user of each crate sees.
#[test]
fn every_crate_says_what_it_offers() {
    for (name, sources) in workspace() {
        if sources.contains_key("lib.rs") {
            let names = surface::public_names(&ModuleTree::parse(&name, &sources, "lib.rs"));
            println!("{name}: {} public names, {} distinct", names.len(), surface::distinct(&names));
            if env::var("CENTRICAL_ARCHITECTURE").is_ok_and(|prefix| prefix == name) {
                println!("  {}", names.join("\n  "));
            }
            assert!(!names.is_empty(), "{name} offers nothing");
        }
    }
}
