//! How is an OBJ file read?
//!
//! Its objects and groups become one mesh, so that surfaces stay closed between them. Faces are
//! fans of triangles. Source: Wavefront, "Object Files (.obj)", version 3.0.

mod mtl;

use std::collections::{HashMap, HashSet};
use std::rc::Rc;

use foveal_core::content::images::wrap::Wrap;
use glam::{DAffine2, DAffine3, DVec2, DVec3};

use super::colour::{Depth, lighten};
use super::error::Fault;
use super::search::{self, Folder};
use super::sound::count;
use super::text::{Words, lines, shortened};
use crate::source::{
    Material, MaterialTexture, SourceImage, SourceMesh, SourceObject, SourceScene,
};
use mtl::Library;

/// Reads an OBJ file into one object called `name`.
pub(super) fn read(
    bytes: &[u8],
    name: &str,
    folder: &mut dyn Folder,
) -> Result<SourceScene, Fault> {
    let mut reader = Reader {
        scene: SourceScene::default(),
        mesh: SourceMesh::default(),
        places: Vec::new(),
        place_colours: Vec::new(),
        colour_depth: Depth::default(),
        normals: Vec::new(),
        uvs: Vec::new(),
        images: HashMap::new(),
        vertices: HashMap::new(),
        library: Library::default(),
        libraries: HashSet::new(),
        material_numbers: HashMap::new(),
        material: None,
        folder,
    };
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    for line in lines(bytes) {
        reader.read_line(&mut Words::of(&line))?;
    }
    Ok(reader.finish(name))
}

struct Reader<'a> {
    scene: SourceScene,
    mesh: SourceMesh,
    /// What `v` lines say.
    places: Vec<DVec3>,
    /// As the file has them; empty, or as long as `places`.
    place_colours: Vec<[f32; 4]>,
    colour_depth: Depth,
    /// What `vn` lines say.
    normals: Vec<[f32; 3]>,
    /// What `vt` lines say.
    uvs: Vec<[f32; 2]>,
    /// The vertex of the mesh for each place, texture place and normal.
    vertices: HashMap<Corner, u32>,
    /// The pictures that were read, by name; `None` for one that is missing.
    images: HashMap<String, Option<usize>>,
    library: Library,
    /// What `mtllib` lines name: each is read once.
    libraries: HashSet<String>,
    material_numbers: HashMap<String, u32>,
    material: Option<u32>,
    folder: &'a mut dyn Folder,
}

/// What a corner of a face names, by numbers of lines.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
struct Corner {
    place: u32,
    uv: Option<u32>,
    normal: Option<u32>,
}

/// Each costs a search on the disk; exporters write one.
const MOST_LIBRARIES: usize = 256;
/// Stands for no colour until all are read.
const UNSAID: [f32; 4] = [f32::NAN; 4];

