//! The native half of the Python package `fathom`. The Python half is in `python/fathom`, with the user documentation;
//! `_native.pyi` declares this one.
//!
//! Long operations run detached from the interpreter. Locks are taken only while attached to it, so that a process
//! forked by another thread never inherits a held lock.

mod arrays;
mod command;
mod errors;
mod job;
mod names;
mod pictures;
mod stream;
mod studio;

use pyo3::pymodule;

#[pymodule]
mod _native {
    #[pymodule_export]
    use crate::command::run;
    #[pymodule_export]
    use crate::job::Job;
    #[pymodule_export]
    use crate::names::names;
    #[pymodule_export]
    use crate::pictures::{decode, encode_png, enhance, measure};
    #[pymodule_export]
    use crate::stream::{Stream, StreamRecord};
}
