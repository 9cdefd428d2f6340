//! How is a PLY file read?
//!
//! Source: G. Turk, "The PLY Polygon File Format", 1994, and what Stanford's and scanners' files
//! hold: vertices with colours and normals, faces, and strips of triangles. Vertices without faces
//! are a cloud of points.

mod header;
mod numbers;

use glam::{DAffine3, DVec3};

use super::colour::linear_from_rgba;
use super::error::Fault;
use super::sound::count;
use crate::source::{Material, Repairs, SourceCloud, SourceMesh, SourceObject, SourceScene};
use header::{Element, PlyHeader, Property, Scalar};
use numbers::Numbers;

/// Reads a PLY file into one object called `name`.
pub(super) fn read(bytes: &[u8], name: &str) -> Result<SourceScene, Fault> {
    let header = PlyHeader::parse(bytes)?;
    let mut numbers = Numbers::of(&header, bytes);
    let faces = header.elements.iter().filter(|it| is_face(it));
    let mut reader = Reader {
        is_cloud: faces.map(|it| it.count).sum::<u64>() == 0,
        ..Reader::default()
    };
    for element in &header.elements {
        numbers.check_count(element)?;
        match element.name.as_str() {
            "vertex" => reader.read_vertices(element, &mut numbers)?,
            _ if is_face(element) => reader.read_faces(element, &mut numbers)?,
            _ => skip(element, &mut numbers)?,
        }
    }
    reader.check_corners()?;
    if reader.is_cloud {
        return Ok(SourceScene {
            clouds: vec![reader.cloud(name)],
            ..SourceScene::default()
        });
    }
    if reader.mesh.triangles.is_empty() {
        let points = reader.mesh.positions.len();
        count(&mut reader.repairs, "points_left_out", points);
        reader.mesh = SourceMesh::default();
    }
    let mut scene = SourceScene {
        objects: vec![SourceObject {
            name: name.to_owned(),
            mesh: 0,
            placements: vec![DAffine3::IDENTITY],
        }],
        meshes: vec![reader.mesh],
        materials: vec![Material {
            two_sided: true,
            ..Material::default()
        }],
        repairs: reader.repairs,
        ..SourceScene::default()
    };
    if header.has_textures {
        scene.remark("textures of PLY files are not drawn: export the mesh as glTF");
    }
    Ok(scene)
}

/// Whether rows are faces.
fn is_face(element: &Element) -> bool {
    matches!(element.name.as_str(), "face" | "tristrips")
}

fn skip(element: &Element, numbers: &mut Numbers<'_>) -> Result<(), Fault> {
    for index in 0..element.count {
        for property in &element.properties {
            numbers.skip(property, element, index)?;
        }
    }
    Ok(())
}

#[derive(Default)]
struct Reader {
    /// Whether there are no faces.
    is_cloud: bool,
    mesh: SourceMesh,
    /// Colours of the points of a cloud, as codes of sixteen bits.
    codes: Vec<[u16; 3]>,
    repairs: Repairs,
}

/// What a property of a vertex is for: the place in a row of numbers.
fn slot(name: &str) -> Option<usize> {
    let slot = match name {
        "x" => 0,
        "y" => 1,
        "z" => 2,
        "nx" => 3,
        "ny" => 4,
        "nz" => 5,
        "red" | "r" | "diffuse_red" => 6,
        "green" | "g" | "diffuse_green" => 7,
        "blue" | "b" | "diffuse_blue" => 8,
        "alpha" | "a" | "diffuse_alpha" => 9,
        _ => return None,
    };
    Some(slot)
}

const SLOTS: usize = 10;
const ALPHA: usize = 9;

impl Reader {
    fn read_vertices(&mut self, element: &Element, numbers: &mut Numbers<'_>) -> Result<(), Fault> {
        if !self.mesh.positions.is_empty() {
            return Err(Fault::at("header", "there are two elements called vertex"));
        }
        let slots = slots_of(element)?;
        let has = |wanted: core::ops::Range<usize>| {
            wanted.into_iter().all(|slot| slots.contains(&Some(slot)))
        };
        let (has_normals, has_colours) = (has(3..6), has(6..9));
        let mut row = [0.0; SLOTS];
        row[ALPHA] = 1.0;
        for index in 0..element.count {
            for (property, slot) in element.properties.iter().zip(&slots) {
                match (slot, property) {
                    (Some(slot), Property::One { scalar, .. }) => {
                        let value = numbers.number(*scalar, element, index)?;
                        let most = if *slot >= 6 { scalar.full() } else { 1.0 };
                        row[*slot] = value / most;
                    }
                    _ => numbers.skip(property, element, index)?,
                }
            }
            let [x, y, z, nx, ny, nz, red, green, blue, alpha] = row;
            let position = DVec3::new(x, y, z);
            if !position.is_finite() {
                return Err(numbers.fault(element, index, format!("stands at {position}")));
            }
            self.mesh.positions.push(position);
            if has_normals && !self.is_cloud {
                self.mesh.normals.push([nx as f32, ny as f32, nz as f32]);
            }
            if has_colours {
                if ![red, green, blue, alpha]
                    .iter()
                    .all(|part| part.is_finite())
                {
                    return Err(numbers.fault(element, index, "has a colour that is no number"));
                }
                if self.is_cloud {
                    // A code of eight bits becomes 257 times as much.
                    let code = |it: f64| (it.clamp(0.0, 1.0) * 65_535.0).round() as u16;
                    self.codes.push([red, green, blue].map(code));
                } else {
                    let colour = linear_from_rgba([red, green, blue, alpha]);
                    self.mesh.colours.push(colour);
                }
            }
        }
        Ok(())
    }

