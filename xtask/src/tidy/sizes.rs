//! Is a file, a line or a function too long to be read in one go?

use super::Finding;
use super::source::lexing::{body_start, closing_brace, code, is_word};

const FILE_LINES: usize = 600;
const SHADER_LINES: usize = 300;
const LINE_COLUMNS: usize = 100;
const FUNCTION_LINES: usize = 70;

/// Limits on sources, and the question that opens each Rust file.
pub(super) fn check(path: &str, text: &str) -> Vec<Finding> {
    let Some((_, ending)) = path.rsplit_once('.') else {
        return Vec::new();
    };
    if !matches!(ending, "rs" | "wgsl" | "ts" | "py") {
        return Vec::new();
    }
    let mut findings = Vec::new();
    let limit = if ending == "wgsl" {
        SHADER_LINES
    } else {
        FILE_LINES
    };
    let lines = text.lines().count();
    if lines > limit {
        let message =
            format!("{lines} lines, at most {limit}: split it by the question it answers");
        findings.push(Finding::new(path, limit + 1, message));
    }
    findings.extend(check_lines(path, text));
    if matches!(ending, "rs" | "wgsl") {
        findings.extend(check_functions(path, text));
    }
    if ending == "rs" && !text.starts_with("//!") {
        let message = "the first line is no `//!` line: say there which question the file answers";
        findings.push(Finding::new(path, 1, message));
    }
    findings
}

fn check_lines(path: &str, text: &str) -> Vec<Finding> {
    let too_long = |line: &str| line.chars().count() > LINE_COLUMNS && !line.contains("://");
    let lines = (1..).zip(text.lines()).filter(|(_, line)| too_long(line));
    lines
        .map(|(number, line)| {
            let columns = line.chars().count();
            let message = format!("{columns} columns, at most {LINE_COLUMNS}: break the line");
            Finding::new(path, number, message)
        })
        .collect()
}

fn check_functions(path: &str, text: &str) -> Vec<Finding> {
    let long = functions(&code(text))
        .into_iter()
        .filter(|f| f.lines > FUNCTION_LINES);
    long.map(|f| {
        let (name, lines) = (f.name, f.lines);
        let message = format!(
            "function {name} has {lines} lines, at most {FUNCTION_LINES}: give a part a name"
        );
        Finding::new(path, f.first_line, message)
    })
    .collect()
}

struct Function {
    name: String,
    first_line: usize,
    /// From `fn` to the closing brace.
    lines: usize,
}

/// Every `fn` item with a body.
fn functions(code: &str) -> Vec<Function> {
    let chars: Vec<char> = code.chars().collect();
    let lines_in = |part: &[char]| part.iter().filter(|&&c| c == '\n').count();
    let mut found = Vec::new();
    for at in 0..chars.len().saturating_sub(3) {
        let starts_word = at == 0 || !is_word(chars[at - 1]);
        if !starts_word || chars[at..at + 2] != ['f', 'n'] || !chars[at + 2].is_whitespace() {
            continue;
        }
        let after = chars[at + 2..].iter().skip_while(|c| c.is_whitespace());
        let name: String = after.take_while(|c| is_word(**c)).collect();
        let Some(open) = body_start(&chars, at).filter(|&i| chars[i] == '{') else {
            continue;
        };
        if name.is_empty() {
            continue;
        }
        let body = &chars[at..closing_brace(&chars, open)];
        let first_line = lines_in(&chars[..at]) + 1;
        found.push(Function {
            name,
            first_line,
            lines: lines_in(body) + 1,
        });
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn messages(path: &str, text: &str) -> Vec<String> {
        check(path, text).iter().map(ToString::to_string).collect()
    }

    #[test]
    fn a_file_of_the_limit_passes_and_one_line_more_does_not() {
        let full = format!("//! Why?\n{}", "// x\n".repeat(FILE_LINES - 1));
        assert!(messages("a.rs", &full).is_empty());
        let over = messages("a.rs", &format!("{full}// y\n"));
        assert_eq!(over.len(), 1);
        assert!(over[0].starts_with("a.rs:601: 601 lines"), "{over:?}");
        assert_eq!(messages("a.wgsl", &"// x\n".repeat(301)).len(), 1);
        assert!(messages("a.wgsl", &"// x\n".repeat(300)).is_empty());
        assert!(messages("a.md", &full.repeat(2)).is_empty());
    }

    #[test]
    fn columns_are_characters_and_addresses_may_be_long() {
        let line = |filler: &str| format!("//! Why?\n// {}\n", filler.repeat(97));
        assert!(messages("a.rs", &line("é")).is_empty());
        assert!(messages("a.rs", &format!("{}xx", line("é").trim_end()))[0].starts_with("a.rs:2:"));
        assert!(messages("a.rs", &format!("//! Why?\n// https://{}", "a".repeat(100))).is_empty());
    }

    #[test]
    fn a_function_is_measured_from_its_name_to_its_brace() {
        let function = |body: usize| {
            format!(
                "//! Why?\n\n/// {{\nfn long(\n    a: [u8; 2],\n) -> u8 {{\n{}}}\n",
                "x;\n".repeat(body)
            )
        };
        assert!(messages("a.rs", &function(66)).is_empty());
        let over = messages("a.rs", &function(67));
        assert_eq!(over.len(), 1);
        assert!(
            over[0].starts_with("a.rs:4: function long has 71 lines"),
            "{over:?}"
        );
    }

    #[test]
    fn braces_in_text_and_bodiless_functions_do_not_count() {
        let text =
            "trait T { fn a(); fn b() -> [u8; 3]; }\nfn c(f: fn (u8)) { let x = '{'; \"{{\"; }";
        let found = functions(&code(text));
        let names: Vec<&str> = found.iter().map(|f| f.name.as_str()).collect();
        assert_eq!(names, ["c"]);
        assert_eq!(found[0].lines, 1);
    }

    #[test]
    fn a_rust_file_opens_with_its_question() {
        assert_eq!(messages("a.rs", "use b;\n").len(), 1);
        assert!(messages("a.rs", "//! Why?\nuse b;\n").is_empty());
    }
}
