//! Which picture does a HEIF file (AVIF, HEIC) show, and where do its parts lie?
//!
//! ISO/IEC 23008-12: a file holds items; the primary one is shown, perhaps put together of tiles,
//! with another item as its alpha, turned and mirrored as its properties say.

use std::io::{Read, Seek, SeekFrom};
use std::ops::Range;

use crate::read::orientation::Orientation;

/// Longest box of items that is read, in bytes.
const MOST_META: u64 = 16 << 20;
/// Boxes at the beginning among which it is looked for.
const MOST_BOXES: u32 = 64;
/// Most tiles of a picture.
const MOST_TILES: usize = 4096;
/// What an item is that holds the alpha of another.
const ALPHA: [&[u8]; 2] = [
    b"urn:mpeg:mpegB:cicp:systems:auxiliary:alpha",
    b"urn:mpeg:hevc:2015:auxid:1",
];

/// A HEIF file as far as its first picture goes.
#[derive(Clone, Debug, PartialEq)]
pub struct Heif {
    /// How its items are coded: four letters, as `av01` or `hvc1`.
    pub coding: [u8; 4],
    /// What is shown.
    pub picture: Tiled,
    /// Its alpha, in luma, and whether colours are multiplied by it already.
    pub alpha: Option<(Tiled, bool)>,
    /// How its samples are turned to be looked at.
    pub(crate) orientation: Orientation,
    /// Width and height of a pixel to each other.
    pub pixel_aspect: Option<[u32; 2]>,
    /// Matrix and full range, where the file says other than its coded data: H.273's numbers.
    pub colour: Option<(u16, bool)>,
    /// What of it is passed over, in words.
    pub passed_over: Vec<String>,
    /// Bytes that describe it, as XMP.
    pub xmp: Option<Vec<Range<u64>>>,
    /// Whether the file is a series of pictures, of which this is one.
    pub is_series: bool,
}

/// Coded pictures that lie next to each other.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tiled {
    /// Columns of tiles.
    pub columns: usize,
    /// Size of the whole in pixels, where there are several; what reaches beyond is cut off.
    pub size: Option<[u32; 2]>,
    /// Where the bytes of each tile lie in the file, row by row.
    pub tiles: Vec<Vec<Range<u64>>>,
}

/// What a file of HEIF is, if it is one. The error says what is wrong with it.
pub fn read_heif(file: &mut (impl Read + Seek)) -> Option<Result<Heif, String>> {
    let (brands, meta, at) = head_of(file)?;
    let is = |name: &[u8; 4]| brands.chunks_exact(4).any(|it| it == name);
    let names = [
        b"avif", b"avis", b"heic", b"heix", b"hevc", b"mif1", b"msf1", b"heim", b"heis",
    ];
    if !names.into_iter().any(is) {
        return None;
    }
    let meta = meta?;
    let end = file.seek(SeekFrom::End(0)).ok()?;
    let items = Items::new(&meta, (at, end));
    let is_series =
        [b"avis", b"msf1", b"hevc"].contains(&&[brands[0], brands[1], brands[2], brands[3]]);
    let found = items.and_then(|items| items.shown(file));
    Some(found.map(|heif| Heif { is_series, ..heif }))
}

/// Brands, the contents of the box of items, and where in the file that begins.
type Head = (Vec<u8>, Option<Vec<u8>>, u64);

fn head_of(file: &mut (impl Read + Seek)) -> Option<Head> {
    let mut brands: Option<Vec<u8>> = None;
    let mut at = 0u64;
    for _ in 0..MOST_BOXES {
        file.seek(SeekFrom::Start(at)).ok()?;
        let mut head = [0; 16];
        if file.read_exact(&mut head[..8]).is_err() {
            break;
        }
        let (mut length, mut inside) = (u64::from(word(&head, 0)?), at + 8);
        if length == 1 {
            file.read_exact(&mut head[8..]).ok()?;
            length = u64::from(word(&head, 8)?) << 32 | u64::from(word(&head, 12)?);
            inside = at + 16;
        }
        let end = match length {
            0 => file.seek(SeekFrom::End(0)).ok()?,
            length => at.checked_add(length)?,
        };
        let bytes = end.checked_sub(inside)?;
        let mut contents = |most: u64| {
            let mut contents = Vec::new();
            file.seek(SeekFrom::Start(inside)).ok()?;
            file.take(bytes.min(most)).read_to_end(&mut contents).ok()?;
            Some(contents)
        };
        match (&head[4..8], &brands) {
            (b"ftyp", None) => {
                let it = contents(4096)?;
                let mut all = it.get(..4)?.to_vec();
                all.extend_from_slice(it.get(8..).unwrap_or_default());
                brands = Some(all);
            }
            (b"meta", Some(_)) if bytes <= MOST_META => {
                return Some((brands?, Some(contents(MOST_META)?), inside));
            }
            (_, None) => return None,
            _ => {}
        }
        at = end;
    }
    Some((brands?, None, 0))
}

