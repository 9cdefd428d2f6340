//! What happens where the system gives no more memory?
//!
//! A line says so, and the program ends with 1, as after any other failure. What is half written
//! stays as after a kill.

use crate::report::out_of_memory::tell;
use std::alloc::{GlobalAlloc, Layout};

/// Also that of FFmpeg's libraries, which it replaces in the whole program: tiles come and go by
/// the thousand, and a tenth of the time of decoding them went into the system's allocator.
#[cfg(target_os = "linux")]
type Inner = mimalloc::MiMalloc;
#[cfg(target_os = "linux")]
const INNER: Inner = mimalloc::MiMalloc;
#[cfg(not(target_os = "linux"))]
type Inner = std::alloc::System;
#[cfg(not(target_os = "linux"))]
const INNER: Inner = std::alloc::System;

/// The allocator of the program, which never returns without memory.
pub(crate) struct Allocator(Inner);

impl Allocator {
    pub(crate) const fn new() -> Self {
        Self(INNER)
    }
}

fn or_end(memory: *mut u8, bytes: usize) -> *mut u8 {
    if memory.is_null() {
        end(bytes);
    }
    memory
}

#[cold]
fn end(bytes: usize) -> ! {
    tell(bytes);
    // Without destructors: these may need memory, and others hold locks.
    #[cfg(unix)]
    #[allow(unsafe_code, reason = "a call of C")]
    // SAFETY: it ends the process and touches none of its memory.
    unsafe {
        libc::_exit(1)
    }
    #[cfg(not(unix))]
    {
        std::process::abort()
    }
}

#[allow(unsafe_code, reason = "an allocator is unsafe to write")]
// SAFETY: each call is handed on as it came, and what comes back is what the inner allocator gave.
unsafe impl GlobalAlloc for Allocator {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        or_end(unsafe { self.0.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        or_end(unsafe { self.0.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, bytes: usize) -> *mut u8 {
        or_end(unsafe { self.0.realloc(memory, layout, bytes) }, bytes)
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        unsafe { self.0.dealloc(memory, layout) }
    }
}
