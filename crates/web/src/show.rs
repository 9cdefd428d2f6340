//! Which calls does TypeScript make?
//!
//! Numbers and bytes cross as they are, what has many fields as JSON. `now` is in seconds of the
//! page's clock, places are in device pixels of the canvas.

use crate::device_canvas::DeviceCanvas;
use crate::headset_eye::EyeRequest;
use crate::opening::{OpenPack, Opening};
use crate::options::Options;
use crate::page_player::PagePlayer;
use crate::pixel_canvas::PixelCanvas;
use foveal_core::content::payload::Payload;
use foveal_core::content::policy::Policy;
use foveal_core::content::policy::asked;
use foveal_core::content::policy::asked::Detail;
use foveal_core::content::video::bytes::sound::SoundTable;
use foveal_core::gaze::sample::HeadPose;
use foveal_core::pack::unit::UnitId;
use foveal_core::units::{Radians, Seconds};
use foveal_core::view::picture::{Picture, plane_size};
use foveal_core::view::surface::Eye;
use foveal_render::{DrawnPicture, Gpu};
use js_sys::{Array, Uint8Array};
use serde::Serialize;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use wasm_bindgen::prelude::{JsError, JsValue, wasm_bindgen};
use web_sys::OffscreenCanvas;

type Outcome<T> = Result<T, JsError>;

fn refused(error: impl std::fmt::Display) -> JsError {
    JsError::new(&error.to_string())
}

fn json(value: &impl Serialize) -> Outcome<String> {
    serde_json::to_string(value).map_err(refused)
}

/// A pack that is being opened.
#[wasm_bindgen]
#[derive(Default)]
pub struct Pack {
    opening: Opening,
}

#[wasm_bindgen]
impl Pack {
    /// None of it has come.
    #[wasm_bindgen(constructor)]
    pub fn new() -> Self {
        Self::default()
    }

    /// What to fetch, as [`Show::needs`].
    pub fn needs(&self) -> Outcome<String> {
        json(&self.opening.needs())
    }

    /// Takes a stretch of the file, as [`Show::arrived`]; refuses what is damaged.
    pub fn arrived(&mut self, offset: f64, bytes: &[u8]) -> Outcome<String> {
        let arrival = self.opening.arrived(offset as u64, bytes);
        json(&arrival.map_err(refused)?)
    }

    /// Bytes of the file, once its header says so.
    #[wasm_bindgen(js_name = fileBytes)]
    pub fn file_bytes(&self) -> Option<f64> {
        self.opening.file_bytes().map(|bytes| bytes as f64)
    }

    /// Whether all has come that is needed to show it.
    #[wasm_bindgen(js_name = isOpen)]
    pub fn is_open(&self) -> bool {
        self.opening.open().is_some()
    }

    /// What is known of it, as JSON.
    pub fn about(&self) -> Outcome<String> {
        self.open().map(crate::facts::about)
    }
}

impl Pack {
    fn open(&self) -> Outcome<&OpenPack> {
        self.opening
            .open()
            .ok_or_else(|| refused("the pack is not open"))
    }
}

/// A pack on a canvas.
#[wasm_bindgen]
pub struct Show {
    player: PagePlayer,
    target: Target,
    /// The canvas that eyes of a headset are drawn on.
    headset: Option<DeviceCanvas>,
    lost: Arc<AtomicBool>,
}

/// What pictures are shown on.
enum Target {
    Device(DeviceCanvas),
    Pixels(PixelCanvas),
}

/// A device, and whether it was lost since.
async fn open_gpu() -> Outcome<(Gpu, Arc<AtomicBool>)> {
    let gpu = Gpu::open().await.map_err(refused)?;
    let lost = Arc::new(AtomicBool::new(false));
    let told = Arc::clone(&lost);
    gpu.device
        .set_device_lost_callback(move |_, _| told.store(true, Ordering::Relaxed));
    Ok((gpu, lost))
}

