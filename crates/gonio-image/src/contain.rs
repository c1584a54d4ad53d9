//! Turns a panic inside a third party's decoder into an error.
//!
//! The OpenEXR decoder has assertions that a corrupt file can trip. A broken picture must not end a render, so decoders
//! run inside [`contain`]. In a build with `panic = "abort"` nothing can be caught, and such a file ends the process.

use std::any::Any;
use std::cell::Cell;
use std::panic::{self, AssertUnwindSafe};
use std::sync::Once;

thread_local! {
    static QUIET: Cell<bool> = const { Cell::new(false) };
}

/// Runs `decode`; a panic becomes `Err` with its message. Nothing is printed for it: a hook, set once, passes every other
/// panic on to the hook that was there before.
///
/// `decode` may leave no broken state behind: it owns what it builds, and that is dropped.
pub(crate) fn contain<T>(decode: impl FnOnce() -> T) -> Result<T, String> {
    static HOOK: Once = Once::new();
    // A hook cannot be set while this thread is panicking (a picture written by a destructor).
    if !std::thread::panicking() {
        HOOK.call_once(|| {
            let previous = panic::take_hook();
            panic::set_hook(Box::new(move |info| {
                if !QUIET.get() {
                    previous(info);
                }
            }));
        });
    }
    let before = QUIET.replace(true);
    let outcome = panic::catch_unwind(AssertUnwindSafe(decode));
    QUIET.set(before);
    outcome.map_err(|payload| message(payload.as_ref()))
}

fn message(payload: &(dyn Any + Send)) -> String {
    payload
        .downcast_ref::<&str>()
        .map(|s| (*s).to_string())
        .or_else(|| payload.downcast_ref::<String>().cloned())
        .unwrap_or_else(|| "no message".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_becomes_a_message_and_values_pass() {
        assert_eq!(contain(|| 7), Ok(7));
        assert_eq!(contain(|| panic!("seven")), Err::<(), _>("seven".into()));
        let n = 8;
        assert_eq!(
            contain(|| panic!("seven {n}")),
            Err::<(), _>("seven 8".into())
        );
        assert!(!QUIET.get(), "later panics are heard again");
    }
}
