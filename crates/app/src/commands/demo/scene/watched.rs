//! What does a link bring of a scene, moment by moment?

use crate::commands::demo::scene::content::PreparedScene;
use crate::commands::demo::video::pictures::{Png, narrowed, png};
use crate::commands::score::{
    Companions, DeviceName, Engine, LastGaze, display_of_view, from_image,
};
use crate::commands::simulate::moving::{Mover, Standing};
use crate::commands::simulate::pictures::marks;
use crate::gaze_source::{GazeChoice, ViewerModel};
use crate::report::output::{self, Counting};
use anyhow::Context;
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::gaze::sample::GazeSample;
use foveal_core::perception::parameters::Parameters;
use foveal_core::units::{Radians, Seconds};
use foveal_core::view::axes::Axes;
use foveal_core::view::eye_view::{EyeView, Field};
use foveal_core::view::route::Route;
use foveal_core::view::surface::Projection;
use foveal_eval::disc_error::{FOVEA_DEG, disc, error_over};
use foveal_eval::score::{Mode, Viewing};
use foveal_play::{Made, Player, PlayerOptions};
use foveal_render::{DrawDevice, RgbaImage};

/// Bytes a second of the link: 4 Mbit/s.
pub(crate) const LINK_BYTES: f64 = 5e5;
/// When pictures are taken, in seconds.
pub(crate) const MOMENTS_S: [f64; 4] = [0.5, 1.0, 2.0, 4.0];
/// When the levels are shown.
pub(crate) const LEVELS_S: f64 = 2.0;
/// From this error on, of the luminance within the fovea, what the eye looks at is sharp.
pub(crate) const SHARP: f64 = 0.01;
/// Time from one step to the next, in tenths of a second.
const STEPS_A_SECOND: u32 = 10;
/// Steps without anything new after which nothing more comes.
const QUIET: u32 = 10;
/// Widest picture in the report, in pixels.
const SHOWN_WIDTH: u32 = 800;
/// Width of the picture in which a place to look at is sought, in pixels; the distance between
/// such places, and how many there are to each side; and which share of the fovea is enough.
const GLANCE_WIDTH: u32 = 200;
const GLANCE_DEG: f64 = 2.0;
const GLANCES: i32 = 9;
const FILLED: f64 = 0.95;
/// Bytes that the GPU may hold.
const GPU_BYTES: u64 = 512_000_000;

/// Field of view in which what stands all round would fill 80 % of the height: few scenes fill the
/// sphere around them, so what is watched is a little narrower.
const STANDS_FOR_DEG: f64 = 60.0;

/// How a scene is watched.
pub(crate) struct WatchTerms {
    pub(crate) fov_deg: f64,
    /// Pixels of a view that is not given.
    size: [u32; 2],
    pub(crate) longest_s: f64,
}

pub(crate) const WATCHED: WatchTerms = WatchTerms {
    fov_deg: 52.0,
    size: [1000, 800],
    longest_s: 12.0,
};

/// Both policies over the same link.
pub(crate) struct Runs {
    /// `uniform`, then `perceptual`.
    pub(crate) runs: [SceneRun; 2],
    pub(crate) view: EyeView,
    /// Where the viewer looks, in degrees to the right and up of the middle.
    pub(crate) gaze_deg: [f64; 2],
    /// Triangles of everything that is in view, at its finest; 0 of clouds.
    pub(crate) triangles: u64,
    /// All of it, with a ring round the gaze.
    pub(crate) whole: Png,
}

/// What came under one policy.
pub(crate) struct SceneRun {
    pub(crate) name: &'static str,
    pub(crate) moments: Vec<LinkMoment>,
    /// Times of all steps in seconds, and the error in the fovea at each.
    pub(crate) times: Vec<f64>,
    pub(crate) errors: Vec<f64>,
    /// What was chosen, as docs/formats/session.md has it.
    pub(crate) log: String,
    /// Its levels at [`LEVELS_S`], as colours.
    pub(crate) levels: Option<Png>,
    /// Seconds and bytes until the fovea was sharp; `None` where it never was.
    pub(crate) sharp: Option<(f64, u64)>,
}

/// One of [`MOMENTS_S`].
#[derive(Clone, Default)]
pub(crate) struct LinkMoment {
    pub(crate) t_s: f64,
    pub(crate) bytes: u64,
    pub(crate) triangles: u64,
    pub(crate) units: u32,
    pub(crate) error_fovea: Option<f64>,
    pub(crate) error_all: f64,
    /// Null of equal pictures.
    pub(crate) psnr_db: Option<f64>,
    /// `None` where no display shows the view.
    pub(crate) jod: Option<f64>,
    pub(crate) png: Png,
}

