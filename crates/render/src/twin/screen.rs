//! What does a pixel show? Twin of `shaders/shared/screen.wgsl`.

use glam::{Mat3, Vec2};

pub(super) struct View {
    pub(super) content_from_pixel: Mat3,
    pub(super) first_face: u32,
}

pub(super) struct Seen {
    pub(super) inside: bool,
    pub(super) face: u32,
    pub(super) place: Vec2,
    pub(super) footprint: f32,
}

pub(super) fn display_footprint(right: Vec2, down: Vec2) -> f32 {
    (right.x * down.y - right.y * down.x).abs().sqrt()
}
