//! Which pictures and files do the tests of this crate read?

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use av::format::Pixel;
use ffmpeg_next as av;
use foveal_core::view::picture::{Colour, Matrix, Picture, plane_size};

use foveal_core::content::video::bytes::codec::Codec;
use foveal_core::content::video::grid::tile_grid::Cut;

use crate::pack::journal_file::journal_path;
use crate::pack::pack_file::partial_path;
use crate::prepare::{PreparationPlan, PrepareError, PrepareSettings, ProjectionChoice, prepare};
use crate::read::frame::new_frame;
use crate::tiles::encoder::new_encoder;
use crate::write::frame_file::{FrameFile, ReadyEncoder};
use crate::write::write_clip::{ClipCodec, ClipFormat, ClipWriter};
use crate::{MediaError, ReadOptions, TimedPicture, VideoInput};

/// Limited-range BT.709 with chroma on the left.
pub(crate) const VIDEO: Colour = Colour {
    matrix: Matrix::Bt709,
    full_range: false,
    chroma_left: true,
};

/// A file name in the system's folder for such; the file goes away with the value, and with it
/// what a stopped preparation left.
pub(crate) struct Scratch(pub(crate) PathBuf);

impl Scratch {
    pub(crate) fn new(ending: &str) -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let name = format!("foveal-media-{}-{number}.{ending}", std::process::id());
        Self(std::env::temp_dir().join(name))
    }

    pub(crate) fn holding(ending: &str, bytes: &[u8]) -> Self {
        let this = Self::new(ending);
        std::fs::write(&this.0, bytes).unwrap();
        this
    }
}

impl std::ops::Deref for Scratch {
    type Target = Path;
    fn deref(&self) -> &Path {
        &self.0
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let partial = partial_path(&self.0);
        for file in [&self.0, &journal_path(&partial), &partial] {
            let _ = std::fs::remove_file(file);
        }
    }
}

/// A soft pattern that moves by a pixel or two a frame, different for each seed.
pub(crate) fn scene([width, height]: [u32; 2], frame: u32, seed: u32) -> Picture {
    let planes = [0, 1, 2].map(|p| {
        let [w, h] = plane_size(width, height, p);
        let pitch = [0.11, 0.07, 0.05][p] + f64::from(seed % 7) * 0.01;
        let wave = move |x: u32, y: u32| {
            let across = (f64::from(x + 2 * frame) * pitch).sin();
            let down = (f64::from(y + frame) * pitch * 0.7 + f64::from(seed)).cos();
            (128.0 + 50.0 * across + 40.0 * down) as u8
        };
        (0..h)
            .flat_map(|y| (0..w).map(move |x| wave(x, y)))
            .collect()
    });
    Picture {
        width,
        height,
        planes,
    }
}

/// `count` frames of a scene.
pub(crate) fn group(size: [u32; 2], count: u32, seed: u32) -> Vec<Picture> {
    (0..count).map(|frame| scene(size, frame, seed)).collect()
}

/// Peak signal-to-noise ratio of the luma plane in decibels.
pub(crate) fn psnr(a: &Picture, b: &Picture) -> f64 {
    let square = |(x, y): (&u8, &u8)| (f64::from(*x) - f64::from(*y)).powi(2);
    let total: f64 = a.planes[0].iter().zip(&b.planes[0]).map(square).sum();
    let mean = total / a.planes[0].len() as f64;
    10.0 * (255.0f64.powi(2) / mean.max(1e-9)).log10()
}

/// Writes the pictures as a video file.
pub(crate) fn write_clip(ending: &str, codec: ClipCodec, pictures: &[Picture]) -> Scratch {
    let path = Scratch::new(ending);
    let size = [pictures[0].width, pictures[0].height];
    let full_range = matches!(codec, ClipCodec::Mjpeg(_));
    let colour = Colour {
        full_range,
        ..VIDEO
    };
    let format = ClipFormat {
        codec,
        size,
        frame_rate: [25, 1],
        colour,
    };
    let mut clip = ClipWriter::create(&path, &format).unwrap();
    for picture in pictures {
        clip.push(picture).unwrap();
    }
    clip.finish().unwrap();
    path
}

