//! How strongly does the eye see each band, everywhere in a view, asked at every decision?
//!
//! What depends on the gaze changes slowly across the picture: it is looked up in tables at every
//! [`SPACING`]th pixel and interpolated between.

use crate::perception::acuity::{Meridian, watson_spacing};
use crate::perception::gain::Weights;
use crate::perception::importance::Onlooker;
use crate::perception::measures::pyramid::band_gain;
use crate::perception::parameters::{EyeState, Model, Parameters};
use crate::perception::sensitivity_table::SensitivityTable;
use crate::perception::spread::effective_eccentricity;
use crate::units::Radians;
use crate::view::axes::{Axes, yaw_pitch_from_direction};
use crate::view::eye_view::EyeView;
use core::f64::consts::PI;
use core::ops::Range;
use glam::DVec3;

/// Pixels between nodes, a power of two.
pub(super) const SPACING: usize = 8;
/// Entries of the tables over angles.
const ANGLES: usize = 1024;

/// What does not change with the gaze at one node.
#[derive(Clone, Copy)]
struct Node {
    direction: [f32; 3],
    /// Log2 of pixels per degree.
    density: f32,
}

/// What the eye resolves at one node.
#[derive(Clone, Copy, Default)]
struct Resolved {
    /// Log2 of the highest frequency.
    limit: f32,
    /// Octaves that eccentricity raises frequency by.
    raised: f32,
    /// That eccentricity, in radians.
    eccentricity: f32,
}

/// Sensitivities of one view for one gaze, at nodes.
pub(super) struct EyeField {
    parameters: Parameters,
    size: [usize; 2],
    nodes: Vec<Node>,
    resolved: Vec<Resolved>,
    /// Squared spacing of cells over the root of eccentricity, by meridian.
    spacing: Vec<[f32; 4]>,
    /// Octaves raised, sine, cosine and size of the effective eccentricity, over the root of the
    /// chord between gaze and direction.
    eccentricity: Vec<[f32; 4]>,
    spread: Option<Radians>,
    near: SensitivityTable,
    far: SensitivityTable,
    /// Log2 of the highest frequency that the display shows.
    display_limit: f32,
    /// By band: what turns a difference of levels into contrast.
    scales: Vec<f32>,
    looking: Option<Fixated>,
    /// Per band: weighed sustained and transient sensitivity at every node.
    pub(super) bands: Vec<[Vec<f32>; 2]>,
    /// Value of a pixel besides its bands, and the factor on all of it.
    pub(super) whole: [Vec<f32>; 2],
}

impl EyeField {
    pub(super) fn new(parameters: &Parameters, view: &EyeView, bands: usize) -> Self {
        let size = view.size.map(|side| (side as usize).div_ceil(SPACING) + 1);
        let count = size[0] * size[1];
        let plane = || vec![0.0; count];
        Self {
            parameters: parameters.clone(),
            size,
            nodes: nodes(view, size),
            resolved: vec![Resolved::default(); count],
            spacing: spacing_table(),
            eccentricity: vec![[0.0; 4]; ANGLES + 1],
            spread: None,
            looking: None,
            near: SensitivityTable::new(parameters, EyeState::Steady),
            far: SensitivityTable::new(parameters, EyeState::Jumping),
            display_limit: libm::log2(parameters.display_limit().0) as f32,
            scales: (0..bands)
                .map(|band| (1.0 / band_gain(band)) as f32)
                .collect(),
            bands: (0..bands).map(|_| [plane(), plane()]).collect(),
            whole: [plane(), plane()],
        }
    }

    /// Nodes in a row of nodes, and rows of nodes.
    pub(super) fn size(&self) -> [usize; 2] {
        self.size
    }

    /// Looks somewhere else.
    pub(super) fn look(&mut self, onlooker: &Onlooker, weights: &Weights) {
        if self.spread != Some(onlooker.gaze.spread) {
            self.fill_eccentricities(onlooker.gaze.spread);
        }
        let looking = Fixated::new(onlooker, weights);
        self.looking = Some(looking);
        if looking.gaze_counts() {
            for i in 0..self.nodes.len() {
                self.resolved[i] = self.resolve(&looking, self.nodes[i].direction);
            }
        }
        for band in 0..self.bands.len() {
            self.fill_band(band, &looking);
        }
        for i in 0..self.nodes.len() {
            let whole = looking.whole(&self.nodes[i], &self.resolved[i]);
            self.whole[0][i] = whole[0];
            self.whole[1][i] = whole[1];
        }
    }

