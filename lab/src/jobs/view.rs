//! Artifacts as pictures.

use cli::colors;
use cli::exit::Failure;
use imaging::codec::{self, FilePlane, Radiance};
use imaging::{Plane, Rgb8, transfer};
use renderer::Rendered;

use crate::studio::artifact;

/// An artifact as a picture: linear light encoded, labels in colors, near ranges bright and holes black.
pub(super) fn view(rendered: &Rendered, kind: &str) -> Result<Rgb8, Failure> {
    let bytes = artifact(rendered, kind)?;
    let unreadable = |error| Failure::Other(anyhow::Error::from(error));
    match kind {
        "range" => Ok(view_range(&read_codes(bytes)?)),
        "semantics" | "semantics.visible" => paint(bytes, |code| colors::category(code as u8)),
        "instances" => paint(bytes, colors::instance),
        "findings" => paint(bytes, |bits| {
            colors::finding(bits as u8).unwrap_or_else(|| colors::category(0))
        }),
        _ => match codec::decode_radiance(bytes).map_err(unreadable)? {
            Radiance::Encoded(raster) => Ok(raster.to_rgb8()),
            Radiance::Linear(axes) if kind == "normals" => {
                Ok(Rgb8::from_fn(axes.width(), axes.height(), |x, y| {
                    axes.pixel(x, y).map(|v| ((0.5 + 0.5 * v) * 255.0) as u8)
                }))
            }
            Radiance::Linear(light) => Ok(transfer::encode_rgb8(&light).0),
        },
    }
}

/// The codes of an integer artifact.
pub(super) fn read_codes(bytes: &[u8]) -> Result<Plane<u16>, Failure> {
    match codec::decode_plane(bytes).map_err(anyhow::Error::from)? {
        FilePlane::Codes(codes) => Ok(codes),
        FilePlane::Wide(_) | FilePlane::Floats(_) => {
            Err(anyhow::anyhow!("the artifact has other numbers than codes").into())
        }
    }
}

fn paint(bytes: &[u8], color: impl Fn(u16) -> [u8; 3]) -> Result<Rgb8, Failure> {
    let codes = read_codes(bytes)?;
    Ok(Rgb8::from_fn(codes.width(), codes.height(), |x, y| {
        color(codes.pixel(x, y))
    }))
}

/// Millimeters as brightness on a logarithmic scale.
fn view_range(codes: &Plane<u16>) -> Rgb8 {
    let valid = || {
        codes
            .data()
            .iter()
            .filter(|&&code| code > 0)
            .map(|&code| f64::from(code).ln())
    };
    let near = valid().fold(f64::INFINITY, f64::min);
    let far = valid().fold(f64::NEG_INFINITY, f64::max);
    Rgb8::from_fn(codes.width(), codes.height(), |x, y| match codes.pixel(x, y) {
        0 => [0; 3],
        code => [(255.0 - 215.0 * (f64::from(code).ln() - near) / (far - near).max(1e-9)).round() as u8; 3],
    })
}
