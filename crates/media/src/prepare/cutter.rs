//! Which tiles does a source picture become?

use super::plan::PreparationPlan;
use crate::parallel::in_parallel;
use crate::prepare::pyramid::{halve, halve_all};
use crate::prepare::sphere_levels::halve_spheres;
use crate::sphere::{Coverage, CubeSampler, equirect_from_cube};
use crate::surround::cube_layout::CubeLayout;
use crate::surround::eye_layout::EyeLayout;
use crate::surround::found::Surround;
use crate::surround::sphere_part::SpherePart;
use crate::tiles::encode_settings::Speed;
use foveal_core::content::video::grid::tile_grid::{Cut, Tile, TileGrid};
use foveal_core::view::picture::{Colour, Picture};
use foveal_core::view::surface::Projection;
use std::borrow::Cow;

/// How one eye's picture becomes faces.
enum Turn {
    /// It is the face.
    Flat,
    /// By resampling.
    Sphere(Box<CubeSampler>),
    /// By cutting; the flag says that chroma lies on the left luma sample of each pair.
    Cube(CubeLayout, bool),
    /// Onto the front half of a whole sphere.
    Half(SpherePart),
    /// By cutting, and resampling onto a sphere of this many pixels; the flag as above.
    Unfolded(CubeLayout, bool, [u32; 2]),
}

/// Turns source pictures into the tiles of all levels.
pub(super) struct Cutter {
    grid: TileGrid,
    eyes: EyeLayout,
    turn: Turn,
    part: Option<SpherePart>,
    stretch_to_full_range: bool,
    /// Of the pack.
    colour: Colour,
    jobs: usize,
}

impl Cutter {
    pub(super) fn new(plan: &PreparationPlan) -> Self {
        let face = plan.grid.surface.size[0];
        let left = plan.source_chroma_left;
        let surface = plan.grid.surface;
        let turn = match (plan.surround, surface.projection) {
            (Surround::Flat, _) | (Surround::Equirect(Coverage::Full), Projection::Equirect) => {
                Turn::Flat
            }
            (Surround::Equirect(Coverage::FrontHalf), Projection::Equirect) => {
                // Even, so that chroma stays on its luma.
                let at = plan.eye_size[0] / 4 * 2;
                Turn::Half(SpherePart {
                    whole: surface.size,
                    at: [at, 0],
                })
            }
            (Surround::Cube(layout), Projection::Equirect) => {
                Turn::Unfolded(layout, left, surface.size)
            }
            (Surround::Equirect(coverage), _) => {
                let sampler = CubeSampler::new(plan.eye_size, face, coverage, left)
                    .mapped(plan.grid.surface.mapping);
                Turn::Sphere(Box::new(match plan.speed {
                    Speed::Default | Speed::Fast | Speed::Small => sampler.fast(),
                    Speed::Reference => sampler,
                }))
            }
            (Surround::Cube(layout), _) => Turn::Cube(layout, left),
        };
        Self {
            grid: plan.grid,
            eyes: plan.eyes,
            turn,
            part: plan.part,
            stretch_to_full_range: plan.stretch_to_full_range,
            colour: plan.description.colour,
            jobs: plan.jobs,
        }
    }

    /// The tiles of one frame: by level, by rank.
    pub(super) fn tiles_of(&self, picture: &Picture) -> Vec<Vec<Picture>> {
        let eyes = self.eyes_of(picture);
        let faces = self.faces_of(&eyes);
        match self.grid.cut {
            Cut::Tile(_) => self.cut_pyramid(faces),
            Cut::Grid(_) => self.cut_grid(&faces),
        }
    }

    /// Some tiles of the finest level, of each as much as is asked for.
    pub(super) fn parts(&self, picture: &Picture, tiles: &[(Tile, [u32; 2])]) -> Vec<Picture> {
        let eyes = self.eyes_of(picture);
        let faces = self.faces_of(&eyes);
        let part = |(tile, size): &(Tile, [u32; 2])| {
            faces[usize::from(tile.face)].crop(self.grid.origin(*tile), *size)
        };
        tiles.iter().map(part).collect()
    }

