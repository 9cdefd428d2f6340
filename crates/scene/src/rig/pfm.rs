//! What does a portable float map say of each pixel?

use foveal_core::units::counted;
use foveal_core::view::panel::residual_grid::ResidualGrid;

/// Reads the bytes of a file next to the rig file, or says why not.
pub(super) type ReadBeside<'a> = &'a dyn Fn(&str) -> Result<Vec<u8>, String>;

/// Steps by which the third float keeps what the first two lose by rounding: 2^-34 each, from -512
/// on, 11 bits of the second and above these 11 of the first, all times 2^-70. So it is as good as
/// 0 to programs that do not know.
const LOST_STEP: f64 = 1.0 / (1_u64 << 34) as f64;
const LOST_SCALE: f64 = (1_u128 << 70) as f64;
const LOST_MIDDLE: f64 = 512.0;
const LOST_BITS: u32 = 11;

/// Fewest nodes of a map across and down.
const LEAST_NODES: u32 = 2;
/// Points nearer than this to the origin do not count, in units of the map: nDisplay's.
pub(super) const NO_POINT: f64 = 1e-5;

/// Largest number that is a share of a panel's width or height; larger ones are pixels.
const MOST_SHARE: f64 = 2.0;

/// A map of three floats a pixel, or a node between which pixels lie.
pub(super) struct FloatMap<'a> {
    /// Columns and lines of nodes.
    nodes: [usize; 2],
    /// Columns and lines of pixels.
    pixels: [usize; 2],
    is_little: bool,
    floats: &'a [u8],
    /// The factor for shares.
    scale: [f64; 2],
    /// Whether (0, 0, 0) means unlit, as no two pixels show one place.
    is_zero_none: bool,
    /// What was mended, in words.
    notes: Vec<String>,
}

impl<'a> FloatMap<'a> {
    /// The map of a panel of `size`, a node for each pixel; whether it is one, and sound.
    pub(super) fn of(bytes: &'a [u8], size: [u32; 2]) -> Result<Self, String> {
        let map = Self::fitted(bytes, size)?;
        match map.nodes == map.pixels {
            true if !map.notes.is_empty() => Err(map.notes.join("; ")),
            true => Ok(map),
            false => {
                let ([w, h], [columns, lines]) = (map.pixels, map.nodes);
                Err(format!(
                    "is {columns} x {lines} pixels, and the panel {w} x {h}"
                ))
            }
        }
    }

    /// The map of a panel of `size`, of as many nodes as it has, evenly over the panel, each in the
    /// middle of its share of it; between nodes its floats change evenly.
    pub(super) fn fitted(bytes: &'a [u8], size: [u32; 2]) -> Result<Self, String> {
        let (words, floats) = header(bytes)?;
        let [kind, width, height, scale] = words;
        if kind != "PF" {
            return Err("is not a map of three floats: it does not begin with PF".to_owned());
        }
        let whole = |word: &str| word.parse::<u32>().ok();
        let (Some(columns), Some(lines)) = (whole(width), whole(height)) else {
            return Err(format!("is {width} x {height} pixels"));
        };
        let nodes = [columns, lines];
        if nodes != size && nodes.iter().any(|side| *side < LEAST_NODES) {
            return Err(format!("is {columns} x {lines} pixels, fewer than 2 x 2"));
        }
        let scale: f64 = scale
            .parse()
            .ok()
            .filter(|it| *it != 0.0)
            .ok_or("has no scale")?;
        let [w, h] = nodes.map(|side| side as usize);
        let length = w.checked_mul(h).and_then(|nodes| nodes.checked_mul(12));
        let there = length.and_then(|length| floats.get(..length));
        let Some(there) = there else {
            let length = length.map_or("too many".to_owned(), |length| length.to_string());
            return Err(format!("has {} bytes of {length}", floats.len()));
        };
        let mut notes = Vec::new();
        if there.len() < floats.len() {
            let behind = floats.len() - there.len();
            notes.push(format!(
                "{} after its floats are left out",
                counted(behind as u64, "byte")
            ));
        }
        let mut map = Self {
            nodes: [w, h],
            pixels: size.map(|side| side as usize),
            is_little: scale < 0.0,
            floats: there,
            scale: [1.0; 2],
            is_zero_none: false,
            notes,
        };
        let mut zeros = 0;
        for (line, column) in (0..h).flat_map(|line| (0..w).map(move |column| (line, column))) {
            let all = [0, 1, 2].map(|k| map.float(line, column, k));
            zeros += usize::from(all == [0.0; 3]);
            let pair = [all[0], all[1]];
            if pair.iter().any(|it| it.abs() > 1e6) {
                return Err(format!(
                    "has {pair:?} at column {column}, line {line}, expected -1e6 to 1e6"
                ));
            }
        }
        map.is_zero_none = zeros > 1;
        Ok(map)
    }

