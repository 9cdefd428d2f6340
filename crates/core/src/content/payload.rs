//! What does a decoder make of a unit?

use crate::content::images::payload::ImagePage;
use crate::content::mesh::payload::MeshUnit;
use crate::content::points::payload::PointUnit;
use crate::content::scene::description::SceneDescription;
use crate::content::scene::kind::UnitKind;
use crate::content::scene::unit_table::UnitRow;
use crate::pack::PackError;
use crate::view::picture::Picture;
use core::any::Any;
use std::sync::Arc;

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
    /// What only another crate knows.
    Other(OtherPayload),
}

/// A decoded unit of a kind that another crate adds: what draws it knows its type.
#[derive(Clone, Debug)]
pub struct OtherPayload(pub Arc<dyn Any + Send + Sync>);

impl PartialEq for OtherPayload {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl Eq for OtherPayload {}

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
    /// What only another crate knows.
    Other(&'a OtherPayload),
}

impl Payload {
    /// What a unit's chunk says, by its row in the table and what stands in its scene.
    ///
    /// # Errors
    /// It is no such unit.
    pub(crate) fn parse(
        row: &UnitRow,
        about: &SceneDescription,
        chunk: &[u8],
    ) -> Result<Self, PackError> {
        let object = about.objects.get(usize::from(row.object));
        match row.kind {
            UnitKind::Mesh => {
                let attributes = object.map(|it| it.attributes).unwrap_or_default();
                let unit = MeshUnit::parse(chunk, attributes, &row.replaces)?;
                if let Some(texturing) = object.and_then(|it| it.texturing.as_ref()) {
                    unit.check_textures(texturing.textures.len())?;
                }
                Ok(Self::Mesh(unit))
            }
            UnitKind::Points => {
                let cloud = object.and_then(|it| it.shape.cloud());
                let attributes = cloud.map(|it| it.attributes).unwrap_or_default();
                PointUnit::parse(chunk, attributes).map(Self::Points)
            }
            UnitKind::Image => ImagePage::parse(chunk, &about.textures).map(Self::Image),
        }
    }

    /// What it is, without taking it.
    #[must_use]
    pub fn view(&self) -> PayloadView<'_> {
        match self {
            Self::Picture(picture) => PayloadView::Picture(picture),
            Self::Mesh(unit) => PayloadView::Mesh(unit),
            Self::Image(page) => PayloadView::Image(page),
            Self::Points(unit) => PayloadView::Points(unit),
            Self::Other(unit) => PayloadView::Other(unit),
        }
    }
}

impl PayloadView<'_> {
    /// The kind of a unit of a scene; `None` of a video and of what only another crate knows.
    #[must_use]
    pub fn kind(self) -> Option<UnitKind> {
        match self {
            Self::Picture(_) | Self::Other(_) => None,
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
