//! Does core keep its promises when its parts work together?
//!
//! One program for all of them: each would link the whole crate again.

// A test that cannot go on panics; one says what it measured.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::print_stdout)]
// `any_order` is also a module of a program for browsers, and brings along what it uses.
#![allow(clippy::duplicate_mod)]

mod any_order;
mod boxes;
mod counting;
mod damaged_point_units;
mod damaged_scene_packs;
mod damaged_side_tables;
mod head_gaze_allocates_nothing;
mod image_pages;
mod keys_are_told_everywhere;
mod looking;
mod made_video;
mod many_viewers;
mod mesh_units;
mod point_units;
mod scene_in_any_order;
mod scene_packs;
mod second_kind;
mod session_in_any_order;
mod side_tables;
mod signature_predicts_importance;
mod tracker_at_any_rate;
