//! Which calls does TypeScript make?
//!
//! Numbers and bytes cross as they are, what has many fields as JSON. `now` is in seconds of the
//! page's clock, places are in device pixels of the canvas.

use crate::device_canvas::DeviceCanvas;
use crate::headset_eye::EyeRequest;
use crate::options::Options;
use crate::page_player::PagePlayer;
use crate::pixel_canvas::PixelCanvas;
use foveal_core::content::asked;
use foveal_core::content::asked::Detail;
use foveal_core::content::payload::Payload;
use foveal_core::content::policy::Policy;
use foveal_core::content::video::Video;
use foveal_core::content::video::bytes::sound::SoundTable;
use foveal_core::gaze::sample::HeadPose;
use foveal_core::pack::unit::UnitId;
use foveal_core::units::{Radians, Seconds};
use foveal_core::view::picture::{Picture, plane_size};
use foveal_core::view::surface::Eye;
use foveal_render::{DrawnPicture, Gpu};
use js_sys::{Array, Uint8Array};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use wasm_bindgen::prelude::{JsError, JsValue, wasm_bindgen};
use web_sys::OffscreenCanvas;

type Outcome<T> = Result<T, JsError>;

fn refused(error: impl std::fmt::Display) -> JsError {
    JsError::new(&error.to_string())
}

/// Bytes from the beginning of a pack that hold its header and description, by its first 64.
#[wasm_bindgen(js_name = headBytes)]
#[allow(unreachable_pub, reason = "exported to the page")]
pub fn head_bytes(beginning: &[u8]) -> Outcome<f64> {
    let bytes = crate::facts::head_bytes(beginning).map_err(refused)?;
    Ok(bytes as f64)
}

/// What is known of a pack that begins with these bytes, as JSON.
#[wasm_bindgen]
#[allow(unreachable_pub, reason = "exported to the page")]
pub fn about(head: &[u8]) -> Outcome<String> {
    crate::facts::about(head).map_err(refused)
}

/// First byte and length of every stretch that [`Show::open`] needs besides the head.
#[wasm_bindgen]
#[allow(unreachable_pub, reason = "exported to the page")]
pub fn opening(head: &[u8]) -> Outcome<Vec<f64>> {
    crate::facts::opening(head).map_err(refused)
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
    /// Opens a device, or none where `software` is asked for, and shows the pack that begins with
    /// `head`, with what [`opening`] asks for in `rest`, one after the other.
    pub async fn open(
        canvas: OffscreenCanvas,
        head: Vec<u8>,
        rest: Vec<u8>,
        options: String,
    ) -> Outcome<Show> {
        let options = Options::parse(&options).map_err(refused)?;
        let (gpu, lost) = if options.software {
            (None, Arc::default())
        } else {
            let (gpu, lost) = open_gpu().await?;
            (Some(gpu), lost)
        };
        let player = PagePlayer::new(&head, &rest, &options, gpu).map_err(refused)?;
        let target = if options.software {
            Target::Pixels(PixelCanvas::new(canvas).map_err(refused)?)
        } else {
            Target::Device(DeviceCanvas::new(canvas).map_err(refused)?)
        };
        Ok(Self {
            player,
            target,
            headset: None,
            lost,
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

    /// What to fetch and decode, in rows of ten numbers.
    pub fn needs(&self) -> Vec<f64> {
        self.player.needs()
    }

    /// Takes a page of the index.
    #[wasm_bindgen(js_name = addPage)]
    pub fn add_page(&self, page: u32, bytes: &[u8]) -> Outcome<()> {
        let index = self.video()?.pack().index();
        index.add_page(page, bytes).map_err(refused)
    }

    /// A page of the index is damaged: the units that it covers cannot be loaded.
    #[wasm_bindgen(js_name = failPage)]
    pub fn fail_page(&self, page: u32) {
        if let Some(video) = self.player.pack.content.video() {
            video.fail_page(page);
        }
    }

    /// First byte and length of a side table; nothing where there is none.
    #[wasm_bindgen(js_name = tablePlace)]
    pub fn table_place(&self, name: &str) -> Vec<f64> {
        let place = self.player.pack.table_place(name);
        place.map_or(Vec::new(), |place| {
            vec![place.start as f64, (place.end - place.start) as f64]
        })
    }

    /// Takes a side table.
    #[wasm_bindgen(js_name = addTable)]
    pub fn add_table(&mut self, name: &str, bytes: Vec<u8>) -> Outcome<()> {
        self.player.add_table(name, bytes).map_err(refused)
    }

    /// A side table cannot be had.
    #[wasm_bindgen(js_name = failTable)]
    pub fn fail_table(&self, name: &str) {
        if let Some(video) = self.player.pack.content.video() {
            video.fail_table(name);
        }
    }

    /// Lengths of the access units at the end of a chunk; refuses a damaged one.
    pub fn lengths(&self, unit: u32, chunk: &[u8]) -> Outcome<Vec<u32>> {
        let lengths = self.video()?.lengths(UnitId(unit), chunk);
        lengths.map_err(refused)
    }

    /// Takes the planes of a frame of a unit, one after the other without gaps.
    pub fn deliver(&mut self, unit: u32, frame: u32, decoded: u32, planes: &[u8]) -> Outcome<()> {
        let video = self.video()?;
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

    /// Takes the chunk of a unit as it is; refuses a damaged one.
    #[wasm_bindgen(js_name = deliverWhole)]
    pub fn deliver_whole(&mut self, unit: u32, chunk: &[u8]) -> Outcome<()> {
        self.player.deliver_whole(unit, chunk).map_err(refused)
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
                let picture = self.player.drawer.draw(&shown.view, marks.as_ref());
                if let Some(picture) = picture.map_err(refused)? {
                    canvas.show(&gpu, picture, shown.origin, size);
                }
                Ok(())
            }
            (None, Target::Pixels(canvas)) => {
                let read = self.player.drawer.read(&shown.view, marks.as_ref());
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
        let read = self.player.drawer.read(&shown.view, marks.as_ref());
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
        if self.player.session.shown_tick().is_none() {
            return Ok(false);
        }
        if self.headset.is_none() {
            self.headset = Some(DeviceCanvas::new(canvas.clone()).map_err(refused)?);
        }
        let Some(gpu) = self.player.gpu() else {
            return Ok(false);
        };
        let picture = self.player.drawer.draw(&view, None).map_err(refused)?;
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
    /// packet of a stretch of time and the packets; nothing where there is no sound yet.
    #[wasm_bindgen(js_name = soundPackets)]
    pub fn sound_packets(&self, from: f64, to: f64) -> Array {
        let video = self.player.pack.content.video();
        let sound = video.and_then(|video| video.sound());
        sound.map_or_else(Array::new, |sound| stretch(sound, from, to))
    }
}

impl Show {
    fn video(&self) -> Outcome<&Video> {
        let video = self.player.pack.content.video();
        video
            .map(|video| &**video)
            .ok_or_else(|| refused("a scene has no such parts"))
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
