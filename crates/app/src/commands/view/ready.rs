//! What is read before a window opens?

mod checks;
mod kinds;
pub(super) mod opening;

use crate::commands::view::args::ViewArgs;
use crate::commands::view::ready::checks::{before, check, policy_of};
use crate::commands::view::script::Script;
use crate::commands::view::sound::samples::Samples;
use crate::gaze_source::ViewerModel;
use crate::report::output::{self, WrongUsage};
use anyhow::{Context, bail};
use foveal_core::content::opened::Opened;
use foveal_core::content::policy::Policy;
use foveal_core::view::panel::rig::Panel;
use foveal_media::pack::pack::Pack;
use foveal_play::Decoding;

/// What was read before a window opens: whatever is wrong is said without one.
pub(super) struct Ready {
    pub(super) args: ViewArgs,
    pub(super) pack: Pack,
    /// What is in it, on the screen that it fills.
    pub(super) opened: Opened,
    /// The panels that show it, where there is a rig.
    pub(super) panels: Option<Vec<Panel>>,
    pub(super) watching: ViewerModel,
    pub(super) script: Script,
    pub(super) samples: Option<Samples>,
    pub(super) decoding: Decoding,
}

impl Ready {
    pub(super) fn new(args: &ViewArgs) -> anyhow::Result<Self> {
        let decoding = args.decoding.decoding()?;
        let rig = args.panels.read(args.eye)?;
        let pack = Pack::open(&args.pack)?;
        let args = &before(args, &pack, rig.as_ref())?;
        let panels = rig.map(|rig| rig.panels);
        let opened = pack.opened(args.view.screen)?;
        let args = &ViewArgs {
            policy: policy_of(args, &pack)?,
            ..args.clone()
        };
        if let Some(log) = &args.log {
            output::spare_inputs(log, [args.pack.as_path()])?;
        }
        if let Some(folder) = &args.screenshots {
            std::fs::create_dir_all(folder).with_context(|| {
                format!(
                    "--screenshots {}: no such folder can be made",
                    folder.display()
                )
            })?;
        }
        // Says what is wrong with the options before a window is there.
        let config = args.policy.config()?;
        check(args, &opened)?;
        if args.link.is_some() && !config.policy.spends_a_budget() {
            bail!(WrongUsage(format!(
                "--link: {} ignores the link; give --policy uniform, eccentricity or perceptual",
                args.policy.policy().name()
            )));
        }
        if args.showing.has_textures() && config.policy == Policy::Sampled {
            bail!(WrongUsage(
                "--reconstruction textures shows tiles, --policy sampled samples; give one of them"
                    .to_owned()
            ));
        }
        let script = args.script.as_ref().map(|path| {
            let text = output::read_text(path, "a script")?;
            let script = Script::parse(&text, opened.facts().is_entered);
            script.with_context(|| format!("--script {}", path.display()))
        });
        let held = args.hold.map(|hold| Ok(Script::quitting_at(hold)));
        let ready = Self {
            watching: ViewerModel {
                preset: args.presets.head_gaze()?,
                late: args.link.unwrap_or_default().delay,
            },
            script: script.or(held).transpose()?.unwrap_or_default(),
            samples: if args.mute { None } else { sound_of(&pack) },
            args: args.clone(),
            panels,
            pack,
            opened,
            decoding,
        };
        ready.args.view.eye_view(&ready.surface())?;
        Ok(ready)
    }
}

/// The sound of a pack; one that is damaged is reported and left out.
fn sound_of(pack: &Pack) -> Option<Samples> {
    let file = pack.video()?;
    let damaged = |error: anyhow::Error| output::say(&format!("warning: {error:#}; no sound"));
    Samples::of_pack(file).map_err(damaged).ok().flatten()
}
