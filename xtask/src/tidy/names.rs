//! Does one name stand for two types?

use std::collections::{BTreeMap, BTreeSet};

use super::Finding;
use super::known::Breach;
use super::source::file::{Item, Seen};
use super::source::modules::Modules;

/// The crate that every other depends on: its public names are theirs too.
const CORE: &str = "core";

/// Types that other files can name, one name twice in a crate, or in core and in another crate.
pub(super) fn check(crates: &BTreeMap<&str, Modules>) -> Vec<Breach> {
    let mut breaches = Vec::new();
    let core = crates.get(CORE).map(types).unwrap_or_default();
    for (name, modules) in crates {
        let types = types(modules);
        for (kind, places) in &types {
            if let [first, others @ ..] = places.as_slice()
                && !others.is_empty()
            {
                breaches.push(shared(name, kind, first, others));
            }
        }
        if *name == CORE {
            continue;
        }
        for (kind, places) in &types {
            let everywhere = |place: &&Place<'_>| place.item.seen == Seen::Everywhere;
            if let Some(public) = core.get(kind).and_then(|of| of.iter().find(everywhere)) {
                breaches.push(shared(&format!("{CORE} {name}"), kind, public, places));
            }
        }
    }
    breaches
}

#[derive(Clone)]
struct Place<'a> {
    file: &'a str,
    item: &'a Item,
}

/// Where each type that other files can name is defined, once a module: what stands there twice
/// is one type under two conditions, and so is a module that stands twice in a file.
fn types(modules: &Modules) -> BTreeMap<&str, Vec<Place<'_>>> {
    let mut types: BTreeMap<&str, Vec<Place<'_>>> = BTreeMap::new();
    let mut met = BTreeSet::new();
    for (_, module) in modules.iter() {
        for item in &module.scope.items {
            let file = &module.file;
            let place = (file, &module.scope.inside, &item.name);
            if item.is_type && item.seen > Seen::Here && met.insert(place) {
                types
                    .entry(&item.name)
                    .or_default()
                    .push(Place { file, item });
            }
        }
    }
    types
}

fn shared(crates: &str, kind: &str, first: &Place<'_>, others: &[Place<'_>]) -> Breach {
    let others = others
        .iter()
        .map(|place| format!("{}:{}", place.file, place.item.line));
    let others: Vec<String> = others.collect();
    let message = format!(
        "{kind} is also a type of {}: give each the name of what it is",
        others.join(", ")
    );
    let finding = Finding::new(first.file, first.item.line, message);
    Breach::new("names", format!("{crates} {kind}"), finding)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tidy::Tree;

    fn keys(core: &str, a: &str, b: &str) -> Vec<String> {
        let tree = Tree::of_texts(&[
            ("crates/core/src/lib.rs", core),
            ("crates/x/src/lib.rs", "mod a; mod b;"),
            ("crates/x/src/a.rs", a),
            ("crates/x/src/b.rs", b),
        ]);
        let modules = ["core", "x"].map(|name| (name, Modules::of_crate(&tree, name)));
        let found = check(&BTreeMap::from(modules));
        found.iter().map(|breach| breach.key().to_owned()).collect()
    }

    #[test]
    fn two_types_of_a_crate_that_others_can_name_do_not_share_a_name() {
        assert_eq!(keys("", "pub struct S;", "pub(crate) enum S {}"), ["x S"]);
        assert_eq!(
            keys("", "pub(super) trait S {}", "pub(in crate::b) type S = u8;"),
            ["x S"]
        );
        assert_eq!(
            keys("", "pub mod i { pub union S { a: u8 } }", "pub struct S;"),
            ["x S"]
        );
    }

    #[test]
    fn what_only_its_file_can_name_is_free() {
        assert!(keys("", "pub struct S;", "struct S; pub(self) enum S {}").is_empty());
        assert!(keys("", "pub struct S;", "pub fn f() { pub struct S; }").is_empty());
        assert!(
            keys(
                "",
                "pub struct S;",
                "#[cfg(test)] mod tests { pub struct S; }"
            )
            .is_empty()
        );
    }

    #[test]
    fn functions_and_associated_types_are_no_types() {
        let associated = "pub trait T { type S; } impl T for U { type S = u8; }";
        assert!(keys("", "pub struct S;", associated).is_empty());
        assert!(keys("", "pub struct S;", "pub fn S() {} pub const S: u8 = 0;").is_empty());
    }

    #[test]
    fn one_type_under_two_conditions_is_one() {
        let both = "#[cfg(unix)] pub struct S; #[cfg(windows)] pub struct S(u8);";
        assert!(keys("", both, "").is_empty());
        let inside = "#[cfg(unix)] mod i { pub struct S; }
                      #[cfg(windows)] mod i { pub struct S; }";
        assert!(keys("", inside, "").is_empty());
        let apart = "mod i { pub struct S; } mod j { pub struct S; }";
        assert_eq!(keys("", apart, ""), ["x S"]);
    }

    #[test]
    fn public_types_of_core_share_no_name_with_those_of_other_crates() {
        assert_eq!(
            keys("pub struct S;", "pub(crate) struct S;", ""),
            ["core x S"]
        );
        assert!(keys("pub(crate) struct S;", "pub struct S;", "").is_empty());
        assert!(keys("pub struct S;", "struct S;", "").is_empty());
    }
}
