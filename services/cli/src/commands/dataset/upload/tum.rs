//! Folders of the TUM RGB-D benchmark: `rgb.txt` and `depth.txt` list files by time, `groundtruth.txt` poses.

use cli::exit::Failure;
use cli::files;
use serde_json::json;

use super::entries::Entry;
use super::plan::{Assigned, FolderPlan};
use super::role::Role;

const PICTURES: &str = "rgb.txt";
const DEPTHS: &str = "depth.txt";
const POSES: &str = "groundtruth.txt";
/// Longest time between a picture and its depth or pose, s; that of the benchmark's tools.
const MAX_DELAY_S: f64 = 0.02;
/// Meters of one unit of a depth file.
const UNIT_M: f64 = 0.0002;

/// A line of a list.
struct Timed {
    time_s: f64,
    rest: String,
}

/// Makes a scene of each line of `rgb.txt`, with the depth and the pose nearest in time.
pub(super) fn plan_tum(plan: &mut FolderPlan, entries: &[Entry]) -> Result<(), Failure> {
    let pictures = read_list(entries, PICTURES)?;
    let depths = read_list(entries, DEPTHS)?;
    let has_poses = entries.iter().any(|entry| entry.name == POSES);
    let poses = match has_poses {
        true => read_list(entries, POSES)?,
        false => Vec::new(),
    };
    (plan.unit_m, plan.invalid_code) = (Some(UNIT_M), Some(0));
    let find = |name: &str| entries.iter().find(|entry| entry.name == name);
    let mut assigned = Vec::new();
    let mut scene_poses = Vec::new();
    for picture in &pictures {
        let Some(entry) = find(&picture.rest) else {
            plan.problems.push(describe_missing(PICTURES, picture));
            continue;
        };
        let scene = entry.stem().to_owned();
        let depth = find_nearest(&depths, picture.time_s);
        match depth.map(|depth| (depth, find(&depth.rest))) {
            Some((_, Some(depth))) => assigned.push(Assigned {
                entry: depth,
                role: Role::ZDepth,
                scene: scene.clone(),
            }),
            Some((listed, None)) => plan.problems.push(describe_missing(DEPTHS, listed)),
            None => plan
                .notes
                .push(format!("{} has no depth within {MAX_DELAY_S} s", entry.name)),
        }
        match find_nearest(&poses, picture.time_s) {
            Some(pose) => scene_poses.push((scene.clone(), read_pose(&pose.rest)?)),
            None if has_poses => plan
                .notes
                .push(format!("{} has no pose within {MAX_DELAY_S} s", entry.name)),
            None => {}
        }
        assigned.push(Assigned {
            entry,
            role: Role::Picture,
            scene,
        });
    }
    let reason = format!("no line of {PICTURES} or {DEPTHS} within {MAX_DELAY_S} s uses it");
    plan.add_unassigned(entries, &assigned, &[PICTURES, DEPTHS, POSES], &reason);
    plan.add_scenes(assigned);
    for (name, pose) in scene_poses {
        if let Some(scene) = plan.scenes.iter_mut().find(|scene| scene.name == name) {
            scene.pose = Some(pose);
        }
    }
    Ok(())
}

fn describe_missing(list: &str, line: &Timed) -> String {
    format!("{list} lists {}, which does not exist", line.rest)
}

fn read_list(entries: &[Entry], name: &str) -> Result<Vec<Timed>, Failure> {
    let missing = || Failure::BadInput(format!("the layout tum needs {name}"));
    let entry = entries
        .iter()
        .find(|entry| entry.name == name)
        .ok_or_else(missing)?;
    let text = String::from_utf8_lossy(&files::read(&entry.path)?).into_owned();
    let lines = text.lines().enumerate();
    let lines = lines.filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'));
    lines
        .map(|(number, line)| {
            let (time, rest) = line.trim().split_once(char::is_whitespace).unwrap_or((line, ""));
            let time_s = time.parse().map_err(|_| {
                Failure::BadInput(format!(
                    "{name}, line {}: `{time}` is not a time in seconds",
                    number + 1
                ))
            })?;
            Ok(Timed {
                time_s,
                rest: rest.trim().to_owned(),
            })
        })
        .collect()
}

