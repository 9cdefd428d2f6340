//! How is an MTL file read?
//!
//! `Kd` is taken as sRGB-encoded, as programs that write it show it so.

use std::collections::HashMap;

use super::super::colour::linear_from_encoded;
use super::super::error::Fault;
use super::super::sound::count;
use super::super::text::{Words, lines, shortened};
use crate::source::{Material, Repairs};
use percent_encoding::percent_decode_str;

/// Light of what is black.
const DARKEST: f32 = 1e-3;
/// A `Kd` is brighter than white by mistake up to here; what is beyond is written from 0 to 255.
const MOST_LIGHT: f64 = 16.0;
/// And by rounding up to here.
const CUT_LIGHT: f64 = 1.01;
/// Most materials that remarks name.
const MOST_REMARKS: usize = 8;

/// The materials that files define.
#[derive(Debug, Default)]
pub(super) struct Library {
    pub(super) materials: HashMap<String, Material>,
    /// The pictures of materials, by name, and how they lie.
    pub(super) pictures: HashMap<String, MapOptions>,
    pub(super) repairs: Repairs,
    /// What a person should know of materials.
    pub(super) remarks: Vec<String>,
}

/// What a material says while it is read.
#[derive(Debug, Default)]
struct Said {
    material: Material,
    /// What stands for `map_Kd` where there is none: `map_Ka`, then `map_Ke`.
    others: [Option<MapOptions>; 2],
    /// `Ke`, in linear light.
    emitted: [f32; 3],
    /// The largest of `Kd`.
    most: f64,
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
        };
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
            rest = behind
                .split(' ')
                .skip(values.len())
                .collect::<Vec<_>>()
                .join(" ");
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
                        _ => {
                            self.pictures.insert(said.material.name.clone(), options);
                        }
                    }
                }
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
                most,
            } = said;
            if most > MOST_LIGHT {
                let what = format!("`Kd` reaches {most}: 255 counts as full light");
                self.mend("colours_rescaled", &material, &what);
            } else if most > CUT_LIGHT {
                let what = format!("`Kd` reaches {most}, brighter than white: cut to 1");
                self.mend("colours_cut", &material, &what);
            }
            let has_picture = self.pictures.contains_key(&material.name);
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
            if let Some((picture, keyword)) = other {
                let what = format!("its picture is that of `{keyword}`, as `map_Kd` is missing");
                self.mend("pictures_of_other_kinds", &material, &what);
                self.pictures.insert(material.name.clone(), picture);
            }
            // Exporters write no light where a picture has it all.
            let is_black = material.colour[..3].iter().all(|it| *it < DARKEST);
            if is_black && self.pictures.contains_key(&material.name) {
                material.colour[..3].fill(1.0);
                count(&mut self.repairs, "black_under_textures", 1);
            }
            self.materials.insert(material.name.clone(), material);
        }
    }
}

fn read_property(said: &mut Said, keyword: &str, words: &mut Words<'_>) -> Result<(), Fault> {
    words.leave_out_comment();
    let material = &mut said.material;
    match keyword {
        "kd" | "ke"
            if !["spectral", "xyz"]
                .iter()
                .any(|way| words.rest().starts_with(way)) =>
        {
            let red = words.number("a colour")?;
            let green = words.number_if_any("a colour")?.unwrap_or(red);
            let blue = words.number_if_any("a colour")?.unwrap_or(red);
            let most = red.max(green).max(blue);
            let full = if most > MOST_LIGHT { 255.0 } else { 1.0 };
            let light = [red, green, blue].map(|it| linear_from_encoded(it / full));
            if keyword == "ke" {
                said.emitted = light;
            } else {
                material.colour[..3].copy_from_slice(&light);
                said.most = most;
            }
        }
        "d" if !words.rest().starts_with('-') => {
            material.colour[3] = words.number("`d`")?.clamp(0.0, 1.0) as f32;
        }
        "tr" => {
            material.colour[3] = 1.0 - words.number("`Tr`")?.clamp(0.0, 1.0) as f32;
        }
        _ => {}
    }
    Ok(())
}
