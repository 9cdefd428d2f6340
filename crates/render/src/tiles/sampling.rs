//! Which samples of a frame are shown round the gaze?

use foveal_core::content::policy::PolicyConfig;
use foveal_core::content::video::grid::gather::Gather;
use foveal_core::content::video::grid::tile_grid::{Tile, TileGrid};
use foveal_core::gaze::sample::GazeSample;
use foveal_core::perception::samples::sample_mask::{MaskShape, SampleMask};
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::picture::Picture;
use std::collections::{BTreeMap, HashSet};

/// The mask that a policy asks for in a view: pixels count by the angles that they fill at the eye.
/// From a gaze at one border of the view, a mask of twice its width reaches the other.
#[must_use]
pub fn mask_shape(config: &PolicyConfig, view: &EyeView) -> MaskShape {
    let field = view.as_seen().field;
    MaskShape {
        side: config.mask.side.min(2 * view.size[0].max(view.size[1])),
        pitch: (field.left + field.right) / f64::from(view.size[0]),
        eye: config.acuity.clone(),
    }
}

/// How many samples that is.
#[must_use]
pub fn sample_count(config: &PolicyConfig, view: &EyeView) -> u32 {
    let wanted = || mask_shape(config, view).wanted_samples();
    config.mask.samples.unwrap_or_else(wanted)
}

/// A mask, and what was gathered for it.
pub(crate) struct Sampling {
    pub(crate) mask: SampleMask,
    /// Whether a sample is the mean of what it stands for, and interpolated where that is less than
    /// a texel, not its own pixel's texel alone.
    averages: bool,
    /// Decoded tiles of the frame.
    tiles: BTreeMap<Tile, Picture>,
}

/// Y, U and V of every sample, and the pixel of the view that the mask's top left lies on.
pub(crate) struct GatheredSamples {
    pub(crate) corner: [i32; 2],
    pub(crate) codes: Vec<u32>,
}

impl Sampling {
    /// The mask of a policy in a view.
    pub(crate) fn new(config: &PolicyConfig, view: &EyeView, averages: bool) -> Self {
        let shape = mask_shape(config, view);
        Self {
            mask: SampleMask::new(&shape, config.mask.samples),
            averages,
            tiles: BTreeMap::new(),
        }
    }

    /// Forgets the tiles of the frame before, but for the coarsest level: as in the atlas, it is
    /// shown until that of this frame has come.
    pub(crate) fn begin_frame(&mut self, coarsest: u8) {
        self.tiles.retain(|tile, _| tile.level == coarsest);
    }

    /// Keeps a decoded tile of the frame.
    pub(crate) fn keep(&mut self, tile: Tile, picture: Picture) {
        self.tiles.insert(tile, picture);
    }

    /// Forgets all tiles but these and those of the coarsest level.
    pub(crate) fn retain(&mut self, coarsest: u8, tiles: &[Tile]) {
        let tiles: HashSet<&Tile> = tiles.iter().collect();
        self.tiles
            .retain(|tile, _| tile.level == coarsest || tiles.contains(tile));
    }

    /// The samples round a gaze that the tiles kept show.
    pub(crate) fn gather(
        &self,
        grid: &TileGrid,
        view: &EyeView,
        gaze: &GazeSample,
    ) -> GatheredSamples {
        let half = (self.mask.side / 2) as i32;
        let gaze = gaze.gaze_in_content;
        let middle = view.place(gaze).unwrap_or([0.0; 2]);
        let corner = middle.map(|place| place.clamp(-1e6, 1e6).floor() as i32 - half);
        let footprint = grid.surface.locate(gaze).map_or(1.0, |(_, place)| {
            view.footprint(grid.surface.ppd(place), gaze)
        });
        let gather = Gather::new(grid, &self.tiles, footprint, self.averages);
        GatheredSamples {
            corner,
            codes: gather.codes(view, corner, &self.mask.places, |place| {
                if self.averages {
                    self.mask.spacing(place)
                } else {
                    1.0
                }
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use foveal_core::content::policy::Policy;
    use foveal_core::content::video::grid::tile_grid::Cut;
    use foveal_core::units::{Radians, Seconds};
    use foveal_core::view::surface::{Screen, Surface};

    #[test]
    fn until_a_frame_has_come_the_coarsest_level_of_the_one_before_is_sampled() {
        let surface = Surface::flat([256, 128], Screen::default());
        let grid = TileGrid::new(surface, Cut::Tile(64), 3, 2).unwrap();
        let view = EyeView::filling(&grid.surface, [256, 128]);
        let config = PolicyConfig::new(Policy::Sampled);
        let mut sampling = Sampling::new(&config, &view, true);
        for (level, luma) in [(2, 90), (0, 200)] {
            for tile in grid.tiles_of(level) {
                let [width, height] = grid.tile_size(tile);
                sampling.keep(tile, Picture::filled(width, height, [luma, 110, 140]));
            }
        }
        let gaze = GazeSample::at(Seconds(0.0), Radians(0.0), Radians(0.0));
        let shown = |sampling: &Sampling| {
            let mut codes = sampling.gather(&grid, &view, &gaze).codes;
            codes.dedup();
            codes
        };
        let code = |luma: u32| luma | 110 << 8 | 140 << 16;
        assert_eq!(shown(&sampling), [code(200)]);
        sampling.begin_frame(grid.coarsest());
        assert_eq!(shown(&sampling), [code(90)]);
    }
}
