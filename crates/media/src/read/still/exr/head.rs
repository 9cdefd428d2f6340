//! Which picture of an OpenEXR file is shown, and is all of it there?
//!
//! Source: Academy Software Foundation, "OpenEXR File Layout". Heads and tables of places are read;
//! FFmpeg decodes, and leaves black without a word what it finds no data for.

use std::ops::Range;

use foveal_core::units::counted;

/// What begins every file.
pub(super) const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];
/// Flags of the version: tiles in a file of one part, samples of several depths, several parts.
const TILED: u32 = 0x200;
const DEEP: u32 = 0x800;
const PARTS: u32 = 0x1000;
/// Most parts, attributes of one, channels of one, and bytes of a name.
const MOST_PARTS: usize = 256;
const MOST_ATTRIBUTES: usize = 4096;
const MOST_CHANNELS: usize = 4096;
const MOST_NAME: usize = 255;
/// Most columns or rows.
const MOST_SIDE: i64 = 1 << 24;
/// Rows of a block, by the number of its compression: none, RLE, ZIP of one row, ZIP, PIZ, PXR24,
/// B44 twice, DWA twice.
const ROWS: [u32; 10] = [1, 1, 1, 16, 32, 16, 32, 32, 32, 256];
/// How layers are called that hold the whole picture, the likeliest first.
const WHOLE: [&str; 7] = ["combined", "beauty", "rgba", "rgb", "c", "color", "colour"];
/// Most layers that are named.
const MOST_NAMED: usize = 4;

/// How colours are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Colours {
    /// Red, green and blue, or luminance alone.
    Plain,
    /// Luminance, and how red and blue differ from it.
    Chroma,
}

/// Why a file is not shown.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum ExrRefusal {
    /// What it is instead.
    Kind(String),
    Broken(String),
}

/// The picture that is shown.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExrHead {
    /// The number of its part.
    pub(super) part: usize,
    /// What stands before the names of its channels, without the last dot; empty where nothing
    /// does.
    pub(super) layer: String,
    pub(super) colours: Colours,
    /// What a person should know of it.
    pub(super) note: Option<String>,
    /// Where names of channels stand that are to be in capitals, as FFmpeg wants them.
    pub(super) small: Vec<usize>,
}

/// Reads bytes from front to back.
struct Bytes<'a> {
    all: &'a [u8],
    at: usize,
}

impl<'a> Bytes<'a> {
    fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let end = self.at.checked_add(count)?;
        let found = self.all.get(self.at..end)?;
        self.at = end;
        Some(found)
    }

    fn word(&mut self) -> Option<u32> {
        Some(u32::from_le_bytes(*self.take(4)?.first_chunk()?))
    }

    fn signed(&mut self) -> Option<i32> {
        Some(self.word()? as i32)
    }

    /// A name that ends in NUL, and where it begins.
    fn name(&mut self) -> Option<(usize, &'a [u8])> {
        let rest = &self.all[self.at..];
        let end = rest.iter().take(MOST_NAME + 1).position(|it| *it == 0)?;
        let begin = self.at;
        self.at += end + 1;
        Some((begin, &rest[..end]))
    }
}

/// A channel: its name, where that ends in the file, and of how many columns and rows it has one.
struct Channel {
    name: String,
    last: usize,
    every: [u32; 2],
}

/// A part of a file.
#[derive(Default)]
struct Part {
    channels: Vec<Channel>,
    compression: u8,
    /// First and last column and row.
    window: Option<[i32; 4]>,
    tile: Option<[u32; 2]>,
    /// Blocks, where it says how many.
    blocks: Option<u32>,
    is_deep: bool,
}

