//! What an uploaded scene is made of.

use crate::check::{MessageError, digest, finite, positive, wrong};
use crate::message::{Intrinsics, RangeFile, RangeKind, SceneFiles};
use crate::wire;

impl TryFrom<wire::SceneResponse> for SceneFiles {
    type Error = MessageError;

    fn try_from(wire: wire::SceneResponse) -> Result<Self, MessageError> {
        let range = match wire.range_digest {
            None => None,
            Some(range) => Some(RangeFile {
                digest: digest("range_digest", range)?,
                kind: range_kind(wire.range_kind)?,
                unit_m: wire.unit_m.map(|unit| positive("unit_m", unit)).transpose()?,
                invalid_code: wire.invalid_code.map(invalid_code).transpose()?,
            }),
        };
        Ok(Self {
            rgb_digest: digest("rgb_digest", wire.rgb_digest)?,
            range,
            intrinsics: wire.intrinsics.map(Intrinsics::try_from).transpose()?,
            instances_digest: wire
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

impl TryFrom<wire::Intrinsics> for Intrinsics {
    type Error = MessageError;

    fn try_from(wire: wire::Intrinsics) -> Result<Self, MessageError> {
        Ok(Self {
            focal_px: positive("focal_px", wire.focal_px)?,
            cx: finite("cx", wire.cx)?,
            cy: finite("cy", wire.cy)?,
        })
    }
}

impl From<SceneFiles> for wire::SceneResponse {
    fn from(scene: SceneFiles) -> Self {
        let range_kind = match scene.range.as_ref().map(|range| range.kind) {
            None => wire::RangeKind::Unspecified,
            Some(RangeKind::Range) => wire::RangeKind::Range,
            Some(RangeKind::ZDepth) => wire::RangeKind::ZDepth,
        };
        Self {
            rgb_digest: scene.rgb_digest,
            range_kind: range_kind.into(),
            unit_m: scene.range.as_ref().and_then(|range| range.unit_m),
            invalid_code: scene
                .range
                .as_ref()
                .and_then(|range| range.invalid_code)
                .map(u32::from),
            range_digest: scene.range.map(|range| range.digest),
            intrinsics: scene
                .intrinsics
                .map(|Intrinsics { focal_px, cx, cy }| wire::Intrinsics { focal_px, cx, cy }),
            instances_digest: scene.instances_digest,
        }
    }
}
