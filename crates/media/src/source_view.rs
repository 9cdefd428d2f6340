//! What does a view show of the source itself?
//!
//! The source's pixels are resampled once, by the view, and never by way of a pack's faces: it is
//! what packs are judged against. Luma goes through the interpolating cubic of Catmull and Rom, as
//! a picture that is enlarged by a good viewer does; chroma, which has half the samples, through a
//! triangle, as it is drawn. Both widen, along each axis of the source, where that is denser than
//! the view.

mod chart;

use crate::parallel::in_parallel;
use crate::prepare::{PreparationPlan, Surround};
use crate::read::source::SourceInfo;
use crate::sphere::catmull_rom;
use crate::surround::eye_layout::EyeLayout;
use crate::surround::sphere_part::SpherePart;
use chart::{Chart, Spot};
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::picture::{Colour, Picture};
use foveal_core::view::surface::{Eye, Screen, Surface};
use std::borrow::Cow;

/// How the pictures of a source lie before the eyes.
#[derive(Clone, Copy, Debug)]
pub struct SourceView {
    surround: Surround,
    /// Where a picture of a part of a sphere lies on the whole.
    part: Option<SpherePart>,
    eyes: EyeLayout,
    surface: Surface,
    colour: Colour,
}

/// A picture of a source, ready to be looked at.
pub struct SourcePicture<'a> {
    source: SourceView,
    /// The pictures of the left eye, then those of the right: one each, or the faces of a cube.
    pictures: Cow<'a, [Picture]>,
}

/// How much a sample counts by its distance.
struct Kernel {
    at: fn(f64) -> f64,
    /// Distance from which nothing counts.
    reach: f64,
}

const LUMA: Kernel = Kernel {
    at: catmull_rom,
    reach: 2.0,
};
const CHROMA: Kernel = Kernel {
    at: |x| (1.0 - x.abs()).max(0.0),
    reach: 1.0,
};

impl SourceView {
    /// Of a source that would be prepared as planned; flat content fills `screen`.
    #[must_use]
    pub fn new(plan: &PreparationPlan, info: &SourceInfo, screen: Screen) -> Self {
        Self {
            surround: plan.surround,
            part: plan.part,
            eyes: plan.eyes,
            surface: plan.source_surface(screen),
            colour: info.colour,
        }
    }

    /// A decoded picture of this source.
    #[must_use]
    pub fn of<'a>(&self, picture: &'a Picture) -> SourcePicture<'a> {
        let mut eyes = self.eyes.split(picture);
        if let Some(part) = self.part {
            let black = if self.colour.full_range { 0 } else { 16 };
            let whole = eyes.iter().map(|eye| part.whole_of(eye, black));
            eyes = Cow::Owned(whole.collect());
        }
        let pictures = match self.surround {
            Surround::Cube(layout) => eyes
                .iter()
                .flat_map(|eye| layout.split(eye, self.colour.chroma_left))
                .collect(),
            Surround::Flat | Surround::Equirect(_) => eyes,
        };
        SourcePicture {
            source: *self,
            pictures,
        }
    }
}

impl SourcePicture<'_> {
    /// What a view shows of it: red, green and blue of every pixel, rows from the top, the same for
    /// any number of threads `jobs`. Black where there is nothing.
    #[must_use]
    pub fn seen(&self, view: &EyeView, jobs: usize) -> Vec<u8> {
        let SourceView {
            surround, surface, ..
        } = self.source;
        let each = self.pictures.len() / usize::from(self.source.eyes.eyes());
        let first = match view.eye {
            Eye::Right if each < self.pictures.len() => each,
            _ => 0,
        };
        let pictures = &self.pictures[first..first + each];
        let size = [pictures[0].width, pictures[0].height];
        let look = Look {
            pictures,
            chart: Chart::new(surround, surface, size, view),
            chroma_left: self.source.colour.chroma_left,
            rgb_from_yuv: self.source.colour.rgb_from_yuv(),
        };
        in_parallel(jobs, view.size[1] as usize, |y| {
            look.row(y, view.size[0] as usize)
        })
        .concat()
    }
}

/// One eye's look through a view.
struct Look<'a> {
    pictures: &'a [Picture],
    chart: Chart,
    chroma_left: bool,
    rgb_from_yuv: [[f32; 4]; 3],
}