impl ExrHead {
    /// The picture that is shown of the bytes of a file.
    pub(super) fn of(file: &[u8]) -> Result<Self, ExrRefusal> {
        let broken = |what: &str| ExrRefusal::Broken(what.to_owned());
        let mut bytes = Bytes { all: file, at: 0 };
        let in_head = || broken("it ends within its header, or that is damaged");
        if bytes.take(4) != Some(&MAGIC) {
            return Err(broken("it is no OpenEXR"));
        }
        let flags = bytes.word().ok_or_else(in_head)?;
        let has_parts = flags & PARTS != 0;
        let mut parts = Vec::new();
        while let Some(part) = Part::read(&mut bytes).ok_or_else(in_head)? {
            parts.push(part);
            if !has_parts || parts.len() > MOST_PARTS {
                break;
            }
        }
        for part in &mut parts {
            part.is_deep |= flags & DEEP != 0 && !has_parts;
            part.tile = part.tile.filter(|_| has_parts || flags & TILED != 0);
        }
        let (number, layer, colours) = chosen(&parts)?;
        let part = &parts[number];
        let odd = part.channels.iter().find(|it| it.every != [1, 1]);
        if let Some(channel) = odd {
            return Err(ExrRefusal::Kind(format!(
                "OpenEXR with a channel {:?} of fewer samples than pixels (luminance and chroma)",
                channel.name
            )));
        }
        let mut table = bytes.at;
        for before in &parts[..number] {
            let count = before.blocks_told().ok_or_else(in_head)?;
            table = table.saturating_add(count.saturating_mul(8));
        }
        let head = if has_parts { 4 } else { 0 };
        if let Some(why) = part.missing(file, table, head).ok_or_else(in_head)? {
            return Err(ExrRefusal::Broken(why));
        }
        let is_own = |it: &&Channel| it.leaf_in(&layer).is_some_and(|leaf| leaf.len() == 1);
        let own = part.channels.iter().filter(is_own);
        let last = own.map(|it| it.last);
        let small = last.filter(|at| file[*at].is_ascii_lowercase()).collect();
        Ok(Self {
            part: number,
            note: told(&parts, number, &layer),
            layer,
            colours,
            small,
        })
    }

    /// Reads any bytes as OpenEXR; `true` if a picture of them could be shown: for fuzzing and
    /// tests.
    #[must_use]
    pub fn read_any(bytes: &[u8]) -> bool {
        Self::of(bytes).is_ok()
    }
}

impl Channel {
    /// Its name without a layer; none where it belongs to another.
    fn leaf_in(&self, layer: &str) -> Option<&str> {
        let (own, leaf) = split(&self.name);
        (own == layer).then_some(leaf)
    }
}

/// The layer of a channel, and its name in that.
fn split(name: &str) -> (&str, &str) {
    name.rsplit_once('.').unwrap_or(("", name))
}

impl Part {
    /// The next part; `Some(None)` behind the last.
    fn read(bytes: &mut Bytes<'_>) -> Option<Option<Self>> {
        let mut part = Self::default();
        for number in 0..MOST_ATTRIBUTES {
            let (_, name) = bytes.name()?;
            if name.is_empty() {
                return Some((number > 0).then_some(part));
            }
            bytes.name()?;
            let length = bytes.word()? as usize;
            let inside = bytes.at;
            let value = bytes.take(length)?;
            let mut value = Bytes {
                all: &bytes.all[..inside + value.len()],
                at: inside,
            };
            match name {
                b"channels" => part.channels = channels(&mut value)?,
                b"compression" => part.compression = *value.take(1)?.first()?,
                b"dataWindow" => {
                    let mut window = [0; 4];
                    for side in &mut window {
                        *side = value.signed()?;
                    }
                    part.window = Some(window);
                }
                b"tiles" => part.tile = Some([value.word()?, value.word()?]),
                b"chunkCount" => part.blocks = Some(value.word()?),
                b"type" => part.is_deep = value.take(length)?.starts_with(b"deep"),
                _ => {}
            }
        }
        None
    }

    /// Columns and rows; none where these cannot be.
    fn size(&self) -> Option<[u32; 2]> {
        let [left, top, right, bottom] = self.window?.map(i64::from);
        let size = [right - left + 1, bottom - top + 1];
        let is_size = |it: &i64| (1..=MOST_SIDE).contains(it);
        size.iter().all(is_size).then(|| size.map(|it| it as u32))
    }

