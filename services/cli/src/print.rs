//! Printing to a closed pipe: in `fathom query | head`, the unread rest is dropped and the exit status is that of the command. The
//! macros replace those of the standard library, which panic.

use std::fmt;
use std::io::{ErrorKind, Write};

/// Prints a line to standard output.
#[macro_export]
macro_rules! println {
    ($($line:tt)*) => {
        $crate::print::line(&mut std::io::stdout().lock(), format_args!($($line)*))
    };
}

/// Prints a line to standard error.
#[macro_export]
macro_rules! eprintln {
    ($($line:tt)*) => {
        $crate::print::line(&mut std::io::stderr().lock(), format_args!($($line)*))
    };
}

/// Writes a line; ends the process if it cannot be written to a reader who is still there, such as a full disk.
pub fn line(out: &mut impl Write, text: fmt::Arguments<'_>) {
    if let Err(error) = writeln!(out, "{text}")
        && error.kind() != ErrorKind::BrokenPipe
    {
        // Standard error may be what cannot be written.
        let _ = writeln!(std::io::stderr(), "fathom: cannot print: {error}");
        std::process::exit(1);
    }
}