#[wasm_bindgen]
impl Show {
    /// Shows an open pack on a canvas; without a device the CPU twin draws.
    #[wasm_bindgen(constructor)]
    pub fn new(
        canvas: OffscreenCanvas,
        pack: &Pack,
        device: Option<Device>,
        options: &str,
    ) -> Outcome<Self> {
        let options = Options::parse(options).map_err(refused)?;
        let (gpu, lost) = device.map(|device| (device.gpu, device.lost)).unzip();
        let is_drawn = gpu.is_some();
        let player = PagePlayer::new(pack.open()?, &options, gpu).map_err(refused)?;
        let target = if is_drawn {
            Target::Device(DeviceCanvas::new(canvas).map_err(refused)?)
        } else {
            Target::Pixels(PixelCanvas::new(canvas).map_err(refused)?)
        };
        Ok(Self {
            player,
            target,
            headset: None,
            lost: lost.unwrap_or_default(),
        })
    }

    /// Whether the device is gone.
    #[wasm_bindgen(js_name = isLost)]
    pub fn is_lost(&self) -> bool {
        self.lost.load(Ordering::Relaxed)
    }

    /// Gives the device back, as if it were lost.
    #[wasm_bindgen(js_name = loseDevice)]
    pub fn lose_device(&self) {
        if let Some(gpu) = self.player.gpu() {
            gpu.device.destroy();
        }
    }

    /// Starts over on this device; [`Device::open`] opens it.
    pub fn restart(&mut self, device: Device) -> Outcome<()> {
        self.player.recover(device.gpu).map_err(refused)?;
        self.lost = device.lost;
        if let Target::Device(canvas) = &mut self.target {
            canvas.forget_device();
        }
        self.headset = None;
        Ok(())
    }

    /// Moves on to `now`; returns what happened as the bits of `flag`.
    pub fn step(&mut self, now: f64) -> Outcome<u32> {
        self.player.step(Seconds(now)).map_err(refused)
    }

    /// What to fetch, decode and hand over, first what matters most: a list of `Need` of
    /// `web/src/engine/needs.ts`, as JSON.
    pub fn needs(&mut self) -> Outcome<String> {
        json(&self.player.needs())
    }

    /// Takes a stretch of the file that came, and says in JSON what there is to do for it: an
    /// `Arrival` of `web/src/engine/needs.ts`. Refuses once what is damaged for good.
    pub fn arrived(&mut self, offset: f64, bytes: &[u8]) -> Outcome<String> {
        let arrival = self.player.arrived(offset as u64, bytes);
        json(&arrival.map_err(refused)?)
    }

    /// Whether side tables by which the policy chooses are still to come.
    #[wasm_bindgen(js_name = awaitsTables)]
    pub fn awaits_tables(&self) -> bool {
        self.player.awaits_tables()
    }

    /// Takes the planes of a frame of a unit, one after the other without gaps.
    pub fn deliver(&mut self, unit: u32, frame: u32, decoded: u32, planes: &[u8]) -> Outcome<()> {
        let Some(video) = self.player.pack.content.video() else {
            return Err(refused("a scene has no such parts"));
        };
        let [width, height] = video.grid().tile_size(video.pack().tile_of(UnitId(unit)));
        let sizes = [0, 1, 2].map(|plane| {
            let [w, h] = plane_size(width, height, plane);
            w as usize * h as usize
        });
        if sizes.iter().sum::<usize>() != planes.len() {
            return Err(refused(format!(
                "planes of {} bytes, expected {sizes:?}",
                planes.len()
            )));
        }
        let (y, chroma) = planes.split_at(sizes[0]);
        let (u, v) = chroma.split_at(sizes[1]);
        let picture = Picture {
            width,
            height,
            planes: [y, u, v].map(<[u8]>::to_vec),
        };
        let picture = Payload::Picture(picture);
        self.player.deliver(unit, frame, decoded, Some(picture));
        Ok(())
    }

    /// A frame of a unit cannot be had.
    pub fn fail(&mut self, unit: u32, frame: u32) {
        self.player.deliver(unit, frame, 0, None);
    }

