//! What does each panel of an atlas show of a source?

use super::blends::Blends;
use super::params::{BlendParams, PanelParams, SightParams};
use foveal_core::view::panel::alpha::AlphaMap;
use foveal_core::view::panel::drawn_grid::DrawnGrid;
use foveal_core::view::panel::eye_blur::EyeBlur;
use foveal_core::view::panel::placement::{Placement, SourceProjection};
use foveal_core::view::panel::residual_grid::ResidualGrid;
use foveal_core::view::panel::rig::Panel;
use foveal_core::view::panel::seed::SeedTexel;
use glam::{DMat3, DVec3};

/// A panel, the part of a source that it looks at, and its place in the atlas.
#[derive(Clone, Copy, Debug)]
pub struct PanelOnSource<'a> {
    /// The panel.
    pub panel: &'a Panel,
    /// Where the part of the source lies before the eye.
    pub placement: &'a Placement,
    /// The part: left, top, width and height in texels; one of two halves where each eye has its
    /// own.
    pub part: [u32; 4],
    /// First column and row in the atlas.
    pub origin: [u32; 2],
}

/// All that the pass reads of a rig: 128 bytes a flat panel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WarpPlan {
    /// Columns and rows of the atlas.
    pub atlas: [u32; 2],
    /// A record a panel.
    pub panels: Vec<PanelParams>,
    /// Of panels that fade.
    pub blends: Vec<BlendParams>,
    /// Of panels that fade, who shows the same directions.
    pub neighbours: Vec<u32>,
    /// Of panels that fade, radians inside the edges that others cover, and inside all edges.
    pub fields: Vec<[f32; 2]>,
    /// Of panels with optics, bits of residuals in pixels; of those whose pixels keep a share of
    /// their light, two shares a word; or the seed's maps.
    pub grids: Vec<u32>,
    /// Of each panel, how many of these words there are up to its own last one.
    pub grid_ends: Vec<usize>,
    /// Where an eye blurs, how the rays of each source stand in the world.
    pub sights: Vec<SightParams>,
    /// What the eye makes of a point straight ahead, right and down, in radians: one standard
    /// deviation.
    pub spread: [f32; 2],
}

