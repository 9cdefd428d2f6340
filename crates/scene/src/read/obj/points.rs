//! Which points does an OBJ file show?

use glam::DVec3;

use super::super::mends::{COLOUR_MADE, Mends, POINT_WITHOUT_PLACE};
use super::super::text::Words;
use crate::build::codes_from_linear;

/// What `p` and `l` lines name, by numbers of vertices from 0.
#[derive(Debug, Default)]
pub(super) struct NamedPoints {
    points: Vec<u32>,
    of_lines: Vec<u32>,
    /// Invalid points, and the line of the first.
    lost: usize,
    first_lost: usize,
}

impl NamedPoints {
    /// Reads the words of a `p` line, before which so many vertices stand.
    pub(super) fn read(&mut self, words: &mut Words<'_>, vertices: usize) {
        while let Some(word) = words.next() {
            match vertex(word, vertices) {
                Some(point) => self.points.push(point),
                None => self.lose(words.line),
            }
        }
    }

    /// Reads the words of an `l` line and returns how many lines it draws.
    pub(super) fn read_line(&mut self, words: &mut Words<'_>, vertices: usize) -> usize {
        let mut corners = 0_usize;
        while let Some(word) = words.next() {
            corners += 1;
            self.of_lines.extend(vertex(word, vertices));
        }
        corners.saturating_sub(1)
    }

    fn lose(&mut self, line: usize) {
        if self.lost == 0 {
            self.first_lost = line;
        }
        self.lost += 1;
    }

    /// The points to show, by numbers of vertices: those of `p` lines, or all that no line has in a
    /// file without faces; those that are nowhere are left out.
    pub(super) fn shown(self, places: &[DVec3], has_faces: bool, mends: &mut Mends) -> Vec<u32> {
        let first = self.first_lost;
        mends.add(POINT_WITHOUT_PLACE, self.lost, || {
            format!("in line {first}")
        });
        let mut shown = self.points;
        if shown.is_empty() && !has_faces {
            let mut is_free = vec![true; places.len()];
            for corner in &self.of_lines {
                if let Some(is_free) = is_free.get_mut(*corner as usize) {
                    *is_free = false;
                }
            }
            let all = 0..u32::try_from(places.len()).unwrap_or(u32::MAX);
            shown = all.filter(|it| is_free[*it as usize]).collect();
        }
        let place = |it: &u32| places.get(*it as usize).filter(|it| it.is_finite());
        let before = shown.len();
        let lost = shown.iter().find(|it| place(it).is_none()).copied();
        shown.retain(|it| place(it).is_some());
        mends.add(POINT_WITHOUT_PLACE, before - shown.len(), || {
            format!("is vertex {}", lost.map_or(0, |it| u64::from(it) + 1))
        });
        shown
    }
}

/// The number from 0 of the vertex that a word names, which may stand behind it.
fn vertex(word: &str, vertices: usize) -> Option<u32> {
    let number = word.split('/').next()?.parse::<i64>().ok()?;
    let from_zero = match number {
        ..0 => number.checked_add(vertices as i64)?,
        _ => number - 1,
    };
    u32::try_from(from_zero).ok()
}

/// The colours of points, as a cloud has them: those that are no numbers are white.
pub(super) fn colours(shown: &[u32], colours: &[[f32; 4]], mends: &mut Mends) -> Vec<[u16; 3]> {
    let code = |at: &u32| {
        let mut colour = *colours.get(*at as usize)?;
        if colour.iter().any(|part| part.is_nan()) {
            mends.add(COLOUR_MADE, 1, || {
                format!("of vertex {}", u64::from(*at) + 1)
            });
            colour = [1.0; 4];
        }
        let [red, green, blue, _] = codes_from_linear(colour);
        Some([red, green, blue].map(|it| u16::from(it) * 257))
    };
    shown.iter().filter_map(code).collect()
}
