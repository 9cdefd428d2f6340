//! How is a film or a picture played under all policies, and what is shown of that?

mod atlas_sheet;
mod colours;
pub(super) mod common;
pub(super) mod content;
pub(super) mod facts;
pub(super) mod figures;
mod judging;
mod moment;
pub(super) mod pictures;
pub(super) mod run;
pub(super) mod setup;
