//! How does JSON that people's programs write become JSON by the letter?
//!
//! Only what is no glTF as it stands comes here. Mended are numbers such as `81.0` where a whole
//! one is asked for, line breaks in texts, members that are `null`, numbers of nothing (`-1`),
//! commas before a closing bracket, comments, numbers that JSON has not (`NaN`), and numbers that
//! are written as texts.

/// Members whose value is the number of something: below 0 they name nothing.
const NUMBERS: [&[u8]; 12] = [
    b"mesh",
    b"skin",
    b"camera",
    b"material",
    b"indices",
    b"bufferView",
    b"source",
    b"sampler",
    b"scene",
    b"skeleton",
    b"NORMAL",
    b"COLOR_0",
];
/// Members whose value is a whole number, or a list of such numbers.
const WHOLE: [&[u8]; 34] = [
    b"mesh",
    b"skin",
    b"camera",
    b"material",
    b"indices",
    b"bufferView",
    b"source",
    b"sampler",
    b"scene",
    b"skeleton",
    b"POSITION",
    b"NORMAL",
    b"TANGENT",
    b"COLOR_0",
    b"TEXCOORD_0",
    b"TEXCOORD_1",
    b"JOINTS_0",
    b"WEIGHTS_0",
    b"buffer",
    b"byteOffset",
    b"byteLength",
    b"byteStride",
    b"componentType",
    b"count",
    b"mode",
    b"index",
    b"texCoord",
    b"target",
    b"magFilter",
    b"minFilter",
    b"inverseBindMatrices",
    b"nodes",
    b"children",
    b"joints",
];
/// Members whose value is a text, also where it looks like a number.
const TEXTS: [&[u8]; 9] = [
    b"name",
    b"uri",
    b"version",
    b"minVersion",
    b"generator",
    b"copyright",
    b"type",
    b"mimeType",
    b"filter",
];
/// Members that are true or false.
const TRUTHS: [&[u8]; 2] = [b"doubleSided", b"normalized"];
/// Lists whose numbers change nothing where they are 1.
const ONES: [&[u8]; 3] = [b"\"scale", b"\"baseColorFactor", b"\"diffuseFactor"];
/// The largest whole number that a `float` of 64 bits holds exactly.
const MOST_EXACT: f64 = 9_007_199_254_740_992.0;

/// The text with what can be mended, and how much of it was.
pub(super) fn mended(json: &[u8]) -> (Vec<u8>, usize) {
    let mut writer = Writer {
        out: Vec::with_capacity(json.len()),
        mended: 0,
        comma: false,
        member: None,
    };
    let mut rest = json;
    while let Some((first, behind)) = rest.split_first() {
        rest = match first {
            b'"' => writer.text(rest),
            b',' => {
                writer.mended += usize::from(writer.comma);
                writer.comma = true;
                behind
            }
            b'{' | b'[' => {
                writer.begin();
                writer.member = None;
                writer.out.push(*first);
                behind
            }
            b'}' | b']' => {
                writer.mended += usize::from(writer.comma);
                writer.comma = false;
                writer.out.push(*first);
                behind
            }
            b':' => {
                writer.out.push(b':');
                behind
            }
            b'/' if behind.starts_with(b"/") => {
                writer.mended += 1;
                after(behind, b"\n")
            }
            b'/' if behind.starts_with(b"*") => {
                writer.mended += 1;
                after(behind, b"*/")
            }
            blank if blank.is_ascii_whitespace() || *blank == 0 => behind,
            _ => writer.word(rest),
        };
    }
    (writer.out, writer.mended)
}

struct Writer {
    out: Vec<u8>,
    mended: usize,
    /// Whether a comma was read that is not written yet.
    comma: bool,
    /// Where in `out` the member begins whose value is next, and where its name.
    member: Option<(usize, usize)>,
}

impl Writer {
    /// Writes the comma before a value or a name.
    fn begin(&mut self) {
        if std::mem::take(&mut self.comma) {
            match self.out.last() {
                Some(b'{' | b'[') | None => self.mended += 1,
                Some(_) => self.out.push(b','),
            }
        }
    }

