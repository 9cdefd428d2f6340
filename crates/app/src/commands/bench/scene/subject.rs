//! What is measured: a scene, its source, and its pack?

use crate::run::mesh_file::ply;
use anyhow::{Context, bail};
use foveal_media::pack::pack::Pack;
use foveal_media::pack::scene_file::SceneFile;
use foveal_scene::baseline::{FinestMesh, finest_meshes};
use foveal_scene::generate::torus;
use foveal_scene::read::{ReadOptions, read};
use foveal_scene::source::SourceScene;
use serde_json::Value;
use std::path::Path;
use std::process::Command;
use std::sync::Arc;

/// Vertices round and along the torus that is drawn: 262,144 triangles.
const TORUS: [u32; 2] = [512, 256];

/// A scene that is measured.
pub(super) struct Subject {
    /// What it is called: the file, without its folder.
    pub(super) name: String,
    /// What was read of its files; nothing of a pack.
    pub(super) source: Option<SourceScene>,
    /// The most memory that preparing took on one thread, in bytes.
    pub(super) prepare_peak: Option<f64>,
    pub(super) file: Arc<SceneFile>,
    /// Its finest level, object by object.
    pub(super) finest: Vec<FinestMesh>,
}

impl Subject {
    /// Reads a pack as it is; of 3D files, or of a drawn torus, writes one to `pack`.
    pub(super) fn prepare(input: Option<&Path>, pack: &Path) -> anyhow::Result<Self> {
        let drawn = pack.with_file_name("torus.ply");
        let input = match input {
            Some(input) if Pack::open(input).is_ok_and(|it| it.scene().is_some()) => {
                return Self::of(input, None, None, input);
            }
            Some(input) => input,
            None => {
                std::fs::write(&drawn, ply(&torus(TORUS[0], TORUS[1])))?;
                &drawn
            }
        };
        let source = read(&[input], &ReadOptions::default())?;
        let told = prepare_apart(input, pack)?;
        let peak = told["peak_memory_bytes"].as_f64();
        Self::of(input, Some(source), peak, pack)
    }

    fn of(
        input: &Path,
        source: Option<SourceScene>,
        prepare_peak: Option<f64>,
        pack: &Path,
    ) -> anyhow::Result<Self> {
        let file = SceneFile::open(pack)?;
        let objects = file.pack().description().objects.iter();
        let attributes: Vec<_> = objects.map(|it| it.attributes).collect();
        let mut payload_of = |unit| file.read_mesh(unit).map_err(anyhow::Error::from);
        let finest = finest_meshes(file.pack().rows(), &attributes, &mut payload_of)?;
        let name = input.file_name().unwrap_or_default();
        Ok(Self {
            name: name.to_string_lossy().into_owned(),
            source,
            prepare_peak,
            finest,
            file: Arc::new(file),
        })
    }

    /// Triangles of the finest level.
    pub(super) fn leaves(&self) -> f64 {
        self.finest.iter().map(|it| it.triangles.len() as f64).sum()
    }
}

/// Prepares in a process of its own, whose peak of memory is that of preparing alone.
fn prepare_apart(input: &Path, pack: &Path) -> anyhow::Result<Value> {
    let program = std::env::current_exe().context("this program cannot be found")?;
    let mut command = Command::new(program);
    command.args(["prepare", "scene"]).arg(input);
    command.arg("--out").arg(pack);
    command.args(["--jobs", "1", "--json"]);
    let done = command
        .output()
        .context("foveal prepare cannot be started")?;
    if !done.status.success() {
        let said = String::from_utf8_lossy(&done.stderr);
        bail!("{}: cannot be prepared: {}", input.display(), said.trim());
    }
    Ok(serde_json::from_slice(&done.stdout)?)
}
