//! Worlds of solids on a seabed, and their pictures from a camera with a lamp.
//!
//! World: meters, z up, the ground at z = 0 except in pits. Intersections are exact: range is the distance to the solid
//! itself. Relief (ripples, rust, pores, growth) changes normals and colors only, like a normal map. The picture is in
//! air, lit by a lamp at the camera and by soft light from above; it is linear and may exceed 1 close to the lamp.
//!
//! A pixel depends on its ray only, so any split of the rows over bands and threads yields the same bytes.

pub(crate) mod bounds;
pub(crate) mod builder;
pub(crate) mod chance;
pub(crate) mod finish;
pub(crate) mod lanes;
pub(crate) mod pose;
mod rendering;
pub(crate) mod solid;
mod textures;
pub(crate) mod tree;
mod usual;
pub(crate) mod view;

use imaging::vector::DVec3;

use crate::CameraPose;
use crate::categories::Category;
use finish::SurfaceFinish;
use pits::Pit;
use solid::Solid;
use usual::Usual;

pub(crate) use picture::{RenderOptions, render};
use rendering::{camera, geometry, light, outline, picture, rows, shade};
pub(crate) use rows::{FAR_M, RenderedRows, SurfaceRows};
pub(crate) use shade::LABEL_BEVEL_M;
pub(crate) use textures::pits;
use textures::{dots, lattice, noise};

/// An object: its surface and its category. Number 0 is the ground.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SiteObject {
    pub(crate) finish: SurfaceFinish,
    pub(crate) category: Category,
    /// For growth, the object it is attached to.
    pub(crate) host: Option<u16>,
}

/// A site with its usual view and light.
pub(crate) struct Site {
    pub(crate) solids: Vec<Solid>,
    pub(crate) objects: Vec<SiteObject>,
    pub(crate) pits: Vec<Pit>,
    /// Camera of a single frame.
    pub(crate) pose: CameraPose,
    /// Point that this camera looks at.
    pub(crate) target: DVec3,
    /// Center of the drawn poses.
    pub(crate) usual: Usual,
    /// Track of a camera past the site: a vector of the usual length, m.
    pub(crate) travel: DVec3,
    /// Distance at which the lamp gives full light, m.
    pub(crate) lamp_m: f32,
    /// Light from above relative to that.
    pub(crate) ambient: f32,
}
