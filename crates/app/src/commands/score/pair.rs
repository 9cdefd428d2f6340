//! What is the score of one pair of pictures, videos or packs?

use crate::commands::score::args::ScoreArgs;
use crate::commands::score::conditions::{GazeOnPicture, check_hdr, display_of, fps_of, gaze_of};
use crate::commands::score::engine::{Companions, Engine, Frame};
use crate::commands::score::frames::{Frames, is_pack};
use crate::commands::score::heat::write_heat;
use crate::commands::score::of_source::PackOfSource;
use crate::commands::score::pack_frames::Opening;
use crate::commands::score::report::{ScoreReport, Single};
use crate::report::output::{self, Counting, WrongUsage};
use anyhow::{Context, bail};
use foveal_core::content::policy::Policy;
use foveal_core::units::counted;
use foveal_eval::score::Viewing;
use foveal_eval::score::companion::{Companion, CompanionJudge};
use serde::Serialize;
use std::path::Path;

/// What takes in a frame, and what hands over all of them.
type TakeFrame<'a> = dyn FnMut(Frame) -> anyhow::Result<()> + 'a;
type EachFrame<'a> = dyn FnMut(&mut TakeFrame<'_>) -> anyhow::Result<()> + 'a;

/// What is said of a pair.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
pub(super) enum Judged {
    ByEye(Box<ScoreReport>),
    By(Single),
}

impl ScoreArgs {
    pub(super) fn score(&self, reference: &Path, test: &Path) -> anyhow::Result<Judged> {
        if is_pack(test) && !is_pack(reference) && !reference.is_dir() {
            return self.score_of_source(reference, test);
        }
        let mut pair = self.open(reference, test)?;
        let size = pair.0.size;
        let gaze = gaze_of(self.gaze.as_ref(), self.gaze_trace.as_deref())?;
        let fps = fps_of(self.fps, [&pair.0, &pair.1])?;
        let own = pair.0.display.clone();
        let display = display_of("--display", self.display.as_deref(), own)?;
        check_hdr(&display, [&pair.0, &pair.1])?;
        let foveated = gaze.is_some();
        let viewing = Viewing::new(display, size, fps, foveated, self.mode.mode())
            .with_context(|| reference.display().to_string())?;
        let name = gaze.as_ref().map(GazeOnPicture::source);
        self.judge(&viewing, name, &mut |take| {
            self.each_frame(&mut pair, &viewing, gaze.as_ref(), take)
        })
    }

    /// Scores a pack that is played as `simulate` does against the same views of its source.
    fn score_of_source(&self, source: &Path, pack: &Path) -> anyhow::Result<Judged> {
        let (name, trace) = (pack.display(), self.gaze_trace.is_some());
        let Some(gaze) = self.gaze.as_ref().filter(|_| !trace) else {
            bail!(WrongUsage(format!(
                "{name}: levels of a pack are chosen for its viewer's gaze; give --gaze \
                 YAW,PITCH, center, scan, trace:FILE or head:FILE"
            )));
        };
        if self.fps.is_some() {
            bail!(WrongUsage(format!(
                "--fps: {name} and its source have a rate; leave it out"
            )));
        }
        let look = (gaze, self.seed);
        let opening = self.opening(None);
        let mut played = PackOfSource::open(source, pack, &opening, look, self.frames)?;
        let own = Some(played.display());
        let display = display_of("--display", self.display.as_deref(), own)?;
        let mode = self.mode.mode();
        let viewing = Viewing::new(display, played.size(), played.fps(), true, mode)
            .with_context(|| name.to_string())?;
        let judged = gaze.of_viewer()?.as_judged();
        self.judge(&viewing, Some(judged), &mut |take| {
            let bar = output::bar(Some(u64::from(played.frames())), Counting::Frames);
            while let Some(frame) = played.next()? {
                take(frame)?;
                bar.inc(1);
            }
            bar.finish_and_clear();
            played.tell_unseen();
            Ok(())
        })
    }

    fn judge(
        &self,
        viewing: &Viewing,
        gaze: Option<String>,
        frames: &mut EachFrame<'_>,
    ) -> anyhow::Result<Judged> {
        match self.metric.companion() {
            None => self.score_by_eye(viewing, gaze, frames),
            Some(companion) => self.score_by(companion, viewing, gaze, frames),
        }
    }

