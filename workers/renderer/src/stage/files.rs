//! The files of a frame: one match from artifact kind to bytes.

use imaging::codec::{self, EncodeError};
use imaging::{Plane, Raster, Rgb, Rgb8, transfer};
use optics::chain::Layers;
use serde_json::json;
use spec::{ArtifactKind, Encode, FrameRecord};

use super::enhance::Enhancements;
use super::range_file::millimeters;
use super::water::transmittance;
use super::{Shot, snow};
use crate::error::RenderError;
use crate::file::File;

/// Longer side of a thumbnail.
const PREVIEW_PX: usize = 256;

const PNG: &str = "image/png";
const NPY: &str = "application/x-npy";
const JSON: &str = "application/json";

/// The results of the stages.
pub(crate) struct Pictures<'a> {
    pub(crate) layers: &'a Layers,
    /// Opacity of the snow; none where nothing was drawn.
    pub(crate) snow: Option<&'a Plane<f32>>,
    /// Linear light after the style.
    pub(crate) styled: &'a Rgb<f32>,
    pub(crate) rgb: &'a Rgb8,
    pub(crate) enhancements: &'a Enhancements,
}

/// Encodes the requested artifacts in the order of the frame; each one that does not exist becomes a warning.
pub(crate) fn encode(
    shot: &Shot<'_>,
    pictures: &Pictures<'_>,
    record: &mut FrameRecord,
) -> Result<Vec<File>, RenderError> {
    let mut files = Vec::new();
    for kind in &shot.frame.artifacts {
        match encode_kind(shot, pictures, kind, record)? {
            Some((media_type, bytes)) => files.push(File::new(kind.to_string(), media_type, bytes)),
            None => {
                let warning = format!("there is no artifact `{kind}`: {}", why_missing(kind));
                record.warnings.push(warning);
            }
        }
    }
    let saturated = record.counts.range_saturated;
    if saturated > 0 {
        let warning = format!("{saturated} pixels are farther than 65.535 m and stored as that");
        record.warnings.push(warning);
    }
    record.artifacts = files.iter().map(File::entry).collect();
    Ok(files)
}

/// Media type and bytes.
type Encoded = (&'static str, Vec<u8>);

/// Encodes one artifact. `None`: the frame has none of this kind.
fn encode_kind(
    shot: &Shot<'_>,
    pictures: &Pictures<'_>,
    kind: &ArtifactKind,
    record: &mut FrameRecord,
) -> Result<Option<Encoded>, RenderError> {
    let Pictures { layers, rgb, .. } = *pictures;
    let (scene, labels) = (&shot.prepared.scene, shot.prepared.labels.as_ref());
    let picture = |picture: &Rgb8| encode_picture(picture, shot.frame.encode).map(Some);
    let display = |layer: &Rgb<f32>| picture(&transfer::encode_rgb8(layer).0);
    let linear = |layer: &Rgb<f32>| Ok(Some((NPY, codec::encode_npy_rgb(layer))));
    let encoded = match kind {
        ArtifactKind::Rgb | ArtifactKind::Hazed => picture(rgb),
        ArtifactKind::Clean => display(&scene.radiance),
        ArtifactKind::Scattered => display(&layers.scattered),
        ArtifactKind::Styled => display(pictures.styled),
        ArtifactKind::Direct => linear(&layers.direct),
        ArtifactKind::ForwardScatter => linear(&layers.forward_scatter),
        ArtifactKind::Backscatter => linear(&layers.backscatter),
        ArtifactKind::Transmittance => linear(&transmittance(shot)),
        ArtifactKind::Preview => picture(&codec::downscale(rgb, PREVIEW_PX)),
        ArtifactKind::Enhanced(method) => match pictures.enhancements.get(method) {
            Some(enhanced) => picture(&enhanced.picture.to_rgb8()),
            None => Ok(None),
        },
        ArtifactKind::HscmMask => {
            let hscm = pictures.enhancements.get("hscm");
            encode_codes(hscm.and_then(|hscm| hscm.mask.clone()))
        }
        ArtifactKind::SnowMask => {
            let size = (rgb.width(), rgb.height());
            encode_codes(Some(snow::codes(pictures.snow, size)))
        }
        ArtifactKind::Instances => encode_codes(scene.instances.clone()),
        ArtifactKind::Semantics => encode_codes(labels.map(|labels| labels.semantics.clone())),
        ArtifactKind::Findings => encode_codes(labels.map(|labels| labels.findings.clone())),
        ArtifactKind::Normals => match labels.map(|labels| Rgb::new(labels.normals.clone())) {
            Some(Ok(normals)) => linear(&normals),
            _ => Ok(None),
        },
        ArtifactKind::Boxes => {
            let described = record.scene.as_ref().filter(|scene| scene.instances.is_some());
            Ok(described.map(|scene| (JSON, json!(scene).to_string().into_bytes())))
        }
        ArtifactKind::Range => {
            let stored = scene.range.as_ref().map(millimeters);
            record.counts.range_saturated = stored.as_ref().map_or(0, |(_, saturated)| *saturated);
            encode_codes(stored.map(|(codes, _)| codes))
        }
    };
    Ok(encoded?)
}

/// Encodes a picture in the requested format.
fn encode_picture(picture: &Rgb8, encode: Encode) -> Result<Encoded, EncodeError> {
    Ok(match encode {
        Encode::Png => (PNG, codec::encode_png(&Raster::from(picture.clone()))?),
        Encode::Webp => ("image/webp", codec::encode_webp_lossless(picture)?),
        Encode::Jpeg { quality } => ("image/jpeg", codec::encode_jpeg(picture, quality)?),
    })
}

/// Encodes codes losslessly, whatever the format of pictures.
fn encode_codes(codes: Option<impl Into<Raster>>) -> Result<Option<Encoded>, EncodeError> {
    codes
        .map(|codes| Ok((PNG, codec::encode_png(&codes.into())?)))
        .transpose()
}

fn why_missing(kind: &ArtifactKind) -> &'static str {
    match kind {
        ArtifactKind::Range => "the scene has no range",
        ArtifactKind::Instances => "the scene has no instance mask",
        kind if kind.needs_labels() => "only procedural scenes have labels",
        _ => "the enhancement did not run",
    }
}
