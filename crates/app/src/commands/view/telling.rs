//! How do a viewer's figures and settings read?

use crate::commands::view::Stage;
use crate::commands::view::screen::overlay::{Key, Line};
use crate::commands::view::viewer::Viewer;
use crate::run::canvas::Showing;
use foveal_core::content::asked::score_told;
use foveal_core::units::{Seconds, counted};
use foveal_core::view::keys::{KEYS, Needs, Row};
use foveal_render::Interpolation;

/// What fills the pixels between samples.
pub(super) fn interpolation(interpolation: Interpolation) -> &'static str {
    match interpolation {
        Interpolation::Nearest => "nearest sample",
        Interpolation::Blended => "blended samples",
    }
}

/// What tiles lie in.
pub(super) fn reconstruction(showing: &Showing) -> &'static str {
    if showing.has_textures {
        "textures"
    } else {
        "atlas"
    }
}

impl Viewer {
    /// The keys that do something now.
    pub(super) fn keys(&self, stage: &Stage) -> Vec<Key> {
        let style = stage.easel.style();
        let does = |needs| match needs {
            Needs::Nothing => true,
            Needs::Frames => !stage.timeline().is_still(),
            Needs::Heard => self.sound.is_some(),
            Needs::TwoEyes => self.two_eyes,
            Needs::Samples => style.samples,
            Needs::Tiles => !style.samples,
            Needs::Atlas => !style.samples && !style.showing.has_textures,
        };
        let here = KEYS.iter().filter(|row| does(row.needs));
        here.map(|Row { shown, says, .. }| (*shown, *says))
            .collect()
    }

    fn style_told(&self, stage: &Stage) -> String {
        let style = stage.easel.style();
        let what = if style.samples {
            interpolation(style.showing.interpolation)
        } else {
            reconstruction(&style.showing)
        };
        let blur = if style.showing.blurs { ", blurred" } else { "" };
        format!("{what}{blur}")
    }

    /// The figures, for people.
    pub(super) fn lines(&self, stage: &Stage, now: Seconds) -> Vec<Line> {
        let [fps, upload] = self.figures.rates(now);
        let figures = &self.figures;
        let levels: Vec<String> = figures.histogram.iter().map(ToString::to_string).collect();
        let line = |what: &str, value: String| (what.to_owned(), value);
        let mut lines = vec![
            line("policy", self.choice.policy().name().to_owned()),
            line(
                "score",
                score_told(self.choice.target(), self.choice.expected_jod()),
            ),
            line("picture", self.style_told(stage)),
            line("zoom", format!("{:.2}", self.scene.zoom())),
        ];
        lines.extend(self.time(stage, now, fps));
        lines.extend([
            line(
                "decode, draw",
                format!(
                    "{:.1} ms, {:.1} ms a frame",
                    figures.decode_ms,
                    figures.draw_s * 1e3
                ),
            ),
            line("upload", format!("{upload:.1} MB/s")),
            line(
                "pixels",
                format!("{:.2} % of the finest", figures.share * 100.0),
            ),
            line("tiles by level", levels.join(" / ")),
            line(
                "GPU memory",
                format!("{:.1} MB", figures.gpu_bytes as f64 / 1e6),
            ),
        ]);
        lines.extend(self.carried_on());
        if self.two_eyes {
            lines.push(line("eye", self.eye.name().to_owned()));
        }
        if let Some(sound) = &self.sound {
            let off = self.drift.worst_and_p95_ms();
            let off = off.map_or("at the beginning".to_owned(), |[worst, p95]| {
                format!("95 % in {p95:.0} ms, all {worst:.0}")
            });
            lines.push(line(
                "sound",
                format!("{off}; {}", counted(sound.gaps(), "gap")),
            ));
        }
        lines
    }

    /// Where in time it is, and how fast that goes; nothing of a picture, which has none.
    fn time(&self, stage: &Stage, now: Seconds, fps: f64) -> Vec<Line> {
        let timeline = stage.timeline();
        if timeline.is_still() {
            return Vec::new();
        }
        let media = self.clock.time(now);
        let frame = stage.shown_tick().map_or(0, |tick| timeline.frame_of(tick));
        let (within, length) = (timeline.within(media).0, timeline.length().0);
        let shown = match self.is_moving(stage) {
            true => format!("{fps:.1} frames/s"),
            false => "paused".to_owned(),
        };
        vec![
            (
                "time".to_owned(),
                format!("{within:.2} / {length:.2} s, frame {frame}"),
            ),
            ("shown".to_owned(), shown),
        ]
    }

    /// What went wrong and was carried on from.
    fn carried_on(&self) -> [Line; 4] {
        let figures = &self.figures;
        let line = |what: &str, value: String| (what.to_owned(), value);
        [
            line(
                "late",
                format!(
                    "{} for decoding, {} for drawing, {} incomplete",
                    figures.late_frames, figures.slow_draws, figures.incomplete_frames
                ),
            ),
            line("left out", counted(figures.left_out_frames, "frame")),
            line(
                "damaged",
                format!(
                    "{}, {}",
                    counted(figures.damaged_tiles, "tile"),
                    counted(figures.damaged_frames, "frame")
                ),
            ),
            line(
                "recovered",
                format!(
                    "{}, {}",
                    counted(figures.lost_devices, "lost device"),
                    counted(figures.gpu_errors, "error")
                ),
            ),
        ]
    }
}
