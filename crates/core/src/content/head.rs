//! How does the head of a log tell of content?

use crate::content::demand::Demand;
use crate::content::policy::PolicyConfig;
use crate::content::video::demand::VideoDemand;
use crate::content::video::grid::tile_grid::TileGrid;
use crate::content::video::units::{UnknownUnits, VideoUnits};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Most cells of a grid that is replayed from outside bytes.
const MOST_CELLS: u32 = 1 << 18;

/// What was chosen on, of any kind of content.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct ContentHead(TileGrid);

impl ContentHead {
    /// A video that is cut by this grid.
    #[must_use]
    pub fn of_video(grid: TileGrid) -> Self {
        Self(grid)
    }

    /// The grid of a video.
    #[must_use]
    pub fn video(&self) -> &TileGrid {
        &self.0
    }

    /// Whether every number is in range, so that it can be chosen on.
    ///
    /// # Errors
    /// Says which is not.
    pub fn check(&self) -> Result<(), String> {
        self.0.check().map_err(|error| format!("grid: {error}"))?;
        let cells = self.0.tiles_in_level(0);
        if cells > MOST_CELLS {
            return Err(format!(
                "grid: {cells} cells, at most {MOST_CELLS} are replayed"
            ));
        }
        if self
            .0
            .surface
            .tangents
            .iter()
            .all(|t| (1e-6..=1e6).contains(t))
        {
            Ok(())
        } else {
            Err("field, tangents: expected tangents between 1e-6 and 1e6".to_owned())
        }
    }

    /// What a viewer wants of such content, of which no more is known: rules need no more.
    ///
    /// # Panics
    /// Choosing then panics under a policy that needs signatures or cues.
    #[must_use]
    pub fn demand(&self, config: &PolicyConfig) -> Box<dyn Demand> {
        let units = Arc::new(UnknownUnits::new(self.0));
        self.demand_of(units, config)
    }

    /// What a viewer wants of video with these units, cut as the head says.
    #[must_use]
    pub fn demand_of(&self, units: Arc<dyn VideoUnits>, config: &PolicyConfig) -> Box<dyn Demand> {
        Box::new(VideoDemand::new(units, self.0, config.clone()))
    }
}
