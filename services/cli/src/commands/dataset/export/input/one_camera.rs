//! Checks of formats that describe the camera of a sequence once: before a file is written, from the rows alone.

use std::collections::HashMap;

use cli::exit::Failure;
use client::{Client, ImageQuery, ImageRow};
use serde_json::Value;
use spec::{Camera, Port};

use crate::commands::dataset::export::arguments::Arguments;
use crate::commands::dataset::export::format::Format;
use crate::commands::dataset::export::input::frame::Place;
use crate::commands::dataset::export::input::times::Times;

/// Columns that decide the place and the time of a frame.
const PLACE: [&str; 7] = [
    "job",
    "frame",
    "camera.path.frames",
    "camera.path.frame",
    "camera.frames_per_s",
    "scene.id",
    "scene.name",
];
/// Columns that decide the camera.
const CAMERA: [&str; 11] = [
    "camera.width",
    "camera.height",
    "camera.hfov_deg",
    "camera.preset",
    "camera.port.kind",
    "camera.distortion.k1",
    "camera.distortion.k2",
    "camera.distortion.k3",
    "camera.distortion.p1",
    "camera.distortion.p2",
    "camera.stereo.baseline_m",
];

/// A condition that matches images whose lens a format can describe, with the reason; `None` if it can describe all.
pub(crate) fn require_lens(format: Format) -> Option<(String, &'static str)> {
    let (coefficients, why): (&[&str], _) = match format {
        Format::Kitti => (
            &["k1", "k2", "k3", "p1", "p2"],
            "the format kitti has no distortion; leave out lens and flat port, or choose the format tum, mcap or colmap",
        ),
        Format::Euroc => (
            &["k3"],
            "the format euroc has no coefficient k3, which a flat port needs too; leave it out, or choose the format tum, mcap or \
             colmap",
        ),
        _ => return None,
    };
    let mut refused = vec!["camera.port.kind = \"flat\"".to_owned()];
    let distorted = coefficients
        .iter()
        .map(|name| format!("camera.distortion.{name} != 0"));
    refused.extend(distorted);
    let presets = camera::preset::CAMERAS.iter().filter(|preset| {
        let camera = Camera {
            preset: Some(preset.name.to_owned()),
            ..Camera::pinhole(1, 1, 1.0)
        };
        let camera = camera::preset::complete(&camera);
        let is_flat = matches!(camera.port, Some(Port::Flat { .. }));
        is_flat || (format == Format::Kitti && camera.distortion.is_some())
    });
    let presets: Vec<String> = presets.map(|preset| format!("\"{}\"", preset.name)).collect();
    if !presets.is_empty() {
        refused.push(format!("camera.preset in ({})", presets.join(", ")));
    }
    Some((format!("not ({})", refused.join(" or ")), why))
}

/// Checks that times grow, and for formats that need it that each sequence has one camera.
pub(crate) fn check_sequences(client: &Client, arguments: &Arguments) -> Result<(), Failure> {
    let fields: Vec<String> = PLACE
        .iter()
        .chain(&CAMERA)
        .map(|name| (*name).to_owned())
        .collect();
    let query = ImageQuery {
        dataset: Some(&arguments.dataset),
        filter: &arguments.filter,
        order_by: None,
        fields: &fields,
        limit: usize::MAX,
    };
    let mut times = Times::new(client, &arguments.dataset);
    let mut cameras: HashMap<String, ImageRow> = HashMap::new();
    for rows in client.image_pages(query) {
        for row in rows? {
            let timed = times.assign_time(&row, &Place::read(&row)?)?;
            let first = cameras
                .entry(timed.sequence.clone())
                .or_insert_with(|| row.clone());
            if arguments.format.has_one_camera()
                && let Some(name) = CAMERA.iter().find(|name| first.value(name) != row.value(name))
            {
                return Err(describe_change(
                    arguments.format,
                    &timed.sequence,
                    name,
                    [first, &row],
                ));
            }
        }
    }
    Ok(())
}

fn describe_change(format: Format, sequence: &str, column: &str, rows: [&ImageRow; 2]) -> Failure {
    let [first, other] = rows.map(|row| match row.value(column) {
        Value::Null => "no value".to_owned(),
        value => value.to_string(),
    });
    Failure::BadInput(format!(
        "frames of {sequence} have {first} and {other} as `{column}`, but the format {} has one camera for each sequence: choose the \
         format mcap, or take some of the images with --filter",
        format.name()
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn conditions_name_the_presets_that_a_format_cannot_describe() {
        let (kitti, _) = require_lens(Format::Kitti).unwrap();
        assert!(
            kitti.contains("\"action-flat-port\"") && !kitti.contains("dome"),
            "{kitti}"
        );
        assert!(kitti.contains("camera.distortion.p2 != 0"), "{kitti}");
        let (euroc, _) = require_lens(Format::Euroc).unwrap();
        assert!(euroc.contains("k3 != 0") && !euroc.contains("k1"), "{euroc}");
        assert!(require_lens(Format::Tum).is_none() && require_lens(Format::Mcap).is_none());
    }
}
