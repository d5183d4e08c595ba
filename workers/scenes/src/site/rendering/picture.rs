//! Renders row by row: first the nearest surface of each ray, then its light.

use std::ops::Range;

use imaging::geometry::Intrinsics;
use imaging::vector::Vec3;
use imaging::vectorized;

use crate::CameraPose;
use crate::site::camera::ViewCamera;
use crate::site::outline::Outline;
use crate::site::rows::{FAR_M, RenderedRows, SurfaceRows};
use crate::site::shade::Shader;
use crate::site::solid::{EyeRays, Nearest};
use crate::site::{Site, pits};

#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct RenderOptions {
    /// Reflectance instead of radiance.
    pub(crate) reflectance: bool,
    /// Also surface data for labels.
    pub(crate) surfaces: bool,
}

/// Renders a range of rows.
pub(crate) fn render(
    site: &Site,
    pose: &CameraPose,
    (width, height): (usize, usize),
    lens: &Intrinsics,
    rows: Range<usize>,
    wanted: RenderOptions,
) -> RenderedRows {
    let camera = ViewCamera::new(pose, (width, height), lens);
    let outlines = site.solids.iter().map(|solid| Outline::new(solid, &camera));
    let outlines: Vec<Outline> = outlines.collect();
    let pixels = width * rows.len();
    let blank = || vec![0.0; pixels];
    let mut picture = RenderedRows {
        bands: [blank(), blank(), blank()],
        range: blank(),
        objects: Vec::with_capacity(pixels),
        labels: wanted.surfaces.then(|| SurfaceRows {
            z_depth: Vec::with_capacity(pixels),
            normals: [blank(), blank(), blank()],
            findings: vec![0; pixels],
        }),
    };
    let mut shader = Shader::new(site, &camera, wanted.reflectance);
    let shown = site.solids.iter().map(|solid| solid.object + 1);
    let shown: Vec<u16> = shown.chain([1, 0]).collect();
    let (mut parameter, mut owner) = (vec![0.0f32; width], vec![0u16; width]);
    for (row, y) in rows.enumerate() {
        trace(site, &camera, &outlines, y, &mut parameter, &mut owner);
        let first = row * width;
        let range = &mut picture.range[first..first + width];
        let (start, step) = (camera.ray(0.0, y as f32), camera.column_step());
        vectorized!(fill_ranges(range, &parameter, start, step));
        let objects = owner.iter().map(|&owner| shown[usize::from(owner)]);
        picture.objects.extend(objects);
        if let Some(labels) = &mut picture.labels {
            labels.z_depth.extend(&parameter);
        }
        shader.row(y, first, &parameter, &owner, &mut picture);
    }
    shader.finish(&mut picture);
    picture
}

#[inline(always)]
fn fill_ranges(range: &mut [f32], parameter: &[f32], start: Vec3, step: Vec3) {
    for (i, (range, parameter)) in range.iter_mut().zip(parameter).enumerate() {
        *range = *parameter * (start + step * (i as i32 as f32)).length();
    }
}

/// The nearest surface for every ray of a row: its parameter along the ray (infinite for open water) and its owner, the
/// index of a solid; the number of solids means the ground, one more means open water.
fn trace(
    site: &Site,
    camera: &ViewCamera,
    outlines: &[Outline],
    y: usize,
    parameter: &mut [f32],
    owner: &mut [u16],
) {
    let ground = site.solids.len() as u16;
    let (start, step, height) = (camera.ray(0.0, y as f32), camera.column_step(), camera.eye.z);
    vectorized!(meet_ground(parameter, owner, (start, step), height, ground));
    if !site.pits.is_empty() {
        for (i, parameter) in parameter.iter_mut().enumerate() {
            if owner[i] == ground {
                *parameter = pits::sink(
                    &site.pits,
                    camera.eye,
                    start + step * (i as i32 as f32),
                    *parameter,
                );
            }
        }
    }
    for (index, (solid, outline)) in site.solids.iter().zip(outlines).enumerate() {
        let columns = outline.columns(y);
        if columns.is_empty() {
            continue;
        }
        let rays = EyeRays {
            eye: camera.eye,
            first: camera.ray(columns.start as f32, y as f32),
            step,
        };
        let nearest = Nearest {
            parameter: &mut parameter[columns.clone()],
            owner: &mut owner[columns],
        };
        solid.meet(&rays, nearest, index as u16);
    }
}

/// Intersects rays from `height` meters above the ground with it.
#[inline(always)]
fn meet_ground(
    parameter: &mut [f32],
    owner: &mut [u16],
    (start, step): (Vec3, Vec3),
    height: f32,
    ground: u16,
) {
    for (i, (parameter, owner)) in parameter.iter_mut().zip(owner).enumerate() {
        let ray = start + step * (i as i32 as f32);
        let reach = -height / ray.z;
        let met = (reach > 0.0) & (reach * ray.length() < FAR_M);
        *parameter = if met { reach } else { f32::INFINITY };
        *owner = if met { ground } else { ground + 1 };
    }
}
