//! Multiple scattering of lamp light.
//!
//! Sea water scatters forward, so that light scattered a little is still in the beam (quasi-single scattering: Gordon 1973; the
//! idea of delta-Eddington, Joseph, Wiscombe & Weinman 1976). On a path of L meters from a lamp with a profile S, of x = b L mean
//! free paths, the unscattered light `S e^{−c L}` is supplemented by
//!
//! ```text
//! S̄ (e^{−c_g L} − e^{−c L})        in the airlight, L up to the camera:  c_g = a − 0.06 b/(1 + x/8)
//! S̄ (e^{−(a + κ b) r} − e^{−c r})  on surfaces, L = r:               κ = min(0.1, 0.016 (a/b)^0.8 (b r)^0.7)
//! ```
//!
//! S̄ is the profile blurred by a Cauchy kernel of 0.037 + 0.018 x rad in the airlight, and of 0.015 + 0.0165 x + 0.0011 x² rad, x
//! up to 8, on surfaces. It is 1 for a point lamp. c_g may be below 0: spread light is scattered with greater values of the phase
//! function. The constants are fits to Monte Carlo runs; [`ModelError`](super::ModelError) has their error.

use std::f64::consts::PI;
use std::sync::LazyLock;

use super::beam::Beam;

/// Samples of the blurred profile: rings about the direction, and azimuths of one half; the other mirrors it.
pub(super) const RINGS: usize = 6;
pub(super) const AZIMUTHS: usize = 4;
/// c_g of the airlight: `a − SWELL b/(1 + x/SATURATION)`.
pub(super) const SWELL: f64 = 0.06;
pub(super) const SATURATION: f64 = 8.0;
/// κ: the most, the factor, and the powers of a/b and of b r.
pub(super) const MOST_LOSS: f64 = 0.1;
const LOSS: f64 = 0.016;
const RATIO_POWER: f64 = 0.8;
pub(super) const PATH_POWER: f64 = 0.7;
/// Mean free paths beyond which the kernel on surfaces stays constant.
pub(super) const WIDEST: f64 = 8.0;

/// Scale of the kernel in radians in the airlight, at x mean free paths: the coefficients of 1 and x.
pub(super) const GLOW_SCALE: [f64; 2] = [0.037, 0.018];
/// The same on surfaces: of 1, x and x².
pub(super) const SURFACE_SCALE: [f64; 3] = [0.015, 0.0165, 0.0011];

/// Angle of each ring from the direction as a multiple of the scale: the quantiles (k + 1/2)/6 of the kernel.
pub(super) fn rings() -> [f64; RINGS] {
    std::array::from_fn(|k| {
        let rest = 1.0 - (k as f64 + 0.5) / RINGS as f64;
        (1.0 / (rest * rest) - 1.0).sqrt()
    })
}

/// Cosines of the azimuths (q + 1/2) π/4.
pub(super) fn azimuths() -> [f64; AZIMUTHS] {
    std::array::from_fn(|q| ((q as f64 + 0.5) * PI / 4.0).cos())
}

static RING_ANGLES: LazyLock<[f64; RINGS]> = LazyLock::new(rings);
static AZIMUTH_COSINES: LazyLock<[f64; AZIMUTHS]> = LazyLock::new(azimuths);

/// S̄ in a direction whose cosine to the axis is `cosine(axis)`, for a kernel of this scale in radians.
pub(super) fn blurred(beam: Beam, scale: f64, cosine: impl Fn([f64; 3]) -> f64) -> f64 {
    let Beam::Spot { axis, .. } = beam else { return 1.0 };
    let cos = cosine(axis).clamp(-1.0, 1.0);
    let sin = (1.0 - cos * cos).sqrt();
    let mut sum = 0.0;
    for ring in &*RING_ANGLES {
        let (sin_ring, cos_ring) = (scale * ring).min(PI).sin_cos();
        for azimuth in &*AZIMUTH_COSINES {
            sum += beam.profile(|_| cos * cos_ring + sin * sin_ring * azimuth);
        }
    }
    sum / (RINGS * AZIMUTHS) as f64
}

