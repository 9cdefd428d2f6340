//! Which files import from which, and which of them lead back to themselves?

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use super::modules::{Module, Modules};
use super::typescript::imports;
use crate::tidy::Tree;

/// What each file imports from each other file.
#[derive(Default)]
pub(crate) struct Graph {
    edges: BTreeMap<String, BTreeMap<String, BTreeSet<String>>>,
}

impl Graph {
    /// The imports of a crate. Each leads to the file that defines the name; a file that only
    /// hands names on imports nothing itself.
    pub(crate) fn of(modules: &Modules) -> Self {
        let mut graph = Self::default();
        let defining: BTreeSet<&str> = modules
            .iter()
            .filter(|(_, module)| module.scope.defines)
            .map(|(_, module)| module.file.as_str())
            .collect();
        for (at, module) in modules.iter() {
            if defining.contains(module.file.as_str()) {
                graph.add_imports(modules, at, module);
                for path in &module.scope.paths {
                    graph.add(modules, at, path, "");
                }
            }
        }
        graph
    }

    /// The imports of TypeScript in a folder, whose name ends with `/`; tests are left out.
    pub(crate) fn of_typescript(tree: &Tree, folder: &str) -> Self {
        let mut graph = Self::default();
        for (from, file) in tree.files() {
            let is_source = from.starts_with(folder) && from.ends_with(".ts");
            let text = file.text.as_deref().filter(|_| is_source);
            for (names, path) in text
                .filter(|_| !from.ends_with(".test.ts"))
                .map_or(Vec::new(), imports)
            {
                if let Some(to) = beside(from, &path).filter(|to| tree.has(to)) {
                    let edges = graph.edges.entry(from.to_owned()).or_default();
                    edges.entry(to).or_default().insert(names);
                }
            }
        }
        graph
    }

    fn add_imports(&mut self, modules: &Modules, at: usize, module: &Module) {
        for import in &module.scope.imports {
            if let Some(name) = &import.name {
                let handed = import.hands_on && !module.scope.uses(name);
                let remark = if handed { " (handed on)" } else { "" };
                self.add(modules, at, &import.path, remark);
                continue;
            }
            let names: BTreeSet<&str> = module
                .scope
                .names
                .iter()
                .filter(|name| !name.is_import)
                .map(|name| name.text.as_str())
                .collect();
            for name in names {
                let mut path = import.path.clone();
                path.push(name.to_owned());
                self.add(modules, at, &path, "");
            }
        }
    }

    fn add(&mut self, modules: &Modules, at: usize, path: &[String], remark: &str) {
        let from = modules.file(at);
        for (to, name) in modules.definitions(at, path) {
            if to.file != from {
                let names = self.edges.entry(from.to_owned()).or_default();
                let names = names.entry(to.file.clone()).or_default();
                names.insert(format!("{name}{remark}"));
            }
        }
    }

    /// Every pair of files of which the first imports from the second.
    pub(crate) fn edges(&self) -> impl Iterator<Item = (&str, &str)> {
        self.edges
            .iter()
            .flat_map(|(from, to)| to.keys().map(move |to| (from.as_str(), to.as_str())))
    }

    /// What `from` imports from `to`, in one line.
    pub(crate) fn names(&self, from: &str, to: &str) -> String {
        let names = self.edges.get(from).and_then(|edges| edges.get(to));
        let names: Vec<&str> = names.into_iter().flatten().map(String::as_str).collect();
        names.join(", ")
    }

    /// The files of a shortest way from one file to another, both named; nothing where none is.
    pub(crate) fn way(&self, from: &str, to: &str) -> Option<Vec<&str>> {
        let (start, _) = self.edges.get_key_value(from)?;
        let mut before: BTreeMap<&str, &str> = BTreeMap::new();
        let mut waiting = VecDeque::from([start.as_str()]);
        while let Some(at) = waiting.pop_front() {
            if at == to {
                let mut way = vec![at];
                let mut at = at;
                while at != from {
                    at = before.get(at)?;
                    way.push(at);
                }
                way.reverse();
                return Some(way);
            }
            for next in self.edges.get(at).into_iter().flat_map(|to| to.keys()) {
                if next != from && !before.contains_key(next.as_str()) {
                    before.insert(next, at);
                    waiting.push_back(next);
                }
            }
        }
        None
    }
}

