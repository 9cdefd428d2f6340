//! What does a decoder make of a unit?

use crate::content::images::payload::ImagePage;
use crate::content::mesh::payload::MeshUnit;
use crate::content::points::payload::PointUnit;
use crate::view::picture::Picture;

/// A decoded frame of a unit, of any kind of content.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Payload {
    /// A tile of video.
    Picture(Picture),
    /// Clusters of a mesh.
    Mesh(MeshUnit),
    /// A page of a texture.
    Image(ImagePage),
    /// Points of a cloud.
    Points(PointUnit),
}