    /// Draws the picture onto the canvas.
    pub fn draw(&mut self) -> Outcome<()> {
        let (shown, marks) = (self.player.shown(), self.player.marks());
        let size = self.player.pane().size;
        match (self.player.gpu(), &mut self.target) {
            (Some(gpu), Target::Device(canvas)) => {
                let picture = self
                    .player
                    .play
                    .drawer_mut()
                    .draw(&shown.view, marks.as_ref());
                if let Some(picture) = picture.map_err(refused)? {
                    canvas.show(&gpu, picture, shown.origin, size);
                }
                Ok(())
            }
            (None, Target::Pixels(canvas)) => {
                let read = self
                    .player
                    .play
                    .drawer_mut()
                    .read(&shown.view, marks.as_ref());
                match read.map_err(refused)? {
                    Some(DrawnPicture::Here(picture)) => {
                        canvas.show(&picture, shown.origin, size).map_err(refused)
                    }
                    _ => Ok(()),
                }
            }
            _ => Ok(()),
        }
    }

    /// A promise that is kept once all that was drawn so far is on the canvas.
    pub fn seen(&self) -> js_sys::Promise {
        let done = self.player.gpu().map(|gpu| gpu.done());
        wasm_bindgen_futures::future_to_promise(async move {
            if let Some(done) = done {
                done.await;
            }
            Ok(JsValue::UNDEFINED)
        })
    }

    /// The first picture is on the canvas: time begins, where it plays.
    pub fn begin(&mut self, now: f64) {
        self.player.viewer.begin(Seconds(now));
    }

    /// What was to be drawn was drawn in this many seconds.
    pub fn drawn(&mut self, seconds: f64) {
        self.player.drawn(seconds);
    }

    /// The picture as it is drawn: a promise of [width, height, RGBA bytes].
    pub fn pixels(&mut self) -> Outcome<js_sys::Promise> {
        let (shown, marks) = (self.player.shown(), self.player.marks());
        let read = self
            .player
            .play
            .drawer_mut()
            .read(&shown.view, marks.as_ref());
        let read = read.map_err(refused)?;
        let read = read.ok_or_else(|| refused("nothing draws"))?;
        Ok(wasm_bindgen_futures::future_to_promise(async move {
            let image = read.image().await.map_err(refused)?;
            let [width, height] = image.size.map(JsValue::from);
            let bytes = Uint8Array::from(image.pixels.as_slice());
            Ok(Array::of3(&width, &height, &bytes).into())
        }))
    }

    /// Draws what an eye of a headset sees onto a canvas of its own size: x, y, z, w of its
    /// orientation, its tangents to the left, right, top and bottom, then its place in metres from
    /// where the head began. `false` before the first picture.
    #[wasm_bindgen(js_name = drawEye)]
    pub fn draw_eye(
        &mut self,
        canvas: &OffscreenCanvas,
        is_right: bool,
        eye: &[f64],
        now: f64,
    ) -> Outcome<bool> {
        let &[x, y, z, w, left, right, up, down, ref position @ ..] = eye else {
            return Err(refused("an eye is eleven numbers"));
        };
        let position = position.try_into();
        let position = position.map_err(|_| refused("an eye is eleven numbers"))?;
        let request = EyeRequest {
            eye: if is_right { Eye::Right } else { Eye::Left },
            size: [canvas.width(), canvas.height()],
            position,
            orientation: [x, y, z, w],
            tangents: [left, right, up, down],
        };
        let view = self.player.eye_view(&request, Seconds(now));
        let view = view.ok_or_else(|| refused("invalid eye pose or field"))?;
        if self.player.play.session().shown_tick().is_none() {
            return Ok(false);
        }
        if self.headset.is_none() {
            self.headset = Some(DeviceCanvas::new(canvas.clone()).map_err(refused)?);
        }
        let Some(gpu) = self.player.gpu() else {
            return Ok(false);
        };
        let picture = self
            .player
            .play
            .drawer_mut()
            .draw(&view, None)
            .map_err(refused)?;
        if let (Some(headset), Some(picture)) = (&mut self.headset, picture) {
            headset.show(&gpu, picture, [0, 0], view.size);
        }
        Ok(true)
    }