    /// How packs are played, under a policy in the place of that of the options.
    fn opening(&self, policy: Option<Policy>) -> Opening {
        Opening {
            policy: policy.map_or_else(|| self.policy.clone(), |policy| self.policy.under(policy)),
            view: self.view.clone(),
            jobs: self.jobs,
            needs_gaze: self.gaze.is_none() && self.gaze_trace.is_none(),
        }
    }

    fn open(&self, reference: &Path, test: &Path) -> anyhow::Result<(Frames, Frames)> {
        let reference = Frames::open(reference, &self.opening(Some(self.reference_policy)))?;
        let test = Frames::open(test, &self.opening(None))?;
        if test.size != reference.size {
            let ([a, b], [c, d]) = (reference.size, test.size);
            let name = test.name.display();
            bail!("{name}: {c}x{d} pixels where the reference has {a}x{b}; bring both to one size");
        }
        if let (Some(wanted), Some(found)) = (reference.frames, test.frames)
            && self.frames.is_none()
            && wanted != found
            && reference.is_exact
            && test.is_exact
        {
            let name = test.name.display();
            let found = counted(found, "frame");
            bail!("{name}: has {found} where the reference has {wanted}; give --frames N");
        }
        Ok((reference, test))
    }

    fn score_by_eye(
        &self,
        viewing: &Viewing,
        gaze: Option<String>,
        frames: &mut EachFrame<'_>,
    ) -> anyhow::Result<Judged> {
        let mut engine = Engine::open(self.device, viewing, output::jobs(self.jobs)?)?;
        if self.heat.is_some() {
            engine.keep_heat()?;
        }
        let mut companions = Companions::beside(viewing)?;
        frames(&mut |frame| {
            companions.frame(&frame.reference, &frame.test, frame.gaze_px)?;
            engine.frame(&frame.reference, &frame.test, frame.gaze_px)
        })?;
        let score = engine.score()?;
        if let (Some(path), Some(heat)) = (&self.heat, engine.heat()?) {
            write_heat(path, &heat)?;
        }
        let report = ScoreReport::judged(viewing, self.mode.mode(), gaze, score).with(
            companions.totals(),
            engine.name(),
            self.heat.clone(),
        );
        Ok(Judged::ByEye(Box::new(report)))
    }

    fn score_by(
        &self,
        companion: Companion,
        viewing: &Viewing,
        gaze: Option<String>,
        frames: &mut EachFrame<'_>,
    ) -> anyhow::Result<Judged> {
        if self.heat.is_some() {
            bail!(WrongUsage(
                "--heat: only fovvideovdp shows where; leave --metric out".to_owned()
            ));
        }
        let mut judge = CompanionJudge::new(companion, viewing).context("--metric")?;
        let mut per_frame = Vec::new();
        frames(&mut |frame| {
            per_frame.push(judge.frame(&frame.reference, &frame.test, frame.gaze_px)?);
            Ok(())
        })?;
        let measure = (companion, self.mode.mode());
        let single = Single::new(measure, viewing, gaze, judge.total(), per_frame);
        Ok(Judged::By(single))
    }

    /// Reads both to their end, frame by frame.
    fn each_frame(
        &self,
        (reference, test): &mut (Frames, Frames),
        viewing: &Viewing,
        gaze: Option<&GazeOnPicture>,
        take: &mut TakeFrame<'_>,
    ) -> anyhow::Result<()> {
        let most = self.frames.unwrap_or(u32::MAX);
        let length = reference.frames.map(|frames| frames.min(u64::from(most)));
        let names = [reference.name.clone(), test.name.clone()];
        let bar = output::bar(length, Counting::Frames);
        for number in 0..most {
            // A trace may end where the pictures do: it is asked when there is a picture.
            let gaze_px = || match gaze {
                Some(gaze) => gaze.at(number, viewing.size),
                None => Ok([0.0; 2]),
            };
            let both = (reference.next(gaze_px)?, test.next(gaze_px)?);
            let (reference, test) = match both {
                (Some(reference), Some(test)) => (reference, test),
                (None, None) if number > 0 => break,
                (longer, _) => {
                    let (name, other) = match longer {
                        Some(_) => (&names[1], &names[0]),
                        None => (&names[0], &names[1]),
                    };
                    bail!(
                        "{}: ends after {}, {} goes on; give --frames {}",
                        name.display(),
                        counted(number, "frame"),
                        other.display(),
                        number.max(1)
                    );
                }
            };
            take(Frame {
                reference,
                test,
                gaze_px: gaze_px()?,
            })?;
            bar.inc(1);
        }
        bar.finish_and_clear();
        Ok(())
    }
}