/// Scale of the kernel of the airlight, rad.
pub(super) fn glow_scale(x: f64) -> f64 {
    GLOW_SCALE[0] + GLOW_SCALE[1] * x
}

/// Scale of the kernel on surfaces, rad.
pub(super) fn surface_scale(x: f64) -> f64 {
    let x = x.min(WIDEST);
    SURFACE_SCALE[0] + SURFACE_SCALE[1] * x + SURFACE_SCALE[2] * x * x
}

/// c_g L of the airlight.
pub(super) fn glow_depth(a: f64, b: f64, meters: f64) -> f64 {
    if meters.is_infinite() {
        return meters;
    }
    let x = b * meters;
    a * meters - SWELL * x / (1.0 + x / SATURATION)
}

/// The factor f of κ b = min(0.1 b, f r^0.7), 1/m^1.7. It is 0 where b is.
pub(super) fn loss_factor(a: f64, b: f64) -> f64 {
    LOSS * a.powf(RATIO_POWER) * b.powf(1.0 + PATH_POWER - RATIO_POWER)
}

/// (a + κ b) r of surfaces.
pub(super) fn surface_depth(a: f64, b: f64, meters: f64) -> f64 {
    let lost = (loss_factor(a, b) * meters.powf(PATH_POWER)).min(MOST_LOSS * b);
    (a + lost) * meters
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spot(cone_deg: f64) -> Beam {
        Beam::Spot {
            axis: [0.0, 0.0, 1.0],
            cos_cone: cone_deg.to_radians().cos(),
        }
    }

    #[test]
    fn a_blurred_profile_is_no_brighter_than_the_lamp_and_reaches_beyond_its_cone() {
        // Not narrower: the nearest sample of the blur is half a scale away.
        for cone_deg in [15.0, 35.0, 80.0] {
            for scale in [0.015, 0.05, 0.2] {
                let at = |degrees: f64| blurred(spot(cone_deg), scale, |_| degrees.to_radians().cos());
                assert!((0..=180).all(|degrees| (0.0..=1.0).contains(&at(f64::from(degrees)))));
                assert!(at(0.0) > at(cone_deg) && at(cone_deg) > 0.0);
            }
            let sharp = blurred(spot(cone_deg), 1e-6, |_| (0.5 * cone_deg).to_radians().cos());
            let own = spot(cone_deg).profile(|_| (0.5 * cone_deg).to_radians().cos());
            assert!((sharp - own).abs() < 1e-3);
        }
        assert_eq!(blurred(Beam::Point, 0.1, |_| 0.3), 1.0);
    }

    /// The measured κ of the model at 0.5, 1, 2 and 4 mean free paths.
    #[test]
    fn the_loss_on_the_way_to_a_surface_is_the_measured_one() {
        let waters = [
            ((0.114, 0.037), [0.024, 0.038, 0.056, 0.082]),
            ((0.179, 0.219), [0.0065, 0.0135, 0.023, 0.039]),
            ((0.118, 0.675), [0.001, 0.003, 0.006, 0.012]),
        ];
        for ((a, b), measured) in waters {
            for (x, expected) in [0.5, 1.0, 2.0, 4.0].into_iter().zip(measured) {
                let kappa = (surface_depth(a, b, x / b) - a * x / b) / x;
                let light = (-kappa * x).exp() / (-expected * x).exp();
                assert!((light - 1.0).abs() < 0.08, "{a} {b} {x}: {kappa} for {expected}");
            }
        }
    }

    #[test]
    fn water_without_scattering_loses_what_it_absorbs() {
        for meters in [0.1, 3.0, 1e6] {
            assert_eq!(glow_depth(0.3, 0.0, meters), 0.3 * meters);
            assert_eq!(surface_depth(0.3, 0.0, meters), 0.3 * meters);
        }
        assert_eq!(surface_depth(0.0, 0.3, 2.0), 0.0);
        assert!(glow_depth(0.0, 0.3, 1e9) >= -SWELL * SATURATION);
    }
}
