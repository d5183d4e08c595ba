//! Daylight around the camera in a form that is cheap at every pixel.
//!
//! From the radiances of [`super::transport`], per unit of downwelling irradiance at the camera:
//!
//! ```text
//! L(v, Z) = A(μ) ℓ(k(μ), Z) + b E_s p(v·s) ℓ(c − c μ/μ_s, Z) + b E_s p_a(v·s) ℓ(c + (1 − w) b − c μ/μ_s, Z),
//! ℓ(k, Z) = (1 − e^{−k Z})/k
//! ```
//!
//! is the light that the water scatters into a ray of length Z in the direction v that one looks in; μ is its cosine from the vertical
//! (1 up), s the direction to the sun with cosine μ_s and E_s the sun's irradiance at right angles to it. The second term is sunlight that
//! is scattered once, the third its aureole ([`super::aureole`]), the first all other. `ln A` and k are polynomials in μ; k is such that the light along the whole ray, up to the
//! surface, is that of the radiative transfer. Upward rays end at the surface with `e^{−c h/μ} ((1 − R) sky + R mirrored)`.
//!
//! All lengths here are those of the range, and coefficients are per unit of it: a range scale multiplies the ones and divides the depth.

use std::cell::Cell;

use super::aureole::Aureole;
use super::model::{Bottom, CRITICAL_COSINE, fresnel};
use super::slope::{SLOPES, share_by_slope};
use super::sun::SunLight;
use super::transport::{Above, DIRECTIONS, Exchange, FIRST_UP, Radiance, azimuth_mean, effective_length};
use super::wide::{PEAK_COSINE, Repeated, TERMS, WideScattering};
use crate::polynomial::Polynomial;

/// How far inside the window's edge its reflectance is taken at least: at the edge itself it is 1.
pub(super) const EDGE_INSIDE: f64 = 0.02;
/// Least cosine in the exponent of light from the surface.
pub(super) const LEAST_COSINE: f64 = 1e-3;
/// Irradiance grows toward the surface by e to this power at most.
pub(super) const MOST_GAIN: f64 = 20.0;
/// Width of the window's edge in the cosine: of light that kept its direction, which waves spread by about two degrees, and of light from
/// the forward peak.
pub(super) const SHARP_EDGE: f64 = 0.06;
pub(super) const BLURRED_EDGE: f64 = 0.3;
/// Darker radiance counts as this.
const DARKEST: f64 = 1e-12;

/// Brighter sky counts as this: kilometers down it is a number of f32 still, and nothing of it arrives.
const BRIGHTEST: f64 = 1e30;

/// Coefficients of the polynomials.
pub(super) const SOURCE_TERMS: usize = 7;
pub(super) const RATE_TERMS: usize = 6;
pub(super) const MIRROR_TERMS: usize = 4;

/// The radiance field of one channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Field {
    /// K, the mean decay of irradiance between the surface and the camera.
    pub decay: f64,
    /// c = a + w b, where the forward peak of scattering does not count.
    pub attenuation: f64,
    /// (1 − w) b, the forward peak, which blurs the edge of the window and draws the aureole of the sun.
    pub peak: f64,
    /// Radiance of the horizon.
    pub horizon: f64,
    /// `ln A(μ)`.
    pub(super) source: Polynomial<SOURCE_TERMS>,
    /// k(μ).
    pub(super) rate: Polynomial<RATE_TERMS>,
    /// Logarithm of the radiance in every direction without the direct sun.
    pub(super) around: Polynomial<SOURCE_TERMS>,
    /// Logarithm of the upwelling radiance at the surface in the mirrored direction, by the cosine of the direction that looks up.
    pub(super) mirrored: Polynomial<MIRROR_TERMS>,
    /// Radiance of the sky in the water before the surface reflects a part of it.
    pub(super) sky: f64,
    /// b E_s.
    pub(super) sunlight: f64,
    /// Logarithm of the phase function of sunlight by the cosine from the sun: of one scattering, and of a second as far as its light
    /// still depends on the azimuth.
    pub(super) sunny: Polynomial<TERMS>,
    /// p_a.
    pub(super) aureole: Aureole,
    /// Irradiance without the direct sun by the slope of a surface, over that of a horizontal one.
    pub slopes: [f64; SLOPES],
}

