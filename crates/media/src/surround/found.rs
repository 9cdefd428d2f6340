//! How does the input surround the eyes?
//!
//! By what the caller says, else by metadata, else by name and size; whatever is assumed is said.

use crate::prepare::error::PrepareError;
use crate::prepare::remarks::Remarks;
use crate::prepare::settings::{PrepareSettings, ProjectionChoice, StereoChoice};
use crate::read::source::SourceInfo;
use crate::sphere::Coverage;
use crate::surround::cube_layout::CubeLayout;
use crate::surround::eye_layout::{EyeLayout, Packing};
use crate::surround::name_words::NameWords;
use crate::surround::photo_sphere::{PhotoSphere, Placed};
use crate::surround::sphere_part::SpherePart;
use crate::surround::spherical::{Spherical, SphericalProjection, StereoLayout};
use crate::surround::spherical_boxes::BrokenBox;
use std::path::Path;

/// How each eye's picture is turned into faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Surround {
    /// It is the one face.
    Flat,
    /// It is resampled to a cube.
    Equirect(Coverage),
    /// It is cut into faces.
    Cube(CubeLayout),
}

/// What was found, for an input of one size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SurroundOfEyes {
    pub(crate) surround: Surround,
    pub(crate) eyes: EyeLayout,
    /// Pixels of one eye's picture, of the whole where it is a part.
    pub(crate) eye_size: [u32; 2],
    /// Where the picture lies on the whole sphere, if it is a part or turned.
    pub(crate) part: Option<SpherePart>,
    /// Yaw of the picture's middle, in degrees to the right of forward.
    pub(crate) front_deg: f64,
    /// Width and height of a pixel to each other, where a flat picture was squeezed.
    pub(crate) pixel_aspect: [u32; 2],
}

/// The one picture of both eyes, twice as wide as high, counts as a sphere from this width on when
/// nothing else decides; so do two eyes that share one of that shape and width, one above the
/// other.
const SPHERE_WIDTH: u32 = 3840;
/// Six square faces in a row count as a cube from this face size on when nothing else decides.
const CUBE_FACE: u32 = 256;
/// A flat eye narrower than this, width over height, was squeezed to half its width.
const NARROWEST: f64 = 1.2;
/// A flat eye wider than this was squeezed to half its height.
const WIDEST: f64 = 2.8;

/// A sphere this many times as wide or as high as its angles is reported as stretched.
const STRETCHED: f64 = 1.02;

/// Finds how `input` surrounds the eyes, and says what was assumed; refuses what does not fit.
pub(crate) fn surround_of(
    input: &Path,
    info: &SourceInfo,
    settings: &PrepareSettings,
    remarks: &mut Remarks,
) -> Result<SurroundOfEyes, PrepareError> {
    let wrong = |why: String| PrepareError::Option(format!("{}: {why}", input.display()));
    let words = NameWords::of(input);
    let frame = [info.width, info.height];
    let is_auto = settings.projection == ProjectionChoice::Auto;
    if let Some(camera) = info.camera.filter(|it| is_auto && it.is_certain()) {
        return Err(wrong(camera.words(false)));
    }
    let eyes = eyes_of(info, settings, &words, remarks).map_err(wrong)?;
    let eye_size = eyes.eye_size(frame).map_err(wrong)?;
    let pixel = info
        .pixel_aspect
        .map_or([1, 1], |it| it.map(|side| side.max(1) as u32));
    let found = Found {
        info,
        words: &words,
        eye_size,
        shape: [0, 1].map(|k| u64::from(eye_size[k]) * u64::from(pixel[k])),
        two_eyes: eyes.eyes() > 1,
    };
    let surround = match settings.projection {
        ProjectionChoice::Flat => Surround::Flat,
        ProjectionChoice::Equirect => Surround::Equirect(Coverage::Full),
        ProjectionChoice::HalfEquirect => Surround::Equirect(Coverage::FrontHalf),
        ProjectionChoice::Cube => Surround::Cube(found.cube(remarks).map_err(wrong)?),
        ProjectionChoice::Auto => found.surround(remarks).map_err(wrong)?,
    };
    let part = match found.bounds(settings, remarks).map_err(wrong)? {
        Some(part) => Some(part),
        None => {
            let placed = found.placed(settings, remarks).map_err(wrong)?;
            placed.map(|placed| placed.part)
        }
    };
    let front_deg = part.map_or(0.0, |part| part.middle_deg(eye_size[0]));
    let shown_size = eye_size;
    let eye_size = part.map_or(eye_size, |part| part.whole);
    warn_of_metadata(info, remarks);
    let shape = [0, 1].map(|k| f64::from(eye_size[k]) * f64::from(pixel[k]));
    if eyes.eyes() == 1 && part.is_none() {
        remarks
            .warnings
            .extend(stretch_of(surround, eye_size, shape));
    }
    let mut pixel_aspect = [1, 1];
    if surround == Surround::Flat && info.pixel_aspect.is_some() {
        pixel_aspect = pixel;
        remarks.note(format!(
            "its pixels are {}:{}, and shown so",
            pixel[0], pixel[1]
        ));
    } else if eyes.eyes() > 1 {
        pixel_aspect = squeeze_of(surround, eye_size, remarks);
    }
    Ok(SurroundOfEyes {
        surround,
        eyes,
        eye_size,
        part: part.filter(|part| !part.is_whole(shown_size)),
        front_deg,
        pixel_aspect,
    })
}

