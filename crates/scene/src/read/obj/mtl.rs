//! How is an MTL file read?
//!
//! `Kd` is taken as sRGB-encoded, as programs that write it show it so.

use std::collections::{HashMap, HashSet};

use super::super::colour::{Brightness, linear_from_encoded};
use super::super::error::Fault;
use super::super::mends::{MAP_OPTION_LEFT, MATERIAL_TWICE, Mends, OPACITY_TWICE, SPECTRUM_LEFT};
use super::super::sound::count;
use super::super::text::{Words, lines, shortened};
use crate::source::{Material, Repairs};
use percent_encoding::percent_decode_str;

/// Light of what is black.
const DARKEST: f32 = 1e-3;
/// Most materials that remarks name.
const MOST_REMARKS: usize = 8;

/// The materials that files define.
#[derive(Debug, Default)]
pub(super) struct Library {
    pub(super) materials: HashMap<String, Material>,
    /// The pictures of materials, by name, and how they lie.
    pub(super) pictures: HashMap<String, MapOptions>,
    /// The materials that a picture of alpha makes half transparent (`map_d`).
    pub(super) seen_through: HashSet<String>,
    pub(super) repairs: Repairs,
    /// What a person should know of materials.
    pub(super) remarks: Vec<String>,
    pub(super) mends: Mends,
}

/// What a material says while it is read.
#[derive(Debug, Default)]
struct Said {
    material: Material,
    /// What stands for `map_Kd` where there is none: `map_Ka`, then `map_Ke`.
    others: [Option<MapOptions>; 2],
    /// `Ke`, in linear light.
    emitted: [f32; 3],
    /// How `Kd` is read.
    taken: Option<Brightness>,
    /// What `d` and `Tr` say of how opaque it is.
    opacities: [Option<f32>; 2],
    /// `map_Kd`, and whether there is a `map_d`.
    picture: Option<MapOptions>,
    is_seen_through: bool,
}

/// What `map_Kd` says.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct MapOptions {
    /// Name of the file.
    pub(super) file: String,
    /// The same from the folder of the library, and without what stands for blanks in addresses.
    others: Vec<String>,
    pub(super) scale: [f64; 2],
    pub(super) offset: [f64; 2],
    pub(super) clamps: bool,
    /// Whether options change the picture in ways that are not drawn.
    is_changed: bool,
}

impl MapOptions {
    /// Options with their values, then a name, maybe with blanks.
    fn read(words: &mut Words<'_>) -> Self {
        let mut options = Self {
            file: String::new(),
            others: Vec::new(),
            scale: [1.0; 2],
            offset: [0.0; 2],
            clamps: false,
            is_changed: false,
        };
        let mut as_it_is = words.clone();
        let mut rest = words.rest();
        while let Some((name, behind)) = rest.split_once(' ').filter(|(it, _)| it.starts_with('-'))
        {
            let most = match name {
                "-o" | "-s" | "-t" => 3,
                "-mm" => 2,
                _ => 1,
            };
            let is_of_it = |(at, word): &(usize, &str)| match most {
                1 => *at < 1,
                _ => *at < most && word.parse::<f64>().is_ok(),
            };
            let values: Vec<&str> = behind
                .split(' ')
                .enumerate()
                .take_while(is_of_it)
                .map(|it| it.1)
                .collect();
            let number = |at: usize| values.get(at).and_then(|it| it.parse().ok());
            let target = match name {
                "-o" => Some(&mut options.offset),
                "-s" => Some(&mut options.scale),
                _ => None,
            };
            for (at, along) in target.into_iter().flatten().enumerate() {
                *along = number(at).unwrap_or(*along);
            }
            options.clamps |= name == "-clamp" && values.first() == Some(&"on");
            let usual = match name {
                "-mm" => &[0.0, 1.0][..],
                "-t" => &[0.0, 0.0, 0.0],
                _ => &[],
            };
            let mut told = usual.iter().enumerate();
            options.is_changed |=
                told.any(|(at, usual)| number(at).is_some_and(|it: f64| it != *usual));
            (0..=values.len()).for_each(|_| _ = as_it_is.next());
            rest = behind
                .split(' ')
                .skip(values.len())
                .collect::<Vec<_>>()
                .join(" ");
        }
        let as_it_is = as_it_is.rest_as_it_is();
        if as_it_is != rest {
            options.others.push(as_it_is.to_owned());
        }
        options.file = rest;
        options
    }

