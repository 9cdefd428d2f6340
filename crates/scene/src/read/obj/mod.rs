//! How is an OBJ file read?
//!
//! Its objects and groups become one mesh, so that surfaces stay closed between them; its points,
//! or the vertices of a file without faces, become a cloud. Source: Wavefront, "Object Files
//! (.obj)", version 3.0.

mod corners;
mod mtl;
mod points;
mod polypaint;
mod rows;
mod shown;

use std::collections::{HashMap, HashSet};
use std::rc::Rc;

use foveal_core::content::images::wrap::Wrap;
use glam::{DAffine2, DAffine3, DVec2, DVec3};

use super::colour::{Depth, lighten};
use super::error::Fault;
use super::mends::{self, Mends};
use super::outliers;
use super::polygon::Polygons;
use super::search::{self, Folder};
use super::sound::count;
use super::text::{Words, lines, shortened, utf8_of};
use crate::source::{
    Material, MaterialTexture, SourceImage, SourceMesh, SourceObject, SourceScene,
};
use corners::{Corner, FaceCorner, Late, NO_UV, Vertices};
use mtl::Library;
use points::NamedPoints;
use polypaint::Polypaint;

/// Reads an OBJ file into one object called `name`.
pub(super) fn read(
    bytes: &[u8],
    name: &str,
    folder: &mut dyn Folder,
) -> Result<SourceScene, Fault> {
    let read_from = |first: u32, folder: &mut dyn Folder| {
        let mut reader = Reader::new(first, folder);
        for line in lines(bytes) {
            reader.read_line(&mut Words::of(&line))?;
        }
        match reader.late.counts_from_zero(reader.places.len()) {
            true => Ok(None),
            false => reader.finish(name).map(Some),
        }
    };
    let scene = match read_from(1, folder)? {
        Some(scene) => Some(scene),
        None => read_from(0, folder)?,
    };
    Ok(scene.unwrap_or_default())
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
    vertices: Vertices,
    polygons: Polygons,
    /// The corners of the face that is being read, and the vertices of the mesh that they are.
    face: Vec<FaceCorner>,
    outline: Vec<u32>,
    /// Faces that name what did not stand before them.
    late: Late,
    points: NamedPoints,
    polypaint: Polypaint,
    /// How many numbers the last `v` and `vt` lines had; 0 before the first.
    place_columns: usize,
    uv_columns: usize,
    mends: Mends,
    /// The pictures that were read, by name; `None` for one that is missing.
    images: HashMap<String, Option<usize>>,
    library: Library,
    /// What `mtllib` lines name: each is read once.
    libraries: HashSet<String>,
    material_numbers: HashMap<String, u32>,
    /// Materials that no file had yet, and their numbers.
    lost_materials: Vec<(String, u32)>,
    material: Option<u32>,
    folder: &'a mut dyn Folder,
}

/// Exporters write one.
const MOST_LIBRARIES: usize = 256;
/// Stands for no colour until all are read.
const UNSAID: [f32; 4] = [-1.0; 4];
/// Numbers of 32 bits, of which the last two stand for none.
const MOST_VERTICES: usize = u32::MAX as usize - 2;

