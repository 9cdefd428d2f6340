//! What does the header of a PLY file say that follows it?

use super::super::error::Fault;
use super::super::text::shortened;

/// A kind of number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F16,
    F32,
    F64,
}

impl Scalar {
    fn of(word: &str) -> Option<Self> {
        let scalar = match word.to_ascii_lowercase().as_str() {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "int64" | "long" => Self::I64,
            "uint64" | "ulong" => Self::U64,
            "half" | "float16" => Self::F16,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        };
        Some(scalar)
    }

    pub(super) fn is_whole(self) -> bool {
        !matches!(self, Self::F16 | Self::F32 | Self::F64)
    }

    pub(super) fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 | Self::F16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }
}

/// What each row of an element has.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Property {
    One {
        name: String,
        scalar: Scalar,
    },
    /// A length, and as many numbers.
    List {
        name: String,
        length: Scalar,
        scalar: Scalar,
    },
}

/// Rows of one kind.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
}

/// How numbers are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

/// A whole number, maybe written as `3.0`.
fn count_of(word: &str) -> Option<u64> {
    const MOST: f64 = (1_u64 << 53) as f64;
    let real = || word.parse::<f64>().ok();
    let whole = || real().filter(|it| it.fract() == 0.0 && (0.0..=MOST).contains(it));
    word.parse().ok().or_else(|| whole().map(|it| it as u64))
}

/// The name of an element as the format has it, where it is one that other programs write.
fn element_of(name: &str) -> String {
    let usual = match name.to_ascii_lowercase().as_str() {
        "vertex" | "vertices" | "point" | "points" => "vertex",
        "face" | "faces" | "triangle" | "triangles" | "polygon" | "polygons" => "face",
        "tristrips" => "tristrips",
        _ => name,
    };
    usual.to_owned()
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct PlyHeader {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// Where rows begin, in bytes.
    pub(super) end: usize,
    /// How many lines the header has.
    pub(super) lines: usize,
    /// Whether a comment names a picture, as MeshLab writes it.
    pub(super) has_textures: bool,
}

impl PlyHeader {
    pub(super) fn parse(bytes: &[u8]) -> Result<Self, Fault> {
        if !bytes
            .get(..3)
            .is_some_and(|it| it.eq_ignore_ascii_case(b"ply"))
        {
            return Err(Fault::at("byte 0", "a PLY file begins with `ply`"));
        }
        let end_of_line = match bytes.get(3..5) {
            Some([b'\r', b'\n']) => b'\n',
            Some([b'\r', _]) => b'\r',
            _ => b'\n',
        };
        let mut header = Self {
            encoding: Encoding::Text,
            elements: Vec::new(),
            end: 0,
            lines: 0,
            has_textures: false,
        };
        let mut encoding = None;
        for line in bytes.split_inclusive(|byte| *byte == end_of_line) {
            header.end += line.len();
            header.lines += 1;
            let text = String::from_utf8_lossy(line);
            let mut words: Vec<&str> = text.split_ascii_whitespace().collect();
            // Some write them in capitals.
            let small = words
                .first()
                .map_or_else(String::new, |it| it.to_ascii_lowercase());
            if let Some(first) = words.first_mut() {
                *first = &small;
            }
            match words.as_slice() {
                ["end_header"] if line.ends_with(&[end_of_line]) => {
                    header.encoding = encoding
                        .ok_or_else(|| Fault::at("header", "the line `format` is missing"))?;
                    return Ok(header);
                }
                ["format", name, ..] => encoding = Some(header.encoding_of(name)?),
                ["comment", rest @ ..] => {
                    header.has_textures |= rest.first() == Some(&"TextureFile");
                }
                [_] if header.lines == 1 => {}
                [] | ["obj_info", ..] => {}
                other => header.add(other)?,
            }
        }
        Err(Fault::line(
            header.lines,
            "the file ends before `end_header`",
        ))
    }

    fn encoding_of(&self, name: &str) -> Result<Encoding, Fault> {
        match name.to_ascii_lowercase().as_str() {
            "ascii" => Ok(Encoding::Text),
            "binary_little_endian" => Ok(Encoding::LittleEndian),
            "binary_big_endian" => Ok(Encoding::BigEndian),
            _ => Err(self.fault(&["format", name])),
        }
    }

    fn add(&mut self, words: &[&str]) -> Result<(), Fault> {
        let fault = self.fault(words);
        let scalar = |word: &str| Scalar::of(word).ok_or_else(|| fault.clone());
        let property = match words {
            ["element", name, count] => {
                self.elements.push(Element {
                    name: element_of(name),
                    count: count_of(count).ok_or_else(|| fault.clone())?,
                    properties: Vec::new(),
                });
                return Ok(());
            }
            ["property", "list", length, of, name] => Property::List {
                name: (*name).to_owned(),
                length: scalar(length)?,
                scalar: scalar(of)?,
            },
            ["property", of, name] => Property::One {
                name: (*name).to_owned(),
                scalar: scalar(of)?,
            },
            _ => return Err(fault),
        };
        match self.elements.last_mut() {
            Some(element) => element.properties.push(property),
            None => return Err(fault),
        }
        Ok(())
    }

    fn fault(&self, words: &[&str]) -> Fault {
        let words = shortened(&words.join(" "));
        Fault::line(
            self.lines,
            format!("{words:?} has no meaning in a PLY header"),
        )
    }
}