    fn cloud(self, name: &str) -> SourceCloud {
        SourceCloud {
            colours: self.codes,
            ..SourceCloud::on_grid(name, &self.mesh.positions)
        }
    }

    fn read_faces(&mut self, element: &Element, numbers: &mut Numbers<'_>) -> Result<(), Fault> {
        let is_strip = element.name == "tristrips";
        let mut corners = Vec::new();
        for index in 0..element.count {
            for property in &element.properties {
                match property {
                    Property::List {
                        name,
                        length,
                        scalar,
                    } if name == "vertex_indices" || name == "vertex_index" => {
                        let length = numbers.length(*length, *scalar, element, index)?;
                        corners.clear();
                        for _ in 0..length {
                            corners.push(numbers.number(*scalar, element, index)?);
                        }
                        if is_strip {
                            self.add_strips(&corners, |what| numbers.fault(element, index, what))?;
                        } else {
                            self.add_face(&corners, |what| numbers.fault(element, index, what))?;
                        }
                    }
                    _ => numbers.skip(property, element, index)?,
                }
            }
        }
        Ok(())
    }

    fn add_face(&mut self, corners: &[f64], fault: impl Fn(String) -> Fault) -> Result<(), Fault> {
        if corners.len() < 3 {
            count(&mut self.repairs, "faces_under_three_corners", 1);
            return Ok(());
        }
        let first = vertex(corners[0]).map_err(&fault)?;
        let mut before = vertex(corners[1]).map_err(&fault)?;
        for corner in &corners[2..] {
            let next = vertex(*corner).map_err(&fault)?;
            self.mesh.triangles.push([first, before, next]);
            before = next;
        }
        Ok(())
    }

    /// Strips of triangles with -1 between them; every second triangle is turned.
    fn add_strips(
        &mut self,
        corners: &[f64],
        fault: impl Fn(String) -> Fault,
    ) -> Result<(), Fault> {
        for strip in corners.split(|corner| *corner == -1.0) {
            for (index, triangle) in strip.windows(3).enumerate() {
                let mut three = [0; 3];
                for (corner, said) in three.iter_mut().zip(triangle) {
                    *corner = vertex(*said).map_err(&fault)?;
                }
                if index % 2 == 1 {
                    three.swap(1, 2);
                }
                self.mesh.triangles.push(three);
            }
        }
        Ok(())
    }

    /// Faces may come before vertices, so that their corners are checked at the end.
    fn check_corners(&self) -> Result<(), Fault> {
        let vertices = self.mesh.positions.len();
        let out = |triangle: &[u32; 3]| triangle.iter().any(|corner| *corner as usize >= vertices);
        match self.mesh.triangles.iter().find(|triangle| out(triangle)) {
            None => Ok(()),
            Some(triangle) => Err(Fault::at(
                "element face",
                format!(
                    "a triangle has the corners {triangle:?}, but there are {vertices} vertices"
                ),
            )),
        }
    }
}

fn vertex(said: f64) -> Result<u32, String> {
    let number = said as u32;
    if f64::from(number) == said {
        Ok(number)
    } else {
        Err(format!("names the vertex {said}"))
    }
}

/// The slot of each property of a vertex; refused without x, y and z, or with two of one kind.
fn slots_of(element: &Element) -> Result<Vec<Option<usize>>, Fault> {
    let mut slots: Vec<Option<usize>> = Vec::with_capacity(element.properties.len());
    let mut taken = [false; SLOTS];
    for property in &element.properties {
        let slot = match property {
            Property::One { name, .. } => slot(name).filter(|slot| !taken[*slot]),
            Property::List { .. } => None,
        };
        if let Some(slot) = slot {
            taken[slot] = true;
        }
        slots.push(slot);
    }
    if taken[..3] == [true; 3] {
        return Ok(slots);
    }
    Err(Fault::at("header", "a vertex has no x, y and z"))
}

impl Scalar {
    /// The value that stands for all light.
    fn full(self) -> f64 {
        match self {
            Self::I8 => f64::from(i8::MAX),
            Self::U8 => f64::from(u8::MAX),
            Self::I16 => f64::from(i16::MAX),
            Self::U16 => f64::from(u16::MAX),
            Self::I32 => f64::from(i32::MAX),
            Self::U32 => f64::from(u32::MAX),
            Self::F32 | Self::F64 => 1.0,
        }
    }
}

#[cfg(test)]
mod tests;