    /// The same, with first two floats that are shares from 0 to 1 even if the file counts pixels.
    pub(super) fn of_shares(mut self) -> Result<Self, String> {
        let [w, h] = self.nodes;
        let all = (0..h).flat_map(|line| (0..w).map(move |column| (line, column)));
        let pairs = all.map(|(line, column)| self.whole_pair([column, line]));
        let largest = pairs.filter(|it| it.iter().all(|it| it.is_finite()));
        let largest = largest.fold([0.0_f64; 2], |most, own| {
            [0, 1].map(|k| most[k].max(own[k].abs()))
        });
        if largest.iter().all(|it| *it <= MOST_SHARE) {
            return Ok(self);
        }
        let [w, h] = self.pixels;
        let reaches = [0, 1].map(|k| largest[k] / self.pixels[k] as f64);
        if !reaches.iter().all(|it| (0.5..=1.05).contains(it)) {
            let [x, y] = largest;
            return Err(format!(
                "has places up to {x} and {y}, where 1 is the whole width or height, and these \
                 are not pixels of {w} x {h}: write shares from 0 to 1"
            ));
        }
        self.scale = self.pixels.map(|side| 1.0 / side as f64);
        let note = format!("its places are pixels: they are divided by {w} and {h}");
        self.notes.push(note);
        Ok(self)
    }

    /// What was mended, in words.
    pub(super) fn notes(&self) -> &[String] {
        &self.notes
    }

    fn float(&self, line: usize, column: usize, k: usize) -> f32 {
        let bytes = &self.floats[((line * self.nodes[0] + column) * 3 + k) * 4..][..4];
        let four = [bytes[0], bytes[1], bytes[2], bytes[3]];
        match self.is_little {
            true => f32::from_le_bytes(four),
            false => f32::from_be_bytes(four),
        }
    }

    /// Its nodes across and down, where they are not as many as the panel's pixels.
    pub(super) fn other_size(&self) -> Option<[usize; 2]> {
        (self.nodes != self.pixels).then_some(self.nodes)
    }

    /// The three floats of a pixel, a point in space; 0 where a node next to it has none. Lines
    /// as the file has them.
    pub(super) fn triple(&self, line: usize, column: usize) -> [f64; 3] {
        let of = |at: [usize; 2]| {
            let all = [0, 1, 2].map(|k| self.float(at[1], at[0], k));
            if is_unlit(all) {
                [0.0; 3]
            } else {
                all.map(f64::from)
            }
        };
        if self.nodes == self.pixels {
            return of([column, line]);
        }
        let beside = self.beside([column, line]);
        let is_none = |(at, _): &([usize; 2], f64)| of(*at).iter().all(|it| it.abs() < NO_POINT);
        match beside.iter().any(is_none) {
            true => [0.0; 3],
            false => [0, 1, 2].map(|k| beside.iter().map(|(at, share)| share * of(*at)[k]).sum()),
        }
    }

    /// The first two floats of a pixel, and what they lost; lines as the file has them.
    pub(super) fn pair(&self, line: usize, column: usize) -> [f64; 2] {
        if self.nodes == self.pixels {
            return self.whole_pair([column, line]);
        }
        let beside = self.beside([column, line]);
        let beside = beside.map(|(at, share)| self.whole_pair(at).map(|it| it * share));
        [0, 1].map(|k| beside.iter().map(|pair| pair[k]).sum())
    }

    fn whole_pair(&self, [column, line]: [usize; 2]) -> [f64; 2] {
        let all = [0, 1, 2].map(|k| self.float(line, column, k));
        if is_unlit(all) || self.is_zero_none && all == [0.0; 3] {
            return [f64::NAN; 2];
        }
        let lost = lost_of(all[2]);
        [0, 1].map(|k| (f64::from(all[k]) + lost[k]) * self.scale[k])
    }

    /// The four nodes round a pixel, and their shares, which are 1 together: beyond the outermost
    /// nodes the map goes on as straight as between them.
    fn beside(&self, pixel: [usize; 2]) -> [([usize; 2], f64); 4] {
        let along = [0, 1].map(|k| {
            let at = (pixel[k] as f64 + 0.5) * self.nodes[k] as f64 / self.pixels[k] as f64 - 0.5;
            let first = at.floor().clamp(0.0, (self.nodes[k] - 2) as f64);
            (first as usize, at - first)
        });
        let [(column, x), (line, y)] = along;
        [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[right, down]| {
            let share = |step: usize, to: f64| if step == 1 { to } else { 1.0 - to };
            (
                [column + right, line + down],
                share(right, x) * share(down, y),
            )
        })
    }
}

