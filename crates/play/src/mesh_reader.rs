//! Who reads the units of a scene?

use crate::feed::{Decoder, Done, Failure};
use foveal_core::session::unit_states::Piece;
use foveal_media::pack::scene_file::SceneFile;
use std::collections::VecDeque;
use std::sync::Arc;

/// Reads and parses units of a pack, one after the other: that takes less time than what is done
/// with them.
#[derive(Debug)]
pub(crate) struct MeshReader {
    file: Arc<SceneFile>,
    asked: VecDeque<Piece>,
}

impl MeshReader {
    pub(crate) fn new(file: &Arc<SceneFile>) -> Self {
        Self {
            file: Arc::clone(file),
            asked: VecDeque::new(),
        }
    }
}

impl Decoder for MeshReader {
    fn request(&mut self, piece: Piece) {
        self.asked.push_back(piece);
    }

    fn receive(&mut self) -> Option<Done> {
        let piece = self.asked.pop_front()?;
        let payload = self.file.read_unit(piece.unit.unit);
        let damaged = |error| {
            Failure::Damaged(format!(
                "{error}; what there is else is shown (`foveal verify` lists all damage)"
            ))
        };
        Some(Done {
            piece,
            frames: 1,
            payload: payload.map_err(damaged),
        })
    }
}
