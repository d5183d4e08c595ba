//! A surface as it is described, and as it looks at a group of points.

use crate::categories::FINDINGS;
use crate::site::lanes::{Lane, Lane3, clamp01};
use crate::site::lattice::NoiseSample;
use crate::site::noise::NoisePoints;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Material {
    /// Painted steel, rusting from edges and scratches.
    Steel,
    /// A coated steel pipe.
    Coated(Coat),
    /// Concrete or masonry with joints, cracks and spalls.
    Concrete(JointPattern),
    /// Covered with mussels and weed.
    Growth,
    /// A sacrificial anode, white with its own corrosion.
    Anode,
    /// Broken stone.
    Stone,
    /// Black rubber or plastic.
    Rubber,
    /// Woven bags of sand or grout.
    Bag,
    /// The rippled seabed, or the mud in a shaft.
    Sand,
    /// Skin, shell or leaf.
    Body {
        /// Albedo of the upper side.
        color: [f32; 3],
        gloss: f32,
        /// Brightness of the underside relative to that.
        belly: f32,
    },
    /// The silvery skin of a bubble.
    Bubble,
}

/// A material with the parameters of one object.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SurfaceFinish {
    pub(crate) material: Material,
    pub(crate) base: [f32; 3],
    pub(super) key: u32,
    /// Share of rust, dirt or cracks, about 0..1.
    pub(super) wear: f32,
    /// Share of growth, about 0..1; below -0.9 there is none.
    pub(super) growth: f32,
    /// Direction of ripples or position of formwork, in turns.
    pub(super) direction: f32,
    /// Share of silt on upward surfaces, 0..1.
    pub(super) silt: f32,
    /// Strength of the second scale of texture, 0..1.
    pub(crate) grain: f32,
}

#[derive(Clone, Copy)]
pub(crate) struct Points<'a> {
    /// In the solid's frame, shifted to the object's part of the noise.
    pub(crate) place: NoisePoints<'a>,
    /// In the solid's frame.
    pub(crate) local: &'a Lane3,
    pub(crate) world: &'a Lane3,
    /// Closeness of each point to an edge, 0..1.
    pub(crate) edge: &'a Lane,
    /// Vertical component of each normal, -1..1.
    pub(crate) rise: &'a Lane,
}

/// Points with the noise shared by all materials.
#[derive(Clone, Copy)]
pub(super) struct Grain<'a> {
    pub(super) points: &'a Points<'a>,
    /// Varies over about a meter; its slope is 0 for materials that do not use it.
    pub(super) broad: &'a NoiseSample,
    /// Varies over about 10 cm.
    pub(super) fine: &'a NoiseSample,
}

/// Color and relief of a group of points.
#[derive(Default)]
pub(crate) struct Surface {
    pub(crate) albedo: Lane3,
    /// Slope of the relief in the solid's frame, meters per meter.
    pub(crate) slope: Lane3,
    pub(crate) gloss: Lane,
    /// Strength of each finding, 0..1, in the order of [`FINDINGS`].
    pub(crate) findings: [Lane; FINDINGS.len()],
}

/// Share of a pixel covered by a line of the given half width at a distance from its middle, 0..1.
#[inline(always)]
pub(super) fn line(distance: f32, half_width: f32, footprint: f32) -> f32 {
    let inverse = 1.0 / footprint;
    let part = 2.0 * half_width * inverse;
    clamp01(0.5 + (half_width - distance) * inverse) * if part < 1.0 { part } else { 1.0 }
}

/// Parameters of one pipe. Its axis is z, radius and positions are in meters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Coat {
    pub(crate) radius: f32,
    /// Position of a joint, and distance between joints.
    pub(crate) joint: f32,
    pub(crate) pitch: f32,
    /// Half the length of the band over a joint.
    pub(crate) band: f32,
    pub(crate) band_color: [f32; 3],
    /// Angle of the longitudinal seam, radians.
    pub(crate) seam: f32,
}

/// Flat coordinates of a surface: u across its axis and v = z along it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Unroll {
    /// A cylinder about z: u is the arc in meters.
    Round { radius: f32 },
    /// The walls of a rectangular shaft with these half sides.
    Walls { half: [f32; 2] },
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum JointPattern {
    /// Seams of formwork boards along z.
    Boards,
    /// Courses of pieces, every other course shifted by half a piece.
    Courses(Courses),
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Courses {
    pub(crate) unroll: Unroll,
    /// Height of a course along v, m.
    pub(crate) height: f32,
    /// Length of a piece along u, m.
    pub(crate) length: f32,
    /// Half the width of a joint, m.
    pub(crate) joint: f32,
    /// Depth of shade in the two bolt pockets of a piece, 0..1.
    pub(crate) pocket: f32,
    /// Spread of brightness among pieces.
    pub(crate) variety: f32,
}
