//! Who makes pictures of the tiles of a video?

use crate::decoding::Decoding;
use crate::error::PlayError;
use crate::feed::{Decoder, Done, Failure};
use foveal_core::content::payload::Payload;
use foveal_core::content::unit::{AssetId, UnitRef};
use foveal_core::content::video::grid::tile_grid::Tile;
use foveal_core::session::unit_states::Piece;
use foveal_media::pack::pack_file::PackFile;
use foveal_media::tiles::decode_pool::{DecodePool, DecodedTile, TileError};
use std::sync::Arc;

/// Decodes the tiles of a pack on all cores.
#[derive(Debug)]
pub(crate) struct TileDecoder {
    pool: DecodePool,
    file: Arc<PackFile>,
}

impl TileDecoder {
    /// The decoders of a pack.
    ///
    /// # Errors
    /// Nothing decodes it.
    pub(crate) fn new(file: &Arc<PackFile>, decoding: Decoding) -> Result<Self, PlayError> {
        Ok(Self {
            pool: decoding.pool(Arc::clone(file))?,
            file: Arc::clone(file),
        })
    }

    fn damaged(&self, tile: Tile, frame: u32, error: &TileError) -> Failure {
        let Tile { level, face, x, y } = tile;
        Failure::Damaged(format!(
            "{}: level {level}, face {face}, column {x}, row {y} cannot be decoded at frame \
             {frame}; what there is else is shown ({error}; `foveal verify` lists all damage)",
            self.file.path().display(),
        ))
    }
}

impl Decoder for TileDecoder {
    fn request(&mut self, piece: Piece) {
        self.pool.request(piece.unit.unit, piece.frame);
    }

    fn receive(&mut self) -> Option<Done> {
        let DecodedTile {
            unit,
            frame,
            picture,
            decoded,
        } = self.pool.receive(None)?;
        let tile = self.file.pack().tile_of(unit);
        let payload = match picture {
            Ok((picture, number)) if number == i64::from(frame) => Ok(Payload::Picture(picture)),
            Ok((_, number)) => Err(Failure::Wrong(PlayError::WrongFrame {
                path: self.file.path().to_owned(),
                tile,
                frame,
                number,
            })),
            Err(error) => Err(self.damaged(tile, frame, &error)),
        };
        let asset = AssetId::ONLY;
        Some(Done {
            piece: Piece {
                unit: UnitRef { asset, unit },
                frame,
            },
            frames: decoded,
            payload,
        })
    }
}
