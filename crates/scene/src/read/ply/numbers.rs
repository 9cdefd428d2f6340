//! What is the next number of a PLY file?
//!
//! In text a row has a line of its own, where the first row of its element has; else numbers may
//! stand in any lines.

use super::super::half::half;
use super::super::text::glued;
use super::super::text::numbers::{number_of, plain_number};
use super::header::{Element, Encoding, PlyHeader, Property, Scalar};

/// Of so many elements it is found out whether rows are lines: the file is looked through for it.
const MOST_LOOKED_AT: usize = 16;
/// Lists of so many numbers are believed without a look at their line.
const FEW: f64 = 64.0;

/// The rows of a file, read number by number.
pub(super) struct Numbers<'a> {
    encoding: Encoding,
    bytes: &'a [u8],
    at: usize,
    /// Whether each row is a line of its own.
    has_lines: bool,
    /// Of the number before, counted from 1; text only.
    line: usize,
    /// Whether a row was begun, of which there may be more.
    is_begun: bool,
    /// How many elements were begun.
    begun: usize,
    /// Rows that had more words than they should, and that had a list of no length.
    pub(super) too_long: Lines,
    pub(super) broken: Lines,
    /// Numbers with a decimal comma.
    pub(super) commas: usize,
    /// Rows with numbers that have no blank between them.
    pub(super) glued: Lines,
    /// How many numbers a row of an element without lists has, and where the row begins.
    columns: Option<usize>,
    row_at: usize,
    /// Numbers of a row that were read before their turn, the last first.
    parted: Vec<f64>,
}

/// How many lines were mended, and the first.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Lines {
    pub(super) times: usize,
    pub(super) first: usize,
}

impl Lines {
    fn add(&mut self, line: usize) {
        self.times += 1;
        if self.times == 1 {
            self.first = line;
        }
    }
}

impl<'a> Numbers<'a> {
    pub(super) fn of(header: &PlyHeader, bytes: &'a [u8]) -> Self {
        Self {
            encoding: header.encoding,
            bytes,
            at: header.end,
            has_lines: false,
            line: header.lines + 1,
            is_begun: false,
            begun: 0,
            too_long: Lines::default(),
            broken: Lines::default(),
            commas: 0,
            glued: Lines::default(),
            columns: None,
            row_at: 0,
            parted: Vec::new(),
        }
    }

    /// Where the next number stands, for people.
    pub(super) fn place(&self) -> String {
        match self.encoding {
            Encoding::Text => format!("in line {}", self.line),
            _ => format!("at byte {}", self.at),
        }
    }

    /// Begins the rows of an element.
    pub(super) fn begin(&mut self, element: &Element) {
        self.has_lines = false;
        self.begun += 1;
        if self.encoding != Encoding::Text || self.begun > MOST_LOOKED_AT {
            return;
        }
        self.skip_blank();
        let said = self.words(self.at);
        let mut first = said.clone();
        let mut needed = 0_usize;
        for property in &element.properties {
            let length = match property {
                Property::One { .. } => {
                    first.next();
                    1
                }
                Property::List { .. } => {
                    let length = first.next().and_then(|it| it.parse::<usize>().ok());
                    let length = length.unwrap_or(0).min(self.left());
                    first.by_ref().take(length).for_each(drop);
                    length + 1
                }
            };
            needed = needed.saturating_add(length);
        }
        let has_lists = |it: &Property| matches!(it, Property::List { .. });
        let lists = element.properties.iter().any(has_lists);
        self.columns = (!lists).then_some(needed);
        let mut found = said.clone().count();
        if !lists && glued::numbers(said, |count| count == needed).is_some() {
            found = needed;
        }
        // More words are more of the row, unless several rows share a line.
        self.has_lines = found == needed || found > needed && self.lines_reach(element.count);
    }

    fn words(&self, at: usize) -> impl Iterator<Item = &'a str> + Clone + use<'a> {
        let rest = &self.bytes[at..];
        let line = &rest[..end_of_line(rest)];
        core::str::from_utf8(line)
            .unwrap_or("")
            .split_ascii_whitespace()
    }

    /// Whether there are so many lines with words.
    fn lines_reach(&self, count: u64) -> bool {
        let lines = self.bytes[self.at..].split(|byte| matches!(byte, b'\n' | b'\r'));
        let full = lines.filter(|line| !line.trim_ascii().is_empty());
        full.take(usize::try_from(count).unwrap_or(usize::MAX))
            .count() as u64
            == count
    }