/// What its metadata say and what is not done by them.
fn warn_of_metadata(info: &SourceInfo, remarks: &mut Remarks) {
    remarks.warnings.extend(info.tags.broken.iter().cloned());
    remarks.notes.extend(info.tags.notes.iter().cloned());
    for BrokenBox { name, at, what, .. } in &info.broken_boxes {
        remarks.warn(format!(
            "its {name} box, at byte {at}, {what}, and is passed over; give --projection or \
             --stereo if the guess is wrong"
        ));
    }
    if let Some(turn) = info.spherical.as_ref().and_then(turn_of) {
        remarks.warn(format!(
            "the turn of the sphere in its metadata ({turn}) is not applied"
        ));
    }
}

/// Yaw, pitch and roll in words; `None` where the sphere is not turned.
fn turn_of(spherical: &Spherical) -> Option<String> {
    let turn = [spherical.yaw_deg, spherical.pitch_deg, spherical.roll_deg];
    let [yaw, pitch, roll] = turn;
    (turn != [0.0; 3]).then(|| format!("yaw {yaw:.1}°, pitch {pitch:.1}°, roll {roll:.1}°"))
}

/// Where the eyes lie: as the caller says, else by metadata, else by name.
fn eyes_of(
    info: &SourceInfo,
    settings: &PrepareSettings,
    words: &NameWords,
    remarks: &mut Remarks,
) -> Result<EyeLayout, String> {
    let told = info.stereo.map(|stereo| {
        let packing = match stereo.layout {
            StereoLayout::SideBySide => Some(Packing::SideBySide),
            StereoLayout::TopBottom => Some(Packing::TopBottom),
            StereoLayout::Other => None,
        };
        (packing, stereo.right_first)
    });
    let asked = |packing| EyeLayout {
        packing,
        right_first: told == Some((Some(packing), true)),
    };
    match (settings.stereo, told) {
        (StereoChoice::Mono, _) => Ok(EyeLayout::default()),
        (StereoChoice::SideBySide, _) => Ok(asked(Packing::SideBySide)),
        (StereoChoice::TopBottom, _) => Ok(asked(Packing::TopBottom)),
        (StereoChoice::Auto, Some((Some(packing), right_first))) => {
            let eyes = EyeLayout {
                packing,
                right_first,
            };
            remarks.note(format!("two eyes, {}, by its metadata", words_of(eyes)));
            Ok(eyes)
        }
        (StereoChoice::Auto, Some((None, _))) => Err(
            "holds two eyes in one picture or in turns, which cannot be prepared; bring them side \
             by side with `ffmpeg -i FILE -vf stereo3d=..:sbsl OUT`, or give --stereo mono"
                .to_owned(),
        ),
        (StereoChoice::Auto, None) => Ok(eyes_by_name(info, settings, words, remarks)),
    }
}

