//! What do panels show: a picture, a video, what is captured, or a world that is drawn for them?

use crate::commands::score::{check_source, is_pack};
use crate::report::output::{WrongUsage, say};
use anyhow::{Context, bail};
use foveal_core::view::panel::placement::Placement;
use foveal_core::view::picture::Colour;
use foveal_core::view::surface::Eye;
use foveal_media::capture::Capture;
use foveal_media::capture::source::{CapturedPicture, LiveSource};
use foveal_media::generate::FRAMES_PER_SECOND;
use foveal_media::generate::placed::{DrawnRgb, GeneratedWorld};
use foveal_media::prepare::{PreparationPlan, PrepareSettings};
use foveal_media::{SourceInfo, VideoInput};
use foveal_render::RgbaImage;
use std::path::Path;
use std::time::Duration;

/// How long the first picture of what is captured is waited for, and how long any other at a time.
const FIRST_WAIT: Duration = Duration::from_secs(10);
const WAIT: Duration = Duration::from_millis(500);

/// What panels show.
pub(super) enum PanelSource {
    Still(RgbaImage),
    /// Its first picture, and what gives the next.
    Video(Box<(VideoInput, RgbaImage)>),
    Live(Box<LivePictures>),
    World(GeneratedWorld),
}

/// What is captured.
pub(super) struct LivePictures {
    name: String,
    capture: Capture,
    /// The first picture, until it is taken.
    first: Option<RgbaImage>,
    /// Columns and rows of the newest picture.
    size: [u32; 2],
}

/// A picture of a source, and when it is due, counted from the first; what is live is due at once.
pub(super) struct SourceFrame {
    pub(super) picture: RgbaImage,
    pub(super) due: Duration,
}

/// Where in the source an eye's part lies, and where that lies before the eye.
pub(super) struct EyePart {
    pub(super) eye: Eye,
    pub(super) placement: Placement,
    /// Left, top, width and height.
    pub(super) part: [u32; 4],
}

impl PanelSource {
    pub(super) fn open(name: &str) -> anyhow::Result<Self> {
        refuse_two_meanings(name)?;
        match name {
            "world:valley" => return Ok(Self::World(GeneratedWorld::valley())),
            "world:gratings" => {
                let seed = GeneratedWorld::FRONTAL;
                return Ok(Self::World(GeneratedWorld::gratings(seed)));
            }
            _ => {}
        }
        if let Some(world) = name.strip_prefix("world:") {
            bail!(WrongUsage(format!(
                "world:{world} is no generated world; give world:valley or world:gratings"
            )));
        }
        if let Some(live) = LiveSource::parse(name) {
            return Ok(Self::Live(Box::new(LivePictures::open(name, &live)?)));
        }
        let path = Path::new(name);
        if is_pack(path) {
            bail!(WrongUsage(format!(
                "{name}: is a pack, which panels sample themselves: foveal view {name} --panels \
                 RIG, or foveal simulate"
            )));
        }
        let mut input = VideoInput::open(path)?;
        check_source(path, input.info())?;
        tell_round(path, input.info());
        let is_still = input.info().looks_still;
        let colour = input.info().colour;
        let first = next_picture(&mut input, colour)?;
        let first = first.with_context(|| format!("{name}: holds no picture"))?;
        Ok(match is_still {
            true => Self::Still(still(path, first)?),
            false => Self::Video(Box::new((input, first))),
        })
    }

    /// Its own size; a world has none.
    pub(super) fn size(&self) -> Option<[u32; 2]> {
        match self {
            Self::Still(picture) => Some(picture.size),
            Self::Video(video) => Some(video.1.size),
            Self::Live(live) => Some(live.size),
            Self::World(_) => None,
        }
    }

    /// Number of its pictures, as far as its file says.
    pub(super) fn length(&self) -> Option<u64> {
        match self {
            Self::Video(video) => video.0.info().frames,
            _ => None,
        }
    }

    pub(super) fn world(&self) -> Option<&GeneratedWorld> {
        match self {
            Self::World(world) => Some(world),
            _ => None,
        }
    }

    /// Whether it has more than one picture.
    pub(super) fn moves(&self) -> bool {
        !matches!(self, Self::Still(_))
    }

    pub(super) fn live(&self) -> Option<&LivePictures> {
        match self {
            Self::Live(live) => Some(live),
            _ => None,
        }
    }

    /// The next frame, which has this number, with a part for each eye; `None` after the last.
    /// Waits for what is captured.
    pub(super) fn frame(
        &mut self,
        number: u32,
        parts: &[EyePart],
    ) -> anyhow::Result<Option<SourceFrame>> {
        let at_once = |picture| SourceFrame {
            picture,
            due: Duration::ZERO,
        };
        match self {
            Self::Still(picture) => Ok((number == 0).then(|| at_once(picture.clone()))),
            Self::Video(video) if number == 0 => Ok(Some(at_once(video.1.clone()))),
            Self::Video(video) => {
                let colour = video.0.info().colour;
                let next = video.0.next_frame()?;
                Ok(next.map(|it| SourceFrame {
                    picture: RgbaImage::from_planes(&it.picture, colour),
                    due: Duration::from_nanos(it.time_ns.unsigned_abs()),
                }))
            }
            Self::Live(live) => Ok(live.wait().map(at_once)),
            Self::World(world) => Ok(Some(SourceFrame {
                picture: drawn_parts(world, number, parts),
                due: Duration::from_secs_f32(number as f32 / FRAMES_PER_SECOND),
            })),
        }
    }
}

