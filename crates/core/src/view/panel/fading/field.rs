//! How far inside the edges of a panel does any direction lie?
//!
//! Distances are known at the nodes of a chart, a stereographic picture of the sphere, and linear
//! between them. So every panel that shows a direction finds the same number, whatever its own
//! pixels, and shares of light add up.

use super::edge::EdgePiece;
use crate::view::axes::angle_between;
use glam::DVec3;

/// Nodes across a fade, at least: between nodes a distance is a quarter of their step off at most,
/// where edges meet.
const ACROSS_FADE: f64 = 64.0;
/// Nodes across a panel, at least, and most of them on a side.
const ACROSS: f64 = 128.0;
const MOST_ACROSS: f64 = 512.0;
/// Nodes beyond the lit part, and how many steps off an edge still counts.
const MARGIN: f64 = 2.0;
const NEAR: f64 = 4.0;
/// How many steps off the lit part a node may be that linear interpolation there reads.
const NEXT: f64 = 1.5;
/// A part of a chart of so many nodes on a side is not divided further.
const SMALLEST_PART: usize = 8;
/// Sides of a panel.
const SIDES: usize = 4;
/// Kinds of edges: those that other panels cover, and all.
const COVERED: usize = 0;
const ALL: usize = 1;
/// Chords whose squares differ by less are equally far.
const SAME_CHORD: f64 = 1e-12;

/// Distances from the edges of one panel.
#[derive(Clone, Debug, PartialEq)]
pub struct FadeField {
    /// Unit directions of the chart: to its right, down, and to its middle.
    pub axes: [DVec3; 3],
    /// The first node's place on the chart.
    pub low: [f64; 2],
    /// From node to node.
    pub step: f64,
    /// Columns and rows of nodes, each at least 2.
    pub size: [usize; 2],
    /// Radians, row by row: how far inside the edges that other panels cover, and to the nearest of
    /// all; negative outside, and no larger than is needed. The first is the width of the fade
    /// times the product, over the sides of the panel, of the shares of it that the edges are
    /// away: so no share of light changes twice as fast where two sides meet.
    pub nodes: Vec<[f32; 2]>,
    /// The largest number of each kind.
    most: [f64; 2],
    /// Radians of the fade.
    width: f64,
    /// Nodes off the lit part, until it is known which edges are covered.
    beside: Vec<NodeBeside>,
}

/// A node just outside of the lit part.
#[derive(Clone, Debug, PartialEq)]
struct NodeBeside {
    index: usize,
    direction: DVec3,
    /// The nearest piece of the edge.
    piece: usize,
    /// The unit direction as far inside.
    mirrored: DVec3,
}

/// Nodes from a column and row up to others.
#[derive(Clone, Copy)]
struct ChartPart {
    first: [usize; 2],
    end: [usize; 2],
}

impl FadeField {
    /// Of a panel with this edge and these directions inside it, which fades over `width` radians,
    /// with about `share` of the nodes that are wanted on a side. `None` where nothing is lit.
    pub(super) fn new(
        edge: &[EdgePiece],
        inside: &[DVec3],
        width: f64,
        share: f64,
    ) -> Option<Self> {
        let middles = || edge.iter().map(EdgePiece::middle);
        let inner = inside.iter().copied().sum::<DVec3>();
        let axis = inner
            .try_normalize()
            .or_else(|| middles().sum::<DVec3>().try_normalize())?;
        let right = axis.any_orthonormal_vector();
        let mut field = Self {
            axes: [right, axis.cross(right), axis],
            low: [0.0; 2],
            step: 1.0,
            size: [2; 2],
            nodes: Vec::new(),
            most: [0.0; 2],
            width,
            beside: Vec::new(),
        };
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for at in edge
            .iter()
            .flat_map(|it| it.ends)
            .chain(inside.iter().copied())
        {
            let place = field.on_chart(at);
            for k in 0..2 {
                low[k] = low[k].min(place[k]);
                high[k] = high[k].max(place[k]);
            }
        }
        let longest = (high[0] - low[0]).max(high[1] - low[1]);
        let wanted = (longest / width * ACROSS_FADE).clamp(ACROSS, MOST_ACROSS);
        field.step = longest / (wanted * share).max(2.0);
        if field.step.is_nan() || field.step <= 0.0 {
            return None;
        }
        field.low = low.map(|it| it - MARGIN * field.step);
        field.size = [0, 1].map(|k| {
            let steps = (high[k] - low[k]) / field.step + 2.0 * MARGIN;
            libm::ceil(steps) as usize + 1
        });
        field.most = [width + NEAR * field.step, NEAR * field.step];
        field.nodes = vec![[0.0; 2]; field.size[0] * field.size[1]];
        field.fill(ALL, edge);
        Some(field)
    }

