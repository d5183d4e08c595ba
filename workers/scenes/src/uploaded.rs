//! Scenes from files: a picture with an optional range or z-depth map, camera and instance mask.
//!
//! Pictures of integer codes are sRGB-encoded; floats are linear radiance. Orientation tags turn the picture as viewers
//! show it. A map of the shown size is taken as it is; one of the stored size is turned like its picture. There are no
//! guesses: a map of integer codes needs the length of its unit and the code for "no value".

use imaging::codec::{self, FilePlane, Orientation, Radiance};
use imaging::geometry::{Intrinsics, range_from_z_depth};
use imaging::transfer::{Transfer, decode_raster};
use imaging::{Plane, Rgb};
use spec::{Classes, RangeFile, RangeKind, SceneFiles};

use super::scene::Scene;
use crate::{SceneError, labels};

/// Limit on the objects of an instance mask: each adds time to a frame with boxes.
pub const MAX_OBJECTS: usize = 10_000;
/// Limit on the numbers listed in an error.
const MAX_LISTED: usize = 10;

/// Decodes a scene. Holes of the range are NaN; negative radiances are kept and clamped later by the chain, which
/// counts them.
///
/// # Errors
/// [`SceneError`]: an unusable file, sizes that differ, a number that is missing or out of range, a non-finite
/// radiance.
pub fn decode<T: AsRef<[u8]>>(upload: &SceneFiles<T>) -> Result<Scene, SceneError> {
    if let Some(camera) = &upload.intrinsics {
        check_camera(camera)?;
    }
    let radiance = decode_radiance(upload.rgb.as_ref(), upload.scale)?;
    let picture = PictureSize {
        shown: radiance.size(),
        orientation: Orientation::read(upload.rgb.as_ref()),
    };
    let intrinsics = upload.intrinsics;
    let range = upload.range.as_ref();
    let range = range.map(|file| decode_range(file, intrinsics, &picture));
    let instances = upload.instances.as_ref();
    let instances = instances.map(|file| decode_instances(file.as_ref(), &picture));
    Ok(Scene {
        radiance,
        range: range.transpose()?,
        instances: instances.transpose()?,
        intrinsics,
        normals: None,
    })
}

/// Checks the instance mask and the classes of a new scene. Previously stored scenes are exempt.
///
/// # Errors
/// [`SceneError::Objects`].
pub fn check_objects(scene: &Scene, classes: Option<&Classes>) -> Result<(), SceneError> {
    let Some(mask) = &scene.instances else {
        return classes.map_or(Ok(()), |_| {
            Err(SceneError::Objects {
                field: "classes",
                reason: "they describe the objects of `instances`, which is missing".to_owned(),
            })
        });
    };
    let objects = labels::objects(mask);
    if objects.len() > MAX_OBJECTS {
        return Err(SceneError::Objects {
            field: "instances",
            reason: format!(
                "the mask shows {} objects; must be at most {MAX_OBJECTS}",
                objects.len()
            ),
        });
    }
    let absent = classes.iter().flat_map(|classes| &classes.segments_info);
    let absent: Vec<String> = absent
        .filter(|segment| objects.binary_search(&segment.id).is_err())
        .map(|segment| segment.id.to_string())
        .collect();
    if absent.is_empty() {
        return Ok(());
    }
    let listed = absent[..absent.len().min(MAX_LISTED)].join(", ");
    let more = absent.len().saturating_sub(MAX_LISTED);
    let more = if more > 0 {
        format!(" and {more} more")
    } else {
        String::new()
    };
    Err(SceneError::Objects {
        field: "classes",
        reason: format!("no pixel of the instance mask has the numbers {listed}{more}"),
    })
}

fn check_camera(camera: &Intrinsics) -> Result<(), SceneError> {
    if !(camera.focal_px.is_finite() && camera.focal_px > 0.0) {
        return Err(number("focal_px", camera.focal_px, "finite and above 0"));
    }
    for (field, value) in [("cx", camera.cx), ("cy", camera.cy)] {
        if !value.is_finite() {
            return Err(number(field, value, "finite"));
        }
    }
    Ok(())
}

fn number(field: &'static str, value: f64, limit: &'static str) -> SceneError {
    SceneError::Number { field, value, limit }
}

/// Size of a picture, and how its stored pixels were turned.
struct PictureSize {
    shown: (usize, usize),
    orientation: Orientation,
}

