//! Do any bytes in the side tables of a pack make selection panic or overspend?

#![no_main]

#[path = "../../crates/core/tests/side_tables/mod.rs"]
mod side_tables;

use foveal_core::asset::pack::Pack;
use libfuzzer_sys::fuzz_target;
use std::sync::OnceLock;

static PACK: OnceLock<Pack> = OnceLock::new();

fuzz_target!(|data: &[u8]| {
    let pack = PACK.get_or_init(side_tables::small_pack);
    // A length that is right is hard to find: what is short is filled up, what is long is cut.
    let _ = side_tables::choose_by_anything(pack, data);
    let mut whole = data.to_vec();
    whole.resize(2 + side_tables::table_bytes(pack).iter().sum::<usize>(), 0);
    whole[0] = 1;
    assert!(side_tables::choose_by_anything(pack, &whole));
});
