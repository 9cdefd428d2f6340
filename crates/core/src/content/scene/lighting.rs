//! How does light fall on a scene?
//!
//! The numbers that `crates/render/shaders/draw_clusters.wgsl` has as well.

use glam::{DMat3, DVec3};

/// Where light comes from, in the world: above, from the right and the viewer's side of who looks
/// along -z. Of any length.
pub const LAMP_DIRECTION: DVec3 = DVec3::new(0.4, 0.8, 0.45);
/// Ambient light from below; 1 shows a colour as it is, which nothing exceeds.
pub const GROUND: f32 = 0.22;
/// Ambient light from above.
pub const SKY: f32 = 0.45;
/// Light from the lamp on what faces it.
pub const LAMP: f32 = 0.55;

/// What turns normals as `matrix` turns places, up to their length: its cofactors, so that it needs
/// no inverse, scaled to be near 1.
#[must_use]
pub fn normal_matrix(matrix: DMat3) -> DMat3 {
    let axes = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
    let largest = axes.map(|it| it.abs().max_element());
    let largest = largest.into_iter().fold(0.0, f64::max).max(1e-300);
    let [x, y, z] = axes.map(|it| it / largest);
    let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
    // Outside stays outside in a mirror.
    cofactors * x.dot(y.cross(z)).signum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_stay_outside_in_a_mirror_and_lean_where_a_sphere_is_flattened() {
        let mirror = DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0));
        assert_eq!(normal_matrix(mirror) * DVec3::X, DVec3::NEG_X);
        assert_eq!(normal_matrix(mirror) * DVec3::Y, DVec3::Y);
        let flattened = DMat3::from_diagonal(DVec3::new(1.0, 0.5, 1.0));
        let normal = normal_matrix(flattened) * DVec3::new(1.0, 1.0, 0.0);
        assert!((normal.y / normal.x - 2.0).abs() < 1e-12);
    }
}
