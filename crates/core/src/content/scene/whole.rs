//! Do the units of a scene match their table, and each other?
//!
//! These are the checks that drawing makes of each unit as it arrives: a pack that passes them is
//! drawn whole.

use super::pack::ScenePack;
use crate::content::images::shape::{BORDER, PagePlace, TextureShape};
use crate::content::mesh::payload::MeshUnit;
use crate::content::payload::Payload;
use crate::content::points::whole::CloudCheck;
use crate::pack::PackError;
use crate::pack::unit::UnitId;
use core::hash::BuildHasher;
use std::collections::{HashMap, HashSet};

/// Compares units with their rows and with the units that they need, which come before them.
///
/// Keeps eight bytes for each vertex of clusters whose refinement has not come.
#[derive(Debug)]
pub struct SceneCheck<'a> {
    pack: &'a ScenePack,
    clouds: CloudCheck,
    /// Which unit refines each cluster.
    refiners: HashMap<(UnitId, u8), UnitId>,
    /// The vertices of clusters that are refined; each stands there until it is.
    clusters: HashMap<(UnitId, u8), Vec<u64>>,
    /// Pages, with their textures.
    pages: HashMap<UnitId, (u16, PagePlace)>,
    /// Units that are damaged themselves, or need one that is.
    damaged: HashSet<UnitId>,
    hasher: core::hash::BuildHasherDefault<std::hash::DefaultHasher>,
}

impl<'a> SceneCheck<'a> {
    /// No unit of a pack.
    #[must_use]
    pub fn new(pack: &'a ScenePack) -> Self {
        Self {
            refiners: pack.refiners(),
            pack,
            clouds: CloudCheck::default(),
            clusters: HashMap::new(),
            pages: HashMap::new(),
            damaged: HashSet::new(),
            hasher: Default::default(),
        }
    }

    /// A unit could not be read: nothing is asked of those that need it.
    pub fn miss(&mut self, unit: UnitId) {
        self.damaged.insert(unit);
    }

    /// Adds a unit after all with lower numbers.
    ///
    /// # Errors
    /// It differs from its row in the table, or does not fit what it needs.
    pub fn add(&mut self, unit: UnitId, payload: &Payload) -> Result<(), PackError> {
        let needs = &self.pack.row(unit).needs;
        let misses = needs.iter().any(|it| self.damaged.contains(it));
        let checked = self.check_row(unit, payload).and_then(|()| match misses {
            // What it needs has been reported already.
            true => Ok(()),
            false => self.fit(unit, payload),
        });
        if misses || checked.is_err() {
            self.damaged.insert(unit);
        }
        checked
    }

    fn fit(&mut self, unit: UnitId, payload: &Payload) -> Result<(), PackError> {
        match payload {
            Payload::Mesh(payload) => self.fit_mesh(unit, payload),
            Payload::Image(page) => self.fit_page(unit, (page.texture, page.page)),
            Payload::Points(_) => self.clouds.add(unit, self.pack.row(unit), payload),
            Payload::Picture(_) | Payload::Other(_) => Ok(()),
        }
    }

    /// Refuses a unit that differs from its row in the table.
    fn check_row(&self, unit: UnitId, payload: &Payload) -> Result<(), PackError> {
        let row = self.pack.row(unit);
        let found = match payload {
            Payload::Mesh(mesh) => {
                let corners = mesh.clusters.iter().map(|it| it.vertices.len());
                [mesh.triangles(), corners.sum()]
            }
            Payload::Image(page) => {
                let inner = page.picture.size.map(|side| (side - 2 * BORDER) as usize);
                let quarter = row.replaces.first().map(|it| it.part);
                let is_its = quarter.is_none_or(|it| it == page.page.quarter());
                [inner[0] * inner[1], usize::from(!is_its)]
            }
            Payload::Points(points) => [points.points.len(), 0],
            Payload::Picture(_) | Payload::Other(_) => return Ok(()),
        };
        let told = [row.samples, row.vertices].map(|it| it as usize);
        match found == told {
            true => Ok(()),
            false => Err(PackError::new(
                &format!("unit {}, samples and vertices", unit.0),
                format!("{found:?}"),
                format!("{told:?}, as the table says"),
            )),
        }
    }

    /// Refuses a unit of a mesh whose coarse clusters are not there, or have other vertices than
    /// stay; keeps the vertices of its clusters that others refine.
    fn fit_mesh(&mut self, unit: UnitId, payload: &MeshUnit) -> Result<(), PackError> {
        let needs = &self.pack.row(unit).needs;
        let mut vertices: Vec<u64> = Vec::new();
        let mut met: HashSet<u64> = HashSet::new();
        for replaced in &payload.replaces {
            let need = needs.get(usize::from(replaced.need)).copied();
            // Of two that replace a cluster, the second finds nothing there.
            let there = need.and_then(|need| self.clusters.remove(&(need, replaced.part)));
            let Some(there) = there else {
                return Err(PackError::new(
                    &format!("unit {}, replaces", unit.0),
                    format!("cluster {} of {need:?}", replaced.part),
                    "a cluster that is there, and that no other unit replaces",
                ));
            };
            vertices.extend(there.into_iter().filter(|it| met.insert(*it)));
        }
        if vertices.len() != usize::from(payload.staying) {
            return Err(PackError::new(
                &format!("unit {}, staying vertices", unit.0),
                payload.staying,
                format!("{}, as many as the replaced clusters have", vertices.len()),
            ));
        }
        vertices.extend(payload.vertices.iter().map(|it| self.hasher.hash_one(it)));
        for (cluster, number) in payload.clusters.iter().zip(0..) {
            if self.refiners.contains_key(&(unit, number)) {
                let own = cluster.vertices.iter().map(|it| vertices[usize::from(*it)]);
                self.clusters.insert((unit, number), own.collect());
            }
        }
        Ok(())
    }

    /// Refuses a page that needs another than the one it lies in.
    fn fit_page(&mut self, unit: UnitId, page: (u16, PagePlace)) -> Result<(), PackError> {
        let (texture, place) = page;
        let about = &self.pack.description().textures[usize::from(texture)];
        let is_root = place.level == TextureShape { size: about.size }.root();
        let is_coarser = |need: &UnitId| self.pages.get(need) == Some(&(texture, place.coarser()));
        let needs = &self.pack.row(unit).needs;
        let fits = match needs[..] {
            [] => is_root,
            [need] => !is_root && is_coarser(&need),
            _ => false,
        };
        self.pages.insert(unit, page);
        match fits {
            true => Ok(()),
            false => Err(PackError::new(
                &format!("unit {}, needs", unit.0),
                format!("{needs:?} of page {place:?}"),
                "the page that it lies in, or nothing of the coarsest",
            )),
        }
    }
}
