//! What does a scene file say: what stands where, before what, in which light?
//!
//! Normative: docs/formats/scene.md.

mod keys;
mod outline;
#[cfg(test)]
mod tests;

use std::path::Path;

use glam::{DAffine3, DMat3, DVec3};
use serde::Deserialize;
use serde::de::IgnoredAny;

use super::colour::linear_from_encoded;
use super::error::{Fault, ReadError};
use super::files::OnDisk;
use super::place::{self, MOST_PLACES, ReadOptions, Up};
use super::single::{SceneFormat, read_named};
use super::text::shortened;
use crate::source::SourceScene;
use keys::{KEYS, NEXT, PLACE, PLACES, line_of};
use outline::{Outline, PlaceText};

/// Most bytes of a scene file.
const MOST_BYTES: usize = 1 << 24;
/// Most bytes that describe one place.
const MOST_PLACE_BYTES: usize = 1 << 16;
/// Largest number of a place, in metres, and of a scale.
const LARGEST: f64 = 1e9;

/// A scene file, as far as its types and ranges are checked.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Arrangement {
    background: Option<String>,
    light: Option<[f64; 3]>,
    input: Vec<ArrangedInput>,
}

/// A 3D file and where it stands.
#[derive(Debug, Deserialize)]
struct ArrangedInput {
    file: String,
    name: Option<String>,
    up: Option<UpAxis>,
    /// What stands in the outline: nothing of what they say.
    #[serde(default, rename = "place")]
    outlined: Vec<IgnoredAny>,
    #[serde(skip)]
    place: Vec<ArrangedPlace>,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
enum UpAxis {
    Y,
    Z,
}

/// A place by itself, in brackets.
#[derive(Debug, Deserialize)]
struct BracketedPlace {
    place: [ArrangedPlace; 1],
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(default)]
struct ArrangedPlace {
    translation: [f64; 3],
    rotation_deg: [f64; 3],
    scale: Option<PlaceScale>,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(untagged, expecting = "expected a number, or three in brackets")]
enum PlaceScale {
    Even(f64),
    Each([f64; 3]),
}

impl Arrangement {
    /// Reads the text of a scene file.
    pub(super) fn parse(bytes: &[u8]) -> Result<Self, Fault> {
        if bytes.len() > MOST_BYTES {
            let what = format!("it has {} bytes, more than {MOST_BYTES}", bytes.len());
            return Err(Fault::broken("scene file", what, NEXT));
        }
        let text = std::str::from_utf8(bytes).map_err(|error| {
            let place = format!("byte {}", error.valid_up_to());
            Fault::broken(place, "is no text in UTF-8", NEXT)
        })?;
        let outline = Outline::of(text)?;
        let line = |at: usize| line_of(text, outline.whole(at));
        KEYS.check_text(&outline.text, &line)?;
        let said = toml::from_str(&outline.text).map_err(|error| keys::wrong(&error, &line));
        let mut said: Self = said?;
        for place in &outline.places {
            let of = place.input.checked_sub(1);
            if let Some(input) = of.and_then(|it| said.input.get_mut(it)) {
                input.place.push(ArrangedPlace::parse(text, place)?);
            }
        }
        said.check()?;
        Ok(said)
    }

    fn check(&self) -> Result<(), Fault> {
        let wrong = |place: &str, what: String| Err(Fault::broken(place, what, NEXT));
        if let Some(text) = &self.background
            && light_of(text).is_none()
        {
            let text = shortened(text);
            return wrong("background", format!("{text:?} is no colour like #8fb0d0"));
        }
        let is_direction = |light: DVec3| is_sane(light) && light.try_normalize().is_some();
        if let Some(light) = self
            .light
            .filter(|it| !is_direction(DVec3::from_array(*it)))
        {
            return wrong("light", format!("{light:?} is no direction"));
        }
        if self.input.is_empty() {
            return wrong(
                "input",
                "there is none: nothing would stand there".to_owned(),
            );
        }
        for (input, number) in self.input.iter().zip(1..) {
            if input.outlined.len() > input.place.len() {
                return wrong(&format!("input {number}"), "a place is no table".to_owned());
            }
            for (place, at) in input.place.iter().zip(1..) {
                let place = place.world_from_file();
                if !place.is_some_and(|it| it.is_finite()) {
                    let place = format!("input {number}, place {at}");
                    let what = format!("numbers must be at most {LARGEST}, no scale 0");
                    return wrong(&place, what);
                }
            }
        }
        Ok(())
    }

