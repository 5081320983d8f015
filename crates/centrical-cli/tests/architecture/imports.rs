//! The two rules that leave no circle of imports: no module names an item of its ancestors, and the children of a module, each
//! with all that lies in it, import each other without a cycle.

use std::{
    collections::{BTreeMap, BTreeSet},
    fmt::Write as _,
};

use super::module_tree::ModuleTree;

/// Every breach of the rules: the modules concerned, separated by spaces, and a sentence.
pub fn findings(tree: &ModuleTree) -> Vec<(String, String)> {
    let mut imports_of_children: BTreeMap<usize, Imports> = BTreeMap::new();
    let mut found = BTreeMap::new();
    for (user, module) in tree.modules.iter().enumerate() {
        for path in &module.paths {
            let Some((target, used)) = tree.resolve(user, &path.segments) else { continue };
            let place = format!("{}:{}", module.file, path.line);
            if target != user && tree.is_within(user, target) {
                let item = path.segments.get(used).map_or("the module itself", String::as_str);
                let ancestor = &tree.modules[target].name;
                found
                    .entry((place, item))
                    .or_insert_with(|| (module.name.clone(), format!("uses `{item}` of its ancestor {ancestor}")));
            } else if !tree.is_within(target, user) {
                let (parent, from, to) = branches(tree, user, target);
                let text = path.segments.join("::");
                imports_of_children
                    .entry(parent)
                    .or_default()
                    .entry((from, to))
                    .or_default()
                    .push(format!("{place} {text}"));
            }
        }
    }
    let mut found: Vec<_> =
        found.into_iter().map(|((place, _), (module, text))| (module, format!("{place}: {text}"))).collect();
    for (parent, imports) in &imports_of_children {
        found.extend(circles(imports).iter().map(|circle| describe(tree, *parent, imports, circle)));
    }
    found
}

/// Places and paths by which one child of a module imports from another.
type Imports = BTreeMap<(usize, usize), Vec<String>>;

/// The nearest common ancestor and its children on the way to each of the two.
fn branches(tree: &ModuleTree, user: usize, target: usize) -> (usize, usize, usize) {
    let towards = |module: usize, ancestor: usize| {
        tree.lineage(module)
            .find(|&m| tree.modules[m].parent == Some(ancestor))
            .expect("an ancestor has a child on the way")
    };
    let common = tree.lineage(user).find(|&m| tree.is_within(target, m)).expect("all modules lie in the root");
    (common, towards(user, common), towards(target, common))
}

/// Sets of children that reach each other both ways.
fn circles(imports: &Imports) -> Vec<BTreeSet<usize>> {
    let mut reaches: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
    for &(from, _) in imports.keys() {
        let (mut seen, mut open) = (BTreeSet::new(), vec![from]);
        while let Some(at) = open.pop() {
            open.extend(imports.keys().filter(|edge| edge.0 == at).map(|edge| edge.1).filter(|&to| seen.insert(to)));
        }
        reaches.insert(from, seen);
    }
    let circle_of = |m: usize| -> BTreeSet<usize> {
        reaches[&m].iter().copied().filter(|to| reaches.get(to).is_some_and(|r| r.contains(&m))).collect()
    };
    let circles: BTreeSet<BTreeSet<usize>> = reaches.keys().map(|&m| circle_of(m)).filter(|c| !c.is_empty()).collect();
    circles.into_iter().collect()
}

/// The imports within a circle, the rarest first: there it is the easiest to open.
fn describe(tree: &ModuleTree, parent: usize, imports: &Imports, circle: &BTreeSet<usize>) -> (String, String) {
    let last = |m: usize| tree.modules[m].name.rsplit("::").next().expect("a name has a last part");
    let members: Vec<&str> = circle.iter().map(|&m| last(m)).collect();
    let mut text =
        format!("circle of {} children of {}: {}", circle.len(), tree.modules[parent].name, members.join(", "));
    let mut edges: Vec<_> =
        imports.iter().filter(|((from, to), _)| circle.contains(from) && circle.contains(to)).collect();
    edges.sort_by_key(|(_, uses)| uses.len());
    for ((from, to), uses) in edges {
        write!(
            text,
            "\n    {} -> {}, {} times: {}",
            last(*from),
            last(*to),
            uses.len(),
            uses[..uses.len().min(4)].join("; ")
        )
        .expect("a string takes all");
    }
    let concerned: Vec<&str> =
        std::iter::once(parent).chain(circle.iter().copied()).map(|m| tree.modules[m].name.as_str()).collect();
    (concerned.join(" "), text)
}

