//! Does a reader survive files that are cut or changed?

use proptest::prelude::*;
use proptest::test_runner::TestRunner;

use super::{SceneFormat, read_anything};

/// Reads a small good file cut at every byte, with every byte changed in some ways, and with
/// several changed at once: it must be refused, or be a sound scene.
pub(super) fn cut_and_flip(format: SceneFormat, file: &[u8]) {
    assert!(read_anything(format, file), "the whole file is good");
    for end in 0..file.len() {
        read_anything(format, &file[..end]);
    }
    let mut changed = file.to_vec();
    for at in 0..file.len() {
        for flip in [0x01, 0x10, 0x80, 0xff] {
            changed[at] ^= flip;
            read_anything(format, &changed);
            changed[at] = file[at];
        }
    }
    let edits = prop::collection::vec((0..file.len(), any::<u8>()), 1..8);
    let run = TestRunner::deterministic().run(&edits, |edits| {
        let mut changed = file.to_vec();
        for (at, byte) in edits {
            changed[at] = byte;
        }
        read_anything(format, &changed);
        Ok(())
    });
    run.unwrap();
}