    /// Reads all files that it names, which lie in `folder`.
    fn read(&self, folder: &mut OnDisk, up: Option<Up>) -> Result<SourceScene, Wrong> {
        let mut scene = SourceScene {
            background: self.background.as_deref().and_then(light_of),
            light: self.light.map(DVec3::from_array),
            ..SourceScene::default()
        };
        let mut places = 0;
        for (input, number) in self.input.iter().zip(1..) {
            if SceneFormat::of(Path::new(&input.file)).is_none() {
                let what = format!(
                    "{:?} is not a 3D file that Foveal reads",
                    shortened(&input.file)
                );
                return Err(Fault::broken(format!("input {number}"), what, NEXT).into());
            }
            let named = folder.read_named(&input.file)?;
            let own_up = input.up.map(|it| match it {
                UpAxis::Y => Up::Y,
                UpAxis::Z => Up::Z,
            });
            let mut one = read_named(named, input.name.as_deref(), own_up.or(up))?;
            let all = input
                .place
                .iter()
                .filter_map(ArrangedPlace::world_from_file);
            let all: Vec<DAffine3> = all.collect();
            for own in one.placements_mut().filter(|_| !all.is_empty()) {
                places += own.len().saturating_mul(all.len());
                if places > MOST_PLACES {
                    let what = format!("objects stand in more than {MOST_PLACES} places");
                    return Err(Fault::broken(format!("input {number}"), what, NEXT).into());
                }
                let placed = all.iter().flat_map(|all| own.iter().map(|own| *all * *own));
                *own = placed.collect();
            }
            scene.append(one);
        }
        place::check(&scene)?;
        Ok(scene)
    }
}

impl ArrangedPlace {
    /// Reads what a text says of one place.
    fn parse(text: &str, place: &PlaceText) -> Result<Self, Fault> {
        /// What makes brackets with one place a text of their own.
        const BEFORE: &str = "place = [";
        let own = text.get(place.bytes.clone()).unwrap_or_default();
        if own.len() > MOST_PLACE_BYTES {
            let what = format!("a place takes more than {MOST_PLACE_BYTES} bytes");
            return Err(Fault::broken(line_of(text, place.bytes.start), what, NEXT));
        }
        let before = if place.is_inline { BEFORE.len() } else { 0 };
        let line = |at: usize| line_of(text, place.bytes.start + at.saturating_sub(before));
        let told = |error| keys::wrong(&error, &line);
        if !place.is_inline {
            PLACE.check_text(own, &line)?;
            return toml::from_str(own).map_err(told);
        }
        let own = format!("{BEFORE}{own}]");
        PLACES.check_text(&own, &line)?;
        let said: BracketedPlace = toml::from_str(&own).map_err(told)?;
        Ok(said.place[0])
    }

    /// Scaled, turned about x, then y, then z, and moved; `None` where a number is out of range.
    fn world_from_file(&self) -> Option<DAffine3> {
        let scale = DVec3::from_array(match self.scale {
            None => [1.0; 3],
            Some(PlaceScale::Even(scale)) => [scale; 3],
            Some(PlaceScale::Each(scale)) => scale,
        });
        let turn = DVec3::from_array(self.rotation_deg);
        let translation = DVec3::from_array(self.translation);
        let is_none = scale.abs().min_element() < LARGEST.recip();
        if is_none || ![scale, turn, translation].into_iter().all(is_sane) {
            return None;
        }
        let [x, y, z] = turn.to_array().map(f64::to_radians);
        let turned = DMat3::from_rotation_z(z) * DMat3::from_rotation_y(y);
        let turned = turned * DMat3::from_rotation_x(x) * DMat3::from_diagonal(scale);
        Some(DAffine3::from_mat3_translation(turned, translation))
    }
}

fn is_sane(numbers: DVec3) -> bool {
    numbers.is_finite() && numbers.abs().max_element() <= LARGEST
}

/// The linear light of a colour that is written as `#rrggbb`.
fn light_of(text: &str) -> Option<[f32; 3]> {
    let digits = text.strip_prefix('#')?;
    let is_plain = digits.len() == 6 && digits.bytes().all(|it| it.is_ascii_hexdigit());
    let code = u32::from_str_radix(digits, 16).ok().filter(|_| is_plain)?;
    let [_, r, g, b] = code.to_be_bytes();
    Some([r, g, b].map(|it| linear_from_encoded(f64::from(it) / 255.0)))
}

/// What is wrong with a scene file, or with a file that it names.
enum Wrong {
    Here(Fault),
    There(ReadError),
}

impl From<Fault> for Wrong {
    fn from(fault: Fault) -> Self {
        Self::Here(fault)
    }
}

impl From<ReadError> for Wrong {
    fn from(error: ReadError) -> Self {
        Self::There(error)
    }
}

/// Reads a scene file and all files that it names; `options` are of those of which it does not say
/// it.
pub(super) fn read(path: &Path, options: &ReadOptions) -> Result<SourceScene, ReadError> {
    let up = options.up;
    let mut folder = OnDisk::of(path, options.allow_outside);
    let bytes = folder.read_scene()?;
    let said = Arrangement::parse(&bytes).map_err(|fault| fault.in_file(path))?;
    let mut scene = said.read(&mut folder, up).map_err(|wrong| match wrong {
        Wrong::Here(fault) => fault.in_file(path),
        Wrong::There(error) => error,
    })?;
    scene.bytes += folder.bytes;
    scene.hashes.splice(0..0, folder.hashes);
    Ok(scene)
}
