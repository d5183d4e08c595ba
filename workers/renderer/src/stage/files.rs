//! The files of a frame: one match from artifact kind to content, and one from content to bytes.

use std::borrow::Cow;

use camera::sensor::Raw;
use imaging::codec::{self, EncodeError};
use imaging::{Channels, Plane, Raster, Rgb, Samples, cancel, transfer};
use optics::chain::Layers;
use serde_json::json;
use spec::{ArtifactKind, Counts, Encode, FrameRecord, MASK_STEP, ScenePart};

use super::camera::Developed;
use super::enhance::Enhancements;
use super::labels::visible_semantics;
use super::range_file::millimeters;
use super::snow;
use super::truth::Traced;
use super::water::transmittance;
use crate::content::Content;
use crate::context::FrameContext;
use crate::error::RenderError;
use crate::file::File;
use crate::sequence::Motions;

/// Longer side of a thumbnail.
const PREVIEW_PX: usize = 256;

/// The results of the stages.
pub(crate) struct Pictures<'a> {
    pub(crate) layers: &'a Layers,
    /// Opacity of the snow; `None` without drawn particles.
    pub(crate) snow: Option<&'a Plane<f32>>,
    /// Linear light after the style.
    pub(crate) styled: &'a Rgb<f32>,
    pub(crate) developed: &'a Developed,
    pub(crate) enhancements: &'a Enhancements,
    /// The light by Monte Carlo; `None` unless an artifact needs it.
    pub(crate) traced: Option<&'a Traced>,
    /// The picture of the right camera; `None` unless an artifact needs it.
    pub(crate) right: Option<&'a Developed>,
    pub(crate) motions: &'a Motions,
}

/// Encodes the requested artifacts in the order of the frame. Each missing one adds a warning.
pub(crate) fn encode(
    context: &FrameContext<'_>,
    pictures: &Pictures<'_>,
    record: &mut FrameRecord,
) -> Result<Vec<File>, RenderError> {
    let mut files = Vec::new();
    for kind in &context.frame.artifacts {
        cancel::check();
        if let Some(content) = content_or_warn(context, pictures, kind, record) {
            files.push(encode_file(kind, content, context.frame.encode, record)?);
        }
    }
    list_files(&files, record);
    Ok(files)
}

/// Encodes the content of an artifact.
pub(crate) fn encode_file(
    kind: &ArtifactKind,
    content: Content<'_>,
    encode: Encode,
    record: &mut FrameRecord,
) -> Result<File, RenderError> {
    let bytes = encode_content(content, encode, &texts(kind), &mut record.counts)?;
    Ok(File::new(kind.to_string(), kind.media_type(encode), bytes))
}

/// Adds the files of a frame to its record.
pub(crate) fn list_files(files: &[File], record: &mut FrameRecord) {
    let saturated = record.counts.range_saturated;
    if saturated > 0 {
        let warning = format!("{saturated} pixels are farther than 65.535 m and stored as that");
        record.warnings.push(warning);
    }
    record.artifacts = files.iter().map(File::entry).collect();
}

/// The contents of those files, as [`encode`] would encode them.
pub(crate) fn contents(
    context: &FrameContext<'_>,
    pictures: &Pictures<'_>,
    record: &mut FrameRecord,
) -> Result<Vec<(ArtifactKind, Content<'static>)>, RenderError> {
    let mut contents = Vec::new();
    for kind in &context.frame.artifacts {
        if let Some(content) = content_or_warn(context, pictures, kind, record) {
            contents.push((kind.clone(), content.into_owned()));
        }
    }
    Ok(contents)
}

fn content_or_warn<'a>(
    context: &'a FrameContext<'_>,
    pictures: &Pictures<'a>,
    kind: &ArtifactKind,
    record: &mut FrameRecord,
) -> Option<Content<'a>> {
    let content = content(context, pictures, kind, record);
    if content.is_none() {
        let warning = format!("there is no artifact `{kind}`: {}", why_missing(kind));
        record.warnings.push(warning);
    }
    content
}

