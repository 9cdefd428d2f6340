//! What does selection make of side tables that hold any bytes? Also the body of a fuzz target.

#![allow(clippy::unwrap_used)]

use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::content::video::bytes::build::{begin_pack, finish_pack, push_tile};
use foveal_core::content::video::bytes::codec::Codec;
use foveal_core::content::video::bytes::cue_table::{CUES_VERSION, CueTable};
use foveal_core::content::video::bytes::description::{Description, Source};
use foveal_core::content::video::bytes::pack::VideoPack;
use foveal_core::content::video::bytes::rate::QualityScale;
use foveal_core::content::video::bytes::signatures::{SIGNATURES_VERSION, Signatures};
use foveal_core::content::video::grid::tile_grid::Cut;
use foveal_core::content::video::units::PackContent;
use foveal_core::gaze::sample::GazeSample;
use foveal_core::pack::{HEADER_BYTES, Header, SideTable};
use foveal_core::perception::measures::contrast::Signature;
use foveal_core::perception::measures::cues::Cues;
use foveal_core::perception::moment::Moment;
use foveal_core::perception::parameters::{EyeState, Model, Parameters};
use foveal_core::selection::refine::Refiner;
use foveal_core::units::{Radians, Seconds};
use foveal_core::view::picture::{Colour, Matrix};
use foveal_core::view::surface::{Projection, Screen};

/// A pack of three levels and a short last group, without side tables.
fn small_pack() -> VideoPack {
    let description = Description {
        generator: String::new(),
        projection: Projection::Flat,
        size: [100, 60],
        eyes: 1,
        cube_faces: 6,
        mapping: foveal_core::view::surface::Mapping::Gnomonic,
        pixel_aspect: [1, 1],
        front_deg: 0.0,
        cut: Cut::Tile(16),
        levels: 3,
        ratio: 2,
        codec: Codec::Png,
        quality: vec![0; 3],
        quality_scale: QualityScale::default(),
        bit_rates: Vec::new(),
        groups: vec![2, 2, 4],
        frames: 5,
        frame_rate: [25, 1],
        colour: Colour {
            matrix: Matrix::Bt601,
            full_range: true,
            chroma_left: false,
        },
        source: Source {
            name: String::new(),
            size: [100, 60],
            bytes: 1,
            codec: String::new(),
        },
        identity: None,
        loss: None,
        tables: Vec::new(),
    };
    let grid = description.grid(Screen::default());
    let mut builder = begin_pack(&description);
    for level in 0..3 {
        let group = description.groups[usize::from(level)];
        for first in (0..description.frames).step_by(group as usize) {
            for tile in grid.tiles_of(level) {
                push_tile(
                    &mut builder,
                    tile,
                    first,
                    &[vec![7; 20 + usize::from(tile.x) * 9]],
                );
            }
        }
    }
    let none: [SideTable; 0] = [];
    let parts = finish_pack(builder, description, &none).unwrap();
    let header = Header::parse(&parts.head).unwrap();
    VideoPack::parse(&header, &parts.head[HEADER_BYTES..], &parts.tail).unwrap()
}

/// Bytes of the two side tables of a pack.
pub(crate) fn table_bytes(pack: &VideoPack) -> [usize; 2] {
    let refining = pack.units().len() - pack.first_refining_unit().0 as usize;
    let finest = pack.units().filter(|unit| pack.tile_of(*unit).level == 0);
    [refining * Signature::BYTES, finest.count() * Cues::BYTES]
}

/// A pack, and what chooses from it under either model, with and without saliency.
pub(crate) struct Target {
    pub(crate) pack: VideoPack,
    refiners: Vec<Refiner>,
}

impl Target {
    pub(crate) fn new() -> Self {
        let pack = small_pack();
        let [signatures, _] = table_bytes(&pack);
        let busy = Signatures::parse(&pack, SIGNATURES_VERSION, vec![200; signatures]);
        let models = [Model::Default, Model::Paper];
        let configs = models.map(|model| [false, true].map(|saliency| (model, saliency)));
        let refiner = |(model, saliency): &(Model, bool)| {
            let config = PolicyConfig {
                perception: Parameters::of(*model),
                saliency: *saliency,
                ..PolicyConfig::new(Policy::Perceptual)
            };
            let mut refiner = Refiner::new(*pack.grid(), config);
            // Buys nothing, but makes the tables that are made when first asked for.
            choose(
                &mut refiner,
                &pack,
                busy.as_ref().unwrap(),
                None,
                [(0, Some(0))],
            );
            refiner
        };
        let refiners = configs.as_flattened().iter().map(refiner).collect();
        Self { pack, refiners }
    }

    /// Reads `data` as version and rows of both tables, and lets units be valued by them: within
    /// the budget, and nothing that is not there. Returns whether the tables were tables.
    pub(crate) fn choose_by_anything(&self, data: &[u8]) -> bool {
        let Some(([version, which], rows)) = data.split_first_chunk() else {
            return false;
        };
        let [signature_bytes, _] = table_bytes(&self.pack);
        let (rows, cues) = rows.split_at(rows.len().min(signature_bytes));
        let version = u32::from(*version);
        let signatures = Signatures::parse(&self.pack, version, rows.to_vec());
        let cues = CueTable::parse(&self.pack, CUES_VERSION, cues.to_vec()).ok();
        let Ok(signatures) = signatures else {
            return false;
        };
        assert!((1..=SIGNATURES_VERSION).contains(&version));
        let mut refiner = self.refiners[usize::from(*which) % self.refiners.len()].clone();
        let frames = [(0, Some(900)), (3, Some(0)), (4, None)];
        choose(&mut refiner, &self.pack, &signatures, cues.as_ref(), frames);
        true
    }
}

/// Chooses for frames within budgets.
fn choose<const N: usize>(
    refiner: &mut Refiner,
    pack: &VideoPack,
    signatures: &Signatures,
    cues: Option<&CueTable>,
    frames: [(u32, Option<u64>); N],
) {
    let content = PackContent {
        pack,
        signatures,
        cues,
    };
    for (frame, budget) in frames {
        let moment = Moment {
            gaze: GazeSample::at(Seconds(0.0), Radians(0.1), Radians(0.0)),
            view: None,
            state: EyeState::Steady,
        };
        let chosen = refiner.refine(&content, frame, &moment, budget);
        assert!(refiner.spent() <= budget.unwrap_or(u64::MAX));
        assert!(chosen.tiles.len() >= pack.grid().tiles_in_level(2) as usize);
    }
}
