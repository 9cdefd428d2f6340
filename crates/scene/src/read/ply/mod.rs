//! How is a PLY file read?
//!
//! Source: G. Turk, "The PLY Polygon File Format", 1994, and what Stanford's and scanners' files
//! hold: vertices with colours and normals, faces, and strips of triangles. Vertices without faces
//! are a cloud of points.

mod colours;
mod corners;
mod header;
mod numbers;
mod order;

use glam::{DAffine3, DVec3};

use super::colour::{BLACK_COLOURS, tell_black};
use super::error::Fault;
use super::mends::{self, Mends};
use super::outliers;
use super::polygon::Polygons;
use super::sound::count;
use super::text::shortened;
use crate::source::{Material, Repairs, SourceMesh, SourceObject, SourceScene, keep};
use colours::{ColourColumns, ColourRemarks, PlyColours, colour_triangles, forget_colours};
use corners::Corners;
use header::{Element, PlyHeader, Property};
use numbers::Numbers;

/// Reads a PLY file into one object called `name`.
pub(super) fn read(bytes: &[u8], name: &str) -> Result<SourceScene, Fault> {
    let mut header = PlyHeader::parse(bytes)?;
    let is_turned = order::mend(&mut header, bytes);
    let mut reader = Reader::of(&header, bytes, 0)?;
    if let Some(other) = reader.other_count(&mut header, bytes)? {
        reader = other;
    } else if reader.counts_from_one() {
        reader = Reader::of(&header, bytes, 1)?;
        let place = || "vertex is 1".to_owned();
        reader.mends.add(mends::FROM_ONE, 1, place);
    }
    let polygons = std::mem::take(&mut reader.polygons);
    polygons.fill(&mut reader.mesh, &mut reader.mends);
    let mut scene = SourceScene::default();
    let are_points = reader.is_cloud || reader.has_only_vertices();
    let is_black = reader.colours.as_ref().is_some_and(PlyColours::is_black);
    if are_points && is_black && forget_colours(&mut header) {
        reader = Reader::of(&header, bytes, 0)?;
        count(
            &mut scene.repairs,
            BLACK_COLOURS,
            reader.mesh.positions.len(),
        );
        tell_black(name, true, &mut scene);
    }
    let place = || "is that of the first vertex".to_owned();
    let times = usize::from(is_turned);
    reader.mends.add(mends::BYTE_ORDER, times, place);
    reader.take_colours(are_points, name, &mut scene);
    if are_points {
        let (positions, colours) = reader.points();
        scene.clouds = outliers::clouds(name, &positions, colours, &mut scene);
    } else {
        if reader.mesh.triangles.is_empty() {
            let points = reader.mesh.positions.len();
            count(&mut reader.repairs, "points_left_out", points);
            reader.mesh = SourceMesh::default();
        }
        scene.objects = vec![SourceObject {
            name: name.to_owned(),
            mesh: 0,
            placements: vec![DAffine3::IDENTITY],
        }];
        scene.meshes = vec![reader.mesh];
        scene.materials = vec![Material {
            two_sided: true,
            ..Material::default()
        }];
    }
    for (name, times) in reader.repairs {
        count(&mut scene.repairs, &name, times as usize);
    }
    reader.mends.tell(name, &mut scene);
    if header.has_textures {
        scene.remark("textures of PLY files are not drawn: export the mesh as glTF");
    }
    Ok(scene)
}

