//! Parses a scene upload.

use axum::body::Bytes;
use axum::extract::Multipart;
use spec::{Classes, RangeFile, RangeKind, SceneFiles};

use crate::decode::GivenCamera;
use crate::http::form::{Form, Kind};
use crate::http::problem::Problem;

const FIELDS: [(&str, Kind); 16] = [
    ("rgb", Kind::File),
    ("range", Kind::File),
    ("z_depth", Kind::File),
    ("instances", Kind::File),
    ("classes", Kind::File),
    ("pose", Kind::File),
    ("unit_m", Kind::Text),
    ("invalid_code", Kind::Text),
    ("fx", Kind::Text),
    ("focal_px", Kind::Text),
    ("cx", Kind::Text),
    ("cy", Kind::Text),
    ("hfov_deg", Kind::Text),
    ("scale", Kind::Text),
    ("collection", Kind::Text),
    ("name", Kind::Text),
];

/// Maximum length of a scene's name in a collection, characters: that of a file name.
const MAX_NAME: usize = 255;

/// The fields of a scene upload.
pub(super) struct SceneForm {
    rgb: Bytes,
    range: Option<Bytes>,
    z_depth: Option<Bytes>,
    instances: Option<Bytes>,
    classes: Option<Classes>,
    pose: Option<[[f64; 4]; 4]>,
    unit_m: Option<f64>,
    invalid_code: Option<u16>,
    focal_px: Option<f64>,
    cx: Option<f64>,
    cy: Option<f64>,
    hfov_deg: Option<f64>,
    scale: Option<f64>,
    /// The collection to add it to.
    pub(super) collection: Option<String>,
    /// Its name in the collection.
    pub(super) name: Option<String>,
}

impl SceneForm {
    /// Reads all fields and reports all errors together.
    pub(super) async fn read(body: Multipart) -> Result<Self, Problem> {
        let mut form = Form::read(body, &FIELDS).await?;
        if form.get("fx").is_some() && form.get("focal_px").is_some() {
            form.refuse(
                "fx",
                "`fx` is an alias of `focal_px`; send one of them".to_owned(),
            );
        }
        let focal_px = form.parsed("focal_px", "a number above 0", is_positive);
        let fx = form.parsed("fx", "a number above 0", is_positive);
        let classes = form.get("classes").map(|text| scenes::classes::read(text));
        let classes =
            classes.and_then(|read| read.map_err(|wrong| form.refuse_inside("classes", wrong)).ok());
        let pose = form.get("pose").map(|text| scenes::pose::read(text));
        let pose = pose.and_then(|read| read.map_err(|wrong| form.refuse_inside("pose", wrong)).ok());
        let (collection, name) = read_collection(&mut form);
        let scene = Self {
            rgb: form.get("rgb").cloned().unwrap_or_default(),
            range: form.get("range").cloned(),
            z_depth: form.get("z_depth").cloned(),
            instances: form.get("instances").cloned(),
            classes,
            pose,
            unit_m: form.parsed("unit_m", "a number above 0", is_positive),
            invalid_code: form.parsed("invalid_code", "a whole number in 0..=65535", |_| true),
            focal_px: focal_px.or(fx),
            cx: form.parsed("cx", "a finite number", |value: &f64| value.is_finite()),
            cy: form.parsed("cy", "a finite number", |value: &f64| value.is_finite()),
            hfov_deg: form.parsed("hfov_deg", "a number above 0 and below 180", |degrees: &f64| {
                *degrees > 0.0 && *degrees < 180.0
            }),
            scale: form.parsed("scale", "a number above 0", is_positive),
            collection,
            name,
        };
        scene.refuse_conflicts(&mut form);
        form.check()?;
        Ok(scene)
    }

    fn refuse_conflicts(&self, form: &mut Form) {
        form.require("rgb");
        if self.range.is_some() && self.z_depth.is_some() {
            form.refuse(
                "z_depth",
                "`range` and `z_depth` exclude each other; send one".to_owned(),
            );
        }
        if self.focal_px.is_some() && self.hfov_deg.is_some() {
            form.refuse(
                "hfov_deg",
                "`focal_px` and `hfov_deg` exclude each other; send one".to_owned(),
            );
        }
        if self.range.is_none() && self.z_depth.is_none() {
            for (name, is_given) in [
                ("unit_m", self.unit_m.is_some()),
                ("invalid_code", self.invalid_code.is_some()),
            ] {
                if is_given {
                    form.refuse(
                        name,
                        format!("`{name}` is for distances; send `range` or `z_depth` too"),
                    );
                }
            }
        }
        if self.camera().is_none() && (self.cx.is_some() || self.cy.is_some()) {
            form.refuse(
                "cx",
                "a principal point needs `focal_px` or `hfov_deg`".to_owned(),
            );
        }
    }

    /// The camera, if given.
    pub(super) fn camera(&self) -> Option<GivenCamera> {
        let Self {
            focal_px,
            cx,
            cy,
            hfov_deg,
            ..
        } = *self;
        (focal_px.is_some() || hfov_deg.is_some()).then_some(GivenCamera {
            focal_px,
            cx,
            cy,
            hfov_deg,
        })
    }

    /// The files, without their camera.
    pub(super) fn files(self) -> SceneFiles<Bytes> {
        let range = self.range.map(|file| (file, RangeKind::Range));
        let z_depth = self.z_depth.map(|file| (file, RangeKind::ZDepth));
        let (unit_m, invalid_code) = (self.unit_m, self.invalid_code);
        let (hfov_deg, scale) = (self.hfov_deg, self.scale);
        SceneFiles {
            rgb: self.rgb,
            range: range.or(z_depth).map(|(file, kind)| RangeFile {
                file,
                kind,
                unit_m,
                invalid_code,
            }),
            instances: self.instances,
            intrinsics: None,
            classes: self.classes,
            world_from_camera: self.pose,
            hfov_deg,
            scale,
        }
    }
}

fn read_collection(form: &mut Form) -> (Option<String>, Option<String>) {
    let collection = form.texts("collection").next();
    if let Some(name) = collection.as_deref().filter(|name| !spec::is_collection(name)) {
        let limit = spec::schema::Names::Collection.describe();
        form.refuse("collection", format!("collection is `{name}`; must be {limit}"));
    }
    let name = form.texts("name").next();
    if collection.is_none() && name.is_some() {
        form.refuse("name", "`name` needs `collection`".to_owned());
    }
    if name.as_deref().is_some_and(|name| !is_name(name)) {
        form.refuse(
            "name",
            format!("name must be 1 to {MAX_NAME} printable characters"),
        );
    }
    (collection, name)
}

fn is_positive(value: &f64) -> bool {
    *value > 0.0 && value.is_finite()
}

fn is_name(text: &str) -> bool {
    (1..=MAX_NAME).contains(&text.chars().count()) && !text.chars().any(char::is_control)
}
