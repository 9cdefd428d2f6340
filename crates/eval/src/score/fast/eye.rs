//! Where in the table of sensitivities does each pixel of a row look?

use super::math::{atan, split};
use crate::score::geometry::{Geometry, Tangents};
use crate::score::rules::GeometryRule;
use crate::score::sensitivity::LogSensitivityTable;
use crate::score::viewing::Viewing;
use rayon::prelude::*;
use std::f32::consts::FRAC_PI_2;

/// Entries of the table of octaves that eccentricity raises, over the root of degrees.
const RAISED: usize = 1024;
/// Root of the largest eccentricity, 180°.
const MOST_ROOT: f64 = 13.416_407_864_998_739;

/// The table in single precision, and how numbers become places in it.
pub(in crate::score) struct Table {
    /// Log2 of sustained and transient sensitivity, in turn.
    pub(in crate::score) entries: Vec<f32>,
    pub(in crate::score) luminances: usize,
    pub(in crate::score) frequencies: usize,
    /// Places a unit, and the place of 0: of log2 of luminance.
    pub(in crate::score) luminance: [f32; 2],
    pub(in crate::score) most_luminance: f32,
    pub(in crate::score) most_frequency: f32,
    /// Places a root of degrees; 0 where eccentricity has no axis.
    pub(in crate::score) root: f32,
    pub(in crate::score) most_root: f32,
    /// Places that eccentricity raises frequency by, over [`RAISED`] entries; empty where it has an
    /// axis.
    pub(in crate::score) raised: Vec<f32>,
}

impl Table {
    pub(in crate::score) fn new(table: &LogSensitivityTable) -> Self {
        let scale = |axis: &crate::score::sensitivity::Axis| {
            (axis.entries - 1) as f64 / (axis.range[1] - axis.range[0])
        };
        let luminance = scale(&table.luminance);
        let last = |entries: usize| (entries - 1) as f32;
        let (root, most_root, raised) = if table.has_eccentricity() {
            let axis = &table.eccentricity;
            (scale(axis), last(axis.entries), Vec::new())
        } else {
            let step = MOST_ROOT / (RAISED - 1) as f64;
            let places = |entry: usize| {
                let root = entry as f64 * step;
                (table.raised(root * root) * scale(&table.frequency)) as f32
            };
            (1.0 / step, last(RAISED), (0..RAISED).map(places).collect())
        };
        Self {
            entries: table
                .entries
                .iter()
                .flatten()
                .map(|log2| *log2 as f32)
                .collect(),
            luminances: table.luminance.entries,
            frequencies: table.frequency.entries,
            luminance: [luminance, -table.luminance.range[0] * luminance].map(|v| v as f32),
            most_luminance: last(table.luminance.entries),
            most_frequency: last(table.frequency.entries),
            root: root as f32,
            most_root,
            raised,
        }
    }

    /// The place of a log2 of luminance.
    #[inline(always)]
    pub(in crate::score) fn across(&self, log2: f32) -> (u32, f32) {
        split((log2 * self.luminance[0] + self.luminance[1]).clamp(0.0, self.most_luminance))
    }

    /// The place of degrees of eccentricity.
    #[inline(always)]
    pub(in crate::score) fn deep(&self, eccentricity_deg: f32) -> (u32, f32) {
        split((eccentricity_deg.sqrt() * self.root).min(self.most_root))
    }
}

/// What one band knows of its pixels that does not change with the gaze.
pub(in crate::score) struct BandEye {
    pub(in crate::score) size: [usize; 2],
    /// Tangents, or angles in degrees, of columns and of rows.
    pub(in crate::score) axes: [Vec<f32>; 2],
    /// Places of frequency in the table, not clamped; one for all without a gaze.
    pub(in crate::score) frequency: Vec<f32>,
    rule: GeometryRule,
    foveated: bool,
}