    /// The canvas has other pixels.
    pub fn resize(&mut self, width: u32, height: u32) {
        self.player.resize([width, height]);
    }

    /// Draws the content along.
    pub fn drag(&mut self, x: f64, y: f64) {
        let pane = self.player.pane();
        self.player.viewer.navigation.drag([x, y], &pane);
    }

    /// Comes closer by a factor, round a place.
    pub fn zoom(&mut self, factor: f64, x: f64, y: f64) {
        let pane = self.player.pane();
        self.player.viewer.navigation.zoom_by(factor, [x, y], &pane);
    }

    /// Flies, or no longer flies, through a scene along a direction of the head: to the right, up
    /// and ahead.
    pub fn fly(&mut self, towards: &[f64], is_held: bool, is_hurried: bool, now: f64) {
        if let Ok(towards) = towards.try_into() {
            self.player.fly(towards, is_held, is_hurried, Seconds(now));
        }
    }

    /// Stays where it is in a scene.
    #[wasm_bindgen(js_name = stopFlying)]
    pub fn stop_flying(&mut self, now: f64) {
        self.player.stop_flying(Seconds(now));
    }

    /// The head is turned to these degrees to the right, up and clockwise.
    pub fn turn(&mut self, yaw: f64, pitch: f64, roll: f64) {
        let [yaw, pitch, roll] = [yaw, pitch, roll].map(Radians::from_degrees);
        self.player
            .viewer
            .navigation
            .look_along(HeadPose { yaw, pitch, roll });
    }

    /// Turns the view of a sphere by hand to these degrees to the right and up, and makes it so
    /// many degrees wide; what is no number stays.
    pub fn look(&mut self, yaw: f64, pitch: f64, fov: f64) {
        let pane = self.player.pane();
        let wanted = [yaw, pitch, fov].map(|it| it.is_finite().then(|| Radians::from_degrees(it)));
        self.player.viewer.navigation.look(wanted, &pane);
    }

    /// Back to where the view began.
    pub fn reset(&mut self) {
        self.player.viewer.navigation.reset();
    }

    /// The pointer is at a place.
    pub fn point(&mut self, x: f64, y: f64) {
        self.player.viewer.pointer.move_to([x, y]);
    }

    /// The pointer left.
    pub fn leave(&mut self, now: f64) {
        self.player.viewer.pointer.leave(Seconds(now));
    }

    /// Takes a gaze record; refuses anything else.
    pub fn gaze(&mut self, record: &str, now: f64) -> Outcome<()> {
        let taken = self
            .player
            .looking
            .take(record.trim().as_bytes(), Seconds(now));
        taken.map_err(refused)
    }

    /// Goes back from records to the pointer.
    #[wasm_bindgen(js_name = forgetGaze)]
    pub fn forget_gaze(&mut self) {
        self.player.looking.forget_sender();
    }

    /// Plays.
    pub fn play(&mut self, now: f64) {
        self.player.play(Seconds(now));
    }

    /// Pauses.
    pub fn pause(&mut self, now: f64) {
        self.player.pause(Seconds(now));
    }

    /// Goes to a time of the content.
    pub fn seek(&mut self, seconds: f64, now: f64) {
        self.player.seek(Seconds(seconds), Seconds(now));
    }

    /// Goes some frames on or back, and pauses.
    #[wasm_bindgen(js_name = stepFrames)]
    pub fn step_frames(&mut self, frames: i32, now: f64) {
        self.player.step_frames(i64::from(frames), Seconds(now));
    }

    /// Keeps to what is heard.
    pub fn heard(&mut self, seconds: f64, now: f64) {
        self.player.heard(Seconds(seconds), Seconds(now));
    }