/// A number of four bytes.
fn word(bytes: &[u8], at: usize) -> Option<u32> {
    let four = bytes.get(at..at.checked_add(4)?)?;
    Some(u32::from_be_bytes(four.try_into().ok()?))
}

/// The boxes that follow each other: name and contents.
fn boxes(bytes: &[u8]) -> Vec<([u8; 4], &[u8])> {
    let mut found = Vec::new();
    let mut rest = bytes;
    while let (Some(length), Some(name)) = (word(rest, 0), rest.get(4..8)) {
        let length = if length == 0 {
            rest.len()
        } else {
            length as usize
        };
        let Some(contents) = rest.get(8..length) else {
            break;
        };
        found.push(([name[0], name[1], name[2], name[3]], contents));
        rest = &rest[length..];
    }
    found
}

/// Reads numbers from the front of bytes.
struct Numbers<'a>(&'a [u8]);

impl Numbers<'_> {
    /// A number of so many bytes, 0 to 8.
    fn next(&mut self, bytes: usize) -> Option<u64> {
        let (first, rest) = self.0.split_at_checked(bytes)?;
        self.0 = rest;
        Some(
            first
                .iter()
                .fold(0, |sum, byte| sum << 8 | u64::from(*byte)),
        )
    }
}

/// The items of a file.
struct Items<'a> {
    primary: u32,
    /// Number and kind.
    kinds: Vec<(u32, [u8; 4])>,
    /// Number, and where in the file its bytes lie.
    places: Vec<(u32, Vec<Range<u64>>)>,
    /// Kind, from, to.
    references: Vec<([u8; 4], u32, Vec<u32>)>,
    properties: Vec<([u8; 4], &'a [u8])>,
    /// Number of an item, and of its properties, counted from 1.
    associations: Vec<(u32, Vec<usize>)>,
}

impl<'a> Items<'a> {
    /// Of the contents of a `meta` box that begin at a byte of a file of `end` bytes.
    fn new(meta: &'a [u8], (at, end): (u64, u64)) -> Result<Self, String> {
        let inside = meta.get(4..).ok_or("its list of pictures is empty")?;
        let all = boxes(inside);
        let first = |name: &[u8; 4]| all.iter().find(|it| it.0 == *name).map(|it| it.1);
        let broken = |name: &str| format!("its list of pictures ({name}) is broken");
        let primary = first(b"pitm").and_then(|it| {
            let wide = if it.first()? == &0 { 2 } else { 4 };
            Numbers(it.get(4..)?).next(wide)
        });
        // Data may lie in a box next to the list.
        let stored = first(b"idat").map(|it| {
            let from = at + (it.as_ptr() as usize - meta.as_ptr() as usize) as u64;
            from..from + it.len() as u64
        });
        let properties = first(b"iprp").map(boxes).unwrap_or_default();
        let of = |name: &[u8; 4]| properties.iter().find(|it| it.0 == *name).map(|it| it.1);
        let references = first(b"iref").map(references).unwrap_or_default();
        Ok(Self {
            primary: primary.ok_or_else(|| broken("pitm"))? as u32,
            kinds: first(b"iinf")
                .and_then(kinds)
                .ok_or_else(|| broken("iinf"))?,
            places: first(b"iloc")
                .and_then(|it| places(it, stored, end))
                .ok_or_else(|| broken("iloc"))?,
            references,
            properties: of(b"ipco").map(boxes).unwrap_or_default(),
            associations: of(b"ipma").and_then(associations).unwrap_or_default(),
        })
    }

    fn kind(&self, item: u32) -> Option<[u8; 4]> {
        self.kinds.iter().find(|it| it.0 == item).map(|it| it.1)
    }