impl PictureSize {
    /// Turns a map of the stored size like the picture; a map of the shown size stays.
    fn orient<T: Copy>(&self, field: &'static str, map: Plane<T>) -> Result<Plane<T>, SceneError> {
        let (size, image) = (map.size(), self.shown);
        if size == image {
            return Ok(map);
        }
        if self.orientation.shown_sides(size) == image {
            return Ok(self.orientation.turn_plane(map));
        }
        Err(SceneError::Size { field, size, image })
    }
}

fn decode_radiance(bytes: &[u8], scale: Option<f64>) -> Result<Rgb<f32>, SceneError> {
    if let Some(scale) = scale
        && !(scale.is_finite() && scale > 0.0)
    {
        return Err(number("scale", scale, "finite and above 0"));
    }
    let file = codec::decode_radiance(bytes).map_err(|reason| SceneError::File { field: "rgb", reason })?;
    let radiance = match (file, scale) {
        (Radiance::Encoded(_), Some(scale)) => {
            return Err(number("scale", scale, "absent for pictures of integer codes"));
        }
        (Radiance::Encoded(raster), None) => return Ok(decode_raster(&raster, Transfer::Srgb)),
        (Radiance::Linear(radiance), None) => radiance,
        (Radiance::Linear(radiance), Some(scale)) => radiance.map(|&value| (f64::from(value) * scale) as f32),
    };
    let [r, g, b] = radiance.planes().each_ref().map(Plane::data);
    let invalid = (0..r.len()).find_map(|i| {
        let value = [r[i], g[i], b[i]]
            .into_iter()
            .find(|sample| !sample.is_finite())?;
        Some((i, value))
    });
    if let Some((i, value)) = invalid {
        return Err(SceneError::Radiance {
            x: i % radiance.width(),
            y: i / radiance.width(),
            value,
        });
    }
    Ok(radiance)
}

fn decode_range<T: AsRef<[u8]>>(
    file: &RangeFile<T>,
    camera: Option<Intrinsics>,
    picture: &PictureSize,
) -> Result<Plane<f32>, SceneError> {
    let field = file.kind.name();
    if let Some(unit) = file.unit_m
        && !(unit.is_finite() && unit > 0.0)
    {
        return Err(number("unit_m", unit, "finite and above 0"));
    }
    if file.kind == RangeKind::ZDepth && camera.is_none() {
        return Err(SceneError::Missing {
            field: "focal_px",
            reason: "z-depth becomes range along the ray by the camera: give `focal_px` or `hfov_deg`",
        });
    }
    let plane =
        codec::decode_plane(file.file.as_ref()).map_err(|reason| SceneError::File { field, reason })?;
    let meters = match plane {
        FilePlane::Floats(values) => {
            let (unit, invalid) = (file.unit_m.unwrap_or(1.0), file.invalid_code.map(f32::from));
            values.map(|&value| meters_or_hole(f64::from(value), unit, Some(value) == invalid))
        }
        FilePlane::Codes(codes) => {
            let (unit, invalid) = read_code_unit(file)?;
            codes.map(|&code| meters_or_hole(f64::from(code), unit, code == invalid))
        }
        FilePlane::Wide(values) => {
            let (unit, invalid) = read_code_unit(file)?;
            values.map(|&value| {
                let is_hole = value < 0 || value == i32::from(invalid);
                meters_or_hole(f64::from(value), unit, is_hole)
            })
        }
    };
    let meters = picture.orient(field, meters)?;
    Ok(match (file.kind, camera) {
        (RangeKind::ZDepth, Some(camera)) => range_from_z_depth(&meters, &camera),
        _ => meters,
    })
}

/// Unit and code for "no value" of a map of integers.
fn read_code_unit<T>(file: &RangeFile<T>) -> Result<(f64, u16), SceneError> {
    let unit = file.unit_m.ok_or(SceneError::Missing {
        field: "unit_m",
        reason: match file.invalid_code {
            Some(_) => "integer codes do not define a length",
            None => "integer codes do not define a length; give `invalid_code` too, the code of pixels without a distance",
        },
    })?;
    let invalid = file.invalid_code.ok_or(SceneError::Missing {
        field: "invalid_code",
        reason: "one of the integer codes marks pixels without a distance",
    })?;
    Ok((unit, invalid))
}

fn meters_or_hole(value: f64, unit_m: f64, hole: bool) -> f32 {
    let meters = (value * unit_m) as f32;
    let hole = hole || !meters.is_finite();
    if hole { f32::NAN } else { meters }
}

fn decode_instances(bytes: &[u8], picture: &PictureSize) -> Result<Plane<u16>, SceneError> {
    let field = "instances";
    let mask = codec::decode_mask(bytes).map_err(|reason| SceneError::File { field, reason })?;
    picture.orient(field, mask)
}
