//! Do a video and a scene share one picture, and one budget?

use crate::common::playing::play;
use crate::common::share_beyond;
use crate::common::torus::{ALL, object, refinement, root};
use crate::made_video::Made;
use foveal_core::content::demand::Content;
use foveal_core::content::mesh::payload::MeshUnit;
use foveal_core::content::payload::Payload;
use foveal_core::content::policy::Policy;
use foveal_core::content::scene::Scene;
use foveal_core::content::scene::description::{
    KIND, ObjectBounds, SceneDescription, SceneObject, SceneSource,
};
use foveal_core::content::scene::pack::{ScenePack, begin_scene, chunk_name, finish_scene};
use foveal_core::content::scene::unit_table::UnitRow;
use foveal_core::content::unit::AssetId;
use foveal_core::content::video::Video;
use foveal_core::gaze::sample::GazeSample;
use foveal_core::pack::unit::UnitId;
use foveal_core::pack::{HEADER_BYTES, Header};
use foveal_core::perception::moment::Moment;
use foveal_core::session::actions::{Now, Pace, SessionAction};
use foveal_core::session::unit_states::Piece;
use foveal_core::units::{Radians, Seconds};
use foveal_core::view::axes::Axes;
use foveal_core::view::eye_view::{EyeView, Field};
use foveal_core::view::picture::Picture;
use foveal_core::view::surface::Projection;
use foveal_render::{DrawDevice, Drawer, Gpu, RgbaImage, TileStyle};
use glam::{DAffine3, DVec3};
use std::sync::Arc;

const SIZE: [u32; 2] = [160, 120];
/// What a link brings: all of both assets in some steps.
const BYTES_PER_S: f64 = 8000.0;
const STEP_S: f64 = 0.1;
const STEPS: u32 = 40;
/// The first asset; the second is the scene.
const VIDEO: AssetId = AssetId(0);

/// A torus four metres ahead, its root and a unit that refines each quarter of it.
fn units() -> Vec<MeshUnit> {
    let quarters = [0_u8, 4, 8, 12].map(|first| [first, first + 1, first + 2, first + 3]);
    let finer = quarters.iter().map(|clusters| refinement(clusters));
    std::iter::once(root()).chain(finer).collect()
}

fn scene(units: &[MeshUnit]) -> Arc<Scene> {
    let standing = DAffine3::from_translation(DVec3::new(0.0, 0.0, -4.0))
        * DAffine3::from_rotation_x(std::f64::consts::FRAC_PI_2);
    let description = SceneDescription {
        kind: KIND.to_owned(),
        needs: vec![KIND.to_owned()],
        generator: "a test".to_owned(),
        source: SceneSource::default(),
        objects: vec![SceneObject {
            bounds: ObjectBounds {
                centre: [0.0; 3],
                radius: 1.5,
                half: [0.0; 3],
            },
            placements: vec![standing.to_cols_array()],
            ..object(ALL)
        }],
        textures: Vec::new(),
        parts: Vec::new(),
        joined: Default::default(),
        units: vec![4, 1],
        page: 16,
        look: Default::default(),
        identity: Default::default(),
        remarks: Vec::new(),
        repairs: Default::default(),
        tables: Vec::new(),
    };
    let row = |unit: &MeshUnit| {
        let is_root = unit.replaces.is_empty();
        let triangles = unit.clusters.iter().map(|it| it.triangles.len() as u32);
        UnitRow {
            radius: 1.5,
            error: if is_root { f32::INFINITY } else { 0.05 },
            samples: triangles.sum(),
            vertices: unit.vertices.len() as u32,
            needs: if is_root { Vec::new() } else { vec![UnitId(0)] },
            replaces: unit.replaces.clone(),
            ..UnitRow::default()
        }
    };
    let rows: Vec<UnitRow> = units.iter().map(row).collect();
    let mut builder = begin_scene(&description);
    for (number, unit) in (0..).map(UnitId).zip(units) {
        builder.push(chunk_name(number), &unit.write(ALL).unwrap());
    }
    let parts = finish_scene(builder, description, &rows).unwrap();
    let header = Header::parse(&parts.head).unwrap();
    let about = ScenePack::describe(&header, &parts.head[HEADER_BYTES..]).unwrap();
    let table = about.units_table().unwrap();
    let (index, rest) = parts.tail.split_at(header.index_bytes as usize);
    let table = &rest[..table.bytes as usize];
    let pack = ScenePack::new(&header, about, index, table).unwrap();
    Arc::new(Scene::new("torus.foveal", Arc::new(pack)))
}