    /// Texels of a row of a band that are so near the gaze that nothing is interpolated.
    pub(super) fn near_gaze(&self, band: usize, y: usize, width: usize) -> Range<usize> {
        let side = libm::ldexp(1.0, band as i32);
        let looking = self.looking.as_ref();
        looking.map_or(0..0, |looking| {
            looking.texels_near_gaze(side, (y as f64 + 0.5) * side, width)
        })
    }

    /// Puts what is exact in place of what lies between nodes along a row of a band, where the gaze
    /// makes it curve.
    pub(super) fn refine_row(
        &self,
        band: usize,
        y: usize,
        near: Range<usize>,
        rows: &mut [Vec<f32>; 2],
    ) {
        let Some(looking) = &self.looking else { return };
        let side = libm::ldexp(1.0, band as i32);
        for x in near {
            let node = looking.node([(x as f64 + 0.5) * side, (y as f64 + 0.5) * side]);
            let seen = self.seen(band, looking, &node, &self.resolve(looking, node.direction));
            rows[0][x] = seen[0];
            rows[1][x] = seen[1];
        }
    }

    /// The same for what pixels are worth besides their bands.
    pub(super) fn refine_whole(&self, y: usize, rows: &mut [Vec<f32>; 2]) {
        let Some(looking) = &self.looking else { return };
        if looking.weights.acuity == 0.0 {
            return;
        }
        let place_y = y as f64 + 0.5;
        for x in looking.texels_near_gaze(1.0, place_y, rows[0].len()) {
            let node = looking.node([x as f64 + 0.5, place_y]);
            let whole = looking.whole(&node, &self.resolve(looking, node.direction));
            rows[0][x] = whole[0];
            rows[1][x] = whole[1];
        }
    }

    fn fill_eccentricities(&mut self, spread: Radians) {
        self.spread = Some(spread);
        for (index, entry) in self.eccentricity.iter_mut().enumerate() {
            let root = index as f64 / ANGLES as f64;
            let apart = Radians(2.0 * libm::asin(root * root));
            let effective = effective_eccentricity(apart, spread);
            let angle = effective.0;
            let raised = self.parameters.octaves_raised(effective);
            *entry = [raised, libm::sin(angle), libm::cos(angle), angle].map(|v| v as f32);
        }
    }

    fn resolve(&self, looking: &Fixated, direction: [f32; 3]) -> Resolved {
        let apart = direction.iter().zip(looking.gaze);
        let chord2: f32 = apart.map(|(d, g)| (d - g) * (d - g)).sum();
        let root = (chord2.sqrt() * 0.5).sqrt();
        let [raised, sin, cos, angle] = interpolated(&self.eccentricity, root);
        let at = Offset {
            across: [dot(direction, looking.right), dot(direction, looking.up)],
            sin,
            cos,
            angle,
        };
        let limit = match &self.parameters.acuity {
            Some(measured) => {
                let acuity = measured.acuity(Radians(f64::from(angle)));
                libm::log2(acuity.0) as f32
            }
            None => at.log_acuity(&self.spacing, self.parameters.model),
        };
        Resolved {
            limit,
            raised,
            eccentricity: angle,
        }
    }

    fn fill_band(&mut self, band: usize, looking: &Fixated) {
        let size = self.size;
        let every = band_stride(band);
        for i in 0..self.nodes.len() {
            // Coarse bands look at the nodes in the middle of their texels alone.
            if every > 1
                && !(used(i % size[0], size[0], every) && used(i / size[0], size[1], every))
            {
                continue;
            }
            let seen = self.seen(band, looking, &self.nodes[i], &self.resolved[i]);
            self.bands[band][0][i] = seen[0];
            self.bands[band][1][i] = seen[1];
        }
    }

    /// Weighed sustained and transient sensitivity.
    fn seen(&self, band: usize, looking: &Fixated, node: &Node, resolved: &Resolved) -> [f32; 2] {
        let octaves = node.density - (band + 2) as f32;
        let [sustained, transient] = match looking.state {
            EyeState::Jumping => self.far.at(octaves, 0.0),
            _ => {
                let limit = resolved.limit.min(self.display_limit);
                let share = (limit - octaves + 0.5).clamp(0.0, 1.0);
                let near = self
                    .near
                    .at(octaves + resolved.raised, resolved.eccentricity);
                near.map(|s| s * share)
            }
        };
        let scale = self.scales[band];
        [
            sustained * scale * looking.weights.error as f32,
            transient * scale,
        ]
    }
}