#[cfg(test)]
mod tests {
    use super::{super::module_tree::Sources, *};

    fn found(files: &[(&str, &str)]) -> Vec<String> {
        let sources: Sources = files.iter().map(|(file, text)| ((*file).to_owned(), (*text).to_owned())).collect();
        findings(&ModuleTree::parse("house", &sources, "lib.rs")).into_iter().map(|(_, text)| text).collect()
    }

    #[test]
    fn a_parent_may_name_its_children_and_a_child_its_elder_sibling() {
        let none = found(&[
            ("lib.rs", "mod a; mod b; pub use a::A; fn f() { b::deep::g(); }"),
            ("a.rs", "pub struct A; impl A { fn f() -> Self { Self::g() } }"),
            ("b.rs", "pub mod deep; use deep::g; use std::fmt; fn f() { fmt::format(x); self::deep::g() }"),
            ("b/deep.rs", "use crate::a::A; pub(in crate::b) fn g() { super::super::a::A::f(); }"),
        ]);
        assert!(none.is_empty(), "{none:?}");
    }

    #[test]
    fn an_item_of_an_ancestor_is_found_however_it_is_named() {
        let texts = [
            "use super::T;",
            "use crate::a::T;",
            "use crate::a::{\nself};",
            "use super::*;",
            "fn f() -> super::T { g() }",
            "fn f() { assert!(super::T::new()); }",
            "fn f() { vec![g(1, crate::a::T)]; }",
            "use super::super::a as x; fn f() { x::T::new(); }",
            "impl Clone for super::T {}",
            "use crate::Root;",
            "mod inner { fn f() { super::super::T; } }",
            "fn f() { use super::T; }",
        ];
        for text in texts {
            let found = found(&[("lib.rs", "mod a;"), ("a.rs", "mod b; pub struct T;"), ("a/b.rs", text)]);
            assert!(!found.is_empty() && found[0].starts_with("crates/house/src/a/b.rs:"), "{text}: {found:?}");
            assert!(found[0].contains("of its ancestor house"), "{text}: {found:?}");
        }
    }

    #[test]
    fn the_place_of_a_finding_is_its_line() {
        let found = found(&[("lib.rs", "mod a;"), ("a.rs", "\n\nuse crate::{\n    R,\n};")]);
        assert_eq!(found, ["crates/house/src/a.rs:4: uses `R` of its ancestor house"]);
    }

    #[test]
    fn two_siblings_that_import_each_other_are_a_circle() {
        let found = found(&[
            ("lib.rs", "mod a; mod b; mod c;"),
            ("a.rs", "use super::b::B; use crate::c::C;"),
            ("b.rs", "use crate::a::A;"),
            ("c.rs", ""),
        ]);
        assert_eq!(found.len(), 1);
        assert!(found[0].starts_with("circle of 2 children of house: a, b\n"), "{}", found[0]);
        assert!(found[0].contains("a -> b, 1 times: crates/house/src/a.rs:1 super::b::B"), "{}", found[0]);
    }

    #[test]
    fn a_circle_may_run_through_what_lies_deeper_and_through_imported_modules() {
        let found = found(&[
            ("lib.rs", "mod a; mod b; mod c;"),
            ("a.rs", "mod low;"),
            ("a/low.rs", "use crate::b; fn f() { b::low::g() }"),
            ("b.rs", "pub mod low;"),
            ("b/low.rs", "fn g() { println!(\"{}\", crate::c::X); }"),
            ("c.rs", "mod inner { use super::super::a::low::L; }"),
        ]);
        assert_eq!(found.len(), 1);
        assert!(found[0].starts_with("circle of 3 children of house: a, b, c\n"), "{}", found[0]);
    }

    #[test]
    fn tests_may_import_what_they_like() {
        let none = found(&[
            ("lib.rs", "mod a; mod b;"),
            ("a.rs", "#[cfg(test)] mod tests { use super::super::b::B; use super::*; } #[cfg(test)] use crate::b::C;"),
            ("b.rs", "use crate::a::A;"),
        ]);
        assert!(none.is_empty(), "{none:?}");
    }
}
