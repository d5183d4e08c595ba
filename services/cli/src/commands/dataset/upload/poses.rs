//! Poses and cameras of a folder's pictures, from the `transforms.json` of nerfstudio and its kin.

use std::collections::HashMap;
use std::path::Path;

use cli::exit::Failure;
use cli::files;
use imaging::codec::read_sides;
use serde::Deserialize;
use serde_json::{Map, Value, json};

use super::plan::{CameraNumbers, FolderPlan};
use super::role::Role;

/// The file with its camera, which each frame may replace.
#[derive(Deserialize)]
pub(super) struct Transforms {
    pub(super) frames: Vec<Transform>,
    #[serde(flatten)]
    camera: Map<String, Value>,
}

#[derive(Deserialize)]
pub(super) struct Transform {
    /// Path of the picture; some programs leave the extension out.
    pub(super) file_path: String,
    /// Absent if the pose is unknown.
    #[serde(default)]
    transform_matrix: Option<Matrix>,
    #[serde(default)]
    pub(super) depth_file_path: Option<String>,
    #[serde(default)]
    pub(super) mask_path: Option<String>,
    #[serde(flatten)]
    camera: Map<String, Value>,
}

/// Rows of the matrix from camera axes right, up, back to the world; some programs leave the last one out.
#[derive(Clone, Copy, Deserialize)]
#[serde(try_from = "Vec<[f64; 4]>")]
struct Matrix([[f64; 4]; 4]);

impl TryFrom<Vec<[f64; 4]>> for Matrix {
    type Error = String;

    fn try_from(rows: Vec<[f64; 4]>) -> Result<Self, String> {
        match rows[..] {
            [x, y, z] => Ok(Self([x, y, z, [0.0, 0.0, 0.0, 1.0]])),
            [x, y, z, last] => Ok(Self([x, y, z, last])),
            _ => Err(format!(
                "`transform_matrix` has {} rows; must be 3 or 4",
                rows.len()
            )),
        }
    }
}

/// Numbers of a camera that are read.
const CAMERA_KEYS: [&str; 6] = ["fl_x", "fl_y", "cx", "cy", "w", "h"];
/// Distortion, which a scene does not have.
const DISTORTION_KEYS: [&str; 7] = ["k1", "k2", "k3", "k4", "p1", "p2", "skew"];
/// From nerfstudio's coordinates, in which the first pixel's center is at 0.5.
const HALF_PIXEL: f64 = 0.5;
/// Largest relative difference of the two focal lengths of square pixels.
const SQUARE: f64 = 1e-3;

/// Adds the poses and cameras of a file to the scenes of a folder.
pub(super) fn add_poses(plan: &mut FolderPlan, path: &Path) -> Result<(), Failure> {
    let transforms = read(path)?;
    let index = FrameIndex::new(&transforms.frames);
    let mut used = vec![false; transforms.frames.len()];
    let mut found = 0;
    for scene in plan.scenes.iter_mut() {
        let matches = index.find(&scene.name, &transforms.frames);
        match matches[..] {
            [] => {}
            [index] => {
                let frame = &transforms.frames[index];
                used[index] = true;
                found += 1;
                let matrix = frame.transform_matrix.map(|matrix| picture_axes(matrix.0));
                if let (Some(matrix), false) = (matrix, scene.files.contains_key(&Role::Pose)) {
                    scene.pose = Some(json!({"world_from_camera": matrix}).to_string().into_bytes());
                }
                let picture = scene.files.get(&Role::Picture);
                let sides = picture.and_then(|path| read_sides(&std::fs::read(path).ok()?));
                match read_camera(&transforms.camera, &frame.camera, sides) {
                    Ok(camera) => scene.camera = camera,
                    Err(reason) => plan.problems.push(format!("{}: {reason}", frame.file_path)),
                }
            }
            _ => {
                matches.iter().for_each(|&index| used[index] = true);
                let names: Vec<&str> = matches
                    .iter()
                    .map(|&index| transforms.frames[index].file_path.as_str())
                    .collect();
                plan.problems.push(format!(
                    "the picture {} fits the frames {} of {}; keep the folders of the frames",
                    scene.name,
                    names.join(" and "),
                    path.display()
                ));
            }
        }
    }
    if found == 0 && plan.problems.is_empty() {
        let example = transforms.frames.first().map_or("none", |frame| &frame.file_path);
        plan.problems.push(format!(
            "no picture fits a frame of {}; its first frame is {example}",
            path.display()
        ));
    }
    describe(plan, path, &transforms, &used);
    Ok(())
}

