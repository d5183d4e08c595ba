//! STUB until merged.
use super::Lighting;
use crate::error_bound::ErrorBound;
use crate::visible_bounds::VisibleBounds;
/// s
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceBounds {
    /// i
    pub irradiance: Vec<[f64; 3]>,
    /// r
    pub rounding: Vec<ErrorBound>,
}
/// a
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AirlightBounds {
    /// p
    pub peak: [f64; 3],
    /// r
    pub rounding: ErrorBound,
}
/// b
#[must_use]
pub fn bound_irradiance(lighting: &Lighting, view: &VisibleBounds) -> SurfaceBounds {
    let irradiance: Vec<[f64; 3]> = view
        .tiles
        .iter()
        .map(|tile| {
            let Some([near, far]) = tile.range_m else {
                return [0.0; 3];
            };
            let [least, most] = tile.stretch();
            let region = tile.between([near / most, far / least]);
            let e: f64 = lighting
                .lamps
                .iter()
                .map(|lamp| lamp.most_light(lighting, region.distances(lamp.position_m())[0]))
                .sum();
            [e; 3]
        })
        .collect();
    let rounding = irradiance
        .iter()
        .map(|e| ErrorBound {
            absolute: 1e-6 * e[0],
            relative: 1e-6,
        })
        .collect();
    SurfaceBounds { irradiance, rounding }
}
/// c
#[must_use]
pub fn bound_airlight(lighting: &Lighting, _view: &VisibleBounds) -> AirlightBounds {
    let most = lighting
        .lamps
        .iter()
        .map(|lamp| lamp.most_light(lighting, 0.3))
        .sum::<f64>();
    AirlightBounds {
        peak: [most; 3],
        rounding: ErrorBound {
            absolute: 1e-7 * most,
            relative: 1e-6,
        },
    }
}
impl AirlightBounds {
    /// x
    #[must_use]
    pub fn brightest(&self) -> f64 {
        self.peak.into_iter().fold(0.0, f64::max)
    }
}
