//! A small scene in files, and jobs that use it.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use fathom_tests::root;
use imaging::codec::{encode_npy_plane, encode_png};
use imaging::{Plane, Raster, Rgb8};
use renderer::{Engine, RenderError, Rendered, SceneSource, Slot};
use serde_json::{Value, json};
use spec::Job;
use style::Library;
use tempfile::TempDir;

pub(crate) const WIDTH: usize = 48;
pub(crate) const HEIGHT: usize = 32;

/// A picture and its range: 1 m at the left to 5 m at the right, a hole in the corner.
pub(crate) struct Files {
    folder: TempDir,
}

impl Files {
    pub(crate) fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let picture = Rgb8::from_fn(WIDTH, HEIGHT, |x, y| [5 * x as u8, 7 * y as u8, 90]);
        write(
            &folder.path().join("rgb.png"),
            encode_png(&Raster::from(picture)).unwrap(),
        );
        let range = Plane::from_fn(WIDTH, HEIGHT, |x, y| match (x, y) {
            (0, 0) => f32::NAN,
            _ => 1.0 + 4.0 * x as f32 / (WIDTH - 1) as f32,
        });
        write(&folder.path().join("range.npy"), encode_npy_plane(&range));
        write(
            &folder.path().join("holes.npy"),
            encode_npy_plane(&range.map(|_| 0.0)),
        );
        Self { folder }
    }

    /// A job of one frame: these fields, over a scene with range.
    pub(crate) fn job(&self, fields: &Value) -> Job {
        parse(&self.description(fields))
    }

    /// The same, as stored by an older service that did not check for missing scene data.
    pub(crate) fn stored_job(&self, fields: &Value) -> Job {
        let mut description = self.description(fields);
        description["daylight"] = json!("auto");
        Job::from_canonical(&description.to_string()).unwrap()
    }

    pub(crate) fn description(&self, fields: &Value) -> Value {
        let mut description = json!({"scene": self.scene("range.npy"), "metrics": []});
        merge(&mut description, fields);
        description
    }

    pub(crate) fn scene(&self, range: &str) -> Value {
        json!({"kind": "files", "rgb": self.path("rgb.png"), "range": self.path(range)})
    }

    pub(crate) fn scene_without_range(&self) -> Value {
        json!({"kind": "files", "rgb": self.path("rgb.png")})
    }

    /// An instance mask in four columns with their classes: object 1, empty, objects 300 and 301.
    pub(crate) fn write_mask(&self, classes: &str) {
        let mask = Plane::from_fn(WIDTH, HEIGHT, |x, _| [1_u16, 0, 300, 301][4 * x / WIDTH]);
        write(
            &self.folder.path().join("mask.png"),
            encode_png(&Raster::from(mask)).unwrap(),
        );
        write(
            &self.folder.path().join("classes.json"),
            classes.as_bytes().to_vec(),
        );
    }

    pub(crate) fn scene_with_mask(&self) -> Value {
        let mut scene = self.scene("range.npy");
        scene["instances"] = self.path("mask.png").into();
        scene["classes"] = self.path("classes.json").into();
        scene
    }

    /// Writes another file into its folder.
    pub(crate) fn add(&self, name: &str, bytes: Vec<u8>) {
        write(&self.folder.path().join(name), bytes);
    }

    pub(crate) fn path(&self, name: &str) -> String {
        self.folder.path().join(name).to_str().unwrap().to_owned()
    }
}

fn write(path: &Path, bytes: Vec<u8>) {
    std::fs::write(path, bytes).unwrap();
}

fn merge(into: &mut Value, fields: &Value) {
    for (name, value) in fields.as_object().unwrap() {
        into[name] = value.clone();
    }
}

/// The shipped styles and `foreign`: the network of `muddy` under another graph name, so that only ONNX Runtime accepts it.
pub(crate) fn library() -> Library {
    let shipped = Library::embedded().unwrap();
    let mut onnx = shipped.get("muddy").unwrap().onnx.to_vec();
    let name = b"fathom_style";
    let at = onnx
        .windows(name.len())
        .position(|window| window == name)
        .unwrap();
    onnx[at] = b'F';
    let folder = tempfile::tempdir().unwrap();
    write(&folder.path().join("foreign.onnx"), onnx);
    shipped.with_dir(folder.path()).unwrap()
}

/// ONNX Runtime, if scripts/get-onnxruntime.sh has installed it.
pub(crate) fn installed_runtime() -> Option<PathBuf> {
    let installed = root().join(".onnxruntime/libonnxruntime.so");
    installed.is_file().then_some(installed)
}

/// An engine with these styles and the runtime installed by scripts/get-onnxruntime.sh.
pub(crate) fn engine() -> Arc<Engine> {
    Arc::new(Engine::new(library(), installed_runtime().as_deref()))
}

/// An engine whose runtime cannot be loaded.
pub(crate) fn engine_without_runtime() -> Arc<Engine> {
    Arc::new(Engine::new(
        library(),
        Some(Path::new("/nowhere/libonnxruntime.so")),
    ))
}

pub(crate) fn parse(description: &Value) -> Job {
    let vocabulary = renderer::vocabulary(&library(), true);
    Job::parse(description.to_string().as_bytes(), &vocabulary).unwrap_or_else(|invalid| panic!("{invalid}"))
}

/// The errors of a description.
pub(crate) fn parse_errors(description: &Value) -> Vec<spec::FieldError> {
    let vocabulary = renderer::vocabulary(&library(), true);
    Job::parse(description.to_string().as_bytes(), &vocabulary)
        .unwrap_err()
        .0
}

/// Frame 0 of a job.
pub(crate) fn render(job: &Job) -> Rendered {
    try_render(job, &engine_without_runtime()).unwrap()
}

pub(crate) fn try_render(job: &Job, engine: &Arc<Engine>) -> Result<Rendered, RenderError> {
    Slot::new(engine).render(&job.resolve(0).unwrap(), &SceneSource::Local)
}

/// The bytes of an artifact.
pub(crate) fn file<'a>(rendered: &'a Rendered, kind: &str) -> &'a [u8] {
    let found = rendered.files.iter().find(|file| file.kind == kind);
    &found.unwrap_or_else(|| panic!("no artifact {kind}")).bytes
}

/// The samples of a picture, apart from the text in its file, which names the kind.
pub(crate) fn pixels(rendered: &Rendered, kind: &str) -> Vec<u8> {
    let picture = imaging::codec::decode_picture(file(rendered, kind)).unwrap();
    picture.to_rgb8().pixels().flatten().collect()
}
