//! Which triangles is a glTF mesh made of?

use std::collections::HashMap;

use glam::DVec3;

use super::super::colour::Depth;
use super::super::error::Fault;
use super::super::mends::{
    ATTRIBUTE_LEFT, ATTRIBUTE_LENGTH, COLOUR_MADE, FAN_FILLED, MATERIAL_NOT_FOUND, Mends,
    PART_LEFT, POINT_WITHOUT_PLACE, RESTARTED, SHAPE_LEFT, TEXTURE_WITHOUT_UVS,
};
use super::super::outliers;
use super::super::polygon::{Filler, Filling, tell};
use super::super::sound::count;
use super::accessor::{Accessors, BREAK, LOST};
use super::json::{GltfAttributes, Primitive};
use crate::build::codes_from_linear;
use crate::source::{Repairs, SourceCloud, SourceMesh, SourceScene};

/// How many vertices and corners may be made of each byte of the buffers. Eight-bit strips give
/// one, and files of people a tenth; so meshes may show the same bytes some ten times.
const MOST_PER_BYTE: usize = 2;
/// So many may be made of whatever bytes.
const MOST_FREE: usize = 1 << 18;
/// Least bytes of each that was unpacked: of indices.
const LEAST_UNPACKED: usize = 2;

/// Reads meshes, all parts of one into one.
pub(super) struct MeshReader<'a> {
    pub(super) accessors: &'a Accessors<'a>,
    /// For each material, whether its alpha has no meaning.
    pub(super) opaque: Vec<bool>,
    /// For each material the set of places on textures that it takes.
    pub(super) uv_sets: Vec<Option<u32>>,
    /// The number of the material of parts that have none.
    pub(super) without_material: u32,
    pub(super) repairs: Repairs,
    /// What a person should know of meshes.
    pub(super) remarks: Vec<String>,
    pub(super) mends: Mends,
    /// Fills outlines that other programs wrote as fans.
    pub(super) filler: Filler,
    /// The colour of each material.
    pub(super) factors: Vec<[f32; 4]>,
    /// The points of the mesh that was read last.
    pub(super) points: MeshPoints,
    /// Vertices and corners that were read.
    pub(super) spent: usize,
    /// Whether they were too many for the file.
    pub(super) is_spent: bool,
    /// Why the first part that was left out cannot be read.
    pub(super) first_fault: Option<Fault>,
}

/// Points of a mesh: where they lie, and their colours in linear light.
#[derive(Default)]
pub(super) struct MeshPoints {
    positions: Vec<DVec3>,
    colours: Vec<[f32; 4]>,
}

impl MeshPoints {
    /// Takes away those after the first ones.
    fn cut(&mut self, points: usize) {
        self.positions.truncate(points);
        self.colours.truncate(points);
    }

    /// As clouds; none where there are no points.
    pub(super) fn clouds(&self, name: &str, scene: &mut SourceScene) -> Vec<SourceCloud> {
        if self.positions.is_empty() {
            return Vec::new();
        }
        let has_colours = self.colours.iter().any(|it| *it != WHITE);
        let code = |it: &[f32; 4]| {
            let [red, green, blue, _] = codes_from_linear(*it);
            [red, green, blue].map(|it| u16::from(it) * 257)
        };
        let colours: Vec<[u16; 3]> = match has_colours {
            true => self.colours.iter().map(code).collect(),
            false => Vec::new(),
        };
        outliers::clouds(name, &self.positions, colours, scene)
    }
}

/// What vertices are made of; parts with the same share them.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
struct Streams {
    positions: u32,
    normals: Option<u32>,
    colours: Option<u32>,
    uvs: Option<u32>,
    opaque: bool,
}

/// Where the vertices of some streams are in a mesh.
#[derive(Clone, Copy)]
struct Vertices {
    first: usize,
    count: usize,
}

