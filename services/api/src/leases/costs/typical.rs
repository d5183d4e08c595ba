//! Typical costs of frames: figures of the stages, and the nominal time of Monte Carlo paths.

use spec::{ArtifactKind, Fidelity, Frame};

/// Nanoseconds per pixel of each stage on one core of a server processor, 768×492, before any measurement; per lamp
/// for lamps.
const TYPICAL_NS: [(&str, f64); 16] = [
    ("scene", 90.0),
    ("plan", 2.0),
    ("turbidity", 20.0),
    ("lamps", 50.0),
    ("snow", 15.0),
    ("water", 300.0),
    ("style", 110.0),
    ("haze", 5.0),
    ("camera", 20.0),
    ("encode", 5.0),
    ("enhance", 20.0),
    ("metrics", 50.0),
    ("flow", 32.0),
    ("disparity", 32.0),
    ("right", 500.0),
    ("files", 75.0),
];
/// Bytes per pixel of each artifact kind: PNG of synthetic scenes, float32 NPY of the linear layers.
const TYPICAL_BYTES: [(&str, f64); 14] = [
    ("range", 0.6),
    ("instances", 0.02),
    ("snow_mask", 0.1),
    ("preview", 0.04),
    ("raw", 2.0),
    ("valid", 0.02),
    ("direct", 12.0),
    ("forward_scatter", 12.0),
    ("backscatter", 12.0),
    ("transmittance", 12.0),
    ("flow", 12.0),
    ("disparity", 12.0),
    ("truth", 24.0),
    ("clean", 1.0),
];
/// Bytes per pixel of other kinds: images.
const PICTURE_BYTES: f64 = 0.5;
/// Bytes of a frame's rows.
const ROW_BYTES: f64 = 6000.0;
/// Cost of the f64 reference in units of the fast stages.
const REFERENCE_FACTOR: f64 = 1000.0;

/// Seconds of one slot, except for the Monte Carlo paths.
pub(crate) fn typical_seconds(frame: &Frame, pixels: f64) -> f64 {
    let stages = TYPICAL_NS.iter().filter(|(stage, _)| runs(frame, stage));
    let ns = stages.map(|(stage, ns): &(&str, f64)| {
        let units = match *stage {
            "lamps" => frame.lamp_count(),
            "enhance" => frame
                .enhance
                .iter()
                .map(|enhancement| enhancement.steps.len())
                .sum(),
            _ => 1,
        };
        ns * units as f64
    });
    let factor = match frame.fidelity {
        Fidelity::Reference => REFERENCE_FACTOR,
        _ => 1.0,
    };
    ns.sum::<f64>() * factor * pixels / 1e9
}

/// Bytes of the artifacts and rows.
pub(crate) fn typical_bytes(frame: &Frame, pixels: f64) -> f64 {
    let kinds = frame
        .artifacts
        .iter()
        .map(|kind| bytes_per_pixel(&kind.to_string()));
    kinds.sum::<f64>() * pixels + ROW_BYTES
}

/// Whether a stage runs for this frame.
pub(crate) fn runs(frame: &Frame, stage: &str) -> bool {
    let water = &frame.water;
    match stage {
        "flow" => frame.artifacts.contains(&ArtifactKind::Flow),
        "disparity" => frame.artifacts.contains(&ArtifactKind::Disparity),
        "right" => frame.artifacts.contains(&ArtifactKind::RgbRight),
        "water" => water.optics.is_some(),
        "lamps" => frame.has_lamps(),
        "snow" => water.snow.is_some_and(|snow| snow.density_per_m3 > 0.0),
        "turbidity" => {
            water.optics.is_some() && water.turbidity.is_some_and(|patches| patches.contrast > 0.0)
        }
        "style" => water.style.is_some() && frame.alpha > 0.0,
        "haze" => !frame.haze().is_empty(),
        "enhance" => !frame.enhance.is_empty(),
        "metrics" => !frame.metrics.is_empty(),
        _ => true,
    }
}

fn bytes_per_pixel(kind: &str) -> f64 {
    let known = TYPICAL_BYTES.iter().find(|(known, _)| *known == kind);
    known.map_or(PICTURE_BYTES, |(_, bytes)| *bytes)
}

/// Maximum nominal time of the Monte Carlo paths; 0 without an artifact that needs them.
pub(crate) fn traced_seconds(frame: &Frame, pixels: f64) -> f64 {
    let most = frame.truth.unwrap_or_default().most_paths(pixels as u64);
    match most {
        Ok((paths, _)) if frame.is_traced() => spec::truth::seconds(pixels as u64, paths),
        _ => 0.0,
    }
}
