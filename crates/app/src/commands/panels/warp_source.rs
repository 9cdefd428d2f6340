//! What do panels show: a picture, a video, or a world that is drawn for them?

use crate::commands::score::check_source;
use crate::report::output::WrongUsage;
use anyhow::{Context, bail};
use clap::ValueEnum;
use foveal_core::view::panel::placement::Placement;
use foveal_core::view::picture::Colour;
use foveal_core::view::surface::Eye;
use foveal_media::VideoInput;
use foveal_media::generate::placed::{DrawnRgb, GeneratedWorld};
use foveal_render::RgbaImage;
use std::path::Path;

/// How the two eyes' pictures lie in a source.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum StereoName {
    /// Both eyes see all of it.
    #[default]
    Mono,
    /// The left half is the left eye's.
    Sbs,
    /// The upper half is the left eye's.
    Tb,
}

/// What panels show.
pub(super) enum PanelSource {
    Still(RgbaImage),
    /// Its first picture, and what gives the next.
    Video(Box<(VideoInput, RgbaImage)>),
    World(GeneratedWorld),
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
        let path = Path::new(name);
        let mut input = VideoInput::open(path)?;
        check_source(path, input.info())?;
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
            Self::World(_) => None,
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

    /// The picture of the next frame, which has this number, with a part for each eye; `None` after
    /// the last.
    pub(super) fn frame(
        &mut self,
        number: u32,
        parts: &[EyePart],
    ) -> anyhow::Result<Option<RgbaImage>> {
        match self {
            Self::Still(picture) => Ok((number == 0).then(|| picture.clone())),
            Self::Video(video) if number == 0 => Ok(Some(video.1.clone())),
            Self::Video(video) => {
                let colour = video.0.info().colour;
                next_picture(&mut video.0, colour)
            }
            Self::World(world) => Ok(Some(drawn_parts(world, number, parts))),
        }
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
pub(super) fn opaque(drawn: &DrawnRgb) -> RgbaImage {
    RgbaImage {
        size: drawn.size,
        pixels: drawn
            .rgb
            .iter()
            .flat_map(|&[r, g, b]| [r, g, b, 255])
            .collect(),
    }
}