    fn place(&self, item: u32) -> Result<Vec<Range<u64>>, String> {
        let found = self.places.iter().find(|it| it.0 == item);
        let place = found.map(|it| it.1.clone()).filter(|it| !it.is_empty());
        place.ok_or_else(|| format!("item {item} of its list of pictures lies nowhere"))
    }

    /// The properties of an item, in order.
    fn of(&self, item: u32) -> impl Iterator<Item = ([u8; 4], &'a [u8])> {
        let numbers = self.associations.iter().find(|it| it.0 == item);
        let numbers = numbers.map(|it| it.1.clone()).unwrap_or_default();
        let known = |number: usize| self.properties.get(number.checked_sub(1)?).copied();
        numbers.into_iter().filter_map(known)
    }

    /// What a reference of this kind from an item names.
    fn named(&self, kind: &[u8; 4], from: u32) -> &[u32] {
        let found = self
            .references
            .iter()
            .find(|it| it.0 == *kind && it.1 == from);
        found.map_or(&[], |it| &it.2)
    }

    fn tiled(&self, file: &mut (impl Read + Seek), item: u32) -> Result<Tiled, String> {
        if self.kind(item) != Some(*b"grid") {
            return Ok(Tiled {
                columns: 1,
                size: None,
                tiles: vec![self.place(item)?],
            });
        }
        let bytes = bytes_of(file, &self.place(item)?, 64)?;
        let broken = || "its grid of tiles is broken".to_owned();
        let mut numbers = Numbers(&bytes);
        let mut next = |bytes| numbers.next(bytes).ok_or_else(broken);
        next(1)?;
        let wide = if next(1)? & 1 == 0 { 2 } else { 4 };
        let [rows, columns] = [next(1)? as usize + 1, next(1)? as usize + 1];
        let size = [next(wide)? as u32, next(wide)? as u32];
        let tiles = self.named(b"dimg", item);
        if tiles.len() != rows * columns || tiles.len() > MOST_TILES || size.contains(&0) {
            return Err(broken());
        }
        Ok(Tiled {
            columns,
            size: Some(size),
            tiles: tiles
                .iter()
                .map(|it| self.place(*it))
                .collect::<Result<_, _>>()?,
        })
    }

    /// The item that is shown.
    fn shown(&self, file: &mut (impl Read + Seek)) -> Result<Heif, String> {
        let item = self.primary;
        let kind = self.kind(item).ok_or("its primary picture is missing")?;
        let tiles = self.named(b"dimg", item);
        let coding = match &kind {
            b"grid" => tiles.first().and_then(|it| self.kind(*it)).unwrap_or(kind),
            _ => kind,
        };
        let mut heif = Heif {
            coding,
            picture: Tiled::default(),
            alpha: None,
            orientation: Orientation::default(),
            pixel_aspect: None,
            colour: None,
            passed_over: Vec::new(),
            xmp: self.xmp(),
            is_series: false,
        };
        if &coding != b"av01" {
            return Ok(heif);
        }
        heif.picture = self.tiled(file, item)?;
        for (name, contents) in self.of(item) {
            heif.take(&name, contents);
        }
        let is_alpha = |it: &&([u8; 4], u32, Vec<u32>)| {
            it.0 == *b"auxl" && it.2.contains(&item) && self.is_alpha(it.1)
        };
        if let Some((_, alpha, _)) = self.references.iter().find(is_alpha) {
            let is_multiplied = self.named(b"prem", item).contains(alpha);
            match self.tiled(file, *alpha) {
                Ok(tiled) => heif.alpha = Some((tiled, is_multiplied)),
                Err(why) => heif
                    .passed_over
                    .push(format!("its transparency is not read: {why}")),
            }
        }
        Ok(heif)
    }

    fn is_alpha(&self, item: u32) -> bool {
        self.of(item).any(|(name, contents)| {
            let kind = contents.get(4..).unwrap_or_default();
            name == *b"auxC" && ALPHA.into_iter().any(|it| kind.starts_with(it))
        })
    }

    fn xmp(&self) -> Option<Vec<Range<u64>>> {
        let mime = self.kinds.iter().find(|it| it.1 == *b"mime")?;
        self.place(mime.0).ok()
    }
}

