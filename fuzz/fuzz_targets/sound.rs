//! Do any bytes in the side table `sound` make its parser panic, or read as something else?

#![no_main]

use foveal_core::content::video::bytes::sound::SoundTable;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    if let Ok(table) = SoundTable::parse(1, data) {
        assert_eq!(table.write(), data);
        let packets = (0..table.packets()).filter_map(|number| table.packet(number));
        let bytes: usize = packets.map(<[u8]>::len).sum();
        assert!(bytes <= data.len());
    }
});