pub(super) fn read(path: &Path) -> Result<Transforms, Failure> {
    let transforms: Transforms = serde_json::from_slice(spec::skip_byte_order_mark(&files::read(path)?))
        .map_err(|error| {
            Failure::BadInput(format!(
                "{} is not a transforms.json with `frames` of `file_path` and `transform_matrix`: {error}",
                path.display()
            ))
        })?;
    Ok(transforms)
}

/// Adds notes about the use of the file.
fn describe(plan: &mut FolderPlan, path: &Path, transforms: &Transforms, used: &[bool]) {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    for (frame, _) in transforms.frames.iter().zip(used).filter(|(_, used)| !**used) {
        plan.unused.add(
            &format!("{} in {name}", frame.file_path),
            "no picture of this path",
        );
    }
    let all = std::iter::once(&transforms.camera).chain(transforms.frames.iter().map(|frame| &frame.camera));
    let mut distorted: Vec<&str> = all
        .flat_map(|camera| {
            let keys = DISTORTION_KEYS.into_iter();
            keys.filter(|key| {
                camera
                    .get(*key)
                    .and_then(Value::as_f64)
                    .is_some_and(|value| value != 0.0)
            })
        })
        .collect();
    distorted.sort_unstable();
    distorted.dedup();
    let moved: Vec<&str> = ["applied_transform", "applied_scale"]
        .into_iter()
        .filter(|key| !matches!(transforms.camera.get(*key), None | Some(Value::Null)))
        .filter(|key| transforms.camera[*key].as_f64() != Some(1.0))
        .collect();
    if !moved.is_empty() {
        plan.notes.push(format!(
            "{name}: {} is not undone; poses are those of the file, in its units",
            moved.join(" and ")
        ));
    }
    if !distorted.is_empty() {
        plan.notes.push(format!(
            "{name}: {} are not used, since scenes have no distortion; undistort the pictures, or set `camera.distortion` in the job",
            distorted.join(", ")
        ));
    }
}

/// Frames by the name of their picture, with and without its extension.
struct FrameIndex(HashMap<String, Vec<usize>>);

impl FrameIndex {
    fn new(frames: &[Transform]) -> Self {
        let mut by_name: HashMap<String, Vec<usize>> = HashMap::new();
        for (index, frame) in frames.iter().enumerate() {
            let name = frame.file_path.rsplit(['/', '\\']).next().unwrap_or_default();
            let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
            by_name.entry(name.to_owned()).or_default().push(index);
            if stem != name {
                by_name.entry(stem.to_owned()).or_default().push(index);
            }
        }
        Self(by_name)
    }

    /// The frames whose paths fit that of a picture as far as both go; the longest fits win.
    fn find(&self, name: &str, frames: &[Transform]) -> Vec<usize> {
        let own = name.rsplit('/').next().unwrap_or_default();
        let candidates = self.0.get(own).map_or(&[][..], Vec::as_slice);
        let fits: Vec<(usize, usize)> = candidates
            .iter()
            .filter_map(|&index| Some((index, count_common_parts(name, &frames[index].file_path)?)))
            .collect();
        let longest = fits.iter().map(|(_, length)| *length).max();
        fits.into_iter()
            .filter(|(_, length)| Some(*length) == longest)
            .map(|(index, _)| index)
            .collect()
    }
}

/// Parts of two paths that agree from the end, if one path ends with the other. The extension of the frame is optional.
pub(super) fn count_common_parts(name: &str, frame_path: &str) -> Option<usize> {
    let frame_path = frame_path.replace('\\', "/");
    let parts: Vec<&str> = name
        .split('/')
        .filter(|part| !matches!(*part, "" | "."))
        .collect();
    let mut frame: Vec<&str> = frame_path
        .split('/')
        .filter(|part| !matches!(*part, "" | "."))
        .collect();
    let last = frame.pop()?;
    let stem = last.rsplit_once('.').map_or(last, |(stem, _)| stem);
    let picture = *parts.last()?;
    frame.push(if picture == last { last } else { stem });
    let length = parts.len().min(frame.len());
    let fits = parts
        .iter()
        .rev()
        .zip(frame.iter().rev())
        .all(|(one, other)| one == other);
    fits.then_some(length)
}

