//! What of fades into neighbours does the pass that fills panels read?

use super::params::BlendParams;
use foveal_core::view::panel::drawn_grid::DrawnGrid;
use foveal_core::view::panel::fading::{Fade, Fades};
use foveal_core::view::panel::rig::Panel;
use glam::DVec3;

/// What the panels that fade need: a record each, lists of neighbours, and fields of distances.
#[derive(Default)]
pub(super) struct Blends {
    /// Of panels that fade, in their order.
    pub(super) records: Vec<BlendParams>,
    /// Numbers of records.
    pub(super) neighbours: Vec<u32>,
    /// Nodes of all fields.
    pub(super) fields: Vec<[f32; 2]>,
    /// For each panel the number of its record from 1 on, or 0.
    pub(super) of_panel: Vec<u32>,
}

impl Blends {
    pub(super) fn new(panels: &[(&Panel, Option<&DrawnGrid>)]) -> Self {
        let fades = Fades::of(panels);
        let number = |index: &Option<usize>| index.map_or(0, |it| it as u32 + 1);
        let mut blends = Self {
            of_panel: fades.of_panel.iter().map(number).collect(),
            ..Self::default()
        };
        for fade in &fades.fades {
            blends.add(fade, fades.most);
        }
        blends
    }

    fn add(&mut self, fade: &Fade, most: usize) {
        let column = |v: DVec3| v.as_vec3().to_array();
        let field = &fade.field;
        let [chart_right, chart_down, chart_axis] = field.axes.map(column);
        self.records.push(BlendParams {
            right: column(fade.rays.x_axis),
            sharpness: (1.0 / fade.width) as f32,
            down: column(fade.rays.y_axis),
            first: self.neighbours.len() as u32,
            corner: column(fade.rays.z_axis),
            count: fade.neighbours.len() as u32,
            chart_right,
            most: most as f32,
            chart_down,
            field: self.fields.len() as u32,
            chart_axis,
            per_step: (1.0 / field.step) as f32,
            low: field.low.map(|it| it as f32),
            nodes: field.size.map(|it| it as u32),
        });
        let neighbours = fade.neighbours.iter().map(|other| *other as u32);
        self.neighbours.extend(neighbours);
        self.fields.extend_from_slice(&field.nodes);
    }
}