/// The daylight of a place: three channels and the phase function that they share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Fields {
    pub(crate) channels: [Field; 3],
    /// Downwelling irradiance at the camera where that just below the surface is 1.
    pub(crate) irradiance: [f64; 3],
    pub(crate) wide: WideScattering,
}

/// A place in the sea.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Place {
    pub(crate) absorption: [f64; 3],
    pub(crate) scattering: [f64; 3],
    pub(crate) depth_m: f64,
    pub(crate) sun: Option<SunLight>,
    /// True meters of one length of the range.
    pub(crate) scale: f64,
    pub(crate) bottom: Option<Bottom>,
}

impl Place {
    /// Length of a whole ray, m.
    fn end(&self, rise: f64) -> f64 {
        if rise > 0.0 {
            self.depth_m / rise
        } else {
            self.bottom.map_or(f64::INFINITY, |bottom| bottom.below_m / -rise)
        }
    }

    fn above(&self, channel: usize) -> Above {
        Above {
            depth: self.depth_m,
            sun: self.sun,
            bottom: self
                .bottom
                .map(|bottom| (bottom.below_m, bottom.reflectance[channel])),
        }
    }
}

thread_local! {
    /// The last place and its fields: a frame, its thinned picture and its moments are at one place.
    static LAST: Cell<Option<(Place, Fields)>> = const { Cell::new(None) };
}

impl Fields {
    /// [`Fields::new`], which is not computed again for the place before.
    pub(crate) fn find(place: &Place, wide: WideScattering) -> Self {
        if let Some((last, fields)) = LAST.get()
            && last == *place
            && fields.wide == wide
        {
            return fields;
        }
        let fields = Self::new(place, wide);
        LAST.set(Some((*place, fields)));
        fields
    }

    pub(super) fn new(place: &Place, wide: WideScattering) -> Self {
        let exchange = Exchange::new(wide);
        let radiances =
            [0, 1, 2].map(|i| exchange.solve(place.absorption[i], place.scattering[i], place.above(i)));
        let channel = |i: usize| Field::new(&radiances[i], &exchange, place, place.scattering[i]);
        Self {
            channels: [0, 1, 2].map(channel),
            irradiance: radiances.each_ref().map(|radiance| radiance.irradiance),
            wide,
        }
    }
}

impl Field {
    fn new(radiance: &Radiance, exchange: &Exchange, place: &Place, scattering: f64) -> Self {
        let &Place { depth_m, scale, .. } = place;
        let nodes = &exchange.directions;
        let relative = |light: f64| (light / radiance.irradiance).max(DARKEST);
        let samples = |values: [f64; DIRECTIONS]| {
            (0..DIRECTIONS).map(move |j| [nodes[j].rise, values[j], nodes[j].weight])
        };
        let twice = SecondSunlight::new(radiance, exchange, place, scattering);
        let peak = (1.0 - exchange.wide.share) * scattering;
        let sun_rise = place.sun.map_or(1.0, |sun| sun.rise);
        let [source, path] = twice.remove_from(radiance);
        let rates: [f64; DIRECTIONS] = std::array::from_fn(|j| {
            let length = path[j] / source[j].max(f64::MIN_POSITIVE);
            rate_of(length, place.end(nodes[j].rise), radiance.attenuation)
        });
        let source = Polynomial::fit(samples(source.map(|light| (relative(light) * scale).ln())));
        let rate = Polynomial::fit(samples(rates.map(|rate| rate * scale)));
        Self {
            decay: scale * decay_of(radiance, depth_m, exchange.wide.share * scattering),
            attenuation: radiance.attenuation * scale,
            peak: peak * scale,
            horizon: source.value(0.0).exp() / rate.value(0.0),
            source,
            rate,
            around: Polynomial::fit(samples(radiance.total.map(|light| relative(light).ln()))),
            mirrored: Polynomial::fit(
                samples(radiance.mirrored.map(|light| relative(light).ln())).skip(FIRST_UP),
            ),
            sky: (radiance.sky / radiance.irradiance).min(BRIGHTEST),
            sunlight: scattering * scale * radiance.sun / radiance.irradiance,
            sunny: exchange.wide.with_repeated(&twice.repeated, twice.share),
            aureole: exchange.peak.aureole(peak * depth_m / sun_rise),
            slopes: share_by_slope(&nodes.map(|node| [node.rise, node.weight]), &radiance.total),
        }
    }

