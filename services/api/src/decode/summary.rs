//! Checks the numbers of an uploaded scene for plausibility, and summarizes it.

use std::collections::BTreeMap;

use client::{ClassPixels, SceneSummary};
use imaging::Plane;
use imaging::codec::{Orientation, find_foreign_profile, has_distances, has_transparency};
use imaging::geometry::range_from_z_depth;
use scenes::Scene;
use spec::{RangeKind, SceneFiles};

use super::refusal::Refusal;

/// Median distance above which a map without `unit_m` is probably not in meters.
const FAR_MEDIAN_M: f32 = 100.0;
/// Value above which floats without `scale` are probably not linear light with 1 for white.
const BRIGHT: f32 = 10.0;

/// Rejects floats that are probably in another unit, unless `unit_m` or `scale` is given.
pub(crate) fn check_units(scene: &Scene, files: &SceneFiles<Vec<u8>>) -> Result<(), Refusal> {
    if let (Some(range), Some(plane)) = (&files.range, &scene.range)
        && range.unit_m.is_none()
        && let Some(median) = find_median(&find_distances(scene, plane, range.kind))
        && median > FAR_MEDIAN_M
    {
        let message = format!(
            "the median of `{}` is {median} m, above {FAR_MEDIAN_M} m; give `unit_m`: 0.001 for a file in millimeters, 1 for meters",
            range.kind.name()
        );
        return Err(Refusal::new("unit_m", message));
    }
    let samples = scene.radiance.planes().iter().flat_map(|plane| plane.data());
    let brightest = samples.copied().fold(0.0, f32::max);
    if files.scale.is_none() && brightest > BRIGHT {
        let message = format!(
            "the floats of `rgb` reach {brightest}, above {BRIGHT}, where 1 is white; give `scale`: 0.00392156862745098 for 0 to \
             255, 1 to keep the values"
        );
        return Err(Refusal::new("scale", message));
    }
    Ok(())
}

/// The distances as the file holds them: a wide lens makes ranges far longer than depths.
fn find_distances(scene: &Scene, range: &Plane<f32>, kind: RangeKind) -> Vec<f32> {
    let camera = scene.intrinsics.filter(|_| kind == RangeKind::ZDepth);
    let depth = camera.map(|camera| {
        let stretch = range_from_z_depth(&range.map(|_| 1.0), &camera);
        let pairs = range.data().iter().zip(stretch.data());
        pairs.map(|(range, stretch)| range / stretch).collect()
    });
    depth.unwrap_or_else(|| range.data().to_vec())
}

fn find_median(distances: &[f32]) -> Option<f32> {
    let mut valid: Vec<f32> = distances.iter().copied().filter(|&z| is_distance(z)).collect();
    let middle = valid.len().checked_sub(1)? / 2;
    Some(*valid.select_nth_unstable_by(middle, f32::total_cmp).1)
}

fn is_distance(value: f32) -> bool {
    value.is_finite() && value > 0.0
}

/// Summarizes a decoded scene.
pub(crate) fn summarize(scene: &Scene, files: &SceneFiles<Vec<u8>>) -> SceneSummary {
    let mut summary = SceneSummary {
        notes: list_notes(files),
        ..SceneSummary::default()
    };
    if let Some(range) = &scene.range {
        let valid: Vec<f32> = range.data().iter().copied().filter(|&z| is_distance(z)).collect();
        summary.valid_share = Some(valid.len() as f64 / range.data().len() as f64);
        summary.nearest_m = valid.iter().copied().min_by(f32::total_cmp).map(f64::from);
        summary.farthest_m = valid.iter().copied().max_by(f32::total_cmp).map(f64::from);
    }
    if let Some(mask) = &scene.instances {
        let mut pixels = BTreeMap::new();
        for &number in mask.data().iter().filter(|&&number| number > 0) {
            *pixels.entry(number).or_insert(0) += 1;
        }
        summary.objects = Some(pixels.len());
        summary.classes = count_classes(&pixels, files);
    }
    summary
}