/// Refuses the name of a file that is also that of something else.
fn refuse_two_meanings(name: &str) -> Result<(), WrongUsage> {
    let is_other = name.starts_with("world:") || LiveSource::parse(name).is_some();
    if is_other && std::fs::symlink_metadata(name).is_ok() {
        return Err(WrongUsage(format!(
            "{name}: is what this name stands for, and also a file here; give ./{name} for the \
             file, or move that away"
        )));
    }
    Ok(())
}

impl LivePictures {
    fn open(name: &str, source: &LiveSource) -> anyhow::Result<Self> {
        let capture = Capture::open(source)?;
        let first = capture.next(FIRST_WAIT).map(image);
        let Some(first) = first else {
            let why = capture.ended();
            let why = why.unwrap_or_else(|| "gives no picture".to_owned());
            bail!("{name}: {why}; is it running?");
        };
        Ok(Self {
            name: name.to_owned(),
            capture,
            size: first.size,
            first: Some(first),
        })
    }

    /// The newest picture, where there is one that was not taken.
    pub(super) fn newest_frame(&mut self) -> Option<SourceFrame> {
        let picture = self.newest(Duration::ZERO)?;
        Some(SourceFrame {
            picture,
            due: Duration::ZERO,
        })
    }

    /// The pause after which to look again, while more may come.
    pub(super) fn goes_on(&self, pause: Duration) -> Option<Duration> {
        self.capture.ended().is_none().then_some(pause)
    }

    /// The newest picture, once there is one; `None`, with a message, where none will come.
    fn wait(&mut self) -> Option<RgbaImage> {
        loop {
            if let Some(picture) = self.newest(WAIT) {
                return Some(picture);
            }
            if let Some(why) = self.capture.ended() {
                say(&format!("{}: {why}", self.name));
                return None;
            }
        }
    }

    /// The newest picture that was not taken, waited for so long.
    fn newest(&mut self, wait: Duration) -> Option<RgbaImage> {
        let picture = self
            .first
            .take()
            .or_else(|| self.capture.next(wait).map(image))?;
        self.size = picture.size;
        Some(picture)
    }

    /// Number of pictures that newer ones took the place of.
    pub(super) fn dropped(&self) -> u64 {
        self.capture.dropped()
    }
}

fn image(picture: CapturedPicture) -> RgbaImage {
    RgbaImage {
        size: picture.size,
        pixels: picture.rgba,
    }
}

/// Says how what lies all round the viewer is shown so: here every source lies before the panels.
fn tell_round(path: &Path, info: &SourceInfo) {
    let plan = PreparationPlan::new(path, info, &PrepareSettings::default());
    if plan.is_ok_and(|plan| plan.description.projection.surrounds()) {
        let name = path.display();
        say(&format!(
            "warning: {name}: looks like 360°, and is laid before the panels as if it were flat; \
             to surround the viewer with it, run `foveal prepare video {name} --out PACK`, then \
             `foveal simulate PACK --panels RIG --out DIR` or `foveal view PACK --panels RIG`"
        ));
    }
}

/// A PNG file by its own bytes: 4:2:0 would take half of its colour away.
fn still(path: &Path, otherwise: RgbaImage) -> anyhow::Result<RgbaImage> {
    match crate::commands::score::is_png(path) {
        true => Ok(crate::report::picture_file::read_png(path)?.image()),
        false => Ok(otherwise),
    }
}

fn next_picture(input: &mut VideoInput, colour: Colour) -> anyhow::Result<Option<RgbaImage>> {
    let next = input.next_frame()?;
    Ok(next.map(|it| RgbaImage::from_planes(&it.picture, colour)))
}

/// A world as each eye's placement has it.
fn drawn_parts(world: &GeneratedWorld, number: u32, parts: &[EyePart]) -> RgbaImage {
    let ends = |k: usize| {
        parts
            .iter()
            .map(move |it| it.part[k] + it.part[k + 2])
            .max()
    };
    let mut image = RgbaImage::black([0, 1].map(|k| ends(k).unwrap_or(1)));
    let mut done: Vec<[u32; 4]> = Vec::new();
    for it in parts {
        if done.contains(&it.part) {
            continue;
        }
        done.push(it.part);
        let [left, top, width, height] = it.part;
        let drawn = world.placed(u64::from(number), &it.placement, [width, height]);
        for y in 0..height {
            for x in 0..width {
                let [r, g, b] = drawn.rgb[(y * width + x) as usize];
                image.set_pixel([left + x, top + y], [r, g, b, 255]);
            }
        }
    }
    image
}

/// A drawn picture, opaque.
pub(in crate::commands::panels) fn opaque(drawn: &DrawnRgb) -> RgbaImage {
    RgbaImage {
        size: drawn.size,
        pixels: drawn
            .rgb
            .iter()
            .flat_map(|&[r, g, b]| [r, g, b, 255])
            .collect(),
    }
}
