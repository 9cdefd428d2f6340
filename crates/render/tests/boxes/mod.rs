//! Can a kind be added from outside, drawn in front of a video and chosen within one budget?

mod layer;

use crate::common::playing::play;
use crate::looking::looking;
use crate::made_video::Made;
use crate::octree_boxes::{Boxes, place_of};
use foveal_core::content::demand::Content;
use foveal_core::content::payload::{OtherPayload, Payload};
use foveal_core::content::policy::Policy;
use foveal_core::content::unit::{AssetId, UnitRef};
use foveal_core::pack::unit::UnitId;
use foveal_core::session::actions::{Cache, Now, Pace, SessionAction};
use foveal_core::session::unit_states::Piece;
use foveal_core::view::picture::Picture;
use foveal_core::view::surface::Projection;
use foveal_render::scene::placements::Placements;
use foveal_render::{
    Coming, DrawDevice, Drawer, Gpu, RgbaImage, SceneLayer, SceneStyle, TileStyle,
};
use layer::{BoxLayer, BoxUnit};
use std::sync::Arc;

const SIDE: u32 = 160;
const STEP_S: f64 = 0.1;
/// The first asset is the video.
const BOXES: AssetId = AssetId(1);

/// The colour of a box: the finer the redder.
fn colour(number: u32) -> [u8; 4] {
    let level = place_of(number).0;
    [250 - 50 * level, 40 + 50 * level, 0, 255]
}

/// Uploads and evicts boxes as a session says; the actions that are left are the video's.
fn perform(
    layer: &mut SceneLayer,
    actions: Vec<SessionAction>,
    cache: &mut Cache<Payload>,
) -> Vec<SessionAction> {
    let mut left = Vec::new();
    for action in actions {
        match action {
            SessionAction::Upload(piece) if piece.unit.asset == BOXES => {
                let payload = cache.take(piece).unwrap();
                let unit = piece.unit.unit;
                let coming = Coming {
                    unit,
                    object: 0,
                    level: place_of(unit.0).0,
                    needs: &[],
                    part: None,
                    payload: payload.view(),
                };
                assert!(layer.upload(&coming).unwrap());
                continue;
            }
            SessionAction::Show(piece) if piece.unit.asset == BOXES => {
                assert!(layer.show(piece.unit.unit));
                continue;
            }
            SessionAction::Keep {
                ref shown,
                ref staying,
            } => {
                let boxes = |units: &[UnitRef]| -> Vec<UnitId> {
                    let boxes = units.iter().filter(|it| it.asset == BOXES);
                    boxes.map(|it| it.unit).collect()
                };
                layer.keep(&boxes(shown).into_iter().collect(), &boxes(staying));
            }
            _ => {}
        }
        left.push(action);
    }
    left
}

/// What was fetched of each asset, beyond its coarsest level, and the pictures at the end: of both,
/// and of the video alone.
fn played(gpu: &Gpu, bytes_per_s: f64) -> ([u64; 2], [RgbaImage; 2]) {
    let video = Made::new(Projection::Flat, [256, 256], 64).build().unwrap();
    let contents: [Arc<dyn Content>; 2] = [Arc::clone(&video) as _, Arc::new(Boxes::default())];
    let device = DrawDevice::Gpu(gpu.clone());
    let mut drawer = Drawer::new(&device, &video, TileStyle::default()).unwrap();
    let nowhere = Arc::new(Placements::new(&[], |_, _| Default::default()));
    let boxes = Box::new(BoxLayer::new(gpu));
    let mut layer = SceneLayer::of_layers(gpu, vec![boxes], nowhere, 1 << 20).unwrap();
    let payload = |piece: Piece| match piece.unit {
        unit if unit.asset == BOXES => {
            Payload::Other(OtherPayload(Arc::new(BoxUnit(colour(unit.unit.0)))))
        }
        unit => {
            let [width, height] = video.grid().tile_size(video.pack().tile_of(unit.unit));
            Payload::Picture(Picture::filled(width, height, [90, 128, 128]))
        }
    };
    let at = |step| f64::from(step) * STEP_S;
    let steps = (0..40).map(|step| looking(at(step), at(step), Pace::Playing, [0.0; 2], SIDE));
    let steps: Vec<Now> = steps.collect();
    let link = (Policy::Perceptual, bytes_per_s);
    let fetched = play(&contents, link, &steps, payload, |actions, cache, now| {
        let left = perform(&mut layer, actions, cache);
        let (_, _) = drawer.perform(left, cache, now).unwrap();
        drawer.take_evicted()
    });
    let view = steps[0].moment.views[0];
    let alone = drawer.picture(&view, None).unwrap().unwrap();
    let under = drawer.draw(&view, None).unwrap();
    let both = layer.read_over(under, &view, &SceneStyle::default());
    (fetched, [both.unwrap().wait(gpu).unwrap(), alone])
}

#[test]
fn a_kind_from_outside_is_drawn_in_front_of_a_video_and_chosen_within_one_budget() {
    let gpu = Gpu::open_blocking().unwrap();
    let (fetched, [both, video]) = played(&gpu, 8000.0);
    assert!(fetched.iter().all(|bytes| *bytes > 0), "{fetched:?}");
    for at in [[2, 2], [SIDE - 3, 2], [2, SIDE - 3], [SIDE - 3; 2]] {
        assert_eq!(both.pixel(at), video.pixel(at), "{at:?}");
    }
    // Boxes are fine where the eye looks, and coarse next to it.
    let [beside, gazed] = [40, SIDE / 2].map(|x| both.pixel([x, SIDE / 2]));
    let level_of = |found| (0..5).find(|level| colour(first_of(*level)) == found);
    let [beside, gazed] = [beside, gazed].map(|it| level_of(it).unwrap());
    assert!(gazed < beside, "{gazed} {beside}");
    // A slow link brings less of both together.
    let (less, _) = played(&gpu, 500.0);
    assert!(less.iter().sum::<u64>() < fetched.iter().sum(), "{less:?}");
}

/// A box of a level.
fn first_of(level: u8) -> u32 {
    (level..4).fold(0, |number, _| 8 * number + 1)
}