    /// k in a direction.
    #[must_use]
    pub(super) fn rate(&self, rise: f64) -> f64 {
        self.rate.value(rise)
    }

    /// Light that water scatters into a ray of this length, without singly scattered sunlight.
    #[must_use]
    pub(super) fn scattered(&self, rise: f64, length: f64) -> f64 {
        let rate = self.rate(rise).max(-MOST_GAIN / length.max(f64::MIN_POSITIVE));
        self.source.value(rise).exp() * effective_length(rate, length)
    }

    /// Singly scattered sunlight of a ray at this cosine from the sun.
    #[must_use]
    pub(super) fn sunlit(&self, ray: SunnyRay) -> f64 {
        let rate = self.attenuation * (1.0 - ray.rise / ray.sun_rise);
        let rate = rate.max(-MOST_GAIN / ray.length.max(f64::MIN_POSITIVE));
        let density = self
            .sunny
            .value((1.0 - ray.versine).clamp(-1.0, PEAK_COSINE))
            .exp();
        self.sunlight * density * effective_length(rate, ray.length)
    }

    /// Sunlight that only the forward peak scattered into a ray.
    #[must_use]
    pub(super) fn aureole(&self, ray: SunnyRay) -> f64 {
        self.aureole.density(ray.versine) * self.aureole_length(ray)
    }

    /// An upper bound of the aureole on rays of this cosine from the vertical at this angle from the sun or a larger one.
    #[must_use]
    pub(super) fn most_aureole(&self, ray: SunnyRay) -> f64 {
        self.aureole.most(ray.versine) * self.aureole_length(ray)
    }

    fn aureole_length(&self, ray: SunnyRay) -> f64 {
        let rate = self.attenuation * (1.0 - ray.rise / ray.sun_rise) + self.peak;
        let rate = rate.max(-MOST_GAIN / ray.length.max(f64::MIN_POSITIVE));
        self.sunlight * effective_length(rate, ray.length)
    }

    /// Light from the surface at the end of a ray that rises.
    #[must_use]
    pub(super) fn surface(&self, rise: f64, depth: f64) -> f64 {
        if rise <= 0.0 {
            return 0.0;
        }
        let steep = rise.max(LEAST_COSINE);
        let blurred = -(-self.peak * depth / steep).exp_m1();
        let inside = (1.0 - blurred) * ramp(rise, SHARP_EDGE) + blurred * ramp(rise, BLURRED_EDGE);
        let through = (1.0 - fresnel(rise.max(CRITICAL_COSINE + EDGE_INSIDE))) * inside;
        let light = through * self.sky + (1.0 - through) * self.mirrored.value(rise).exp();
        light * (-self.attenuation * depth / steep).exp()
    }
}

/// From 0 outside of the window to 1 inside, over this width of the cosine.
fn ramp(rise: f64, width: f64) -> f64 {
    let s = ((rise - CRITICAL_COSINE) / width + 0.5).clamp(0.0, 1.0);
    s * s * (3.0 - 2.0 * s)
}

/// A ray through sunlit water.
#[derive(Debug, Clone, Copy)]
pub(super) struct SunnyRay {
    pub(super) rise: f64,
    pub(super) length: f64,
    /// 1 − cos of the angle to the sun, whose cosine has too few digits close to it.
    pub(super) versine: f64,
    pub(super) sun_rise: f64,
}

/// Sunlight that was scattered twice. The transfer keeps only its mean over the azimuth; here it gets back the direction of the sun, as
/// if every first scattering had the same path.
struct SecondSunlight {
    repeated: Repeated,
    /// Its source over that of one scattering.
    share: f64,
    /// Its mean over the azimuth, source and path, in each direction.
    means: [[f64; DIRECTIONS]; 2],
}

