//! How much contrast does a unit add to the clusters that it replaces?
//!
//! Both are drawn from the six sides of the object's space by a small rasteriser whose arithmetic
//! is the same on every machine, and compared octave by octave, as tiles of video are.

mod lit;
mod side_view;

use foveal_core::content::mesh::payload::MeshVertex;
use foveal_core::content::scene::description::SceneObject;
use foveal_core::content::scene::lighting::LAMP_DIRECTION;
use foveal_core::perception::measures::contrast::Signature;
use foveal_core::perception::measures::step_contrast::StepContrast;
use glam::DVec3;
use lit::{LitSurface, LitTriangle};
use side_view::{FARTHEST, Raster, Side, Window};

/// Most pixels of all sides together that are drawn whole; of what is larger there are samples.
const MOST_WHOLE: i64 = 6 * 32 * 32;
/// Number of samples of all sides together, about.
const SAMPLES: i64 = 12;
/// Pixels along the sides of a sample.
const SAMPLE_SIDE: u32 = 24;
/// Pixels round what is drawn whole, so that filters do not reach over the border.
const MARGIN: u32 = 4;
/// Least side of a picture, so that it has all octaves of a signature.
const LEAST_SIDE: u32 = 16;

/// Measures the steps of one object.
pub(crate) struct StepMeasure {
    surface: LitSurface,
    step: f64,
}

impl StepMeasure {
    pub(crate) fn new(object: &SceneObject, light: DVec3) -> Self {
        Self {
            surface: LitSurface::new(object, light),
            step: object.grid.step,
        }
    }

    /// What triangles add to those in whose place they are shown, with pixels so wide in the
    /// object's space. Takes about as long whatever their number is.
    pub(crate) fn signature(&self, step: [&[[MeshVertex; 3]]; 2], pixel: f64) -> Signature {
        let lit = |triangles: &[[MeshVertex; 3]]| -> Vec<LitTriangle> {
            let triangles = triangles.iter();
            triangles.map(|it| self.surface.triangle(it)).collect()
        };
        let step = step.map(lit);
        let extent = Extent::of(&step);
        let raster = extent.raster(&self.surface, pixel / self.step);
        let windows = extent.whole(&raster);
        let windows = windows.unwrap_or_else(|| samples(&step[1], &raster));
        let mut contrast = StepContrast::default();
        for (side, window) in windows {
            let pictures = step.each_ref().map(|it| raster.picture(side, window, it));
            add(&mut contrast, &pictures, window.size);
        }
        contrast.signature()
    }
}

/// What is looked at, and from where.
type Windows = Vec<(Side, Window)>;

/// Samples in the middles of triangles, such that each stands for about as much of the area that is
/// seen from all sides together.
fn samples(triangles: &[LitTriangle], raster: &Raster<'_>) -> Windows {
    let area = |side: Side, it| side.area(raster.surface, it);
    let of_side = |side| triangles.iter().map(|it| area(side, it)).sum::<i64>();
    let areas = Side::ALL.map(of_side);
    let all = areas.iter().sum::<i64>().max(1);
    let mut windows = Vec::new();
    for (side, of_side) in Side::ALL.into_iter().zip(areas) {
        let count = (2 * SAMPLES * of_side + all) / (2 * all);
        let (mut before, mut number) = (0, 0);
        for triangle in triangles {
            before += area(side, triangle);
            // Systematic sampling: in the middle of each of so many equal parts.
            while number < count && before * 2 * count > of_side * (2 * number + 1) {
                let middle = raster.pixel(side, triangle);
                let low = middle.map(|it| it - i64::from(SAMPLE_SIDE / 2));
                let size = [SAMPLE_SIDE; 2];
                windows.push((side, Window { low, size }));
                number += 1;
            }
        }
    }
    windows
}

/// Where triangles lie on the grid: the least and the most along each axis.
struct Extent([[i64; 2]; 3]);

impl Extent {
    fn of(step: &[Vec<LitTriangle>; 2]) -> Self {
        let mut extent = [[i64::MAX, i64::MIN]; 3];
        for place in step.iter().flatten().flat_map(|it| it.places) {
            for ([low, high], at) in extent.iter_mut().zip(place) {
                (*low, *high) = (at.min(*low), at.max(*high));
            }
        }
        let is_empty = step.iter().all(Vec::is_empty);
        Self(if is_empty { [[0; 2]; 3] } else { extent })
    }

    fn along(&self, axis: usize) -> f64 {
        let [low, high] = self.0[axis];
        (high - low) as f64
    }

