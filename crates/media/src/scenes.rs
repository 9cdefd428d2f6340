//! Which pictures and files do the tests of this crate read?
