//! Calls of libraries that panic on damaged files: of tens of thousands of damaged Parquet files some made the decoders
//! of bytes by stream and of dictionaries index out of bounds. Such a panic is an error like another.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::sync::Once;

thread_local! {
    /// Whether this thread is inside of [`catch_panic`], where a panic is not printed.
    static CATCHING: Cell<bool> = const { Cell::new(false) };
}

/// Calls; a panic is `Err(None)`, and nothing is printed of it. Nothing half done is used again.
pub(crate) fn catch_panic<T, E>(call: impl FnOnce() -> Result<T, E>) -> Result<T, Option<E>> {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let tell = take_hook();
        set_hook(Box::new(move |panic| {
            if !CATCHING.get() {
                tell(panic);
            }
        }));
    });
    CATCHING.set(true);
    let result = catch_unwind(AssertUnwindSafe(call));
    CATCHING.set(false);
    result.map_or(Err(None), |result| result.map_err(Some))
}