impl MeshReader<'_> {
    /// Why the first part, or else the first buffer, that is not there cannot be read.
    pub(super) fn fault(&mut self) -> Option<Fault> {
        let of_part = self.first_fault.take();
        of_part.or_else(|| self.accessors.buffers.first_fault())
    }

    /// Reads mesh `number`, which exists; it may have no triangle. Parts that cannot be read are
    /// left out; a mesh that claims far more than the file has is refused.
    pub(super) fn read(&mut self, number: u32) -> Result<SourceMesh, Fault> {
        let said = &self.accessors.document.meshes[number as usize];
        self.points = MeshPoints::default();
        let mut mesh = SourceMesh::default();
        let mut met = HashMap::new();
        for (index, primitive) in said.primitives.iter().enumerate() {
            let place = format!("mesh {number}, primitive {index}");
            let before = Lengths::of(&mesh);
            let points = self.points.positions.len();
            match self.add(&mut mesh, &mut met, (primitive, &said.weights), &place) {
                Ok(()) => {}
                Err(fault) if self.is_spent => return Err(fault),
                Err(fault) => {
                    before.cut(&mut mesh);
                    let there = mesh.positions.len();
                    met.retain(|_, it| it.first + it.count <= there);
                    self.points.cut(points);
                    let what = fault.clone().told();
                    self.mends
                        .add(PART_LEFT, 1, || format!("is {place} ({what})"));
                    self.first_fault.get_or_insert(fault);
                }
            }
        }
        Ok(mesh)
    }

    fn add(
        &mut self,
        mesh: &mut SourceMesh,
        met: &mut HashMap<Streams, Vertices>,
        (primitive, weights): (&Primitive, &[f64]),
        place: &str,
    ) -> Result<(), Fault> {
        if let Some(fault) = &primitive.broken {
            return Err(Fault::clone(fault));
        }
        let said = primitive.material.unwrap_or(self.without_material);
        let is_lost = said > self.without_material;
        self.mends
            .add(MATERIAL_NOT_FOUND, usize::from(is_lost), || {
                format!("is {said}, in {place}")
            });
        let material = said.min(self.without_material);
        let opaque = self.opaque[material as usize];
        let uv_set = self.uv_sets.get(material as usize).copied().flatten();
        let Some(positions) = primitive.attributes.position else {
            count(&mut self.repairs, "primitives_without_positions", 1);
            return Ok(());
        };
        let streams = Streams {
            positions,
            normals: primitive.attributes.normal,
            colours: primitive.attributes.colour,
            uvs: uv_set.and_then(|set| primitive.attributes.uvs(set)),
            opaque,
        };
        let is_bare = uv_set.is_some() && streams.uvs.is_none();
        self.mends
            .add(TEXTURE_WITHOUT_UVS, usize::from(is_bare), || {
                let set = uv_set.unwrap_or(0);
                format!("is {place}, which has no TEXCOORD_{set}")
            });
        if primitive.mode == Some(POINTS) {
            return self.add_points(primitive, (streams, material), place);
        }
        // Parts with other shapes have other vertices at rest.
        let moves = moves(primitive, weights);
        let known = met.get(&streams).filter(|_| moves.is_empty());
        let vertices = match known {
            Some(vertices) => *vertices,
            None => {
                let vertices = self.add_vertices(mesh, streams, place)?;
                self.add_shapes(mesh, vertices, &moves, place)?;
                vertices
            }
        };
        if moves.is_empty() {
            met.insert(streams, vertices);
        }
        let corners = self.corners(primitive, vertices, place)?;
        let before = mesh.triangles.len();
        let mode = primitive.mode.unwrap_or(4);
        for part in corners.split(|corner| *corner == BREAK) {
            if mode != FAN || !self.add_outline(mesh, part, place) {
                self.add_triangles(mesh, part, mode)
                    .map_err(|what| Fault::at(place, what))?;
            }
        }
        let added = mesh.triangles.len() - before;
        mesh.materials.extend(std::iter::repeat_n(material, added));
        Ok(())
    }

    /// Adds the points of a part.
    fn add_points(
        &mut self,
        primitive: &Primitive,
        (streams, material): (Streams, u32),
        place: &str,
    ) -> Result<(), Fault> {
        let mut vertices = SourceMesh::default();
        let bare = Streams {
            normals: None,
            ..streams
        };
        let added = self.add_vertices(&mut vertices, bare, place)?;
        let corners = self.corners(primitive, added, place)?;
        let factor = self.factors.get(material as usize).copied();
        let factor = factor.unwrap_or(WHITE);
        for corner in corners.into_iter().filter(|it| *it != BREAK) {
            let corner = corner as usize;
            let position = vertices.positions.get(corner).copied();
            let Some(position) = position.filter(|it| it.is_finite()) else {
                self.mends
                    .add(POINT_WITHOUT_PLACE, 1, || format!("in {place}"));
                continue;
            };
            let mut colour = vertices.colours.get(corner).copied().unwrap_or(WHITE);
            if colour.iter().any(|part| part.is_nan()) {
                self.mends.add(COLOUR_MADE, 1, || format!("in {place}"));
                colour = WHITE;
            }
            let colour = [0, 1, 2, 3].map(|k| factor[k] * colour[k]);
            self.points.positions.push(position);
            self.points.colours.push(colour);
        }
        Ok(())
    }

    /// Adds the triangles of an outline that a fan does not fill; `false` if it does. The fan of a
    /// convex outline, or round a corner in its middle, is what glTF says it is; but other programs
    /// write concave faces so, too, of which some triangles would turn back over others.
    fn add_outline(&mut self, mesh: &mut SourceMesh, corners: &[u32], place: &str) -> bool {
        let positions = corners.iter().map(|it| mesh.positions.get(*it as usize));
        let positions: Option<Vec<DVec3>> = positions.map(Option::<&DVec3>::copied).collect();
        let finite = |all: &Vec<DVec3>| all.len() > 3 && all.iter().all(|it| it.is_finite());
        let Some(outline) = positions.filter(finite) else {
            return false;
        };
        let (filling, triangles) = self.filler.fill(&outline);
        tell(filling, &mut self.mends, || format!("in {place}"));
        let named = triangles.iter().map(|it| it.map(|at| corners[at as usize]));
        mesh.triangles.extend(named);
        let is_cut = usize::from(filling == Filling::Cut);
        self.mends.add(FAN_FILLED, is_cut, || format!("in {place}"));
        !triangles.is_empty()
    }

    /// Counts what is to be read, so that a small file cannot become a large scene.
    fn spend(&mut self, elements: u64, place: &str) -> Result<(), Fault> {
        let elements = usize::try_from(elements).unwrap_or(usize::MAX);
        self.spent = self.spent.saturating_add(elements);
        let bytes = self.accessors.buffers.total;
        let unpacked = self.accessors.buffers.unpacked as usize;
        let most = bytes.saturating_mul(MOST_PER_BYTE);
        let most = most.saturating_add(MOST_FREE + unpacked / LEAST_UNPACKED);
        if self.spent <= most {
            return Ok(());
        }
        self.is_spent = true;
        let what = format!(
            "{} vertices and corners are made of only {bytes} bytes up to here",
            self.spent
        );
        let next = "let nodes show the same mesh instead of meshes that differ in their materials";
        Err(Fault::broken(place, what, next))
    }

    fn add_vertices(
        &mut self,
        mesh: &mut SourceMesh,
        streams: Streams,
        place: &str,
    ) -> Result<Vertices, Fault> {
        let first = mesh.positions.len();
        self.spend(self.accessors.count(streams.positions)?, place)?;
        let positions = self.accessors.rows::<3>(streams.positions, &[3])?;
        let count = positions.len();
        if u32::try_from(first + count).is_err() {
            return Err(Fault::at(
                place,
                "the mesh has more vertices than 4294967295",
            ));
        }
        let (normals, colours, uvs) = self.beside_places(streams, count, place)?;
        mesh.positions
            .extend(positions.into_iter().map(DVec3::from_array));
        if let Some(normals) = normals {
            // Those without one are made of the triangles around them.
            mesh.normals.resize(first, [0.0; 3]);
            mesh.normals.extend(normals);
        }
        if let Some(colours) = colours {
            mesh.colours.resize(first, WHITE);
            mesh.colours.extend(colours);
        }
        if let Some(uvs) = uvs {
            mesh.uvs.resize(first, [0.0; 2]);
            mesh.uvs.extend(uvs);
        }
        fill(&mut mesh.normals, first + count, [0.0; 3]);
        fill(&mut mesh.uvs, first + count, [0.0; 2]);
        fill(&mut mesh.colours, first + count, WHITE);
        Ok(Vertices { first, count })
    }

    /// Moves vertices as the shapes of a mesh at rest do.
    fn add_shapes(
        &mut self,
        mesh: &mut SourceMesh,
        vertices: Vertices,
        moves: &[(&GltfAttributes, f64)],
        place: &str,
    ) -> Result<(), Fault> {
        let Vertices { first, count } = vertices;
        for (shape, weight) in moves {
            for number in [shape.position, shape.normal].into_iter().flatten() {
                self.spend(self.accessors.count(number).unwrap_or(0), place)?;
            }
            let steps = |number: Option<u32>| {
                let fits = number.map(|it| self.accessors.count(it)) == Some(Ok(count as u64));
                let rows = number.filter(|_| fits);
                rows.and_then(|it| self.accessors.rows::<3>(it, &[3]).ok())
            };
            let (places, normals) = (steps(shape.position), steps(shape.normal));
            let lost = [
                shape.position.is_some() && places.is_none(),
                shape.normal.is_some() && normals.is_none(),
            ];
            let lost = lost.iter().filter(|it| **it).count();
            self.mends.add(SHAPE_LEFT, lost, || format!("in {place}"));
            if let Some(steps) = places {
                for (position, step) in mesh.positions[first..].iter_mut().zip(steps) {
                    *position += DVec3::from_array(step) * *weight;
                }
            }
            if let (Some(steps), false) = (normals, mesh.normals.is_empty()) {
                for (normal, step) in mesh.normals[first..].iter_mut().zip(steps) {
                    *normal = [0, 1, 2].map(|k| normal[k] + (step[k] * *weight) as f32);
                }
            }
        }
        Ok(())
    }

    /// What vertices have besides a place, one of each a vertex; what cannot be read is left out.
    fn beside_places(
        &mut self,
        streams: Streams,
        count: usize,
        place: &str,
    ) -> Result<BesidePlaces, Fault> {
        let lists = [streams.normals, streams.colours, streams.uvs];
        for number in lists.into_iter().flatten() {
            let found = self.accessors.count(number).unwrap_or(0);
            self.spend(found.saturating_sub(count as u64), place)?;
        }
        let lone = [f32::NAN; 2];
        let normals = streams.normals.map(|it| self.normals(it));
        let normals = self.fitting(normals, (count, [0.0; 3]), place);
        let colours = streams.colours.map(|it| self.colours(it, streams.opaque));
        let colours = self.fitting(colours, (count, WHITE), place);
        let uvs = streams.uvs.map(|it| self.uvs(it));
        Ok((normals, colours, self.fitting(uvs, (count, lone), place)))
    }

    /// A list of one a vertex, of one that may be longer or shorter.
    fn fitting<T: Clone>(
        &mut self,
        read: Option<Result<Vec<T>, Fault>>,
        (count, without): (usize, T),
        place: &str,
    ) -> Option<Vec<T>> {
        match read? {
            Ok(mut list) => {
                let length = list.len();
                let is_odd = usize::from(length != count);
                self.mends.add(ATTRIBUTE_LENGTH, is_odd, || {
                    format!("in {place}, of {length} for {count} vertices")
                });
                list.resize(count, without);
                Some(list)
            }
            Err(fault) => {
                let what = fault.told();
                self.mends
                    .add(ATTRIBUTE_LEFT, 1, || format!("in {place} ({what})"));
                None
            }
        }
    }

    fn normals(&self, number: u32) -> Result<Vec<[f32; 3]>, Fault> {
        let normals = self.accessors.rows::<3>(number, &[3])?.into_iter();
        Ok(normals
            .map(|normal| normal.map(|along| along as f32))
            .collect())
    }

    fn uvs(&self, number: u32) -> Result<Vec<[f32; 2]>, Fault> {
        let uvs = self.accessors.rows::<2>(number, &[2])?;
        let of_file = uvs.into_iter().map(|uv| uv.map(|along| along as f32));
        Ok(of_file.collect())
    }

    fn colours(&mut self, number: u32, opaque: bool) -> Result<Vec<[f32; 4]>, Fault> {
        let mut colours = self.accessors.rows::<4>(number, &[3, 4])?;
        let mut usual = self.accessors.full_light(number)?;
        let is_said = usual <= 1.0;
        // Sixteen bits may hold codes of fewer bits.
        if let Some(full) = self.accessors.full_code(number) {
            usual = full;
            let code = |it: &mut f64| *it = (*it * full).round();
            colours.as_flattened_mut().iter_mut().for_each(code);
        }
        let mut depth = Depth::default();
        for colour in &colours {
            depth.add([colour[0], colour[1], colour[2]]);
        }
        let full = depth.full(usual);
        let has_alpha = self.accessors.get(number)?.shape == "VEC4";
        let strays = colours
            .iter()
            .filter(|it| full.is_stray([it[0], it[1], it[2]]));
        let strays = strays.count();
        let what = format!("vertices (accessor {number})");
        if !is_said {
            count(&mut self.repairs, "colours_not_normalised", colours.len());
            self.remarks.push(format!(
                "colours of {what} are whole numbers that are not said to be parts of 1: {} \
                 counts as full light",
                full.largest()
            ));
        } else {
            let remark = full.tell(&what, (colours.len(), strays), &mut self.repairs);
            self.remarks.extend(remark);
        }
        let light = |[red, green, blue, alpha]: [f64; 4]| {
            let [red, green, blue] = full.shares([red, green, blue]);
            let alpha = match opaque || !has_alpha {
                true => 1.0,
                false => alpha / if usual > 1.0 { full.largest() } else { 1.0 },
            };
            [red, green, blue, alpha].map(|part| part.clamp(0.0, 1.0) as f32)
        };
        Ok(colours.into_iter().map(light).collect())
    }

    /// The vertices of the mesh that a part names, in its order.
    fn corners(
        &mut self,
        primitive: &Primitive,
        vertices: Vertices,
        place: &str,
    ) -> Result<Vec<u32>, Fault> {
        let first = vertices.first as u32;
        let Some(number) = primitive.indices else {
            self.spend(vertices.count as u64, place)?;
            return Ok((first..first + vertices.count as u32).collect());
        };
        self.spend(self.accessors.count(number)?, place)?;
        let mut corners = self.accessors.indices(number)?;
        let largest = self.accessors.largest_index(number)?;
        let is_there = |index: u32| (index as usize) < vertices.count;
        let is_end = |index: &u32| [largest, BREAK].contains(index);
        let breaks = match primitive.mode.unwrap_or(4) {
            STRIP | FAN => true,
            // In lists it may be a mistake, which costs one triangle.
            4 => corners.split(is_end).all(|it| it.len() % 3 == 0) && !is_there(largest),
            _ => !is_there(largest),
        };
        let mut ends = 0;
        for corner in &mut corners {
            let ends_here = breaks && is_end(corner);
            ends += usize::from(ends_here);
            *corner = match *corner {
                _ if ends_here => BREAK,
                index if is_there(index) => index + first,
                // An invalid one is left out with its triangle.
                _ => LOST,
            };
        }
        self.mends.add(RESTARTED, ends, || format!("in {place}"));
        Ok(corners)
    }

    fn add_triangles(
        &mut self,
        mesh: &mut SourceMesh,
        corners: &[u32],
        mode: u32,
    ) -> Result<(), String> {
        let triangles = &mut mesh.triangles;
        let left_out = &mut self.repairs;
        match mode {
            1 => count(left_out, "lines_left_out", corners.len() / 2),
            2 => count(left_out, "lines_left_out", corners.len()),
            3 => count(left_out, "lines_left_out", corners.len().saturating_sub(1)),
            4 => {
                let (whole, rest) = corners.as_chunks();
                triangles.extend_from_slice(whole);
                count(left_out, "corners_left_out", rest.len());
            }
            STRIP => {
                let all = corners.windows(3).enumerate();
                triangles.extend(all.map(|(index, at)| match index % 2 {
                    0 => [at[0], at[1], at[2]],
                    _ => [at[0], at[2], at[1]],
                }));
            }
            FAN => {
                if let [middle, rim @ ..] = corners {
                    let all = rim.windows(2);
                    triangles.extend(all.map(|edge| [edge[0], edge[1], *middle]));
                }
            }
            _ => return Err(format!("its mode is {mode}, which does not exist")),
        }
        Ok(())
    }
}

