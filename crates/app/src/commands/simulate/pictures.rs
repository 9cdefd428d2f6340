//! Which pictures of a run are written, and where?

use crate::commands::simulate::options::{SimulateArgs, WrittenPictures};
use crate::report::picture_file::write_png;
use crate::run::optics::as_seen;
use crate::run::run_folder::{VIDEO, picture_name};
use foveal_core::gaze::sample::GazeSample;
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::panel::rig::Panel;
use foveal_core::view::picture::{Colour, Matrix};
use foveal_media::write::picture_from_rgba::picture_from_rgba;
use foveal_media::{ClipCodec, ClipFormat, ClipWriter};
use foveal_play::{FramePlayer, FrameReport};
use foveal_render::warp::PanelOptics;
use foveal_render::{Overlay, RgbaImage};
use std::path::PathBuf;

/// The marks of a heat map: levels, borders, and a ring of 2.5° (the fovea) round the gaze.
pub(crate) fn marks(view: &EyeView, gaze: &GazeSample) -> Overlay {
    let direction = gaze.gaze_in_content;
    let place = view.place(direction).unwrap_or([-1e6; 2]);
    let radius = view.ppd_towards(direction).0 * 2.5;
    Overlay {
        gaze: place.map(|place| place as f32),
        gaze_radius: radius as f32,
        borders: 0.5,
        ..Overlay::default()
    }
}

/// The pictures of a run: of its view, or of each of its panels.
pub(crate) struct PictureSinks<'a> {
    args: &'a SimulateArgs,
    /// What panels make of what they reach; of a view nothing.
    optics: Option<PanelOptics>,
    /// One for each view of a frame.
    sinks: Vec<PictureSink>,
}

/// Where the pictures of one view go.
struct PictureSink {
    folder: PathBuf,
    /// Frames a second, as a fraction.
    rate: [u32; 2],
    video: Option<ClipWriter>,
}

/// Colour of written videos: what RGB becomes.
const VIDEO_COLOUR: Colour = Colour {
    matrix: Matrix::Bt709,
    full_range: false,
    chroma_left: false,
};
/// Quantiser of written videos: visually lossless.
const VIDEO_QUALITY: u8 = 16;

impl<'a> PictureSinks<'a> {
    /// Makes the folders: the one that was asked for, and in it one for each panel.
    pub(crate) fn new(
        args: &'a SimulateArgs,
        frame_rate: [u32; 2],
        panels: Option<&[Panel]>,
    ) -> anyhow::Result<Self> {
        let [frames, seconds] = frame_rate;
        let folders = args.folders(panels)?;
        let sink = |folder| PictureSink {
            folder,
            rate: [frames, seconds.saturating_mul(args.every)],
            video: None,
        };
        Ok(Self {
            args,
            optics: panels.map(as_seen),
            sinks: folders.into_iter().map(sink).collect(),
        })
    }

    /// Draws and writes what the frame of a picture shows, by its number from 0.
    pub(crate) fn frame(
        &mut self,
        player: &mut FramePlayer,
        picture: u32,
        report: &FrameReport,
    ) -> anyhow::Result<()> {
        let args = self.args;
        let number = args.start.saturating_add(picture);
        let is_left_out = !picture.is_multiple_of(args.every);
        if args.pictures == WrittenPictures::None || is_left_out {
            return Ok(());
        }
        for (at, (sink, view)) in self.sinks.iter_mut().zip(&report.views).enumerate() {
            let eyes = match self.optics.is_some() {
                true => std::slice::from_ref(&view.eye),
                false => args.eye.eyes(),
            };
            let mut picture: Option<RgbaImage> = None;
            for eye in eyes {
                let view = EyeView { eye: *eye, ..*view };
                let marks = args.heat_map.then(|| marks(&view, &report.gaze));
                let drawn = player.drawer().picture(&view, marks.as_ref())?;
                picture = match (picture, drawn) {
                    (Some(left), Some(right)) => Some(left.beside(&right)),
                    (None, drawn) => drawn,
                    (left, None) => left,
                };
            }
            let device = player.drawer().device().clone();
            let picture = picture.map(|image| match &mut self.optics {
                Some(optics) => optics.image(&device, at, image),
                None => Ok(image),
            });
            match picture.transpose()? {
                Some(image) if args.pictures == WrittenPictures::Png => {
                    write_png(&sink.folder.join(picture_name(number)), &image)?;
                }
                Some(image) => sink.append(&image)?,
                None => {}
            }
        }
        Ok(())
    }

    pub(crate) fn finish(self) -> anyhow::Result<()> {
        for sink in self.sinks {
            sink.video.map_or(Ok(()), ClipWriter::finish)?;
        }
        Ok(())
    }
}

impl PictureSink {
    fn append(&mut self, image: &RgbaImage) -> anyhow::Result<()> {
        let picture = picture_from_rgba(&image.pixels, image.size, VIDEO_COLOUR);
        if self.video.is_none() {
            self.video = Some(ClipWriter::create(
                &self.folder.join(VIDEO),
                &ClipFormat {
                    codec: ClipCodec::Vp9(VIDEO_QUALITY),
                    size: image.size,
                    frame_rate: self.rate.map(|n| n.min(i32::MAX as u32) as i32),
                    colour: VIDEO_COLOUR,
                },
            )?);
        }
        match &mut self.video {
            Some(video) => Ok(video.push(&picture)?),
            None => Ok(()),
        }
    }
}
