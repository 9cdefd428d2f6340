//! One module a command: what it takes, what it does, what it says.

pub(crate) mod bench;
pub(crate) mod calibrate;
pub(crate) mod demo;
pub(crate) mod evaluate;
pub(crate) mod formats;
pub(crate) mod gaze;
pub(crate) mod info;
pub(crate) mod panels;
pub(crate) mod perception;
pub(crate) mod prepare;
pub(crate) mod replay;
pub(crate) mod score;
pub(crate) mod select;
pub(crate) mod serve;
pub(crate) mod simulate;
pub(crate) mod site;
pub(crate) mod verify;
pub(crate) mod view;