    /// Takes in which pieces of the edge other panels cover.
    pub(super) fn cover(&mut self, pieces: &[EdgePiece]) {
        let beside = core::mem::take(&mut self.beside);
        let mut shares = vec![self.width; self.nodes.len()];
        for side in 0..SIDES {
            let of_side = pieces.iter().filter(|it| it.side == side).copied();
            let of_side: Vec<EdgePiece> = of_side.collect();
            if of_side.is_empty() {
                continue;
            }
            self.fill_covered(&of_side, &beside);
            for (share, node) in shares.iter_mut().zip(&self.nodes) {
                *share *= (f64::from(node[COVERED]) / self.width).min(1.0);
            }
        }
        for (node, share) in self.nodes.iter_mut().zip(shares) {
            node[COVERED] = share as f32;
        }
    }

    /// Distances from the covered pieces of one side.
    fn fill_covered(&mut self, pieces: &[EdgePiece], beside: &[NodeBeside]) {
        self.fill(COVERED, pieces);
        // Across an edge that no panel covers, distances from the others go on as in a mirror:
        // what is linear between nodes is then right up to the edge.
        for node in beside {
            let is_covered = pieces
                .binary_search_by_key(&node.piece, |it| it.number)
                .is_ok();
            // Beyond the end of a side, round a corner, its own line goes on.
            let angle = match is_covered {
                true => nearest(pieces, node.direction).map_or(0.0, |it| libm::asin(it.1[1])),
                false => signed_angle(pieces, node.mirrored),
            };
            let most = self.most[COVERED];
            self.nodes[node.index][COVERED] = angle.clamp(-most, most) as f32;
        }
    }

    /// Radians inside the edges that other panels cover, and inside all of them, of a unit
    /// direction, negative outside; `None` far from the panel.
    #[must_use]
    pub fn at(&self, direction: DVec3) -> Option<[f64; 2]> {
        let place = self.on_chart(direction);
        let at = [0, 1].map(|k| (place[k] - self.low[k]) / self.step);
        let is_within = |k: usize| at[k] >= 0.0 && at[k] <= (self.size[k] - 1) as f64;
        if !(is_within(0) && is_within(1)) {
            return None;
        }
        let cell = [0, 1].map(|k| (at[k] as usize).min(self.size[k] - 2));
        let [x, y] = [0, 1].map(|k| at[k] - cell[k] as f64);
        let node = |dx: usize, dy: usize| {
            self.nodes[(cell[1] + dy) * self.size[0] + cell[0] + dx].map(f64::from)
        };
        let (a, b, c, d) = (node(0, 0), node(1, 0), node(0, 1), node(1, 1));
        Some([0, 1].map(|k| {
            let upper = a[k] * (1.0 - x) + b[k] * x;
            let lower = c[k] * (1.0 - x) + d[k] * x;
            upper * (1.0 - y) + lower * y
        }))
    }

    /// Whether a unit direction lies so many radians inside all edges, or as far as is known.
    pub(super) fn holds(&self, direction: DVec3, margin: f64) -> bool {
        let margin = margin.min(self.most[ALL] / 2.0);
        self.at(direction).is_some_and(|it| it[ALL] > margin)
    }

    /// The place of a unit direction on the chart, in radians about its middle.
    fn on_chart(&self, direction: DVec3) -> [f64; 2] {
        let [right, down, axis] = self.axes.map(|it| it.dot(direction));
        // Behind, places are as far as there are none.
        let scale = 2.0 / (1.0 + axis).max(1e-6);
        [right * scale, down * scale]
    }

    /// The unit direction of a node.
    fn direction(&self, node: [usize; 2]) -> DVec3 {
        let [x, y] = [0, 1].map(|k| self.low[k] + node[k] as f64 * self.step);
        let square = (x * x + y * y) / 4.0;
        let [right, down, axis] = self.axes;
        ((right * x + down * y) + axis * (1.0 - square)) / (1.0 + square)
    }

    fn fill(&mut self, kind: usize, pieces: &[EdgePiece]) {
        let whole = ChartPart {
            first: [0; 2],
            end: self.size,
        };
        match pieces.is_empty() {
            true => self.set(whole, kind, self.most[kind]),
            false => self.fill_part(whole, kind, pieces),
        }
    }

