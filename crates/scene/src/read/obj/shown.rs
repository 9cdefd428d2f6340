//! Which looks of an OBJ file are shown, once all of it is read?

use std::collections::{BTreeMap, BTreeSet, HashMap};

use super::super::image::{hidden, transparent};
use super::super::mends::{BLACK_UNDER_COLOURS, TEXTURE_WITHOUT_UVS};
use super::super::text::shortened;
use super::Reader;
use super::corners::NO_UV;

/// A part of a colour below this is black.
const DARKEST: f32 = 1e-3;

impl Reader<'_> {
    /// Shows colours of vertices where a black material would leave nothing of their light, and
    /// painted colours where there are no others. Colours are as the file has them.
    pub(super) fn show_colours_on_black(&mut self) {
        let is_painted = self.place_colours.is_empty() && !self.polypaint.is_empty();
        let is_black = |it: &[f32; 4]| it[..3].iter().all(|part| *part < DARKEST);
        if self.place_colours.is_empty() && !is_painted {
            return;
        }
        let mut black: BTreeSet<u32> = BTreeSet::new();
        for (number, material) in (0..).zip(&self.scene.materials) {
            if is_black(&material.colour) && material.texture.is_none() {
                black.insert(number);
            }
        }
        let mut coloured: BTreeSet<u32> = BTreeSet::new();
        let is_said = |it: &[f32; 4]| it[3] > 0.0 && !is_black(it);
        for (triangle, material) in self.mesh.triangles.iter().zip(&self.mesh.materials) {
            let mut colours = triangle
                .iter()
                .filter_map(|it| self.mesh.colours.get(*it as usize));
            if black.contains(material) && (is_painted || colours.any(is_said)) {
                coloured.insert(*material);
            }
        }
        for number in coloured {
            let material = &mut self.scene.materials[number as usize];
            material.colour[..3].fill(1.0);
            let place = || format!("is {:?}", shortened(&material.name));
            self.mends.add(BLACK_UNDER_COLOURS, 1, place);
        }
    }

    /// Gives vertices the colours that were painted on them.
    pub(super) fn paint(&mut self) {
        if self.place_colours.is_empty() && !self.polypaint.is_empty() {
            let lights = self.polypaint.lights(self.places.len(), &mut self.mends);
            let places = self.vertices.place_of_each();
            let of = |place: &u32| lights.get(*place as usize).copied().unwrap_or([1.0; 4]);
            self.mesh.colours = places.iter().map(of).collect();
            self.place_colours = lights;
        }
    }

    /// Reports pictures without texture coordinates, and what is drawn opaque.
    pub(super) fn tell_what_is_not_shown(&mut self) {
        let mut used: BTreeMap<u32, usize> = BTreeMap::new();
        let is_bare = |vertex: &u32| {
            let uv = self.mesh.uvs.get(*vertex as usize);
            uv.is_none_or(|it| *it == NO_UV)
        };
        for (triangle, material) in self.mesh.triangles.iter().zip(&self.mesh.materials) {
            let shows = self.scene.materials.get(*material as usize);
            let has_picture = shows.is_some_and(|it| it.texture.is_some());
            let bare = has_picture && triangle.iter().any(is_bare);
            *used.entry(*material).or_default() += usize::from(bare);
        }
        for uv in self.mesh.uvs.iter_mut().filter(|it| **it == NO_UV) {
            *uv = [0.0; 2];
        }
        let mut pictures: HashMap<usize, bool> = HashMap::new();
        let mut transparent: Vec<&str> = Vec::new();
        for (number, bare) in used {
            let Some(material) = self.scene.materials.get(number as usize) else {
                continue;
            };
            let place = || {
                let name = shortened(&material.name);
                format!("is under material {name:?}")
            };
            self.mends
                .add(TEXTURE_WITHOUT_UVS, usize::from(bare > 0), place);
            let by_picture = material.texture.is_some_and(|it| {
                let image = &self.scene.images[it.image];
                *pictures
                    .entry(it.image)
                    .or_insert_with(|| transparent::is_seen_through(&image.bytes))
            });
            let by_map = self.library.seen_through.contains(&material.name);
            if !hidden::is_hidden(material) && (material.colour[3] < 1.0 || by_map || by_picture) {
                transparent.push(&material.name);
            }
        }
        let names: Vec<String> = transparent.into_iter().map(str::to_owned).collect();
        transparent::tell(names.iter().map(String::as_str), &mut self.scene);
    }
}