    /// The names that the file may have, the likeliest first.
    pub(super) fn names(&self) -> Vec<&str> {
        let others = self.others.iter().map(String::as_str);
        others.chain([&*self.file]).collect()
    }

    /// Remembers that a library of this name describes it.
    fn lies_beside(&mut self, library: &str) {
        if let Some((folder, _)) = library.rsplit_once(['/', '\\']) {
            self.others.push(format!("{folder}/{}", self.file));
        }
        if self.file.contains('%') {
            let plain = percent_decode_str(&self.file).decode_utf8_lossy();
            self.others.push(plain.into_owned());
        }
    }
}

impl Library {
    /// Adds the materials of a file of this name, and returns the numbers of lines that say nothing
    /// that a colour can be; these are left out.
    pub(super) fn read(&mut self, bytes: &[u8], name: &str) -> Vec<usize> {
        let mut broken = Vec::new();
        let mut current: Option<Said> = None;
        for line in lines(bytes) {
            let mut words = Words::of(&line);
            let keyword = words.next().unwrap_or("").to_ascii_lowercase();
            if keyword == "newmtl" {
                let material = Material {
                    name: words.rest(),
                    two_sided: true,
                    ..Material::default()
                };
                let begun = current.replace(Said {
                    material,
                    ..Said::default()
                });
                self.add(begun);
            } else if let Some(said) = &mut current {
                if matches!(&*keyword, "map_kd" | "map_ka" | "map_ke") {
                    let mut options = MapOptions::read(&mut words);
                    options.lies_beside(name);
                    match &*keyword {
                        "map_ka" => said.others[0] = Some(options),
                        "map_ke" => said.others[1] = Some(options),
                        _ => said.picture = Some(options),
                    }
                }
                said.is_seen_through |= keyword == "map_d" && !words.rest().is_empty();
                let is_spectrum = keyword == "kd" && words.peek() == "spectral";
                let place = || format!("in line {} of {:?}", line.number, shortened(name));
                self.mends
                    .add(SPECTRUM_LEFT, usize::from(is_spectrum), place);
                if read_property(said, &keyword, &mut words).is_err() {
                    broken.push(line.number);
                }
            }
        }
        self.add(current);
        broken
    }

    /// Counts what was mended of a material, and says it.
    fn mend(&mut self, repair: &str, material: &Material, what: &str) {
        count(&mut self.repairs, repair, 1);
        if self.remarks.len() < MOST_REMARKS {
            self.remarks
                .push(format!("material {:?}: {what}", shortened(&material.name)));
        }
    }

