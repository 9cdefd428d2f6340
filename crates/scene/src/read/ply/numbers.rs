//! What is the next number of a PLY file?

use super::super::error::Fault;
use super::super::text::finite;
use super::header::{Element, Encoding, PlyHeader, Property, Scalar};

/// The rows of a file, read number by number.
pub(super) struct Numbers<'a> {
    encoding: Encoding,
    bytes: &'a [u8],
    at: usize,
    /// Of the number before, counted from 1; text only.
    line: usize,
}

impl<'a> Numbers<'a> {
    pub(super) fn of(header: &PlyHeader, bytes: &'a [u8]) -> Self {
        Self {
            encoding: header.encoding,
            bytes,
            at: header.end,
            line: header.lines + 1,
        }
    }

    /// Refuses an element whose rows do not fit into what is left of the file.
    pub(super) fn check_count(&self, element: &Element) -> Result<(), Fault> {
        let least: usize = match self.encoding {
            // A digit and what parts it from the next.
            Encoding::Text => 2 * element.properties.len(),
            _ => element.properties.iter().map(least_bytes).sum(),
        };
        if least == 0 && element.count > 0 {
            let what = format!("the element {} has rows without properties", element.name);
            return Err(Fault::at("header", what));
        }
        // The last number needs nothing behind it.
        let left = self.left() as u64 + u64::from(self.encoding == Encoding::Text);
        if element.count.saturating_mul(least as u64) <= left {
            return Ok(());
        }
        let place = format!("element {}, byte {}", element.name, self.at);
        let what = format!(
            "{} rows of {least} bytes or more are said to follow, but {} bytes are left",
            element.count,
            self.left()
        );
        Err(Fault::at(place, what))
    }

    fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// What is wrong with a row.
    pub(super) fn fault(&self, element: &Element, index: u64, what: impl ToString) -> Fault {
        let place = match self.encoding {
            Encoding::Text => format!("line {}", self.line),
            _ => format!("byte {}", self.at),
        };
        Fault::at(
            format!("{place}, {} {index} of {}", element.name, element.count),
            what,
        )
    }

    /// The next number; finite if it is text.
    pub(super) fn number(
        &mut self,
        scalar: Scalar,
        element: &Element,
        index: u64,
    ) -> Result<f64, Fault> {
        let number = match self.encoding {
            Encoding::Text => self.next_word().map(finite),
            Encoding::LittleEndian => self
                .next_bytes(scalar)
                .map(|bytes| Ok(value(scalar, bytes))),
            Encoding::BigEndian => self.next_bytes(scalar).map(|mut bytes| {
                bytes[..scalar.bytes()].reverse();
                Ok(value(scalar, bytes))
            }),
        };
        match number {
            Some(Ok(number)) => Ok(number),
            Some(Err(found)) => Err(self.fault(element, index, format!("has {found}"))),
            None => Err(self.fault(element, index, "the file ends here")),
        }
    }

    /// The length of a list, if so many numbers can follow.
    pub(super) fn length(
        &mut self,
        length: Scalar,
        scalar: Scalar,
        element: &Element,
        index: u64,
    ) -> Result<usize, Fault> {
        let said = self.number(length, element, index)?;
        let least = match self.encoding {
            Encoding::Text => 1,
            _ => scalar.bytes(),
        };
        let most = self.left() / least;
        if said >= 0.0 && said <= most as f64 && said.fract() == 0.0 {
            return Ok(said as usize);
        }
        let what = format!("has a list of {said} numbers, but at most {most} can follow");
        Err(self.fault(element, index, what))
    }

    pub(super) fn skip(
        &mut self,
        property: &Property,
        element: &Element,
        index: u64,
    ) -> Result<(), Fault> {
        match property {
            Property::One { scalar, .. } => {
                self.number(*scalar, element, index)?;
            }
            Property::List { length, scalar, .. } => {
                for _ in 0..self.length(*length, *scalar, element, index)? {
                    self.number(*scalar, element, index)?;
                }
            }
        }
        Ok(())
    }

    fn next_word(&mut self) -> Option<&'a str> {
        let rest = &self.bytes[self.at..];
        let blank = rest.iter().take_while(|byte| byte.is_ascii_whitespace());
        let mut blanks = 0;
        for byte in blank {
            blanks += 1;
            self.line += usize::from(*byte == b'\n');
        }
        let rest = &rest[blanks..];
        let end = rest.iter().position(u8::is_ascii_whitespace);
        let word = &rest[..end.unwrap_or(rest.len())];
        self.at += blanks + word.len();
        (!word.is_empty()).then(|| core::str::from_utf8(word).unwrap_or("\u{fffd}"))
    }

    fn next_bytes(&mut self, scalar: Scalar) -> Option<[u8; 8]> {
        let found = self.bytes[self.at..].get(..scalar.bytes())?;
        let mut bytes = [0; 8];
        bytes[..found.len()].copy_from_slice(found);
        self.at += found.len();
        Some(bytes)
    }
}

/// What a row has at least of a property: a list may be empty.
fn least_bytes(property: &Property) -> usize {
    match property {
        Property::One { scalar, .. } => scalar.bytes(),
        Property::List { length, .. } => length.bytes(),
    }
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
        Scalar::F32 => f64::from(f32::from_le_bytes([a, b, c, d])),
        Scalar::F64 => f64::from_le_bytes(bytes),
    }
}
