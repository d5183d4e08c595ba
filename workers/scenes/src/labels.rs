//! Labels of a procedural frame: geometry, masks, boxes and findings, in the geometry of the picture itself.

use imaging::Plane;
use imaging::geometry::Intrinsics;

use crate::CameraPose;
use crate::categories::Category;
use crate::site::Surfaces;

/// What is known about every pixel of a frame. All planes have the sides of the frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Labels {
    /// Depth along the optical axis in meters: range times the cosine of the angle to it; infinite where nothing is met.
    pub z_depth: Plane<f32>,
    /// Unit normals of the surfaces, without relief, in camera axes (right, down, ahead); they face the camera. Edges are
    /// rounded over a millimeter. Zero where nothing is met.
    pub normals: [Plane<f32>; 3],
    /// [`Category`] of each pixel by its number.
    pub semantics: Plane<u8>,
    /// [`crate::categories::Finding::bit`] of every finding that the pixel shows. A finding covers more than half of it; a crack
    /// counts where it passes through.
    pub findings: Plane<u8>,
    /// Every instance in view, by number.
    pub instances: Vec<Instance>,
    /// Where the camera is.
    pub pose: CameraPose,
    /// Its intrinsics.
    pub intrinsics: Intrinsics,
}

/// An object in view.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Instance {
    /// Its number in the instance mask: 1 for the ground, from 2 on for objects.
    pub number: u16,
    /// What it is.
    pub category: Category,
    /// The smallest box of whole pixels around what is seen of it: left, top, and the first column and row beyond.
    pub bounds: [usize; 4],
    /// How many pixels show it.
    pub pixels: usize,
}

impl Labels {
    /// `categories` are those of the instances from 1 on.
    pub(crate) fn new(
        surfaces: Surfaces,
        numbers: &Plane<u16>,
        categories: &[Category],
        pose: CameraPose,
        intrinsics: Intrinsics,
    ) -> Self {
        let (width, height) = numbers.size();
        let plane = |data| Plane::new(width, height, data).expect("one sample for each pixel");
        let category = |&number: &u16| match number {
            0 => Category::Background as u8,
            _ => categories[usize::from(number) - 1] as u8,
        };
        Self {
            z_depth: plane(surfaces.z_depth),
            normals: surfaces.normals.map(plane),
            semantics: numbers.map(category),
            findings: Plane::new(width, height, surfaces.findings).expect("one mask for each pixel"),
            instances: instances(numbers, categories),
            pose,
            intrinsics,
        }
    }
}

fn instances(numbers: &Plane<u16>, categories: &[Category]) -> Vec<Instance> {
    let (width, height) = numbers.size();
    let unseen = |(number, &category)| Instance {
        number,
        category,
        bounds: [width, height, 0, 0],
        pixels: 0,
    };
    let mut found: Vec<Instance> = (1..).zip(categories).map(unseen).collect();
    for (y, row) in numbers.data().chunks_exact(width.max(1)).enumerate() {
        let mut left = 0;
        for run in row.chunk_by(|a, b| a == b) {
            let right = left + run.len();
            if run[0] != 0 {
                let Instance { bounds, pixels, .. } = &mut found[usize::from(run[0]) - 1];
                let [x0, y0, x1, y1] = *bounds;
                *bounds = [x0.min(left), y0.min(y), x1.max(right), y1.max(y + 1)];
                *pixels += run.len();
            }
            left = right;
        }
    }
    found.retain(|instance| instance.pixels > 0);
    found
}
