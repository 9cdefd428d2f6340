//! How is an STL file read?
//!
//! Binary: 80 bytes of any text, the number of triangles, and 50 bytes for each. Text: `vertex`
//! lines in loops. Corners at one place become one vertex, so that the mesh is connected.

use std::collections::HashMap;

use glam::{DAffine3, DVec3};

use super::error::Fault;
use super::sound::{count, place_bits};
use super::text::{Words, lines, shortened};
use crate::source::{Material, Repairs, SourceMesh, SourceObject, SourceScene};

const HEADER_BYTES: usize = 80;
const FIRST_TRIANGLE: usize = HEADER_BYTES + 4;
/// A normal and three corners in f32, and 2 bytes that have no meaning for all.
const TRIANGLE_BYTES: usize = 50;
const NORMAL_BYTES: usize = 12;

/// Reads an STL file into one object called `name`.
pub(super) fn read(bytes: &[u8], name: &str) -> Result<SourceScene, Fault> {
    let mut solid = Solid::default();
    if is_text(bytes) {
        solid.read_text(bytes)?;
    } else {
        solid.read_binary(bytes)?;
    }
    Ok(SourceScene {
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
    })
}

/// Binary files may begin with `solid` too, but their length fits their count.
fn is_text(bytes: &[u8]) -> bool {
    let fits = bytes
        .get(HEADER_BYTES..FIRST_TRIANGLE)
        .is_some_and(|count| {
            let triangles = word(count) as usize;
            bytes.len() - FIRST_TRIANGLE == triangles.saturating_mul(TRIANGLE_BYTES)
        });
    let start = bytes.trim_ascii_start();
    let said = start
        .get(..5)
        .is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    !fits && said && !bytes.contains(&0)
}

fn word(bytes: &[u8]) -> u32 {
    let mut word = [0; 4];
    word.copy_from_slice(bytes);
    u32::from_le_bytes(word)
}

#[derive(Default)]
struct Solid {
    mesh: SourceMesh,
    vertex_at: HashMap<[u64; 3], u32>,
    repairs: Repairs,
}

impl Solid {
    /// The number of the vertex at a place.
    fn vertex(&mut self, place: DVec3) -> Result<u32, String> {
        if !place.is_finite() {
            return Err(format!("a corner is at {place}, which is no place"));
        }
        let next = u32::try_from(self.mesh.positions.len())
            .map_err(|_| "there are more vertices than 4294967295".to_owned())?;
        let vertex = *self.vertex_at.entry(place_bits(place)).or_insert(next);
        if vertex == next {
            self.mesh.positions.push(place);
        }
        Ok(vertex)
    }

    fn read_binary(&mut self, bytes: &[u8]) -> Result<(), Fault> {
        let Some(claimed) = bytes.get(HEADER_BYTES..FIRST_TRIANGLE) else {
            let what = format!(
                "an STL file has at least 84 bytes, this one {}",
                bytes.len()
            );
            return Err(Fault::at("start of the file", what));
        };
        let claimed = word(claimed) as usize;
        let there = (bytes.len() - FIRST_TRIANGLE) / TRIANGLE_BYTES;
        if claimed > there {
            let what = format!("{claimed} triangles are said to follow, {there} do");
            return Err(Fault::at("byte 80", what));
        }
        let triangles = bytes[FIRST_TRIANGLE..].chunks_exact(TRIANGLE_BYTES);
        for (index, triangle) in triangles.take(claimed).enumerate() {
            let numbers = triangle[NORMAL_BYTES..].chunks_exact(4);
            let numbers: Vec<f64> = numbers
                .map(|number| f64::from(f32::from_bits(word(number))))
                .collect();
            let mut corners = [0; 3];
            for (corner, place) in corners.iter_mut().zip(numbers.chunks_exact(3)) {
                *corner = self.vertex(DVec3::from_slice(place)).map_err(|what| {
                    let at = FIRST_TRIANGLE + index * TRIANGLE_BYTES;
                    Fault::at(format!("triangle {index}, byte {at}"), what)
                })?;
            }
            self.mesh.triangles.push(corners);
        }
        Ok(())
    }

    fn read_text(&mut self, bytes: &[u8]) -> Result<(), Fault> {
        let mut corners = Vec::new();
        let mut open = false;
        let mut last = 1;
        for line in lines(bytes) {
            last = line.number;
            let mut words = Words::of(&line);
            let Some(keyword) = words.next() else {
                continue;
            };
            match keyword.to_ascii_lowercase().as_str() {
                "solid" => open = true,
                "facet" | "outer" | "endfacet" => {}
                "vertex" => {
                    let place = DVec3::from_array(words.three("a coordinate")?);
                    let vertex = self.vertex(place);
                    corners.push(vertex.map_err(|what| Fault::line(last, what))?);
                }
                "endloop" => self.close_loop(&mut corners),
                "endsolid" => open = false,
                _ => {
                    let what = format!("{:?} is no word of STL", shortened(keyword));
                    return Err(Fault::line(last, what));
                }
            }
        }
        if open || !corners.is_empty() {
            return Err(Fault::line(last, "the file ends without `endsolid`"));
        }
        Ok(())
    }

    /// Makes triangles of the corners of a loop, and empties it.
    fn close_loop(&mut self, corners: &mut Vec<u32>) {
        if let [first, rest @ ..] = corners.as_slice() {
            let fan = rest.windows(2).map(|edge| [*first, edge[0], edge[1]]);
            self.mesh.triangles.extend(fan);
        }
        let few = usize::from(corners.len() < 3);
        count(&mut self.repairs, "faces_under_three_corners", few);
        corners.clear();
    }
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
    fn a_cut_file_is_refused_with_the_place() {
        let square = square();
        let cut = refusal(&square[..square.len() - 1]);
        assert!(
            cut.contains("byte 80: 2 triangles are said to follow, 1 do"),
            "{cut}"
        );
        let cut = refusal(&TEXT.as_bytes()[..TEXT.len() - 20]);
        assert!(cut.contains("line "), "{cut}");
        assert!(refusal(b"").contains("at least 84 bytes"));
    }

    #[test]
    fn corners_that_are_no_place_are_refused() {
        let bytes = binary(&[[[f32::NAN; 3]; 3]]);
        assert!(refusal(&bytes).contains("triangle 0, byte 84"));
        let text = TEXT.replacen("vertex 1 0 0", "vertex 1 0 inf", 1);
        assert!(refusal(text.as_bytes()).contains("line 5: a coordinate is inf"));
    }

    #[test]
    fn no_cut_and_no_flip_of_a_byte_panics() {
        for file in [square(), TEXT.as_bytes().to_vec()] {
            super::super::mangle::cut_and_flip(SceneFormat::Stl, &file);
        }
        assert!(read_anything(SceneFormat::Stl, &square()));
    }
}
