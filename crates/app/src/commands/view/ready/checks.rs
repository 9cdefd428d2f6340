//! Which options does a pack of a kind take?

use crate::commands::view::args::ViewArgs;
use crate::commands::view::gaze_source::WindowGaze;
use crate::gaze_source::GazeChoice;
use crate::options::hold::moves;
use crate::options::panels::{SAMPLES_ONE_VIEW, ShownRig};
use crate::options::policy::{PolicyOptions, check_thresholds};
use crate::options::showing::InterpolationName;
use crate::report::output::WrongUsage;
use anyhow::bail;
use foveal_core::content::opened::Opened;
use foveal_core::content::policy::{ImportanceSource, Policy, PolicyConfig};
use foveal_core::units::counted;
use foveal_media::pack::pack::Pack;

/// These options with those that panels and a published system stand for.
pub(super) fn before(
    args: &ViewArgs,
    pack: &Pack,
    rig: Option<&ShownRig>,
) -> anyhow::Result<ViewArgs> {
    let mut with = args.clone();
    if pack.facts().is_entered {
        args.presets.refuse_for_scene()?;
    }
    with.gaze = match &args.gaze {
        WindowGaze::Other(choice) => WindowGaze::Other(args.tracker.read_as(choice)?),
        // Refuses columns of no table.
        own => args
            .tracker
            .read_as(&GazeChoice::Scan)
            .map(|_| own.clone())?,
    };
    if rig.is_none() && args.presets.system().is_none() {
        return Ok(with);
    }
    let shape = pack.video().and_then(|file| {
        let about = file.pack().description();
        with.policy = args.presets.policy(&args.policy, about.projection);
        about.flat_shape()
    });
    let Some(rig) = rig else {
        return Ok(with);
    };
    if with.policy.named() == Some(Policy::Sampled) {
        bail!(WrongUsage(SAMPLES_ONE_VIEW.to_owned()));
    }
    if let Some(screen) = args.panels.screen(rig, shape)? {
        with.view.screen = screen;
    }
    Ok(with)
}

/// The policy that was asked for, or the usual one of this kind.
pub(super) fn policy_of(args: &ViewArgs, pack: &Pack) -> anyhow::Result<PolicyOptions> {
    let usual = match (args.demo, args.link, pack.video()) {
        (false, ..) => Policy::Viewport,
        (true, None, Some(file)) => {
            let (policy, _) = args.policy.for_pack(file, &args.view)?;
            return Ok(policy.under(policy.policy()));
        }
        (true, link, _) => pack.facts().usual_policies[usize::from(link.is_some())],
    };
    Ok(args.policy.under(args.policy.named().unwrap_or(usual)))
}

/// Says what is wrong with the options for this kind, before a window is there.
pub(super) fn check(args: &ViewArgs, opened: &Opened) -> anyhow::Result<()> {
    let config = args.policy.config()?;
    let content = opened.content();
    if args.hold.is_some() && !content.timeline().is_still() {
        let frames = counted(content.timeline().frames(), "frame");
        bail!(moves(&format!("a {} of {frames}", opened.facts().noun)));
    }
    match opened.video() {
        Some(video) => check_thresholds(&config, video.grid()),
        None => check_scene(args, opened, &config),
    }
}

fn check_scene(args: &ViewArgs, opened: &Opened, config: &PolicyConfig) -> anyhow::Result<()> {
    let policy = config.policy;
    if let Some(why) = opened.why_not(policy) {
        let able = Policy::IN_TURN
            .into_iter()
            .filter(|it| opened.why_not(*it).is_none());
        let able: Vec<&str> = able.map(Policy::name).collect();
        bail!(WrongUsage(format!(
            "--policy {} does not choose for scenes: {why}; give one of {}",
            policy.name(),
            able.join(", ")
        )));
    }
    args.policy.refuse_score_of_scene(policy)?;
    if config.importance == ImportanceSource::Rendered {
        bail!(WrongUsage(
            "--importance rendered: a window does not draw every level for each choice; leave it \
             out, or take simulate"
                .to_owned()
        ));
    }
    let style = args.showing.showing(InterpolationName::Blended);
    let of_tiles = [
        (style.has_textures, "--reconstruction textures"),
        (args.showing.interpolation.is_some(), "--interpolation"),
        (style.blurs, "--blur on"),
    ];
    match of_tiles.iter().find(|(is_given, _)| *is_given) {
        Some((_, option)) => bail!(WrongUsage(format!(
            "{option} is for video, and this is a scene; leave it out"
        ))),
        None => Ok(()),
    }
}
