//! What an uploaded scene is made of.

use spec::{Intrinsics, RangeFile, RangeKind, SceneFiles};

use crate::check::{MessageError, digest, finite, positive, wrong};
use crate::wire;

impl TryFrom<wire::SceneResponse> for SceneFiles<String> {
    type Error = MessageError;

    fn try_from(wire: wire::SceneResponse) -> Result<Self, MessageError> {
        let range = match wire.range_digest {
            None => None,
            Some(range) => Some(RangeFile {
                file: digest("range_digest", range)?,
                kind: range_kind(wire.range_kind)?,
                unit_m: wire.unit_m.map(|unit| positive("unit_m", unit)).transpose()?,
                invalid_code: wire.invalid_code.map(invalid_code).transpose()?,
            }),
        };
        Ok(Self {
            rgb: digest("rgb_digest", wire.rgb_digest)?,
            range,
            intrinsics: wire.intrinsics.map(intrinsics).transpose()?,
            instances: wire
                .instances_digest
                .map(|it| digest("instances_digest", it))
                .transpose()?,
        })
    }
}

fn range_kind(number: i32) -> Result<RangeKind, MessageError> {
    match wire::RangeKind::try_from(number) {
        Ok(wire::RangeKind::Range) => Ok(RangeKind::Range),
        Ok(wire::RangeKind::ZDepth) => Ok(RangeKind::ZDepth),
        Ok(wire::RangeKind::Unspecified) => Err(MessageError::Missing { field: "range_kind" }),
        Err(_) => Err(wrong("range_kind", &number, "1 (range) or 2 (z-depth)")),
    }
}

fn invalid_code(code: u32) -> Result<u16, MessageError> {
    u16::try_from(code).map_err(|_| wrong("invalid_code", &code, "0..=65535"))
}

fn intrinsics(wire: wire::Intrinsics) -> Result<Intrinsics, MessageError> {
    Ok(Intrinsics {
        focal_px: positive("focal_px", wire.focal_px)?,
        cx: finite("cx", wire.cx)?,
        cy: finite("cy", wire.cy)?,
    })
}

impl From<SceneFiles<String>> for wire::SceneResponse {
    fn from(scene: SceneFiles<String>) -> Self {
        let range_kind = match scene.range.as_ref().map(|range| range.kind) {
            None => wire::RangeKind::Unspecified,
            Some(RangeKind::Range) => wire::RangeKind::Range,
            Some(RangeKind::ZDepth) => wire::RangeKind::ZDepth,
        };
        Self {
            rgb_digest: scene.rgb,
            range_kind: range_kind.into(),
            unit_m: scene.range.as_ref().and_then(|range| range.unit_m),
            invalid_code: scene
                .range
                .as_ref()
                .and_then(|range| range.invalid_code)
                .map(u32::from),
            range_digest: scene.range.map(|range| range.file),
            intrinsics: scene
                .intrinsics
                .map(|Intrinsics { focal_px, cx, cy }| wire::Intrinsics { focal_px, cx, cy }),
            instances_digest: scene.instances,
        }
    }
}