impl Look<'_> {
    fn row(&self, y: usize, width: usize) -> Vec<u8> {
        let mut taps = [Taps::default(), Taps::default()];
        let pixels = (0..width).flat_map(|x| {
            let spot = self.chart.spot([x as f64 + 0.5, y as f64 + 0.5]);
            spot.map_or([0; 3], |spot| self.rgb(&spot, &mut taps))
        });
        pixels.collect()
    }

    fn rgb(&self, spot: &Spot, taps: &mut [Taps; 2]) -> [u8; 3] {
        let mut codes = [0.0; 3];
        for (p, code) in codes.iter_mut().enumerate() {
            // The taps of U are those of V.
            if p < 2 {
                self.weigh(spot, p, taps);
            }
            *code = self.sum(spot.face, p, taps) / 255.0;
        }
        let [luma, u, v] = codes;
        let rgb = self
            .rgb_from_yuv
            .map(|r| r[0] * luma + r[1] * u + r[2] * v + r[3]);
        rgb.map(|c| (c.clamp(0.0, 1.0) * 255.0 + 0.5) as u8)
    }

    /// The samples of a plane round a spot.
    fn weigh(&self, spot: &Spot, p: usize, taps: &mut [Taps; 2]) {
        let (kernel, pitch) = if p == 0 { (LUMA, 1.0) } else { (CHROMA, 2.0) };
        let first = first_sample(p, self.chroma_left);
        for (k, taps) in taps.iter_mut().enumerate() {
            let place = (spot.place[k] - first[k]) / pitch;
            taps.weigh(&kernel, place, (spot.stretch[k] / pitch).max(1.0));
        }
    }

    fn sum(&self, face: usize, p: usize, [columns, rows]: &[Taps; 2]) -> f32 {
        let picture = &self.pictures[face];
        let [w, h] = picture.plane_size(p).map(|side| side as usize);
        let mut sum = 0.0;
        if let (Some(columns_at), Some(rows_at)) = (columns.within(w), rows.within(h)) {
            for (row, weight) in (rows_at..).zip(&rows.weights) {
                let samples = &picture.planes[p][row * w + columns_at..];
                let pairs = samples.iter().zip(&columns.weights);
                sum += weight * pairs.map(|(s, w)| f32::from(*s) * w).sum::<f32>();
            }
            return sum;
        }
        for (row, weight) in (rows.first..).zip(&rows.weights) {
            let across = (columns.first..).zip(&columns.weights);
            let across = across.map(|(column, w)| w * self.sample(face, p, [column, row]));
            sum += weight * across.sum::<f32>();
        }
        sum
    }

    /// A sample of a plane, or what lies where it would, beyond the border.
    fn sample(&self, face: usize, p: usize, at: [i64; 2]) -> f32 {
        let size = self.pictures[face].plane_size(p).map(i64::from);
        if (0..2).all(|k| (0..size[k]).contains(&at[k])) {
            return self.code(face, p, at);
        }
        let first = first_sample(p, self.chroma_left);
        let pitch = if p == 0 { 1.0 } else { 2.0 };
        let place = [0, 1].map(|k| at[k] as f64 * pitch + first[k]);
        match self.chart.beyond(face, place) {
            // On another face samples lie elsewhere: between four.
            Some((beside, place)) => {
                let place = [0, 1].map(|k| (place[k] - first[k]) / pitch);
                let low = place.map(f64::floor);
                let [x, y] = [0, 1].map(|k| (place[k] - low[k]) as f32);
                let [i, j] = low.map(|k| k as i64);
                let upper =
                    self.code(beside, p, [i, j]) * (1.0 - x) + self.code(beside, p, [i + 1, j]) * x;
                let lower = self.code(beside, p, [i, j + 1]) * (1.0 - x)
                    + self.code(beside, p, [i + 1, j + 1]) * x;
                upper * (1.0 - y) + lower * y
            }
            None => self.code(face, p, self.chart.folded(at, size)),
        }
    }

    /// The sample of a plane that is nearest to a column and row.
    fn code(&self, face: usize, p: usize, at: [i64; 2]) -> f32 {
        let picture = &self.pictures[face];
        let size = picture.plane_size(p);
        let [x, y] = [0, 1].map(|k| at[k].clamp(0, i64::from(size[k]) - 1) as usize);
        f32::from(picture.planes[p][y * size[0] as usize + x])
    }
}

/// Where the first sample of a plane lies, in luma pixels from the left and top border.
fn first_sample(p: usize, chroma_left: bool) -> [f64; 2] {
    match (p, chroma_left) {
        (0, _) => [0.5, 0.5],
        (_, true) => [0.5, 1.0],
        (_, false) => [1.0, 1.0],
    }
}

/// Weights of the samples round a place on one axis; kept to reuse the memory.
#[derive(Default)]
struct Taps {
    first: i64,
    weights: Vec<f32>,
}

impl Taps {
    /// Weights for a kernel that is `stretch` samples wide a unit, of sum one.
    fn weigh(&mut self, kernel: &Kernel, place: f64, stretch: f64) {
        let reach = kernel.reach * stretch;
        // The ends of a kernel have no weight.
        let (first, last) = ((place - reach).floor() + 1.0, (place + reach).ceil() - 1.0);
        self.first = first as i64;
        let at = |tap: i64| (kernel.at)((tap as f64 - place) / stretch);
        let taps = self.first..=last as i64;
        let sum: f64 = taps.clone().map(at).sum();
        self.weights.clear();
        self.weights.extend(taps.map(|tap| (at(tap) / sum) as f32));
    }

    /// The first sample, where all lie within the first `count`.
    fn within(&self, count: usize) -> Option<usize> {
        let first = usize::try_from(self.first).ok()?;
        (first + self.weights.len() <= count).then_some(first)
    }
}

#[cfg(test)]
mod tests;
