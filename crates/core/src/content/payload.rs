//! What does a decoder make of a unit?

use crate::content::images::payload::ImagePage;
use crate::content::mesh::payload::MeshUnit;
use crate::content::points::payload::PointUnit;
use crate::content::scene::kind::UnitKind;
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

/// The same, where it lies.
#[derive(Clone, Copy, Debug)]
pub enum PayloadView<'a> {
    /// A tile of video.
    Picture(&'a Picture),
    /// Clusters of a mesh.
    Mesh(&'a MeshUnit),
    /// A page of a texture.
    Image(&'a ImagePage),
    /// Points of a cloud.
    Points(&'a PointUnit),
}

impl Payload {
    /// What it is, without taking it.
    #[must_use]
    pub fn view(&self) -> PayloadView<'_> {
        match self {
            Self::Picture(picture) => PayloadView::Picture(picture),
            Self::Mesh(unit) => PayloadView::Mesh(unit),
            Self::Image(page) => PayloadView::Image(page),
            Self::Points(unit) => PayloadView::Points(unit),
        }
    }
}

impl PayloadView<'_> {
    /// The kind of a unit of a scene; `None` of a video.
    #[must_use]
    pub fn kind(self) -> Option<UnitKind> {
        match self {
            Self::Picture(_) => None,
            Self::Mesh(_) => Some(UnitKind::Mesh),
            Self::Image(_) => Some(UnitKind::Image),
            Self::Points(_) => Some(UnitKind::Points),
        }
    }

    /// Whether it is on its way once it is there: [`KindFacts::morphs`].
    ///
    /// [`KindFacts::morphs`]: crate::content::scene::kind::KindFacts::morphs
    #[must_use]
    pub fn morphs(self) -> bool {
        self.kind().is_some_and(|kind| kind.facts().morphs)
    }
}
