//! Which numbers do the shaders of meshes and their twins read?
//!
//! The structs here have the layout of the WGSL structs whose names lack the `Params`;
//! `tests/shaders.rs` compares them.

use bytemuck::{Pod, Zeroable};
use foveal_core::content::scene::description::Backdrop;
use foveal_core::perception::luminance::linear_from_srgb;
use foveal_core::view::eye_view::EyeView;
use glam::DVec3;

/// What of what cannot be seen is left out before it is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Culling {
    /// What lies outside the field of view.
    pub outside: bool,
    /// Clusters that show their backs.
    pub backs: bool,
    /// Clusters that others hide: in the picture before, and still in this one.
    pub hidden: bool,
}

impl Culling {
    /// Nothing is left out.
    pub const NONE: Self = Self {
        outside: false,
        backs: false,
        hidden: false,
    };
    /// All that cannot be seen.
    pub const ALL: Self = Self {
        outside: true,
        backs: true,
        hidden: true,
    };

    /// As shaders read it.
    fn bits(self) -> u32 {
        let marked = |is, bit| if is { bit } else { 0 };
        marked(self.outside, OUTSIDE) | marked(self.backs, BACKS) | marked(self.hidden, HIDDEN)
    }
}

/// Clusters outside the field of view are left out.
pub(crate) const OUTSIDE: u32 = 1;
/// Those that show their backs are.
pub(crate) const BACKS: u32 = 2;
/// Those that others hide are.
pub(crate) const HIDDEN: u32 = 4;

/// How clusters become a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneStyle {
    /// What is left out before it is drawn; the picture is the same.
    pub culls: Culling,
    /// How much of its level's colour covers each cluster, 0 to 1.
    pub tint: f32,
    /// Depth in metres from which on things are drawn; more than 0.
    pub near: f64,
    /// What is seen where nothing stands, and where light comes from.
    pub look: Backdrop,
}

impl SceneStyle {
    /// The same without leaving out what others hide.
    pub(crate) fn without_hiding(&self) -> Self {
        let culls = Culling {
            hidden: false,
            ..self.culls
        };
        Self { culls, ..*self }
    }

    /// What is seen where nothing stands, as the nearest sRGB codes.
    pub(crate) fn background(&self) -> [u8; 4] {
        let [r, g, b] = self.look.background.map(|light| {
            let off = |code: &u8| (linear_from_srgb(*code) - f64::from(light)).abs();
            (0..=255).min_by(|a, b| off(a).total_cmp(&off(b)))
        });
        [r, g, b, Some(255)].map(Option::unwrap_or_default)
    }
}

impl Default for SceneStyle {
    fn default() -> Self {
        Self {
            culls: Culling::ALL,
            tint: 0.0,
            near: 0.01,
            look: Backdrop::default(),
        }
    }
}

/// What is the same for all that a view shows.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct SceneParams {
    /// What places to the right and down, in view space, are multiplied by, then what is added for
    /// each metre of depth.
    pub clip_from_view: [f32; 4],
    /// Tangents of the field of view to the left, right, up and down.
    pub field: [f32; 4],
    /// Unit direction to the light, in view space: right, down, forward.
    pub light: [f32; 3],
    /// Least depth that is drawn, in metres.
    pub near: f32,
    /// Unit direction of the world's up, in view space.
    pub up: [f32; 3],
    /// How much of its level's colour covers each cluster.
    pub tint: f32,
    /// The coarsest level, at least 1.
    pub coarsest: f32,
    /// Which clusters are left out: `OUTSIDE`, `BACKS` and `HIDDEN`.
    pub culls: u32,
    /// Columns and rows of the picture.
    pub picture: [u32; 2],
}

/// What a level of depths is made by.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct HalvingParams {
    /// Columns and rows of the picture.
    pub picture: [u32; 2],
    /// The level: its depths are each of 2^level pixels on a side.
    pub level: u32,
    /// Keeps the size a multiple of sixteen.
    pub unused: u32,
}

/// What is the same for all clusters of an object where it stands.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct PlacementParams {
    /// Rows of the matrix that turns (x, y, z, 1) on the object's grid into view space.
    pub view_from_grid: [[f32; 4]; 3],
    /// Rows of the matrix that turns a normal of the object into one of view space, not of unit
    /// length.
    pub normal_from_object: [[f32; 4]; 3],
    /// The eye on the object's grid; then 1 where that is known, else 0.
    pub eye_in_grid: [f32; 4],
    /// Colour of the object in linear light.
    pub colour: [f32; 4],
    /// Place on its textures of [0, 0] on the grid of them, then the distance of its places.
    pub uv_from_grid: [f32; 4],
    /// What holds of the object: `NORMALS`, `COLOURS`, `UNLIT`, `MIRRORED`, `TWO_SIDED` and
    /// `TEXTURED`.
    pub flags: u32,
    /// Where the list of its textures begins in the table of pages.
    pub textures: u32,
    /// Keeps the size a multiple of sixteen.
    pub unused_pair: [u32; 2],
}

/// Its vertices have normals.
pub(crate) const NORMALS: u32 = 1;
/// Its vertices have colours.
pub(crate) const COLOURS: u32 = 2;
/// No light falls on it.
pub(crate) const UNLIT: u32 = 4;
/// It stands as in a mirror.
pub(crate) const MIRRORED: u32 = 8;
/// It is seen from both sides.
pub(crate) const TWO_SIDED: u32 = 16;
/// Its vertices have places on textures.
pub(crate) const TEXTURED: u32 = 32;

impl SceneParams {
    /// What `view` shows of clusters of levels up to `coarsest`.
    #[must_use]
    pub fn new(view: &EyeView, style: &SceneStyle, coarsest: u8) -> Self {
        let field = view.field;
        let [across, along] = [field.left + field.right, field.up + field.down];
        let clip_from_view = [
            2.0 / across,
            -2.0 / along,
            (field.left - field.right) / across,
            (field.down - field.up) / along,
        ];
        let tangents = [field.left, field.right, field.up, field.down];
        let in_view = |it| in_view(view, it).as_vec3().to_array();
        Self {
            clip_from_view: clip_from_view.map(|it| it as f32),
            field: tangents.map(|it| it as f32),
            light: in_view(DVec3::from_array(style.look.light).normalize()),
            near: style.near as f32,
            up: in_view(DVec3::Y),
            tint: style.tint,
            coarsest: f32::from(coarsest.max(1)),
            culls: style.culls.bits(),
            picture: view.size,
        }
    }
}

/// A direction of the world in view space: right, down, forward.
pub(crate) fn in_view(view: &EyeView, direction: DVec3) -> DVec3 {
    let axes = view.axes;
    DVec3::new(
        direction.dot(axes.right),
        direction.dot(axes.down),
        direction.dot(axes.forward),
    )
}
