//! What does a corner of a face name, before or behind it in the file?

use std::collections::HashMap;

use super::super::mends::{FROM_ZERO, Mends};

/// Stands for a number that is not given.
const NONE: u32 = u32::MAX;
/// Stands for one that nothing can have.
const LOST: u32 = u32::MAX - 1;

/// Stands for missing texture coordinates until all faces are read.
pub(super) const NO_UV: [f32; 2] = [f32::MAX; 2];

/// What a corner of a face names, by numbers of lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Corner {
    pub(super) place: u32,
    pub(super) uv: Option<u32>,
    pub(super) normal: Option<u32>,
}

/// The same as a face says it: place, place on a texture and normal, counted from 0; maybe none,
/// and maybe of what is not there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct FaceCorner([u32; 3]);

impl FaceCorner {
    /// Whether one of its numbers cannot exist.
    pub(super) fn is_lost(self) -> bool {
        self.0.contains(&LOST)
    }

    /// Whether all that it names is among so many.
    pub(super) fn is_there(self, counts: [usize; 3]) -> bool {
        let [place, uv, normal] = self.0;
        let is_in = |number: u32, count: usize| number == NONE || (number as usize) < count;
        place != NONE && is_in(place, counts[0]) && is_in(uv, counts[1]) && is_in(normal, counts[2])
    }

    /// What it names among so many; `None` without a place. Counts places on textures and normals
    /// that are not there.
    pub(super) fn of(self, counts: [usize; 3], lost: &mut [usize; 2]) -> Option<Corner> {
        let named = |k: usize| {
            let number = self.0[k];
            ((number as usize) < counts[k]).then_some(number)
        };
        for k in [1, 2] {
            lost[k - 1] += usize::from(self.0[k] != NONE && named(k).is_none());
        }
        Some(Corner {
            place: named(0)?,
            uv: named(1),
            normal: named(2),
        })
    }
}

/// Most vertices of one place that are looked through one by one.
const MOST_OF_PLACE: usize = 12;

/// The vertices of the mesh, by what corners name.
#[derive(Debug, Default)]
pub(super) struct Vertices {
    /// The newest vertex of each place, or [`NONE`].
    newest: Vec<u32>,
    /// For each vertex the one of its place before it, and its numbers of `vt` and `vn`.
    all: Vec<[u32; 3]>,
    /// Those of places that have many.
    more: HashMap<Corner, u32>,
}

impl Vertices {
    /// The vertex of a corner, and whether it is new.
    pub(super) fn of(&mut self, corner: Corner) -> (u32, bool) {
        let place = corner.place as usize;
        if place >= self.newest.len() {
            self.newest.resize(place + 1, NONE);
        }
        let numbers = [corner.uv, corner.normal].map(|it| it.unwrap_or(NONE));
        let mut at = self.newest[place];
        let mut met = 0;
        while at != NONE && met < MOST_OF_PLACE {
            let [before, uv, normal] = self.all[at as usize];
            if [uv, normal] == numbers {
                return (at, false);
            }
            (at, met) = (before, met + 1);
        }
        let next = self.all.len() as u32;
        if at != NONE {
            let vertex = *self.more.entry(corner).or_insert(next);
            if vertex != next {
                return (vertex, false);
            }
            self.all.push([NONE; 3]);
        } else {
            self.all.push([self.newest[place], numbers[0], numbers[1]]);
            self.newest[place] = next;
        }
        (next, true)
    }

    /// Number of vertices.
    pub(super) fn len(&self) -> usize {
        self.all.len()
    }

    /// The place of each vertex.
    pub(super) fn place_of_each(&self) -> Vec<u32> {
        let mut places = vec![NONE; self.all.len()];
        for (place, newest) in (0..).zip(&self.newest) {
            let mut at = *newest;
            while at != NONE {
                places[at as usize] = place;
                at = self.all[at as usize][0];
            }
        }
        for (corner, vertex) in &self.more {
            places[*vertex as usize] = corner.place;
        }
        places
    }

    /// The places that have a vertex.
    pub(super) fn places(&self) -> impl Iterator<Item = u32> {
        let all = (0..).zip(&self.newest);
        all.filter(|(_, vertex)| **vertex != NONE)
            .map(|(place, _)| place)
    }
}