fn eyes_by_name(
    info: &SourceInfo,
    settings: &PrepareSettings,
    words: &NameWords,
    remarks: &mut Remarks,
) -> EyeLayout {
    let may_be_half = matches!(
        settings.projection,
        ProjectionChoice::Auto | ProjectionChoice::HalfEquirect
    );
    let mut why = "by its name";
    let mut named = words.eyes();
    if named.is_none() && may_be_half && words.names_half() && info.width == 2 * info.height {
        why = "by its name and 2:1 size, as 180° pictures of both eyes lie";
        named = Some(EyeLayout {
            packing: Packing::SideBySide,
            right_first: false,
        });
    }
    let Some(eyes) = named else {
        return EyeLayout::default();
    };
    let words = words_of(eyes);
    remarks.note(format!(
        "treated as two eyes, {words}, {why}; give --stereo mono if it is not"
    ));
    eyes
}

fn words_of(eyes: EyeLayout) -> &'static str {
    match (eyes.packing, eyes.right_first) {
        (Packing::Mono, _) => "one picture",
        (Packing::SideBySide, false) => "side by side",
        (Packing::SideBySide, true) => "side by side, the right eye first",
        (Packing::TopBottom, false) => "one above the other",
        (Packing::TopBottom, true) => "one above the other, the right eye first",
    }
}

/// What is known where projection is looked for.
struct Found<'a> {
    info: &'a SourceInfo,
    words: &'a NameWords,
    eye_size: [u32; 2],
    /// Width and height of one eye's picture as it is to be shown, to each other.
    shape: [u64; 2],
    two_eyes: bool,
}

