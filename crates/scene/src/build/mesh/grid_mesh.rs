//! Where on the grid of its object does a mesh lie?
//!
//! All that follows is about the mesh on the grid: its errors, too, are measured from there.

use crate::build::built::BuildError;
use crate::build::numbering::IntegerMap;
use crate::build::textures::{MeshTexturing, ShownImages};
use crate::source::{Material, SourceMesh, SourceObject, SourceScene};
use foveal_core::content::mesh::octahedral::octahedral_from_direction;
use foveal_core::content::mesh::payload::{Attributes, MeshVertex, NO_TEXTURE};
use foveal_core::content::scene::description::{Grid, ObjectBounds, SceneObject, Shape};
use glam::{DVec2, DVec3};

/// A mesh on the grid of its object.
#[derive(Clone, Debug)]
pub(in crate::build) struct GridMesh {
    /// The object that shows it.
    pub object: SceneObject,
    /// The names of the parts that it was joined of; none where it is one by itself.
    pub parts: Vec<String>,
    /// Its vertices, each value once.
    pub vertices: Vec<MeshVertex>,
    /// For each vertex the first that has the same place.
    pub same_place: Vec<u32>,
    /// Triangles with three different places.
    pub triangles: Vec<[u32; 3]>,
    /// Number of triangles that were left out, since two of their places are one.
    pub zero_area: u64,
    /// Places of the grid that a step on the grid of textures spans along each axis, on average.
    pub places_of_uv: [f32; 2],
}

/// Puts the mesh of an object on a grid.
pub(in crate::build) fn grid_mesh(
    source: &SourceScene,
    object: &SourceObject,
    bits: u8,
    shown: &ShownImages,
) -> Result<GridMesh, BuildError> {
    let wrong = |what| BuildError::Source {
        object: object.name.clone(),
        what,
    };
    let mesh = source.meshes.get(object.mesh);
    let mesh = mesh.ok_or_else(|| wrong("mesh out of range"))?;
    check(source, mesh).map_err(wrong)?;
    if object.placements.is_empty() {
        return Err(wrong("no placement"));
    }
    let grid = grid_of(&mesh.positions, bits);
    let looks = Looks::of(source, mesh, shown);
    let mut welder = Welder::new(mesh, grid, &looks);
    let mut zero_area = 0;
    let mut triangles = Vec::with_capacity(mesh.triangles.len());
    for (number, corners) in mesh.triangles.iter().enumerate() {
        let material = mesh.materials.get(number).copied().unwrap_or(0);
        let welded = corners.map(|corner| welder.weld(corner, material));
        let [a, b, c] = welded.map(|it| welder.vertices[it as usize].place);
        match a == b || b == c || c == a {
            true => zero_area += 1,
            false => triangles.push(welded),
        }
    }
    let placements = object.placements.iter();
    let object = SceneObject {
        name: object.name.clone(),
        shape: Shape::Mesh {
            leaf_triangles: triangles.len() as u64,
        },
        bounds: bounds_of(&welder.vertices, &grid),
        grid,
        attributes: looks.attributes,
        colour: looks.colour,
        two_sided: looks.two_sided,
        unlit: looks.unlit,
        placements: placements.map(glam::DAffine3::to_cols_array).collect(),
        texturing: looks.texturing.as_ref().map(|it| it.texturing.clone()),
    };
    Ok(GridMesh {
        places_of_uv: places_of_uv(&object, &welder.vertices, &triangles),
        object,
        parts: Vec::new(),
        same_place: same_place(&welder.vertices),
        vertices: welder.vertices,
        triangles,
        zero_area,
    })
}

impl GridMesh {
    /// Centre and radius of the sphere round the mesh, in steps of the grid.
    pub(in crate::build) fn sphere_on_grid(&self) -> (DVec3, f64) {
        let (grid, bounds) = (&self.object.grid, &self.object.bounds);
        let centre = DVec3::from_array(bounds.centre) - DVec3::from_array(grid.origin);
        (centre / grid.step, bounds.radius / grid.step)
    }