/// Faces that name what did not stand before them, and what shows how vertices are counted.
#[derive(Debug)]
pub(super) struct Late {
    /// The number of the first vertex.
    first: u32,
    corners: Vec<FaceCorner>,
    /// The corners of each face, its material and its line.
    faces: Vec<(u32, u32, usize)>,
    next: [usize; 2],
    /// Whether a face names vertex 0, or counts back.
    zero: bool,
    back: bool,
    /// The largest number that a face gave a vertex.
    most: u32,
}

impl Default for Late {
    fn default() -> Self {
        Self::of(1)
    }
}

impl Late {
    /// None yet, of a file whose first vertex has this number.
    pub(super) fn of(first: u32) -> Self {
        Self {
            first,
            corners: Vec::new(),
            faces: Vec::new(),
            next: [0; 2],
            zero: false,
            back: false,
            most: 0,
        }
    }

    /// What `place`, `place/texture`, `place//normal` or `place/texture/normal` names, where so
    /// many of each stand before it.
    pub(super) fn corner(&mut self, word: &str, counts: [usize; 3]) -> FaceCorner {
        let mut named = [LOST, NONE, NONE];
        let parts = word.as_bytes().split(|it| *it == b'/');
        for ((k, part), count) in (0..3).zip(parts).zip(counts) {
            if part.is_empty() {
                continue;
            }
            let number = whole(part);
            if k == 0 {
                self.zero |= number == Some(0);
                self.back |= number.is_some_and(|it| it < 0);
                let most = number.and_then(|it| u32::try_from(it).ok());
                self.most = self.most.max(most.unwrap_or(0));
            }
            named[k] = match number {
                // Some programs write 0 for none.
                Some(0) if k > 0 && self.first > 0 => NONE,
                Some(number) if number < 0 => from_zero(number + count as i64),
                Some(number) => from_zero(number - i64::from(self.first)),
                None => LOST,
            };
        }
        FaceCorner(named)
    }

    /// Adds a face.
    pub(super) fn push(&mut self, face: &[FaceCorner], material: u32, line: usize) {
        self.corners.extend(face);
        self.faces.push((face.len() as u32, material, line));
    }

    /// The next face in the order of the file: its corners, its material and its line.
    pub(super) fn pop(&mut self, face: &mut Vec<FaceCorner>) -> Option<(u32, usize)> {
        let [at, begin] = self.next;
        let (corners, material, line) = *self.faces.get(at)?;
        let end = begin + corners as usize;
        face.clear();
        face.extend_from_slice(&self.corners[begin..end]);
        self.next = [at + 1, end];
        Some((material, line))
    }

    /// Whether faces count vertices from 0 though they were read as counting from 1: one names
    /// vertex 0, and none the last.
    pub(super) fn counts_from_zero(&self, vertices: usize) -> bool {
        self.first == 1 && self.zero && !self.back && (self.most as usize) < vertices
    }

    /// Says how vertices were counted.
    pub(super) fn tell(&self, mends: &mut Mends) {
        mends.add(FROM_ZERO, usize::from(self.first == 0), || {
            "vertex is 0".to_owned()
        });
    }
}

fn from_zero(number: i64) -> u32 {
    u32::try_from(number).map_or(LOST, |it| it.min(LOST))
}

/// A whole number, maybe written as `1.0` or `1e+05`.
fn whole(word: &[u8]) -> Option<i64> {
    const MOST: f64 = (1_u64 << 32) as f64;
    // Nearly all are a few digits.
    if word.len() < 10 && word.iter().all(u8::is_ascii_digit) {
        let digits = word.iter().map(|digit| i64::from(digit - b'0'));
        return Some(digits.fold(0, |number, digit| 10 * number + digit));
    }
    let word = core::str::from_utf8(word).ok()?;
    if let Ok(number) = word.parse::<i64>() {
        return Some(number.clamp(-(MOST as i64), MOST as i64));
    }
    let number = word.parse::<f64>().ok()?;
    (number.fract() == 0.0 && number.abs() <= MOST).then_some(number as i64)
}
