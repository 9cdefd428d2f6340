//! Do any bytes, read as rows of the table of a scene's units, panic or read back otherwise?

#![no_main]

use foveal_core::content::scene::unit_table::{read_units, write_units};
use foveal_core::pack::UnitNumbers;
use foveal_core::pack::paged_table::{PageDirectory, write_pages};
use libfuzzer_sys::fuzz_target;

/// Rows of the table that is tried.
const ROWS: u32 = 32;

fuzz_target!(|data: &[u8]| {
    // Any bytes as the one page of a table, whose checksums are right.
    let mut rows = vec![Vec::new(); ROWS as usize];
    rows[0] = data.to_vec();
    let table = write_pages(&rows, ROWS, &[]);
    let directory = PageDirectory::parse(&table, ROWS, table.len() as u64)
        .expect("the directory was just written");
    let place = directory.place(0);
    let page = &table[place.start as usize..place.end as usize];
    if let Ok(read) = read_units(&directory, 0, page) {
        let numbers = UnitNumbers::in_pages_of(ROWS, &[u64::from(ROWS)]).expect("few units");
        let again = write_units(&read, ROWS, &numbers);
        let directory = PageDirectory::parse(&again, ROWS, again.len() as u64)
            .expect("the directory was just written");
        let place = directory.place(0);
        let page = &again[place.start as usize..place.end as usize];
        assert_eq!(read_units(&directory, 0, page), Ok(read));
    }
});