/// A gaze, as a band's rows are compared with it.
#[derive(Clone, Copy)]
pub(in crate::score) struct GazeRay {
    /// Tangents, or angles in degrees.
    pub(in crate::score) place: [f32; 2],
    /// Length of the ray.
    pub(in crate::score) length: f32,
}

impl BandEye {
    pub(in crate::score) fn new(
        viewing: &Viewing,
        geometry: &Geometry,
        table: &LogSensitivityTable,
        cpd: f64,
        size: [usize; 2],
    ) -> Self {
        let rule = viewing.rules.geometry;
        let tangents = [0, 1].map(|axis| -> Vec<f64> {
            let all = 0..size[axis];
            all.map(|index| geometry.tangent(axis, index, size[axis]))
                .collect()
        });
        let axis = &table.frequency;
        let scale = (axis.entries - 1) as f64 / (axis.range[1] - axis.range[0]);
        let place =
            |magnification: f64| (((cpd * magnification).log2() - axis.range[0]) * scale) as f32;
        let frequency = if viewing.foveated {
            let row = |y: usize| -> Vec<f32> {
                let down = tangents[1][y];
                let at = |across: &f64| place(geometry.magnification([*across, down]));
                tangents[0].iter().map(at).collect()
            };
            (0..size[1]).into_par_iter().flat_map_iter(row).collect()
        } else {
            vec![place(1.0)]
        };
        Self {
            size,
            axes: tangents.map(|axis| axis.iter().map(|t| on_axis(rule, *t)).collect()),
            frequency,
            rule,
            foveated: viewing.foveated,
        }
    }

    pub(in crate::score) fn looking(&self, gaze: Tangents) -> GazeRay {
        GazeRay {
            place: gaze.map(|tangent| on_axis(self.rule, tangent)),
            length: (1.0 + gaze[0] * gaze[0] + gaze[1] * gaze[1]).sqrt() as f32,
        }
    }

    /// Degrees from the gaze of every pixel of a row; 0 where there is no gaze.
    #[inline(always)]
    pub(in crate::score) fn eccentricities(&self, y: usize, looking: &GazeRay, out: &mut [f32]) {
        let GazeRay { place, length } = *looking;
        let (row, columns) = (self.axes[1][y], &self.axes[0][..out.len()]);
        if !self.foveated {
            out.fill(0.0);
            return;
        }
        let down = row - place[1];
        match self.rule {
            GeometryRule::Stretched => {
                for (out, column) in out.iter_mut().zip(columns) {
                    let across = column - place[0];
                    *out = (across * across + down * down).sqrt();
                }
            }
            GeometryRule::TrueRays => {
                for (out, &column) in out.iter_mut().zip(columns) {
                    let across = column - place[0];
                    let turned = across * place[1] - down * place[0];
                    let cross = (across * across + down * down + turned * turned).sqrt();
                    let dot = 1.0 + column * place[0] + row * place[1];
                    let far = (1.0 + column * column + row * row).sqrt() * length;
                    // Tangent of half of the angle, which is above 1 beyond a right angle.
                    let ahead = far + dot;
                    let half = atan(cross.min(ahead) / cross.max(ahead));
                    let half = if cross > ahead {
                        FRAC_PI_2 - half
                    } else {
                        half
                    };
                    *out = 2.0 * half.to_degrees();
                }
            }
        }
    }

    /// Places of frequency in the table, of a row.
    #[inline(always)]
    pub(in crate::score) fn frequencies(&self, y: usize, out: &mut [f32]) {
        match self.frequency.as_slice() {
            [same] => out.fill(*same),
            all => out.copy_from_slice(&all[y * self.size[0]..][..out.len()]),
        }
    }
}

fn on_axis(rule: GeometryRule, tangent: f64) -> f32 {
    match rule {
        GeometryRule::Stretched => tangent.atan().to_degrees() as f32,
        GeometryRule::TrueRays => tangent as f32,
    }
}
