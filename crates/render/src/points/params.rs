//! Which numbers do the shaders of points and their twins read?
//!
//! The structs here have the layout of the WGSL structs whose names lack the `Params`;
//! `tests/shaders.rs` compares them.

use bytemuck::{Pod, Zeroable};

/// Stands for no cube and no unit.
pub(crate) const NONE: u32 = u32::MAX;

/// What is the same for all points that a view shows.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct CloudViewParams {
    /// Half a pixel across and along, where the picture has two of each.
    pub half_pixel: [f32; 2],
    /// Keeps the size a multiple of sixteen.
    pub unused_pair: [f32; 2],
}

/// The cube of a unit where it stands.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct CubeParams {
    /// Rows of the matrix that turns (x, y, z, 1), in 65536ths of a side, into view space.
    pub view_from_cube: [[f32; 4]; 3],
    /// How far its points are apart, in metres.
    pub spacing: f32,
    /// Level of the unit, 0 the finest.
    pub level: u32,
    /// Keeps the size a multiple of sixteen.
    pub unused_pair: [u32; 2],
    /// For each octant the cube that refines it, by its number in the list; 4294967295 where none
    /// is there.
    pub octants: [u32; 8],
    /// For each octant the unit that would refine it.
    pub refiners: [u32; 8],
}