/// The content of an artifact, or `None` if the frame lacks it.
fn content<'a>(
    context: &'a FrameContext<'_>,
    pictures: &Pictures<'a>,
    kind: &ArtifactKind,
    record: &FrameRecord,
) -> Option<Content<'a>> {
    let Pictures {
        layers, developed, ..
    } = *pictures;
    let rgb = &developed.rgb;
    let (scene, labels) = (&context.prepared.scene, context.labels());
    let surfaces = labels.and_then(|labels| labels.surfaces.as_ref());
    let display = |layer: &Rgb<f32>| Content::Picture(Cow::Owned(transfer::encode_rgb8(layer).0));
    let linear = |layer: &'a Rgb<f32>| Content::Linear(context.view(layer));
    match kind {
        ArtifactKind::Rgb | ArtifactKind::Hazed => Some(picture(pictures.developed)),
        ArtifactKind::RgbRight => Some(picture(pictures.right?)),
        ArtifactKind::Flow => Some(Content::Linear(Cow::Borrowed(pictures.motions.flow.as_ref()?))),
        ArtifactKind::Disparity => Some(Content::Linear(Cow::Borrowed(
            pictures.motions.disparity.as_ref()?,
        ))),
        ArtifactKind::Clean => Some(display(&context.view(&scene.radiance))),
        ArtifactKind::Scattered => Some(display(&context.view(&layers.scattered))),
        ArtifactKind::Styled => Some(display(pictures.styled)),
        ArtifactKind::Direct => Some(linear(&layers.direct)),
        ArtifactKind::ForwardScatter => Some(linear(&layers.forward_scatter)),
        ArtifactKind::Backscatter => Some(linear(&layers.backscatter)),
        ArtifactKind::Transmittance => Some(Content::Linear(Cow::Owned(seen_transmittance(context)?))),
        ArtifactKind::Preview => Some(Content::Picture(Cow::Owned(codec::downscale(rgb, PREVIEW_PX)))),
        ArtifactKind::Enhanced(_) => enhanced(pictures.enhancements, kind),
        ArtifactKind::SnowMask => {
            let codes_of = snow::codes(pictures.snow, context.setting.size);
            codes(Some(&*context.view_labels(&codes_of)))
        }
        ArtifactKind::Instances => codes(context.instances()),
        ArtifactKind::Semantics => codes(labels.map(|labels| &labels.semantics)),
        ArtifactKind::SemanticsVisible => {
            let visible = visible_semantics(&labels?.semantics, &seen_transmittance(context)?);
            codes(Some(&visible))
        }
        ArtifactKind::Findings => codes(surfaces.map(|surfaces| &surfaces.findings)),
        ArtifactKind::Normals => {
            let normals = Rgb::new(surfaces?.normals.clone()).ok()?;
            Some(Content::Linear(Cow::Owned(normals)))
        }
        ArtifactKind::Raw => Some(Content::Codes(match developed.raw.as_ref()? {
            Raw::Mosaic(codes) => codes.clone().into(),
            Raw::Planes(planes) => interleaved(planes)?,
        })),
        ArtifactKind::Valid => {
            let taking = context.taking.as_ref();
            let valid = taking.and_then(|taking| taking.sampling.as_ref()?.valid());
            let inside = |&inside: &u8| if inside == 0 { 0 } else { u8::MAX };
            Some(Content::Codes(match valid {
                Some(valid) => valid.map(inside).into(),
                None => Plane::filled(rgb.width(), rgb.height(), u8::MAX).into(),
            }))
        }
        ArtifactKind::Boxes => {
            let described = record.scene.as_ref().filter(|scene| scene.instances.is_some());
            described.map(|scene| Content::Json(json!(scene)))
        }
        ArtifactKind::Truth => {
            let pictures = pictures.traced?.truth.pictures();
            Some(Content::Pair(pictures.map(Cow::Owned)))
        }
        ArtifactKind::TruthReport => Some(Content::Json(json!(pictures.traced?.report))),
        ArtifactKind::Range => Some(Content::Range(Cow::Borrowed(context.range()?))),
    }
}

