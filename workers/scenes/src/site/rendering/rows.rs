/// End of the ground: light of a camera lamp does not return from beyond.
pub(crate) const FAR_M: f32 = 60.0;

/// Some rows of a picture; all planes are row-major.
pub(crate) struct RenderedRows {
    /// Linear radiance, or reflectance: red, green, blue.
    pub(crate) bands: [Vec<f32>; 3],
    /// Range in meters, infinite in open water.
    pub(crate) range: Vec<f32>,
    /// Number of the object plus 1; 0 in open water.
    pub(crate) objects: Vec<u16>,
    pub(crate) labels: Option<SurfaceRows>,
}

pub(crate) struct SurfaceRows {
    /// Depth along the optical axis in meters, infinite in open water.
    pub(crate) z_depth: Vec<f32>,
    /// Unit normals without relief in camera axes; zero in open water.
    pub(crate) normals: [Vec<f32>; 3],
    /// One bit per finding.
    pub(crate) findings: Vec<u8>,
}