    /// Makes the sphere round the mesh enclose the vertices from this one on.
    pub(in crate::build) fn reach_all(&mut self, first: usize) {
        let bounds = &mut self.object.bounds;
        let centre = DVec3::from_array(bounds.centre);
        for vertex in &self.vertices[first..] {
            let away = self.object.grid.at(vertex.place).distance(centre);
            bounds.radius = bounds.radius.max(away);
        }
    }
}

/// How many places of the grid a step on the grid of textures spans.
fn places_of_uv(object: &SceneObject, vertices: &[MeshVertex], triangles: &[[u32; 3]]) -> [f32; 2] {
    let Some(texturing) = &object.texturing else {
        return [0.0; 2];
    };
    let step = DVec2::from_array(texturing.step);
    let (mut in_space, mut on_texture) = (0.0, 0.0);
    for corners in triangles {
        let [a, b, c] = corners.map(|it| &vertices[it as usize]);
        let place = |it: &MeshVertex| DVec3::from_array(it.place.map(f64::from));
        let uv = |it: &MeshVertex| DVec2::from_array(it.uv.map(f64::from)) * step;
        let area = (uv(b) - uv(a)).perp_dot(uv(c) - uv(a)).abs();
        if a.texture != NO_TEXTURE && area > 0.0 {
            on_texture += area;
            in_space += (place(b) - place(a)).cross(place(c) - place(a)).length();
        }
    }
    let places = if on_texture > 0.0 {
        (in_space / on_texture).sqrt()
    } else {
        0.0
    };
    (places * step).to_array().map(|it| it as f32)
}

/// What is wrong with a mesh.
pub(in crate::build) fn check(source: &SourceScene, mesh: &SourceMesh) -> Result<(), &'static str> {
    let count = mesh.positions.len();
    let fits = |length: usize, all: usize| length == 0 || length == all;
    if u32::try_from(count).is_err() || u32::try_from(3 * mesh.triangles.len()).is_err() {
        return Err("more than 4 thousand million vertices");
    }
    let lists = [mesh.normals.len(), mesh.colours.len(), mesh.uvs.len()];
    if !lists.iter().all(|length| fits(*length, count)) {
        return Err("not one normal, colour and place on textures a vertex");
    }
    if !fits(mesh.materials.len(), mesh.triangles.len()) {
        return Err("not one material a triangle");
    }
    let beyond = |corner: &u32| *corner as usize >= count;
    if mesh.triangles.as_flattened().iter().any(beyond) {
        return Err("vertex of a triangle out of range");
    }
    let beyond = |material: &u32| *material as usize >= source.materials.len();
    if mesh.materials.iter().any(beyond) {
        return Err("material of a triangle out of range");
    }
    // Such that neither an extent nor its square overflows.
    let is_near = |it: &DVec3| it.is_finite() && it.abs().max_element() <= 1e15;
    match mesh.positions.iter().all(is_near) {
        true => Ok(()),
        false => Err("position that is not finite, or beyond 1e15"),
    }
}

/// The grid with so many bits along the largest extent.
fn grid_of(positions: &[DVec3], bits: u8) -> Grid {
    let none = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (least, most) = positions
        .iter()
        .fold(none, |(least, most), it| (least.min(*it), most.max(*it)));
    let extent = (most - least).max_element();
    // An even number: the middle of a symmetric mesh, where seams often lie, is a place, and no
    // rounding parts what meets there.
    let steps = f64::from((1_u32 << bits) - 2);
    let is_extended = extent / steps > 0.0 && extent.is_finite();
    Grid {
        origin: if positions.is_empty() {
            [0.0; 3]
        } else {
            least.to_array()
        },
        step: if is_extended { extent / steps } else { 1.0 },
        bits,
    }
}

