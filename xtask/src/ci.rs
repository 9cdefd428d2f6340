//! Which checks does a change have to pass, and how long did each of them take?

use std::fs;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use crate::deps::Deps;
use crate::measured::{self, Which};
use crate::steps::{self, Outcome, cargo, linting_cargo, repository_root};
use crate::touched::Touched;
use crate::{tidy, wasm, web};

/// Names the file in which tests write what this machine did not let them try, a line each.
const SKIPPED_TESTS: &str = "FOVEAL_SKIPPED_TESTS";

/// Every check, the fast ones first and the tests last.
pub(crate) fn all() -> Outcome {
    let mut steps = Steps::new();
    steps.run("fmt", fmt);
    steps.run("tidy", tidy::run);
    let deps = Deps::of_this_tree();
    match &deps {
        Some(deps) => steps.run("restore", || deps.restore()),
        None => steps.skip("restore", Deps::WHY_NOT),
    }
    // The program carries the page, so the page comes first.
    steps.run("web", web::run);
    // What the steps after it run is built here, once, with the features of the whole workspace.
    steps.run("build, clippy", || build(&["--workspace".to_owned()]));
    steps.run("wasm", wasm::run);
    steps.run("measured", || measured::repeat(&Which::Sample));
    steps.run("web-test", web::test);
    steps.run("test", || test(&["--workspace".to_owned()]));
    if let Some(deps) = deps {
        // After a failure too, so that the next try is sooner there.
        deps.keep();
    }
    steps.end()
}

/// What a change needs while one works on it: the checks of what differs from the last commit.
pub(crate) fn touched() -> Outcome {
    let touched = Touched::since_the_last_commit()?;
    let mut steps = Steps::new();
    steps.run("fmt", fmt);
    steps.run("tidy", tidy::run);
    let packages = touched.packages();
    if packages.is_empty() {
        steps.skip(
            "build, clippy, test",
            "no crate differs from the last commit",
        );
    } else {
        steps.run("build, clippy", || build(&packages));
    }
    for words in touched.tests() {
        steps.run("test", || test(&words));
    }
    if touched.page() {
        steps.run("web-check", web::check);
    }
    for (name, why) in touched.left_out() {
        steps.skip(name, why);
    }
    steps.end()
}

fn fmt() -> Outcome {
    steps::run(&mut cargo(&["fmt", "--all", "--check"]))
}

/// Builds and lints everything, benchmarks and examples too.
fn build(which: &[String]) -> Outcome {
    let words = ["test", "--no-run", "--quiet", "--all-targets"];
    steps::run(linting_cargo(&words)?.args(which))
}

fn test(which: &[String]) -> Outcome {
    let mut command = linting_cargo(&["test"])?;
    command.args(which).env("RUST_BACKTRACE", "1");
    steps::run(command.env(SKIPPED_TESTS, skipped_tests()))
}

fn skipped_tests() -> PathBuf {
    repository_root().join("target").join("skipped-tests.txt")
}

/// The steps of a run: none begins after one that failed.
struct Steps {
    rows: Vec<(String, Row)>,
    failure: Option<String>,
}

enum Row {
    Took(Duration),
    Failed(Duration),
    Skipped(String),
}

impl Steps {
    fn new() -> Self {
        let _ = fs::remove_file(skipped_tests());
        Self {
            rows: Vec::new(),
            failure: None,
        }
    }

    fn run(&mut self, name: &str, work: impl FnOnce() -> Outcome) {
        if self.failure.is_some() {
            return self.skip(name, "a step before it failed");
        }
        println!("== {name}");
        let start = Instant::now();
        let outcome = work();
        let took = start.elapsed();
        println!("== {name}: {:.1} s", took.as_secs_f64());
        let row = match outcome {
            Ok(()) => Row::Took(took),
            Err(message) => {
                self.failure = Some(format!("step {name}: {message}"));
                Row::Failed(took)
            }
        };
        self.rows.push((name.to_owned(), row));
    }

    fn skip(&mut self, name: &str, why: &str) {
        self.rows
            .push((name.to_owned(), Row::Skipped(why.to_owned())));
    }

    /// Prints the table of steps, then what tests could not try here.
    fn end(self) -> Outcome {
        let untried = fs::read_to_string(skipped_tests()).unwrap_or_default();
        println!("{}", table(&self.rows, &untried));
        self.failure.map_or(Ok(()), Err)
    }
}

fn table(rows: &[(String, Row)], untried: &str) -> String {
    let mut all = Duration::ZERO;
    let mut lines = vec!["== seconds".to_owned()];
    for (name, row) in rows {
        lines.push(match row {
            Row::Took(took) => format!("{:8.1}  {name}", took.as_secs_f64()),
            Row::Failed(took) => format!("{:8.1}  {name}: FAILED", took.as_secs_f64()),
            Row::Skipped(why) => format!(" skipped  {name}: {why}"),
        });
        if let Row::Took(took) | Row::Failed(took) = row {
            all += *took;
        }
    }
    lines.push(format!("{:8.1}  in all", all.as_secs_f64()));
    let mut untried: Vec<&str> = untried.lines().collect();
    untried.sort_unstable();
    untried.dedup();
    lines.extend(untried.iter().map(|line| format!("not tried  {line}")));
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn after_a_failure_no_step_begins_and_the_table_says_why() {
        let mut steps = Steps::new();
        steps.run("first", || Ok(()));
        steps.run("second", || Err("it broke".to_owned()));
        steps.run("third", || panic!("begun"));
        let table = table(&steps.rows, "");
        assert!(table.contains("  first\n"), "{table}");
        assert!(table.contains("second: FAILED"), "{table}");
        assert!(table.contains("third: a step before it failed"), "{table}");
        assert_eq!(steps.end(), Err("step second: it broke".to_owned()));
    }

    #[test]
    fn what_tests_could_not_try_is_listed_once() {
        let table = table(&[], "no display\nno shell\nno display\n");
        assert_eq!(table.matches("not tried  no display").count(), 1, "{table}");
        assert!(table.ends_with("not tried  no shell"), "{table}");
    }
}