/// The result of an enhancement, or of a step of it.
fn enhanced(enhancements: &Enhancements, kind: &ArtifactKind) -> Option<Content<'static>> {
    let (name, step) = kind.enhancement()?;
    let outcome = enhancements.get(name)?;
    let picture = match step {
        None => &outcome.picture,
        Some(step) => {
            let (_, result) = outcome.steps.iter().find(|(name, _)| name == step)?;
            if step == MASK_STEP {
                return Some(Content::Codes(result.clone()));
            }
            result
        }
    };
    Some(Content::Picture(Cow::Owned(picture.to_rgb8())))
}

fn picture(developed: &Developed) -> Content<'_> {
    match &developed.deep {
        Some(deep) => Content::Codes(deep.clone()),
        None => Content::Picture(Cow::Borrowed(&developed.rgb)),
    }
}

/// Transmittance of the water in the geometry of the picture.
fn seen_transmittance(context: &FrameContext<'_>) -> Option<Rgb<f32>> {
    let transmittance = transmittance(context);
    let planes = transmittance.planes().each_ref();
    Rgb::new(planes.map(|plane| context.view_labels(plane).into_owned())).ok()
}

/// The codes of three sensors pixel by pixel.
fn interleaved([red, green, blue]: &[Plane<u16>; 3]) -> Option<Raster> {
    let pixels = red.data().iter().zip(green.data()).zip(blue.data());
    let samples = pixels.flat_map(|((&r, &g), &b)| [r, g, b]).collect();
    Raster::new(
        red.width(),
        red.height(),
        Channels::Rgb,
        Samples::U16(samples),
        None,
    )
    .ok()
}

fn codes<T: Clone>(plane: Option<&Plane<T>>) -> Option<Content<'static>>
where
    Raster: From<Plane<T>>,
{
    plane.map(|plane| Content::Codes(plane.clone().into()))
}

/// Text chunks of a PNG file.
fn texts(kind: &ArtifactKind) -> Vec<(&'static str, &'static str)> {
    let unit = kind.unit().map(|unit| ("Unit", unit));
    [("Software", "Fathom"), ("Description", kind.about())]
        .into_iter()
        .chain(unit)
        .collect()
}

/// Encodes a file, and counts the saturated pixels of a range.
fn encode_content(
    content: Content<'_>,
    encode: Encode,
    texts: &[(&str, &str)],
    counts: &mut Counts,
) -> Result<Vec<u8>, EncodeError> {
    Ok(match content {
        Content::Picture(picture) => match encode {
            Encode::Png => codec::encode_png_with_text(&Raster::from(picture.into_owned()), texts)?,
            Encode::Webp => codec::encode_webp_lossless(&picture)?,
            Encode::Jpeg { quality } => codec::encode_jpeg(&picture, quality)?,
        },
        Content::Codes(codes) => codec::encode_png_with_text(&codes, texts)?,
        Content::Linear(layer) => codec::encode_npy_rgb(&layer),
        Content::Pair([first, second]) => codec::encode_npy_pair(&first, &second),
        Content::Range(range) => {
            let (codes, saturated) = millimeters(&range);
            counts.range_saturated = saturated;
            codec::encode_png_with_text(&codes.into(), texts)?
        }
        Content::Json(value) => value.to_string().into_bytes(),
    })
}

fn why_missing(kind: &ArtifactKind) -> &'static str {
    match kind.needs() {
        None if *kind == ArtifactKind::Raw => "the camera has no sensor",
        None if *kind == ArtifactKind::Flow => "the path has no next frame, or the shutter is rolling",
        None if *kind == ArtifactKind::Disparity => "the camera has no `stereo`, or the shutter is rolling",
        None if *kind == ArtifactKind::RgbRight => "the camera has no `stereo`",
        Some(ScenePart::Range) => "the scene has no range",
        Some(ScenePart::Instances) => "the scene has no instance mask",
        Some(ScenePart::Surfaces) => "only procedural scenes know their surfaces",
        None => "the enhancement did not run",
    }
}
