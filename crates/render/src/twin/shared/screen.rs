//! What does a pixel show? Twin of `shaders/shared/screen.wgsl`.

use glam::{Mat3, Vec2};

pub(crate) struct View {
    pub(crate) content_from_pixel: Mat3,
    pub(crate) first_face: u32,
}

pub(crate) struct SeenPlace {
    pub(crate) inside: bool,
    pub(crate) face: u32,
    pub(crate) place: Vec2,
    pub(crate) footprint: f32,
}

pub(crate) fn display_footprint(right: Vec2, down: Vec2) -> f32 {
    (right.x * down.y - right.y * down.x).abs().sqrt()
}