    /// Begins a row of the element.
    pub(super) fn begin_row(&mut self) {
        if !self.has_lines {
            return;
        }
        self.leave_row();
        self.skip_blank();
        let is_sign = |sign: &u8| matches!(sign, b'#' | b'/' | b'c');
        while self.bytes.get(self.at).is_some_and(is_sign)
            && self.words(self.at).next().is_some_and(is_comment)
        {
            self.at += end_of_line(&self.bytes[self.at..]);
            self.skip_blank();
        }
        self.is_begun = true;
        self.row_at = self.at;
    }

    /// Ends the rows of an element.
    pub(super) fn end(&mut self) {
        if self.has_lines {
            self.leave_row();
        }
        self.has_lines = false;
    }

    /// Leaves out what is left of a row.
    fn leave_row(&mut self) {
        self.parted.clear();
        let rest = &self.bytes[self.at..];
        let rest = &rest[..end_of_line(rest)];
        if self.is_begun && !rest.trim_ascii().is_empty() {
            self.too_long.add(self.line);
            self.at += rest.len();
        }
        self.is_begun = false;
    }

    /// How many rows, at most, stand behind those of the last element.
    pub(super) fn rows_left(&self, last: &Element) -> usize {
        let rest = &self.bytes[self.at..];
        if self.encoding == Encoding::Text {
            let lines = rest.split(|byte| matches!(byte, b'\n' | b'\r'));
            let is_row = |line: &&[u8]| line.iter().any(u8::is_ascii_alphanumeric);
            return lines.filter(is_row).count();
        }
        // Zeros and blanks fill up.
        let end = rest
            .iter()
            .rposition(|it| *it != 0 && !it.is_ascii_whitespace());
        let least = last.properties.iter().map(|it| match it {
            Property::One { scalar, .. } => scalar.bytes(),
            Property::List { length, scalar, .. } => length.bytes() + 3 * scalar.bytes(),
        });
        end.map_or(0, |end| (end + 1) / least.sum::<usize>().max(1))
    }

    fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// The next number, NaN where a word is no number or the line of a row ends before; `None` at
    /// the end of the file.
    pub(super) fn number(&mut self, scalar: Scalar) -> Option<f64> {
        match self.encoding {
            Encoding::Text => self.next_of_text(),
            Encoding::LittleEndian => self.next_bytes(scalar).map(|bytes| value(scalar, bytes)),
            Encoding::BigEndian => self.next_bytes(scalar).map(|mut bytes| {
                bytes[..scalar.bytes()].reverse();
                value(scalar, bytes)
            }),
        }
    }

    fn next_of_text(&mut self) -> Option<f64> {
        if let Some(number) = self.parted.pop() {
            return Some(number);
        }
        self.leave_blank();
        if let Some((number, length)) = plain_number(&self.bytes[self.at..]) {
            self.at += length;
            return Some(number);
        }
        let begin = self.at;
        let Some(word) = self.next_word() else {
            let is_short = self.has_lines && self.left() > 0;
            return is_short.then_some(f64::NAN);
        };
        let number = number_of(word, &mut self.commas);
        number.or_else(|| self.part(begin)).or(Some(f64::NAN))
    }

    /// The number at `begin` of a row whose numbers have no blanks between some of them; the others
    /// from there on wait for their turn.
    fn part(&mut self, begin: usize) -> Option<f64> {
        let columns = self.columns.filter(|_| self.has_lines)?;
        let before = core::str::from_utf8(&self.bytes[self.row_at..begin]).ok()?;
        let before = before.split_ascii_whitespace().count();
        let all = glued::numbers(self.words(self.row_at), |count| count == columns)?;
        self.glued.add(self.line);
        self.at = begin + end_of_line(&self.bytes[begin..]);
        self.parted = all.into_iter().skip(before).collect();
        self.parted.reverse();
        self.parted.pop()
    }

    /// The next number, into which parts of a colour are packed, as a whole one: that of its bits
    /// where it is real. As `number`, at the end of the file.
    pub(super) fn packed(&mut self, scalar: Scalar) -> Option<f64> {
        let bits = match (self.encoding, scalar) {
            (Encoding::LittleEndian, Scalar::F32) => {
                let [a, b, c, d, ..] = self.next_bytes(scalar)?;
                u32::from_le_bytes([a, b, c, d])
            }
            (Encoding::BigEndian, Scalar::F32) => {
                let [a, b, c, d, ..] = self.next_bytes(scalar)?;
                u32::from_be_bytes([a, b, c, d])
            }
            _ => {
                let number = self.number(scalar)?;
                // What is less than 1 is no whole number that was written as a real one.
                let is_whole = number.fract() == 0.0 && number.abs() >= 1.0;
                match is_whole && number.abs() <= f64::from(u32::MAX) || number == 0.0 {
                    true => number as i64 as u32,
                    false => (number as f32).to_bits(),
                }
            }
        };
        Some(f64::from(bits))
    }

