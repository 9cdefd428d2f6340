//! Do any bytes, read as what a judge found of a pack, panic or promise nonsense?

#![no_main]

use foveal_core::content::policy::calibration::Expectation;
use foveal_core::content::video::bytes::calibration_table::CALIBRATION_VERSION;
use foveal_core::content::video::calibration::{Calibration, ZoneLosses};
use foveal_core::units::Ppd;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    // The number of rows is hard to find: it is set by the length.
    let mut bytes = data.to_vec();
    let rows = (bytes.len().saturating_sub(8) / 32) as u32;
    bytes.truncate(8 + 32 * rows as usize);
    if let Some(count) = bytes.get_mut(4..8) {
        count.copy_from_slice(&rows.to_le_bytes());
    }
    let Ok(calibration) = Calibration::parse(CALIBRATION_VERSION, &bytes) else {
        return;
    };
    let losses = ZoneLosses {
        sums: [1.0, 10.0, 1e6],
        pixels: [10.0, 0.0, 5.0],
    };
    for ppd in [None, Some(Ppd(11.0))] {
        let scale = calibration.at(ppd);
        for rule in [Expectation::ByLoss, Expectation::Elsewise] {
            assert!(!scale.expected(rule, &losses).jod.is_nan());
        }
        let _ = (scale.bounds(9.5), calibration.cheaper(9.5, ppd));
    }
});
