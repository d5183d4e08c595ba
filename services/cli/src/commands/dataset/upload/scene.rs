//! Uploads one scene.

use std::collections::BTreeSet;
use std::path::PathBuf;

use cli::exit::Failure;
use cli::files;
use cli::plural::count;
use client::{Client, ClientError, Received, SceneView};
use imaging::codec::{decode_mask, has_distances};
use serde_json::json;
use ureq::unversioned::multipart::{Form, Part};

use super::arguments::{Arguments, EmbeddedDepth};
use super::color_masks::{number_colors, number_suim};
use super::layout::Layout;
use super::plan::{CameraNumbers, FolderPlan, ScenePlan};
use super::role::Role;

/// The bytes of a scene's form.
struct Contents(Vec<(&'static str, Vec<u8>)>);

impl Contents {
    fn has(&self, role: Role) -> bool {
        self.0.iter().any(|(field, _)| *field == role.field())
    }

    fn add(&mut self, role: Role, bytes: Vec<u8>) {
        if !self.has(role) {
            self.0.push((role.field(), bytes));
        }
    }

    fn get(&self, role: Role) -> Option<&[u8]> {
        let found = self.0.iter().find(|(field, _)| *field == role.field());
        found.map(|(_, bytes)| bytes.as_slice())
    }
}

/// Uploads a scene with the numbers of the options, of its files and of its layout, in this order.
pub(super) fn upload_scene(
    client: &Client,
    arguments: &Arguments,
    plan: &FolderPlan,
    scene: &ScenePlan,
) -> Result<Received<SceneView>, Failure> {
    let mut contents = Contents(Vec::new());
    for (role, path) in &scene.files {
        contents.add(*role, files::read(path)?);
    }
    number_mask(&mut contents, plan.layout, scene)?;
    if let Some(pose) = &scene.pose {
        contents.add(Role::Pose, pose.clone());
    }
    if let Some(classes) = read_shared_classes(arguments, &contents)? {
        contents.add(Role::Classes, classes);
    }
    let camera = match arguments.camera() {
        given if given.is_given() => given,
        _ => scene.camera,
    };
    add_embedded_depth(&mut contents, arguments, camera)?;
    let fields = list_fields(arguments, plan, scene, camera, &contents);
    let received = client.post_form("/v1/scenes", || {
        let texts = fields
            .iter()
            .fold(Form::new(), |form, (name, value)| form.text(name, value));
        contents.0.iter().fold(texts, |form, (name, bytes)| {
            form.part(name, Part::bytes(bytes).file_name(name))
        })
    });
    let is_folder = arguments.rgb.is_dir();
    let mut received: Received<SceneView> = received.map_err(|error| name_options(error, is_folder))?;
    if let (EmbeddedDepth::Ignore, Some(summary)) = (arguments.embedded_depth, &mut received.value.summary) {
        summary
            .notes
            .retain(|note| !note.contains("channel of distances"));
    }
    Ok(received)
}

/// Replaces a mask of colors by one of numbers, where the layout has such masks.
fn number_mask(contents: &mut Contents, layout: Layout, scene: &ScenePlan) -> Result<(), Failure> {
    let Some(mask) = contents.get(Role::Instances) else {
        return Ok(());
    };
    let numbered = match layout {
        Layout::Suim => number_suim(mask)?,
        layout if layout.has_color_masks() => number_colors(mask, scene.mask_classes.as_ref())?,
        _ => return Ok(()),
    };
    contents.0.retain(|(field, _)| *field != Role::Instances.field());
    contents.add(Role::Instances, numbered.png);
    if let Some(classes) = numbered.classes {
        contents.add(Role::Classes, classes);
    }
    Ok(())
}

/// Sends a picture with a channel of distances as distances too.
fn add_embedded_depth(
    contents: &mut Contents,
    arguments: &Arguments,
    camera: CameraNumbers,
) -> Result<(), Failure> {
    let picture = contents.get(Role::Picture).unwrap_or_default();
    if contents.has(Role::Range) || contents.has(Role::ZDepth) || !has_distances(picture) {
        return Ok(());
    }
    let role = match arguments.embedded_depth {
        EmbeddedDepth::Ignore => return Ok(()),
        EmbeddedDepth::Range => Role::Range,
        EmbeddedDepth::ZDepth if camera.is_given() => Role::ZDepth,
        EmbeddedDepth::ZDepth => {
            return Err(Failure::input(
                "the picture has a channel of distances; give --hfov-deg or --focal-px to use it as z-depth, or --embedded-depth \
                 range or ignore",
            ));
        }
    };
    let bytes = picture.to_vec();
    contents.add(role, bytes);
    Ok(())
}

/// The text fields of the form.
fn list_fields(
    arguments: &Arguments,
    plan: &FolderPlan,
    scene: &ScenePlan,
    camera: CameraNumbers,
    contents: &Contents,
) -> Vec<(&'static str, String)> {
    let number = |value: Option<f64>| value.map(|value| value.to_string());
    // The service rejects numbers of a range without a range, as it should for a single picture. Some pictures of a folder have none.
    let needs_unit = contents.has(Role::Range) || contents.has(Role::ZDepth) || !arguments.rgb.is_dir();
    let unit_m = arguments.unit_m.or(plan.unit_m).filter(|_| needs_unit);
    let invalid_code = arguments
        .invalid_code
        .or(plan.invalid_code)
        .filter(|_| needs_unit);
    let fields = [
        ("unit_m", number(unit_m)),
        ("invalid_code", number(invalid_code.map(f64::from))),
        ("focal_px", number(camera.focal_px)),
        ("hfov_deg", number(camera.hfov_deg)),
        ("cx", number(camera.cx)),
        ("cy", number(camera.cy)),
        ("scale", number(arguments.scale)),
        ("collection", arguments.collection.clone()),
        ("name", arguments.collection.as_ref().map(|_| scene.name.clone())),
    ];
    fields
        .into_iter()
        .filter_map(|(name, value)| Some((name, value?)))
        .collect()
}

/// The classes of --classes that a scene's mask shows.
fn read_shared_classes(arguments: &Arguments, contents: &Contents) -> Result<Option<Vec<u8>>, Failure> {
    let (Some(path), Some(mask)) = (&arguments.classes, contents.get(Role::Instances)) else {
        return Ok(None);
    };
    let classes = scenes::classes::read(&files::read(path)?);
    let classes = classes.map_err(|wrong| Failure::BadInput(format!("{}:\n{wrong}", path.display())))?;
    let Ok(mask) = decode_mask(mask) else {
        // The service reports the error.
        return Ok(None);
    };
    let shown: BTreeSet<u16> = mask.data().iter().copied().collect();
    let shown = classes.only(|number| shown.contains(&number));
    Ok(Some(json!(shown).to_string().into_bytes()))
}

/// Replaces the fields of the form by the options of this command. The files of a folder have no option.
fn name_options(error: ClientError, is_folder: bool) -> Failure {
    const NUMBERS: &[&str] = &[
        "hfov_deg",
        "focal_px",
        "cx",
        "cy",
        "unit_m",
        "invalid_code",
        "scale",
        "collection",
    ];
    const FILES: &[&str] = &["range", "z_depth", "instances", "classes", "pose"];
    let options = if is_folder { &[][..] } else { FILES };
    match Failure::from(error) {
        Failure::BadInput(message) => {
            let named = NUMBERS.iter().chain(options).fold(message, |message, field| {
                let option = format!("--{}", field.replace('_', "-"));
                message.replace(&format!("`{field}`"), &option)
            });
            Failure::BadInput(named)
        }
        other => other,
    }
}

/// The content of an uploaded scene in one line.
pub(super) fn describe_summary(scene: &SceneView) -> String {
    let mut parts = vec![format!("{}×{}", scene.width, scene.height)];
    let Some(summary) = &scene.summary else {
        return parts.remove(0);
    };
    match (summary.valid_share, summary.nearest_m, summary.farthest_m) {
        (Some(share), Some(nearest), Some(farthest)) => parts.push(format!(
            "range of {:.1} % of the pixels, {nearest:.3} to {farthest:.3} m",
            100.0 * share
        )),
        (Some(_), ..) => parts.push("no valid range".to_owned()),
        _ => parts.push("no range".to_owned()),
    }
    if let Some(objects) = summary.objects {
        let classes: Vec<String> = summary
            .classes
            .iter()
            .map(|class| format!("{} {} px", class.name, class.pixels))
            .collect();
        let separator = if classes.is_empty() { "" } else { ": " };
        parts.push(format!(
            "{}{separator}{}",
            count(objects, "object"),
            classes.join(", ")
        ));
    }
    parts.extend(summary.notes.iter().cloned());
    parts.join("; ")
}

/// A single picture with the files of the options.
pub(super) fn plan_picture(arguments: &Arguments) -> Result<ScenePlan, Failure> {
    let stem = arguments.rgb.file_stem().unwrap_or_default();
    let parts = [
        (Role::Picture, Some(&arguments.rgb)),
        (Role::Range, arguments.range.as_ref()),
        (Role::ZDepth, arguments.z_depth.as_ref()),
        (Role::Instances, arguments.instances.as_ref()),
    ];
    let files = parts
        .into_iter()
        .filter_map(|(role, path)| Some((role, PathBuf::from(path?))));
    let mut scene = ScenePlan {
        name: stem.to_string_lossy().into_owned(),
        files: files.collect(),
        ..ScenePlan::default()
    };
    // All classes of a single picture must occur, so they are not reduced to those of its mask.
    let own = [(Role::Classes, &arguments.classes), (Role::Pose, &arguments.pose)];
    scene.files.extend(
        own.into_iter()
            .filter_map(|(role, path)| Some((role, path.clone()?))),
    );
    Ok(scene)
}