/// For each vertex the first with the same place.
fn same_place(vertices: &[MeshVertex]) -> Vec<u32> {
    let mut first = IntegerMap::default();
    first.reserve(vertices.len());
    let places = vertices.iter().zip(0_u32..);
    let first = places.map(|(vertex, number)| *first.entry(place_of(vertex)).or_insert(number));
    first.collect()
}

/// The vertices of a mesh by their values, and by their places.
pub(in crate::build) struct KnownVertices {
    of_value: IntegerMap<(u128, u64), u32>,
    of_place: IntegerMap<u64, u32>,
}

impl KnownVertices {
    pub(in crate::build) fn of(mesh: &GridMesh) -> Self {
        let mut known = Self {
            of_value: IntegerMap::default(),
            of_place: IntegerMap::default(),
        };
        for (vertex, number) in mesh.vertices.iter().zip(0..) {
            known.of_value.entry(key(vertex)).or_insert(number);
            known.of_place.entry(place_of(vertex)).or_insert(number);
        }
        known
    }

    /// The number of a vertex; added to the mesh if it has none of this value.
    pub(in crate::build) fn number(&mut self, mesh: &mut GridMesh, vertex: MeshVertex) -> u32 {
        let next = mesh.vertices.len() as u32;
        let number = *self.of_value.entry(key(&vertex)).or_insert(next);
        if number == next {
            let first = *self.of_place.entry(place_of(&vertex)).or_insert(next);
            mesh.vertices.push(vertex);
            mesh.same_place.push(first);
        }
        number
    }
}

/// The place of a vertex as one number.
fn place_of(vertex: &MeshVertex) -> u64 {
    // The place lies in the low bits.
    key(vertex).0 as u64 & ((1 << 48) - 1)
}

/// All of a vertex in two numbers.
fn key(vertex: &MeshVertex) -> (u128, u64) {
    let [x, y, z] = vertex.place.map(u128::from);
    let [u, v] = vertex.normal.map(|it| u128::from(it as u8));
    let colour = u128::from(u32::from_le_bytes(vertex.colour));
    let rest = x | y << 16 | z << 32 | u << 48 | v << 56 | colour << 64;
    let [u, v] = vertex.uv.map(u64::from);
    (rest, u | v << 16 | u64::from(vertex.texture) << 32)
}

/// What the surface of a mesh looks like.
struct Looks<'a> {
    materials: &'a [Material],
    attributes: Attributes,
    colour: [f32; 4],
    two_sided: bool,
    unlit: bool,
    texturing: Option<MeshTexturing<'a>>,
}

impl<'a> Looks<'a> {
    fn of(source: &'a SourceScene, mesh: &SourceMesh, shown: &ShownImages) -> Self {
        let materials = &source.materials[..];
        let first = mesh.materials.first().copied().unwrap_or(0);
        let mut used = vec![first];
        used.extend(mesh.materials.iter().copied().filter(|it| *it != first));
        used.sort_unstable();
        used.dedup();
        let used = used.iter().filter_map(|it| materials.get(*it as usize));
        let colour = used.clone().next().map_or([1.0; 4], |it| it.colour);
        let texturing = MeshTexturing::of(source, mesh, shown);
        let is_plain = mesh.colours.is_empty() && used.clone().all(|it| it.colour == colour);
        Self {
            materials,
            attributes: Attributes {
                normals: !mesh.normals.is_empty(),
                colours: !is_plain,
                textured: texturing.is_some(),
            },
            colour: if is_plain {
                colour.map(|it| it.clamp(0.0, 1.0))
            } else {
                [1.0; 4]
            },
            two_sided: used.clone().any(|it| it.two_sided),
            unlit: used.clone().any(|it| it.unlit),
            texturing,
        }
    }
}