impl Reader<'_> {
    fn read_line(&mut self, words: &mut Words<'_>) -> Result<(), Fault> {
        match words.next() {
            Some("v") => self.read_place(words),
            Some("vn") => {
                let normal = words.three("a part of a normal")?;
                self.normals.push(normal.map(|along| along as f32));
                Ok(())
            }
            Some("vt") => {
                let u = words.number("a place on a texture")?;
                let v = words.number_if_any("a place on a texture")?.unwrap_or(0.0);
                // Here 0 is at the bottom of pictures.
                self.uvs
                    .push([u, 1.0 - v].map(|along| along.clamp(-1e6, 1e6) as f32));
                Ok(())
            }
            Some("f" | "fo") => self.read_face(words),
            Some("usemtl") => {
                self.use_material(&words.rest())?;
                Ok(())
            }
            Some("mtllib") => self.read_library(words),
            Some("p") => {
                let points = words.left();
                count(&mut self.scene.repairs, "points_left_out", points);
                Ok(())
            }
            Some("l") => {
                let lines = words.left().saturating_sub(1);
                count(&mut self.scene.repairs, "lines_left_out", lines);
                Ok(())
            }
            Some("curv" | "curv2" | "surf") => {
                let remark = "curves and free-form surfaces of OBJ are not drawn";
                self.scene.remark(remark);
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// x, y and z, maybe followed by a weight, which has no meaning here, or by a colour.
    fn read_place(&mut self, words: &mut Words<'_>) -> Result<(), Fault> {
        let place = DVec3::from_array(words.three("a coordinate")?);
        let mut more = Vec::new();
        while let Some(number) = words.number_if_any("what follows coordinates")? {
            more.push(number);
        }
        let colour = match more.as_slice() {
            [red, green, blue] | [red, green, blue, _] => {
                self.colour_depth.add([*red, *green, *blue]);
                Some([*red as f32, *green as f32, *blue as f32, 1.0])
            }
            _ => None,
        };
        if colour.is_some() || !self.place_colours.is_empty() {
            self.place_colours.resize(self.places.len(), UNSAID);
            self.place_colours.push(colour.unwrap_or(UNSAID));
        }
        self.places.push(place);
        Ok(())
    }

    fn read_face(&mut self, words: &mut Words<'_>) -> Result<(), Fault> {
        let mut first = None;
        let mut before = None;
        let mut corners = 0;
        while let Some(word) = words.next() {
            let next = self
                .corner(word)
                .map_err(|what| Fault::line(words.line, what))?;
            corners += 1;
            if let (Some(first), Some(before)) = (first, before) {
                self.add_triangle([first, before, next])?;
            }
            before = first.is_some().then_some(next);
            first = first.or(Some(next));
        }
        let few = usize::from(corners < 3);
        count(&mut self.scene.repairs, "faces_under_three_corners", few);
        Ok(())
    }

    fn add_triangle(&mut self, triangle: [u32; 3]) -> Result<(), Fault> {
        let material = match self.material {
            Some(material) => material,
            None => self.use_material("")?,
        };
        self.mesh.triangles.push(triangle);
        self.mesh.materials.push(material);
        Ok(())
    }

    /// The vertex of the mesh that `place`, `place/texture`, `place//normal` or
    /// `place/texture/normal` is.
    fn corner(&mut self, word: &str) -> Result<u32, String> {
        let mut parts = word.split('/');
        let place = index(parts.next().unwrap_or(""), self.places.len(), "vertex")?;
        let uv = match parts.next() {
            None | Some("") => None,
            // Some programs name what they do not write.
            Some(uv) => index(uv, self.uvs.len(), "place on a texture").ok(),
        };
        let normal = match parts.next() {
            None | Some("") => None,
            Some(normal) => Some(index(normal, self.normals.len(), "normal")?),
        };
        let corner = Corner { place, uv, normal };
        let next = u32::try_from(self.mesh.positions.len())
            .map_err(|_| "there are more vertices than 4294967295".to_owned())?;
        let vertex = *self.vertices.entry(corner).or_insert(next);
        if vertex == next {
            self.add_vertex(corner);
        }
        Ok(vertex)
    }

    fn add_vertex(&mut self, Corner { place, uv, normal }: Corner) {
        let vertices = self.mesh.positions.len();
        self.mesh.positions.push(self.places[place as usize]);
        if normal.is_some() || !self.mesh.normals.is_empty() {
            // Those without one are made of the faces around them.
            self.mesh.normals.resize(vertices, [0.0; 3]);
            let normal = normal.map_or([0.0; 3], |normal| self.normals[normal as usize]);
            self.mesh.normals.push(normal);
        }
        if uv.is_some() || !self.mesh.uvs.is_empty() {
            self.mesh.uvs.resize(vertices, [0.0; 2]);
            let uv = uv.map_or([0.0; 2], |uv| self.uvs[uv as usize]);
            self.mesh.uvs.push(uv);
        }
        let colour = self.place_colours.get(place as usize);
        if colour.is_some() || !self.mesh.colours.is_empty() {
            self.mesh.colours.resize(vertices, UNSAID);
            self.mesh.colours.push(colour.copied().unwrap_or(UNSAID));
        }
    }

    fn use_material(&mut self, name: &str) -> Result<u32, Fault> {
        let number = match self.material_numbers.get(name) {
            Some(number) => *number,
            None => {
                let number = self.scene.materials.len() as u32;
                let known = self.library.materials.get(name).cloned();
                let lost = usize::from(known.is_none() && !name.is_empty());
                count(&mut self.scene.repairs, "materials_not_found", lost);
                let mut material = known.unwrap_or_else(|| Material {
                    name: name.to_owned(),
                    two_sided: true,
                    ..Material::default()
                });
                material.texture = self.texture(name);
                self.scene.materials.push(material);
                self.material_numbers.insert(name.to_owned(), number);
                number
            }
        };
        self.material = Some(number);
        Ok(number)
    }

    /// How a material shows a picture.
    fn texture(&mut self, material: &str) -> Option<MaterialTexture> {
        let map = self.library.pictures.get(material).cloned()?;
        let image = match self.images.get(&map.file) {
            Some(known) => *known,
            None => {
                let image = match search::read(self.folder, &map.names()) {
                    Ok(bytes) => {
                        self.scene.images.push(SourceImage {
                            name: map.file.clone(),
                            bytes: bytes.as_slice().into(),
                        });
                        Some(self.scene.images.len() - 1)
                    }
                    Err(fault) => {
                        self.scene.missing_picture(&map.file, &fault.what());
                        None
                    }
                };
                *self.images.entry(map.file).or_insert(image)
            }
        };
        let wrap = if map.clamps {
            Wrap::Clamp
        } else {
            Wrap::Repeat
        };
        // The picture's rows count from its top, the file's from the bottom.
        let [u, v] = map.scale;
        let offset = DVec2::new(map.offset[0], 1.0 - v - map.offset[1]);
        image.map(|image| MaterialTexture {
            image,
            wrap: [wrap; 2],
            picture_from_uv: DAffine2::from_scale_angle_translation(DVec2::new(u, v), 0.0, offset),
            cutoff: None,
        })
    }

    /// The files of one line: their names have no blanks, unless it is one name.
    fn read_library(&mut self, words: &Words<'_>) -> Result<(), Fault> {
        let whole = words.rest();
        if !self.libraries.insert(whole.clone()) {
            return Ok(());
        }
        if self.libraries.len() > MOST_LIBRARIES {
            let what = format!("more than {MOST_LIBRARIES} files of materials are named");
            return Err(Fault::line(words.line, what));
        }
        // Blanks may be of one name, or between several; quotes tell.
        match search::read(self.folder, &[&whole]) {
            Err(Fault::Missing { .. }) if whole.contains(' ') && !whole.starts_with('"') => {
                for name in whole.split(' ').take(MOST_LIBRARIES) {
                    let file = search::read(self.folder, &[name]);
                    self.add_library(name, file, words.line)?;
                }
                Ok(())
            }
            file => self.add_library(&whole, file, words.line),
        }
    }

    fn add_library(
        &mut self,
        name: &str,
        file: Result<Rc<Vec<u8>>, Fault>,
        line: usize,
    ) -> Result<(), Fault> {
        match file {
            Ok(bytes) => {
                self.library
                    .read(&bytes, name)
                    .map_err(|fault| in_library(name, fault))?;
            }
            Err(Fault::Missing { reason, .. }) => {
                let missing = "material_files_missing";
                if !self.scene.repairs.contains_key(missing) {
                    let name = shortened(name);
                    self.scene.remark(format!(
                        "the materials in {name:?}, named in line {line}, cannot be read \
                         ({reason}): surfaces are white"
                    ));
                }
                count(&mut self.scene.repairs, missing, 1);
            }
            Err(fault) => return Err(fault),
        }
        Ok(())
    }

    /// Colours are codes of whatever depth all of them tell.
    fn light_colours(&mut self) {
        if self.mesh.colours.is_empty() {
            return;
        }
        let full = self.colour_depth.full(1.0);
        let largest = full.largest() as f32;
        for colour in self.mesh.colours.iter_mut().filter(|it| it[0].is_nan()) {
            *colour = [largest, largest, largest, 1.0];
        }
        let strays = lighten(&mut self.mesh.colours, &full, 1.0);
        count(&mut self.scene.repairs, "colours_of_another_depth", strays);
        if let Some(remark) = full.remark("vertices", strays) {
            self.scene.remark(remark);
        }
    }

    fn finish(mut self, name: &str) -> SourceScene {
        self.light_colours();
        for (repair, times) in std::mem::take(&mut self.library.repairs) {
            count(&mut self.scene.repairs, &repair, times as usize);
        }
        self.scene.objects.push(SourceObject {
            name: name.to_owned(),
            mesh: 0,
            placements: vec![DAffine3::IDENTITY],
        });
        let unused = self.vertices_in_no_face();
        count(&mut self.scene.repairs, "unused_vertices", unused);
        self.scene.meshes.push(self.mesh);
        self.scene
    }

    fn vertices_in_no_face(&self) -> usize {
        let mut used = vec![false; self.places.len()];
        for Corner { place, .. } in self.vertices.keys() {
            used[*place as usize] = true;
        }
        used.iter().filter(|used| !**used).count()
    }
}

/// The number, counted from 0, that a word names in a list: 1 is the first, -1 the last.
fn index(word: &str, length: usize, what: &str) -> Result<u32, String> {
    let Ok(number) = word.parse::<i64>() else {
        return Err(format!("{:?} is no number of a {what}", shortened(word)));
    };
    let from_zero = if number < 0 {
        (length as i64).checked_add(number)
    } else {
        number.checked_sub(1)
    };
    from_zero
        .filter(|index| *index < length as i64)
        .and_then(|index| u32::try_from(index).ok())
        .ok_or_else(|| format!("names {what} {number}, but {length} stand before it"))
}

fn in_library(name: &str, fault: Fault) -> Fault {
    match fault {
        Fault::Broken { place, what, next } => Fault::Broken {
            place: format!("its {:?}, {place}", shortened(name)),
            what,
            next,
        },
        other => other,
    }
}

#[cfg(test)]
mod tests;