/// The file that a path like `../a/b.ts` leads to from another file; nothing of a package's name.
fn beside(from: &str, path: &str) -> Option<String> {
    let mut folder: Vec<&str> = from.split('/').collect();
    folder.pop();
    path.starts_with('.').then_some(())?;
    for name in path.split('/') {
        match name {
            "." => {}
            ".." => drop(folder.pop()?),
            name => folder.push(name),
        }
    }
    Some(folder.join("/"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `from -> to: names` of a crate whose files are given by their names under `src`.
    fn edges(files: &[(&str, &str)]) -> Vec<String> {
        let paths: Vec<(String, &str)> = files
            .iter()
            .map(|(name, text)| (format!("crates/x/src/{name}"), *text))
            .collect();
        let files: Vec<(&str, &str)> = paths.iter().map(|(p, t)| (p.as_str(), *t)).collect();
        let modules = Modules::of_crate(&Tree::of_texts(&files), "x");
        assert_eq!(modules.faults, []);
        let graph = Graph::of(&modules);
        let short = |file: &str| file.replace("crates/x/src/", "");
        let edges = graph.edges().map(|(from, to)| {
            let names = graph.names(from, to);
            format!("{} -> {}: {names}", short(from), short(to))
        });
        edges.collect()
    }

    #[test]
    fn an_import_leads_to_the_file_that_defines_the_name_however_it_is_handed_on() {
        let files = [
            ("lib.rs", "mod a; mod b; pub use a::deep::Far as Near;"),
            ("a/mod.rs", "pub mod deep; pub(crate) use deep::*;"),
            ("a/deep.rs", "pub struct Far; pub fn wide() {}"),
            (
                "b.rs",
                "use crate::Near; use super::a::{self, wide as w}; fn f() {}",
            ),
        ];
        assert_eq!(edges(&files), ["b.rs -> a/deep.rs: Far, wide"]);
    }

    #[test]
    fn groups_renames_globs_and_paths_in_bodies_are_followed() {
        let files = [
            ("lib.rs", "mod a; mod b; mod c; mod d; mod e;"),
            ("a.rs", "pub fn one() {} pub fn two() {}"),
            (
                "b.rs",
                "use crate::{a::{one as x}, c}; fn f() { c::three() }",
            ),
            ("c.rs", "use super::a::*; pub fn three() { two() }"),
            (
                "d.rs",
                "fn f() { assert!(crate::a::one() == [super::c::three()]); }",
            ),
            (
                "e.rs",
                "fn f() { use crate::a::two; let x: crate::c::three; }",
            ),
        ];
        let expected = [
            "b.rs -> a.rs: one",
            "b.rs -> c.rs: three",
            "c.rs -> a.rs: two",
            "d.rs -> a.rs: one",
            "d.rs -> c.rs: three",
            "e.rs -> a.rs: two",
            "e.rs -> c.rs: three",
        ];
        assert_eq!(edges(&files), expected);
    }

    #[test]
    fn tests_other_crates_and_words_import_nothing() {
        let files = [
            ("lib.rs", "mod a; mod b; #[cfg(test)] mod c; mod tests;"),
            ("a.rs", "pub fn one() {}"),
            (
                "b.rs",
                "use std::a::one; /// [`crate::a::one`]\nfn f() { \"crate::a::one\"; }
                 #[cfg(test)] mod tests { use crate::a::one; }
                 #[cfg(all(test, unix))] use crate::a::one; fn a() { ::a::one() }
                 struct S; impl S { #[cfg(test)] fn t() { crate::a::one() } }",
            ),
            ("c.rs", "use crate::a::one; fn f() {}"),
            ("tests.rs", "use crate::a::one; fn f() {}"),
        ];
        assert!(edges(&files).is_empty(), "{:?}", edges(&files));
    }

    #[test]
    fn modules_with_braces_belong_to_their_file() {
        let files = [
            ("lib.rs", "mod a; mod b;"),
            (
                "a.rs",
                "pub mod inner { pub fn one() { super::two() } } pub fn two() {}",
            ),
            (
                "b.rs",
                "mod own { use super::super::a::inner::one; fn f() { one() } }",
            ),
        ];
        assert_eq!(edges(&files), ["b.rs -> a.rs: one"]);
    }

    #[test]
    fn a_parent_that_defines_things_imports_what_it_hands_on() {
        let files = [
            ("lib.rs", "mod a;"),
            ("a.rs", "mod b; pub use b::{One, Two}; pub fn f(x: One) {}"),
            ("a/b.rs", "use super::f; pub struct One; pub struct Two;"),
        ];
        let expected = ["a.rs -> a/b.rs: One, Two (handed on)", "a/b.rs -> a.rs: f"];
        assert_eq!(edges(&files), expected);
    }

    #[test]
    fn typescript_imports_lead_to_files_of_its_folder_and_those_of_tests_do_not_count() {
        let tree = Tree::of_texts(&[
            (
                "web/src/a.ts",
                "import { x,\n  y as z } from \"./in/b.ts\";\nimport v from \"vite\";",
            ),
            ("web/src/in/b.ts", "export type { T } from \"../c.ts\";"),
            ("web/src/c.ts", "// from \"./a.ts\"\nconst x = \"./a.ts\";"),
            ("web/src/c.test.ts", "import { x } from \"./a.ts\";"),
        ]);
        let graph = Graph::of_typescript(&tree, "web/src/");
        let edges = graph
            .edges()
            .map(|(from, to)| format!("{from} -> {to}: {}", graph.names(from, to)));
        let expected = [
            "web/src/a.ts -> web/src/in/b.ts: x, y, z",
            "web/src/in/b.ts -> web/src/c.ts: T",
        ];
        assert_eq!(edges.collect::<Vec<_>>(), expected);
    }

    #[test]
    fn a_way_back_is_a_shortest_one() {
        let mut graph = Graph::default();
        for (from, to) in [("a", "b"), ("b", "c"), ("c", "a"), ("b", "d"), ("d", "c")] {
            let edges = graph.edges.entry(from.into()).or_default();
            edges.insert(to.into(), BTreeSet::new());
        }
        assert_eq!(graph.way("b", "a"), Some(vec!["b", "c", "a"]));
        assert_eq!(graph.way("a", "e"), None);
    }
}