/// The camera of a frame, for a picture of these sides.
fn read_camera(
    shared: &Map<String, Value>,
    own: &Map<String, Value>,
    sides: Option<(usize, usize)>,
) -> Result<CameraNumbers, String> {
    let find = |key: &str| own.get(key).or_else(|| shared.get(key)).and_then(Value::as_f64);
    let [fl_x, fl_y, cx, cy, width, height] = CAMERA_KEYS.map(find);
    let Some(fl_x) = fl_x else {
        return Ok(CameraNumbers {
            hfov_deg: find("camera_angle_x").map(f64::to_degrees),
            ..CameraNumbers::default()
        });
    };
    if let Some(fl_y) = fl_y.filter(|fl_y| (fl_y / fl_x - 1.0).abs() > SQUARE) {
        return Err(format!(
            "fl_x is {fl_x} and fl_y is {fl_y}, but pixels must be square; resample the pictures"
        ));
    }
    let scale = match (sides, width, height) {
        (Some((columns, rows)), Some(width), Some(height)) => {
            let [across, down] = [columns as f64 / width, rows as f64 / height];
            if (across / down - 1.0).abs() > SQUARE {
                return Err(format!(
                    "w and h are {width} and {height} but the picture is {columns}×{rows}"
                ));
            }
            across
        }
        _ => 1.0,
    };
    Ok(CameraNumbers {
        focal_px: Some(fl_x * scale),
        hfov_deg: None,
        cx: cx.map(|cx| cx * scale - HALF_PIXEL),
        cy: cy.map(|cy| cy * scale - HALF_PIXEL),
    })
}

/// From camera axes right, up, back to right, down, ahead: the second and the third axis turn around.
pub(super) fn picture_axes(matrix: [[f64; 4]; 4]) -> [[f64; 4]; 4] {
    let [x, y, z, last] = matrix;
    let rows = [x, y, z].map(|[right, up, back, place]| [right, 0.0 - up, 0.0 - back, place]);
    [rows[0], rows[1], rows[2], last]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_axes_of_nerfstudio_become_those_of_pictures() {
        let given = [
            [1.0, 0.0, 0.0, 7.0],
            [0.0, 0.0, -1.0, 8.0],
            [0.0, 1.0, 0.0, 9.0],
            [0.0, 0.0, 0.0, 1.0],
        ];
        let expected = [
            [1.0, 0.0, 0.0, 7.0],
            [0.0, 0.0, 1.0, 8.0],
            [0.0, -1.0, 0.0, 9.0],
            [0.0, 0.0, 0.0, 1.0],
        ];
        assert_eq!(picture_axes(given), expected);
    }

    #[test]
    fn paths_fit_as_far_as_both_go() {
        for (name, frame, parts) in [
            ("0001", "cam0/0001.png", Some(1)),
            ("cam0/0001", "cam0/0001.png", Some(2)),
            ("cam0/0001", "./images/cam0/0001", Some(2)),
            ("cam0/0001", r"C:\data\cam0\0001.png", Some(2)),
            ("images/cam0/0001", "cam0/0001.jpg", Some(2)),
            ("cam1/0001", "cam0/0001.png", None),
            ("a.0001", "a.0001.png", Some(1)),
            ("a.0001", "a.0001", Some(1)),
            ("0001", "10001.png", None),
        ] {
            assert_eq!(count_common_parts(name, frame), parts, "{name} {frame}");
        }
    }

    #[test]
    fn the_camera_of_a_frame_follows_the_size_of_its_picture() {
        let map = |value: Value| value.as_object().unwrap().clone();
        let shared = map(json!({"fl_x": 60.0, "fl_y": 60.0, "cx": 32.0, "cy": 24.0, "w": 64, "h": 48}));
        let camera = read_camera(&shared, &Map::new(), Some((128, 96))).unwrap();
        assert_eq!(
            (camera.focal_px, camera.cx, camera.cy),
            (Some(120.0), Some(63.5), Some(47.5))
        );
        let own = map(json!({"fl_x": 30.0, "fl_y": 30.0}));
        assert_eq!(
            read_camera(&shared, &own, Some((64, 48))).unwrap().focal_px,
            Some(30.0)
        );
        assert!(read_camera(&shared, &Map::new(), Some((64, 64))).is_err());
        assert!(read_camera(&shared, &map(json!({"fl_y": 90.0})), None).is_err());
        let angle = map(json!({"camera_angle_x": std::f64::consts::FRAC_PI_2}));
        assert_eq!(
            read_camera(&angle, &Map::new(), None).unwrap().hfov_deg,
            Some(90.0)
        );
    }
}
