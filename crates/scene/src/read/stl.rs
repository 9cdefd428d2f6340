//! How is an STL file read?
//!
//! Binary: 80 bytes of any text, the number of triangles, and 50 bytes for each, of which the last
//! two may be a colour, as VisCAM and Magics write them. Text: `vertex` lines in loops. Corners at
//! one place become one vertex, so that the mesh is connected.

use std::collections::HashMap;

use glam::{DAffine3, DVec3};

use super::colour::linear_from_encoded;
use super::error::Fault;
use super::mends::{self, Mends};
use super::polygon::Polygons;
use super::sound::{count, place_bits};
use super::text::{Words, single_lines, utf8_of};
use crate::source::{Material, Repairs, SourceMesh, SourceObject, SourceScene};

const HEADER_BYTES: usize = 80;
const FIRST_TRIANGLE: usize = HEADER_BYTES + 4;
/// A normal and three corners in f32, and 2 bytes that have no meaning for all.
const TRIANGLE_BYTES: usize = 50;
const NORMAL_BYTES: usize = 12;

/// Reads an STL file into one object called `name`.
pub(super) fn read(bytes: &[u8], name: &str) -> Result<SourceScene, Fault> {
    let mut solid = Solid::default();
    let text = utf8_of(bytes);
    if !is_whole(bytes) && is_text(&text) {
        solid.read_text(&text)?;
    } else {
        solid.read_binary(bytes)?;
    }
    solid.polygons.fill(&mut solid.mesh, &mut solid.mends);
    let mut scene = SourceScene {
        objects: vec![SourceObject {
            name: name.to_owned(),
            mesh: 0,
            placements: vec![DAffine3::IDENTITY],
        }],
        meshes: vec![solid.mesh],
        materials: vec![Material {
            two_sided: true,
            ..Material::default()
        }],
        repairs: solid.repairs,
        ..SourceScene::default()
    };
    let solid_colour = colour_of_solid(bytes).filter(|_| solid.is_binary);
    solid.words.resize(scene.meshes[0].triangles.len(), 0);
    colour(&solid.words, solid_colour, &mut scene);
    solid.mends.tell(name, &mut scene);
    Ok(scene)
}

/// Whether a file is as long as a binary one of its number of triangles: these may begin with
/// `solid` too.
fn is_whole(bytes: &[u8]) -> bool {
    let count = bytes.get(HEADER_BYTES..FIRST_TRIANGLE);
    count.is_some_and(|count| {
        let triangles = word(count) as usize;
        bytes.len() - FIRST_TRIANGLE == triangles.saturating_mul(TRIANGLE_BYTES)
    })
}

/// Whether a file is text, maybe filled up with zeros at its end.
fn is_text(bytes: &[u8]) -> bool {
    let start = bytes.trim_ascii_start();
    let said = start
        .get(..5)
        .is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    said && !text_in(bytes).contains(&0)
}

/// A file without the zeros at its end.
fn text_in(bytes: &[u8]) -> &[u8] {
    let end = bytes.iter().rposition(|byte| *byte != 0);
    &bytes[..end.map_or(0, |end| end + 1)]
}

fn word(bytes: &[u8]) -> u32 {
    let mut word = [0; 4];
    word.copy_from_slice(bytes);
    u32::from_le_bytes(word)
}

#[derive(Default)]
struct Solid {
    mesh: SourceMesh,
    polygons: Polygons,
    vertex_at: HashMap<[u64; 3], u32>,
    repairs: Repairs,
    mends: Mends,
    is_binary: bool,
    /// The last two bytes of each triangle, where these may be a colour.
    words: Vec<u16>,
}

/// The colour of a whole solid that Magics writes into the head: red, green, blue and alpha.
fn colour_of_solid(bytes: &[u8]) -> Option<[u8; 3]> {
    const SIGN: &[u8] = b"COLOR=";
    let head = bytes.get(..HEADER_BYTES)?;
    let at = head.windows(SIGN.len()).position(|it| it == SIGN)? + SIGN.len();
    head.get(at..at + 3)?.try_into().ok()
}