/// Makes vertices that are equal on the grid one.
struct Welder<'a> {
    mesh: &'a SourceMesh,
    grid: Grid,
    looks: &'a Looks<'a>,
    /// The vertices of the mesh as they were last welded: the material, and the number.
    last: Vec<Option<(u32, u32)>>,
    numbers: IntegerMap<(u128, u64), u32>,
    vertices: Vec<MeshVertex>,
}

impl<'a> Welder<'a> {
    fn new(mesh: &'a SourceMesh, grid: Grid, looks: &'a Looks<'a>) -> Self {
        Self {
            mesh,
            grid,
            looks,
            last: vec![None; mesh.positions.len()],
            numbers: IntegerMap::default(),
            vertices: Vec::with_capacity(mesh.positions.len()),
        }
    }

    /// The number of the vertex that a corner of a triangle of a material becomes.
    fn weld(&mut self, corner: u32, material: u32) -> u32 {
        let at = corner as usize;
        if let Some((before, number)) = self.last[at]
            && before == material
        {
            return number;
        }
        let vertex = self.vertex(at, material);
        let next = self.vertices.len() as u32;
        let number = *self.numbers.entry(key(&vertex)).or_insert(next);
        if number == next {
            self.vertices.push(vertex);
        }
        self.last[at] = Some((material, number));
        number
    }

    fn vertex(&self, at: usize, material: u32) -> MeshVertex {
        let steps =
            (self.mesh.positions[at] - DVec3::from_array(self.grid.origin)) / self.grid.step;
        let normal = self.mesh.normals.get(at);
        let colour = self.looks.attributes.colours.then(|| {
            let material = self.looks.materials.get(material as usize);
            let material = material.map_or([1.0; 4], |it| it.colour);
            let vertex = self.mesh.colours.get(at).copied().unwrap_or([1.0; 4]);
            codes_from_linear([0, 1, 2, 3].map(|it| material[it] * vertex[it]))
        });
        let texturing = self.looks.texturing.as_ref();
        let uv = self.mesh.uvs.get(at).copied().unwrap_or_default();
        let (uv, texture) = texturing.map_or(([0; 2], 0), |it| it.place(material, uv));
        MeshVertex {
            place: steps.round().to_array().map(|it| it as u16),
            normal: normal.map_or([0; 2], |it| octahedral_from_direction(*it)),
            colour: colour.unwrap_or_default(),
            uv,
            texture,
        }
    }
}

/// Linear light as sRGB codes (IEC 61966-2-1), and alpha times 255.
pub(crate) fn codes_from_linear([r, g, b, alpha]: [f32; 4]) -> [u8; 4] {
    let code = |light: f32| match light {
        _ if light <= 0.003_130_8 => 12.92 * light,
        _ => 1.055 * light.powf(1.0 / 2.4) - 0.055,
    };
    [code(r), code(g), code(b), alpha].map(|it| (it.clamp(0.0, 1.0) * 255.0).round() as u8)
}

/// A small sphere round vertices.
fn bounds_of(vertices: &[MeshVertex], grid: &Grid) -> ObjectBounds {
    let places: Vec<[f32; 3]> = vertices.iter().map(|it| it.place.map(f32::from)).collect();
    let adapter = meshopt::PositionDataAdapter {
        data: meshopt::typed_to_bytes(&places),
        position_count: places.len(),
        position_stride: size_of::<[f32; 3]>(),
        position_offset: 0,
    };
    let sphere = meshopt::compute_sphere_bounds(adapter, None::<meshopt::RadiusDataAdapter<'_>>);
    let on_grid = DVec3::from_array(sphere.center.map(f64::from));
    let centre = DVec3::from_array(grid.origin) + grid.step * on_grid;
    let away = || vertices.iter().map(|it| grid.at(it.place) - centre);
    ObjectBounds {
        centre: centre.to_array(),
        radius: away().map(DVec3::length).fold(0.0, f64::max),
        half: away()
            .fold(DVec3::ZERO, |most, it| most.max(it.abs()))
            .to_array(),
    }
}
