//! Starts the part of `fathom` that is written in Python.

use std::ffi::{OsStr, OsString};
use std::io::ErrorKind;
use std::process::{Command, ExitStatus};

use anyhow::Context;
use cli::exit::Failure;

/// Names the interpreter of the package that contains this program.
const INTERPRETER: &str = "FATHOM_PYTHON";
const MODULE: &str = "fathom.bag";
/// Succeeds if the module exists, without importing it.
const FIND: &str = "from importlib.machinery import PathFinder
package = PathFinder.find_spec('fathom')
places = package and package.submodule_search_locations
raise SystemExit(not (places and PathFinder.find_spec('fathom.bag', places)))";
const INSTALL: &str = "recordings need the Python package; install it with `pip install 'fathom-datasets[bag]'`, or name its \
                       interpreter in FATHOM_PYTHON";

/// Runs the module for recordings with the streams of this process, and returns its exit status.
pub(crate) fn run_module(arguments: &[OsString]) -> Result<u8, Failure> {
    let interpreter = std::env::var_os(INTERPRETER).unwrap_or_else(|| "python3".into());
    if !start(&interpreter, &["-c".into(), FIND.into()])?.success() {
        return Err(describe_missing(&interpreter));
    }
    let module = [OsString::from("-m"), MODULE.into()];
    let status = start(&interpreter, &[&module, arguments].concat())?;
    // A signal has no status.
    Ok(status
        .code()
        .and_then(|code| u8::try_from(code).ok())
        .unwrap_or(1))
}

fn start(interpreter: &OsStr, arguments: &[OsString]) -> Result<ExitStatus, Failure> {
    match Command::new(interpreter).args(arguments).status() {
        Err(error) if error.kind() == ErrorKind::NotFound => Err(describe_missing(interpreter)),
        status => Ok(status.with_context(|| format!("cannot start {}", interpreter.display()))?),
    }
}

fn describe_missing(interpreter: &OsStr) -> Failure {
    Failure::RuntimeMissing(format!("{INSTALL} (looked in {})", interpreter.display()))
}
