//! Which policy does a pack's own calibration choose?

use crate::options::policy::{PolicyOptions, ViewOptions};
use foveal_core::content::policy::Policy;
use foveal_core::content::video::calibration::density_of;
use foveal_media::pack::pack_file::PackFile;

impl PolicyOptions {
    /// The same for a pack of video in this view, and the policy that its calibration chose where
    /// none was named: the rule that shows fewer pixels at the target.
    pub(crate) fn for_pack(
        &self,
        file: &PackFile,
        view: &ViewOptions,
    ) -> anyhow::Result<(Self, Option<Policy>)> {
        let is_open = self.named().is_none() && self.policy() == Policy::Perceptual;
        let calibration = file.calibration().ok().flatten();
        let (Some(calibration), true) = (calibration, is_open) else {
            return Ok((self.clone(), None));
        };
        let surface = file.pack().description().grid(view.screen).surface;
        let density = density_of(&surface, &view.eye_view(&surface)?);
        let target = self.target(Policy::Perceptual)?;
        let cheaper = target.and_then(|target| calibration.cheaper(target, Some(density)));
        let policy = cheaper.map_or(Policy::Perceptual, |(rule, _)| Policy::judged_for(rule));
        Ok((self.under(policy), Some(policy)))
    }
}
