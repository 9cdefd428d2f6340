//! How near does a warped panel come to the same panel drawn directly?

use crate::commands::score::{DeviceName, Engine, from_image};
use anyhow::Context;
use foveal_core::view::panel::rig::Panel;
use foveal_eval::score::companion::{Companion, CompanionJudge};
use foveal_eval::score::display::Photometry;
use foveal_eval::score::{Display, Mode, Viewing};
use foveal_render::RgbaImage;
use nv_flip::{FlipImageRgb8, FlipPool, flip};
use serde::Serialize;

/// What measures say of a panel: of all its frames together.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(super) struct PanelScore {
    /// Decibels; null of equal pictures.
    pub(super) psnr_db: Option<f64>,
    pub(super) ssim: f64,
    /// Mean of Andersson et al. 2020, at the panel's pixels per degree.
    pub(super) flip: f64,
    pub(super) jod: f64,
}

/// Judges a panel frame by frame.
pub(super) struct PanelJudge {
    viewing: Viewing,
    engine: Engine,
    psnr: CompanionJudge,
    ssim: CompanionJudge,
    flips: Vec<f64>,
}

impl PanelJudge {
    /// Of a panel that shows `fps` frames a second; `None` for a still.
    pub(super) fn new(panel: &Panel, fps: Option<f64>) -> anyhow::Result<Self> {
        let (field, size) = (panel.view.field, panel.view.size);
        let extent = [field.left + field.right, field.up + field.down];
        let light = match panel.is_for_both {
            true => Photometry::DESK,
            false => Photometry::HEADSET,
        };
        let display = Display::of(&panel.id, size, extent, light);
        let viewing = Viewing::new(display, size, fps, false, Mode::Strict)
            .with_context(|| format!("panel {}: cannot be compared", panel.id))?;
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        Ok(Self {
            engine: Engine::open(DeviceName::Cpu, &viewing, cores)?,
            psnr: CompanionJudge::new(Companion::Psnr, &viewing)?,
            ssim: CompanionJudge::new(Companion::Ssim, &viewing)?,
            flips: Vec::new(),
            viewing,
        })
    }

    /// Takes in a frame, as drawn directly and as warped.
    pub(super) fn frame(&mut self, direct: &RgbaImage, warped: &RgbaImage) -> anyhow::Result<()> {
        let (reference, test) = (from_image(direct)?, from_image(warped)?);
        let nowhere = [0.0; 2];
        self.engine.frame(&reference, &test, nowhere)?;
        self.psnr.frame(&reference, &test, nowhere)?;
        self.ssim.frame(&reference, &test, nowhere)?;
        self.flips.push(self.flip_of(direct, warped));
        Ok(())
    }

    fn flip_of(&self, direct: &RgbaImage, warped: &RgbaImage) -> f64 {
        let [direct, warped] = [direct, warped].map(|image| {
            let opaque = image.pixels.chunks_exact(4);
            let rgb: Vec<u8> = opaque.flat_map(|it| [it[0], it[1], it[2]]).collect();
            FlipImageRgb8::with_data(image.size[0], image.size[1], &rgb)
        });
        let ppd = self.viewing.display.ppd() as f32;
        f64::from(FlipPool::from_image(&flip(direct, warped, ppd)).mean())
    }

    pub(super) fn score(&self) -> anyhow::Result<PanelScore> {
        let psnr = self.psnr.total();
        Ok(PanelScore {
            psnr_db: psnr.is_finite().then_some(psnr),
            ssim: self.ssim.total(),
            flip: self.flips.iter().sum::<f64>() / self.flips.len().max(1) as f64,
            jod: self.engine.score()?.jod,
        })
    }
}