    /// Columns and rows of a block, and blocks across and down at full size.
    fn blocks(&self) -> Option<([u32; 2], [u32; 2])> {
        let size = self.size()?;
        let rows = ROWS.get(usize::from(self.compression)).copied();
        let block = self.tile.unwrap_or([size[0], rows?]);
        let is_block = block.iter().all(|it| *it > 0);
        is_block.then(|| (block, [0, 1].map(|k| size[k].div_ceil(block[k]))))
    }

    /// Entries of its table of places.
    fn blocks_told(&self) -> Option<usize> {
        match self.blocks {
            Some(told) => usize::try_from(told).ok(),
            None if self.tile.is_some() => None,
            None => {
                let (_, [across, down]) = self.blocks()?;
                usize::try_from(across).ok()?.checked_mul(down as usize)
            }
        }
    }

    /// Which rows lack data in a file whose table of places of this part begins there, and whose
    /// blocks have so many bytes before their heads; `Some(None)` where all are there.
    fn missing(&self, file: &[u8], table: usize, head: usize) -> Option<Option<String>> {
        let (block, [across, down]) = self.blocks()?;
        let rows = self.size()?[1];
        let count = (across as usize).checked_mul(down as usize)?;
        let end = count.checked_mul(8).and_then(|it| table.checked_add(it))?;
        let Some(places) = file.get(table..end) else {
            return Some(Some(format!(
                "all of its {} are missing",
                counted(rows, "row")
            )));
        };
        let mut is_there = vec![false; count];
        let mut places = places
            .as_chunks::<8>()
            .0
            .iter()
            .map(|it| u64::from_le_bytes(*it));
        // Where writing was broken off, the table is empty, and blocks follow each other.
        let is_empty = self.tile.is_none() && places.clone().next() == Some(0);
        let mut next = end;
        for _ in 0..count {
            let at = match places.next() {
                _ if is_empty => Some(next),
                place => usize::try_from(place?).ok(),
            };
            let found = at.and_then(|at| self.block_at(file, at.checked_add(head)?));
            match found {
                Some((number, behind)) => {
                    next = behind;
                    if let Some(it) = is_there.get_mut(number) {
                        *it = true;
                    }
                }
                None if is_empty => break,
                None => {}
            }
        }
        let all = is_there.chunks_exact(across as usize);
        let lost: Vec<bool> = all.map(|it| it.contains(&false)).collect();
        let mut lost = (0..rows).filter(|row| lost[(row / block[1]) as usize]);
        let Some(first) = lost.next() else {
            return Some(None);
        };
        let last = lost.clone().next_back().unwrap_or(first);
        Some(Some(which(first..last + 1, 1 + lost.count() as u32, rows)))
    }

    /// The number of the block whose head is there, and where it ends; none where it is not whole.
    fn block_at(&self, file: &[u8], at: usize) -> Option<(usize, usize)> {
        let (block, [across, down]) = self.blocks()?;
        let mut bytes = Bytes { all: file, at };
        let number = if self.tile.is_some() {
            let [column, row, level, other] =
                [bytes.word()?, bytes.word()?, bytes.word()?, bytes.word()?];
            if column >= across || row >= down || level != 0 || other != 0 {
                return None;
            }
            row as usize * across as usize + column as usize
        } else {
            let row = i64::from(bytes.signed()?) - i64::from(self.window?[1]);
            (u32::try_from(row).ok()? / block[1]) as usize
        };
        let length = usize::try_from(bytes.signed()?).ok().filter(|it| *it > 0)?;
        bytes.take(length)?;
        Some((number, bytes.at))
    }
}

fn channels(list: &mut Bytes<'_>) -> Option<Vec<Channel>> {
    let mut all = Vec::new();
    for _ in 0..MOST_CHANNELS {
        let (at, name) = list.name()?;
        if name.is_empty() {
            return Some(all);
        }
        // Kind and flags.
        list.take(8)?;
        all.push(Channel {
            name: String::from_utf8_lossy(name).into_owned(),
            last: at + name.len() - 1,
            every: [list.word()?, list.word()?],
        });
    }
    None
}

