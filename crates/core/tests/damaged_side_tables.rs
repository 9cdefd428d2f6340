//! Can bytes in a side table make selection panic or overspend?

use crate::side_tables::{Target, table_bytes};
use foveal_core::view::random::Random;

#[test]
fn any_bytes_in_side_tables_are_refused_or_chosen_by() {
    let target = Target::new();
    let [signatures, cues] = table_bytes(&target.pack);
    assert_eq!(
        signatures,
        (28 * 3 + 8 * 3) * 12,
        "three short groups of each"
    );
    assert_eq!(cues, 28 * 3 * 4);
    let whole = 2 + signatures + cues;
    let mut random = Random::new(3);
    for turn in 0..60 {
        let most = [0.0, 1.0, 16.0, 256.0][turn % 4];
        let mut data: Vec<u8> = (0..whole).map(|_| (random.unit() * most) as u8).collect();
        data[..2].copy_from_slice(&[2, turn as u8]);
        assert!(target.choose_by_anything(&data), "{turn}");
        data[0] = 4;
        assert!(!target.choose_by_anything(&data), "another version");
        data[0] = 2;
        assert!(!target.choose_by_anything(&data[..1 + signatures]), "short");
    }
    assert!(!target.choose_by_anything(&[]));
}
