//! How do a viewer's figures and settings read?

use crate::commands::view::screen::overlay::{KeyLine, Line};
use crate::commands::view::styles::{interpolation, reconstruction};
use crate::commands::view::window_player::WindowPlayer;
use crate::report::output::size;
use foveal_core::content::policy::asked::score_told;
use foveal_core::units::{Seconds, counted};
use foveal_core::view::keys::{KEYS, Needs, Row};

impl WindowPlayer {
    /// The keys that do something now.
    pub(super) fn keys(&self) -> Vec<KeyLine> {
        let style = self.live.style();
        let does = |needs| match needs {
            Needs::Nothing => true,
            Needs::Video => self.facts().has_tiles,
            Needs::Scene => self.facts().is_entered,
            Needs::Frames => !self.live.session().timeline().is_still(),
            Needs::Heard => self.sound.is_some(),
            Needs::TwoEyes => self.two_eyes,
            Needs::Samples => style.samples,
            Needs::Tiles => self.facts().has_tiles && !style.samples,
            Needs::Atlas => self.facts().has_tiles && !style.samples && !style.has_textures,
        };
        let here = KEYS.iter().filter(|row| does(row.needs));
        let says = |says: &'static str| says.strip_prefix("scenes: ").unwrap_or(says);
        here.map(|row: &Row| (row.shown, says(row.says))).collect()
    }

    fn style_told(&self) -> String {
        let style = self.live.style();
        let what = if style.samples {
            interpolation(style.interpolation)
        } else {
            reconstruction(style)
        };
        let blur = if style.blurs { ", blurred" } else { "" };
        format!("{what}{blur}")
    }

    /// The figures, for people.
    pub(super) fn lines(&self, now: Seconds) -> Vec<Line> {
        match self.facts().has_tiles {
            true => self.lines_of_video(now),
            false => self.lines_of_scene(now),
        }
    }

    /// What may be spent, where the policy spends.
    fn budget_told(&self) -> String {
        let spends = self.live.session().policy_in_use().policy.spends_a_budget();
        match self.bytes_per_s.filter(|_| spends) {
            Some(bytes) => format!("{}/s", size(bytes as u64)),
            None => "no limit".to_owned(),
        }
    }

    fn lines_of_scene(&self, now: Seconds) -> Vec<Line> {
        let session = self.live.session();
        let (figures, config) = (session.figures(), session.policy_in_use());
        let levels: Vec<String> = figures.histogram.iter().map(ToString::to_string).collect();
        let all = self.live.opened().content().finest_samples();
        let told = [
            ("policy", config.policy.name().to_owned()),
            ("budget", self.budget_told()),
            (
                "drawn",
                format!("{} pictures/s", self.draw_rate.per_second(now)),
            ),
            (
                "shown",
                format!(
                    "{:.1} % of {all} triangles, points and texels",
                    figures.share * 100.0
                ),
            ),
            ("drawn triangles", self.live.triangles_drawn().to_string()),
            ("units by level", levels.join(" / ")),
            ("GPU memory", size(figures.gpu_bytes)),
            ("fetched", size(figures.fetched_bytes)),
            ("damaged", counted(figures.damaged_units, "unit")),
        ];
        let told = told.map(|(what, value)| (what.to_owned(), value));
        let [.., recovered] = self.carried_on();
        told.into_iter().chain([recovered]).collect()
    }

    fn lines_of_video(&self, now: Seconds) -> Vec<Line> {
        let [fps, upload] = self.live.session().figures().rates(now);
        let figures = self.live.session().figures();
        let levels: Vec<String> = figures.histogram.iter().map(ToString::to_string).collect();
        let line = |what: &str, value: String| (what.to_owned(), value);
        let mut lines = vec![
            line(
                "policy",
                self.live.session().policy_in_use().policy.name().to_owned(),
            ),
            line(
                "score",
                score_told(
                    self.live.session().policy().target,
                    // What a link leaves out is not in the expectation.
                    (self.bytes_per_s.is_none())
                        .then(|| self.live.session().expected_jod())
                        .flatten(),
                ),
            ),
            line("picture", self.style_told()),
            line("zoom", format!("{:.2}", self.viewer.navigation.zoom())),
        ];
        lines.extend(self.time(now, fps));
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
    fn time(&self, now: Seconds, fps: f64) -> Vec<Line> {
        let timeline = self.live.session().timeline();
        if timeline.is_still() {
            return Vec::new();
        }
        let media = self.viewer.time(now);
        let frame = self
            .live
            .session()
            .shown_tick()
            .map_or(0, |tick| timeline.frame_of(tick));
        let (within, length) = (timeline.within(media).0, timeline.length().0);
        let shown = match self.is_moving() {
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
        let figures = self.live.session().figures();
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
                    counted(figures.damaged_units, "tile"),
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
