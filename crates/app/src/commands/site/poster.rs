//! Which picture stands for a pack in a list?
//!
//! What a viewer sees who has just opened it, drawn by the path that plays it: flat content whole,
//! a sphere towards its front.

use crate::gaze_source::{GazeChoice, GazeSource, ViewerModel};
use crate::options::renderer::{RendererName, open_device};
use crate::report::output;
use crate::run::open_player::open_player;
use anyhow::Context;
use foveal_core::content::demand::{Content, Demand};
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::content::scene::Scene;
use foveal_core::content::scene::demand::SceneDemand;
use foveal_core::content::unit::{AssetId, UnitRef};
use foveal_core::gaze::sample::GazeSample;
use foveal_core::pack::unit::UnitId;
use foveal_core::perception::moment::Moment;
use foveal_core::session::unit_states::Piece;
use foveal_core::units::{Radians, Seconds};
use foveal_core::view::axes::Axes;
use foveal_core::view::eye_view::{EyeView, Field};
use foveal_core::view::route::EyePose;
use foveal_core::view::surface::{Eye, Projection, Screen, Surface};
use foveal_media::pack::pack_file::PackFile;
use foveal_media::pack::scene_file::SceneFile;
use foveal_play::{FrameOptions, PlayerOptions};
use foveal_render::{DrawDevice, Drawer, RgbaImage};
use jpeg_encoder::{ColorType, Encoder, SamplingFactor};
use std::collections::HashSet;
use std::sync::Arc;

/// Columns of a poster: twice what a list shows, for dense screens.
const WIDTH: u32 = 640;
/// Rows that a poster has at most, however tall the content is.
const MOST_HEIGHT: u32 = 960;
/// Field of view of a sphere's poster, in degrees.
const FIELD_DEG: f64 = 100.0;
/// Field of view of a scene's poster, in degrees.
const SCENE_FIELD_DEG: f64 = 60.0;
/// Bytes on the GPU of what a poster shows of a scene, at most.
const MOST_GPU_BYTES: u64 = 256 << 20;
/// JPEG quality, 1 to 100.
const QUALITY: u8 = 82;
/// A clip often begins in black: the poster is taken this part of its length later.
const LATER: u32 = 10;

/// A poster as a JPEG file.
pub(super) struct Poster {
    pub(super) size: [u32; 2],
    pub(super) jpeg: Vec<u8>,
}

/// What draws posters: the GPU, or the CPU twin where there is no driver.
pub(super) fn drawing() -> DrawDevice {
    open_device(RendererName::Gpu).unwrap_or(DrawDevice::Twin)
}

/// Draws the poster of a video or picture.
pub(super) fn of_video(file: &Arc<PackFile>, drawing: &DrawDevice) -> anyhow::Result<Poster> {
    let about = file.pack().description();
    let (surface, frame) = (about.grid(Screen::default()).surface, about.frames / LATER);
    let view = view(&surface, Radians::from_degrees(about.front_deg));
    let config = PolicyConfig::new(Policy::Viewport);
    let player = PlayerOptions::new(config, drawing, output::say);
    let options = FrameOptions::new(player, view);
    let mut player = open_player(file, options)?;
    let ahead = GazeChoice::At([0.0, 0.0]);
    let until = player.time(frame);
    let mut gaze = GazeSource::new(&ahead, &surface, 0, until, &ViewerModel::default())?;
    let look = gaze.look(player.time(frame));
    player.show(frame, &look)?;
    let picture = player.drawer().picture(&view, None)?;
    encoded(&picture.context("nothing draws")?)
}

/// Draws the poster of a scene: all of it, as fine as the poster can show, damaged units left out.
pub(super) fn of_scene(file: &SceneFile, drawing: &DrawDevice) -> anyhow::Result<Poster> {
    let scene = file.scene();
    let view = towards(scene);
    let ahead = GazeSample {
        gaze_in_content: view.axes.forward,
        ..GazeSample::at(Seconds(0.0), Radians(0.0), Radians(0.0))
    };
    let config = PolicyConfig::new(Policy::Viewport);
    let mut demand = SceneDemand::new(Arc::clone(scene), &config);
    let wanted = demand.needed(0, &Moment::new(ahead, vec![view])).units;
    let mut drawer = Drawer::of_scene(drawing, scene, MOST_GPU_BYTES)?;
    let mut missing = HashSet::new();
    for unit in wanted {
        let is_alone = scene.needs(unit).iter().any(|need| missing.contains(need));
        match file.read_unit(unit) {
            Ok(payload) if !is_alone => drawer.upload(piece(unit), payload)?,
            _ => drop(missing.insert(unit)),
        }
    }
    let picture = drawer.picture(&view, None)?;
    encoded(&picture.context("nothing draws")?)
}

fn piece(unit: UnitId) -> Piece {
    let asset = AssetId::ONLY;
    Piece {
        unit: UnitRef { asset, unit },
        frame: 0,
    }
}

/// What a viewer of a scene sees who has just opened it.
fn towards(scene: &Scene) -> EyeView {
    let size = [WIDTH, WIDTH * 9 / 16];
    let field = Field::across(Radians::from_degrees(SCENE_FIELD_DEG), size);
    let bounds = scene.bounds();
    let pose = EyePose::before((bounds.centre, bounds.radius), scene.rise(), &field);
    EyeView {
        position: pose.position,
        axes: pose.axes,
        field,
        size,
        eye: Eye::Left,
    }
}

fn encoded(picture: &RgbaImage) -> anyhow::Result<Poster> {
    let mut jpeg = Vec::new();
    let mut encoder = Encoder::new(&mut jpeg, QUALITY);
    encoder.set_sampling_factor(SamplingFactor::R_4_2_0);
    encoder.set_optimized_huffman_tables(true);
    let [width, height] = picture.size.map(|side| side as u16);
    encoder.encode(&picture.pixels, width, height, ColorType::Rgba)?;
    Ok(Poster {
        size: picture.size,
        jpeg,
    })
}

fn view(surface: &Surface, front: Radians) -> EyeView {
    match surface.projection {
        Projection::Flat => {
            let height = f64::from(WIDTH) * surface.tangents[1] / surface.tangents[0];
            let height = (height.round() as u32).clamp(1, MOST_HEIGHT);
            EyeView::filling(surface, [WIDTH, height])
        }
        Projection::Cube | Projection::Equirect => {
            let size = [WIDTH, WIDTH * 9 / 16];
            EyeView {
                position: Default::default(),
                axes: Axes::from_yaw_pitch_roll(front, Radians(0.0), Radians(0.0)),
                field: Field::across(Radians::from_degrees(FIELD_DEG), size),
                size,
                eye: Eye::Left,
            }
        }
    }
}
