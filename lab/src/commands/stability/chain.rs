//! Failure modes of the water chain: the page of the findings and its pictures.

use std::path::Path;

use cli::exit::Failure;
use cli::files;
use imaging::Raster;
use lab::chain_stability::{findings, markdown};

use crate::machine;

/// Folder of the pictures, next to the page.
const PICTURES: &str = "stability-chain";

/// Writes the page; fails if a figure exceeds its limit.
pub(super) fn run(out: &Path) -> Result<(), Failure> {
    let findings = findings();
    let about = format!("Measured on {}.", machine::describe());
    let page = markdown(&findings, &about, |name| format!("{PICTURES}/{name}.png"));
    files::write(&out.join("stability-chain.md"), page.as_bytes())?;
    for (name, _, picture) in findings.iter().filter_map(|finding| finding.picture.as_ref()) {
        let path = out.join(PICTURES).join(format!("{name}.png"));
        files::write_picture(&path, &Raster::from(picture.clone()))?;
    }
    let broken: Vec<String> = findings.iter().flat_map(|finding| finding.broken()).collect();
    println!(
        "{} findings: {}",
        findings.len(),
        out.join("stability-chain.md").display()
    );
    if broken.is_empty() {
        return Ok(());
    }
    Err(Failure::BadInput(broken.join("\n")))
}