    /// The length of a list; 0 where a line of its own says none. `None` where so many numbers
    /// cannot follow: then nothing that follows can be found.
    pub(super) fn length(&mut self, length: Scalar, scalar: Scalar) -> Option<usize> {
        let said = self.number(length)?;
        let least = match self.encoding {
            Encoding::Text => 1,
            _ => scalar.bytes(),
        };
        let mut most = self.left() / least;
        // A row of a line of its own has no more than stands there.
        if self.has_lines && said > FEW {
            most = end_of_line(&self.bytes[self.at..]);
        }
        if said >= 0.0 && said <= most as f64 && said.fract() == 0.0 {
            return Some(said as usize);
        }
        let end = match self.has_lines {
            true => self.at + end_of_line(&self.bytes[self.at..]),
            false => self.bytes.len(),
        };
        self.at = end;
        if end == self.bytes.len() {
            return None;
        }
        self.broken.add(self.line);
        Some(0)
    }

    pub(super) fn skip(&mut self, property: &Property) -> Option<()> {
        match property {
            Property::One { scalar, .. } => {
                self.number(*scalar)?;
            }
            Property::List { length, scalar, .. } => {
                for _ in 0..self.length(*length, *scalar)? {
                    self.number(*scalar)?;
                }
            }
        }
        Some(())
    }

    fn skip_blank(&mut self) {
        let rest = &self.bytes[self.at..];
        let blank = rest.iter().take_while(|byte| byte.is_ascii_whitespace());
        let mut blanks = 0;
        for byte in blank {
            self.line += usize::from(*byte == b'\n');
            blanks += 1;
        }
        self.at += blanks;
    }

    /// Goes on to the next word, which stands in this line where rows have lines of their own.
    fn leave_blank(&mut self) {
        match self.has_lines {
            true => {
                let rest = &self.bytes[self.at..];
                let is_blank = |it: &&u8| matches!(it, b' ' | b'\t');
                self.at += rest.iter().take_while(is_blank).count();
            }
            false => self.skip_blank(),
        }
    }

    fn next_word(&mut self) -> Option<&'a str> {
        self.leave_blank();
        let rest = &self.bytes[self.at..];
        let length = rest.iter().position(u8::is_ascii_whitespace);
        let word = &rest[..length.unwrap_or(rest.len())];
        self.at += word.len();
        (!word.is_empty()).then(|| core::str::from_utf8(word).unwrap_or("\u{fffd}"))
    }

    fn next_bytes(&mut self, scalar: Scalar) -> Option<[u8; 8]> {
        let Some(found) = self.bytes[self.at..].get(..scalar.bytes()) else {
            self.at = self.bytes.len();
            return None;
        };
        let mut bytes = [0; 8];
        bytes[..found.len()].copy_from_slice(found);
        self.at += found.len();
        Some(bytes)
    }
}

/// Whether a line that begins with a word is no row.
fn is_comment(word: &str) -> bool {
    word.starts_with('#') || word.starts_with("//") || word == "comment"
}

/// Bytes of a line without its end.
fn end_of_line(rest: &[u8]) -> usize {
    let end = rest.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
    end.unwrap_or(rest.len())
}

/// The number that the first bytes are, little end first.
fn value(scalar: Scalar, bytes: [u8; 8]) -> f64 {
    let [a, b, c, d, ..] = bytes;
    match scalar {
        Scalar::I8 => f64::from(a as i8),
        Scalar::U8 => f64::from(a),
        Scalar::I16 => f64::from(i16::from_le_bytes([a, b])),
        Scalar::U16 => f64::from(u16::from_le_bytes([a, b])),
        Scalar::I32 => f64::from(i32::from_le_bytes([a, b, c, d])),
        Scalar::U32 => f64::from(u32::from_le_bytes([a, b, c, d])),
        Scalar::I64 => i64::from_le_bytes(bytes) as f64,
        Scalar::U64 => u64::from_le_bytes(bytes) as f64,
        Scalar::F16 => half(u16::from_le_bytes([a, b])),
        Scalar::F32 => f64::from(f32::from_le_bytes([a, b, c, d])),
        Scalar::F64 => f64::from_le_bytes(bytes),
    }
}
