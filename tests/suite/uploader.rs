//! A service and files to upload to it.

#![allow(clippy::unwrap_used)]

use std::path::PathBuf;

use fathom_tests::{Service, run};
use imaging::codec::{encode_npy_plane, encode_png};
use imaging::{Plane, Raster, Rgb8};
use serde_json::Value;

pub(crate) const SIZE: (usize, usize) = (24, 16);

pub(crate) struct Uploader {
    pub(crate) folder: tempfile::TempDir,
    pub(crate) service: Service,
}

/// Both outputs of an upload, and whether it succeeded.
pub(crate) struct Uploaded {
    pub(crate) is_complete: bool,
    pub(crate) out: String,
    pub(crate) err: String,
}

impl Uploader {
    pub(crate) fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let service = Service::start(&folder.path().join("data"), &["--workers", "0"]);
        Self { folder, service }
    }

    pub(crate) fn place(&self, name: &str) -> PathBuf {
        let path = self.folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        path
    }

    pub(crate) fn write(&self, name: &str, bytes: &[u8]) {
        std::fs::write(self.place(name), bytes).unwrap();
    }

    pub(crate) fn upload(&self, name: &str, options: &[&str]) -> Uploaded {
        let path = self.folder.path().join(name);
        let usual = ["upload", path.to_str().unwrap(), "--server", &self.service.url];
        let output = run(&[&usual[..], options].concat());
        Uploaded {
            is_complete: output.status.success(),
            out: String::from_utf8_lossy(&output.stdout).into_owned(),
            err: String::from_utf8_lossy(&output.stderr).into_owned(),
        }
    }

    /// The scenes of an upload, in its order.
    pub(crate) fn scenes(&self, uploaded: &Uploaded) -> Vec<Value> {
        assert!(uploaded.is_complete, "{}", uploaded.err);
        let ids = uploaded.out.lines().map(|line| line.split(' ').next().unwrap());
        ids.map(|id| self.service.get(&format!("/v1/scenes/{id}")).1)
            .collect()
    }
}

/// A different picture for each number, so that scenes differ.
pub(crate) fn picture(number: u8) -> Rgb8 {
    Rgb8::from_fn(SIZE.0, SIZE.1, |x, y| [(9 * x) as u8, (13 * y) as u8, number])
}

pub(crate) fn png(number: u8) -> Vec<u8> {
    encode_png(&picture(number).into()).unwrap()
}

pub(crate) fn distances(meters: f32) -> Vec<u8> {
    encode_npy_plane(&Plane::from_fn(SIZE.0, SIZE.1, |x, _| meters + x as f32 * 0.125))
}

pub(crate) fn millimeters(code: u16) -> Vec<u8> {
    encode_png(&Raster::from(Plane::filled(SIZE.0, SIZE.1, code))).unwrap()
}
