//! How is an MTL file read?
//!
//! `Kd` is taken as sRGB-encoded, as programs that write it show it so.

use std::collections::HashMap;

use super::super::colour::linear_from_encoded;
use super::super::error::Fault;
use super::super::text::{Words, lines};
use crate::source::Material;

/// The materials that files define.
#[derive(Debug, Default)]
pub(super) struct Library {
    pub(super) materials: HashMap<String, Material>,
    /// The pictures of materials, by name, and how they lie.
    pub(super) pictures: HashMap<String, MapOptions>,
}

/// What `map_Kd` says.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct MapOptions {
    /// Name of the file.
    pub(super) file: String,
    pub(super) scale: [f64; 2],
    pub(super) offset: [f64; 2],
    pub(super) clamps: bool,
}

impl MapOptions {
    /// Options with their values, then a name, maybe with blanks.
    fn read(words: &mut Words<'_>) -> Self {
        let mut options = Self {
            file: String::new(),
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
}

impl Library {
    /// Adds the materials of a file, and returns the numbers of lines that say nothing that a
    /// colour can be; these are left out.
    pub(super) fn read(&mut self, bytes: &[u8]) -> Vec<usize> {
        let mut broken = Vec::new();
        let mut current: Option<Material> = None;
        for line in lines(bytes) {
            let mut words = Words::of(&line);
            let keyword = words.next().unwrap_or("").to_ascii_lowercase();
            if keyword == "newmtl" {
                let begun = current.replace(Material {
                    name: words.rest(),
                    two_sided: true,
                    ..Material::default()
                });
                self.add(begun);
            } else if let Some(material) = &mut current {
                if keyword == "map_kd" {
                    let options = MapOptions::read(&mut words);
                    self.pictures.insert(material.name.clone(), options);
                }
                if read_property(material, &keyword, &mut words).is_err() {
                    broken.push(line.number);
                }
            }
        }
        self.add(current);
        broken
    }

    fn add(&mut self, material: Option<Material>) {
        if let Some(material) = material {
            self.materials.insert(material.name.clone(), material);
        }
    }
}

fn read_property(
    material: &mut Material,
    keyword: &str,
    words: &mut Words<'_>,
) -> Result<(), Fault> {
    words.leave_out_comment();
    match keyword {
        "kd" if !["spectral", "xyz"]
            .iter()
            .any(|way| words.rest().starts_with(way)) =>
        {
            let red = words.number("a colour")?;
            let green = words.number_if_any("a colour")?.unwrap_or(red);
            let blue = words.number_if_any("a colour")?.unwrap_or(red);
            let light = [red, green, blue].map(linear_from_encoded);
            material.colour[..3].copy_from_slice(&light);
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