/// Gives triangles the colours that words of theirs say: five bits for each part, and a highest bit
/// that VisCAM sets where the others are a colour, red highest, and Magics where the triangle has
/// the colour of the solid, else red lowest.
fn colour(words: &[u16], of_solid: Option<[u8; 3]>, scene: &mut SourceScene) {
    let is_said = words.iter().any(|it| *it != 0);
    let light = |colour: [u8; 3]| {
        let [red, green, blue] = colour.map(|it| linear_from_encoded(f64::from(it) / 255.0));
        [red, green, blue, 1.0]
    };
    if let Some(colour) = of_solid {
        scene.materials[0].colour = light(colour);
    }
    if !is_said {
        return;
    }
    if of_solid.is_none() && words.iter().all(|it| it & VALID == 0) {
        scene.remark(
            "triangles have two bytes each besides their places, which are no colours: not drawn",
        );
        return;
    }
    let part = |word: u16, place: u16| ((u32::from(word >> place & 31) * 255 + 15) / 31) as u8;
    let mut numbers: HashMap<u16, u32> = HashMap::new();
    let mut materials = Vec::with_capacity(words.len());
    for word in words {
        let has_own = (word & VALID == 0) == of_solid.is_some();
        if !has_own {
            materials.push(0);
            continue;
        }
        let next = scene.materials.len() as u32;
        let number = *numbers.entry(*word).or_insert(next);
        if number == next {
            let [low, middle, high] = [0, 5, 10].map(|place| part(*word, place));
            let colour = match of_solid.is_some() {
                true => [low, middle, high],
                false => [high, middle, low],
            };
            scene.materials.push(Material {
                colour: light(colour),
                two_sided: true,
                ..Material::default()
            });
        }
        materials.push(number);
    }
    scene.meshes[0].materials = materials;
}

/// The highest bit of a colour.
const VALID: u16 = 1 << 15;

impl Solid {
    /// The number of the vertex at a place, which may be NaN.
    fn vertex(&mut self, place: DVec3) -> Result<u32, String> {
        let next = u32::try_from(self.mesh.positions.len())
            .map_err(|_| "there are more vertices than 4294967295".to_owned())?;
        let vertex = *self.vertex_at.entry(place_bits(place)).or_insert(next);
        if vertex == next {
            self.mesh.positions.push(place);
        }
        Ok(vertex)
    }

    fn read_binary(&mut self, bytes: &[u8]) -> Result<(), Fault> {
        self.is_binary = true;
        let Some(claimed) = bytes.get(HEADER_BYTES..FIRST_TRIANGLE) else {
            let what = format!(
                "an STL file has at least 84 bytes, this one {}",
                bytes.len()
            );
            return Err(Fault::at("start of the file", what));
        };
        let claimed = word(claimed) as usize;
        let rows = &bytes[FIRST_TRIANGLE..];
        let there = rows.len() / TRIANGLE_BYTES;
        if let Some(starts) = starts_with_more(rows, claimed) {
            return starts
                .iter()
                .try_for_each(|at| self.add_binary(&rows[*at..], *at));
        }
        let place = |number: usize| move || format!("is triangle {number}");
        let missing = claimed.saturating_sub(there);
        self.mends.add(mends::ROW_MISSING, missing, place(there));
        // Some programs never write the number, or that of one part.
        let is_all = claimed == 0 || rows.len().is_multiple_of(TRIANGLE_BYTES);
        let read = if is_all { there } else { claimed.min(there) };
        let beyond = read.saturating_sub(claimed);
        self.mends.add(mends::ROW_BEYOND, beyond, place(claimed));
        self.mends.add(mends::ROW_LEFT, there - read, place(read));
        let word =
            |row: &[u8]| u16::from_le_bytes([row[TRIANGLE_BYTES - 2], row[TRIANGLE_BYTES - 1]]);
        let all = rows.chunks_exact(TRIANGLE_BYTES).take(read);
        self.words = all.map(word).collect();
        (0..read).try_for_each(|index| {
            let at = index * TRIANGLE_BYTES;
            self.add_binary(&rows[at..], at)
        })
    }

    /// Adds the triangle at the start of `row`, which stands so many bytes behind the first.
    fn add_binary(&mut self, row: &[u8], at: usize) -> Result<(), Fault> {
        let mut corners = [0; 3];
        for (number, corner) in corners.iter_mut().enumerate() {
            let place = DVec3::from_array([0, 1, 2].map(|k| {
                let at = NORMAL_BYTES + 4 * (3 * number + k);
                f64::from(f32::from_bits(word(&row[at..at + 4])))
            }));
            *corner = self
                .vertex(place)
                .map_err(|what| Fault::at(format!("byte {}", FIRST_TRIANGLE + at), what))?;
        }
        self.mesh.triangles.push(corners);
        Ok(())
    }