/// Whether the floats of a node mean unlit: the first two are not numbers, or all three are -1.
fn is_unlit(all: [f32; 3]) -> bool {
    all[..2].iter().any(|it| it.is_nan()) || all == [-1.0; 3]
}

fn lost_of(third: f32) -> [f64; 2] {
    let both = f64::from(third) * LOST_SCALE;
    let is_told = both.fract() == 0.0 && (0.0..f64::from(1 << (2 * LOST_BITS))).contains(&both);
    if !is_told || both == 0.0 {
        return [0.0; 2];
    }
    let both = both as u32;
    [both >> LOST_BITS, both & ((1 << LOST_BITS) - 1)]
        .map(|it| (f64::from(it) - LOST_MIDDLE) * LOST_STEP)
}

/// Three floats of two numbers, which are at most 1 where the third is to keep what they lose.
fn floats_of(pair: [f64; 2]) -> [f32; 3] {
    let short = pair.map(|it| it as f32);
    let steps = [0, 1].map(|k| {
        let lost = pair[k] - f64::from(short[k]);
        (lost / LOST_STEP).round() + LOST_MIDDLE
    });
    let most = f64::from((1 << LOST_BITS) - 1);
    let third = match steps.iter().all(|it| (0.0..=most).contains(it)) {
        true => (steps[0] * f64::from(1 << LOST_BITS) + steps[1]) / LOST_SCALE,
        false => 0.0,
    };
    [short[0], short[1], third as f32]
}

/// The file of a map, little-endian; `pair` gives two numbers by line and column.
pub(super) fn written(size: [u32; 2], pair: impl Fn(u32, u32) -> [f64; 2]) -> Vec<u8> {
    let [w, h] = size;
    let mut file = format!("PF\n{w} {h}\n-1.0\n").into_bytes();
    for line in 0..h {
        for column in 0..w {
            file.extend(
                floats_of(pair(line, column))
                    .map(f32::to_le_bytes)
                    .as_flattened(),
            );
        }
    }
    file
}

/// Reads a map for a panel of `size`: the share of the ideal panel to the right and down. The first
/// line of pixels is the lowest.
pub(super) fn read(bytes: &[u8], size: [u32; 2]) -> Result<ResidualGrid, String> {
    let map = FloatMap::of(bytes, size)?;
    let [w, h] = size.map(|side| side as usize);
    if w < 2 || h < 2 {
        return Err("has fewer than 2 columns or rows".to_owned());
    }
    Ok(by_shares(size, |row, column| map.pair(h - 1 - row, column)))
}

/// The residuals of a panel of `size`, by the share of the ideal panel to the right and down of the
/// pixel at a row and column.
pub(super) fn by_shares(size: [u32; 2], share: impl Fn(usize, usize) -> [f64; 2]) -> ResidualGrid {
    let [w, h] = size.map(|side| side as usize);
    let pixels = (0..h).flat_map(|row| (0..w).map(move |column| [column, row]));
    let residuals = pixels.map(|at| {
        let share = share(at[1], at[0]);
        [0, 1].map(|k| (share[k] * f64::from(size[k]) - at[k] as f64 - 0.5) as f32)
    });
    ResidualGrid {
        nodes: [w, h],
        origin: [0.5; 2],
        step: [1.0; 2],
        residuals: residuals.collect(),
    }
}

/// The four words before the floats, and what follows the line's end or single white space after
/// them.
fn header(bytes: &[u8]) -> Result<([&str; 4], &[u8]), String> {
    let cut = || "ends within its header".to_owned();
    let mut rest = bytes;
    let mut words = [""; 4];
    for word in &mut words {
        let start = rest.iter().position(|it| !it.is_ascii_whitespace());
        rest = &rest[start.ok_or_else(cut)?..];
        let end = rest.iter().take(32).position(u8::is_ascii_whitespace);
        let end = end.ok_or_else(cut)?;
        *word = std::str::from_utf8(&rest[..end])
            .map_err(|_| "is not a map of three floats".to_owned())?;
        rest = &rest[end..];
    }
    // A line that Windows ended is ended by two.
    let end = if rest.starts_with(b"\r\n") { 2 } else { 1 };
    Ok((words, &rest[end..]))
}
