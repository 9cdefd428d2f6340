//! Is a file what a 360° camera stored, before anything was made of it?

use std::path::Path;

use av::format::context::Input;
use av::media::Type;
use ffmpeg_next as av;
use foveal_core::view::picture::Picture;

use crate::plain_file::last_bytes;

/// The raw file of a camera, which shows something only once its pictures are joined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Camera {
    /// GoPro's `.360`: two video tracks of three faces of an equi-angular cube each.
    GoPro,
    /// Insta360's `.insp`: a picture of two fisheyes.
    InstaPicture,
    /// Insta360's `.insv`: two fisheyes in one picture, in two tracks, or in two files.
    InstaFilm(Fisheyes),
    /// Two fisheyes side by side, by their look: film, or a picture.
    TwoFisheyes {
        /// Whether it is one picture.
        is_still: bool,
    },
}

/// Where the pictures of two lenses lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fisheyes {
    /// Side by side in a picture.
    OnePicture,
    /// In two video tracks.
    TwoTracks,
    /// In this file and another one.
    TwoFiles,
}

/// The last bytes of everything that Insta360's cameras store.
const INSTA_TRAILER: &[u8] = b"8db42d694ccc418790edff439fe026bf";
/// Luma above that of black that still counts as black.
const DARK: u8 = 20;
/// Luma above that of black which is more than noise.
const LIT: u8 = 36;

impl Camera {
    /// The camera that stored a file, by its name and by what it holds.
    pub(crate) fn of(path: &Path, input: &Input, size: [u32; 2], is_still: bool) -> Option<Self> {
        let ending = path.extension().and_then(|it| it.to_str());
        let ending = ending.unwrap_or_default().to_lowercase();
        let kinds = input.streams().map(|it| it.parameters().medium());
        let tracks = kinds.filter(|kind| *kind == Type::Video).count();
        let fisheyes = match size {
            _ if tracks > 1 => Fisheyes::TwoTracks,
            [w, h] if w >= h / 2 * 3 => Fisheyes::OnePicture,
            _ => Fisheyes::TwoFiles,
        };
        match ending.as_str() {
            "360" => return Some(Self::GoPro),
            "insp" => return Some(Self::InstaPicture),
            "insv" => return Some(Self::InstaFilm(fisheyes)),
            _ => {}
        }
        if tracks > 1 && size[0] > 5 * size[1] / 2 && is_of_gopro(input) {
            return Some(Self::GoPro);
        }
        // Cameras with one lens end their files in the same way.
        let is_double = tracks > 1 && size[0] == size[1] || size[0] == 2 * size[1];
        let length = INSTA_TRAILER.len() as u64;
        let is_insta = is_double && last_bytes(path, length).is_ok_and(|it| it == INSTA_TRAILER);
        let stored = match is_still {
            true => Self::InstaPicture,
            false => Self::InstaFilm(fisheyes),
        };
        is_insta.then_some(stored)
    }

    /// Whether its name or its tracks leave no doubt, whatever other metadata say.
    pub(crate) fn is_certain(self) -> bool {
        !matches!(self, Self::TwoFisheyes { .. })
    }

    /// What it is, and how something is made of it that can be prepared: the rest of a sentence
    /// that begins with the file, whose two halves may be for an eye each.
    #[must_use]
    pub fn words(self, two_eyes: bool) -> String {
        const JOINED: &str = "v360=dfisheye:e:ih_fov=200:iv_fov=200";
        let two = |what: &str, command: &str| {
            format!(
                "{what}, which must be joined to a sphere first: `{command}` does, or the \
                 camera's own program without seams; give --projection flat to see it as it is"
            )
        };
        match self {
            Self::GoPro => two(
                "is a raw file of a GoPro camera, two tracks of an equi-angular cube",
                "ffmpeg -i FILE -filter_complex \"[0:v:0][0:v:1]vstack,v360=eac:e\" OUT_360.mp4",
            ),
            Self::InstaPicture => two(
                "is a raw picture of an Insta360 camera, two fisheyes",
                &format!("ffmpeg -i FILE -vf {JOINED} OUT_360.png"),
            ),
            Self::InstaFilm(fisheyes) => {
                let command = match fisheyes {
                    Fisheyes::OnePicture => format!("ffmpeg -i FILE -vf {JOINED} OUT_360.mp4"),
                    Fisheyes::TwoTracks => format!(
                        "ffmpeg -i FILE -filter_complex \"[0:v:0][0:v:1]hstack,{JOINED}\" \
                         OUT_360.mp4"
                    ),
                    Fisheyes::TwoFiles => format!(
                        "ffmpeg -i VID_.._00_...insv -i VID_.._10_...insv -filter_complex \
                         \"[0:v][1:v]hstack,{JOINED}\" OUT_360.mp4"
                    ),
                };
                two(
                    "is a raw film of an Insta360 camera, of two fisheyes",
                    &command,
                )
            }
            Self::TwoFisheyes { is_still } => {
                let ending = if is_still { "png" } else { "mp4" };
                if two_eyes {
                    return two(
                        "shows a fisheye for each eye",
                        &format!(
                            "ffmpeg -i FILE -vf v360=fisheye:hequirect:in_stereo=sbs:\
                             out_stereo=sbs:ih_fov=190:iv_fov=190 OUT_180_LR.{ending}"
                        ),
                    );
                }
                two(
                    "shows two fisheyes side by side, as 360° cameras store them",
                    &format!("ffmpeg -i FILE -vf {JOINED} OUT_360.{ending}"),
                )
            }
        }
    }
}

