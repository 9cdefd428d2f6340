//! How is an asset drawn, whatever kind of content it is?

use crate::draw_device::{DrawDevice, DrawnPicture};
use crate::drawn_scene::DrawnScene;
use crate::error::RenderError;
#[cfg(not(target_arch = "wasm32"))]
use crate::image::RgbaImage;
use crate::params::Overlay;
use crate::tiles::drawer::TileDrawer;
use crate::under::Under;
use foveal_core::content::payload::Payload;
use foveal_core::content::unit::{AssetId, UnitRef};
use foveal_core::pack::unit::UnitId;
use foveal_core::session::unit_states::Piece;
use foveal_core::view::eye_view::EyeView;

/// An asset, and what draws it.
pub(crate) enum AssetDrawer {
    /// Tiles of a video or still.
    Tiles(Box<TileDrawer>),
    /// Units of a scene.
    Scene(Box<DrawnScene>),
}

fn numbers(units: &[UnitRef]) -> Vec<UnitId> {
    units.iter().map(|it| it.unit).collect()
}

impl AssetDrawer {
    /// Makes a piece resident; `false` where there is no room for it and what is coarser is shown.
    ///
    /// # Errors
    /// It is not what its unit should be, or the device was lost.
    pub(crate) fn upload(&mut self, piece: Piece, payload: Payload) -> Result<bool, RenderError> {
        match (self, payload) {
            (Self::Tiles(tiles), Payload::Picture(picture)) => {
                tiles.upload(piece, picture).map(|()| true)
            }
            (Self::Tiles(_), _) => Err(RenderError::OtherKind),
            (Self::Scene(scene), payload) => scene.upload(piece.unit.unit, &payload),
        }
    }

    /// Draws only `shown` units and the coarsest level. Of the others those stay that are
    /// `staying`, first what is to stay longest.
    pub(crate) fn keep(&mut self, shown: &[UnitRef], staying: &[UnitRef]) {
        match self {
            Self::Tiles(tiles) => tiles.keep(shown, staying),
            Self::Scene(scene) => {
                let shown = shown.iter().map(|it| it.unit).collect();
                scene.keep(&shown, &numbers(staying));
            }
        }
    }

    /// Draws a piece again that stayed; `false` where it did not.
    pub(crate) fn show(&mut self, piece: Piece) -> bool {
        match self {
            Self::Tiles(tiles) => tiles.show(piece),
            Self::Scene(scene) => scene.show(piece.unit.unit),
        }
    }

    /// These do not give way, until others are spared: they are about to be drawn again.
    pub(crate) fn spare(&mut self, units: &[UnitRef]) {
        match self {
            Self::Tiles(tiles) => tiles.spare(units),
            Self::Scene(scene) => scene.spare(&numbers(units)),
        }
    }

    /// Pieces of an asset of this number that stayed and gave way since this was last asked.
    pub(crate) fn take_evicted(&mut self, asset: AssetId) -> Vec<Piece> {
        match self {
            Self::Tiles(tiles) => tiles.take_evicted(asset),
            Self::Scene(scene) => {
                let units = scene.take_evicted().into_iter();
                let piece = |unit| Piece {
                    unit: UnitRef { asset, unit },
                    frame: 0,
                };
                units.map(piece).collect()
            }
        }
    }

    /// Bytes of GPU memory in use.
    pub(crate) fn gpu_bytes(&self) -> u64 {
        match self {
            Self::Tiles(tiles) => tiles.gpu_bytes(),
            Self::Scene(scene) => scene.gpu_bytes(),
        }
    }

    /// The texture of the picture that a view shows, over what is under it; tiles cover all of
    /// that. `None` where no GPU draws.
    ///
    /// # Errors
    /// The picture is larger than the device draws.
    pub(crate) fn draw(
        &mut self,
        under: &Under,
        view: &EyeView,
        marks: Option<&Overlay>,
    ) -> Result<Option<&wgpu::Texture>, RenderError> {
        match self {
            Self::Tiles(tiles) => tiles.draw(view, marks),
            Self::Scene(scene) => scene.draw(under, view, marks),
        }
    }

    /// The same, on its way to main memory; `None` when nothing draws.
    ///
    /// # Errors
    /// The picture is larger than the device draws.
    pub(crate) fn read(
        &mut self,
        under: &Under,
        view: &EyeView,
        marks: Option<&Overlay>,
    ) -> Result<Option<DrawnPicture>, RenderError> {
        match self {
            Self::Tiles(tiles) => tiles.read(view, marks),
            Self::Scene(scene) => scene.read(under, view, marks),
        }
    }

    /// The same, once it is there. Blocks.
    ///
    /// # Errors
    /// The picture is larger than the device draws, or has marks that it cannot have.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) fn picture(
        &mut self,
        under: &Under,
        view: &EyeView,
        marks: Option<&Overlay>,
    ) -> Result<Option<RgbaImage>, RenderError> {
        match self {
            Self::Tiles(tiles) => tiles.picture(view, marks),
            Self::Scene(scene) => scene.picture(under, view, marks),
        }
    }

    /// The picture of assets, each over those before it, that another is drawn over.
    ///
    /// # Errors
    /// The picture is larger than the device draws.
    pub(crate) fn all_under(
        assets: &mut [Self],
        device: &DrawDevice,
        view: &EyeView,
        marks: Option<&Overlay>,
    ) -> Result<Under, RenderError> {
        let mut under = Under::default();
        for asset in assets {
            under = match device {
                DrawDevice::Gpu(_) => Under {
                    texture: asset.draw(&under, view, marks)?.cloned(),
                    image: None,
                },
                DrawDevice::Twin | DrawDevice::Nothing => Under {
                    texture: None,
                    image: match asset.read(&under, view, marks)? {
                        Some(DrawnPicture::Here(image)) => Some(image),
                        Some(DrawnPicture::Coming(_)) | None => None,
                    },
                },
            };
        }
        Ok(under)
    }
}
