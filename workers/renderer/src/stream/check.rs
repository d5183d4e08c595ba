//! Checks of an input before anything is computed. All errors are reported together.

use imaging::codec::MAX_PIXELS;
use imaging::geometry::Intrinsics;
use scenes::CameraPose;
use spec::Camera;

use super::error::InputError;
use super::input::{StreamInput, StreamPicture};

/// Largest difference of the two focal lengths, relative: the renderer assumes square pixels.
const SQUARE: f64 = 0.01;
/// Largest difference of the focal length from that of the job, relative.
const SAME_FOCAL: f64 = 0.01;

/// The checked parts of an input.
pub(super) struct Checked {
    /// The camera of the frame; `None` for that of the job.
    pub(super) camera: Option<Intrinsics>,
    pub(super) pose: Option<CameraPose>,
}

/// Checks an input of a job with this camera. `gives_hfov`: whether the job states its field of view.
pub(super) fn check_input(
    input: &StreamInput<'_>,
    gives_hfov: bool,
    job: &Camera,
) -> Result<Checked, Vec<InputError>> {
    let mut errors = Vec::new();
    errors.extend(find_picture_error(&input.picture));
    errors.extend(find_depth_error(input));
    errors.extend(find_mask_error(input));
    let mut checked = Checked {
        camera: None,
        pose: None,
    };
    if let Some(matrix) = &input.camera {
        match read_camera(matrix, input.picture.size, gives_hfov.then_some(job.hfov_deg)) {
            Ok(camera) => checked.camera = Some(camera),
            Err(message) => errors.push(InputError::new("camera", message)),
        }
    }
    if let Some(matrix) = &input.pose {
        match CameraPose::from_matrix(matrix) {
            Ok(_) if job.up.is_some() => errors.push(InputError::new(
                "pose",
                "contradicts `camera.up` of the job, because the z axis of its world points up; remove one of them",
            )),
            Ok(pose) => checked.pose = Some(pose),
            Err(reason) => errors.push(InputError::new(
                "pose",
                format!("is not a matrix from camera axes to the world: {reason}"),
            )),
        }
    }
    if errors.is_empty() {
        Ok(checked)
    } else {
        Err(errors)
    }
}

fn find_picture_error(picture: &StreamPicture<'_>) -> Option<InputError> {
    let (width, height) = picture.size;
    let message = if width == 0 || height == 0 {
        format!("is {width}×{height}; must be at least 1×1")
    } else if width.saturating_mul(height) > MAX_PIXELS {
        format!("is {width}×{height}; must be at most {MAX_PIXELS} pixels")
    } else {
        let needed = width * height * picture.channels.count();
        let held = picture.samples.count();
        if held == needed {
            return None;
        }
        format!(
            "holds {held} samples; {width}×{height} pixels in `{}` need {needed}",
            picture.channels.name()
        )
    };
    Some(InputError::new("rgb", message))
}

fn find_depth_error(input: &StreamInput<'_>) -> Option<InputError> {
    let depth = input.depth.as_ref()?;
    let ((width, height), (columns, rows)) = (depth.size, input.picture.size);
    if (width, height) != (columns, rows) {
        let message = format!(
            "is {width}×{height} but `rgb` is {columns}×{rows}; register the distances to the picture and resample them to its size"
        );
        return Some(InputError::new(depth.field(), message));
    }
    let held = depth.samples.count();
    (held != width.saturating_mul(height)).then(|| {
        InputError::new(
            depth.field(),
            format!("holds {held} samples; {width}×{height} need one for each pixel"),
        )
    })
}

fn find_mask_error(input: &StreamInput<'_>) -> Option<InputError> {
    let mask = input.instances.as_ref()?;
    let ((width, height), (columns, rows)) = (mask.size, input.picture.size);
    let held = mask.numbers.len();
    let message = if (width, height) != (columns, rows) {
        format!("is {width}×{height} but `rgb` is {columns}×{rows}; resample it to the size of the picture")
    } else if held != width.saturating_mul(height) {
        format!("holds {held} numbers; {width}×{height} need one for each pixel")
    } else {
        return None;
    };
    Some(InputError::new("instances", message))
}

/// The camera of a matrix. An error is the reason why the matrix is invalid or contradicts the picture or the job.
fn read_camera(
    matrix: &[[f64; 3]; 3],
    (width, height): (usize, usize),
    given_hfov_deg: Option<f64>,
) -> Result<Intrinsics, String> {
    let [[fx, skew, cx], [below, fy, cy], last] = *matrix;
    if matrix.as_flattened().iter().any(|value| !value.is_finite()) {
        return Err("must hold finite numbers".to_owned());
    }
    if skew != 0.0 || below != 0.0 || last != [0.0, 0.0, 1.0] {
        return Err("must be [[fx, 0, cx], [0, fy, cy], [0, 0, 1]]: rectify the picture".to_owned());
    }
    if fx <= 0.0 || fy <= 0.0 {
        return Err(format!("has the focal lengths {fx} and {fy} px; must be above 0"));
    }
    if (fx - fy).abs() > SQUARE * fx {
        return Err(format!(
            "has the focal lengths {fx} and {fy} px; must agree within {} %: resample the picture to square pixels",
            100.0 * SQUARE
        ));
    }
    for (name, center, side) in [("cx", cx, width), ("cy", cy, height)] {
        if !(-0.5..=side as f64 - 0.5).contains(&center) {
            return Err(format!(
                "has {name} {center}, outside of the picture of {width}×{height}; scale or crop it like the picture"
            ));
        }
    }
    let focal_px = (fx * fy).sqrt();
    if let Some(hfov_deg) = given_hfov_deg {
        let described = Camera::pinhole(width, height, hfov_deg).focal_px(width);
        if (described - focal_px).abs() > SAME_FOCAL * described {
            return Err(format!(
                "has a focal length of {focal_px:.1} px, but `camera.hfov_deg` of the job is {hfov_deg}, which is {described:.1} px; \
                 remove one of them"
            ));
        }
    }
    Ok(Intrinsics { focal_px, cx, cy })
}
