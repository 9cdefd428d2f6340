//! Where do objects stand before the eye?

use crate::scene::params::{
    COLOURS, MIRRORED, NORMALS, PlacementParams, TEXTURED, TWO_SIDED, UNLIT, in_view,
};
use foveal_core::content::scene::description::SceneObject;
use foveal_core::content::scene::lighting::normal_matrix;
use foveal_core::view::eye_view::EyeView;
use glam::{DAffine3, DMat3, DVec3};
use std::ops::Range;

/// How the vertices of an object lie on textures.
#[derive(Clone, Copy, Debug, Default)]
pub struct OnTextures {
    /// Origin and step of the grid of places on textures.
    pub uv_from_grid: [f32; 4],
    /// Where the list of its textures begins.
    pub textures: u32,
}

/// Objects, each where it stands.
pub struct Placements {
    all: Vec<Placement>,
    /// The first placement of each object; last, their number.
    first: Vec<u32>,
}

/// An object where it stands.
struct Placement {
    world_from_grid: DAffine3,
    /// Normals know nothing of the grid: they are of the object's space.
    world_from_object: DMat3,
    colour: [f32; 4],
    flags: u32,
    on_textures: OnTextures,
}

impl Placements {
    /// All placements of objects; `on_textures` says how each lies on textures, by its number.
    pub fn new(
        objects: &[SceneObject],
        on_textures: impl Fn(usize, &SceneObject) -> OnTextures,
    ) -> Self {
        let (mut all, mut first) = (Vec::new(), vec![0]);
        for (number, object) in objects.iter().enumerate() {
            let object_from_grid = object.grid.object_from_grid();
            all.extend(object.placements().map(|world_from_object| Placement {
                world_from_grid: world_from_object * object_from_grid,
                world_from_object: world_from_object.matrix3,
                colour: object.colour,
                on_textures: on_textures(number, object),
                flags: flags(object, world_from_object.matrix3),
            }));
            first.push(all.len() as u32);
        }
        Self { all, first }
    }

    /// Bytes of all as shaders read them.
    pub(crate) fn bytes(&self) -> u64 {
        (self.all.len() * size_of::<PlacementParams>()) as u64
    }

    /// The placements of an object, by number.
    pub(crate) fn of(&self, object: u16) -> Range<u32> {
        let object = usize::from(object);
        self.first[object]..self.first[object + 1]
    }

    /// All of them, as `view` sees them. Differences of places are taken in `f64`: what stands ten
    /// thousand kilometres from the origin is drawn as exactly as what stands there.
    pub(crate) fn seen_by(&self, view: &EyeView) -> Vec<PlacementParams> {
        self.all.iter().map(|it| it.seen_by(view)).collect()
    }
}

impl Placement {
    fn seen_by(&self, view: &EyeView) -> PlacementParams {
        let DAffine3 {
            matrix3,
            translation,
        } = self.world_from_grid;
        let linear = columns(matrix3).map(|it| in_view(view, it));
        let origin = in_view(view, translation - view.position);
        let normals = columns(normal_matrix(self.world_from_object)).map(|it| in_view(view, it));
        let eye = self.world_from_grid.inverse();
        let eye = eye.transform_vector3(view.position - translation);
        // Beyond that, single precision holds too little of it.
        let is_known = eye.abs().max_element() < 1e7;
        let [x, y, z] = if is_known { eye } else { DVec3::ZERO }
            .as_vec3()
            .to_array();
        PlacementParams {
            view_from_grid: rows(linear, origin),
            normal_from_object: rows(normals, DVec3::ZERO),
            eye_in_grid: [x, y, z, if is_known { 1.0 } else { 0.0 }],
            colour: self.colour,
            uv_from_grid: self.on_textures.uv_from_grid,
            flags: self.flags,
            textures: self.on_textures.textures,
            unused_pair: [0; 2],
        }
    }
}

fn flags(object: &SceneObject, world_from_object: DMat3) -> u32 {
    let flag = |is_set: bool, flag: u32| if is_set { flag } else { 0 };
    flag(object.attributes.normals, NORMALS)
        | flag(object.attributes.colours, COLOURS)
        | flag(object.unlit, UNLIT)
        | flag(world_from_object.determinant() < 0.0, MIRRORED)
        | flag(object.two_sided, TWO_SIDED)
        | flag(object.attributes.textured, TEXTURED)
}

fn columns(matrix: DMat3) -> [DVec3; 3] {
    [matrix.x_axis, matrix.y_axis, matrix.z_axis]
}

/// The rows of the matrix with these columns.
fn rows([x, y, z]: [DVec3; 3], origin: DVec3) -> [[f32; 4]; 3] {
    [0, 1, 2].map(|k| [x[k], y[k], z[k], origin[k]].map(|it| it as f32))
}