    /// Reads words in whatever lines they stand; a loop ends where the next begins, too.
    fn read_text(&mut self, bytes: &[u8]) -> Result<(), Fault> {
        let mut corners = Vec::new();
        let (mut last, mut has_end) = (1, false);
        for line in single_lines(text_in(bytes)) {
            last = line.number;
            let mut words = Words::of(&line);
            let mut is_name = false;
            while let Some(keyword) = words.next() {
                let before = |wanted: &str| words.peek().eq_ignore_ascii_case(wanted);
                let (is_facet, is_end) = (before("normal"), before("solid"));
                match keyword.to_ascii_lowercase().as_str() {
                    keyword if is_name && !(keyword == "facet" && is_facet) => {}
                    "vertex" => {
                        let vertex = self.vertex(DVec3::from_array(words.three()));
                        corners.push(vertex.map_err(|what| Fault::line(last, what))?);
                    }
                    "facet" => {
                        is_name = false;
                        self.close_loop(&mut corners, last);
                    }
                    "endfacet" | "endloop" => self.close_loop(&mut corners, last),
                    "solid" => (is_name, has_end) = (true, false),
                    "endsolid" => (is_name, has_end) = (true, true),
                    "end" if is_end => (is_name, has_end) = (true, true),
                    "outer" | "loop" => {}
                    "normal" => {
                        words.next();
                        words.next();
                        words.next();
                    }
                    "color" => break,
                    sign if sign.starts_with(['#', '/', ';']) => break,
                    _ => {
                        let place = || format!("in line {last}");
                        self.mends.add(mends::LINE_BROKEN, 1, place);
                        break;
                    }
                }
            }
            let place = || format!("in line {last}");
            self.mends.add(mends::COMMA, words.commas, place);
            self.mends.add(mends::GLUED, words.glued, place);
            let broken = usize::from(words.is_broken);
            self.mends.add(mends::LINE_BROKEN, broken, place);
        }
        // Of a loop that was cut off the last corner may be cut too.
        let is_cut = !has_end || !corners.is_empty();
        let place = || format!("in line {last}");
        self.mends
            .add(mends::ROW_MISSING, usize::from(is_cut), place);
        Ok(())
    }

    /// Makes triangles of the corners of a loop, and empties it.
    fn close_loop(&mut self, corners: &mut Vec<u32>, line: usize) {
        match corners.len() {
            0 => {}
            1 | 2 => {
                count(&mut self.repairs, mends::SHORT_FACE.name, 1);
                let place = || format!("in line {line}");
                self.mends.add(mends::LINE_BROKEN, 1, place);
            }
            _ => self.polygons.add(&mut self.mesh.triangles, corners),
        }
        corners.clear();
    }
}

/// Where triangles begin behind which the bytes stand that their last two count: only if the rows
/// of so many triangles end just there.
fn starts_with_more(rows: &[u8], claimed: usize) -> Option<Vec<usize>> {
    let least = claimed.checked_mul(TRIANGLE_BYTES)?;
    if claimed == 0 || rows.len() <= least {
        return None;
    }
    let mut at = 0;
    let mut starts = Vec::with_capacity(claimed);
    for _ in 0..claimed {
        let more = rows.get(at + TRIANGLE_BYTES - 2..at + TRIANGLE_BYTES)?;
        starts.push(at);
        at += TRIANGLE_BYTES + usize::from(u16::from_le_bytes([more[0], more[1]]));
    }
    (at == rows.len()).then_some(starts)
}

#[cfg(test)]
mod tests {
    use super::super::{SceneFormat, read_anything};
    use super::*;

    const TEXT: &str = "solid two\n\
        facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nendloop\n\
        endfacet\n\
        facet normal 0 0 1\nouter loop\nVERTEX 0 0 0\n\tvertex 1 1 0\nvertex -0 1 0\nendloop\n\
        endfacet\nendsolid two\n";

    fn binary(triangles: &[[[f32; 3]; 3]]) -> Vec<u8> {
        let mut bytes = vec![b' '; HEADER_BYTES];
        bytes[..5].copy_from_slice(b"solid");
        bytes.extend((triangles.len() as u32).to_le_bytes());
        for triangle in triangles {
            bytes.extend([0; NORMAL_BYTES]);
            let numbers = triangle.iter().flatten();
            bytes.extend(numbers.flat_map(|number| number.to_le_bytes()));
            bytes.extend([0; 2]);
        }
        bytes
    }

