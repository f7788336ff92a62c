//! Memory for the calls from C.
//!
//! Rust's collections end the process when an allocation fails, and nothing stable prevents that. So a call first sets
//! memory aside, as much as it can need: address space that is not touched and costs next to nothing. When the system
//! refuses an allocation of the call, it is taken from there instead. A call whose memory cannot be set aside fails
//! before it begins, with an error.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::os::raw::{c_int, c_void};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

extern "C" {
    fn mmap(at: *mut c_void, bytes: usize, protection: c_int, flags: c_int, descriptor: c_int, offset: i64) -> *mut c_void;
    fn munmap(at: *mut c_void, bytes: usize) -> c_int;
}
const READ_WRITE: c_int = 3;
const PRIVATE_ANONYMOUS: c_int = 0x22;
const FAILED: usize = usize::MAX;

/// Memory set aside of which something is in use. It is handed out from its beginning to its end, once.
#[derive(Clone, Copy)]
struct Region {
    begin: usize,
    end: usize,
    next: usize,
    /// Allocations that were not freed yet.
    live: usize,
    /// The call that had set it aside is running.
    held: bool,
}

/// More than threads run at a time.
const MOST_REGIONS: usize = 1024;
const NO_REGION: Region = Region { begin: 0, end: 0, next: 0, live: 0, held: false };
static REGIONS: Mutex<[Region; MOST_REGIONS]> = Mutex::new([NO_REGION; MOST_REGIONS]);
/// How many of them there are: while there are none, which is nearly always, nothing is searched.
static COUNT: AtomicUsize = AtomicUsize::new(0);

thread_local! {
    /// Begin and end of what this thread has set aside; 0 and 0 when there is nothing.
    static ASIDE: Cell<(usize, usize)> = const { Cell::new((0, 0)) };
}

fn regions() -> MutexGuard<'static, [Region; MOST_REGIONS]> {
    REGIONS.lock().unwrap_or_else(PoisonError::into_inner)
}

fn unmap(begin: usize, end: usize) {
    unsafe { munmap(begin as *mut c_void, end - begin) };
}

fn remove_if_unused(region: &mut Region) {
    if region.live == 0 && !region.held {
        unmap(region.begin, region.end);
        *region = NO_REGION;
        COUNT.fetch_sub(1, Ordering::Release);
    }
}

/// Memory that this thread has set aside, until the value is dropped.
pub struct Aside;

impl Aside {
    /// None when the system has no such amount of memory. One at a time for each thread.
    pub fn set(bytes: usize) -> Option<Aside> {
        let bytes = bytes.max(1);
        let begin = unsafe { mmap(std::ptr::null_mut(), bytes, READ_WRITE, PRIVATE_ANONYMOUS, -1, 0) } as usize;
        if begin == FAILED {
            return None;
        }
        ASIDE.with(|aside| aside.set((begin, begin + bytes)));
        Some(Aside)
    }
}

impl Drop for Aside {
    fn drop(&mut self) {
        let (begin, end) = ASIDE.with(|aside| aside.replace((0, 0)));
        if COUNT.load(Ordering::Acquire) == 0 {
            return unmap(begin, end);
        }
        let mut regions = regions();
        match regions.iter_mut().find(|region| region.begin == begin) {
            Some(region) => {
                region.held = false;
                remove_if_unused(region);
            }
            None => unmap(begin, end),
        }
    }
}

/// From what this thread has set aside; null when there is nothing or not enough.
fn take(layout: Layout) -> *mut u8 {
    let (begin, end) = ASIDE.try_with(Cell::get).unwrap_or_default();
    if begin == 0 {
        return std::ptr::null_mut();
    }
    let mut regions = regions();
    let place = regions
        .iter()
        .position(|region| region.begin == begin)
        .or_else(|| regions.iter().position(|region| region.begin == 0));
    let Some(place) = place else {
        return std::ptr::null_mut();
    };
    let region = &mut regions[place];
    if region.begin == 0 {
        *region = Region { begin, end, next: begin, live: 0, held: true };
        COUNT.fetch_add(1, Ordering::Release);
    }
    let at = region.next.next_multiple_of(layout.align());
    if at > region.end || region.end - at < layout.size() {
        return std::ptr::null_mut();
    }
    region.next = at + layout.size();
    region.live += 1;
    at as *mut u8
}

/// Frees what take() gave. False for other memory.
fn put_back(memory: *mut u8) -> bool {
    if COUNT.load(Ordering::Acquire) == 0 {
        return false;
    }
    let mut regions = regions();
    match regions.iter_mut().find(|region| region.begin <= memory as usize && (memory as usize) < region.end) {
        Some(region) => {
            region.live -= 1;
            remove_if_unused(region);
            true
        }
        None => false,
    }
}

fn is_of_a_region(memory: *mut u8) -> bool {
    COUNT.load(Ordering::Acquire) != 0
        && regions().iter().any(|region| region.begin <= memory as usize && (memory as usize) < region.end)
}

struct Allocator;

#[global_allocator]
static ALLOCATOR: Allocator = Allocator;

unsafe impl GlobalAlloc for Allocator {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let memory = System.alloc(layout);
        if memory.is_null() { take(layout) } else { memory }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        let memory = System.alloc_zeroed(layout);
        if memory.is_null() { take(layout) } else { memory } // nothing was ever written there
    }

    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, bytes: usize) -> *mut u8 {
        if !is_of_a_region(memory) {
            let moved = System.realloc(memory, layout, bytes);
            if !moved.is_null() {
                return moved;
            }
        }
        let moved = self.alloc(Layout::from_size_align_unchecked(bytes, layout.align()));
        if !moved.is_null() {
            std::ptr::copy_nonoverlapping(memory, moved, layout.size().min(bytes));
            self.dealloc(memory, layout);
        }
        moved
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        if !put_back(memory) {
            System.dealloc(memory, layout)
        }
    }
}