impl Found<'_> {
    fn cube(&self, remarks: &mut Remarks) -> Result<CubeLayout, String> {
        let layout = match self.info.spherical.map(|spherical| spherical.projection) {
            Some(SphericalProjection::Cube { padding }) => {
                CubeLayout::of_metadata(self.eye_size, padding)?
            }
            _ => CubeLayout::of_size(self.eye_size)?,
        };
        remarks.note(format!("a cube of {}", layout.words()));
        Ok(layout)
    }

    fn surround(&self, remarks: &mut Remarks) -> Result<Surround, String> {
        match (self.info.spherical, self.photo_sphere()) {
            (Some(spherical), _) => self.by_metadata(&spherical, remarks),
            (None, Some(sphere)) => Ok(by_photo_sphere(sphere, remarks)),
            (None, None) => self.by_name_and_size(remarks),
        }
    }

    /// What the file says of a photo sphere; it speaks of one picture, so nothing of two eyes.
    fn photo_sphere(&self) -> Option<&PhotoSphere> {
        let said = self.info.tags.photo_sphere.as_ref();
        said.filter(|_| !self.two_eyes)
    }

    /// How the picture lies on the sphere by the metadata of a photo sphere, where these count.
    fn placed(
        &self,
        settings: &PrepareSettings,
        remarks: &mut Remarks,
    ) -> Result<Option<Placed>, String> {
        let is_asked = settings.projection == ProjectionChoice::Auto;
        let sphere = self.photo_sphere().filter(|_| is_asked);
        let Some(sphere) = sphere.filter(|sphere| sphere.flat_because().is_none()) else {
            return Ok(None);
        };
        let placed = sphere.placed(self.eye_size).map_err(|why| {
            format!(
                "its photo sphere metadata (GPano) cannot be meant: {why}; mend them, or give \
                 --projection: equirect if it is the whole sphere, flat if it is none"
            )
        })?;
        let [pitch, roll] = placed.tilt_deg;
        if placed.tilt_deg != [0.0; 2] {
            remarks.warn(format!(
                "the tilt in its metadata (pitch {pitch:.1}°, roll {roll:.1}°) is not applied"
            ));
        }
        if let Some(heading) = placed.heading_deg {
            remarks.note(format!(
                "forward is north; the middle of its sphere lies at {heading:.1}° by its metadata"
            ));
        }
        let whole = placed.part.whole;
        if whole != self.eye_size {
            remarks.note(self.covered(whole));
        }
        Ok(Some(placed))
    }

    /// Where the bounds of spherical metadata put the picture, where these count.
    fn bounds(
        &self,
        settings: &PrepareSettings,
        remarks: &mut Remarks,
    ) -> Result<Option<SpherePart>, String> {
        let is_asked = settings.projection == ProjectionChoice::Auto;
        let Some(spherical) = self.info.spherical.filter(|it| is_asked && !it.is_half()) else {
            return Ok(None);
        };
        let SphericalProjection::EquirectPart { cut } = spherical.projection else {
            return Ok(None);
        };
        let part = SpherePart::within(self.eye_size, cut).map_err(|why| {
            format!(
                "the bounds in its spherical metadata (sv3d) cannot be meant: {why}; mend them, \
                 or give --projection: equirect if it is the whole sphere, flat if it is none"
            )
        })?;
        remarks.note(self.covered(part.whole));
        Ok(Some(part))
    }

    /// How much of the sphere the picture covers, in words.
    fn covered(&self, whole: [u32; 2]) -> String {
        let share = |k: usize| f64::from(self.eye_size[k]) / f64::from(whole[k]);
        format!(
            "it covers {:.0}° x {:.0}° of the sphere, whose whole is {}x{} pixels; the rest is \
             black",
            share(0) * 360.0,
            share(1) * 180.0,
            whole[0],
            whole[1]
        )
    }

    fn by_metadata(
        &self,
        spherical: &Spherical,
        remarks: &mut Remarks,
    ) -> Result<Surround, String> {
        match spherical.projection {
            SphericalProjection::Equirect => {
                remarks.note("360° by its spherical metadata".to_owned());
                Ok(Surround::Equirect(Coverage::Full))
            }
            SphericalProjection::EquirectPart { .. } if spherical.is_half() => {
                remarks.note("180° by its spherical metadata".to_owned());
                Ok(Surround::Equirect(Coverage::FrontHalf))
            }
            SphericalProjection::Cube { .. } => Ok(Surround::Cube(self.cube(remarks)?)),
            SphericalProjection::EquirectPart { .. } => {
                remarks.note("a part of a sphere by its spherical metadata".to_owned());
                Ok(Surround::Equirect(Coverage::Full))
            }
        }
    }

    fn by_name_and_size(&self, remarks: &mut Remarks) -> Result<Surround, String> {
        if let Some(camera) = self.info.camera {
            return Err(camera.words(self.two_eyes));
        }
        let h = self.eye_size[1];
        let is = |columns: u64, rows: u64| self.shape[0] * rows == self.shape[1] * columns;
        let mut taken = |what: &str, named: bool| {
            let shape = shape_of(self.shape);
            let why = match (named, self.two_eyes) {
                (true, true) => format!("its name and each eye's {shape} size"),
                (true, false) => format!("its name and {shape} size"),
                (false, true) => format!("each eye's {shape} size"),
                (false, false) => format!("its {shape} size"),
            };
            remarks.note(format!(
                "treated as {what}, judging by {why}; give --projection flat if it is not"
            ));
        };
        if self.words.names_equiangular() {
            return Err(
                "is an equi-angular cube by its name, which cannot be prepared; make it a plain \
                 one with `ffmpeg -i FILE -vf v360=eac:c3x2 OUT` and give --projection cube"
                    .to_owned(),
            );
        }
        if self.words.names_half() && is(1, 1) {
            taken("180°", true);
            return Ok(Surround::Equirect(Coverage::FrontHalf));
        }
        let named = self.words.names_sphere();
        if self.is_sphere(named) {
            taken("360°", named);
            return Ok(Surround::Equirect(Coverage::Full));
        }
        let named = self.words.names_cube();
        if named && CubeLayout::of_size(self.eye_size).is_ok() || is(6, 1) && h >= CUBE_FACE {
            taken("a cube", named);
            return Ok(Surround::Cube(self.cube(remarks)?));
        }
        self.say_flat(remarks);
        Ok(Surround::Flat)
    }

    /// Says that a picture counts as flat, and what to do if it is not.
    fn say_flat(&self, remarks: &mut Remarks) {
        let w = self.eye_size[0];
        let is = |columns: u64, rows: u64| self.shape[0] * rows == self.shape[1] * columns;
        if is(2, 1) && self.words.may_name_sphere() {
            remarks.warn(
                "treated as flat, although its size is 2:1 and 360 is a part of its name; give \
                 --projection equirect if it is 360°, or flat"
                    .to_owned(),
            );
            return;
        }
        let hint = match () {
            () if self.words.names_sphere() => {
                ": its name says 360°, whose size is 2:1 an eye; give --projection equirect if it \
                 is 360° all the same"
            }
            () if is(2, 1) => "; give --projection equirect if it is 360°",
            () if is(1, 1) && self.two_eyes => {
                "; give --projection half-equirect if it is 180°, equirect if it is 360°"
            }
            () if is(4, 1) && self.two_eyes => "; give --projection equirect if it is 360°",
            () if is(4, 1) => "; give --projection cube if it is four faces round the horizon",
            () if is(3, 2) && w >= SPHERE_WIDTH => "; give --projection cube if it is six faces",
            () => "",
        };
        remarks.note(format!("treated as flat, judging by its size{hint}"));
    }

    /// Whether an eye's picture has the shape of a whole sphere, and something else speaks for one:
    /// the name, a second eye, or its width. `foveal prepare video --help` gives this rule.
    fn is_sphere(&self, named: bool) -> bool {
        let [w, h] = self.shape;
        let is_wide = self.eye_size[0] >= SPHERE_WIDTH;
        match self.two_eyes {
            _ if w == 2 * h => named || self.two_eyes || is_wide,
            // Squeezed to half the height, or to half the width.
            true if w == 4 * h => named || is_wide,
            true if w == h => named,
            _ => false,
        }
    }
}

