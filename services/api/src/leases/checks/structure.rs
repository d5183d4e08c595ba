//! The structure of a file: a complete file of the samples that its kind has. Pixels are not decoded.

use imaging::codec::read_layout;
use serde::de::IgnoredAny;
use spec::{ArtifactKind, Frame};

/// Channels and bits of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct SampleFormat {
    channels: usize,
    bits: usize,
}

/// What is wrong with the bytes of an artifact; `None` if nothing is.
pub(super) fn find_fault(frame: &Frame, kind: &ArtifactKind, bytes: &[u8]) -> Option<String> {
    if matches!(kind, ArtifactKind::Boxes | ArtifactKind::TruthReport) {
        let parsed = serde_json::from_slice::<IgnoredAny>(bytes);
        return parsed.err().map(|error| error.to_string());
    }
    let layout = match read_layout(bytes) {
        Ok(layout) => layout,
        Err(wrong) => return Some(wrong),
    };
    let found = SampleFormat {
        channels: layout.channels,
        bits: layout.bits,
    };
    let allowed = list_formats(frame, kind);
    let shown: Vec<String> = allowed.iter().map(describe).collect();
    (!allowed.contains(&found))
        .then(|| format!("it has {}; must be {}", describe(&found), shown.join(" or ")))
}

fn describe(SampleFormat { channels, bits }: &SampleFormat) -> String {
    format!("{channels} channels of {bits} bits")
}

/// The formats in which workers write a kind.
fn list_formats(frame: &Frame, kind: &ArtifactKind) -> Vec<SampleFormat> {
    let formats: &[(usize, usize)] = match kind {
        ArtifactKind::Rgb | ArtifactKind::Hazed | ArtifactKind::RgbRight if frame.camera.bits == 16 => {
            &[(3, 8), (3, 16)]
        }
        ArtifactKind::Range => &[(1, 16)],
        ArtifactKind::Raw => &[(1, 16), (3, 16)],
        ArtifactKind::Instances => &[(1, 8), (1, 16)],
        ArtifactKind::Semantics
        | ArtifactKind::SemanticsVisible
        | ArtifactKind::Findings
        | ArtifactKind::SnowMask
        | ArtifactKind::Valid => &[(1, 8)],
        ArtifactKind::Enhanced(name) if name.ends_with(".mask") => &[(1, 8)],
        ArtifactKind::Truth => &[(6, 32)],
        ArtifactKind::Direct
        | ArtifactKind::ForwardScatter
        | ArtifactKind::Backscatter
        | ArtifactKind::Transmittance
        | ArtifactKind::Normals
        | ArtifactKind::Flow
        | ArtifactKind::Disparity => &[(3, 32)],
        _ => &[(3, 8)],
    };
    let formats = formats.iter();
    formats
        .map(|&(channels, bits)| SampleFormat { channels, bits })
        .collect()
}
