//! Do files import from each other in a circle?

use super::Finding;
use super::known::Breach;
use super::source::graph::Graph;

/// Every import from which imports lead back to the file it stands in.
pub(super) fn check(graph: &Graph) -> Vec<Breach> {
    let closing = graph
        .edges()
        .filter_map(|(from, to)| Some((from, to, graph.way(to, from)?)));
    closing
        .map(|(from, to, way)| {
            let names = graph.names(from, to);
            let steps = way.windows(2).map(|step| {
                let names = graph.names(step[0], step[1]);
                format!("{} imports {names} from {}", step[0], step[1])
            });
            let back: Vec<String> = steps.collect();
            let message = format!(
                "imports {names} from {to}, and in a circle {}: give what both need a file",
                back.join(", ")
            );
            let finding = Finding::new(from, 1, message);
            Breach::new("circles", format!("{from} -> {to}"), finding)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tidy::Tree;
    use crate::tidy::source::modules::Modules;

    fn keys(b: &str, c: &str) -> Vec<String> {
        let tree = Tree::of_texts(&[
            ("crates/x/src/lib.rs", "mod a; mod b; mod c;"),
            ("crates/x/src/a.rs", "use crate::b::B; pub struct A(B);"),
            ("crates/x/src/b.rs", b),
            ("crates/x/src/c.rs", c),
        ]);
        let found = check(&Graph::of(&Modules::of_crate(&tree, "x")));
        found
            .iter()
            .map(|breach| breach.key().replace("crates/x/src/", ""))
            .collect()
    }

    #[test]
    fn each_import_of_a_circle_is_reported_and_those_that_lead_out_of_it_are_not() {
        let circle = keys(
            "use crate::c::C; pub struct B(C);",
            "pub struct C(crate::a::A);",
        );
        assert_eq!(circle, ["a.rs -> b.rs", "b.rs -> c.rs", "c.rs -> a.rs"]);
        let line = keys("use crate::c::C; pub struct B(C);", "pub struct C;");
        assert!(line.is_empty(), "{line:?}");
    }

    #[test]
    fn a_circle_of_typescript_is_one_too() {
        let tree = Tree::of_texts(&[
            ("web/src/a.ts", "import { B } from \"./b.ts\";"),
            ("web/src/b.ts", "import type { A } from \"./a.ts\";"),
        ]);
        let found = check(&Graph::of_typescript(&tree, "web/src/"));
        let keys: Vec<&str> = found.iter().map(Breach::key).collect();
        let expected = [
            "web/src/a.ts -> web/src/b.ts",
            "web/src/b.ts -> web/src/a.ts",
        ];
        assert_eq!(keys, expected);
    }
}
