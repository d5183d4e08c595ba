//! The archive with the files of a frame, which is not trusted.

use std::io::{self, Read};

use cli::exit::Failure;
use renderer::EXTENSIONS;

use crate::commands::dataset::export::input::frame::{Wanted, untrusted};

/// A file of an archive.
pub(crate) struct Unpacked {
    /// Position among the requested files.
    pub(crate) index: usize,
    pub(crate) name: String,
    pub(crate) bytes: Vec<u8>,
}

/// The files of an archive, with requested names and matching digests only.
pub(crate) fn unpacked(archive: &[u8], wanted: &[Wanted<'_>]) -> Result<Vec<Unpacked>, Failure> {
    let damaged = |error: io::Error| untrusted(format!("a damaged archive: {error}"));
    let mut archive = tar::Archive::new(archive);
    let mut files = Vec::new();
    for entry in archive.entries().map_err(damaged)? {
        let mut entry = entry.map_err(damaged)?;
        let name = String::from_utf8_lossy(&entry.path_bytes()).into_owned();
        let index = wanted.iter().position(|wanted: &Wanted<'_>| {
            let mut extensions = EXTENSIONS.iter();
            extensions.any(|(_, extension)| name == format!("{}.{extension}", wanted.kind))
        });
        let Some(index) = index.filter(|_| entry.header().entry_type().is_file()) else {
            return Err(untrusted(format!("a file {name:?} that was not requested")));
        };
        let mut bytes = Vec::new();
        entry.read_to_end(&mut bytes).map_err(damaged)?;
        if !wanted[index].is(&bytes) {
            return Err(untrusted(format!(
                "{name} with another digest than {}",
                wanted[index].digest
            )));
        }
        files.push(Unpacked { index, name, bytes });
    }
    Ok(files)
}
