//! The boundary to the page: memory that both see. The one unsafe module.
//!
//! Invariant: a pointer that crosses the boundary is that of a boxed slice of bytes of the length that crosses with it, which nothing on this
//! side owns; so it can be taken back exactly once. The page keeps its part of it in `web/src/engine/wasm.ts`.

#![allow(unsafe_code)]

use std::ptr::slice_from_raw_parts_mut;

/// Gives away the bytes.
fn give(bytes: Vec<u8>) -> *mut u8 {
    Box::into_raw(bytes.into_boxed_slice()).cast()
}

/// Takes back what [`give`] gave.
///
/// # Safety
/// `pointer` is from [`give`], of `length` bytes, and was not taken back before.
unsafe fn take(pointer: *mut u8, length: usize) -> Box<[u8]> {
    // SAFETY: what the caller promises is what `Box::from_raw` needs.
    unsafe { Box::from_raw(slice_from_raw_parts_mut(pointer, length)) }
}

/// Room for a request of `length` bytes, which the page fills.
#[unsafe(no_mangle)]
pub extern "C" fn gonio_alloc(length: usize) -> *mut u8 {
    give(vec![0; length])
}

/// Takes back room of `length` bytes.
///
/// # Safety
/// As of [`take`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gonio_free(pointer: *mut u8, length: usize) {
    // SAFETY: the page's promise, above.
    drop(unsafe { take(pointer, length) });
}

/// Answers the request in room from [`gonio_alloc`], which stays the page's. The answer is as [`crate::Answer::into_bytes`] has it; its first number is
/// the length for [`gonio_free`].
///
/// # Safety
/// `pointer` is from [`gonio_alloc`], of `length` bytes, and was not taken back.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gonio_call(pointer: *const u8, length: usize) -> *mut u8 {
    // SAFETY: `gonio_alloc` made it readable for `length` bytes, and the page, which waits for the answer, doesn't write to it.
    let request = unsafe { std::slice::from_raw_parts(pointer, length) };
    let answer = crate::call(&String::from_utf8_lossy(request));
    give(answer.into_bytes())
}
