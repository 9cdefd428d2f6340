//! How does a scene become units?
//!
//! Each mesh is put on a grid, cut into clusters of triangles, and simplified in groups of a few
//! clusters whose borders stay; the coarse clusters are grouped anew, until one is left (Karis et
//! al. 2021, "A deep dive into Nanite virtualized geometry"). Each group becomes a unit.

mod clusters;
mod graph;
mod groups;
mod mesh;
mod numbering;
mod simplify;
mod sphere;
mod units;

#[cfg(test)]
pub(crate) mod tests;

use crate::source::{Repairs, Source};
use foveal_core::content::scene::description::{GRID_BITS, SceneObject};
use foveal_core::content::scene::unit_table::UnitRow;
use foveal_core::pack::PackError;
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};

/// Most objects of a scene.
const MOST_OBJECTS: usize = 4096;

/// How a scene is built.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BuildOptions {
    /// Bits of a place along the largest extent of an object: 10 to 16.
    pub bits: u8,
    /// Number of threads; changes no byte.
    pub jobs: usize,
}

impl Default for BuildOptions {
    fn default() -> Self {
        Self { bits: 14, jobs: 1 }
    }
}

/// A unit with what is told of it.
#[derive(Clone, Debug, PartialEq)]
pub struct BuiltUnit {
    /// Its level, 0 the finest; all roots have the coarsest.
    pub level: u8,
    /// What is told of it before it is fetched.
    pub row: UnitRow,
    /// What is fetched.
    pub payload: Vec<u8>,
}

/// A scene as units.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Built {
    /// What stands in the scene.
    pub objects: Vec<SceneObject>,
    /// All units; the place of one is its number. Coarsest level first, within a level by object,
    /// then along a curve through space.
    pub units: Vec<BuiltUnit>,
    /// Number of levels.
    pub levels: u8,
    /// What was repaired or left out: that of the source and that of the build.
    pub repairs: Repairs,
}

/// Why a scene cannot be built.
#[derive(Debug, thiserror::Error)]
pub enum BuildError {
    /// A number of bits that no grid has.
    #[error("bits of the grid: {0}; choose 10 to 16")]
    Bits(u8),
    /// Nothing that has an area.
    #[error("scene: no triangle with an area; choose files with meshes")]
    Empty,
    /// More than a pack can tell of.
    #[error("scene: {0} objects; at most 4096 fit")]
    Objects(usize),
    /// A source that contradicts itself.
    #[error("object {object}, {what}; mend the file")]
    Source {
        /// Name of the object.
        object: String,
        /// What is wrong with it.
        what: &'static str,
    },
    /// The threads did not start.
    #[error("threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// A unit could not be written.
    #[error("unit: {0}")]
    Unit(#[from] PackError),
}

/// Turns a scene into units; `progress` hears how many triangles are done, of about how many.
///
/// The result depends on the source and the bits alone. Takes about three seconds for a million
/// triangles on one thread, and about 200 bytes of memory for each triangle.
///
/// # Errors
/// A source without triangles, or one whose numbers are out of range.
///
/// # Example
/// ```
/// use foveal_scene::build::{BuildOptions, build};
/// use foveal_scene::source::{Source, SourceMesh, SourceObject};
/// use glam::{DAffine3, DVec3};
///
/// let mesh = SourceMesh {
///     positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y],
///     triangles: vec![[0, 1, 2]],
///     ..Default::default()
/// };
/// let placements = vec![DAffine3::IDENTITY];
/// let object = SourceObject { name: "triangle".to_owned(), mesh: 0, placements };
/// let source = Source { objects: vec![object], meshes: vec![mesh], ..Default::default() };
/// let built = build(&source, &BuildOptions::default(), &|_, _| ())?;
/// assert_eq!(built.units.len(), 1);
/// # Ok::<(), foveal_scene::build::BuildError>(())
/// ```
pub fn build(
    source: &Source,
    options: &BuildOptions,
    progress: &(dyn Fn(u64, u64) + Sync),
) -> Result<Built, BuildError> {
    if !GRID_BITS.contains(&options.bits) {
        return Err(BuildError::Bits(options.bits));
    }
    if source.objects.len() > MOST_OBJECTS {
        return Err(BuildError::Objects(source.objects.len()));
    }
    let threads = rayon::ThreadPoolBuilder::new().num_threads(options.jobs.max(1));
    threads
        .build()?
        .install(|| build_here(source, options, progress))
}

fn build_here(
    source: &Source,
    options: &BuildOptions,
    progress: &(dyn Fn(u64, u64) + Sync),
) -> Result<Built, BuildError> {
    let objects = source.objects.par_iter();
    let meshes = objects.map(|object| mesh::grid_mesh(source, object, options.bits));
    let mut meshes = meshes.collect::<Result<Vec<_>, _>>()?;
    let mut repairs = source.repairs.clone();
    let zero_area = meshes.iter().map(|mesh| mesh.zero_area).sum();
    count(&mut repairs, "zero_area_triangles", zero_area);
    let all = meshes.len();
    meshes.retain(|mesh| !mesh.triangles.is_empty());
    count(&mut repairs, "empty_objects", (all - meshes.len()) as u64);
    if meshes.is_empty() {
        return Err(BuildError::Empty);
    }
    // Each level has half the triangles of the one before: all together twice the source's.
    let all: u64 = meshes.iter().map(|it| 2 * it.triangles.len() as u64).sum();
    let done = AtomicU64::new(0);
    let step = |triangles: u64| {
        let before = done.fetch_add(triangles, Ordering::Relaxed);
        progress((before + triangles).min(all), all);
    };
    let graphs: Vec<_> = meshes
        .par_iter()
        .map(|it| graph::build(it, &step))
        .collect();
    progress(all, all);
    let permissive = graphs.iter().map(|graph| graph.permissive).sum();
    count(&mut repairs, "permissive_groups", permissive);
    let (units, levels) = units::write(&meshes, &graphs)?;
    Ok(Built {
        objects: meshes.into_iter().map(|mesh| mesh.object).collect(),
        units,
        levels,
        repairs,
    })
}

fn count(repairs: &mut Repairs, name: &str, times: u64) {
    if times > 0 {
        *repairs.entry(name.to_owned()).or_default() += times;
    }
}