impl Heif {
    /// A property of the picture.
    fn take(&mut self, name: &[u8; 4], contents: &[u8]) {
        match (name, contents) {
            // Anticlockwise, in quarters.
            (b"irot", [turns, ..]) => {
                let exif = [1, 8, 3, 6][usize::from(turns & 3)];
                let turn = Orientation::from_exif(exif).unwrap_or_default();
                self.orientation = self.orientation.then(turn);
            }
            // 0 exchanges top and bottom, 1 left and right.
            (b"imir", [axis, ..]) => {
                let exif = [4, 2][usize::from(axis & 1)];
                let mirror = Orientation::from_exif(exif).unwrap_or_default();
                self.orientation = self.orientation.then(mirror);
            }
            (b"pasp", _) => {
                let sides = word(contents, 0).zip(word(contents, 4));
                self.pixel_aspect = sides.map(|(wide, high)| [wide, high]);
            }
            (b"colr", [b'n', b'c', b'l', b'x', _, _, _, _, high, low, range, ..]) => {
                let matrix = u16::from_be_bytes([*high, *low]);
                self.colour = Some((matrix, range & 0x80 != 0));
            }
            (b"clap", _) => {
                let what = "its crop (clap) is not applied: all of it is shown";
                self.passed_over.push(what.to_owned());
            }
            _ => {}
        }
    }
}

/// The bytes of an item, of which there may be `most`.
pub(crate) fn bytes_of(
    file: &mut (impl Read + Seek),
    places: &[Range<u64>],
    most: u64,
) -> Result<Vec<u8>, String> {
    let length = places
        .iter()
        .map(|it| it.end - it.start)
        .fold(0, u64::saturating_add);
    if length > most {
        return Err(format!("a part of it has {length} bytes, more than {most}"));
    }
    let mut bytes = Vec::new();
    for place in places {
        let found = file
            .seek(SeekFrom::Start(place.start))
            .and_then(|_| file.take(place.end - place.start).read_to_end(&mut bytes));
        found.map_err(|error| error.to_string())?;
    }
    match bytes.len() as u64 == length {
        true => Ok(bytes),
        false => Err("it ends within a picture; copy it again".to_owned()),
    }
}

fn kinds(iinf: &[u8]) -> Option<Vec<(u32, [u8; 4])>> {
    let count = if iinf.first()? == &0 { 2 } else { 4 };
    let entries = boxes(iinf.get(4 + count..)?).into_iter();
    let entries = entries.filter(|it| it.0 == *b"infe").filter_map(|(_, it)| {
        let version = *it.first()?;
        let wide = if version >= 3 { 4 } else { 2 };
        let mut numbers = Numbers(it.get(4..)?);
        let number = numbers.next(wide)? as u32;
        numbers.next(2)?;
        Some((number, (numbers.next(4)? as u32).to_be_bytes()))
    });
    Some(entries.collect())
}

fn places(
    iloc: &[u8],
    stored: Option<Range<u64>>,
    end: u64,
) -> Option<Vec<(u32, Vec<Range<u64>>)>> {
    let version = *iloc.first()?;
    let mut numbers = Numbers(iloc.get(4..)?);
    let sizes = numbers.next(2)?;
    let [offset, length, base, index] = [12, 8, 4, 0].map(|shift| (sizes >> shift & 15) as usize);
    if [offset, length, base, index].iter().any(|it| *it > 8) {
        return None;
    }
    let wide = if version < 2 { 2 } else { 4 };
    let items = numbers.next(wide)?;
    let mut found = Vec::new();
    for _ in 0..items {
        let item = numbers.next(wide)? as u32;
        let method = if version > 0 {
            numbers.next(2)? & 15
        } else {
            0
        };
        numbers.next(2)?;
        let from = numbers.next(base)?;
        let extents = numbers.next(2)?;
        // Places without a number each would cost nothing and be many.
        if offset + length + index == 0 && extents > 1 {
            return None;
        }
        let mut places = Vec::new();
        for _ in 0..extents {
            if version > 0 {
                numbers.next(index)?;
            }
            let at = from.checked_add(numbers.next(offset)?)?;
            let bytes = numbers.next(length)?;
            let (at, end) = match method {
                0 => (Some(at), end),
                1 => (stored.as_ref()?.start.checked_add(at), stored.as_ref()?.end),
                _ => (None, 0),
            };
            let Some(at) = at else { continue };
            let bytes = if bytes == 0 {
                end.saturating_sub(at)
            } else {
                bytes
            };
            places.push(at..at.checked_add(bytes)?);
        }
        // What is longer than the file overlaps itself.
        let bytes = places.iter().map(|it: &Range<u64>| it.end - it.start);
        if bytes.fold(0, u64::saturating_add) <= end {
            found.push((item, places));
        }
    }
    Some(found)
}

