//! Which colour has each pixel of the nearest surface? Twin of `shaders/draw_clusters.wgsl`.

use crate::meshes::units::DrawnCluster;
use crate::scene::params::{COLOURS, NORMALS, TEXTURED, TWO_SIDED, UNLIT};
use crate::twin::shared::pages::{NO_TEXTURE, TwinPages, is_cut_out, texture_colour, texture_of};
use crate::twin::shared::ramp::ramp;
use crate::twin::shared::raster::{Corner, Fragment};
use crate::twin::shared::scene::{SceneInView, times, vertex_of};
use crate::twin::shared::wgsl::mix;
use foveal_core::content::mesh::octahedral;
use foveal_core::content::scene::lighting::{GROUND, LAMP, SKY};
use glam::{Vec2, Vec3, Vec4};

/// What all triangles of a cluster have.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct OfCluster {
    pub(crate) flags: u32,
    pub(crate) level: u32,
    pub(crate) refiner: u32,
    /// Where the list of the object's textures begins.
    pub(crate) textures: u32,
}

fn linear_from_srgb(code: Vec3) -> Vec3 {
    let curved = ((code + 0.055) / 1.055).powf(2.4);
    Vec3::select(code.cmple(Vec3::splat(0.040_45)), code / 12.92, curved)
}

fn srgb_from_linear(light: Vec3) -> Vec3 {
    let curved = 1.055 * light.powf(1.0 / 2.4) - 0.055;
    Vec3::select(light.cmple(Vec3::splat(0.003_130_8)), light * 12.92, curved)
}

fn direction_from_octahedral(normal: [i8; 2]) -> Vec3 {
    Vec3::from(octahedral::direction_from_octahedral(normal))
}

fn unit(direction: Vec3) -> Vec3 {
    direction / direction.length().max(1e-18)
}

pub(super) fn clip_from_view(scene: &SceneInView, place: Vec3) -> Vec4 {
    let [x, y, z, w] = scene.params.clip_from_view;
    let across = place.truncate() * Vec2::new(x, y) + place.z * Vec2::new(z, w);
    Vec4::new(across.x, across.y, scene.params.near, place.z)
}

/// Of a vertex of a cluster, by its number in it.
pub(super) fn place_corner(
    scene: &SceneInView,
    block: &DrawnCluster<'_>,
    placement: u32,
    number: u32,
) -> Corner {
    let placement = &scene.placements[placement as usize];
    let flags = placement.flags;
    let vertex = vertex_of(block, number);
    let grid = Vec3::from(vertex.place.map(f32::from));
    let mut corner = Corner {
        place: times(&placement.view_from_grid, grid.extend(1.0)),
        ..Corner::default()
    };
    corner.position = clip_from_view(scene, corner.place);
    corner.colour = Vec4::from(placement.colour).truncate();
    if flags & COLOURS != 0 {
        let [r, g, b, _] = vertex.colour.map(|it| f32::from(it) / 255.0);
        corner.colour = linear_from_srgb(Vec3::new(r, g, b));
    }
    if flags & NORMALS != 0 {
        let normal = direction_from_octahedral(vertex.normal);
        corner.normal = unit(times(&placement.normal_from_object, normal.extend(0.0)));
    }
    let uv = Vec2::from(vertex.uv.map(f32::from));
    let [u, v, across, along] = placement.uv_from_grid;
    corner.uv = Vec2::new(u, v) + Vec2::new(across, along) * uv;
    corner
}

/// The texture of a triangle of a cluster whose first corner has this number.
pub(super) fn texture_of_corner(
    pages: &TwinPages,
    of_cluster: OfCluster,
    block: &DrawnCluster<'_>,
    number: u32,
) -> u32 {
    match of_cluster.flags & TEXTURED {
        0 => NO_TEXTURE,
        _ => texture_of(pages, of_cluster.textures, vertex_of(block, number).texture),
    }
}

// The face turned to the viewer; a vertex' normal is turned to that side where both are seen.
fn normal_at(flags: u32, place: Vec3, normal: Vec3, face: Vec3) -> Vec3 {
    let seen = if face.dot(place) > 0.0 { -face } else { face };
    let has_normals = flags & NORMALS != 0 && normal.dot(normal) > 0.0;
    let own = unit(if has_normals { normal } else { seen });
    let turns = flags & TWO_SIDED != 0 && own.dot(seen) < 0.0;
    if turns { -own } else { own }
}

fn light_on(scene: &SceneInView, normal: Vec3) -> f32 {
    let ambient = mix(GROUND, SKY, 0.5 + 0.5 * normal.dot(scene.params.up.into()));
    ambient + LAMP * normal.dot(scene.params.light.into()).max(0.0)
}

fn shaded(scene: &SceneInView, of_cluster: OfCluster, colour: Vec3, normal: Vec3) -> Vec3 {
    let light = match of_cluster.flags & UNLIT != 0 {
        true => 1.0,
        false => light_on(scene, normal),
    };
    let code = srgb_from_linear((colour * light).clamp(Vec3::ZERO, Vec3::ONE));
    let of_level = ramp(of_cluster.level as f32 / scene.params.coarsest);
    mix(code, of_level, scene.params.tint)
}

/// The colour of the texture, given how far places on it move from one pixel to the next; `None`
/// where nothing is drawn.
pub(super) fn texture_on(pages: &TwinPages, head: u32, fragment: &Fragment) -> Option<Vec4> {
    if head == NO_TEXTURE {
        return Some(Vec4::ONE);
    }
    let colour = texture_colour(pages, head, fragment.corner.uv, fragment.uv_steps);
    (!is_cut_out(pages, head, colour.w)).then_some(colour)
}

pub(super) fn draw_clusters(
    scene: &SceneInView,
    of_cluster: OfCluster,
    fragment: &Fragment,
    texture: Vec4,
) -> Vec4 {
    let corner = fragment.corner;
    let face = fragment.face;
    let normal = normal_at(of_cluster.flags, corner.place, corner.normal, face);
    let colour = corner.colour * texture.truncate();
    shaded(scene, of_cluster, colour, normal).extend(1.0)
}

pub(super) fn draw_refiners(of_cluster: OfCluster) -> u32 {
    of_cluster.refiner
}
