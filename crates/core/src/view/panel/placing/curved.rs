//! How does a source that goes round the head lie so that few pixels of it are needed?

use super::super::placement::{Placement, SourceProjection};
use super::plane::{least_sigma, upright};
use super::samples::{PanelSamples, cone_of};
use crate::units::Radians;
use crate::view::axes::{Axes, yaw_pitch_from_direction};
use core::f64::consts::{FRAC_PI_2, PI, TAU};

/// How much less must be needed of a source that does not stand upright: people look at it, too.
const WORTH_TILTING: f64 = 0.9;
/// Sine of the elevation (60°) up to which a source follows the panels' axis.
const STEEPEST: f64 = 0.866;
/// A ring of azimuths with a smaller gap (3°) counts as all of them.
const SMALLEST_GAP: f64 = 0.052;

/// The placement of a projection round the panels with the fewest pixels; `None` where it has no
/// place for one of them.
pub(in super::super) fn best_curved(
    all: &[PanelSamples<'_>],
    projection: SourceProjection,
    aspect: Option<f64>,
) -> Option<Placement> {
    let (axis, _) = cone_of(all);
    let (yaw, _) = yaw_pitch_from_direction(axis);
    let level = Axes::from_yaw_pitch_roll(yaw, Radians(0.0), Radians(0.0));
    let need = |placement: &Placement| {
        let [width, height] = placement.extent();
        let sigma = least_sigma(all, placement)?;
        Some(width * height / (sigma * sigma))
    };
    // Panels that go all round share an axis overhead, and what is upright there lies on its side
    // ahead: it serves where nothing else does.
    let worth_tilting = match axis.y.abs() < STEEPEST {
        true => WORTH_TILTING,
        false => 0.0,
    };
    let mut best: Option<(Placement, f64)> = None;
    for axes in [level, upright(axis)] {
        let found = round(all, projection, axes, aspect);
        let Some((placement, need)) = found.and_then(|it| Some((it, need(&it)?))) else {
            continue;
        };
        if best.is_none_or(|best| need < best.1 * worth_tilting) {
            best = Some((placement, need));
        }
    }
    best.map(|(placement, _)| placement)
}

/// The window round all panels, of given axes.
fn round(
    all: &[PanelSamples<'_>],
    projection: SourceProjection,
    axes: Axes,
    aspect: Option<f64>,
) -> Option<Placement> {
    let open = Placement::new(projection, axes, [1.0; 4]);
    let mut spans = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    for one in all {
        for ray in one
            .rim
            .iter()
            .copied()
            .chain(one.inner.iter().map(|it| it.ray))
        {
            let found = open.coordinates(ray)?.place;
            for (span, at) in spans.iter_mut().zip(found) {
                *span = [span[0].min(at), span[1].max(at)];
            }
        }
        for (pole, up) in [(-axes.down, -FRAC_PI_2), (axes.down, FRAC_PI_2)] {
            if projection != SourceProjection::Fisheye && one.sees(pole) {
                if projection == SourceProjection::Cylinder {
                    return None;
                }
                spans[0] = [-PI, PI];
                spans[1] = [spans[1][0].min(up), spans[1][1].max(up)];
            }
        }
    }
    if projection != SourceProjection::Fisheye && spans[0][1] - spans[0][0] > TAU - SMALLEST_GAP {
        spans[0] = [-PI, PI];
    }
    let [[mut left, mut right], [up, down]] = spans.map(widened);
    let mut axes = axes;
    if projection != SourceProjection::Fisheye {
        let middle = f64::midpoint(left, right);
        axes = turned(axes, middle);
        (left, right) = (left - middle, right - middle);
    }
    Some(Placement {
        window: grown([-left, right, -up, down], aspect),
        axes,
        ..open
    })
}

/// Axes turned to the right about their own down: azimuths count from there on.
fn turned(axes: Axes, azimuth: f64) -> Axes {
    let (sin, cos) = (libm::sin(azimuth), libm::cos(azimuth));
    Axes {
        forward: axes.forward * cos + axes.right * sin,
        right: axes.right * cos - axes.forward * sin,
        down: axes.down,
    }
}

/// By a millionth: places between those that were tried lie within.
fn widened([low, high]: [f64; 2]) -> [f64; 2] {
    let more = (high - low) * 1e-6;
    [low - more, high + more]
}

/// A window whose shorter side is grown to both ends until width over height is `aspect`.
fn grown([left, right, up, down]: [f64; 4], aspect: Option<f64>) -> [f64; 4] {
    let Some(aspect) = aspect else {
        return [left, right, up, down];
    };
    let [width, height] = [left + right, up + down];
    let wider = (height * aspect - width).max(0.0) / 2.0;
    let higher = (width / aspect - height).max(0.0) / 2.0;
    [left + wider, right + wider, up + higher, down + higher]
}