impl Reader<'_> {
    fn new(first: u32, folder: &'_ mut dyn Folder) -> Reader<'_> {
        Reader {
            scene: SourceScene::default(),
            mesh: SourceMesh::default(),
            places: Vec::new(),
            place_colours: Vec::new(),
            colour_depth: Depth::default(),
            normals: Vec::new(),
            uvs: Vec::new(),
            images: HashMap::new(),
            vertices: Vertices::default(),
            polygons: Polygons::default(),
            face: Vec::new(),
            outline: Vec::new(),
            late: Late::of(first),
            points: NamedPoints::default(),
            polypaint: Polypaint::default(),
            place_columns: 0,
            uv_columns: 0,
            mends: Mends::default(),
            library: Library::default(),
            libraries: HashSet::new(),
            material_numbers: HashMap::new(),
            lost_materials: Vec::new(),
            material: None,
            folder,
        }
    }

    fn read_line(&mut self, words: &mut Words<'_>) -> Result<(), Fault> {
        let Some(keyword) = words.next() else {
            return Ok(());
        };
        let small;
        let keyword = match keyword.bytes().any(|sign| sign.is_ascii_uppercase()) {
            true => {
                small = keyword.to_ascii_lowercase();
                small.as_str()
            }
            false => keyword,
        };
        if matches!(keyword, "v" | "vn" | "vt" | "f" | "fo" | "p" | "l") {
            return self.read_numbers(keyword, words);
        }
        match keyword {
            "usemtl" => {
                let name = words.rest();
                let name = if name == "(null)" { "" } else { &name };
                self.use_material(name)?;
                Ok(())
            }
            "mtllib" => self.read_library(words),
            "curv" | "curv2" | "surf" => {
                let place = || format!("in line {}", words.line);
                self.mends.add(mends::CURVE_LEFT, 1, place);
                Ok(())
            }
            "#mrgb" => {
                self.polypaint.read(words);
                Ok(())
            }
            "call" | "usemap" => {
                self.leave_out_named(keyword, words);
                Ok(())
            }
            _ => {
                let is_word = keyword.starts_with(|it: char| it.is_alphabetic() || it == '#');
                let times = usize::from(!is_word && !keyword.starts_with("//"));
                let place = || format!("in line {}", words.line);
                self.mends.add(mends::LINE_BROKEN, times, place);
                Ok(())
            }
        }
    }

    fn read_face(&mut self, words: &mut Words<'_>) -> Result<(), Fault> {
        self.face.clear();
        let counts = [self.places.len(), self.uvs.len(), self.normals.len()];
        let mut before = "";
        while let Some(word) = words.next() {
            let corner = self.late.corner(word, counts);
            if !corner.is_lost() {
                self.face.push(corner);
            } else if !self.read_odd_corner([before, word], counts, words.line) {
                break;
            }
            before = word;
        }
        if self.face.len() < 3 {
            let place = || format!("in line {}", words.line);
            self.mends.add(mends::SHORT_FACE, 1, place);
            return Ok(());
        }
        let material = match self.material {
            Some(material) => material,
            None => self.use_material("")?,
        };
        match self.face.iter().all(|corner| corner.is_there(counts)) {
            true => self.add_face(material, words.line),
            false => {
                self.late.push(&self.face, material, words.line);
                Ok(())
            }
        }
    }

    /// Reads a word of a face that names no vertex, together with the word before. `false` where a
    /// comment begins.
    fn read_odd_corner(
        &mut self,
        [before, word]: [&str; 2],
        counts: [usize; 3],
        line: usize,
    ) -> bool {
        let is_number = |it: char| it.is_ascii_digit() || it == '-';
        if word.starts_with("//") && !word[2..].starts_with(is_number) {
            return false;
        }
        let is_part = word.starts_with('/') && !self.face.is_empty();
        let is_list = word.contains([',', ';', '(', ')', '\\']);
        let times = usize::from(is_part || is_list);
        self.mends
            .add(mends::FACE_SIGNS, times, || format!("in line {line}"));
        if is_part {
            self.face.pop();
        }
        let whole = if is_part {
            format!("{before}{word}")
        } else {
            word.to_owned()
        };
        let whole = whole.replace('\\', "/");
        let corners = whole
            .split([',', ';', '(', ')'])
            .filter(|it| !it.is_empty());
        self.face
            .extend(corners.map(|it| self.late.corner(it, counts)));
        true
    }

    /// Adds the face whose corners stand in `face`; left out if a vertex of it does not exist.
    fn add_face(&mut self, material: u32, line: usize) -> Result<(), Fault> {
        let place = || format!("in line {line}");
        let counts = [self.places.len(), self.uvs.len(), self.normals.len()];
        let mut lost = [0; 2];
        self.outline.clear();
        for at in 0..self.face.len() {
            let corner = self.face[at].of(counts, &mut lost);
            let Some(corner) = corner else {
                self.mends.add(mends::OUT_OF_RANGE, 1, place);
                return Ok(());
            };
            if self.vertices.len() >= MOST_VERTICES {
                let what = format!("there are more vertices than {MOST_VERTICES}");
                return Err(Fault::line(line, what));
            }
            let (vertex, is_new) = self.vertices.of(corner);
            if is_new {
                self.add_vertex(corner);
            }
            self.outline.push(vertex);
        }
        self.mends.add(mends::UV_NOT_FOUND, lost[0], place);
        self.mends.add(mends::NORMAL_NOT_FOUND, lost[1], place);
        self.polygons.add(&mut self.mesh.triangles, &self.outline);
        let triangles = self.mesh.triangles.len();
        self.mesh.materials.resize(triangles, material);
        Ok(())
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
            self.mesh.uvs.resize(vertices, NO_UV);
            let uv = uv.map_or(NO_UV, |uv| self.uvs[uv as usize]);
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
                if known.is_none() && !name.is_empty() {
                    self.lost_materials.push((name.to_owned(), number));
                }
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
        if whole.is_empty() {
            return Ok(());
        }
        if !self.libraries.insert(whole.clone()) {
            return Ok(());
        }
        if self.libraries.len() > MOST_LIBRARIES {
            let what = format!("more than {MOST_LIBRARIES} files of materials are named");
            return Err(Fault::line(words.line, what));
        }
        // Blanks may be part of one name, or separate several; quotes decide.
        match search::read(self.folder, &[words.rest_as_it_is(), &whole]) {
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
        let materials = self.library.materials.len();
        let file = file.and_then(|bytes| match mtl::is_text(&utf8_of(&bytes)) {
            true => Ok(bytes),
            false => Err(Fault::Missing {
                name: name.to_owned(),
                reason: "it is not text".to_owned(),
            }),
        });
        match file {
            Ok(bytes) => {
                for line in self.library.read(&utf8_of(&bytes), name) {
                    let place = || format!("in line {line} of {:?}", shortened(name));
                    self.mends.add(mends::LINE_BROKEN, 1, place);
                }
                if materials == 0 && self.library.materials.is_empty() {
                    let name = shortened(name);
                    let remark = format!("{name:?} has no materials (no `newmtl`)");
                    self.scene.remark(remark);
                }
            }
            Err(Fault::Missing { reason, .. }) => {
                let missing = "material_files_missing";
                if !self.scene.repairs.contains_key(missing) {
                    let name = shortened(name);
                    self.scene.remark(format!(
                        "the materials in \"{name}\", named in line {line}, cannot be read \
                         ({reason}): surfaces are white"
                    ));
                }
                count(&mut self.scene.repairs, missing, 1);
            }
            Err(fault) => return Err(fault),
        }
        Ok(())
    }

    /// Colours are codes of whatever depth all of them show.
    fn light_colours(&mut self, name: &str) {
        let full = self.colour_depth.full(1.0);
        let largest = full.largest() as f32;
        let mut strays = 0;
        for colours in [&mut self.place_colours, &mut self.mesh.colours] {
            for colour in colours.iter_mut().filter(|it| it[3] < 0.0) {
                *colour = [largest, largest, largest, 1.0];
            }
            strays = strays.max(lighten(colours, &full, 1.0));
        }
        let what = format!("vertices of {:?}", shortened(name));
        let counts = (self.place_colours.len(), strays);
        if let Some(remark) = full.tell(&what, counts, &mut self.scene.repairs) {
            self.scene.remark(remark);
        }
    }

    fn finish(mut self, name: &str) -> Result<SourceScene, Fault> {
        let mut late = std::mem::take(&mut self.late);
        while let Some((material, line)) = late.pop(&mut self.face) {
            self.add_face(material, line)?;
        }
        late.tell(&mut self.mends);
        self.find_library(name);
        self.find_materials();
        for (repair, times) in std::mem::take(&mut self.library.repairs) {
            count(&mut self.scene.repairs, &repair, times as usize);
        }
        let remarks = std::mem::take(&mut self.library.remarks);
        remarks.into_iter().for_each(|it| self.scene.remark(it));
        let mends = std::mem::take(&mut self.library.mends);
        mends.tell("materials", &mut self.scene);
        let polygons = std::mem::take(&mut self.polygons);
        polygons.fill(&mut self.mesh, &mut self.mends);
        self.show_colours_on_black();
        if !self.place_colours.is_empty() {
            self.light_colours(name);
        }
        self.paint();
        self.tell_what_is_not_shown();
        self.add_points(name);
        self.scene.objects.push(SourceObject {
            name: name.to_owned(),
            mesh: 0,
            placements: vec![DAffine3::IDENTITY],
        });
        self.scene.meshes.push(self.mesh);
        self.mends.tell(name, &mut self.scene);
        Ok(self.scene)
    }

    /// Adds the points that are shown, and counts the vertices that nothing shows.
    fn add_points(&mut self, name: &str) {
        let has_faces = self.mends.times(mends::OUT_OF_RANGE) > 0 || self.vertices.len() > 0;
        let points = std::mem::take(&mut self.points);
        let shown = points.shown(&self.places, has_faces, &mut self.mends);
        let mut used = vec![false; self.places.len()];
        for place in self.vertices.places().chain(shown.iter().copied()) {
            used[place as usize] = true;
        }
        let unused = used.iter().filter(|used| !**used).count();
        count(&mut self.scene.repairs, "unused_vertices", unused);
        if !shown.is_empty() {
            let colours = points::colours(&shown, &self.place_colours, &mut self.mends);
            let place = |it: &u32| self.places[*it as usize];
            let positions: Vec<DVec3> = shown.iter().map(place).collect();
            let clouds = outliers::clouds(name, &positions, colours, &mut self.scene);
            self.scene.clouds.extend(clouds);
        }
    }

    /// Reads the file of materials next to this one, by its name, where faces name materials and no
    /// file has any.
    fn find_library(&mut self, name: &str) {
        if self.lost_materials.is_empty() || !self.library.materials.is_empty() {
            return;
        }
        let name = format!("{name}.mtl");
        if self.libraries.contains(&name) {
            return;
        }
        let Ok(bytes) = search::read(self.folder, &[&name]) else {
            return;
        };
        let text = utf8_of(&bytes);
        if mtl::is_text(&text) && !self.library.read(&text, &name).is_empty() {
            self.mends.add(mends::LINE_BROKEN, 1, || {
                format!("in {:?}", shortened(&name))
            });
        }
        if !self.library.materials.is_empty() {
            count(&mut self.scene.repairs, "files_found_elsewhere", 1);
            self.scene.remark(format!(
                "no file of materials is named that exists: {:?}, which lies next to the model, is \
                 used",
                shortened(&name)
            ));
        }
    }

    /// Looks up materials again that were named before the file that has them, or with a comment.
    fn find_materials(&mut self) {
        let lost = std::mem::take(&mut self.lost_materials);
        let mut near: HashMap<String, String> = HashMap::new();
        if !lost.is_empty() {
            let mut names: Vec<&String> = self.library.materials.keys().collect();
            names.sort_unstable();
            for name in names {
                near.entry(mtl::alike(name)).or_insert_with(|| name.clone());
            }
        }
        for (name, number) in lost {
            let bare = name.split_once('#').map_or("", |(bare, _)| bare.trim_end());
            let known = |name: &str| Some((name.to_owned(), self.library.materials.get(name)?));
            let mut found = known(&name).or_else(|| known(bare));
            if found.is_none() {
                found = near.get(&mtl::alike(&name)).and_then(|it| known(it));
                let place = || format!("is {:?}", shortened(&name));
                let times = usize::from(found.is_some());
                self.mends.add(mends::MATERIAL_NEARLY, times, place);
            }
            match found {
                Some((name, material)) => {
                    let material = material.clone();
                    let texture = self.texture(&name);
                    self.scene.materials[number as usize] = Material {
                        texture,
                        ..material
                    };
                }
                None => {
                    let place = || format!("is {:?}", shortened(&name));
                    self.mends.add(mends::MATERIAL_NOT_FOUND, 1, place);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_of_looks;