    /// Chooses by another policy; refuses one that the pack has no tables for.
    #[wasm_bindgen(js_name = setPolicy)]
    pub fn set_policy(&mut self, name: &str) -> Outcome<()> {
        let policy: Policy = serde_json::from_value(name.into()).map_err(refused)?;
        self.player.set_policy(policy).map_err(refused)
    }

    /// The policy that needs fewer pixels of this content for its target, once its calibration has
    /// been loaded.
    #[wasm_bindgen(js_name = cheaperPolicy)]
    pub fn cheaper_policy(&self) -> Option<String> {
        let policy = self.player.cheaper_policy()?;
        Some(policy.name().to_owned())
    }

    /// Chooses for a score, in JSON a number or `"none"`; the usual one where nothing is said.
    #[wasm_bindgen(js_name = setTarget)]
    pub fn set_target(&mut self, target: Option<String>) -> Outcome<()> {
        let detail = match target {
            Some(json) => {
                let target: asked::Target = serde_json::from_str(&json).map_err(refused)?;
                Detail::Target(target.checked().map_err(refused)?)
            }
            None => Detail::Usual,
        };
        self.player.set_detail(detail);
        Ok(())
    }

    /// Goes so many target scores on, or back, and says which is asked for then, as in
    /// [`Self::set_target`]; nothing where the policy has no target.
    #[wasm_bindgen(js_name = nextTarget)]
    pub fn next_target(&mut self, by: i32) -> Option<String> {
        match self.player.next_target(by)? {
            Detail::Target(Some(jod)) => Some(jod.to_string()),
            _ => Some("\"none\"".to_owned()),
        }
    }

    /// Draws the levels over the picture.
    #[wasm_bindgen(js_name = showLevels)]
    pub fn show_levels(&mut self, shown: bool) {
        self.player.levels_shown = shown;
    }

    /// What the host brings, in bytes per second.
    #[wasm_bindgen(js_name = setRate)]
    pub fn set_rate(&mut self, bytes_per_s: f64) {
        self.player.set_rate(bytes_per_s);
    }

    /// Figures, as JSON.
    pub fn stats(&self, now: f64) -> String {
        self.player.stats(Seconds(now))
    }

    /// Lines of the session log so far.
    pub fn log(&self) -> String {
        self.player.log().to_owned()
    }

    /// Channels, samples before sample 0, samples of a packet, packets, then number of the first
    /// packet of a stretch of time and the packets; empty where there is no sound, and nothing
    /// while it is still to come.
    #[wasm_bindgen(js_name = soundPackets)]
    pub fn sound_packets(&mut self, from: f64, to: f64) -> Option<Array> {
        if self.player.awaits_sound() {
            return None;
        }
        let video = self.player.pack.content.video();
        let sound = video.and_then(|video| video.sound());
        Some(sound.map_or_else(Array::new, |sound| stretch(sound, from, to)))
    }
}

fn stretch(sound: &SoundTable, from: f64, to: f64) -> Array {
    let rate = f64::from(foveal_core::content::video::bytes::sound::SOUND_RATE);
    let packet = |seconds: f64| {
        let sample = seconds.max(0.0) * rate + f64::from(sound.pre_skip);
        (sample / f64::from(sound.packet_samples)) as usize
    };
    let (first, last) = (packet(from), packet(to).min(sound.packets()));
    let head = [
        f64::from(sound.channels),
        f64::from(sound.pre_skip),
        f64::from(sound.packet_samples),
        sound.packets() as f64,
        first as f64,
    ];
    let packets = (first..last).filter_map(|number| sound.packet(number));
    let packets = packets.map(|bytes| JsValue::from(Uint8Array::from(bytes)));
    head.into_iter().map(JsValue::from).chain(packets).collect()
}

/// A device that stands in for a lost one.
#[wasm_bindgen]
pub struct Device {
    gpu: Gpu,
    lost: Arc<AtomicBool>,
}

#[wasm_bindgen]
impl Device {
    /// Opens a device.
    pub async fn open() -> Outcome<Device> {
        let (gpu, lost) = open_gpu().await?;
        Ok(Self { gpu, lost })
    }
}