    /// Pixels so many steps of the grid wide; wider ones where they would be too many.
    fn raster<'a>(&self, surface: &'a LitSurface, pixel: f64) -> Raster<'a> {
        let longest = [0, 1, 2].map(|axis| self.along(axis));
        let longest = longest.into_iter().fold(1.0, f64::max);
        Raster {
            surface,
            middle: self.0.map(|[low, high]| (low + high) as f64 / 2.0),
            pixels_per_step: 1.0 / pixel.max(longest / FARTHEST),
        }
    }

    /// What shows all from all sides; none where that is large.
    fn whole(&self, raster: &Raster<'_>) -> Option<Windows> {
        let pixels =
            [0, 1, 2].map(|axis| (self.along(axis) * raster.pixels_per_step).ceil() as i64);
        let of_sides = Side::ALL.map(|side| side.across().map(|axis| pixels[axis]));
        let all: i64 = of_sides.iter().map(|[columns, rows]| columns * rows).sum();
        let window = |pixels: [i64; 2]| {
            let size =
                pixels.map(|it| (it as u32 + 2 * MARGIN).max(LEAST_SIDE).next_multiple_of(8));
            let low = size.map(|it| -i64::from(it / 2));
            Window { low, size }
        };
        let windows = Side::ALL.into_iter().zip(of_sides);
        let windows = windows.map(|(side, pixels)| (side, window(pixels)));
        (all <= MOST_WHOLE).then(|| windows.collect())
    }
}

/// What is seen of triangles from a side of their object.
#[derive(Clone, Debug)]
pub struct SideLook {
    /// The axes of the object to the right and upwards; right times up is towards the eye.
    pub across: [usize; 2],
    /// The place in the middle of the picture, on the grid.
    pub middle: [f64; 3],
    /// Columns and rows.
    pub size: [u32; 2],
    /// Luminance on the default display in cd/m², the lowest row first; 0 where nothing is.
    pub luminance: Vec<f64>,
}

/// Triangles of an object as they are drawn to be measured, from all six sides, with pixels so wide
/// in the object's space; none where that is more than some thousand pixels.
#[must_use]
pub fn side_looks(
    object: &SceneObject,
    triangles: &[[MeshVertex; 3]],
    pixel: f64,
) -> Vec<SideLook> {
    let surface = LitSurface::new(object, LAMP_DIRECTION);
    let triangles = triangles.iter().map(|it| surface.triangle(it)).collect();
    let step = [Vec::new(), triangles];
    let extent = Extent::of(&step);
    let raster = extent.raster(&surface, pixel / object.grid.step);
    let windows = extent.whole(&raster).unwrap_or_default().into_iter();
    let looks = windows.map(|(side, window)| SideLook {
        across: side.across(),
        middle: raster.middle,
        size: window.size,
        luminance: raster.picture(side, window, &step[1]),
    });
    looks.collect()
}

/// Adds the contrasts of a step as seen from a side. Where nothing is drawn stands the mean of what
/// is, so that the border of a group adds as little as it can.
fn add(contrast: &mut StepContrast, pictures: &[Vec<f64>; 2], size: [u32; 2]) {
    let drawn = pictures.iter().flatten().filter(|it| **it > 0.0);
    let (sum, count) = drawn.fold((0.0, 0_u32), |(sum, count), it| (sum + it, count + 1));
    if count == 0 {
        return;
    }
    let mean = sum / f64::from(count);
    let covered = pictures[0].iter().zip(&pictures[1]);
    let covered = covered.map(|(before, after)| before.max(*after) > 0.0);
    let counts = widened(&covered.collect::<Vec<_>>(), size);
    let filled = |it: &Vec<f64>| {
        let pixels = it.iter();
        pixels
            .map(|it| if *it > 0.0 { *it } else { mean })
            .collect()
    };
    contrast.add(pictures.each_ref().map(filled), counts, size);
}

/// The pixels that are covered, and those next to such.
fn widened(covered: &[bool], size: [u32; 2]) -> Vec<bool> {
    let columns = size[0] as usize;
    let mut across = covered.to_vec();
    for (row, widened) in covered.chunks(columns).zip(across.chunks_mut(columns)) {
        for x in 1..columns {
            widened[x] |= row[x - 1];
            widened[x - 1] |= row[x];
        }
    }
    let mut both = across.clone();
    for k in columns..covered.len() {
        both[k] |= across[k - columns];
        both[k - columns] |= across[k];
    }
    both
}