    /// Writes a text, and gives what follows it.
    fn text<'a>(&mut self, json: &'a [u8]) -> &'a [u8] {
        let start = self.out.len();
        self.begin();
        let begun = self.out.len();
        self.out.push(b'"');
        let mut rest = &json[1..];
        while let Some((first, behind)) = rest.split_first() {
            rest = behind;
            match first {
                b'"' => break,
                b'\\' => {
                    self.out.push(b'\\');
                    if let Some((escaped, behind)) = rest.split_first() {
                        self.out.push(*escaped);
                        rest = behind;
                    }
                }
                control if *control < b' ' => {
                    self.mended += 1;
                    self.out.push(b' ');
                }
                other => self.out.push(*other),
            }
        }
        self.out.push(b'"');
        let next = rest.iter().find(|byte| !byte.is_ascii_whitespace());
        let is_name = next == Some(&b':');
        if !is_name && !self.names_one_of(&TEXTS) && self.is_number_from(begun) {
            self.mended += 1;
            let text = self.out.split_off(begun);
            let text = &text[1..text.len() - 1];
            let number = std::str::from_utf8(text)
                .ok()
                .and_then(|it| it.parse::<f64>().ok());
            match number.filter(|it| it.fract() == 0.0 && it.abs() < MOST_EXACT) {
                Some(whole) => self.out.extend((whole as i64).to_string().bytes()),
                None => self.out.extend(text),
            }
        }
        self.member = is_name.then_some((start, begun));
        rest
    }

    /// Whether the member whose value is next has one of these names.
    fn names_one_of(&self, names: &[&[u8]]) -> bool {
        let said = self.member.map(|(_, begun)| &self.out[begun..]);
        said.is_some_and(|said| {
            let said = said.strip_prefix(b"\"").unwrap_or(said);
            names
                .iter()
                .any(|it| said.starts_with(it) && said[it.len()..].starts_with(b"\":"))
        })
    }

    /// Whether the list whose value is next belongs to a member of one of these names.
    fn is_in_list_of(&self, names: &[&[u8]]) -> bool {
        let list = self.out.iter().rposition(|byte| *byte == b'[');
        let before = list.and_then(|at| self.out[..at].strip_suffix(b"\":"));
        before.is_some_and(|before| names.iter().any(|name| before.ends_with(name)))
    }

    /// The same of a list with nothing but numbers up to here.
    fn is_plain_list_of(&self, names: &[&[u8]]) -> bool {
        let list = self.out.iter().rposition(|byte| b"[{".contains(byte));
        let before = list.and_then(|at| self.out[..at].strip_suffix(b"\":"));
        let name = |it: &[u8]| it.iter().rposition(|byte| *byte == b'"').map(|at| at + 1);
        let is_list = list.is_some_and(|at| self.out[at] == b'[');
        let said = before.and_then(|it| Some(&it[name(it)?..]));
        is_list && said.is_some_and(|said| names.contains(&said))
    }

    /// Whether the text that was written from a place on is a number, or true or false.
    fn is_number_from(&self, begun: usize) -> bool {
        let text = &self.out[begun + 1..self.out.len() - 1];
        let digits = |byte: &u8| byte.is_ascii_digit() || b"+-.eE".contains(byte);
        let is_number = text.iter().all(digits) && text.first() != Some(&b'+');
        let number = std::str::from_utf8(text)
            .ok()
            .and_then(|it| it.parse::<f64>().ok());
        is_number && number.is_some() || text == b"true" || text == b"false"
    }

    /// Writes a number or a word of letters, and gives what follows it.
    fn word<'a>(&mut self, json: &'a [u8]) -> &'a [u8] {
        let ends = |byte: &u8| b",:{}[]\"/".contains(byte) || byte.is_ascii_whitespace();
        let end = json.iter().position(ends).unwrap_or(json.len()).max(1);
        let (word, rest) = json.split_at(end);
        let number = std::str::from_utf8(word)
            .ok()
            .and_then(|it| it.parse::<f64>().ok());
        let names_nothing = number.is_some_and(|it| it < 0.0) && self.names_one_of(&NUMBERS);
        let is_truth = matches!(word, b"0" | b"1") && self.names_one_of(&TRUTHS);
        let has_point = word.iter().any(|byte| b".eE".contains(byte));
        let is_asked = has_point && (self.names_one_of(&WHOLE) || self.is_plain_list_of(&WHOLE));
        let member = self.member.take();
        let is_none = word == b"null" || names_nothing || number.is_some_and(|it| !it.is_finite());
        if let (true, Some((start, _))) = (is_none, member) {
            self.mended += 1;
            self.out.truncate(start);
            return rest;
        }
        self.begin();
        match number {
            Some(number) if is_truth => {
                self.mended += 1;
                let truth: &[u8] = if number > 0.0 { b"true" } else { b"false" };
                self.out.extend(truth);
            }
            Some(number) if !number.is_finite() => {
                self.mended += 1;
                let neutral = if self.is_in_list_of(&ONES) {
                    b'1'
                } else {
                    b'0'
                };
                self.out.push(neutral);
            }
            Some(number) if has_point && number.fract() == 0.0 && number.abs() < MOST_EXACT => {
                // Elsewhere both are the same.
                self.mended += usize::from(is_asked);
                self.out.extend((number as i64).to_string().bytes());
            }
            _ => self.out.extend(word),
        }
        rest
    }
}

