//! A pack and a gaze in, a PNG out: `cargo run -p foveal-play --example picture PACK YAW PITCH
//! OUT`; the gaze in degrees right of and above the content's forward.

use foveal_core::content::policy::{Policy, asked::Detail};
use foveal_core::gaze::sample::{GazeSample, HeadPose};
use foveal_core::units::{Radians, Seconds};
use foveal_core::view::eye_view::EyeView;
use foveal_media::pack::pack_file::PackFile;
use foveal_play::{FrameOptions, FramePlayer, PlayerOptions, WatchedFrame};
use foveal_render::DrawDevice;
use std::{env, fs::File, path::Path, sync::Arc};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [pack, yaw, pitch, out] = arguments.as_slice() else {
        return Err("give PACK YAW PITCH OUT.png".into());
    };
    let [yaw, pitch] = [yaw.parse()?, pitch.parse()?].map(Radians::from_degrees);
    let file = Arc::new(PackFile::open(Path::new(pack))?);
    let config = Detail::Usual.of(Policy::Perceptual);
    let options = PlayerOptions::new(config, &DrawDevice::Twin, |_| {});
    let view = EyeView::filling(&file.pack().grid().surface, [1280, 720]);
    let mut player = FramePlayer::new(&file, FrameOptions::new(options, view))?;
    let gaze = GazeSample::at(Seconds(0.0), yaw, pitch);
    let shown = player.show(0, &WatchedFrame::known(gaze, HeadPose::default()))?;
    let image = player.drawer().picture(&shown.view, None)?;
    let image = image.ok_or("the twin draws")?;
    let mut png = png::Encoder::new(File::create(out)?, image.size[0], image.size[1]);
    png.set_color(png::ColorType::Rgba);
    Ok(png.write_header()?.write_image_data(&image.pixels)?)
}