fn by_photo_sphere(sphere: &PhotoSphere, remarks: &mut Remarks) -> Surround {
    match sphere.flat_because() {
        None => {
            remarks.note("360° by its photo sphere metadata (GPano)".to_owned());
            Surround::Equirect(Coverage::Full)
        }
        Some(why) => {
            remarks.note(format!(
                "treated as flat, judging by its photo sphere metadata (GPano), where {why}; give \
                 --projection equirect if it is 360°"
            ));
            Surround::Flat
        }
    }
}

/// Width to height in the smallest whole numbers.
fn shape_of([w, h]: [u64; 2]) -> String {
    let (mut a, mut b) = (w.max(1), h);
    while b > 0 {
        (a, b) = (b, a % b);
    }
    format!("{}:{}", w / a, h / a)
}

/// A sphere of another shape than its angles, which is taken as it was asked for.
fn stretch_of(surround: Surround, [w, h]: [u32; 2], shape: [f64; 2]) -> Option<String> {
    let (name, columns) = match surround {
        Surround::Equirect(Coverage::Full) => ("the whole sphere", 2.0),
        Surround::Equirect(Coverage::FrontHalf) => ("half a sphere", 1.0),
        _ => return None,
    };
    let shape = shape[0] / shape[1].max(1.0);
    ((shape / columns).ln().abs() > STRETCHED.ln()).then(|| {
        format!(
            "its {w}x{h} pixels are stretched over {name}, whose shape is {columns}:1; pad it \
             with FFmpeg's filter pad if it shows less"
        )
    })
}

/// The shape of the pixels of one eye of two: a flat picture of an unlikely shape was squeezed to
/// share its frame. Spheres are resampled whatever their shape.
fn squeeze_of(surround: Surround, [w, h]: [u32; 2], remarks: &mut Remarks) -> [u32; 2] {
    let shape = f64::from(w) / f64::from(h.max(1));
    let said = match surround {
        Surround::Flat if shape < NARROWEST => ([2, 1], "width"),
        Surround::Flat if shape > WIDEST => ([1, 2], "height"),
        Surround::Equirect(Coverage::Full) if shape < 1.5 => ([1, 1], "width"),
        Surround::Equirect(Coverage::Full) if shape > 3.0 => ([1, 1], "height"),
        _ => return [1, 1],
    };
    remarks.note(format!(
        "each eye's {w}x{h} pixels are treated as half the {}",
        said.1
    ));
    said.0
}