/// Whether rows are faces.
fn is_face(element: &Element) -> bool {
    matches!(element.name.as_str(), "face" | "tristrips")
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
    /// Colours of materials that faces name.
    palette: Option<PlyColours>,
    polygons: Polygons,
    /// The number of the first vertex, and the least and largest number that faces name.
    first: u32,
    named: Option<[u32; 2]>,
    /// The corners of the face that is being read.
    outline: Vec<u32>,
    /// Colours of the points of a cloud, as codes of sixteen bits.
    codes: Vec<[u16; 3]>,
    repairs: Repairs,
    mends: Mends,
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
    /// All elements that a header lists.
    ///
    /// Faces call the first vertex by the number `first`.
    fn of(header: &PlyHeader, bytes: &[u8], first: u32) -> Result<Self, Fault> {
        let mut numbers = Numbers::of(header, bytes);
        let faces = header.elements.iter().filter(|it| is_face(it));
        let mut reader = Self {
            is_cloud: faces.map(|it| it.count).sum::<u64>() == 0,
            first,
            ..Self::default()
        };
        for element in &header.elements {
            numbers.begin(element);
            match element.name.as_str() {
                "vertex" => reader.read_vertices(element, &mut numbers)?,
                _ if is_face(element) => reader.read_faces(element, &mut numbers),
                "material" => reader.read_materials(element, &mut numbers),
                _ => reader.skip(element, &mut numbers),
            }
            numbers.end();
        }
        reader.add_mends(&numbers);
        if let Some(last) = header.elements.last() {
            let left = numbers.rows_left(last);
            let place = || numbers.place();
            reader.mends.add(mends::ROW_LEFT, left, place);
        }
        Ok(reader)
    }

    /// The same of a text whose header counts too many vertices, or too few: where all rows fit
    /// with another number of them, as a row is a line. The header has that number then.
    fn other_count(&self, header: &mut PlyHeader, bytes: &[u8]) -> Result<Option<Self>, Fault> {
        let count = |mend| self.mends.times(mend) as u64;
        let (missing, left) = (count(mends::ROW_MISSING), count(mends::ROW_LEFT));
        let is_text = header.encoding == header::Encoding::Text;
        let vertices = header.elements.iter().position(|it| it.name == "vertex");
        let (Some(at), true, true) = (vertices, is_text && !self.is_cloud, missing != left) else {
            return Ok(None);
        };
        let said = header.elements[at].count;
        let Some(found) = (said + left).checked_sub(missing).filter(|it| *it > 2) else {
            return Ok(None);
        };
        header.elements[at].count = found;
        let mut other = Self::of(header, bytes, 0)?;
        let kinds = [
            mends::ROW_MISSING,
            mends::ROW_LEFT,
            mends::LINE_BROKEN,
            mends::WORDS_BEYOND,
        ];
        let is_there = |it: &u32| u64::from(*it) < found;
        let is_whole = kinds.iter().all(|it| other.mends.times(*it) == 0)
            && other.repairs.is_empty()
            && !other.mesh.triangles.is_empty()
            && other.mesh.triangles.as_flattened().iter().all(is_there);
        header.elements[at].count = if is_whole { found } else { said };
        if !is_whole {
            return Ok(None);
        }
        let mend = match found < said {
            true => mends::ROW_MISSING,
            false => mends::ROW_BEYOND,
        };
        let place = || format!("is vertex {}", found.min(said));
        let times = usize::try_from(found.abs_diff(said)).unwrap_or(usize::MAX);
        other.mends.add(mend, times, place);
        Ok(Some(other))
    }

    /// Whether faces never name 0, and do name the number of vertices.
    fn counts_from_one(&self) -> bool {
        let vertices = self.mesh.positions.len();
        self.named
            .is_some_and(|[least, most]| least > 0 && most as usize == vertices)
    }

    /// Counts the rows of an element from this one on as missing.
    fn lose(&mut self, element: &Element, index: u64, numbers: &Numbers<'_>) {
        let times = usize::try_from(element.count - index).unwrap_or(usize::MAX);
        self.mends.add(mends::ROW_MISSING, times, || {
            let place = numbers.place();
            format!("is {} {index} of {}, {place}", element.name, element.count)
        });
    }

    fn add_mends(&mut self, numbers: &Numbers<'_>) {
        let all = [
            (mends::WORDS_BEYOND, numbers.too_long),
            (mends::LINE_BROKEN, numbers.broken),
            (mends::GLUED, numbers.glued),
        ];
        for (mend, lines) in all {
            let place = || format!("in line {}", lines.first);
            self.mends.add(mend, lines.times, place);
        }
        let place = || "in its text".to_owned();
        self.mends.add(mends::COMMA, numbers.commas, place);
    }

    /// Whether the file was cut off before its faces.
    fn has_only_vertices(&self) -> bool {
        let is_cut = self.mends.times(mends::ROW_MISSING) > 0;
        is_cut && self.mesh.triangles.is_empty() && self.repairs.is_empty()
    }

    fn skip(&mut self, element: &Element, numbers: &mut Numbers<'_>) {
        if element.properties.is_empty() {
            return;
        }
        if element.name.to_ascii_lowercase().starts_with("edge") {
            let times = usize::try_from(element.count).unwrap_or(usize::MAX);
            let place = || format!("is that of the element {:?}", shortened(&element.name));
            self.mends.add(mends::EDGES_LEFT, times, place);
        }
        for index in 0..element.count {
            numbers.begin_row();
            let mut all = element.properties.iter();
            if all.any(|property| numbers.skip(property).is_none()) {
                return self.lose(element, index, numbers);
            }
        }
    }

    /// Reads the colours of materials.
    fn read_materials(&mut self, element: &Element, numbers: &mut Numbers<'_>) {
        let columns = ColourColumns::of(element).filter(ColourColumns::is_parts);
        let Some(columns) = columns.filter(|_| self.palette.is_none()) else {
            let times = usize::try_from(element.count).unwrap_or(usize::MAX);
            let place = || "is that of the header".to_owned();
            self.mends.add(mends::PLY_MATERIALS, times, place);
            return self.skip(element, numbers);
        };
        let mut palette = PlyColours::new(&columns);
        for index in 0..element.count {
            numbers.begin_row();
            let mut colour = [-1.0; 4];
            for (at, property) in element.properties.iter().enumerate() {
                let read = match (columns.part(at), property) {
                    (Some(part), Property::One { scalar, .. }) => {
                        numbers.number(*scalar).map(|value| colour[part] = value)
                    }
                    _ => numbers.skip(property),
                };
                if read.is_none() {
                    self.lose(element, index, numbers);
                    self.palette = Some(palette);
                    return;
                }
            }
            if !palette.add(colour) {
                let place = || format!("of material {index}");
                self.mends.add(mends::COLOUR_MADE, 1, place);
            }
        }
        self.palette = Some(palette);
    }

    fn read_vertices(&mut self, element: &Element, numbers: &mut Numbers<'_>) -> Result<(), Fault> {
        if !self.mesh.positions.is_empty() {
            return Err(Fault::at("header", "there are two elements called vertex"));
        }
        let slots = slots_of(element)?;
        let is_flat = usize::from(!slots.contains(&Some(2)));
        let place = || "is that of the header".to_owned();
        self.mends.add(mends::FLAT, is_flat, place);
        let has = |wanted: core::ops::Range<usize>| {
            wanted.into_iter().all(|slot| slots.contains(&Some(slot)))
        };
        let has_normals = has(3..6);
        let columns = ColourColumns::of(element);
        let is_packed = columns.as_ref().is_some_and(ColourColumns::is_packed);
        if ColourColumns::is_part_of(element) {
            let place = || "is that of vertices".to_owned();
            self.mends.add(mends::COLOUR_INCOMPLETE, 1, place);
        }
        let mut colours = columns.as_ref().map(PlyColours::new);
        let mut row = [0.0; SLOTS];
        let mut colour = [-1.0; 4];
        for index in 0..element.count {
            numbers.begin_row();
            for (at, (property, slot)) in element.properties.iter().zip(&slots).enumerate() {
                let read = match (slot, property) {
                    (Some(slot), Property::One { scalar, .. }) => {
                        let value = numbers.number(*scalar);
                        value.map(|value| row[*slot] = value)
                    }
                    (None, Property::One { scalar, .. }) => {
                        let part = columns.as_ref().and_then(|it| it.part(at));
                        let value = match part.is_some() && is_packed {
                            true => numbers.packed(*scalar),
                            false => numbers.number(*scalar),
                        };
                        value.map(|value| {
                            if let Some(part) = part {
                                colour[part] = value;
                            }
                        })
                    }
                    _ => numbers.skip(property),
                };
                if read.is_none() {
                    self.lose(element, index, numbers);
                    self.colours = colours;
                    return Ok(());
                }
            }
            let [x, y, z, nx, ny, nz] = row;
            let position = DVec3::new(x, y, z);
            if self.is_cloud && !position.is_finite() {
                let place = || format!("is vertex {index}");
                self.mends.add(mends::POINT_WITHOUT_PLACE, 1, place);
                continue;
            }
            self.mesh.positions.push(position);
            if has_normals && !self.is_cloud {
                self.mesh.normals.push([nx as f32, ny as f32, nz as f32]);
            }
            if let Some(colours) = &mut colours
                && !colours.add(colour)
            {
                let place = || format!("of vertex {index}");
                self.mends.add(mends::COLOUR_MADE, 1, place);
            }
        }
        self.colours = colours;
        Ok(())
    }

    /// Colours what was read, and reports what a person should know of it.
    fn take_colours(&mut self, are_points: bool, name: &str, scene: &mut SourceScene) {
        let name = shortened(name);
        let what = if are_points { "points" } else { "vertices" };
        let mut reported = ColourRemarks::of(format!("{what} of {name:?}"));
        match self.colours.take() {
            Some(colours) if are_points => self.codes = colours.codes(&mut reported),
            Some(colours) => self.mesh.colours = colours.lights(&mut reported),
            None => {}
        }
        let faces = std::mem::take(&mut self.mesh.materials);
        let palette = self.palette.take();
        let names = !faces.is_empty() && self.face_colours.is_none();
        if palette.is_some() != names {
            let place = || "is one that no face names, or that does not exist".to_owned();
            self.mends.add(mends::PLY_MATERIALS, 1, place);
        }
        let colours = self
            .face_colours
            .take()
            .or(palette.filter(|_| !faces.is_empty()));
        if let Some(colours) = colours.filter(|_| !are_points) {
            reported.what = format!("faces of {name:?}");
            match self.mesh.colours.is_empty() {
                true => colour_triangles(&mut self.mesh, &faces, &colours.lights(&mut reported)),
                false => {
                    let remark = "colours of faces are left out, as vertices have colours too";
                    reported.remarks.push(remark.to_owned());
                }
            }
        }
        let lost = self.mesh.colours.iter().filter(|it| it[3] < 1.0).count();
        if lost > 0 {
            count(&mut reported.repairs, "drawn_opaque", lost);
            let remark =
                format!("what is half transparent is drawn opaque: {lost} vertices of {name:?}");
            reported.remarks.push(remark);
        }
        for (name, times) in reported.repairs {
            count(&mut self.repairs, &name, times as usize);
        }
        reported.remarks.into_iter().for_each(|it| scene.remark(it));
    }

    /// The places and colours of points, also of a mesh that has lost its faces.
    fn points(&mut self) -> (Vec<DVec3>, Vec<[u16; 3]>) {
        let positions = std::mem::take(&mut self.mesh.positions);
        let is_finite: Vec<bool> = positions.iter().map(|it| it.is_finite()).collect();
        let lost = is_finite.iter().filter(|it| !**it).count();
        let first = is_finite.iter().position(|it| !*it).unwrap_or(0);
        let place = || format!("is vertex {first}");
        self.mends.add(mends::POINT_WITHOUT_PLACE, lost, place);
        let mut colours = std::mem::take(&mut self.codes);
        let mut positions = positions;
        keep(&mut positions, &is_finite);
        keep(&mut colours, &is_finite);
        (positions, colours)
    }

    fn read_faces(&mut self, element: &Element, numbers: &mut Numbers<'_>) {
        let is_strip = element.name == "tristrips";
        let columns = ColourColumns::of(element).filter(|it| !it.is_packed());
        let before = self.face_colours.take();
        let mut colours = before.or_else(|| columns.as_ref().map(PlyColours::new));
        let mut colour = [-1.0; 4];
        let corners = Corners::of(element);
        let place = || format!("is {:?}", shortened(&corners.name));
        let is_other = usize::from(corners.is_of_another_name);
        self.mends.add(mends::CORNERS_NAMED, is_other, place);
        let material_at = corners.material.filter(|_| colours.is_none());
        let mut material = 0.0;
        if element.properties.is_empty() {
            return;
        }
        let corners_at = corners.at;
        let scalars = corners.scalars;
        let mut row = Vec::new();
        'rows: for index in 0..element.count {
            numbers.begin_row();
            row.clear();
            for (at, property) in element.properties.iter().enumerate() {
                let read = match property {
                    Property::One { scalar, .. } => {
                        let value = numbers.number(*scalar);
                        let part = columns.as_ref().and_then(|it| it.part(at));
                        value.map(|value| {
                            if let Some(part) = part {
                                colour[part] = value;
                            } else if Some(at) == material_at {
                                material = value;
                            } else if scalars.contains(&at) {
                                row.push(value);
                            }
                        })
                    }
                    Property::List { length, scalar, .. } if Some(at) == corners_at => {
                        let length = numbers.length(*length, *scalar);
                        length.and_then(|length| {
                            let mut all = (0..length).map(|_| numbers.number(*scalar));
                            all.try_for_each(|corner| corner.map(|it| row.push(it)))
                        })
                    }
                    _ => numbers.skip(property),
                };
                if read.is_none() {
                    self.lose(element, index, numbers);
                    break 'rows;
                }
            }
            match (corners_at.is_some() || !scalars.is_empty(), is_strip) {
                (false, _) => {}
                (_, true) => self.add_strips(&row),
                (_, false) => self.add_face(&row),
            }
            let triangles = self.mesh.triangles.len();
            // Until all are cut, the material of a triangle holds its face, or what the face names.
            if let Some(colours) = &mut colours {
                let is_none = usize::from(!colours.add(colour));
                self.mends
                    .add(mends::COLOUR_MADE, is_none, || format!("of face {index}"));
                let face = colours.len() as u32 - 1;
                self.mesh.materials.resize(triangles, face);
            } else if material_at.is_some() {
                self.mesh.materials.resize(triangles, vertex(material));
            }
        }
        self.face_colours = colours;
    }

    fn add_face(&mut self, corners: &[f64]) {
        if corners.len() < 3 {
            count(&mut self.repairs, mends::SHORT_FACE.name, 1);
            return;
        }
        self.outline.clear();
        for corner in corners {
            let corner = self.corner(*corner);
            self.outline.push(corner);
        }
        self.polygons.add(&mut self.mesh.triangles, &self.outline);
    }

    /// The number, from 0, of the vertex that a face names, or a number that no vertex has.
    fn corner(&mut self, said: f64) -> u32 {
        let number = vertex(said);
        let [least, most] = self.named.unwrap_or([number; 2]);
        self.named = Some([least.min(number), most.max(number)]);
        number.checked_sub(self.first).unwrap_or(u32::MAX)
    }

    /// Strips of triangles with -1 between them; every second triangle is turned.
    fn add_strips(&mut self, corners: &[f64]) {
        for strip in corners.split(|corner| *corner == -1.0) {
            for (index, triangle) in strip.windows(3).enumerate() {
                let mut three = [0, 1, 2].map(|k| self.corner(triangle[k]));
                if index % 2 == 1 {
                    three.swap(1, 2);
                }
                self.mesh.triangles.push(three);
            }
        }
    }
}

/// The number of a vertex, or one that none has.
fn vertex(said: f64) -> u32 {
    let number = said as u32;
    match f64::from(number) == said {
        true => number,
        false => u32::MAX,
    }
}

/// The slot of each property of a vertex; refused without x and y.
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
    // Drawings have two coordinates.
    if taken[..2] == [true; 2] {
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
    Err(Fault::at("header", "a vertex has no `x` and `y`"))
}

#[cfg(test)]
mod tests;
