//! What computes a score: all cores, or a graphics device?

use crate::commands::score::conditions::DeviceName;
use anyhow::{Context, bail};
use foveal_eval::score::companion::{Companion, CompanionJudge};
use foveal_eval::score::fast::HeatMap;
use foveal_eval::score::gpu::GpuJudge;
use foveal_eval::score::{Judge, Score, ScorePicture, Viewing};
use foveal_render::Gpu;
use serde::Serialize;

/// One frame of both, and where the eye looks.
pub(super) struct Frame {
    pub(super) reference: ScorePicture,
    pub(super) test: ScorePicture,
    /// Counts only where the viewing is foveated.
    pub(super) gaze_px: [f64; 2],
}

/// What computes.
pub(crate) enum Engine {
    Cpu(Box<Judge>),
    Gpu(Box<GpuJudge>, String),
}

impl Engine {
    /// Opens what was asked for.
    pub(crate) fn open(device: DeviceName, viewing: &Viewing, jobs: usize) -> anyhow::Result<Self> {
        match device {
            DeviceName::Cpu => Ok(Self::Cpu(Box::new(Judge::new(viewing, jobs)?))),
            DeviceName::Gpu => {
                let gpu = Gpu::open_blocking()
                    .context("--device gpu cannot be had; give --device cpu")?;
                let judge = GpuJudge::new(&gpu.device, &gpu.queue, viewing)?;
                Ok(Self::Gpu(Box::new(judge), gpu.adapter_name().to_owned()))
            }
        }
    }

    /// From now on adds up a heat map too.
    pub(crate) fn keep_heat(&mut self) -> anyhow::Result<()> {
        match self {
            Self::Cpu(judge) => judge.keep_heat(),
            Self::Gpu(judge, _) => judge.keep_heat()?,
        }
        Ok(())
    }

    /// Takes in the next frame.
    pub(crate) fn frame(
        &mut self,
        reference: &ScorePicture,
        test: &ScorePicture,
        gaze_px: [f64; 2],
    ) -> anyhow::Result<()> {
        match self {
            Self::Cpu(judge) => judge.frame(reference, test, gaze_px)?,
            Self::Gpu(judge, _) => judge.frame(reference, test, gaze_px)?,
        };
        Ok(())
    }

    /// The score of all frames.
    pub(crate) fn score(&self) -> anyhow::Result<Score> {
        let score = match self {
            Self::Cpu(judge) => judge.score(),
            Self::Gpu(judge, _) => judge.score(),
        };
        match score {
            Some(score) => Ok(score),
            None => bail!("there is no frame to score"),
        }
    }

    /// The heat map, where one was kept.
    pub(crate) fn heat(&self) -> anyhow::Result<Option<HeatMap>> {
        Ok(match self {
            Self::Cpu(judge) => judge.heat(),
            Self::Gpu(judge, _) => judge.heat()?,
        })
    }

    /// Its name, for people.
    pub(crate) fn name(&self) -> String {
        match self {
            Self::Cpu(_) => "cpu".to_owned(),
            Self::Gpu(_, adapter) => format!("gpu: {adapter}"),
        }
    }
}

/// Measures besides the score that share nothing with its model of the eye.
pub(crate) struct Companions(Vec<(Companion, CompanionJudge)>);

/// What they say: decibels are null for equal pictures, all that needs a gaze without one.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(crate) struct CompanionValues {
    /// Decibels over red, green and blue.
    pub(crate) psnr_db: Option<f64>,
    /// The same, weighed by the cells of the eye that look there.
    pub(crate) fw_psnr_db: Option<f64>,
    /// Structural similarity in the square round the fovea.
    pub(crate) foveal_ssim: Option<f64>,
}

impl Companions {
    /// Those that there are for a viewing.
    pub(crate) fn beside(viewing: &Viewing) -> anyhow::Result<Self> {
        let all = [Companion::Psnr, Companion::FwPsnr, Companion::FovealSsim];
        let there = all
            .into_iter()
            .filter(|c| viewing.foveated || !c.needs_gaze());
        let judges =
            there.map(|companion| Ok((companion, CompanionJudge::new(companion, viewing)?)));
        Ok(Self(judges.collect::<anyhow::Result<_>>()?))
    }

    /// Takes in the next frame.
    pub(crate) fn frame(
        &mut self,
        reference: &ScorePicture,
        test: &ScorePicture,
        gaze_px: [f64; 2],
    ) -> anyhow::Result<()> {
        for (_, judge) in &mut self.0 {
            judge.frame(reference, test, gaze_px)?;
        }
        Ok(())
    }

    /// What they say of all frames.
    pub(crate) fn totals(&self) -> CompanionValues {
        let of = |wanted: Companion| {
            let judge = self.0.iter().find(|(companion, _)| *companion == wanted);
            judge
                .map(|(_, judge)| judge.total())
                .filter(|value| value.is_finite())
        };
        CompanionValues {
            psnr_db: of(Companion::Psnr),
            fw_psnr_db: of(Companion::FwPsnr),
            foveal_ssim: of(Companion::FovealSsim),
        }
    }
}