/// What follows the first of these bytes.
fn after<'a>(json: &'a [u8], end: &[u8]) -> &'a [u8] {
    let at = json.windows(end.len()).position(|it| it == end);
    at.map_or(&[], |at| &json[at + end.len()..])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_people_write_becomes_json() {
        for (said, told, count) in [
            (
                r#"{"a": [1, 2.5, "x"], "b": {}}"#,
                r#"{"a":[1,2.5,"x"],"b":{}}"#,
                0,
            ),
            (r#"{"count": 81.0, "e": 1e2}"#, r#"{"count":81,"e":100}"#, 1),
            (
                r#"{"nodes": [0.0, 1.0, {"mesh": 2.0, "scale": [1.0]}]}"#,
                r#"{"nodes":[0,1,{"mesh":2,"scale":[1]}]}"#,
                3,
            ),
            ("{\"uri\": \"a\nb\\\"c\"}", "{\"uri\":\"a b\\\"c\"}", 1),
            (r#"{"a": null, "b": 1, "c": null}"#, r#"{"b":1}"#, 3),
            (r#"{"a": [null, 1]}"#, r#"{"a":[null,1]}"#, 0),
            (r#"{"mesh": -1, "weight": -1}"#, r#"{"weight":-1}"#, 2),
            (r#"[1, 2, ]"#, "[1,2]", 1),
            (
                "{\"a\": 1, // one\n \"b\": 2 /* two */}",
                r#"{"a":1,"b":2}"#,
                2,
            ),
            (r#"{"a": NaN, "b": [NaN, -inf]}"#, r#"{"b":[0,0]}"#, 4),
            (r#"{"scale": [2, NaN]}"#, r#"{"scale":[2,1]}"#, 1),
            (
                r#"{"count": "81", "name": "81", "at": ["1", "-2.5e0", "x"]}"#,
                r#"{"count":81,"name":"81","at":[1,-2.5e0,"x"]}"#,
                3,
            ),
            (
                r#"{"doubleSided": 1, "normalized": "true", "count": 1}"#,
                r#"{"doubleSided":true,"normalized":true,"count":1}"#,
                2,
            ),
        ] {
            let (found, mended) = mended(said.as_bytes());
            assert_eq!(String::from_utf8_lossy(&found), told, "{said}");
            assert_eq!(mended, count, "{said}");
        }
    }

    #[test]
    fn whatever_comes_ends() {
        for said in [
            "", "\"", "\"\\", ",,,", "{{{", "]", "/*", "//", "/", "\u{1}", ":", "nul",
        ] {
            mended(said.as_bytes());
        }
    }
}