    fn add(&mut self, said: Option<Said>) {
        if let Some(said) = said {
            let Said {
                mut material,
                others: [ambient, light],
                emitted,
                taken,
                opacities,
                mut picture,
                is_seen_through,
            } = said;
            let [opacity, other] = opacities;
            let is_told_twice = opacity.zip(other).is_some_and(|(a, b)| a != b);
            material.colour[3] = opacity.or(other).unwrap_or(material.colour[3]);
            if let Some((repair, what)) = taken.and_then(|it| it.told("`Kd`")) {
                self.mend(repair, &material, &what);
            }
            let has_picture = picture.is_some();
            let is_black = material.colour[..3].iter().all(|it| *it < DARKEST);
            let is_light = emitted.iter().any(|it| *it > DARKEST);
            let other = match (has_picture, is_black && is_light) {
                (true, _) => None,
                (false, true) => light.map(|it| (it, "map_Ke")),
                (false, false) => ambient.map(|it| (it, "map_Ka")),
            };
            if is_black && is_light && !has_picture {
                material.colour[..3].copy_from_slice(&emitted);
                let what = "black but for its light (`Ke`), whose colour is shown";
                self.mend("lights_shown_as_colours", &material, what);
            }
            if let Some((other, keyword)) = other {
                let what = format!("its picture is that of `{keyword}`, as `map_Kd` is missing");
                self.mend("pictures_of_other_kinds", &material, &what);
                picture = Some(other);
            }
            // Exporters write no light where a picture has it all.
            let is_black = material.colour[..3].iter().all(|it| *it < DARKEST);
            if is_black && picture.is_some() {
                material.colour[..3].fill(1.0);
                count(&mut self.repairs, "black_under_textures", 1);
            }
            let place = || format!("is {:?}", shortened(&material.name));
            let is_changed = picture.as_ref().is_some_and(|it| it.is_changed);
            self.mends
                .add(MAP_OPTION_LEFT, usize::from(is_changed), place);
            self.mends
                .add(OPACITY_TWICE, usize::from(is_told_twice), place);
            let before = self.materials.get(&material.name);
            let is_other = before.is_some_and(|it| *it != material)
                || before.is_some() && self.pictures.get(&material.name) != picture.as_ref();
            self.mends.add(MATERIAL_TWICE, usize::from(is_other), place);
            match picture {
                Some(picture) => _ = self.pictures.insert(material.name.clone(), picture),
                None => _ = self.pictures.remove(&material.name),
            }
            match is_seen_through {
                true => _ = self.seen_through.insert(material.name.clone()),
                false => _ = self.seen_through.remove(&material.name),
            }
            self.materials.insert(material.name.clone(), material);
        }
    }
}

/// Whether bytes are text, and not an archive, a picture or the like.
pub(super) fn is_text(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(1024)];
    !head.contains(&0)
}

/// A name in small letters, with single blanks, also for underscores: alike for names that differ
/// only in these.
pub(super) fn alike(name: &str) -> String {
    let signs = name.chars().map(|it| if it == '_' { ' ' } else { it });
    let plain: String = signs.flat_map(char::to_lowercase).collect();
    plain.split_ascii_whitespace().collect::<Vec<_>>().join(" ")
}

/// Linear light of sRGB from CIE XYZ, whose white is D65 (IEC 61966-2-1).
fn light_from_xyz([x, y, z]: [f64; 3]) -> [f64; 3] {
    [
        3.2406 * x - 1.5372 * y - 0.4986 * z,
        -0.9689 * x + 1.8758 * y + 0.0415 * z,
        0.0557 * x - 0.2040 * y + 1.0570 * z,
    ]
}

fn read_property(said: &mut Said, keyword: &str, words: &mut Words<'_>) -> Result<(), Fault> {
    words.leave_out_comment();
    let material = &mut said.material;
    match keyword {
        "kd" | "ke" if words.peek() == "spectral" => {
            words.next();
            words.next();
            let light = words.number_if_any("a factor")?.unwrap_or(1.0);
            if keyword == "kd" {
                material.colour[..3].fill(light.clamp(0.0, 1.0) as f32);
            }
        }
        "kd" | "ke" => {
            let is_xyz = words.peek() == "xyz";
            if is_xyz {
                words.next();
            }
            let red = words.number("a colour")?;
            let green = words.number_if_any("a colour")?.unwrap_or(red);
            let blue = words.number_if_any("a colour")?.unwrap_or(red);
            let parts = [red, green, blue];
            let taken = Brightness::of(parts, 1.0);
            let light = match is_xyz {
                true => light_from_xyz(parts).map(|it| it.clamp(0.0, 1.0) as f32),
                false => parts.map(|it| linear_from_encoded(it / taken.full())),
            };
            if keyword == "ke" {
                said.emitted = light;
            } else {
                material.colour[..3].copy_from_slice(&light);
                said.taken = Some(taken).filter(|_| !is_xyz);
            }
        }
        "d" if !words.rest().starts_with('-') => {
            said.opacities[0] = Some(words.number("`d`")?.clamp(0.0, 1.0) as f32);
        }
        "tr" => {
            said.opacities[1] = Some(1.0 - words.number("`Tr`")?.clamp(0.0, 1.0) as f32);
        }
        _ => {}
    }
    Ok(())
}