/// At least this share of the source stays even over the azimuth.
const LEAST_EVEN: f64 = 0.2;

impl SecondSunlight {
    fn new(radiance: &Radiance, exchange: &Exchange, place: &Place, scattering: f64) -> Self {
        let repeated = exchange.wide.repeated();
        let nodes = &exchange.directions;
        let Some(sun) = place.sun.filter(|_| radiance.sun > 0.0 && scattering > 0.0) else {
            return Self {
                repeated,
                share: 0.0,
                means: [[0.0; DIRECTIONS]; 2],
            };
        };
        let single = scattering * radiance.sun;
        let mean = nodes.map(|node| single * azimuth_mean(node.rise, sun.rise, |x| repeated.density(x)));
        let weighted = |values: &[f64; DIRECTIONS]| -> f64 {
            nodes
                .iter()
                .zip(values)
                .map(|(node, value)| node.weight * value)
                .sum()
        };
        let lengths = nodes.map(|node| {
            let rate = radiance.attenuation * (1.0 - node.rise / sun.rise);
            effective_length(rate.max(-MOST_GAIN / place.end(node.rise)), place.end(node.rise))
        });
        let fits = |part: f64, whole: f64| (1.0 - LEAST_EVEN) * whole / part.max(f64::MIN_POSITIVE);
        let limits = (0..DIRECTIONS)
            .map(|j| fits(mean[j], radiance.source[j]).min(fits(mean[j] * lengths[j], radiance.path[j])));
        let share = limits.fold(
            weighted(&radiance.twice) / weighted(&mean).max(f64::MIN_POSITIVE),
            f64::min,
        );
        Self {
            repeated,
            share,
            means: [
                mean.map(|light| share * light),
                std::array::from_fn(|j| share * mean[j] * lengths[j]),
            ],
        }
    }

    /// Source and path without it.
    fn remove_from(&self, radiance: &Radiance) -> [[f64; DIRECTIONS]; 2] {
        let [source, path] = &self.means;
        [
            std::array::from_fn(|j| radiance.source[j] - source[j]),
            std::array::from_fn(|j| radiance.path[j] - path[j]),
        ]
    }
}

/// Attenuation lengths of a path below which its decay is lost in the error of the iteration.
const SHORT: f64 = 1e-2;
/// Mean cosine of the light of an even sky below the surface.
const DIFFUSE_COSINE: f64 = 0.86;

/// K between the surface and a depth. At least a: the surface mirrors upwelling light, so irradiance may grow at first, but below it
/// decays by absorption (Gershun 1939).
fn decay_of(radiance: &Radiance, depth_m: f64, wide_scattering: f64) -> f64 {
    let absorption = radiance.attenuation - wide_scattering;
    if radiance.attenuation * depth_m < SHORT {
        absorption / DIFFUSE_COSINE
    } else {
        (-radiance.irradiance.ln() / depth_m).max(absorption)
    }
}

/// k of rays that never end is at least this share of c.
const LEAST_RATE: f64 = 0.02;

/// The k for which `ℓ(k, end)` is a length: by bisection, since ℓ falls with k.
fn rate_of(length: f64, end: f64, attenuation: f64) -> f64 {
    if length <= 0.0 || !length.is_finite() || attenuation * end < SHORT {
        return attenuation;
    }
    if end == f64::INFINITY {
        return (1.0 / length).max(LEAST_RATE * attenuation);
    }
    let bound = MOST_GAIN / end;
    let (mut low, mut high) = (-bound, (2.0 / length).max(bound));
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if effective_length(middle, end) > length {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

impl SunLight {
    /// Decay rate of the sun's share with depth in a channel, `c/μ − K`.
    #[must_use]
    pub(super) fn fading(&self, field: &Field) -> f64 {
        field.attenuation / self.rise - field.decay
    }

    /// σ, the sun's share in the irradiance of a channel at a depth: `clamp(share e^{−(c/μ − K) z}, 0, 1)`.
    #[must_use]
    pub fn share_at(&self, field: &Field, depth: f64) -> f64 {
        (self.share * (-self.fading(field) * depth).min(MOST_GAIN).exp()).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests;