    /// What each eye is shown, in the range of the pack.
    fn eyes_of<'a>(&self, picture: &'a Picture) -> Cow<'a, [Picture]> {
        let eyes = match self.stretch_to_full_range {
            true => Cow::Owned(self.eyes.split(&full_range(picture)).into_owned()),
            false => self.eyes.split(picture),
        };
        match self.part {
            Some(part) => {
                let whole = eyes.iter().map(|eye| part.whole_of(eye, self.black()));
                Cow::Owned(whole.collect())
            }
            None => eyes,
        }
    }

    /// The faces of all eyes, the left eye's first.
    fn faces_of<'a>(&self, eyes: &'a [Picture]) -> Cow<'a, [Picture]> {
        match &self.turn {
            Turn::Flat => Cow::Borrowed(eyes),
            Turn::Sphere(sampler) => {
                let cubes = eyes
                    .iter()
                    .map(|eye| sampler.cube_from_equirect(eye, self.jobs));
                cubes.flatten().collect()
            }
            Turn::Cube(layout, left) => eyes
                .iter()
                .flat_map(|eye| layout.split(eye, *left))
                .collect(),
            Turn::Half(part) => eyes
                .iter()
                .map(|eye| part.whole_of(eye, self.black()))
                .collect(),
            Turn::Unfolded(layout, left, size) => eyes
                .iter()
                .map(|eye| self.unfolded(layout.split(eye, *left), *left, *size))
                .collect(),
        }
    }

    fn black(&self) -> u8 {
        if self.colour.full_range { 0 } else { 16 }
    }

    /// The sphere that these faces show; black where there are none.
    fn unfolded(&self, faces: Vec<Picture>, chroma_left: bool, size: [u32; 2]) -> Picture {
        let [w, h] = [faces[0].width, faces[0].height];
        let mut faces = faces.into_iter();
        let cube = [(); 6].map(|()| match faces.next() {
            Some(face) if chroma_left => between_luma(face),
            Some(face) => face,
            None => Picture::filled(w, h, [self.black(), 128, 128]),
        });
        equirect_from_cube(&cube, size, self.jobs)
    }

    /// Whole faces are halved, then every level is cut.
    fn cut_pyramid(&self, mut faces: Cow<'_, [Picture]>) -> Vec<Vec<Picture>> {
        let mut levels = Vec::new();
        for level in 0..self.grid.levels {
            if level > 0 {
                let halve = match self.grid.surface.is_of_planes() {
                    true => halve_all,
                    false => halve_spheres,
                };
                faces = halve(&faces, self.grid.ratio, self.colour, self.jobs).into();
            }
            let scale = self.grid.scale(level);
            let count = self.grid.tiles_in_level(level);
            levels.push(in_parallel(self.jobs, count as usize, |rank| {
                let tile = self.grid.tile_at(level, rank as u32);
                let corner = self.grid.origin(tile).map(|side| side / scale);
                faces[usize::from(tile.face)].crop(corner, self.grid.tile_size(tile))
            }));
        }
        levels
    }

    /// The same cells at every level: cells are cut, then each is halved by itself. Where a coarse
    /// texel sticks out of its cell it averages what lies there in the picture.
    fn cut_grid(&self, faces: &[Picture]) -> Vec<Vec<Picture>> {
        let grid = &self.grid;
        let widest = grid.scale(grid.coarsest());
        let whole_texels = |tile: Tile| {
            let size = grid.covered(tile).map(|side| side.next_multiple_of(widest));
            faces[usize::from(tile.face)].crop(grid.origin(tile), size)
        };
        let mut cells: Vec<Picture> = grid.tiles_of(0).map(whole_texels).collect();
        let mut levels = Vec::new();
        for level in 0..grid.levels {
            if level > 0 {
                let finer = &cells;
                let halved = |cell: usize| halve(&finer[cell], grid.ratio, self.colour);
                cells = in_parallel(self.jobs, finer.len(), halved);
            }
            let fit = |(tile, cell): (Tile, &Picture)| cell.crop([0, 0], grid.tile_size(tile));
            levels.push(grid.tiles_of(level).zip(&cells).map(fit).collect());
        }
        levels
    }
}

/// The picture with chroma between its luma samples, which lay on the left one of each pair.
fn between_luma(mut picture: Picture) -> Picture {
    let width = picture.plane_size(1)[0] as usize;
    for plane in &mut picture.planes[1..] {
        for row in plane.chunks_exact_mut(width) {
            for x in 0..width - 1 {
                let sum = 3 * u16::from(row[x]) + u16::from(row[x + 1]);
                row[x] = ((sum + 2) / 4) as u8;
            }
        }
    }
    picture
}

/// Limited-range planes (Y 16–235, chroma 16–240) as full-range ones (0–255).
fn full_range(picture: &Picture) -> Picture {
    let stretch = |from: i32, middle: i32, span: i32| {
        let mut table = [0; 256];
        for (value, out) in (0..).zip(table.iter_mut()) {
            let scaled = (value - from) * 255 * 2 + (value - from).signum() * span;
            *out = (scaled / (2 * span) + middle).clamp(0, 255) as u8;
        }
        table
    };
    let (luma, chroma) = (stretch(16, 0, 219), stretch(128, 128, 224));
    let mut picture = picture.clone();
    for (p, plane) in picture.planes.iter_mut().enumerate() {
        let table = if p == 0 { &luma } else { &chroma };
        plane
            .iter_mut()
            .for_each(|sample| *sample = table[usize::from(*sample)]);
    }
    picture
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretching_maps_the_limits_of_the_range_to_0_and_255() {
        for (limited, full) in [
            ([16, 128, 128], [0, 128, 128]),
            ([235, 240, 16], [255, 255, 1]),
        ] {
            let stretched = full_range(&Picture::filled(2, 2, limited));
            let found = [0, 1, 2].map(|p| stretched.planes[p][0]);
            for (found, full) in found.into_iter().zip(full) {
                assert!(
                    found.abs_diff(full) <= 1,
                    "{limited:?} gave {found}, not {full}"
                );
            }
        }
    }
}
