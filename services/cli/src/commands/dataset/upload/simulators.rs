//! Cameras, poses and classes that Isaac Sim and Kubric write next to their pictures.

use cli::exit::Failure;
use cli::files;
use serde_json::{Value, json};

use super::entries::Entry;
use super::plan::{CameraNumbers, FolderPlan, ScenePlan};
use super::poses::picture_axes;
use super::tum::matrix_of_quaternion;

/// The file of Kubric that describes camera and objects.
const METADATA: &str = "metadata.json";

/// Adds camera and poses of Kubric's `metadata.json`.
pub(super) fn add_kubric_camera(plan: &mut FolderPlan, entries: &[Entry]) -> Result<(), Failure> {
    for entry in entries.iter().filter(|entry| entry.file_name() == METADATA) {
        let metadata: Value = serde_json::from_slice(spec::skip_byte_order_mark(&files::read(&entry.path)?))
            .map_err(|error| Failure::BadInput(format!("{}: {error}", entry.name)))?;
        let camera = &metadata["camera"];
        let view = camera["field_of_view"].as_f64();
        for scene in plan
            .scenes
            .iter_mut()
            .filter(|scene| is_in_folder(scene, entry.folder()))
        {
            scene.camera.hfov_deg = view.map(f64::to_degrees);
            let number = scene.name.rsplit('/').next().unwrap_or_default().parse::<usize>();
            let Some(pose) = number.ok().and_then(|number| read_kubric_pose(camera, number)) else {
                continue;
            };
            scene.pose = Some(pose);
        }
        if view.is_none() {
            plan.notes
                .push(format!("{} has no `camera.field_of_view`", entry.name));
        }
        plan.unused.remove(&entry.name);
    }
    Ok(())
}

fn is_in_folder(scene: &ScenePlan, folder: &str) -> bool {
    scene.name.rsplit_once('/').map_or("", |(own, _)| own) == folder
}

/// A pose of axes right, up, back.
fn read_kubric_pose(camera: &Value, number: usize) -> Option<Vec<u8>> {
    let position: [f64; 3] = serde_json::from_value(camera["positions"].get(number)?.clone()).ok()?;
    let quaternion: [f64; 4] = serde_json::from_value(camera["quaternions"].get(number)?.clone()).ok()?;
    let matrix = picture_axes(matrix_of_quaternion(quaternion, position)?);
    Some(json!({"world_from_camera": matrix}).to_string().into_bytes())
}

/// Adds the camera of Isaac Sim's `camera_params_NUMBER.json` and the classes of its masks.
pub(super) fn add_isaac_parts(plan: &mut FolderPlan, entries: &[Entry]) -> Result<(), Failure> {
    for entry in entries {
        let stem = entry.stem();
        let params = stem.strip_prefix("camera_params_");
        let classes = stem.strip_prefix("instance_segmentation_semantics_mapping_");
        let Some(number) = params.or(classes).filter(|_| entry.extension() == "json") else {
            continue;
        };
        let scene = plan.scenes.iter_mut().find(|scene| {
            scene.name == number
                || scene
                    .name
                    .strip_suffix(number)
                    .is_some_and(|rest| rest.ends_with('/'))
        });
        let Some(scene) = scene else { continue };
        let value: Value = serde_json::from_slice(spec::skip_byte_order_mark(&files::read(&entry.path)?))
            .map_err(|error| Failure::BadInput(format!("{}: {error}", entry.name)))?;
        if params.is_some() {
            let Some(camera) = read_isaac_camera(&value) else {
                plan.notes.push(format!(
                    "{} has no `cameraFocalLength`, `cameraAperture` and `renderProductResolution`",
                    entry.name
                ));
                continue;
            };
            scene.camera = camera;
        } else {
            scene.mask_classes = Some(value);
        }
        plan.unused.remove(&entry.name);
    }
    Ok(())
}

fn read_isaac_camera(params: &Value) -> Option<CameraNumbers> {
    let focal = params["cameraFocalLength"].as_f64()?;
    let aperture = params["cameraAperture"][0].as_f64()?;
    let width = params["renderProductResolution"][0].as_f64()?;
    Some(CameraNumbers {
        focal_px: Some(width * focal / aperture),
        ..CameraNumbers::default()
    })
}