/// How a file of raw samples differs from plain video.
pub(crate) struct RawFile<'a> {
    pub(crate) ending: &'a str,
    pub(crate) encoder: &'a str,
    pub(crate) format: Pixel,
    pub(crate) size: [u32; 2],
    pub(crate) side_data: &'a [(av::ffi::AVPacketSideDataType, Vec<u8>)],
}

/// Writes one frame after another, filled by `fill(frame, plane, x in bytes, y)`.
pub(crate) fn write_raw(
    file: &RawFile,
    frames: u32,
    fill: impl Fn(u32, usize, usize, usize) -> u8,
) -> Scratch {
    crate::ffmpeg::start();
    let path = Scratch::new(file.ending);
    let (codec, video) = new_encoder(file.encoder, file.format, file.size, [25, 1]).unwrap();
    let ready = ReadyEncoder {
        codec,
        video,
        options: Vec::new(),
    };
    let mut out = FrameFile::create(&path, ready, file.side_data).unwrap();
    for i in 0..frames {
        let mut frame = new_frame(file.format, file.size).unwrap();
        for p in 0..frame.planes() {
            let stride = frame.stride(p);
            for (at, byte) in frame.data_mut(p).iter_mut().enumerate() {
                *byte = fill(i, p, at % stride, at / stride);
            }
        }
        out.push(frame, u64::from(i)).unwrap();
    }
    out.finish().unwrap();
    path
}

/// Plain frames of this format.
pub(crate) fn raw(
    encoder: &'static str,
    ending: &'static str,
    format: Pixel,
    size: [u32; 2],
) -> RawFile<'static> {
    RawFile {
        ending,
        encoder,
        format,
        size,
        side_data: &[],
    }
}

/// All pictures of the file, or how it breaks off.
pub(crate) fn read(path: &Path) -> (VideoInput, Result<Vec<TimedPicture>, MediaError>) {
    read_all(VideoInput::open(path).unwrap())
}

/// The same without mending.
pub(crate) fn read_strictly(path: &Path) -> Result<Vec<TimedPicture>, MediaError> {
    let options = ReadOptions {
        strict: true,
        ..ReadOptions::default()
    };
    read_all(VideoInput::open_with(path, options)?).1
}

fn read_all(mut input: VideoInput) -> (VideoInput, Result<Vec<TimedPicture>, MediaError>) {
    let mut pictures = Vec::new();
    loop {
        match input.next_frame() {
            Ok(Some(timed)) => pictures.push(timed),
            Ok(None) => return (input, Ok(pictures)),
            Err(e) => return (input, Err(e)),
        }
    }
}

/// The first picture of a file that reads to its end.
pub(crate) fn read_one(path: &Path) -> (VideoInput, Picture) {
    let (input, pictures) = read(path);
    let picture = pictures.unwrap().swap_remove(0).picture;
    assert!(picture.is_consistent());
    assert_eq!(
        [input.info().width, input.info().height],
        [picture.width, picture.height]
    );
    (input, picture)
}

/// How the packs of tests are made: small tiles, three levels.
pub(crate) fn settings(projection: ProjectionChoice, codec: Codec) -> PrepareSettings {
    PrepareSettings {
        projection,
        stereo: crate::prepare::StereoChoice::Auto,
        sound: true,
        cut: Some(Cut::Tile(32)),
        levels: Some(3),
        codec,
        jobs: 2,
        ..PrepareSettings::default()
    }
}

/// What would be made of a file.
pub(crate) fn plan_of(
    input: &Path,
    settings: &PrepareSettings,
) -> Result<PreparationPlan, PrepareError> {
    let info = VideoInput::open(input)?.info().clone();
    PreparationPlan::new(input, &info, settings)
}

/// The pack of a file.
pub(crate) fn prepared(input: &Path, settings: &PrepareSettings) -> Scratch {
    let plan = plan_of(input, settings).unwrap();
    let out = Scratch::new("foveal");
    prepare(input, &out, &plan, &mut |_| {}).unwrap();
    out
}
