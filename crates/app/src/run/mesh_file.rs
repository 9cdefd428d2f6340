//! How does a generated mesh become a file?

use foveal_core::perception::luminance::linear_from_srgb;
use foveal_scene::source::SourceMesh;

/// Positions, colours where there are any, and triangles as a binary PLY.
pub(crate) fn ply(mesh: &SourceMesh) -> Vec<u8> {
    let colours = match mesh.colours.is_empty() {
        true => "",
        false => "property uchar red\nproperty uchar green\nproperty uchar blue\n",
    };
    let mut bytes = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\n\
         property float y\nproperty float z\n{colours}element face {}\n\
         property list uchar int vertex_indices\nend_header\n",
        mesh.positions.len(),
        mesh.triangles.len()
    )
    .into_bytes();
    let light: Vec<f32> = (0..=255)
        .map(|code| linear_from_srgb(code) as f32)
        .collect();
    let code = |of: &f32| light.partition_point(|it| it < of).min(255) as u8;
    for (at, position) in mesh.positions.iter().enumerate() {
        let numbers = position.as_vec3().to_array();
        bytes.extend(numbers.iter().flat_map(|it| it.to_le_bytes()));
        if let Some([r, g, b, _]) = mesh.colours.get(at) {
            bytes.extend([r, g, b].map(code));
        }
    }
    for triangle in &mesh.triangles {
        bytes.push(3);
        bytes.extend(triangle.iter().flat_map(|it| it.to_le_bytes()));
    }
    bytes
}
