//! How is a PLY file read?
//!
//! Source: G. Turk, "The PLY Polygon File Format", 1994, and what Stanford's and scanners' files
//! hold: vertices with colours and normals, faces, and strips of triangles. Vertices without faces
//! are a cloud of points.

mod colours;
mod header;
mod numbers;

use glam::{DAffine3, DVec3};

use super::error::Fault;
use super::outliers;
use super::sound::count;
use crate::source::{Material, Repairs, SourceMesh, SourceObject, SourceScene};
use colours::{ColourColumns, PlyColours, Told, colour_triangles};
use header::{Element, PlyHeader, Property};
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
    let colours = reader.take_colours();
    if reader.is_cloud {
        let mut scene = SourceScene {
            repairs: reader.repairs,
            ..SourceScene::default()
        };
        colours.into_iter().for_each(|it| scene.remark(it));
        let positions = &reader.mesh.positions;
        scene.clouds = outliers::clouds(name, positions, &reader.codes, &mut scene);
        return Ok(scene);
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
    colours.into_iter().for_each(|it| scene.remark(it));
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
    /// Colours of vertices, or of points.
    colours: Option<PlyColours>,
    /// Those of triangles.
    face_colours: Option<PlyColours>,
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
        _ => return None,
    };
    Some(slot)
}

const SLOTS: usize = 6;

impl Reader {
    fn read_vertices(&mut self, element: &Element, numbers: &mut Numbers<'_>) -> Result<(), Fault> {
        if !self.mesh.positions.is_empty() {
            return Err(Fault::at("header", "there are two elements called vertex"));
        }
        let slots = slots_of(element)?;
        let has = |wanted: core::ops::Range<usize>| {
            wanted.into_iter().all(|slot| slots.contains(&Some(slot)))
        };
        let has_normals = has(3..6);
        let columns = ColourColumns::of(element);
        let mut colours = columns.as_ref().map(PlyColours::new);
        let mut row = [0.0; SLOTS];
        let mut colour = [-1.0; 4];
        for index in 0..element.count {
            for (at, (property, slot)) in element.properties.iter().zip(&slots).enumerate() {
                let part = columns.as_ref().and_then(|it| it.part(at));
                match (slot, property) {
                    (Some(slot), Property::One { scalar, .. }) => {
                        row[*slot] = numbers.number(*scalar, element, index)?;
                    }
                    (None, Property::One { scalar, .. }) if part.is_some() => {
                        colour[part.unwrap_or(0)] = numbers.number(*scalar, element, index)?;
                    }
                    _ => numbers.skip(property, element, index)?,
                }
            }
            let [x, y, z, nx, ny, nz] = row;
            let position = DVec3::new(x, y, z);
            if !position.is_finite() {
                return Err(numbers.fault(element, index, format!("stands at {position}")));
            }
            self.mesh.positions.push(position);
            if has_normals && !self.is_cloud {
                self.mesh.normals.push([nx as f32, ny as f32, nz as f32]);
            }
            if let Some(colours) = &mut colours {
                colours.fill(colour, self.mesh.positions.len());
            }
        }
        self.colours = colours;
        Ok(())
    }

    /// Colours what was read, and gives what a person should know of it.
    fn take_colours(&mut self) -> Vec<String> {
        let mut told = Told::of(if self.is_cloud { "points" } else { "vertices" });
        match self.colours.take() {
            Some(colours) if self.is_cloud => self.codes = colours.codes(&mut told),
            Some(colours) => self.mesh.colours = colours.lights(&mut told),
            None => {}
        }
        if let Some(faces) = self.face_colours.take().filter(|it| !it.is_empty()) {
            told.what = "faces";
            match self.mesh.colours.is_empty() {
                true => colour_triangles(&mut self.mesh, &faces.lights(&mut told)),
                false => {
                    let remark = "colours of faces are left out, as vertices have colours too";
                    told.remarks.push(remark.to_owned());
                }
            }
        }
        for (name, times) in told.repairs {
            count(&mut self.repairs, &name, times as usize);
        }
        told.remarks
    }

    fn read_faces(&mut self, element: &Element, numbers: &mut Numbers<'_>) -> Result<(), Fault> {
        let is_strip = element.name == "tristrips";
        let columns = ColourColumns::of(element);
        if self.face_colours.is_none() {
            self.face_colours = columns.as_ref().map(PlyColours::new);
        }
        let mut colour = [-1.0; 4];
        let mut corners = Vec::new();
        for index in 0..element.count {
            for (at, property) in element.properties.iter().enumerate() {
                let part = columns.as_ref().and_then(|it| it.part(at));
                match property {
                    Property::One { scalar, .. } if part.is_some() => {
                        colour[part.unwrap_or(0)] = numbers.number(*scalar, element, index)?;
                    }
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
            if let Some(colours) = &mut self.face_colours {
                colours.fill(colour, self.mesh.triangles.len());
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
            Property::One { name, .. } => {
                slot(&name.to_ascii_lowercase()).filter(|slot| !taken[*slot])
            }
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
    let is_packed =
        |it: &Property| matches!(it, Property::One { name, .. } if name == "packed_position");
    if element.properties.iter().any(is_packed) {
        return Err(Fault::unsupported(
            "its splats are compressed",
            "export them as a plain PLY file",
        ));
    }
    Err(Fault::at("header", "a vertex has no x, y and z"))
}

#[cfg(test)]
mod tests;
