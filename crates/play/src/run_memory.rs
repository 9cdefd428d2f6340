//! What does a player remember that makes pictures one by one?

use crate::rendered_worth::RenderedWorth;
use foveal_core::pack::unit::UnitId;
use std::collections::HashSet;

/// What is remembered from one picture to the next.
#[derive(Default)]
pub(crate) struct RunMemory {
    /// The session log so far.
    pub(crate) log: String,
    /// Units that were needed so far, and the pages of index and table that cover them.
    pub(crate) fetched: HashSet<UnitId>,
    pub(crate) pages: [HashSet<u32>; 2],
    /// Units that are damaged without which others cannot be shown.
    pub(crate) damaged_roots: HashSet<UnitId>,
    /// What measures worth by pictures, where that is asked for.
    pub(crate) rendered: Option<RenderedWorth>,
}