fn find_nearest(list: &[Timed], time_s: f64) -> Option<&Timed> {
    let delay = |timed: &Timed| (timed.time_s - time_s).abs();
    list.iter()
        .filter(|timed| delay(timed) <= MAX_DELAY_S)
        .min_by(|one, other| f64::total_cmp(&delay(one), &delay(other)))
}

/// A pose `tx ty tz qx qy qz qw` from camera axes right, down, ahead.
fn read_pose(text: &str) -> Result<Vec<u8>, Failure> {
    let numbers: Result<Vec<f64>, _> = text.split_whitespace().map(str::parse).collect();
    let matrix = match numbers.as_deref() {
        Ok(&[tx, ty, tz, qx, qy, qz, qw]) => matrix_of_quaternion([qw, qx, qy, qz], [tx, ty, tz]),
        _ => None,
    };
    let Some(matrix) = matrix else {
        let message = format!("{POSES}: `{text}` is not `tx ty tz qx qy qz qw` with a rotation");
        return Err(Failure::BadInput(message));
    };
    Ok(json!({"world_from_camera": matrix}).to_string().into_bytes())
}

/// Rows of the matrix of a rotation w, x, y, z and a translation; `None` for a quaternion without a direction.
pub(super) fn matrix_of_quaternion(quaternion: [f64; 4], [tx, ty, tz]: [f64; 3]) -> Option<[[f64; 4]; 4]> {
    let norm = quaternion.iter().map(|part| part * part).sum::<f64>().sqrt();
    if !norm.is_normal() {
        return None;
    }
    let [w, x, y, z] = quaternion.map(|part| part / norm);
    Some([
        [
            1.0 - 2.0 * (y * y + z * z),
            2.0 * (x * y - z * w),
            2.0 * (x * z + y * w),
            tx,
        ],
        [
            2.0 * (x * y + z * w),
            1.0 - 2.0 * (x * x + z * z),
            2.0 * (y * z - x * w),
            ty,
        ],
        [
            2.0 * (x * z - y * w),
            2.0 * (y * z + x * w),
            1.0 - 2.0 * (x * x + y * y),
            tz,
        ],
        [0.0, 0.0, 0.0, 1.0],
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quarter_turn_about_z_takes_x_to_y() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let matrix = matrix_of_quaternion([half, 0.0, 0.0, half], [7.0, 8.0, 9.0]).unwrap();
        for (row, expected) in
            matrix
                .iter()
                .zip([[0.0, -1.0, 0.0, 7.0], [1.0, 0.0, 0.0, 8.0], [0.0, 0.0, 1.0, 9.0]])
        {
            for (value, expected) in row.iter().zip(expected) {
                assert!((value - expected).abs() < 1e-12, "{matrix:?}");
            }
        }
    }

    #[test]
    fn a_line_that_is_no_pose_is_rejected() {
        for text in [
            "1 2 3 0 0 0",
            "1 2 3 x 0 0 0 1",
            "1 2 3 0 0 0 0",
            "1 2 3 0 0 0 nan",
        ] {
            assert!(read_pose(text).is_err(), "{text}");
        }
        assert!(read_pose("1 2 3 0 0 0 1").is_ok());
    }

    #[test]
    fn the_nearest_line_in_time_is_found_within_the_limit() {
        let timed = |time_s| Timed {
            time_s,
            rest: String::new(),
        };
        let list = [timed(1.0), timed(1.03), timed(1.041)];
        assert_eq!(find_nearest(&list, 1.035).map(|timed| timed.time_s), Some(1.03));
        assert!(find_nearest(&list, 1.1).is_none());
    }
}
