//! How often does this thread allocate, and how many bytes does it hold?

// An allocator is unsafe by its nature.
#![allow(unsafe_code)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
    static HELD: Cell<i64> = const { Cell::new(0) };
}

/// Allocations of this thread so far. The compiler takes it for granted that allocating changes
/// nothing else, so the number is read as if it could change at any time.
pub(crate) fn allocations() -> u64 {
    // SAFETY: the cell is this thread's own and lives as long as it.
    ALLOCATIONS.with(|count| unsafe { count.as_ptr().read_volatile() })
}

/// Bytes that this thread has allocated and not freed.
pub(crate) fn held() -> i64 {
    // SAFETY: as above.
    HELD.with(|held| unsafe { held.as_ptr().read_volatile() })
}

struct Counting;

#[global_allocator]
static ALLOCATOR: Counting = Counting;

// SAFETY: every call goes to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let _ = ALLOCATIONS.try_with(|count| count.set(count.get() + 1));
        let _ = HELD.try_with(|held| held.set(held.get() + layout.size() as i64));
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, place: *mut u8, layout: Layout) {
        let _ = HELD.try_with(|held| held.set(held.get() - layout.size() as i64));
        // SAFETY: the caller keeps the contract of `dealloc`.
        unsafe { System.dealloc(place, layout) }
    }
}
