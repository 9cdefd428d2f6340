//! How does a generated scene become a video file, or a picture?

use crate::report::output::{self, Counting};
use crate::report::picture_file::write_png;
use anyhow::Context;
use foveal_core::view::picture::{Colour, Matrix};
use foveal_media::generate::{FRAMES_PER_SECOND, GeneratedScene as Scene};
use foveal_media::plain_file::rename_durably;
use foveal_media::{ClipCodec, ClipFormat, ClipWriter};
use foveal_render::RgbaImage;
use std::path::Path;

/// Colour of generated scenes.
const SCENE_COLOUR: Colour = Colour {
    matrix: Matrix::Bt709,
    full_range: false,
    chroma_left: false,
};

/// Draws a scene into a video file; where that fails or is stopped, none is left under that name.
pub(crate) fn write_scene(
    scene: &Scene,
    size: [u32; 2],
    frames: u32,
    path: &Path,
) -> anyhow::Result<()> {
    output::say(&format!("{}: is being drawn", path.display()));
    let partial = path.with_extension("partial.mkv");
    if let Err(error) = draw_scene(scene, size, frames, &partial) {
        // What could not be written may not even be there.
        let _ = std::fs::remove_file(&partial);
        return Err(error);
    }
    rename_durably(&partial, path)
        .with_context(|| format!("{}: cannot be given its name", partial.display()))
}

/// Draws the first frame of a scene into a PNG file, whole or not at all.
pub(crate) fn write_still(scene: &Scene, path: &Path) -> anyhow::Result<()> {
    output::say(&format!("{}: is being drawn", path.display()));
    let picture = RgbaImage::from_planes(&scene.frame(0), SCENE_COLOUR);
    write_png(path, &picture)
}

/// Frame by frame, so that one picture at a time is in memory.
fn draw_scene(scene: &Scene, size: [u32; 2], frames: u32, path: &Path) -> anyhow::Result<()> {
    let format = ClipFormat {
        codec: ClipCodec::Ffv1,
        size,
        frame_rate: [FRAMES_PER_SECOND as i32, 1],
        colour: SCENE_COLOUR,
    };
    let bar = output::bar(Some(u64::from(frames)), Counting::Frames);
    let mut clip = ClipWriter::create(path, &format)?;
    for number in 0..u64::from(frames) {
        clip.push(&scene.frame(number))?;
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(clip.finish()?)
}
