//! An uploaded scene of two files: refused with the field, or a scene whose planes have one size.
#![no_main]

use libfuzzer_sys::fuzz_target;
use scenes::uploaded;
use spec::{RangeFile, RangeKind, SceneFiles};

fuzz_target!(|parts: (Vec<u8>, Vec<u8>, Option<f64>, Option<u16>, bool)| {
    let (rgb, range, unit_m, invalid_code, z_depth) = parts;
    let kind = if z_depth {
        RangeKind::ZDepth
    } else {
        RangeKind::Range
    };
    let upload = SceneFiles {
        rgb,
        range: Some(RangeFile {
            file: range,
            kind,
            unit_m,
            invalid_code,
        }),
        intrinsics: None,
        classes: None,
        world_from_camera: None,
        instances: None,
    };
    if let Ok(scene) = uploaded::decode(&upload) {
        assert!(
            scene
                .range
                .is_none_or(|range| range.size() == scene.radiance.size())
        );
    }
});
