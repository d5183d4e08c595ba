//! Reads the user's files, and writes results so that no partial file is ever visible.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Context;
use imaging::Raster;
use imaging::codec;

use crate::exit::Failure;

/// Reads a file named by the user.
pub fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    fs::read(path).map_err(|error| Failure::BadInput(format!("{}: {error}", path.display())))
}

/// Reads and decodes a picture named by the user.
pub fn read_picture(path: &Path) -> Result<Raster, Failure> {
    decode_picture(path, &read(path)?)
}

/// Decodes a picture of the user. A color profile other than sRGB is named on standard error.
pub fn decode_picture(path: &Path, bytes: &[u8]) -> Result<Raster, Failure> {
    if let Some(profile) = codec::find_foreign_profile(bytes) {
        eprintln!(
            "note: {} has {profile}; its values are read as sRGB",
            path.display()
        );
    }
    codec::decode_picture(bytes).map_err(|error| Failure::BadInput(format!("{}: {error}", path.display())))
}

/// The pictures in a folder, sorted by name, without those in subfolders.
pub fn pictures(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    with_extensions(folder, &["png", "jpg", "jpeg", "webp"])
}

/// The files in a folder whose names end in one of these, sorted by name, without those in subfolders.
pub fn with_extensions(folder: &Path, extensions: &[&str]) -> Result<Vec<PathBuf>, Failure> {
    let unreadable = |error| Failure::BadInput(format!("{}: {error}", folder.display()));
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        let extension = path
            .extension()
            .and_then(|e| e.to_str())
            .unwrap_or_default()
            .to_ascii_lowercase();
        if path.is_file() && extensions.contains(&extension.as_str()) {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

/// Writes a file under a temporary name next to it and renames it into place.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    write_all(&[(path.to_owned(), bytes)])
}

/// Writes files that belong together: all are written before the first is renamed into place, and a failure leaves no
/// temporary files.
pub fn write_all(files: &[(PathBuf, &[u8])]) -> Result<(), Failure> {
    let temporary = |path: &Path| {
        let mut name = path.as_os_str().to_owned();
        name.push(format!(".part-{}", std::process::id()));
        PathBuf::from(name)
    };
    let written = files.iter().try_for_each(|(path, bytes)| {
        if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
            fs::create_dir_all(folder).with_context(|| format!("cannot create {}", folder.display()))?;
        }
        fs::write(temporary(path), bytes).with_context(|| format!("cannot write {}", path.display()))
    });
    let renamed = written.and_then(|()| {
        files.iter().try_for_each(|(path, _)| {
            fs::rename(temporary(path), path).with_context(|| format!("cannot write {}", path.display()))
        })
    });
    if renamed.is_err() {
        for (path, _) in files {
            // It may not exist.
            let _ = fs::remove_file(temporary(path));
        }
    }
    Ok(renamed?)
}

/// Writes a picture; the format follows the file's extension: `.png` (default), `.jpg`, `.webp`.
pub fn write_picture(path: &Path, picture: &Raster) -> Result<(), Failure> {
    write(path, &encode_picture(path, picture)?)
}

/// Encodes a picture in the format of the file's extension.
pub fn encode_picture(path: &Path, picture: &Raster) -> Result<Vec<u8>, Failure> {
    let extension = path
        .extension()
        .and_then(|e| e.to_str())
        .unwrap_or("png")
        .to_ascii_lowercase();
    let bytes = match extension.as_str() {
        "png" => codec::encode_png(picture),
        "jpg" | "jpeg" => codec::encode_jpeg(&picture.to_rgb8(), JPEG_QUALITY),
        "webp" => codec::encode_webp_lossless(&picture.to_rgb8()),
        other => {
            return Err(Failure::BadInput(format!(
                "{}: format `{other}` cannot be written; use png, jpg or webp",
                path.display()
            )));
        }
    }
    .with_context(|| format!("cannot encode {}", path.display()))?;
    Ok(bytes)
}

/// JPEG quality: visually lossless on ordinary frames.
const JPEG_QUALITY: u8 = 95;
