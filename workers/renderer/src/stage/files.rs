//! The files of a frame: one match from artifact kind to bytes.

use enhance::Enhanced;
use imaging::codec::{self, EncodeError};
use imaging::{Raster, Rgb, Rgb8, transfer};
use optics::chain::Layers;
use optics::plan::Plan;
use optics::setting::Setting;
use spec::{ArtifactKind, Encode, Frame, SceneRecord};

use serde_json::json;

use super::light::Lit;
use super::measure::Measurements;
use super::range_file::millimetres;
use super::scene::Prepared;
use super::snow::{self, Fallen};
use super::style::Styled;
use super::water::transmittance;
use crate::error::RenderError;
use crate::record::File;

/// Longer side of a thumbnail.
const PREVIEW_PX: usize = 256;

const PNG: &str = "image/png";
const NPY: &str = "application/x-npy";
const JSON: &str = "application/json";

/// Everything that a frame has gone through.
pub(crate) struct Products<'a> {
    pub(crate) frame: &'a Frame,
    pub(crate) prepared: &'a Prepared,
    pub(crate) setting: &'a Setting,
    pub(crate) lit: &'a Lit<'a>,
    pub(crate) plan: &'a Plan,
    pub(crate) layers: &'a Layers,
    /// Whether the water glows.
    pub(crate) glows: bool,
    pub(crate) fallen: Option<&'a Fallen>,
    pub(crate) styled: &'a Styled<'a>,
    pub(crate) rgb: &'a Rgb8,
    /// Samples outside 0..=1 that the encoder clamped.
    pub(crate) clamped: u64,
    pub(crate) enhanced: &'a [(String, Enhanced)],
    pub(crate) measurements: Measurements,
    pub(crate) described: Option<SceneRecord>,
}

/// The files that the frame asks for, in its order.
pub(crate) struct Files {
    pub(crate) files: Vec<File>,
    /// Range pixels beyond what 16-bit millimetres hold.
    pub(crate) range_saturated: u64,
    /// Which files are missing, and why.
    pub(crate) warnings: Vec<String>,
}

/// Encodes the files of a frame.
pub(crate) fn encode(products: &Products<'_>) -> Result<Files, RenderError> {
    let mut files = Files {
        files: Vec::new(),
        range_saturated: 0,
        warnings: Vec::new(),
    };
    for kind in &products.frame.artifacts {
        match bytes(products, kind, &mut files.range_saturated)? {
            Some((media_type, bytes)) => files.files.push(File::new(kind.to_string(), media_type, bytes)),
            None => files
                .warnings
                .push(format!("there is no artifact `{kind}`: {}", why_missing(kind))),
        }
    }
    if files.range_saturated > 0 {
        let pixels = files.range_saturated;
        files.warnings.push(format!(
            "{pixels} pixels are farther than 65.535 m and stored as that"
        ));
    }
    Ok(files)
}

type Encoded = (&'static str, Vec<u8>);

/// `None`: the frame has nothing of this kind.
fn bytes(
    products: &Products<'_>,
    kind: &ArtifactKind,
    saturated: &mut u64,
) -> Result<Option<Encoded>, RenderError> {
    let Products {
        frame,
        prepared,
        layers,
        styled,
        rgb,
        enhanced,
        ..
    } = products;
    let labels = prepared.labels.as_ref();
    let scene = &prepared.scene;
    let linear = |layer: &Rgb<f32>| Some((NPY, codec::encode_npy_rgb(layer)));
    let shown = |layer: &Rgb<f32>| picture(&transfer::encode_rgb8(layer).0, frame.encode);
    let of = |name: &str| {
        enhanced
            .iter()
            .find(|(method, _)| method == name)
            .map(|(_, enhanced)| enhanced)
    };
    Ok(match kind {
        ArtifactKind::Rgb | ArtifactKind::Hazed => Some(picture(rgb, frame.encode)?),
        ArtifactKind::Clean => Some(shown(&scene.radiance)?),
        ArtifactKind::Scattered => Some(shown(&layers.scattered)?),
        ArtifactKind::Styled => Some(shown(&styled.picture)?),
        ArtifactKind::Direct => linear(&layers.direct),
        ArtifactKind::ForwardScatter => linear(&layers.forward_scatter),
        ArtifactKind::Backscatter => linear(&layers.backscatter),
        ArtifactKind::Transmittance => linear(&transmittance(products.lit, products.setting)),
        ArtifactKind::Preview => Some(picture(&codec::downscale(rgb, PREVIEW_PX), frame.encode)?),
        ArtifactKind::Enhanced(method) => match of(method) {
            None => None,
            Some(enhanced) => Some(picture(&enhanced.picture.to_rgb8(), frame.encode)?),
        },
        ArtifactKind::HscmMask => mask(of("hscm").and_then(|hscm| hscm.mask.clone()).map(Raster::from))?,
        ArtifactKind::SnowMask => mask(Some(Raster::from(snow::codes(
            products.fallen,
            (rgb.width(), rgb.height()),
        ))))?,
        ArtifactKind::Instances => mask(scene.instances.clone().map(Raster::from))?,
        ArtifactKind::Semantics => mask(labels.map(|labels| Raster::from(labels.semantics.clone())))?,
        ArtifactKind::Findings => mask(labels.map(|labels| Raster::from(labels.findings.clone())))?,
        ArtifactKind::Normals => match labels.map(|labels| Rgb::new(labels.normals.clone())) {
            Some(Ok(normals)) => linear(&normals),
            _ => None,
        },
        ArtifactKind::Boxes => match products
            .described
            .as_ref()
            .filter(|scene| scene.instances.is_some())
        {
            Some(scene) => Some((JSON, json!(scene).to_string().into_bytes())),
            None => None,
        },
        ArtifactKind::Range => match &scene.range {
            None => None,
            Some(range) => {
                let (codes, beyond) = millimetres(range);
                *saturated = beyond;
                mask(Some(Raster::from(codes)))?
            }
        },
    })
}

/// A picture in the format that the frame asks for.
fn picture(picture: &Rgb8, encode: Encode) -> Result<Encoded, EncodeError> {
    Ok(match encode {
        Encode::Png => (PNG, codec::encode_png(&Raster::from(picture.clone()))?),
        Encode::Webp => ("image/webp", codec::encode_webp_lossless(picture)?),
        Encode::Jpeg { quality } => ("image/jpeg", codec::encode_jpeg(picture, quality)?),
    })
}

/// Codes that must stay what they are, whatever format pictures have.
fn mask(codes: Option<Raster>) -> Result<Option<Encoded>, EncodeError> {
    codes
        .map(|codes| Ok((PNG, codec::encode_png(&codes)?)))
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