/// Whether a track names GoPro as what made it.
fn is_of_gopro(input: &Input) -> bool {
    input.streams().any(|stream| {
        let handler = stream.metadata().get("handler_name").map(str::to_owned);
        handler.is_some_and(|name| name.contains("GoPro"))
    })
}

/// Whether a picture has the shape of two fisheyes side by side.
pub(crate) fn may_be_two_fisheyes([w, h]: [u32; 2]) -> bool {
    let [w, h] = [w, h].map(u64::from);
    w >= 256 && w <= 2 * h && 9 * w >= 15 * h
}

/// Whether a picture, of code value `black` where it is black, shows two bright discs side by
/// side that touch its borders, with black round them.
pub(crate) fn shows_two_fisheyes(picture: &Picture, black: u8) -> bool {
    let size = [picture.width, picture.height].map(f64::from);
    let radius = size[0] / 4.0;
    let luma = |x: f64, y: f64| {
        let [x, y] = [x.clamp(0.0, size[0] - 1.0), y.clamp(0.0, size[1] - 1.0)];
        let at = y as usize * picture.width as usize + x as usize;
        picture.planes[0][at].saturating_sub(black)
    };
    let ring = |centre: f64, share: f64| {
        let around = (0..72).map(move |step| f64::from(step) * core::f64::consts::TAU / 72.0);
        around.map(move |angle| {
            let reach = radius * share;
            [
                centre + reach * libm::cos(angle),
                size[1] / 2.0 + reach * libm::sin(angle),
            ]
        })
    };
    let centres = [radius, 3.0 * radius];
    let is_lit = centres.iter().all(|centre| {
        let places = [0.5, 0.75, 0.92]
            .into_iter()
            .flat_map(|share| ring(*centre, share));
        let lit = places.filter(|[x, y]| luma(*x, *y) > LIT).count();
        lit > 3 * 72 * 7 / 10
    });
    if !is_lit {
        return false;
    }
    let [columns, rows] = [96, 48];
    let grid = (0..columns * rows).map(|at| [at % columns, at / columns]);
    let places = grid.map(|[x, y]| {
        let place = |at: i32, of: i32, side: f64| (f64::from(at) + 0.5) / f64::from(of) * side;
        [place(x, columns, size[0]), place(y, rows, size[1])]
    });
    let outside = places.filter(|[x, y]| {
        let far = |centre: &f64| libm::hypot(x - centre, y - size[1] / 2.0) > 1.06 * radius;
        centres.iter().all(far)
    });
    let (mut all, mut dark) = (0, 0);
    for [x, y] in outside {
        all += 1;
        dark += u32::from(luma(x, y) <= DARK);
    }
    all > 0 && f64::from(dark) >= 0.97 * f64::from(all)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::GeneratedScene;

    /// Two discs over black.
    fn discs(size: [u32; 2], radius: f64) -> Picture {
        let mut picture = GeneratedScene::wide(size).frame(0);
        for (at, luma) in picture.planes[0].iter_mut().enumerate() {
            let [x, y] = [at as u32 % size[0], at as u32 / size[0]].map(f64::from);
            let near = [1.0, 3.0].iter().any(|quarter| {
                let across = x - quarter * f64::from(size[0]) / 4.0;
                libm::hypot(across, y - f64::from(size[1]) / 2.0) < radius
            });
            *luma = if near { (*luma).max(70) } else { 17 };
        }
        picture
    }

    #[test]
    fn two_discs_over_black_are_two_fisheyes_and_other_pictures_are_none() {
        for size in [[512, 256], [640, 360]] {
            let radius = f64::from(size[0]) / 4.0;
            for share in [1.0, 0.97, 1.03] {
                let two = discs(size, radius * share);
                assert!(shows_two_fisheyes(&two, 16), "{size:?} {share}");
            }
            assert!(!shows_two_fisheyes(
                &GeneratedScene::wide(size).frame(3),
                16
            ));
            assert!(!shows_two_fisheyes(
                &GeneratedScene::panorama(size).frame(3),
                16
            ));
            assert!(!shows_two_fisheyes(
                &Picture::filled(size[0], size[1], [16; 3]),
                16
            ));
            // A dark night with a lit horizon.
            let mut night = GeneratedScene::panorama(size).frame(1);
            for (at, luma) in night.planes[0].iter_mut().enumerate() {
                let row = at as u32 / size[0];
                if row < size[1] / 4 || row > size[1] * 3 / 4 {
                    *luma = 16;
                }
            }
            assert!(!shows_two_fisheyes(&night, 16));
        }
        assert!(may_be_two_fisheyes([3840, 1920]) && may_be_two_fisheyes([1920, 1080]));
        assert!(!may_be_two_fisheyes([1920, 1920]) && !may_be_two_fisheyes([1000, 400]));
    }
}