impl WarpPlan {
    /// The plan of panels, in an atlas just large enough.
    #[must_use]
    pub fn new(panels: &[PanelOnSource<'_>]) -> Self {
        let grids = grids_of(panels);
        let blends = blends_of(panels, &grids);
        let mut plan = Self::default();
        for ((it, grid), blend) in panels.iter().zip(&grids).zip(&blends.of_panel) {
            plan.add(it, grid.as_ref(), *blend);
        }
        plan.blends = blends.records;
        plan.neighbours = blends.neighbours;
        plan.fields = blends.fields;
        plan
    }

    /// A plan for each of several panels, which fade into each other all the same.
    #[must_use]
    pub fn one_by_one(panels: &[PanelOnSource<'_>]) -> Vec<Self> {
        let grids = grids_of(panels);
        let blends = blends_of(panels, &grids);
        let one = |((it, grid), blend): ((&PanelOnSource<'_>, &Option<DrawnGrid>), &u32)| {
            let mut plan = Self::default();
            plan.add(it, grid.as_ref(), *blend);
            if *blend > 0 {
                plan.blends.clone_from(&blends.records);
                plan.neighbours.clone_from(&blends.neighbours);
                plan.fields.clone_from(&blends.fields);
            }
            plan
        };
        panels
            .iter()
            .zip(&grids)
            .zip(&blends.of_panel)
            .map(one)
            .collect()
    }

    /// Adds a panel that is drawn by a grid or none and has the record `blend`, from 1 on, of those
    /// that fade.
    fn add(&mut self, it: &PanelOnSource<'_>, grid: Option<&DrawnGrid>, blend: u32) {
        let mut record = straight(it);
        record.blend = blend;
        if let Some(grid) = grid {
            record.grid = self.grids.len() as u32;
            record.cell = grid.cell;
            record.channels = grid.channels.len() as u32;
            self.grids
                .extend(grid.channels.iter().flat_map(bits_of_grid));
        }
        if let Some(alpha) = it.panel.alpha_as_sent() {
            record.alpha = self.grids.len() as u32 + 1;
            self.grids.extend(pairs_of(&alpha));
        }
        for k in 0..2 {
            self.atlas[k] = self.atlas[k].max(record.origin[k] + record.size[k]);
        }
        self.panels.push(record);
        self.grid_ends.push(self.grids.len());
    }

    /// The same, seen by an eye that blurs: a pixel's footprint in the source grows by how the eye
    /// blurs a point there. `panels` are those that the plan was made of.
    ///
    /// # Panics
    /// When there are not as many as in the plan, or it is drawn by maps, which have no rays.
    #[must_use]
    pub fn seen_blurred(mut self, panels: &[PanelOnSource<'_>], blur: &EyeBlur) -> Self {
        assert_eq!(panels.len(), self.panels.len(), "the panels of the plan");
        self.sights.clear();
        for (record, it) in self.panels.iter_mut().zip(panels) {
            assert_ne!(record.projection, BY_MAPS, "maps have no rays");
            let sight = sight_of(it.placement);
            let known = self.sights.iter().position(|other| *other == sight);
            let index = known.unwrap_or_else(|| {
                self.sights.push(sight);
                self.sights.len() - 1
            });
            record.sight = index as u32;
        }
        self.spread = blur.spread().map(|it| it as f32);
        self
    }

    /// The same, with each panel's place in the source read from the maps of Strege 2009, section
    /// 3.2.5, in place of its matrix: a texel for every pixel as it is sent, row by row. They hold
    /// no optics of single colours, and no shares of light.
    ///
    /// # Panics
    /// When there are not as many maps as panels, or a map has not as many texels as its panel has
    /// pixels.
    #[must_use]
    pub fn by_seed_maps(mut self, maps: &[&[SeedTexel]]) -> Self {
        assert_eq!(maps.len(), self.panels.len(), "a map a panel");
        self.grids.clear();
        self.grid_ends.clear();
        self.spread = [0.0; 2];
        for (record, map) in self.panels.iter_mut().zip(maps) {
            let pixels = record.size[0] as usize * record.size[1] as usize;
            assert_eq!(map.len(), pixels, "an entry a pixel");
            record.projection = BY_MAPS;
            record.scale = [1.0; 2];
            record.offset = [0.0; 2];
            record.cell = 0;
            record.alpha = 0;
            record.channels = 1;
            record.grid = self.grids.len() as u32;
            self.grids.extend(map.iter().flat_map(bits_of));
            self.grid_ends.push(self.grids.len());
        }
        self
    }

    /// Bytes that the pass reads besides the source.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        let records = size_of_val(self.panels.as_slice()) + size_of_val(self.blends.as_slice());
        let records = records + size_of_val(self.sights.as_slice());
        let records = records + size_of_val(self.fields.as_slice());
        let words = self.neighbours.len() + self.grids.len();
        (records + words * size_of::<u32>()) as u64
    }
}

fn grids_of(panels: &[PanelOnSource<'_>]) -> Vec<Option<DrawnGrid>> {
    let all = panels.iter();
    all.map(|it| DrawnGrid::of(it.panel, it.placement))
        .collect()
}

fn blends_of(panels: &[PanelOnSource<'_>], grids: &[Option<DrawnGrid>]) -> Blends {
    let all = panels.iter().zip(grids);
    let all = all.map(|(it, grid)| (it.panel, grid.as_ref()));
    Blends::new(&all.collect::<Vec<(&Panel, _)>>())
}

/// What the records of panels say that are drawn by the seed's maps.
const BY_MAPS: u32 = 4;

/// A residual where nothing is lit; the shader knows what is as far as a ten-thousandth of it.
const UNLIT: f32 = 1e9;

/// Bits of two numbers a node, row by row.
fn bits_of_grid(grid: &ResidualGrid) -> impl Iterator<Item = u32> + '_ {
    grid.residuals
        .iter()
        .flat_map(|&[x, y]| match x.is_finite() {
            true => [x.to_bits(), y.to_bits()],
            false => [UNLIT.to_bits(); 2],
        })
}

/// Columns above rows, and four bytes of derivatives.
fn bits_of(texel: &SeedTexel) -> [u32; 3] {
    let pair = |[column, row]: [u16; 2]| u32::from(column) << 16 | u32::from(row);
    let change = u32::from_le_bytes(texel.change.map(i8::cast_unsigned));
    [pair(texel.whole), pair(texel.fraction), change]
}

/// Shares of light row by row, two a word.
fn pairs_of(alpha: &AlphaMap) -> impl Iterator<Item = u32> {
    let pair = |two: &[u16]| u32::from(two[0]) | two.get(1).map_or(0, |it| u32::from(*it) << 16);
    alpha.shares().chunks(2).map(pair)
}

/// A panel without what bends or fades.
fn straight(it: &PanelOnSource<'_>) -> PanelParams {
    let window = it.placement.window;
    let panel = it.panel;
    let seen_from_sent = panel.scanout.seen_from_sent(panel.view.size);
    let rays = source_from_world(it.placement) * panel.view.ray_from_pixel() * seen_from_sent;
    let column = |v: DVec3| v.as_vec3().to_array();
    let [left, top, width, height] = it.part.map(f64::from);
    let extent = it.placement.extent();
    let scale = [width / extent[0], height / extent[1]];
    let offset = [left + window[0] * scale[0], top + window[2] * scale[1]];
    PanelParams {
        right: column(rays.x_axis),
        projection: match it.placement.projection {
            SourceProjection::Plane => 0,
            SourceProjection::Cylinder => 1,
            SourceProjection::Equirect => 2,
            SourceProjection::Fisheye => 3,
        },
        down: column(rays.y_axis),
        black: panel.black as f32,
        corner: column(rays.z_axis),
        origin: it.origin,
        size: panel.sent_size(),
        scale: scale.map(|k| k as f32),
        offset: offset.map(|k| k as f32),
        low: [left, top].map(|k| k as f32),
        high: [left + width, top + height].map(|k| k as f32),
        gain: panel.gain.map(|k| k as f32),
        channels: 1,
        ..PanelParams::default()
    }
}

/// From rays of the eye to rays to the right, down and forward of the source's axis.
fn source_from_world(placement: &Placement) -> DMat3 {
    let axes = placement.axes;
    let rows = DMat3::from_cols(axes.right, axes.down, axes.forward).transpose();
    rows * nearness(placement)
}

fn sight_of(placement: &Placement) -> SightParams {
    let columns = |m: DMat3| {
        m.as_mat3()
            .to_cols_array_2d()
            .map(|[x, y, z]| [x, y, z, 0.0])
    };
    let source_from_world = source_from_world(placement);
    SightParams {
        world_from_source: columns(source_from_world.inverse()),
        source_from_world: columns(source_from_world),
    }
}

/// From rays of the eye to rays of the head's middle, where the source is a plane at hand:
/// e (d . forward) + d (1 - e . forward).
fn nearness(placement: &Placement) -> DMat3 {
    if placement.projection != SourceProjection::Plane {
        return DMat3::IDENTITY;
    }
    let (eye, forward) = (placement.eye, placement.axes.forward);
    let sheared = DMat3::from_cols(eye * forward.x, eye * forward.y, eye * forward.z);
    sheared + DMat3::from_diagonal(DVec3::splat(1.0 - eye.dot(forward)))
}