    fn square() -> Vec<u8> {
        let [a, b, c, d] = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        binary(&[[a, b, c], [a, c, d]])
    }

    fn refusal(bytes: &[u8]) -> String {
        let fault = read(bytes, "a").unwrap_err();
        fault.in_file("a.stl".as_ref()).to_string()
    }

    #[test]
    fn text_and_binary_give_the_same_connected_mesh() {
        let of_text = read(TEXT.as_bytes(), "a").unwrap();
        let of_binary = read(&square(), "a").unwrap();
        for scene in [&of_text, &of_binary] {
            assert_eq!(scene.meshes[0].positions.len(), 4);
            assert_eq!(scene.meshes[0].triangles, [[0, 1, 2], [0, 2, 3]]);
            assert!(scene.materials[0].two_sided);
        }
        assert_eq!(of_text.meshes[0].positions, of_binary.meshes[0].positions);
    }

    #[test]
    fn a_cut_file_shows_its_whole_triangles_and_says_that_others_are_missing() {
        let square = square();
        let cut = read(&square[..square.len() - 1], "a").unwrap();
        assert_eq!(cut.meshes[0].triangles, [[0, 1, 2]]);
        assert_eq!(cut.repairs["rows_missing"], 1);
        assert!(
            cut.remarks[0].contains("is triangle 1"),
            "{:?}",
            cut.remarks
        );
        for end in [60, 90, 104] {
            let cut = read(&TEXT.as_bytes()[..TEXT.len() - end], "a").unwrap();
            assert_eq!(cut.meshes[0].triangles, [[0, 1, 2]], "{end}");
            assert_eq!(cut.repairs["rows_missing"], 1, "{end}");
        }
        assert!(refusal(b"").contains("at least 84 bytes"));
    }

    #[test]
    fn a_wrong_number_of_triangles_costs_none() {
        for claimed in [0_u32, 1, 3, u32::MAX] {
            let mut bytes = square();
            bytes[80..84].copy_from_slice(&claimed.to_le_bytes());
            let scene = read(&bytes, "a").unwrap();
            assert_eq!(scene.meshes[0].triangles.len(), 2, "{claimed}");
            assert_eq!(scene.remarks.len(), 1, "{claimed}");
        }
    }

    #[test]
    fn bytes_behind_triangles_that_these_count_are_passed_over() {
        let mut bytes = square();
        bytes.splice(134..134, *b"six456");
        bytes[132..134].copy_from_slice(&6_u16.to_le_bytes());
        let scene = read(&bytes, "a").unwrap();
        assert_eq!(scene.meshes[0].triangles, [[0, 1, 2], [0, 2, 3]]);
        assert!(scene.remarks.is_empty());
    }

    #[test]
    fn corners_that_are_no_place_are_kept_for_the_triangles_to_be_left_out() {
        assert!(!read_anything(
            SceneFormat::Stl,
            &binary(&[[[f32::NAN; 3]; 3]])
        ));
        let text = TEXT.replacen("vertex 1 0 0", "vertex 1 0 inf", 1);
        let scene = read(text.as_bytes(), "a").unwrap();
        assert_eq!(scene.meshes[0].triangles.len(), 2);
        assert!(read_anything(SceneFormat::Stl, text.as_bytes()));
    }

    #[test]
    fn text_is_read_in_one_line_and_with_words_of_other_programs() {
        let one = TEXT.replace('\n', " ");
        let odd = TEXT.replace("endfacet", "color 1 0 0\n; made\nendfacet");
        let odd = odd.replace("endsolid", "end solid");
        for text in [one, odd] {
            let scene = read(text.as_bytes(), "a").unwrap();
            assert_eq!(scene.meshes[0].triangles, [[0, 1, 2], [0, 2, 3]], "{text}");
            assert!(scene.remarks.is_empty(), "{:?}", scene.remarks);
        }
    }

    #[test]
    fn no_cut_and_no_flip_of_a_byte_panics() {
        for file in [square(), TEXT.as_bytes().to_vec()] {
            super::super::mangle::cut_and_flip(SceneFormat::Stl, &file);
        }
        assert!(read_anything(SceneFormat::Stl, &square()));
    }
}