/// Pixels from the gaze within which nothing is interpolated.
const EXACT_RADIUS: f64 = (6 * SPACING) as f64;

/// Who looks, as needed at every node.
#[derive(Clone, Copy)]
struct Fixated {
    onlooker: Onlooker,
    weights: Weights,
    state: EyeState,
    gaze: [f32; 3],
    right: [f32; 3],
    up: [f32; 3],
    /// The gaze in the picture.
    place: Option<[f64; 2]>,
}

impl Fixated {
    fn new(onlooker: &Onlooker, weights: &Weights) -> Self {
        let gaze = onlooker.gaze.direction;
        let (yaw, pitch) = yaw_pitch_from_direction(gaze);
        let eye = Axes::from_yaw_pitch_roll(yaw, pitch, Radians(0.0));
        let [gaze_f32, right, up] = [gaze, eye.right, -eye.down].map(to_f32);
        Self {
            onlooker: *onlooker,
            weights: *weights,
            state: onlooker.state,
            gaze: gaze_f32,
            right,
            up,
            place: onlooker.view.place(gaze),
        }
    }

    fn gaze_counts(&self) -> bool {
        self.state != EyeState::Jumping || self.weights.acuity != 0.0
    }

    fn node(&self, place: [f64; 2]) -> Node {
        let spot = self.onlooker.spot(place);
        Node {
            direction: to_f32(spot.direction),
            density: libm::log2f(spot.ppd.0 as f32),
        }
    }

    /// Value of a pixel besides its bands, and the factor on all of it.
    fn whole(&self, node: &Node, resolved: &Resolved) -> [f32; 2] {
        let weights = &self.weights;
        // Acuity is weighed only where the paper asks for it.
        let acuity = if weights.acuity == 0.0 {
            0.0
        } else {
            weights.acuity as f32 * libm::exp2f(resolved.limit)
        };
        let factor = if weights.by_area {
            libm::exp2f(-2.0 * node.density)
        } else {
            1.0
        };
        [acuity + weights.constant as f32, factor]
    }

    /// Texels of a row, `side` pixels wide, that are near the gaze.
    fn texels_near_gaze(&self, side: f64, y: f64, width: usize) -> Range<usize> {
        let Some(place) = self.place.filter(|_| self.gaze_counts()) else {
            return 0..0;
        };
        let across2 = EXACT_RADIUS * EXACT_RADIUS - (y - place[1]) * (y - place[1]);
        if side > SPACING as f64 || across2 <= 0.0 {
            return 0..0;
        }
        let half = across2.sqrt();
        let texel = |x: f64| ((x / side).max(0.0) as usize).min(width);
        texel(place[0] - half)..texel(place[0] + half)
    }
}

fn to_f32(v: DVec3) -> [f32; 3] {
    v.to_array().map(|c| c as f32)
}

/// Texels of a band that share a gap between nodes, at least 1.
pub(super) fn texels_per_node(band: usize) -> usize {
    (SPACING >> band.min(63)).max(1)
}

/// Nodes from one texel of a band to the next, where that is more than one.
pub(super) fn band_stride(band: usize) -> usize {
    ((1 << band) / SPACING).max(1)
}