/// Which of so many rows are missing, in words.
pub(in crate::read::still) fn which(between: Range<u32>, missing: u32, rows: u32) -> String {
    let (first, last) = (between.start, between.end.saturating_sub(1));
    let verb = if missing == 1 { "is" } else { "are" };
    let all = counted(rows, "row");
    match between.end.saturating_sub(between.start) == missing {
        true if missing == 1 => format!("row {first} of its {all} is missing, or damaged"),
        true => format!("rows {first} to {last} of its {all} are missing, or damaged"),
        false => format!(
            "{missing} of its {all} {verb} missing, or damaged, the first row {first}, the last \
             {last}"
        ),
    }
}

/// The layers of a part, and how their colours are stored; those without colours are left out.
fn layers(part: &Part) -> Vec<(&str, Colours)> {
    let mut names: Vec<&str> = part.channels.iter().map(|it| split(&it.name).0).collect();
    names.sort_unstable();
    names.dedup();
    let kind = |layer: &str| {
        let has = |name: &str| {
            let leaves = part.channels.iter().filter_map(|it| it.leaf_in(layer));
            leaves.into_iter().any(|it| it.eq_ignore_ascii_case(name))
        };
        let all = |names: &[&str]| names.iter().all(|it| has(it));
        match (all(&["R", "G", "B"]), all(&["Y", "RY", "BY"]), has("Y")) {
            (true, ..) => Some(Colours::Plain),
            (_, true, _) => Some(Colours::Chroma),
            (_, _, true) if !has("X") => Some(Colours::Plain),
            _ => None,
        }
    };
    names
        .into_iter()
        .filter_map(|name| kind(name).map(|kind| (name, kind)))
        .collect()
}

/// The part and the layer that are shown: the first part with colours, and of that the channels
/// without a layer, or else the layer that is called as if it had the whole picture.
fn chosen(parts: &[Part]) -> Result<(usize, String, Colours), ExrRefusal> {
    let rank = |layer: &str| {
        let last = split(layer).1.to_ascii_lowercase();
        let known = WHOLE.iter().position(|it| *it == last);
        match layer {
            "" => 0,
            _ => 1 + known.unwrap_or(WHOLE.len()),
        }
    };
    for (number, part) in parts.iter().enumerate().filter(|(_, it)| !it.is_deep) {
        let found = layers(part)
            .into_iter()
            .min_by_key(|(layer, _)| rank(layer));
        if let Some((layer, colours)) = found {
            return Ok((number, layer.to_owned(), colours));
        }
    }
    let has_deep = parts.iter().any(|it| it.is_deep);
    let names = parts.iter().flat_map(|it| &it.channels).map(|it| &*it.name);
    let names: Vec<&str> = names.take(2 * MOST_NAMED).collect();
    Err(ExrRefusal::Kind(match has_deep {
        true => "OpenEXR of samples in several depths".to_owned(),
        false => format!(
            "OpenEXR without a picture in colour or grey (its channels are {})",
            names.join(", ")
        ),
    }))
}