/// Watches a scene under both policies.
pub(crate) fn watch(
    scene: &PreparedScene,
    drawing: &DrawDevice,
    size: Option<[u32; 2]>,
) -> anyhow::Result<Runs> {
    let size = size.unwrap_or(WATCHED.size);
    let ahead = EyeView {
        position: Default::default(),
        axes: Axes::FRONT,
        field: Field::of_larger_side(Radians::from_degrees(STANDS_FOR_DEG), size),
        size,
        eye: Default::default(),
    };
    let mut whole = player(scene, drawing, Policy::Full)?;
    let bounds = scene.file.scene().bounds();
    let stand = |gaze_deg| {
        let (route, gaze) = ((Route::Still, bounds), GazeChoice::At(gaze_deg));
        let mover = Mover::new(route, &gaze, 0, Seconds(0.0), &ViewerModel::default())?;
        let mut standing = mover
            .through(ahead)
            .at(Seconds(0.0), &Parameters::default());
        standing.moment.views[0].field =
            Field::of_larger_side(Radians::from_degrees(WATCHED.fov_deg), size);
        anyhow::Ok(standing)
    };
    let mut standing = stand([0.0, 0.0])?;
    let view = standing.moment.views[0];
    whole.stand(Seconds(0.0), &standing.moment)?;
    let gaze_deg = match scene.content.gaze_deg() {
        Some(known) => known,
        None => gaze_on_it(&mut whole, &narrowed(&view, GLANCE_WIDTH))?,
    };
    standing = stand(gaze_deg)?;
    let reference = whole.picture(&view, false)?.context("nothing draws")?;
    let watched = Watched {
        drawing,
        scene,
        standing,
        view,
        reference,
    };
    Ok(Runs {
        triangles: whole.triangles_drawn(),
        whole: watched.ringed(&mut whole)?,
        runs: [
            watched.run(Policy::Uniform)?,
            watched.run(Policy::Perceptual)?,
        ],
        view,
        gaze_deg,
    })
}

/// The place nearest to the middle at which what stands there fills nearly all of the fovea, or the
/// most of it, in degrees to the right and up: many things have a hole in their middle.
fn gaze_on_it(whole: &mut Player, view: &EyeView) -> anyhow::Result<[f64; 2]> {
    let picture = whole.picture(view, false)?.context("nothing draws")?;
    let background = picture.pixel([0, 0]);
    let filled = |[right, up]: [f64; 2]| {
        let [yaw, pitch] = [right, up].map(Radians::from_degrees);
        let gaze = GazeSample::at(Seconds(0.0), yaw, pitch).gaze_in_content;
        let fovea = disc(view, gaze, Radians::from_degrees(FOVEA_DEG));
        let is_it = |at: &&usize| picture.pixels[4 * **at..4 * **at + 4] != background;
        fovea.iter().filter(is_it).count() as f64 / fovea.len().max(1) as f64
    };
    let steps = || (-GLANCES..=GLANCES).map(|step| f64::from(step) * GLANCE_DEG);
    let mut places: Vec<[f64; 2]> = steps().flat_map(|x| steps().map(move |y| [x, y])).collect();
    places.sort_by(|a, b| a[0].hypot(a[1]).total_cmp(&b[0].hypot(b[1])));
    let mut best = ([0.0, 0.0], 0.0);
    for place in places {
        let share = filled(place);
        if share > best.1 {
            best = (place, share);
        }
        if share >= FILLED {
            break;
        }
    }
    Ok(best.0)
}

fn player(scene: &PreparedScene, drawing: &DrawDevice, policy: Policy) -> anyhow::Result<Player> {
    let unlimited = PlayerOptions::new(PolicyConfig::new(policy), drawing, output::say);
    let options = match policy {
        Policy::Full => unlimited,
        _ => PlayerOptions {
            bytes_per_s: LINK_BYTES,
            gpu_bytes: GPU_BYTES,
            ..unlimited
        },
    };
    Ok(Player::of_scene(&scene.file, options)?)
}

/// A scene before a viewer who stands still, and what all of it looks like.
struct Watched<'a> {
    drawing: &'a DrawDevice,
    scene: &'a PreparedScene,
    standing: Standing,
    view: EyeView,
    reference: RgbaImage,
}

/// How far a picture is from that of all units.
struct Errors {
    fovea: Option<f64>,
    all: f64,
}

