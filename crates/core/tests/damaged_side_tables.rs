//! Can bytes in a side table make selection panic or overspend?

mod side_tables;

use foveal_core::gaze::scan::Random;
use side_tables::{choose_by_anything, small_pack, table_bytes};

#[test]
fn any_bytes_in_side_tables_are_refused_or_chosen_by() {
    let pack = small_pack();
    let [signatures, cues] = table_bytes(&pack);
    assert_eq!(
        signatures,
        (28 * 3 + 8 * 3) * 9,
        "three short groups of each"
    );
    assert_eq!(cues, 28 * 3 * 4);
    let whole = 2 + signatures + cues;
    let mut random = Random::new(3);
    for turn in 0..60 {
        let most = [0.0, 1.0, 16.0, 256.0][turn % 4];
        let mut data: Vec<u8> = (0..whole).map(|_| (random.unit() * most) as u8).collect();
        data[..2].copy_from_slice(&[1, turn as u8]);
        assert!(choose_by_anything(&pack, &data), "{turn}");
        data[0] = 2;
        assert!(!choose_by_anything(&pack, &data), "another version");
        data[0] = 1;
        assert!(!choose_by_anything(&pack, &data[..1 + signatures]), "short");
    }
    assert!(!choose_by_anything(&pack, &[]));
}
