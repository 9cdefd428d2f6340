//! Between which two samples does a coordinate lie? Twin of `shaders/shared/lattice.wgsl`.

use super::tiles::{Plane, TwinTiles, offset_of, pitch_of};
use glam::Vec2;

#[derive(Clone, Copy)]
pub(crate) struct Axis {
    pub(crate) size: f32,
    pub(crate) segment: f32,
    pub(crate) last_segment: i32,
    pub(crate) pitch: f32,
    pub(crate) offset: f32,
}

#[derive(Clone, Copy)]
pub(crate) struct Tap {
    pub(crate) within: f32,
    pub(crate) centre: f32,
    pub(crate) beyond: i32,
}

pub(crate) struct Bracket {
    pub(crate) low: Tap,
    pub(crate) high: Tap,
    pub(crate) weight: f32,
}

pub(crate) fn tap_of(bracket: &Bracket, high: bool) -> Tap {
    if high { bracket.high } else { bracket.low }
}

pub(crate) fn weight_of(bracket: &Bracket, high: bool) -> f32 {
    if high {
        bracket.weight
    } else {
        1.0 - bracket.weight
    }
}

pub(crate) fn axis_of(tiles: &TwinTiles, plane: Plane, level: u32, k: usize) -> Axis {
    let offset = offset_of(tiles, plane, level);
    Axis {
        size: tiles.params.size[k],
        segment: tiles.params.segment[k],
        last_segment: tiles.params.segments[k] as i32 - 1,
        pitch: pitch_of(tiles, plane, level),
        offset: offset[k],
    }
}

pub(crate) fn samples_in(axis: &Axis, segment: i32) -> i32 {
    let covered = axis.segment.min(axis.size - segment as f32 * axis.segment);
    (covered / axis.pitch).ceil() as i32
}

pub(crate) fn tap_at(axis: &Axis, segment: i32, sample: i32) -> Tap {
    let start = segment as f32 * axis.segment + sample as f32 * axis.pitch;
    let covered = axis.pitch.min(axis.size - start);
    Tap {
        within: start + 0.5,
        centre: start + (axis.offset * axis.pitch).min(0.5 * covered),
        beyond: 0,
    }
}

pub(crate) fn bracket(axis: &Axis, at: f32, edge: Vec2) -> Bracket {
    let segment = ((at / axis.segment).floor() as i32).clamp(0, axis.last_segment);
    let count = samples_in(axis, segment);
    let along = (at - segment as f32 * axis.segment) / axis.pitch - axis.offset;
    let mut sample = (along.floor() as i32).clamp(-1, count - 1);
    if sample + 1 < count && at >= tap_at(axis, segment, sample + 1).centre {
        sample += 1;
    }
    let mut low = tap_at(axis, segment, sample.max(0));
    let mut high = tap_at(axis, segment, (sample + 1).min(count - 1));
    let mut from_centre = low.centre;
    let mut to_centre = high.centre;
    if sample < 0 && segment > 0 {
        let count_before = samples_in(axis, segment - 1);
        low = tap_at(axis, segment - 1, count_before - 1);
        if at < low.centre {
            high = low;
            low = tap_at(axis, segment - 1, (count_before - 2).max(0));
        }
        from_centre = low.centre;
        to_centre = high.centre;
    } else if sample < 0 {
        low.beyond = -1;
        from_centre = -edge.x;
    }
    if sample == count - 1 && segment < axis.last_segment {
        high = tap_at(axis, segment + 1, 0);
        to_centre = high.centre;
    } else if sample == count - 1 {
        high.beyond = 1;
        to_centre = axis.size + edge.y;
    }
    let distance = (to_centre - from_centre).max(0.001);
    Bracket {
        low,
        high,
        weight: ((at - from_centre) / distance).clamp(0.0, 1.0),
    }
}
