//! What does selection make of side tables that hold any bytes? Also the body of a fuzz target.

#![allow(clippy::unwrap_used)]

use foveal_core::content::demand::Demand;
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::content::video::bytes::cue_table::{CUES_VERSION, CueTable};
use foveal_core::content::video::bytes::pack::VideoPack;
use foveal_core::content::video::bytes::signatures::{SIGNATURES_VERSION, Signatures};
use foveal_core::content::video::bytes::small_pack::{open_file, small_description, small_pack};
use foveal_core::content::video::demand::VideoDemand;
use foveal_core::content::video::grid::tile_grid::Tile;
use foveal_core::content::video::units::VideoUnits;
use foveal_core::gaze::sample::GazeSample;
use foveal_core::pack::unit::UnitId;
use foveal_core::perception::measures::contrast::Signature;
use foveal_core::perception::measures::cues::Cues;
use foveal_core::perception::moment::Moment;
use foveal_core::perception::parameters::{Model, Parameters};
use foveal_core::selection::scheduler::Scheduler;
use foveal_core::units::{Radians, Seconds};
use std::sync::Arc;

/// A pack of three levels and a short last group, without side tables.
fn pack_without_tables() -> VideoPack {
    let about = small_description([100, 60], 16, &[2, 2, 4], 5);
    let units = |tile: Tile, _| vec![vec![7; 20 + usize::from(tile.x) * 9]];
    open_file(&small_pack(about, &[], units).unwrap())
        .unwrap()
        .1
}

/// Bytes of the two side tables of a pack.
pub(crate) fn table_bytes(pack: &VideoPack) -> [usize; 2] {
    let refining = pack.units().len() - pack.first_refining_unit().0 as usize;
    let finest = pack.units().filter(|unit| pack.tile_of(*unit).level == 0);
    [refining * Signature::BYTES, finest.count() * Cues::BYTES]
}

/// Units with their rows of the tables.
#[derive(Debug)]
struct KnownUnits {
    pack: Arc<VideoPack>,
    signatures: Signatures,
    cues: Option<CueTable>,
}

impl VideoUnits for KnownUnits {
    fn unit(&self, tile: Tile, frame: u32) -> UnitId {
        self.pack.unit(tile, frame)
    }

    fn next_group(&self, frame: u32) -> Option<u32> {
        let about = self.pack.description();
        let next = (frame / about.groups[0] + 1) * about.groups[0];
        (next < about.frames).then_some(next)
    }

    fn bytes(&self, unit: UnitId) -> u32 {
        self.pack.entry(unit).bytes
    }

    fn has_signatures(&self) -> bool {
        true
    }

    fn signature(&self, unit: UnitId) -> Option<Signature> {
        self.signatures.of(unit)
    }

    fn cues(&self, unit: UnitId) -> Option<Cues> {
        self.cues.as_ref()?.of(unit)
    }
}

/// A pack, and what chooses from it under either model, with and without saliency.
pub(crate) struct Target {
    pub(crate) pack: Arc<VideoPack>,
    wishes: Vec<(PolicyConfig, VideoDemand)>,
}

impl Target {
    pub(crate) fn new() -> Self {
        let pack = Arc::new(pack_without_tables());
        let [signatures, _] = table_bytes(&pack);
        let busy = Signatures::parse(&pack, SIGNATURES_VERSION, vec![200; signatures]);
        let busy: Arc<dyn VideoUnits> = Arc::new(KnownUnits {
            pack: Arc::clone(&pack),
            signatures: busy.unwrap(),
            cues: None,
        });
        let models = [Model::Default, Model::Paper];
        let configs = models.map(|model| [false, true].map(|saliency| (model, saliency)));
        let wish = |(model, saliency): &(Model, bool)| {
            let config = PolicyConfig {
                perception: Parameters::of(*model),
                saliency: *saliency,
                ..PolicyConfig::new(Policy::Perceptual)
            };
            let mut demand = VideoDemand::new(Arc::clone(&busy), *pack.grid(), config.clone());
            // Buys nothing, but makes the tables that are made when first asked for.
            demand.begin(0, &moment(), Some(0));
            (config, demand)
        };
        let wishes = configs.as_flattened().iter().map(wish).collect();
        Self { pack, wishes }
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
        let content = Arc::new(KnownUnits {
            pack: Arc::clone(&self.pack),
            signatures,
            cues,
        });
        let (config, demand) = &self.wishes[usize::from(*which) % self.wishes.len()];
        let demand = demand.of_content(content);
        let mut scheduler = Scheduler::new(config, vec![Box::new(demand)]);
        for (frame, budget) in [(0, Some(900)), (3, Some(0)), (4, None)] {
            let chosen = scheduler.choose(&[frame], &moment(), budget).remove(0);
            assert!(scheduler.spent() <= budget.unwrap_or(u64::MAX));
            assert!(chosen.units.len() >= self.pack.grid().tiles_in_level(2) as usize);
        }
        true
    }
}

fn moment() -> Moment {
    let gaze = GazeSample::at(Seconds(0.0), Radians(0.1), Radians(0.0));
    Moment::new(gaze, Vec::new())
}
