//! What comes with a unit on its way to where it is drawn from?

use foveal_core::content::payload::PayloadView;
use foveal_core::pack::unit::UnitId;
use std::collections::HashMap;

/// The units that would refine parts of others, each part by its unit and its number in it.
pub type Refiners = HashMap<(UnitId, u8), UnitId>;

/// A unit of a scene on its way to where it is drawn from.
#[derive(Clone, Copy, Debug)]
pub struct Coming<'a> {
    /// Its number.
    pub unit: UnitId,
    /// Number of its object; of a page of a texture, which objects share, any.
    pub object: u16,
    /// Its level, 0 the finest: what it is tinted by.
    pub level: u8,
    /// Its prerequisites, all with lower numbers; they are there already.
    pub needs: &'a [UnitId],
    /// Which part of the first of these it refines, where it refines one as a whole: an octant of a
    /// cloud.
    pub part: Option<u8>,
    /// What it says.
    pub payload: PayloadView<'a>,
}