/// Normals, colours and places on textures.
type BesidePlaces = (
    Option<Vec<[f32; 3]>>,
    Option<Vec<[f32; 4]>>,
    Option<Vec<[f32; 2]>>,
);

/// How long the lists of a mesh are.
struct Lengths([usize; 6]);

impl Lengths {
    fn of(mesh: &SourceMesh) -> Self {
        Self([
            mesh.positions.len(),
            mesh.normals.len(),
            mesh.colours.len(),
            mesh.uvs.len(),
            mesh.triangles.len(),
            mesh.materials.len(),
        ])
    }

    /// Takes away what was added since.
    fn cut(&self, mesh: &mut SourceMesh) {
        mesh.positions.truncate(self.0[0]);
        mesh.normals.truncate(self.0[1]);
        mesh.colours.truncate(self.0[2]);
        mesh.uvs.truncate(self.0[3]);
        mesh.triangles.truncate(self.0[4]);
        mesh.materials.truncate(self.0[5]);
    }
}

/// The shapes that a part has at rest, and how much of each.
fn moves<'a>(primitive: &'a Primitive, weights: &[f64]) -> Vec<(&'a GltfAttributes, f64)> {
    let all = primitive.targets.iter().zip(weights.iter().copied());
    all.filter(|(_, weight)| *weight != 0.0).collect()
}

/// The modes of parts that are points, a strip or a fan.
const POINTS: u32 = 0;
const STRIP: u32 = 5;
const FAN: u32 = 6;
const WHITE: [f32; 4] = [1.0; 4];

/// Fills up a list that is not empty.
fn fill<T: Clone>(list: &mut Vec<T>, length: usize, with: T) {
    if !list.is_empty() {
        list.resize(length, with);
    }
}