fn references(iref: &[u8]) -> Vec<([u8; 4], u32, Vec<u32>)> {
    let wide = if iref.first() == Some(&0) { 2 } else { 4 };
    let all = boxes(iref.get(4..).unwrap_or_default()).into_iter();
    let all = all.filter_map(|(kind, contents)| {
        let mut numbers = Numbers(contents);
        let from = numbers.next(wide)? as u32;
        let count = numbers.next(2)?;
        let to = (0..count).map(|_| numbers.next(wide).map(|it| it as u32));
        Some((kind, from, to.collect::<Option<Vec<u32>>>()?))
    });
    all.collect()
}

fn associations(ipma: &[u8]) -> Option<Vec<(u32, Vec<usize>)>> {
    let wide = if ipma.first()? == &0 { 2 } else { 4 };
    let is_long = ipma.get(3)? & 1 == 1;
    let mut numbers = Numbers(ipma.get(4..)?);
    let entries = numbers.next(4)?;
    let mut found = Vec::new();
    for _ in 0..entries {
        let item = numbers.next(wide)? as u32;
        let count = numbers.next(1)?;
        let properties = (0..count).map(|_| match is_long {
            true => numbers.next(2).map(|it| (it & 0x7fff) as usize),
            false => numbers.next(1).map(|it| (it & 0x7f) as usize),
        });
        found.push((item, properties.collect::<Option<_>>()?));
    }
    Some(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::io::Cursor;

    fn boxed(name: &[u8; 4], contents: &[u8]) -> Vec<u8> {
        let length = (contents.len() as u32 + 8).to_be_bytes();
        [&length[..], name, contents].concat()
    }

    /// A file of one picture, turned once and mirrored.
    fn file() -> Vec<u8> {
        let infe = boxed(b"infe", b"\x02\0\0\0\0\x01\0\0av01\0");
        let ipco = [boxed(b"irot", &[1]), boxed(b"imir", &[1])].concat();
        let ipma = boxed(b"ipma", b"\0\0\0\0\0\0\0\x01\0\x01\x02\x81\x82");
        let meta = [
            b"\0\0\0\0".to_vec(),
            boxed(b"pitm", b"\0\0\0\0\0\x01"),
            boxed(b"iinf", &[&b"\0\0\0\0\0\x01"[..], &infe].concat()),
            boxed(
                b"iloc",
                b"\0\0\0\0\x44\0\0\x01\0\x01\0\0\0\x01\0\0\0\x04\0\0\0\x08",
            ),
            boxed(b"iprp", &[boxed(b"ipco", &ipco), ipma].concat()),
        ];
        [
            boxed(b"ftyp", b"avif\0\0\0\0mif1"),
            boxed(b"meta", &meta.concat()),
        ]
        .concat()
    }

    #[test]
    fn a_picture_is_turned_then_mirrored() {
        let heif = read_heif(&mut Cursor::new(file())).unwrap().unwrap();
        assert_eq!(heif.coding, *b"av01");
        let places = &heif.picture.tiles[0];
        assert_eq!((places.len(), places[0].start, places[0].end), (1, 4, 12));
        let turned = Orientation::from_exif(8).unwrap();
        assert_eq!(
            heif.orientation,
            turned.then(Orientation::from_exif(2).unwrap())
        );
        assert!(read_heif(&mut Cursor::new(b"RIFF")).is_none());
    }

    proptest! {
        #[test]
        fn no_bytes_make_it_panic(
            at in 0usize..400,
            bytes in prop::collection::vec(any::<u8>(), 1..9),
            cut in 0usize..400,
        ) {
            let mut file = file();
            let at = at % file.len();
            let end = (at + bytes.len()).min(file.len());
            file[at..end].copy_from_slice(&bytes[..end - at]);
            let _ = read_heif(&mut Cursor::new(&file));
            let _ = read_heif(&mut Cursor::new(&file[..cut % file.len()]));
        }
    }
}
