//! What does a file's name say about its pictures?

use crate::surround::eye_layout::{EyeLayout, Packing};
use std::path::Path;

/// Words that say that something is a whole sphere; numbers may follow.
const SPHERES: [&str; 12] = [
    "equirect",
    "equirectangular",
    "erp",
    "latlong",
    "pano",
    "panos",
    "panoramas",
    "panoramic",
    "photosphere",
    "sphere",
    "spheres",
    "spherical",
];

/// The words of a name: runs of letters and digits, in small letters.
pub(super) struct NameWords {
    name: String,
    words: Vec<String>,
}

impl NameWords {
    /// The words of the last part of a path.
    pub(super) fn of(path: &Path) -> Self {
        let name = path.file_name().unwrap_or_default();
        let name = name.to_string_lossy().to_lowercase();
        let words = name.split(|c: char| !c.is_alphanumeric());
        Self {
            words: words.map(str::to_owned).collect(),
            name,
        }
    }

    fn has(&self, any: &[&str]) -> bool {
        self.words.iter().any(|word| any.contains(&word.as_str()))
    }

    /// The layout of two eyes, where one is named.
    pub(super) fn eyes(&self) -> Option<EyeLayout> {
        let named: [(Packing, bool, &[&str]); 4] = [
            (
                Packing::SideBySide,
                false,
                &["lr", "sbs", "hsbs", "fsbs", "3dh"],
            ),
            (Packing::SideBySide, true, &["rl"]),
            (
                Packing::TopBottom,
                false,
                &["tb", "ou", "htb", "hou", "3dv"],
            ),
            (Packing::TopBottom, true, &["bt"]),
        ];
        let found = named.into_iter().find(|(.., words)| self.has(words));
        found.map(|(packing, right_first, _)| EyeLayout {
            packing,
            right_first,
        })
    }

    /// Whether the name says that it is the front half of a sphere.
    pub(super) fn names_half(&self) -> bool {
        self.has(&["180", "vr180", "180vr", "180x180", "3d180"])
    }

    /// Whether the name says that it is a whole sphere.
    pub(super) fn names_sphere(&self) -> bool {
        let is = |word: &String| {
            let word = word.trim_end_matches(|c: char| c.is_ascii_digit());
            SPHERES.contains(&word) || word.ends_with("panorama")
        };
        self.words.iter().any(is) || names_a_full_turn(&self.name)
    }

    /// Whether 360 stands in the name right after a letter, as in `my360`, which may mean degrees.
    pub(super) fn may_name_sphere(&self) -> bool {
        self.name.match_indices("360").any(|(at, _)| {
            let mut before = self.name[..at].chars().rev();
            let after = self.name[at + 3..].chars().next();
            let is_size = |c: char| c.is_ascii_digit() || c == 'p' || c == 'x';
            match before.next() {
                // A size, as 640x360.
                Some('x') if before.next().is_some_and(|c| c.is_ascii_digit()) => false,
                Some(c) => c.is_alphabetic() && !after.is_some_and(is_size),
                None => false,
            }
        })
    }

    /// Whether the name says that it is the faces of a cube.
    pub(super) fn names_cube(&self) -> bool {
        let is_cube = |word: &String| {
            let layouts = ["3x2", "6x1", "1x6", "4x1"].into_iter();
            let mut stems = layouts.filter_map(|layout| word.strip_suffix(layout));
            let is = |stem: &str| ["cube", "cubemap"].contains(&stem);
            is(word) || stems.any(|stem| is(stem) || stem == "c")
        };
        self.words.iter().any(is_cube)
    }

    /// Whether the name says that it is a cube whose columns are angles.
    pub(super) fn names_equiangular(&self) -> bool {
        self.has(&["eac"])
    }
}

/// Whether a name says 360 and means degrees: not a size as in `640x360`, `360p` or `xbox360`.
fn names_a_full_turn(name: &str) -> bool {
    name.match_indices("360").any(|(at, _)| {
        let before = name[..at].chars().next_back();
        let after = name[at + 3..].chars().next();
        !before.is_some_and(char::is_alphanumeric)
            && !after.is_some_and(|c| c.is_ascii_digit() || c == 'p' || c == 'x')
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_size_in_a_name_is_no_full_turn() {
        for name in [
            "tour_360.mp4",
            "360.mkv",
            "beach-360-4k.mp4",
            "360video.mp4",
        ] {
            assert!(names_a_full_turn(name), "{name}");
        }
        for name in [
            "clip_640x360.mp4",
            "360p.mp4",
            "xbox360.mp4",
            "13600.mp4",
            "a.mp4",
        ] {
            assert!(!names_a_full_turn(name), "{name}");
        }
    }

    #[test]
    fn a_full_turn_may_stand_right_after_a_letter() {
        let may = |name: &str| NameWords::of(Path::new(name)).may_name_sphere();
        for name in ["my360.jpg", "IMG360_1.png", "tour360a.mp4"] {
            assert!(may(name), "{name}");
        }
        for name in [
            "a640x360.jpg",
            "a_360.jpg",
            "b360p.mp4",
            "13600.mp4",
            "a.mp4",
        ] {
            assert!(!may(name), "{name}");
        }
    }

    #[test]
    fn eyes_and_halves_are_named_by_whole_words() {
        let words = |name: &str| NameWords::of(Path::new(name));
        for (name, packing, right_first) in [
            ("tour_LR.mp4", Packing::SideBySide, false),
            ("tour-SBS.mkv", Packing::SideBySide, false),
            ("tour_180_TB.mp4", Packing::TopBottom, false),
            ("tour.ou.mp4", Packing::TopBottom, false),
            ("tour_rl.mp4", Packing::SideBySide, true),
            ("tour_bt.mp4", Packing::TopBottom, true),
        ] {
            let expected = EyeLayout {
                packing,
                right_first,
            };
            assert_eq!(words(name).eyes(), Some(expected), "{name}");
        }
        for name in [
            "my_pano.jpg",
            "Pano-01.jpg",
            "pano3.jpg",
            "Kugelpanorama.jpg",
            "IMG_1_equirectangular.png",
            "a sphere.mp4",
        ] {
            assert!(words(name).names_sphere(), "{name}");
        }
        for name in [
            "atmosphere.mp4",
            "hemisphere.mp4",
            "hispano.mkv",
            "biospheres.mp4",
            "timpano.jpg",
            "spheredome.mp4",
        ] {
            assert!(!words(name).names_sphere(), "{name}");
        }
        for name in ["about.mp4", "tubes.mp4", "lrx.mp4", "a__b.mp4", ""] {
            assert_eq!(words(name).eyes(), None, "{name}");
        }
        assert!(words("a_180_LR.mp4").names_half() && words("vr180.mp4").names_half());
        assert!(!words("a_1800.mp4").names_half());
        for name in [
            "x_cube.png",
            "cube3x2.mp4",
            "tour_cubemap6x1.mp4",
            "c1x6.mkv",
        ] {
            assert!(words(name).names_cube(), "{name}");
        }
        for name in [
            "cuber.mp4",
            "3x2.mp4",
            "cubex3x2.mp4",
            "c.mp4",
            "abc3x2.mp4",
        ] {
            assert!(!words(name).names_cube(), "{name}");
        }
        assert!(words("x_eac.webm").names_equiangular());
    }
}
