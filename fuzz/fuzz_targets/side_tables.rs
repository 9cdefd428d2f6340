//! Do any bytes in the side tables of a pack make selection panic or overspend?

#![no_main]

#[path = "../../crates/core/tests/side_tables/mod.rs"]
mod side_tables;

use libfuzzer_sys::fuzz_target;
use side_tables::Target;
use std::sync::OnceLock;

static TARGET: OnceLock<Target> = OnceLock::new();

fuzz_target!(|data: &[u8]| {
    let target = TARGET.get_or_init(Target::new);
    // A length that is right is hard to find: what is of another is also filled up or cut.
    let read = target.choose_by_anything(data);
    let mut whole = data.to_vec();
    whole.resize(
        2 + side_tables::table_bytes(&target.pack).iter().sum::<usize>(),
        0,
    );
    whole[0] = 1;
    assert!(read || target.choose_by_anything(&whole));
});
