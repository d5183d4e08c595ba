//! The width of the terminal.

use std::sync::atomic::{AtomicBool, Ordering};

use console::Term;

/// Whether `--wide` was given.
static IS_WIDE: AtomicBool = AtomicBool::new(false);

/// Lets tables be as wide as they are.
pub(crate) fn set_wide() {
    IS_WIDE.store(true, Ordering::Relaxed);
}

/// Columns for prose: at most 100, in a file or a pipe too; `None` with `--wide`.
pub(crate) fn text_width() -> Option<usize> {
    const MOST: usize = 100;
    (!is_wide()).then(|| width().map_or(MOST, |columns| columns.min(MOST)))
}

/// Whether everything is shown in full.
pub(crate) fn is_wide() -> bool {
    IS_WIDE.load(Ordering::Relaxed)
}

/// Columns for a table: those of the variable `COLUMNS`, or else of the terminal; `None` in a file or a pipe, and with `--wide`.
pub(crate) fn width() -> Option<usize> {
    if is_wide() {
        return None;
    }
    let given = std::env::var("COLUMNS").ok().and_then(|text| text.parse().ok());
    let given = given.filter(|columns| *columns > 0);
    given.or_else(|| {
        Term::stdout()
            .size_checked()
            .map(|(_, columns)| usize::from(columns))
    })
}
