//! How do boxes become part of a picture?

use crate::octree_boxes::{GPU_BYTES, place_of};
use foveal_core::content::payload::PayloadView;
use foveal_core::pack::unit::UnitId;
use foveal_render::gpu::buffers::filled;
use foveal_render::gpu::room::TakenBytes;
use foveal_render::scene::corner_pass::CornerPass;
use foveal_render::scene::kind::{Frame, KindLayer};
use foveal_render::scene::phase::{Go, Phase};
use foveal_render::shaders::of_units;
use foveal_render::{Coming, Gpu, RenderError};
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet, HashSet};

const SHADER: &str = "
struct Corner { place: vec3f, colour: u32 }
struct Side { @builtin(position) position: vec4f, @location(0) @interpolate(flat) colour: vec4f }
@group(0) @binding(3) var<storage, read> corners: array<Corner>;
@vertex fn place_corner(@builtin(vertex_index) number: u32) -> Side {
    let place = corners[number].place;
    let across = place.xy * scene.clip_from_view.xy + place.z * scene.clip_from_view.zw;
    return Side(vec4f(across, scene.near, place.z), unpack4x8unorm(corners[number].colour));
}
@fragment fn draw_boxes(side: Side) -> @location(0) vec4f { return side.colour; }";

/// What a box says: its colour, as sRGB codes.
pub(super) struct BoxUnit(pub(super) [u8; 4]);

/// Boxes on the GPU, by their colours.
pub(super) struct BoxLayer {
    gpu: Gpu,
    units: BTreeMap<UnitId, [u8; 4]>,
    /// Those that stay without being drawn.
    hidden: BTreeSet<UnitId>,
    pass: CornerPass,
    /// What the last picture was drawn with, and how many corners it had.
    bound: Option<(wgpu::BindGroup, u32)>,
}

impl BoxLayer {
    pub(super) fn new(gpu: &Gpu) -> Self {
        let shader = of_units("boxes", &[["place_corner", "draw_boxes"]], &[SHADER]);
        let bindings = &[(0, true), (3, false)];
        Self {
            gpu: gpu.clone(),
            units: BTreeMap::new(),
            hidden: BTreeSet::new(),
            pass: CornerPass::new(gpu, &shader, bindings, Phase::Opaque),
            bound: None,
        }
    }

    /// What is drawn: of each box that is there the parts that no finer one shows.
    fn parts(&self) -> impl Iterator<Item = (u32, [u8; 4])> {
        let is_drawn = |unit: &UnitId| self.units.contains_key(unit) && !self.hidden.contains(unit);
        let drawn = self.units.iter().filter(move |(unit, _)| is_drawn(unit));
        drawn.flat_map(move |(unit, colour)| {
            let parts = match place_of(unit.0).0 {
                0 => unit.0..unit.0 + 1,
                _ => 8 * unit.0 + 1..8 * unit.0 + 9,
            };
            let is_finer = move |part: &u32| *part != unit.0 && is_drawn(&UnitId(*part));
            let coarse = parts.filter(move |part| !is_finer(part));
            coarse.map(|part| (part, *colour))
        })
    }
}

fn box_of<'a>(coming: &Coming<'a>) -> Option<&'a BoxUnit> {
    match coming.payload {
        PayloadView::Other(payload) => payload.0.downcast_ref(),
        _ => None,
    }
}

/// The corners of the triangles of a cube, from -1 to 1.
fn corners() -> impl Iterator<Item = DVec3> {
    (0..36).map(|number| {
        let (axis, far, corner) = (number / 12, number / 6 % 2, [0, 1, 2, 3, 2, 1][number % 6]);
        let mut place = [0.0; 3];
        place[axis] = far as f64;
        place[(axis + 1) % 3] = f64::from(corner & 1);
        place[(axis + 2) % 3] = f64::from(corner >> 1);
        DVec3::from_array(place) * 2.0 - 1.0
    })
}

impl KindLayer for BoxLayer {
    fn takes(&self, coming: &Coming<'_>) -> bool {
        box_of(coming).is_some()
    }

    fn upload(&mut self, coming: &Coming<'_>, allowed: TakenBytes) -> Result<bool, RenderError> {
        let payload = box_of(coming).ok_or(RenderError::OtherKind)?;
        let fits = self.taken().used + GPU_BYTES <= allowed.used;
        if fits {
            self.units.insert(coming.unit, payload.0);
        }
        Ok(fits)
    }

    fn remove(&mut self, unit: UnitId) -> bool {
        self.units.remove(&unit).is_some()
    }

    fn keep(&mut self, wanted: &HashSet<UnitId>, staying: &[UnitId]) {
        let is_drawn = |unit: &UnitId| unit.0 == 0 || wanted.contains(unit);
        self.units
            .retain(|unit, _| is_drawn(unit) || staying.contains(unit));
        let hides = |unit: &&UnitId| !is_drawn(unit);
        self.hidden = self.units.keys().filter(hides).copied().collect();
    }

    fn show(&mut self, unit: UnitId) -> bool {
        self.hidden.remove(&unit)
    }

    fn taken(&self) -> TakenBytes {
        // What stays counts as free.
        let bytes = |units: usize| GPU_BYTES * units as u64;
        TakenBytes {
            used: bytes(self.units.len() - self.hidden.len()),
            held: bytes(self.units.len()),
        }
    }

    fn give_back(&mut self, _: bool) -> Result<(), RenderError> {
        Ok(())
    }

    fn prepare(
        &mut self,
        _: &mut wgpu::CommandEncoder,
        frame: &Frame<'_>,
    ) -> Result<(), RenderError> {
        let axes = frame.view.axes;
        let in_view = self.parts().flat_map(|(part, colour)| {
            let (_, centre, half) = place_of(part);
            corners().map(move |corner| {
                let at = centre + half * corner - frame.view.position;
                let [x, y, z] =
                    [axes.right, axes.down, axes.forward].map(|axis| at.dot(axis) as f32);
                [
                    x.to_bits(),
                    y.to_bits(),
                    z.to_bits(),
                    u32::from_le_bytes(colour),
                ]
            })
        });
        let in_view: Vec<[u32; 4]> = in_view.collect();
        let corners = filled(&self.gpu, "boxes", wgpu::BufferUsages::STORAGE, &in_view);
        let bound = self.pass.bind(&self.gpu, &[frame.scene, &corners]);
        self.bound = Some((bound, in_view.len() as u32));
        Ok(())
    }

    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, phase: Phase, _: Go) {
        if let (Phase::Opaque, Some((bound, corners))) = (phase, &self.bound) {
            self.pass.draw(pass, bound, *corners);
        }
    }
}
