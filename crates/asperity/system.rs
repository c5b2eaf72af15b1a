//! Lack of memory and files that grow too large, which the system would answer by ending the program without a sentence.
//!
//! The one module of the program with unsafe code. Its two reasons:
//!
//! - [`Memory`] hands every request on to the allocator of the system as it is.
//! - A signal is ignored, for which no code of this program runs.
//! - Without memory, standard error is written and the process ended by the system's own functions, which take no lock.
#![allow(
    unsafe_code,
    reason = "an allocator, a signal and the end without memory, as the module's text says"
)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::io::Write;
use std::sync::atomic::{AtomicBool, Ordering};

use asperity_io::remove_temporary_files;

#[global_allocator]
static MEMORY: Memory = Memory;

/// The allocator of the system. Where it has no more memory, the program ends with a sentence.
struct Memory;

// SAFETY: every method is that of `System`, and returns what that returns or not at all.
unsafe impl GlobalAlloc for Memory {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's promise.
        granted(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's promise.
        granted(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: the caller's promise.
        granted(unsafe { System.realloc(memory, layout, size) }, size)
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        // SAFETY: the caller's promise.
        unsafe { System.dealloc(memory, layout) }
    }
}

fn granted(memory: *mut u8, bytes: usize) -> *mut u8 {
    if memory.is_null() {
        end_without(bytes);
    }
    memory
}

thread_local! {
    /// `true` on the thread that ends the program.
    static ENDS: Cell<bool> = const { Cell::new(false) };
}

/// Ends the program for want of memory, without temporary files left behind as far as that takes none.
fn end_without(bytes: usize) -> ! {
    static IS_ENDING: AtomicBool = AtomicBool::new(false);
    if ENDS.replace(true) {
        exit_at_once();
    }
    if IS_ENDING.swap(true, Ordering::Relaxed) {
        loop {
            std::thread::park();
        }
    }
    // In memory that is there
    let mut line = [0; 128];
    let mut rest = line.as_mut_slice();
    let _ = writeln!(
        rest,
        "asperity: there is not enough memory: {bytes} bytes more are needed than this process may have"
    );
    let left = rest.len();
    say_unlocked(&line[..line.len() - left]);
    remove_temporary_files();
    exit_at_once()
}

/// Writes on standard error without its lock, which a thread that waits here may hold.
#[cfg(unix)]
fn say_unlocked(text: &[u8]) {
    // SAFETY: the memory of `text` may be read.
    let _ = unsafe { nix::libc::write(2, text.as_ptr().cast(), text.len()) };
}

#[cfg(not(unix))]
fn say_unlocked(text: &[u8]) {
    let _ = std::io::stderr().write_all(text);
}

/// Ends the process without what the end of a program does otherwise, which may wait for such a lock.
#[cfg(unix)]
fn exit_at_once() -> ! {
    // SAFETY: it does not return.
    unsafe { nix::libc::_exit(1) }
}

#[cfg(not(unix))]
fn exit_at_once() -> ! {
    std::process::exit(1)
}

/// Has writes beyond the largest size of a file fail with an error, as a full disk does, in place of a signal.
pub(crate) fn refuse_large_files() {
    #[cfg(unix)]
    {
        use nix::sys::signal::{SigHandler, Signal, signal};
        // SAFETY: no handler is installed.
        let _ = unsafe { signal(Signal::SIGXFSZ, SigHandler::SigIgn) };
    }
}
