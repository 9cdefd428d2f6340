//! Which policy does a pack's own calibration choose?

use crate::options::policy::{PolicyOptions, ViewOptions};
use foveal_core::content::policy::Policy;
use foveal_core::content::video::calibration::density_of;
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::surface::Surface;
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
        if !is_open {
            return Ok((self.clone(), None));
        }
        let surface = file.pack().description().grid(view.screen).surface;
        let seen = (&surface, &view.eye_view(&surface)?);
        Ok(
            match cheaper_policy(file, seen, self.target(Policy::Perceptual)?) {
                Some(policy) => (self.under(policy), Some(policy)),
                None => (self.clone(), None),
            },
        )
    }
}

/// The rule that shows fewer pixels of a pack in a view at a target, by its calibration; `None`
/// where it has none.
pub(crate) fn cheaper_policy(
    file: &PackFile,
    (surface, view): (&Surface, &EyeView),
    target: Option<f64>,
) -> Option<Policy> {
    let calibration = file.calibration().ok().flatten()?;
    let density = density_of(surface, view);
    let cheaper = target.and_then(|target| calibration.cheaper(target, Some(density)));
    Some(cheaper.map_or(Policy::Perceptual, |(rule, _)| Policy::judged_for(rule)))
}
