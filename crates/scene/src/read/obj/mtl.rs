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
    pub(super) has_textures: bool,
}

impl Library {
    /// Adds the materials of a file.
    pub(super) fn read(&mut self, bytes: &[u8]) -> Result<(), Fault> {
        let mut current: Option<Material> = None;
        for line in lines(bytes) {
            let mut words = Words::of(&line);
            let keyword = words.next().unwrap_or("");
            if keyword == "newmtl" {
                let begun = current.replace(Material {
                    name: words.rest(),
                    two_sided: true,
                    ..Material::default()
                });
                self.add(begun);
            } else if let Some(material) = &mut current {
                self.has_textures |= keyword == "map_Kd";
                read_property(material, keyword, &mut words)?;
            }
        }
        self.add(current);
        Ok(())
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
    match keyword {
        "Kd" if !["spectral", "xyz"]
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
        "Tr" => {
            material.colour[3] = 1.0 - words.number("`Tr`")?.clamp(0.0, 1.0) as f32;
        }
        _ => {}
    }
    Ok(())
}