fn now(step: u32) -> Now {
    let at = Seconds(f64::from(step) * STEP_S);
    let view = EyeView {
        position: DVec3::ZERO,
        axes: Axes::FRONT,
        field: Field::across(Radians::from_degrees(60.0), SIZE),
        size: SIZE,
        eye: Default::default(),
    };
    Now {
        wall: at,
        media: Seconds(0.0),
        pace: Pace::Standing,
        drawing: Seconds(0.0),
        until: at,
        moment: Moment::new(GazeSample::at(at, Radians(0.0), Radians(0.0)), vec![view]),
    }
}

/// What a unit says: tiles are grey, the finer the lighter.
fn payload(video: &Video, units: &[MeshUnit], piece: Piece) -> Payload {
    let unit = piece.unit.unit;
    match piece.unit.asset {
        VIDEO => {
            let tile = video.pack().tile_of(unit);
            let [width, height] = video.grid().tile_size(tile);
            let grey = 200 - 40 * tile.level;
            Payload::Picture(Picture::filled(width, height, [grey, 128, 128]))
        }
        _ => Payload::Mesh(units[unit.0 as usize].clone()),
    }
}

/// What was fetched of each asset, beyond its coarsest level, and the picture at the end.
fn played(device: &DrawDevice, bytes_per_s: f64) -> ([u64; 2], RgbaImage, RgbaImage) {
    let units = units();
    let scene = scene(&units);
    let video = Made::new(Projection::Flat, [256, 256], 64).build().unwrap();
    let contents: [Arc<dyn Content>; 2] = [Arc::clone(&video) as _, Arc::clone(&scene) as _];
    let style = TileStyle::default();
    let alone = || Drawer::new(device, &video, style).unwrap();
    let of_scene = Drawer::of_scene(device, &scene, 1 << 24).unwrap();
    let mut drawers = [alone().then(of_scene), alone()];
    let steps: Vec<Now> = (0..STEPS).map(now).collect();
    let payload = |piece| payload(&video, &units, piece);
    let link = (Policy::Uniform, bytes_per_s);
    let fetched = play(&contents, link, &steps, payload, |actions, cache, now| {
        for action in &actions {
            match action {
                SessionAction::Upload(piece) if piece.unit.asset == VIDEO => {
                    drawers[1].upload(*piece, payload(*piece)).unwrap();
                }
                _ => {}
            }
        }
        let (_, _) = drawers[0].perform(actions, cache, now).unwrap();
        drawers[0].take_evicted()
    });
    let view = now(0).moment.views[0];
    let [both, video] = drawers.each_mut().map(|drawer| {
        let picture = drawer.picture(&view, None).unwrap();
        picture.unwrap()
    });
    (fetched, both, video)
}

#[test]
fn a_video_and_a_scene_are_shown_in_one_picture_and_chosen_within_one_budget() {
    let gpu = DrawDevice::Gpu(Gpu::open_blocking().unwrap());
    let [(fetched, both, video), (_, by_twin, _)] =
        [&gpu, &DrawDevice::Twin].map(|device| played(device, BYTES_PER_S));
    assert!(fetched.iter().all(|bytes| *bytes > 0), "{fetched:?}");
    assert!(share_beyond(&both, &by_twin, 3) <= 0.01);
    // The torus covers a ring of the video, which shows through its middle and around it.
    for at in [[80, 60], [5, 5], [155, 115]] {
        assert_eq!(both.pixel(at), video.pixel(at), "{at:?}");
    }
    let changed = share_beyond(&both, &video, 3);
    assert!((0.05..0.5).contains(&changed), "{changed}");
    // Both are paid from one purse: a slow link brings less of them together.
    let (less, ..) = played(&DrawDevice::Twin, BYTES_PER_S / 64.0);
    assert!(
        less.iter().sum::<u64>() < fetched.iter().sum(),
        "{less:?} of {fetched:?}"
    );
}