/// Whether a node is the middle of a texel, or the last one, which stands for what lies beyond.
fn used(node: usize, nodes: usize, every: usize) -> bool {
    node % every == every / 2 || node + 1 == nodes
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// A place off the gaze.
struct Offset {
    /// To the right and up, of any length.
    across: [f32; 2],
    sin: f32,
    cos: f32,
    angle: f32,
}

impl Offset {
    /// Log2 of the acuity in cycles per degree: `AcuityModel::acuity` through the table of cells.
    fn log_acuity(&self, spacing: &[[f32; 4]], model: Model) -> f32 {
        let [x, y] = self.across;
        let length2 = x * x + y * y;
        let [x2, y2] = if length2 > 1e-16 {
            [x * x / length2, y * y / length2]
        } else {
            [1.0, 0.0]
        };
        let spacing2 = if model == Model::Paper {
            let bearing = [x2.sqrt(), y2.sqrt()];
            let angle = bearing.map(|along| libm::atan2f(self.sin * along, self.cos));
            let [h, v] = angle.map(|a| a * a);
            let total = h + v;
            let [temporal, superior, ..] = at_angle(spacing, total.sqrt());
            let share = if total > 0.0 { h / total } else { 1.0 };
            temporal * share + superior * (1.0 - share)
        } else {
            let [temporal, superior, nasal, inferior] = at_angle(spacing, self.angle);
            let vertical = if y > 0.0 { inferior } else { superior };
            // One polarity of cells: half the density, squared spacing 3/2 of the printed one.
            1.5 * (temporal.min(nasal) * x2 + vertical * y2)
        };
        -1.0 - 0.5 * libm::log2f(spacing2)
    }
}

fn at_angle(spacing: &[[f32; 4]], angle: f32) -> [f32; 4] {
    interpolated(spacing, (angle * (1.0 / PI) as f32).sqrt())
}

/// An entry of a table over 0 to 1.
fn interpolated(table: &[[f32; 4]], place: f32) -> [f32; 4] {
    let place = (place * ANGLES as f32).clamp(0.0, ANGLES as f32);
    let index = (place as usize).min(ANGLES - 1);
    let share = place - index as f32;
    let (a, b) = (table[index], table[index + 1]);
    core::array::from_fn(|i| a[i] + (b[i] - a[i]) * share)
}

fn spacing_table() -> Vec<[f32; 4]> {
    use Meridian::{Inferior, Nasal, Superior, Temporal};
    let squared = |meridian, degrees| {
        let spacing = watson_spacing([degrees, 0.0], meridian, meridian);
        (spacing * spacing) as f32
    };
    (0..=ANGLES)
        .map(|index| {
            let root = index as f64 / ANGLES as f64;
            let degrees = Radians(PI * root * root).to_degrees();
            [Temporal, Superior, Nasal, Inferior].map(|meridian| squared(meridian, degrees))
        })
        .collect()
}

fn nodes(view: &EyeView, size: [usize; 2]) -> Vec<Node> {
    let geometry = Onlooker::at_rest(view);
    let mut nodes = Vec::with_capacity(size[0] * size[1]);
    for y in 0..size[1] {
        for x in 0..size[0] {
            let spot = geometry.spot([x, y].map(|at| (at * SPACING) as f64));
            nodes.push(Node {
                direction: to_f32(spot.direction),
                density: libm::log2(spot.ppd.0) as f32,
            });
        }
    }
    nodes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::perception::eye::Gaze;
    use crate::view::axes::direction_from_yaw_pitch;
    use crate::view::eye_view::Field;

    #[test]
    fn nodes_resolve_what_the_model_of_acuity_says() {
        let size = [640, 360];
        let view = EyeView {
            position: Default::default(),
            axes: Axes::FRONT,
            field: Field::across(Radians(1.2), size),
            size,
            eye: Default::default(),
        };
        for (model, spread) in [
            (Model::Paper, 0.0),
            (Model::Default, 0.0),
            (Model::Default, 0.05),
        ] {
            let parameters = Parameters::of(model);
            let onlooker = Onlooker {
                gaze: Gaze {
                    direction: direction_from_yaw_pitch(Radians(0.2), Radians(-0.1)),
                    spread: Radians(spread),
                },
                ..Onlooker::at_rest(&view)
            };
            let mut field = EyeField::new(&parameters, &view, 1);
            field.look(&onlooker, &parameters.weights(EyeState::Steady));
            for (i, resolved) in field.resolved.iter().enumerate() {
                let place = [i % field.size[0], i / field.size[0]].map(|n| (n * SPACING) as f64);
                let direction = onlooker.spot(place).direction;
                let exact = onlooker.gaze.place(direction, &parameters.acuity_model());
                let found = f64::from(libm::exp2f(resolved.limit));
                assert!(
                    (found / exact.acuity.0 - 1.0).abs() < 1e-3,
                    "{model:?} {place:?}"
                );
                let raised = parameters.octaves_raised(exact.eccentricity);
                assert!((f64::from(resolved.raised) - raised).abs() < 1e-3);
            }
        }
    }
}
