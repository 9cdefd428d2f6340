//! What do decoded tiles become before they are looked at?
//!
//! Tiles in an atlas or in a texture for every level, or samples of them round the gaze, blurred
//! where that is wanted. What is chosen here can change while a window is open.

use crate::run::canvas::{Canvas, Drawing, Showing};
use crate::run::sampling::{Sampling, mask_shape};
use anyhow::Context;
use foveal_core::content::policy::PolicyConfig;
use foveal_core::content::video::grid::tile_grid::{Tile, TileGrid};
use foveal_core::perception::samples::sample_mask::MaskShape;
use foveal_core::session::aim::Aim;
use foveal_core::session::playback;
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::picture::{Colour, Picture};
use foveal_render::{Gpu, Interpolation, Overlay, RadialBlur, RgbaImage};
use glam::DVec3;

/// Shares by which a pixel's angle may differ before a mask is made anew.
const SAME_PITCH: f64 = 1e-6;

/// How tiles become a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Style {
    pub(crate) showing: Showing,
    /// Only samples round the gaze are shown over the coarsest level.
    pub(crate) samples: bool,
}

impl Style {
    /// Whether tiles that were uploaded for one serve the other.
    fn keeps_tiles(&self, other: &Self) -> bool {
        let [a, b] = [self, other].map(|style| Self {
            showing: Showing {
                blurs: false,
                ..style.showing
            },
            ..*style
        });
        a == b
    }
}

/// Resident tiles and what draws them.
pub(crate) struct Easel {
    gpu: Gpu,
    grid: TileGrid,
    colour: Colour,
    style: Style,
    canvas: Canvas,
    sampling: Option<(MaskShape, Sampling)>,
    /// What the samples that are shown were gathered for; `None` once tiles came.
    gathered: Option<(DVec3, EyeView)>,
}

impl Easel {
    /// An empty one.
    pub(crate) fn new(
        gpu: &Gpu,
        grid: TileGrid,
        colour: Colour,
        style: Style,
    ) -> anyhow::Result<Self> {
        let drawing = Drawing::Gpu(gpu.clone());
        Ok(Self {
            gpu: gpu.clone(),
            grid,
            colour,
            style,
            canvas: Canvas::new(&drawing, &grid, colour, style.showing)?,
            sampling: None,
            gathered: None,
        })
    }

    /// How it shows tiles.
    pub(crate) fn style(&self) -> Style {
        self.style
    }

    /// From now on shows tiles like this; `true` where all of them must come anew. What cannot be
    /// shown leaves everything as it was.
    pub(crate) fn restyle(&mut self, style: Style) -> anyhow::Result<bool> {
        if self.style.keeps_tiles(&style) {
            self.style = style;
            return Ok(false);
        }
        *self = Self::new(&self.gpu, self.grid, self.colour, style)?;
        Ok(true)
    }

    /// Makes the mask that samples are shown by, where there is none for this view; takes about a
    /// second. `true` where tiles must come anew to be sampled.
    pub(crate) fn prepare(
        &mut self,
        config: &PolicyConfig,
        view: &EyeView,
    ) -> anyhow::Result<bool> {
        if !self.style.samples {
            return Ok(false);
        }
        let shape = mask_shape(config, view);
        let same = |(made, _): &(MaskShape, Sampling)| {
            (made.pitch / shape.pitch - 1.0).abs() < SAME_PITCH
                && (made.side, made.eye) == (shape.side, shape.eye)
        };
        if self.sampling.as_ref().is_some_and(same) {
            return Ok(false);
        }
        let interpolation = self.style.showing.interpolation;
        let averages = interpolation == Interpolation::Blended;
        let sampling = Sampling::new(config, view, averages);
        self.canvas.sample_by(&sampling.mask, interpolation)?;
        self.sampling = Some((shape, sampling));
        self.gathered = None;
        Ok(true)
    }

    /// Moves what follows the gaze: the samples and the blur.
    pub(crate) fn follow(&mut self, aim: &Aim) -> anyhow::Result<()> {
        let gaze = aim.gaze.gaze_in_content;
        let blurs = self.style.showing.blurs;
        self.canvas.set_blur(blurs.then(|| RadialBlur::round(gaze)));
        let Some((_, sampling)) = &self.sampling else {
            return Ok(());
        };
        let wanted = (gaze, aim.view);
        if self.gathered != Some(wanted) {
            let samples = sampling.gather(&self.grid, &aim.view, &aim.gaze);
            self.canvas.show_samples(&samples)?;
            self.gathered = Some(wanted);
        }
        Ok(())
    }

    /// The texture that shows a view; the next call reuses it.
    pub(crate) fn draw(
        &mut self,
        view: &EyeView,
        marks: Option<&Overlay>,
    ) -> anyhow::Result<&wgpu::Texture> {
        let drawn = self.canvas.draw(view, marks)?;
        drawn.context("a window's pictures are drawn by a GPU")
    }

    /// The picture of a view, in main memory.
    pub(crate) fn read(
        &mut self,
        view: &EyeView,
        marks: Option<&Overlay>,
    ) -> anyhow::Result<RgbaImage> {
        let read = self.canvas.picture(view, marks)?;
        read.context("a window's pictures are drawn by a GPU")
    }
}

impl playback::Easel for Easel {
    type Error = anyhow::Error;

    fn begin_frame(&mut self, frame: u32) {
        self.canvas.begin_frame(frame);
        if let Some((_, sampling)) = &mut self.sampling {
            sampling.begin_frame();
        }
        self.gathered = None;
    }

    fn upload(&mut self, tile: Tile, frame: u32, picture: Picture) -> anyhow::Result<()> {
        self.gathered = None;
        let is_base = tile.level == self.grid.coarsest();
        match &mut self.sampling {
            Some((_, sampling)) if is_base => {
                sampling.keep(tile, picture.clone());
                self.canvas.upload(tile, frame, picture)
            }
            Some((_, sampling)) => {
                sampling.keep(tile, picture);
                Ok(())
            }
            None => self.canvas.upload(tile, frame, picture),
        }
    }

    fn retain(&mut self, wanted: &[Tile]) {
        self.canvas.retain(wanted);
    }

    fn wrong_frame_tiles(&mut self) -> usize {
        self.canvas.wrong_frame_tiles()
    }

    fn gpu_bytes(&mut self) -> u64 {
        self.canvas.gpu_bytes()
    }
}
