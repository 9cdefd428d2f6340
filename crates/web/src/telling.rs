//! What does a page report about itself?

use crate::page_player::PagePlayer;
use foveal_core::units::Seconds;
use foveal_core::view::axes::yaw_pitch_from_direction;
use serde_json::json;

impl PagePlayer {
    /// The part of the `Stats` of `web/src/engine/api.ts` that is known here, as JSON.
    pub fn stats(&self, now: Seconds) -> String {
        let figures = self.play.session().figures();
        let head = self.viewer.navigation.head();
        let timeline = self.play.session().timeline();
        let frame = self
            .play
            .session()
            .shown_tick()
            .map(|tick| timeline.frame_of(tick));
        let shown = self.shown();
        let gaze = self
            .viewer
            .moment()
            .map(|moment| moment.gaze.gaze_in_content);
        let gaze_deg = gaze.map(|gaze| {
            let (yaw, pitch) = yaw_pitch_from_direction(gaze);
            [yaw.to_degrees(), pitch.to_degrees()]
        });
        let place = gaze.and_then(|gaze| shown.view.place(gaze));
        let place = place.map(|place| [0, 1].map(|k| place[k] + f64::from(shown.origin[k])));
        let [fps, upload] = figures.rates(now);
        json!({
            "policy": self.play.session().policy().policy,
            "target": self.play.session().policy().target,
            "expectedScore": self.play.session().expected_jod(),
            "playing": self.viewer.is_playing(),
            "time": self.time(now).0,
            "frame": frame,
            "share": figures.share,
            "levels": figures.histogram,
            "gpuBytes": figures.gpu_bytes,
            "tileMs": figures.decode_ms,
            "fps": fps,
            "uploadRate": upload,
            "framesShown": figures.frames,
            "framesLeftOut": figures.left_out_frames,
            "framesLate": figures.late_frames,
            "framesIncomplete": figures.incomplete_frames,
            "damagedTiles": figures.damaged_units,
            "damagedFrames": figures.damaged_frames,
            "wrongFrameTiles": figures.wrong_frame_units,
            "settled": self.is_settled(),
            "headDeg": [head.yaw.to_degrees(), head.pitch.to_degrees(), head.roll.to_degrees()],
            "position": shown.view.position.to_array(),
            "trianglesDrawn": self.play.triangles_drawn(),
            "zoom": self.viewer.navigation.zoom(),
            "fovDeg": self.viewer.navigation.field().to_degrees(),
            "scale": self.viewer.navigation.scale(&self.pane()),
            "gazeDeg": gaze_deg,
            "gazePlace": place,
            "drawing": self.device_name(),
        })
        .to_string()
    }
}
