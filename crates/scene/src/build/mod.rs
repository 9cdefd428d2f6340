//! How does a scene become units?
//!
//! Each mesh is put on a grid, cut into clusters of triangles, and simplified in groups of a few
//! clusters whose borders stay; the coarse clusters are grouped again, until one is left (Karis et
//! al. 2021, "A deep dive into Nanite virtualized geometry"). Each group becomes a unit. Clouds of
//! points become octrees, each of whose nodes is one.

mod built;
mod bundles;
mod cloud;
mod joined;
mod mesh;
mod numbering;
mod pages;
mod pyramid;
mod regions;
mod sphere;
mod textures;

#[cfg(test)]
pub(crate) mod tests;

use crate::source::{Repairs, SourceScene};
pub use built::{BuildError, BuildOptions, Built, BuiltUnit};
use foveal_core::content::scene::description::{GRID_BITS, JoinedParts, MOST_OBJECTS};
use glam::DVec3;
use joined::{Graphed, joined};
pub(crate) use mesh::grid_mesh::codes_from_linear;
use mesh::grid_mesh::{GridMesh, grid_mesh};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};
use textures::ShownImages;

/// Turns a scene into units; `progress` hears how many triangles and points are done, of about
/// how many.
///
/// The result depends on the source and the bits alone. Takes about three seconds for a million
/// triangles on one thread, and about 200 bytes of memory for each triangle.
///
/// # Errors
/// A source without triangles and points, or one whose numbers are out of range.
///
/// # Example
/// ```
/// use foveal_scene::build::{BuildOptions, build};
/// use foveal_scene::source::{SourceScene, SourceMesh, SourceObject};
/// use glam::{DAffine3, DVec3};
///
/// let mesh = SourceMesh {
///     positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y],
///     triangles: vec![[0, 1, 2]],
///     ..Default::default()
/// };
/// let placements = vec![DAffine3::IDENTITY];
/// let object = SourceObject { name: "triangle".to_owned(), mesh: 0, placements };
/// let source = SourceScene { objects: vec![object], meshes: vec![mesh], ..Default::default() };
/// let built = build(&source, &BuildOptions::default(), &|_, _| ())?;
/// assert_eq!(built.units.len(), 1);
/// # Ok::<(), foveal_scene::build::BuildError>(())
/// ```
pub fn build(
    source: &SourceScene,
    options: &BuildOptions,
    progress: &(dyn Fn(u64, u64) + Sync),
) -> Result<Built, BuildError> {
    if !GRID_BITS.contains(&options.bits) {
        return Err(BuildError::Bits(options.bits));
    }
    let threads = rayon::ThreadPoolBuilder::new().num_threads(options.jobs.max(1));
    threads
        .build()?
        .install(|| build_here(source, options, progress))
}

fn build_here(
    source: &SourceScene,
    options: &BuildOptions,
    progress: &(dyn Fn(u64, u64) + Sync),
) -> Result<Built, BuildError> {
    let shown = ShownImages::new(source);
    let (mut meshes, joined_parts) = on_grids(source, options, &shown)?;
    let mut repairs = source.repairs.clone();
    let zero_area = meshes.iter().map(|mesh| mesh.zero_area).sum();
    count(&mut repairs, "zero_area_triangles", zero_area);
    let all = meshes.len();
    meshes.retain(|mesh| !mesh.triangles.is_empty());
    count(&mut repairs, "empty_objects", (all - meshes.len()) as u64);
    if meshes.is_empty() && source.clouds.is_empty() {
        return Err(BuildError::Empty);
    }
    // Each level has half the triangles of the one before: all together twice the source's.
    let triangles = meshes.iter().map(|it| 2 * it.triangles.len() as u64);
    let points = source.clouds.iter().map(|it| it.places.len() as u64);
    let all: u64 = triangles.chain(points).sum();
    let done = AtomicU64::new(0);
    let step = |samples: u64| {
        let before = done.fetch_add(samples, Ordering::Relaxed);
        progress((before + samples).min(all), all);
    };
    let graphs: Vec<_> = meshes
        .par_iter_mut()
        .map(|it| mesh::graph::build(it, &step))
        .collect();
    let permissive = graphs.iter().map(|graph| graph.permissive).sum();
    count(&mut repairs, "permissive_groups", permissive);
    let light = DVec3::from_array(source.look().light);
    let light = options.signatures.then_some(light);
    let pages = pages::write(source, &shown, &mut meshes, options.exact)?;
    count(&mut repairs, "missing_images", shown.missing + pages.broken);
    let (units, levels) = mesh::units::write(&meshes, &graphs, &pages.all, light)?;
    let objects = meshes.into_iter().map(|mesh| (mesh.object, mesh.parts));
    let (mut objects, mut parts): (Vec<_>, Vec<_>) = objects.unzip();
    drop(graphs);
    let (mut graphed, mut remarks) = (vec![Graphed { units, levels }], pages.remarks);
    for source in &source.clouds {
        let built = cloud::build(source, objects.len() as u16, &step)?;
        objects.push(built.object);
        parts.push(Vec::new());
        graphed.push(built.units);
        count(&mut repairs, "points_of_one_place", built.left_out);
        if built.left_out > 0 {
            remarks.push(format!(
                "{}: {} of {} points are left out, where very many lie at one place",
                source.name,
                built.left_out,
                source.places.len()
            ));
        }
    }
    progress(all, all);
    let (units, levels) = joined(graphed);
    Ok(Built {
        objects,
        parts,
        joined: joined_parts,
        textures: pages.textures,
        units,
        levels,
        repairs,
        remarks,
    })
}

/// The meshes of all objects on their grids, those of very many small parts joined.
fn on_grids(
    source: &SourceScene,
    options: &BuildOptions,
    shown: &ShownImages,
) -> Result<(Vec<GridMesh>, JoinedParts), BuildError> {
    let bundles = bundles::bundles(source);
    let objects = source.objects.iter().zip(&bundles.is_joined);
    let apart = objects.filter(|(_, is_joined)| !**is_joined);
    let apart: Vec<_> = apart.map(|(object, _)| object).collect();
    let objects = apart.len() + bundles.scene.objects.len() + source.clouds.len();
    if objects > MOST_OBJECTS {
        return Err(BuildError::Objects(objects));
    }
    let apart = apart.into_par_iter();
    let meshes = apart.map(|object| grid_mesh(source, object, options.bits, shown));
    let mut meshes = meshes.collect::<Result<Vec<_>, _>>()?;
    let told = JoinedParts {
        bundles: bundles.scene.objects.len() as u64,
        objects: bundles.is_joined.iter().filter(|it| **it).count() as u64,
        places: bundles.names.iter().map(|it| it.len() as u64).sum(),
    };
    let of_bundles = bundles.scene.objects.par_iter().zip(bundles.names);
    let of_bundles = of_bundles.map(|(object, parts)| {
        let mesh = grid_mesh(&bundles.scene, object, bundles::BITS, shown)?;
        Ok(GridMesh { parts, ..mesh })
    });
    meshes.extend(of_bundles.collect::<Result<Vec<_>, BuildError>>()?);
    Ok((meshes, told))
}

fn count(repairs: &mut Repairs, name: &str, times: u64) {
    if times > 0 {
        *repairs.entry(name.to_owned()).or_default() += times;
    }
}
