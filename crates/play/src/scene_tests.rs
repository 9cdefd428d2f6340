//! Does what comes glide into its place before an open eye, and jump there before a closed one?

use crate::options::PlayerOptions;
use crate::player::Player;
use foveal_core::content::mesh::payload::{Attributes, Cluster, MeshUnit, MeshVertex};
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::content::scene::description::{
    Grid, KIND, ObjectBounds, SceneDescription, SceneObject, Shape,
};
use foveal_core::content::scene::pack::{begin_scene, chunk_name, finish_scene};
use foveal_core::content::scene::part_ref::PartRef;
use foveal_core::content::scene::unit_table::UnitRow;
use foveal_core::gaze::sample::GazeSample;
use foveal_core::pack::unit::UnitId;
use foveal_core::perception::moment::Moment;
use foveal_core::perception::parameters::EyeState;
use foveal_core::units::{Radians, Seconds};
use foveal_core::view::axes::Axes;
use foveal_core::view::eye_view::{EyeView, Field};
use foveal_media::pack::scene_file::SceneFile;
use foveal_render::{DrawDevice, RgbaImage};
use std::path::PathBuf;
use std::sync::Arc;

/// A square of two triangles, and in its place a roof of four.
fn roof() -> Vec<u8> {
    let at = |place| MeshVertex {
        place,
        ..MeshVertex::default()
    };
    let flat = [[0, 0, 0], [1000, 0, 0], [1000, 1000, 0], [0, 1000, 0]];
    let cluster = |vertices: u16, triangles: &[[u8; 3]]| Cluster {
        vertices: (0..vertices).collect(),
        triangles: triangles.to_vec(),
    };
    let square = MeshUnit {
        vertices: flat.map(at).to_vec(),
        clusters: vec![cluster(4, &[[0, 1, 2], [0, 2, 3]])],
        ..MeshUnit::default()
    };
    let replaces = vec![PartRef { need: 0, part: 0 }];
    let roof = MeshUnit {
        replaces: replaces.clone(),
        staying: 4,
        vertices: vec![at([500, 500, 400])],
        clusters: vec![cluster(5, &[[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])],
    };
    let about = about();
    let row = |samples, error, needs, replaces| UnitRow {
        centre: [0.5; 3],
        radius: 1.0,
        error,
        samples,
        vertices: 5,
        needs,
        replaces,
        ..UnitRow::default()
    };
    let rows = [
        row(2, f32::INFINITY, Vec::new(), Vec::new()),
        row(4, 0.4, vec![UnitId(0)], replaces),
    ];
    let mut builder = begin_scene(&about);
    let chunks = [square, roof].map(|unit| unit.write(Attributes::default()).unwrap());
    for (chunk, unit) in chunks.iter().zip(0..) {
        builder.push(chunk_name(UnitId(unit)), chunk);
    }
    let parts = finish_scene(builder, about, &rows).unwrap();
    [parts.head, chunks.concat(), parts.tail].concat()
}

fn about() -> SceneDescription {
    let object = SceneObject {
        name: "roof".to_owned(),
        shape: Shape::Mesh { leaf_triangles: 4 },
        bounds: ObjectBounds {
            centre: [0.5, 0.5, 0.0],
            radius: 1.0,
            half: [0.0; 3],
        },
        grid: Grid {
            origin: [0.0; 3],
            step: 0.001,
            bits: 10,
        },
        attributes: Attributes::default(),
        colour: [0.5, 0.5, 0.5, 1.0],
        two_sided: false,
        unlit: false,
        texturing: None,
        placements: vec![[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]],
    };
    SceneDescription {
        kind: KIND.to_owned(),
        needs: vec![KIND.to_owned()],
        generator: "test".to_owned(),
        source: Default::default(),
        textures: Vec::new(),
        parts: Vec::new(),
        joined: Default::default(),
        objects: vec![object],
        units: vec![1, 1],
        page: 16,
        look: Default::default(),
        identity: Default::default(),
        remarks: Vec::new(),
        repairs: Default::default(),
        tables: Vec::new(),
    }
}

/// A file that goes with the test.
struct Held(PathBuf);

impl Drop for Held {
    fn drop(&mut self) {
        // What a test leaves behind does no harm.
        let _ = std::fs::remove_file(&self.0);
    }
}

fn held(name: &str) -> Held {
    let path = std::env::temp_dir().join(format!("foveal-{name}-{}", std::process::id()));
    std::fs::write(&path, roof()).unwrap();
    Held(path)
}

/// Under a link that brings the root at once and the roof after some steps.
fn player(held: &Held) -> Player {
    let config = PolicyConfig::new(Policy::Uniform);
    let options = PlayerOptions {
        bytes_per_s: 100.0,
        gpu_bytes: 1 << 20,
        ..PlayerOptions::new(config, &DrawDevice::Twin, |_| ())
    };
    let file = Arc::new(SceneFile::open(&held.0).unwrap());
    Player::of_scene(&file, options).unwrap()
}

fn moment(time: f64, state: EyeState) -> Moment {
    let size = [96, 64];
    let view = EyeView {
        position: glam::DVec3::new(0.5, 0.3, 2.0),
        axes: Axes::FRONT,
        field: Field::across(Radians::from_degrees(50.0), size),
        size,
        eye: Default::default(),
    };
    let gaze = GazeSample::at(Seconds(time), Radians(0.0), Radians(0.0));
    Moment {
        state,
        ..Moment::new(gaze, vec![view])
    }
}

/// Plays until the roof comes, at the returned time.
fn until_it_comes(player: &mut Player, state: EyeState) -> f64 {
    for step in 0..200 {
        let time = 0.05 * f64::from(step);
        let report = player.stand(Seconds(time), &moment(time, state)).unwrap();
        if report.units_by_level == [1, 1] {
            return time;
        }
    }
    panic!("it does not come");
}

fn picture(player: &mut Player) -> RgbaImage {
    let view = moment(0.0, EyeState::Steady).views[0];
    player.picture(&view, false).unwrap().unwrap()
}

#[test]
fn before_an_eye_that_rests_what_comes_takes_a_fifth_of_a_second_to_its_place() {
    let held = held("glide");
    let mut player = player(&held);
    player
        .stand(Seconds(0.0), &moment(0.0, EyeState::Steady))
        .unwrap();
    let coarse = picture(&mut player);
    let came = until_it_comes(&mut player, EyeState::Steady);
    assert!(came > 0.0 && player.drawer().is_morphing());
    let view = moment(0.0, EyeState::Steady).views[0];
    let fine = player.picture_in_place(&view).unwrap().unwrap();
    assert_ne!(fine, coarse);
    let mut show = |time: f64, state| {
        player.stand(Seconds(time), &moment(time, state)).unwrap();
        (picture(&mut player), player.drawer().is_morphing())
    };
    let (begins, _) = show(came, EyeState::Steady);
    assert_eq!(begins, coarse);
    let (half, is_morphing) = show(came + 0.1, EyeState::Steady);
    assert!(half != coarse && half != fine && is_morphing);
    assert_eq!(show(came + 0.21, EyeState::Steady), (fine, false));
}

#[test]
fn in_a_saccade_what_comes_is_in_its_place_at_once() {
    for state in [EyeState::Jumping, EyeState::Landed] {
        let held = held(&format!("jump-{state:?}"));
        let mut player = player(&held);
        until_it_comes(&mut player, state);
        assert!(!player.drawer().is_morphing());
        let view = moment(0.0, state).views[0];
        let fine = player.picture_in_place(&view).unwrap().unwrap();
        assert_eq!(picture(&mut player), fine);
    }
}

#[test]
fn a_saccade_ends_what_is_on_its_way() {
    let held = held("ended");
    let mut player = player(&held);
    let came = until_it_comes(&mut player, EyeState::Steady);
    assert!(player.drawer().is_morphing());
    let time = came + 0.05;
    player
        .stand(Seconds(time), &moment(time, EyeState::Jumping))
        .unwrap();
    assert!(!player.drawer().is_morphing());
}