impl Watched<'_> {
    /// Watches until nothing more comes that the eye could see, or as long as is watched.
    fn run(&self, policy: Policy) -> anyhow::Result<SceneRun> {
        let name = policy.name();
        let steps = (WATCHED.longest_s * f64::from(STEPS_A_SECOND)) as u32;
        output::say(&format!("{}: comes under {name}", self.scene.content.name));
        let bar = output::bar(Some(u64::from(steps)), Counting::Frames);
        let mut player = player(self.scene, self.drawing, policy)?;
        let mut run = SceneRun {
            name,
            moments: Vec::new(),
            times: Vec::new(),
            errors: Vec::new(),
            sharp: None,
            levels: None,
            log: String::new(),
        };
        let (mut bytes, mut quiet) = (self.scene.file.head_bytes(), 0);
        let mut errors = None;
        for step in 0..=steps {
            let t_s = f64::from(step) / f64::from(STEPS_A_SECOND);
            let report = player.stand(Seconds(t_s), &self.standing.moment)?;
            bytes += report.new_bytes + report.page_bytes;
            quiet = if report.new_bytes > 0 { 0 } else { quiet + 1 };
            let found = match errors.take().filter(|_| quiet > 0) {
                Some(found) => found,
                None => self.errors(&self.picture(&mut player)?),
            };
            run.times.push(t_s);
            run.errors.push(found.fovea.unwrap_or(found.all));
            if run.sharp.is_none() && found.fovea.unwrap_or(found.all) <= SHARP {
                run.sharp = Some((t_s, bytes));
            }
            if MOMENTS_S.contains(&t_s) {
                let moment = self.moment(&mut player, (t_s, bytes), &report)?;
                run.moments.push(LinkMoment {
                    error_fovea: found.fovea,
                    error_all: found.all,
                    ..moment
                });
            }
            if t_s == LEVELS_S {
                run.levels = self.levels(&mut player)?;
            }
            errors = Some(found);
            bar.inc(1);
            if quiet >= QUIET && run.moments.len() == MOMENTS_S.len() {
                break;
            }
        }
        bar.finish_and_clear();
        player.log().clone_into(&mut run.log);
        Ok(run)
    }

    /// What is there, in its place.
    fn picture(&self, player: &mut Player) -> anyhow::Result<RgbaImage> {
        let picture = player.picture_in_place(&self.view)?;
        picture.context("nothing draws")
    }

    /// The same as the report shows it.
    fn shown(&self, player: &mut Player) -> anyhow::Result<RgbaImage> {
        let picture = player.picture_in_place(&narrowed(&self.view, SHOWN_WIDTH))?;
        picture.context("nothing draws")
    }

    /// The levels of what is there.
    fn levels(&self, player: &mut Player) -> anyhow::Result<Option<Png>> {
        let picture = player.picture(&narrowed(&self.view, SHOWN_WIDTH), true)?;
        picture.as_ref().map(png).transpose()
    }

    fn errors(&self, picture: &RgbaImage) -> Errors {
        let gaze = self.standing.gaze.gaze_in_content;
        let fovea = disc(&self.view, gaze, Radians::from_degrees(FOVEA_DEG));
        let (shown, whole) = (&picture.pixels, &self.reference.pixels);
        let pixels = shown.len() / 4;
        Errors {
            fovea: (!fovea.is_empty()).then(|| error_over(fovea.into_iter(), shown, whole)),
            all: error_over(0..pixels, shown, whole),
        }
    }

    /// A picture of what is there, with what the judge says of it.
    fn moment(
        &self,
        player: &mut Player,
        (t_s, bytes): (f64, u64),
        report: &Made,
    ) -> anyhow::Result<LinkMoment> {
        let image = self.picture(player)?;
        let display = display_of_view(&self.view, Projection::Cube);
        let viewing = Viewing::new(display, self.view.size, None, true, Mode::Compat).ok();
        let (mut jod, mut psnr_db) = (None, None);
        if let Some(viewing) = viewing {
            let [whole, shown] = [from_image(&self.reference)?, from_image(&image)?];
            let gaze_px = LastGaze::new(&self.view).in_view(&self.view, &self.standing.gaze);
            let mut engine = Engine::open(DeviceName::Cpu, &viewing, output::jobs(None)?)?;
            engine.frame(&whole, &shown, gaze_px)?;
            let mut companions = Companions::beside(&viewing)?;
            companions.frame(&whole, &shown, gaze_px)?;
            jod = Some(engine.score()?.jod);
            psnr_db = companions.totals().psnr_db;
        }
        Ok(LinkMoment {
            t_s,
            bytes,
            triangles: player.triangles_drawn(),
            units: report.units_by_level.iter().sum(),
            jod,
            psnr_db,
            png: png(&self.shown(player)?)?,
            ..LinkMoment::default()
        })
    }

    /// All of it, with a ring round the gaze.
    fn ringed(&self, whole: &mut Player) -> anyhow::Result<Png> {
        let view = narrowed(&self.view, SHOWN_WIDTH);
        let mut picture = whole.picture(&view, false)?.context("nothing draws")?;
        let ring = marks(&view, &self.standing.gaze);
        draw_ring(&mut picture, ring.gaze, ring.gaze_radius);
        png(&picture)
    }
}

/// Draws a circle in white.
fn draw_ring(image: &mut RgbaImage, [x, y]: [f32; 2], radius: f32) {
    /// Half of how wide the line is, in pixels.
    const HALF: f32 = 1.2;
    for row in 0..image.size[1] {
        for column in 0..image.size[0] {
            let away = (column as f32 + 0.5 - x).hypot(row as f32 + 0.5 - y);
            if (away - radius).abs() <= HALF {
                image.set_pixel([column, row], [255; 4]);
            }
        }
    }
}
