//! How much memory do preparing and playing take?

use super::conditions::BenchConditions;
use super::drawing::player;
use super::place::SIZE;
use super::row::{BenchRow, Turns};
use super::subject::Subject;
use crate::report::output;
use foveal_core::content::policy::Policy;
use foveal_core::content::policy::asked::Detail;
use foveal_core::content::scene::description::SceneTexture;
use foveal_core::gaze::sample::GazeSample;
use foveal_core::perception::moment::Moment;
use foveal_core::units::{Radians, Seconds};
use foveal_core::view::axes::Axes;
use foveal_core::view::eye_view::{EyeView, Field};
use foveal_core::view::route::Route;
use foveal_render::DrawDevice;
use foveal_scene::source::{SourceCloud, SourceMesh};

/// What preparing may take: so many times the decoded source, and so many bytes besides.
const TIMES: f64 = 8.0;
const BESIDES: f64 = 300e6;
/// What `--gpu-memory` allows while the scene is played, in bytes.
const GPU_BYTES: u64 = 32_000_000;
/// Once round the scene, second by second.
const SECONDS: u32 = 12;

/// The peak of preparing on one thread, and of the GPU while playing.
pub(super) fn memory(
    subject: &Subject,
    conditions: &BenchConditions,
) -> anyhow::Result<Vec<BenchRow>> {
    let mut rows = Vec::new();
    if let (Some(source), Some(peak)) = (&subject.source, subject.prepare_peak) {
        let meshes = source.meshes.iter().map(decoded_bytes);
        let textures = subject.file.pack().description().textures.iter();
        let textures = textures.map(texture_bytes);
        let clouds = source.clouds.iter().map(cloud_bytes);
        let decoded: f64 = meshes.chain(clouds).chain(textures).sum();
        let turns = Turns::once(peak, Some(TIMES * decoded + BESIDES));
        let what = "peak of prepare, of 8 times the decoded source and 300 MB";
        let row = turns.row(&subject.name, what, "bytes").asked("ratio <= 1");
        rows.push(row.with("decoded_bytes", decoded));
    } else {
        output::say(&format!(
            "{}: the peak of prepare is not known",
            subject.name
        ));
    }
    if matches!(conditions.drawing, DrawDevice::Gpu(_)) {
        let turns = Turns::once(most_gpu_bytes(subject, conditions)?, Some(GPU_BYTES as f64));
        let what = "GPU memory while playing, of --gpu-memory 32MB";
        rows.push(turns.row(&subject.name, what, "bytes").asked("ratio <= 1"));
    }
    Ok(rows)
}

/// What a cloud takes in memory as it was read.
fn cloud_bytes(cloud: &SourceCloud) -> f64 {
    let bytes = size_of_val(&cloud.places[..])
        + size_of_val(&cloud.colours[..])
        + size_of_val(&cloud.intensities[..])
        + size_of_val(&cloud.classes[..]);
    bytes as f64
}

/// What a texture takes in memory once it is decoded, without alpha.
fn texture_bytes(texture: &SceneTexture) -> f64 {
    3.0 * texture.size.map(f64::from).iter().product::<f64>()
}

/// What a mesh takes in memory as it was read.
fn decoded_bytes(mesh: &SourceMesh) -> f64 {
    let bytes = size_of_val(&mesh.positions[..])
        + size_of_val(&mesh.normals[..])
        + size_of_val(&mesh.colours[..])
        + size_of_val(&mesh.uvs[..])
        + size_of_val(&mesh.triangles[..])
        + size_of_val(&mesh.materials[..]);
    bytes as f64
}

fn most_gpu_bytes(subject: &Subject, conditions: &BenchConditions) -> anyhow::Result<f64> {
    let mut player = player(
        subject,
        conditions,
        Detail::Usual.of(Policy::Viewport),
        GPU_BYTES,
    )?;
    let bounds = subject.file.scene().bounds();
    let view = EyeView {
        position: Default::default(),
        axes: Axes::FRONT,
        field: Field::across(Radians::from_degrees(90.0), SIZE),
        size: SIZE,
        eye: Default::default(),
    };
    let mut most = 0;
    for second in 0..SECONDS {
        let time = Seconds(f64::from(second));
        let pose = Route::Orbit.pose(time, (bounds.centre, bounds.radius), &view.field);
        let gaze = GazeSample {
            gaze_in_content: pose.axes.forward,
            ..GazeSample::at(time, Radians(0.0), Radians(0.0))
        };
        player.stand(time, &Moment::new(gaze, vec![pose.view(&view)]))?;
        most = most.max(player.drawer().gpu_bytes());
    }
    Ok(most as f64)
}
