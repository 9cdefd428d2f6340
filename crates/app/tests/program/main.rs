//! Does the whole program do what it says, from a file to the picture that an eye gets?
//!
//! Every test drives the real binary. Inputs are generated, folders go away with the test.

// A test that cannot go on panics.
#![allow(clippy::unwrap_used, clippy::expect_used)]

mod altered;
mod bounded;
mod bridge;
mod calibrated;
mod clouds;
mod damage;
mod demo;
mod documented;
mod documented_runs;
mod endurance;
mod experiments;
mod files;
mod fovea;
mod full;
mod gaze_events;
mod gaze_head;
mod hints;
mod journey;
mod kastner;
mod layouts;
mod live_gaze;
mod loss;
mod no_adapter;
mod numbers;
mod odd_sizes;
mod options;
mod own_eye;
mod panels;
mod panels_live;
mod panels_pack;
mod panels_warp;
mod paths;
mod perception;
mod perceptual;
mod policies;
mod prepare;
mod refusals;
mod results;
mod resume;
mod runs;
mod said;
mod scene;
mod scene_file;
mod scene_sides;
mod scene_textures;
mod scene_view;
mod scenes;
mod score;
mod score_conditions;
mod score_many;
mod selection;
mod serving;
mod site;
mod small_files;
mod spheres;
mod support;
mod unwritable;
mod view;
