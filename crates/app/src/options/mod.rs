//! Options that several commands take.

pub(crate) mod bytes;
pub(crate) mod codec;
pub(crate) mod decoding;
pub(crate) mod hold;
pub(crate) mod link;
pub(crate) mod panels;
pub(crate) mod perception;
pub(crate) mod policy;
pub(crate) mod policy_choice;
pub(crate) mod policy_of_pack;
pub(crate) mod preset;
pub(crate) mod renderer;
pub(crate) mod showing;
pub(crate) mod unused;
pub(crate) mod watching;