/// What is said of the choice of a layer.
fn told(parts: &[Part], number: usize, layer: &str) -> Option<String> {
    let all = parts.iter().flat_map(layers).map(|it| it.0);
    let others: Vec<&str> = all.filter(|it| !it.is_empty() && *it != layer).collect();
    if layer.is_empty() && others.is_empty() && number == 0 {
        return None;
    }
    let shown = match layer {
        "" => format!("part {number} of it is shown"),
        layer => format!("its layer {layer:?} is shown"),
    };
    let named: Vec<String> = others
        .iter()
        .take(MOST_NAMED)
        .map(|it| format!("{it:?}"))
        .collect();
    Some(match others.len() {
        0 => shown,
        more => format!(
            "{shown}, without {} ({}{})",
            counted(more as u64, "other layer"),
            named.join(", "),
            if more > named.len() { ", .." } else { "" }
        ),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A file of 4 x 6 samples a channel, uncompressed.
    fn exr(channels: &[&str], every: u32) -> Vec<u8> {
        let attribute = |name: &str, inside: &[u8]| {
            let length = (inside.len() as u32).to_le_bytes();
            [name.as_bytes(), b"\0any\0", &length, inside].concat()
        };
        let mut list = Vec::new();
        for name in channels {
            list.extend([name.as_bytes(), &[0, 2, 0, 0, 0, 0, 0, 0, 0]].concat());
            list.extend([every.to_le_bytes(), every.to_le_bytes()].concat());
        }
        list.push(0);
        let window: Vec<u8> = [0_i32, -2, 3, 3]
            .iter()
            .flat_map(|it| it.to_le_bytes())
            .collect();
        let mut bytes = [&MAGIC[..], &[2, 0, 0, 0]].concat();
        bytes.extend(attribute("channels", &list));
        bytes.extend(attribute("compression", &[0]));
        bytes.extend(attribute("dataWindow", &window));
        bytes.push(0);
        let row = 16 * channels.len();
        let first = bytes.len() + 6 * 8;
        for k in 0..6 {
            bytes.extend(((first + k * (8 + row)) as u64).to_le_bytes());
        }
        for y in -2..4_i32 {
            bytes.extend(y.to_le_bytes());
            bytes.extend((row as u32).to_le_bytes());
            bytes.extend(vec![1; row]);
        }
        bytes
    }

    fn of(channels: &[&str]) -> ExrHead {
        ExrHead::of(&exr(channels, 1)).unwrap()
    }

    #[test]
    fn the_layer_with_the_whole_picture_is_shown_and_named() {
        assert_eq!(
            (of(&["B", "G", "R"]).layer, of(&["Y"]).note),
            (String::new(), None)
        );
        let blender = of(&[
            "ViewLayer.AO.B",
            "ViewLayer.AO.G",
            "ViewLayer.AO.R",
            "ViewLayer.Combined.B",
            "ViewLayer.Combined.G",
            "ViewLayer.Combined.R",
            "ViewLayer.Depth.Z",
        ]);
        assert_eq!(blender.layer, "ViewLayer.Combined");
        assert!(
            blender
                .note
                .unwrap()
                .contains("1 other layer (\"ViewLayer.AO\")")
        );
        assert_eq!(of(&["BY", "RY", "Y"]).colours, Colours::Chroma);
        assert_eq!(of(&["b", "g", "r"]).small.len(), 3);
        let refused = |channels, every| ExrHead::of(&exr(channels, every)).unwrap_err();
        assert!(
            matches!(refused(&["X", "Y", "Z"], 1), ExrRefusal::Kind(it) if it.contains("X, Y"))
        );
        assert!(matches!(
            refused(&["BY", "RY", "Y"], 2),
            ExrRefusal::Kind(_)
        ));
    }

    #[test]
    fn rows_without_data_are_named() {
        let whole = exr(&["Y"], 1);
        for cut in 1..24 {
            let why = ExrHead::of(&whole[..whole.len() - cut]).unwrap_err();
            assert!(matches!(why, ExrRefusal::Broken(it) if it.contains("row 5 of its 6 rows")));
        }
        let table = whole.len() - 6 * (24 + 8);
        let mut lost = whole.clone();
        lost[table + 16 + 3] = 1;
        let why = ExrHead::of(&lost).unwrap_err();
        assert!(matches!(why, ExrRefusal::Broken(it) if it.contains("row 2 of")));
        // One whose writing was broken off, but for its table.
        let mut unfinished = whole;
        unfinished[table..table + 48].fill(0);
        assert!(ExrHead::read_any(&unfinished));
        unfinished.truncate(unfinished.len() - 40);
        let why = ExrHead::of(&unfinished).unwrap_err();
        assert!(matches!(why, ExrRefusal::Broken(it) if it.contains("rows 4 to 5 of")));
    }

    proptest! {
        #[test]
        fn no_bytes_make_it_panic(
            at in any::<prop::sample::Index>(), byte in any::<u8>(), flags in any::<u8>(),
        ) {
            let mut bytes = exr(&["A.R", "B", "G", "R"], 1);
            bytes[5] = flags;
            let at = at.index(bytes.len());
            bytes[at] = byte;
            let _ = ExrHead::read_any(&bytes);
            let _ = ExrHead::read_any(&bytes[..at]);
        }
    }
}