fn count_classes(pixels: &BTreeMap<u16, u64>, files: &SceneFiles<Vec<u8>>) -> Vec<ClassPixels> {
    let mut counts: BTreeMap<&str, u64> = BTreeMap::new();
    for (number, count) in pixels {
        let name = files.classes.as_ref().and_then(|classes| {
            let segments = &mut classes.segments_info.iter();
            let segment = segments.find(|segment| segment.id == *number)?;
            let categories = &mut classes.categories.iter();
            let category = categories.find(|category| category.id == segment.category_id)?;
            Some(category.name.as_str())
        });
        *counts.entry(name.unwrap_or("unlabeled")).or_insert(0) += count;
    }
    let mut classes: Vec<ClassPixels> = counts
        .into_iter()
        .map(|(name, pixels)| ClassPixels {
            name: name.to_owned(),
            pixels,
        })
        .collect();
    classes.sort_by_key(|class| std::cmp::Reverse(class.pixels));
    classes
}

/// Readings of the files that are not obvious.
fn list_notes(files: &SceneFiles<Vec<u8>>) -> Vec<String> {
    let mut notes = Vec::new();
    let orientation = Orientation::read(&files.rgb);
    if orientation != Orientation::STORED {
        notes.push(format!(
            "`rgb` has the orientation tag {} and is turned as viewers show it; maps of the shown size are read as they are, maps of \
             the stored size are turned like the picture",
            orientation.tag()
        ));
    }
    if let Some(profile) = find_foreign_profile(&files.rgb) {
        notes.push(format!(
            "`rgb` has {profile}, which is not applied: its values are read as sRGB; convert the picture to sRGB to keep its colors"
        ));
    }
    if has_transparency(&files.rgb) {
        notes.push(
            "`rgb` is transparent in places, which is not used: those pixels show the color below".to_owned(),
        );
    }
    if files.range.is_none() && has_distances(&files.rgb) {
        notes.push(
            "`rgb` has a channel of distances, which is not used; send the file as `z_depth` or `range` too"
                .to_owned(),
        );
    }
    notes
}

#[cfg(test)]
mod tests {
    use imaging::Rgb;
    use spec::RangeFile;

    use super::*;

    fn scene(distance: f32, light: f32) -> Scene {
        Scene {
            radiance: Rgb::from_fn(2, 1, |_, _| [light; 3]),
            range: Some(Plane::new(2, 1, vec![distance, f32::NAN]).unwrap()),
            instances: Some(Plane::new(2, 1, vec![0, 7]).unwrap()),
            intrinsics: None,
            normals: None,
        }
    }

    fn files(unit_m: Option<f64>, scale: Option<f64>) -> SceneFiles<Vec<u8>> {
        SceneFiles {
            rgb: Vec::new(),
            range: Some(RangeFile {
                file: Vec::new(),
                kind: RangeKind::Range,
                unit_m,
                invalid_code: None,
            }),
            instances: None,
            intrinsics: None,
            classes: None,
            world_from_camera: None,
            hfov_deg: None,
            scale,
        }
    }

    #[test]
    fn millimeters_and_codes_are_asked_for_and_taken_when_they_are_declared() {
        let refused = |scene: &Scene, files: &SceneFiles<Vec<u8>>| {
            check_units(scene, files).err().map(|refusal| refusal.pointer)
        };
        assert_eq!(refused(&scene(99.0, 9.0), &files(None, None)), None);
        assert_eq!(
            refused(&scene(1500.0, 0.5), &files(None, None)).as_deref(),
            Some("/unit_m")
        );
        assert_eq!(refused(&scene(1500.0, 0.5), &files(Some(1.0), None)), None);
        assert_eq!(
            refused(&scene(5.0, 255.0), &files(None, None)).as_deref(),
            Some("/scale")
        );
        assert_eq!(refused(&scene(5.0, 255.0), &files(None, Some(1.0))), None);
    }

    #[test]
    fn the_summary_counts_distances_and_classes() {
        let summary = summarize(&scene(4.5, 0.5), &files(None, None));
        assert_eq!(
            (summary.valid_share, summary.nearest_m, summary.farthest_m),
            (Some(0.5), Some(4.5), Some(4.5))
        );
        assert_eq!((summary.objects, summary.classes[0].pixels), (Some(1), 1));
        assert_eq!(summary.classes[0].name, "unlabeled");
    }
}