    /// Of the nodes of a part: only pieces count that can be nearest to one of them.
    fn fill_part(&mut self, part: ChartPart, kind: usize, pieces: &[EdgePiece]) {
        let middle = self.direction([0, 1].map(|k| usize::midpoint(part.first[k], part.end[k])));
        let corners = part.corners().map(|it| self.direction(it));
        let radius = corners.map(|it| angle_between(middle, it).0);
        let radius = radius.into_iter().fold(0.0, f64::max);
        let signed = signed_angle(pieces, middle);
        if signed.abs() - radius > self.most[kind] {
            return self.set(part, kind, signed);
        }
        let reach = chord_of(signed.abs() + 2.0 * radius) + SAME_CHORD;
        let near = pieces.iter().filter(|it| it.reached(middle)[0] <= reach);
        let near: Vec<EdgePiece> = near.copied().collect();
        if part.is_small() {
            for node in part.nodes() {
                let direction = self.direction(node);
                let angle = signed_angle(&near, direction);
                self.set(ChartPart::of(node), kind, angle);
                if kind == ALL && angle < 0.0 && -angle < NEXT * self.step {
                    self.add_beside(node, &near);
                }
            }
            return;
        }
        for quarter in part.quarters() {
            self.fill_part(quarter, kind, &near);
        }
    }

    fn add_beside(&mut self, node: [usize; 2], pieces: &[EdgePiece]) {
        let direction = self.direction(node);
        let Some((piece, _)) = nearest(pieces, direction) else {
            return;
        };
        self.beside.push(NodeBeside {
            index: node[1] * self.size[0] + node[0],
            direction,
            piece: piece.number,
            mirrored: direction - piece.inward * (2.0 * piece.inward.dot(direction)),
        });
    }

    fn set(&mut self, part: ChartPart, kind: usize, angle: f64) {
        let angle = angle.clamp(-self.most[kind], self.most[kind]) as f32;
        for [column, row] in part.nodes() {
            self.nodes[row * self.size[0] + column][kind] = angle;
        }
    }
}

impl ChartPart {
    fn of([column, row]: [usize; 2]) -> Self {
        Self {
            first: [column, row],
            end: [column + 1, row + 1],
        }
    }

    fn nodes(self) -> impl Iterator<Item = [usize; 2]> {
        let ([left, top], [right, bottom]) = (self.first, self.end);
        (top..bottom).flat_map(move |row| (left..right).map(move |column| [column, row]))
    }

    fn corners(self) -> [[usize; 2]; 4] {
        let ([left, top], [right, bottom]) = (self.first, self.end.map(|it| it - 1));
        [[left, top], [right, top], [left, bottom], [right, bottom]]
    }

    fn is_small(self) -> bool {
        (0..2).all(|k| self.end[k] - self.first[k] <= SMALLEST_PART)
    }

    fn quarters(self) -> impl Iterator<Item = Self> {
        let middle = [0, 1].map(|k| usize::midpoint(self.first[k], self.end[k]));
        let halves = move |k: usize| [[self.first[k], middle[k]], [middle[k], self.end[k]]];
        let both = halves(1).into_iter().flat_map(move |rows| {
            let columns = halves(0);
            columns.map(|columns| Self {
                first: [columns[0], rows[0]],
                end: [columns[1], rows[1]],
            })
        });
        both.filter(|it| it.first[0] < it.end[0] && it.first[1] < it.end[1])
    }
}

/// Radians to the nearest of pieces, positive on the lit side.
fn signed_angle(pieces: &[EdgePiece], from: DVec3) -> f64 {
    let Some((_, [chord, sine])) = nearest(pieces, from) else {
        return f64::INFINITY;
    };
    let angle = 2.0 * libm::asin((chord.sqrt() / 2.0).min(1.0));
    if sine < 0.0 { -angle } else { angle }
}

/// The nearest of pieces, with what [`EdgePiece::reached`] says of it. Where two are equally near,
/// at the corner between them, that one decides the side whose plane is farther off.
fn nearest(pieces: &[EdgePiece], from: DVec3) -> Option<(&EdgePiece, [f64; 2])> {
    let all = pieces.iter().map(|it| (it, it.reached(from)));
    all.reduce(|best, it| {
        let ([least, known], [chord, sine]) = (best.1, it.1);
        let is_same = (chord - least).abs() <= SAME_CHORD;
        match is_same {
            true if sine.abs() > known.abs() => it,
            false if chord < least => it,
            _ => best,
        }
    })
}

/// The square of the chord of an angle.
fn chord_of(angle: f64) -> f64 {
    let half = libm::sin(angle.min(core::f64::consts::PI) / 2.0);
    4.0 * half * half
}
