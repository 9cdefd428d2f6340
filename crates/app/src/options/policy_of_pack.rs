//! Which policy does a pack's own calibration choose?

use crate::options::policy::{PolicyOptions, ViewOptions};
use foveal_core::content::policy::Policy;
use foveal_core::content::video::calibration::{Calibration, density_of};
use foveal_core::units::Ppd;
use foveal_media::pack::pack_file::PackFile;

impl PolicyOptions {
    /// The same, and the policy that was chosen where none was named: of content that a judge saw
    /// the rule that shows fewer pixels at the target in a view of this density.
    pub(crate) fn for_content(
        &self,
        calibration: Option<&Calibration>,
        density: Ppd,
    ) -> anyhow::Result<(Self, Option<Policy>)> {
        let is_open = self.named().is_none() && self.policy() == Policy::Perceptual;
        let (Some(calibration), true) = (calibration, is_open) else {
            return Ok((self.clone(), None));
        };
        let target = self.target(Policy::Perceptual)?;
        let cheaper = target.and_then(|target| calibration.cheaper(target, Some(density)));
        let policy = cheaper.map_or(Policy::Perceptual, |(rule, _)| Policy::judged_for(rule));
        Ok((self.under(policy), Some(policy)))
    }

    /// The same for a pack of video in this view, under a policy that has a name.
    pub(crate) fn for_pack(&self, file: &PackFile, view: &ViewOptions) -> anyhow::Result<Self> {
        let surface = file.pack().description().grid(view.screen).surface;
        let calibration = file.calibration().ok().flatten();
        let density = density_of(&surface, &view.eye_view(&surface)?);
        let (chosen, _) = self.for_content(calibration.as_ref(), density)?;
        Ok(chosen.under(chosen.policy()))
    }
}
