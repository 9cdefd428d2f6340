//! How much of the light does each of several panels give that show one direction?
//!
//! A panel fades towards those edges of its lit part that another panel covers, by the angle to
//! them, and nowhere else: at an edge that it has for itself it gives all light. All panels that
//! show a direction share its light in proportion, so that together they give one.

mod edge;
mod field;
#[cfg(test)]
mod tests;

use super::drawn_grid::DrawnGrid;
use super::rig::Panel;
use crate::view::axes::angle_between;
use edge::{EdgePiece, LitPanel};
use glam::{DMat3, DVec3};

pub use field::FadeField;

/// Least share of a lit pixel: where all that show a direction are at their edges, one is left.
pub const LEAST_SHARE: f64 = 1e-6;
/// Narrowest fade, in radians: a fiftieth of a second of arc.
const NARROWEST: f64 = 1e-7;
/// Most nodes of all fields of a rig: 64 MB.
const MOST_NODES: f64 = (1 << 23) as f64;
/// Nodes of a field that is as large as it may be.
const FULL_FIELD: f64 = (1 << 18) as f64;

/// Which panels fade, and into which others.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fades {
    /// Of panels that fade, in their order.
    pub fades: Vec<Fade>,
    /// For each panel the index of its fade.
    pub of_panel: Vec<Option<usize>>,
    /// The most panels that show one direction, at least 1.
    pub most: usize,
}

/// How a panel fades.
#[derive(Clone, Debug, PartialEq)]
pub struct Fade {
    /// From (column, row, 1) of the ideal panel, as sent, to a ray.
    pub rays: DMat3,
    /// Radians over which it fades.
    pub width: f64,
    /// How far inside its edges a direction lies.
    pub field: FadeField,
    /// Indices of the fades that show some of its directions to one eye.
    pub neighbours: Vec<usize>,
}

/// What a pixel gives of the light of its direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FadedShare {
    /// From 0 to 1.
    pub light: f64,
    /// Panels that show less there than anywhere: so often is black lifted.
    pub lifts: f64,
}

/// A panel while its neighbours are looked for.
struct Looked<'a> {
    panel: &'a Panel,
    lit: LitPanel<'a>,
    edge: Vec<EdgePiece>,
    inside: Vec<DVec3>,
    /// Radians from its middle to its farthest place.
    radius: f64,
    field: FadeField,
}

impl Fades {
    /// Of panels with the grids that they are drawn by. Those with a `blend` fade into each other.
    #[must_use]
    pub fn of(panels: &[(&Panel, Option<&DrawnGrid>)]) -> Self {
        let count = panels.iter().filter(|it| it.0.blend > 0.0).count();
        let share = (MOST_NODES / FULL_FIELD / count.max(1) as f64)
            .min(1.0)
            .sqrt();
        let looked: Vec<Option<Looked<'_>>> = panels
            .iter()
            .map(|(panel, drawn)| Looked::at(panel, *drawn, share))
            .collect();
        let mut next = 0..;
        let of_panel = looked
            .iter()
            .map(|it| it.as_ref().and_then(|_| next.next()));
        let of_panel = of_panel.collect();
        let looked: Vec<Looked<'_>> = looked.into_iter().flatten().collect();
        let fades = (0..looked.len()).map(|index| fade_of(&looked, index));
        let fades: Vec<Fade> = fades.collect();
        let counts = looked.iter().zip(&fades).flat_map(|(own, fade)| {
            own.inside.iter().map(|ray| {
                let others = fade.neighbours.iter();
                1 + others.filter(|it| fades[**it].weight(*ray) > 0.0).count()
            })
        });
        Self {
            most: counts.max().unwrap_or(1),
            of_panel,
            fades,
        }
    }

    /// What the panel of a fade gives of the light of a unit direction that it shows.
    #[must_use]
    pub fn share(&self, fade: usize, direction: DVec3) -> FadedShare {
        // It shows the direction, whatever the field, which is linear, says where edges meet.
        let own = self.fades[fade].inside(direction)[0].max(LEAST_SHARE);
        let others = self.fades[fade].neighbours.iter();
        let others = others.map(|it| self.fades[*it].weight(direction));
        let (mut sum, mut showing) = (own, 1.0);
        for other in others.filter(|it| *it > 0.0) {
            sum += other;
            showing += 1.0;
        }
        FadedShare {
            light: own / sum,
            lifts: (self.most as f64 - showing).max(0.0),
        }
    }
}

impl Fade {
    /// How far inside a unit direction lies: 0 at an edge that others cover and where nothing is
    /// lit, 1 beyond the fade.
    #[must_use]
    pub fn weight(&self, direction: DVec3) -> f64 {
        let [covered, all] = self.inside(direction);
        if all > 0.0 { covered } else { 0.0 }
    }

    /// How far inside the edges that others cover, and radians inside all edges.
    fn inside(&self, direction: DVec3) -> [f64; 2] {
        let [covered, all] = self.field.at(direction).unwrap_or([-1.0; 2]);
        [(covered / self.width).clamp(0.0, 1.0), all]
    }
}

impl<'a> Looked<'a> {
    fn at(panel: &'a Panel, drawn: Option<&'a DrawnGrid>, share: f64) -> Option<Self> {
        if panel.blend <= 0.0 {
            return None;
        }
        let lit = LitPanel::of(panel, drawn);
        let edge = lit.edge();
        let inside: Vec<DVec3> = lit.probes().collect();
        let width = panel.blend.max(NARROWEST);
        let field = FadeField::new(&edge, &inside, width, share)?;
        let places = edge
            .iter()
            .flat_map(|it| it.ends)
            .chain(inside.iter().copied());
        let angles = places.map(|it| angle_between(field.axes[2], it).0);
        Some(Self {
            radius: angles.fold(0.0, f64::max),
            panel,
            lit,
            edge,
            inside,
            field,
        })
    }

    /// Whether one eye sees both, and their directions may meet.
    fn is_near(&self, other: &Self) -> bool {
        let [a, b] = [self, other].map(|it| it.panel);
        let share_an_eye = a.is_for_both || b.is_for_both || a.view.eye == b.view.eye;
        let apart = angle_between(self.field.axes[2], other.field.axes[2]).0;
        share_an_eye && apart < self.radius + other.radius
    }

    /// Whether it covers a piece of another's edge. Edges that lie on each other, as those of a
    /// wall in one row, cover nothing.
    fn covers(&self, piece: &EdgePiece) -> bool {
        self.field.holds(piece.middle(), piece.half_pixel)
    }

    fn overlaps(&self, other: &Self) -> bool {
        let is_shown = |it: &DVec3| other.field.holds(*it, 0.0);
        self.edge.iter().any(|it| other.covers(it)) || self.inside.iter().any(is_shown)
    }
}

fn fade_of(looked: &[Looked<'_>], index: usize) -> Fade {
    let own = &looked[index];
    let others = looked.iter().enumerate().filter(|(other, it)| {
        *other != index && own.is_near(it) && (own.overlaps(it) || it.overlaps(own))
    });
    let neighbours: Vec<usize> = others.map(|(other, _)| other).collect();
    let is_covered = |piece: &&EdgePiece| neighbours.iter().any(|it| looked[*it].covers(piece));
    let covered = own.edge.iter().filter(is_covered);
    let mut field = own.field.clone();
    field.cover(&covered.copied().collect::<Vec<_>>());
    Fade {
        rays: own.lit.rays(),
        width: own.panel.blend.max(NARROWEST),
        field,
        neighbours,
    }
}
