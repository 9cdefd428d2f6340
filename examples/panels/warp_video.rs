//! Warps a video to the panels of a rig, with the libraries alone: what `foveal panels warp` does.
//!
//!     cargo run --release --example warp_video -- examples/panels/three.toml clip.mp4 out
//!
//! Leaves `out/00000.png` and so on: all panels of the left eye side by side, as they are sent.

use foveal_core::view::panel::fit::{PlacementRule, SourceSize, fit};
use foveal_core::view::panel::rig::Panel;
use foveal_core::view::surface::Eye;
use foveal_media::VideoInput;
use foveal_render::warp::{PanelOnSource, SourceTexture, WarpFilter, WarpPlan, WarpStyle, Warper};
use foveal_render::{Gpu, RgbaImage};
use foveal_scene::rig::read_rig;
use std::error::Error;
use std::fs::File;
use std::path::{Path, PathBuf};

fn main() -> Result<(), Box<dyn Error>> {
    let given: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [rig, video, out] = &given[..] else {
        return Err("give a rig, a video and a folder".into());
    };
    let rig = read_rig(rig)?;
    let panels: Vec<&Panel> = rig.seen_by(Some(Eye::Left));
    let mut video = VideoInput::open(video)?;
    let size = [video.info().width, video.info().height];
    let colour = video.info().colour;
    // Where the video lies before the eye, such that all panels look at it.
    let placed = fit(&panels, PlacementRule::Auto, SourceSize::Picture(size))?;
    let mut across = 0;
    let on_source = panels.iter().map(|panel| {
        let origin = [across, 0];
        across += panel.sent_size()[0];
        PanelOnSource {
            panel,
            placement: &placed.placement,
            part: [0, 0, size[0], size[1]],
            origin,
        }
    });
    let plan = WarpPlan::new(&on_source.collect::<Vec<_>>());
    let style = WarpStyle {
        filter: WarpFilter::Auto,
        ..WarpStyle::default()
    };
    let gpu = Gpu::open_blocking()?;
    let warper = Warper::new(&gpu);
    let loaded = warper.load(&plan)?;
    let source = SourceTexture::new(&gpu, size, style.filter.reads_levels())?;
    std::fs::create_dir_all(out)?;
    let mut frame = 0;
    while let Some(timed) = video.next_frame()? {
        source.write(&gpu, &RgbaImage::from_planes(&timed.picture, colour))?;
        let atlas = warper.read(&loaded, &source, &style).wait(&gpu)?;
        write_png(&out.join(format!("{frame:05}.png")), &atlas)?;
        frame += 1;
    }
    Ok(())
}

fn write_png(path: &Path, image: &RgbaImage) -> Result<(), Box<dyn Error>> {
    let mut encoder = png::Encoder::new(File::create(path)?, image.size[0], image.size[1]);
    encoder.set_color(png::ColorType::Rgba);
    encoder.write_header()?.write_image_data(&image.pixels)?;
    Ok(())
}
