//! Bounds of geometry, defocus, vignette and exposure composed, `error = error * gain + bound`, against the f32 chain
//! and its f64 reference. Adversaries: full-range steps, a single bright pixel, dark scenes, ties at the metered
//! percentile, radii on the edge between two discs, input errors of one sign.
#![allow(clippy::unwrap_used)]

use camera::defocus::{self, Focus};
use camera::exposure;
use camera::geometry::{self, Lens, PortRefraction, Sampling, SourcePicture};
use camera::vignette::{self, FallOff};
use imaging::geometry::Intrinsics;
use imaging::random::Stream;
use imaging::{Plane, Rgb};
use spec::{Defocus, Distortion, Exposure, Metering};

/// Light is clipped here.
const WHITE: f64 = 1.0;
/// Frames of the committed search; overridden by `FATHOM_ATTACK_FRAMES`.
const FRAMES: u64 = 300;

/// A camera, and a scene in front of it.
struct Case {
    size: (usize, usize),
    lens: Lens,
    source: Option<SourcePicture>,
    focus: Option<Focus>,
    falloff: Option<FallOff>,
    exposure: Exposure,
    range: Plane<f32>,
    exact: Rgb<f64>,
    fast: Rgb<f32>,
}

/// Random numbers of a frame by element.
#[derive(Clone, Copy)]
struct Dice {
    stream: Stream,
    frame: u64,
}

impl Dice {
    fn unit(self, element: u64) -> f64 {
        self.stream.unit(self.frame, element)
    }

    fn uniform(self, element: u64, least: f64, most: f64) -> f64 {
        least + (most - least) * self.unit(element)
    }

    /// Log-uniform.
    fn magnitude(self, element: u64, least: f64, most: f64) -> f64 {
        self.uniform(element, least.ln(), most.ln()).exp()
    }

    fn pick(self, element: u64, count: usize) -> usize {
        ((self.unit(element) * count as f64) as usize).min(count - 1)
    }
}

impl Case {
    fn new(frame: u64) -> Self {
        let dice = Dice {
            stream: Stream::stage(11, "composition"),
            frame,
        };
        let size = [(24, 16), (33, 9), (70, 12)][dice.pick(0, 3)];
        let lens = lens(dice, size);
        let source = (dice.unit(1) < 0.7)
            .then(|| SourcePicture::covering(&lens, size, 1 + dice.pick(2, 3)))
            .flatten();
        let cosine_weight = dice.unit(3).round() * dice.unit(4);
        let terms = [5, 6, 7].map(|element| dice.uniform(element, -1.0, 1.0));
        let defocus = Defocus {
            aperture_m: dice.magnitude(8, 1e-4, 0.1),
            focus_m: dice.magnitude(9, 0.2, 20.0),
        };
        let (exact, fast) = lights(dice, source.map_or(size, |source| source.size));
        Self {
            size,
            source,
            focus: (dice.unit(10) < 0.8).then(|| Focus::new(defocus, lens.camera.focal_px, None)),
            falloff: (dice.unit(11) < 0.7)
                .then(|| FallOff::with_terms(cosine_weight, terms, lens.camera, size)),
            lens,
            exposure: exposure_of(dice),
            range: range(dice, size),
            exact,
            fast,
        }
    }

    /// The exposed light of the f32 chain, and its gain.
    fn fast(&self) -> (Rgb<f32>, f64) {
        let mut picture = match &self.source {
            Some(source) => {
                let maps = geometry::coordinates(&self.lens, source, self.size);
                Sampling::new(&maps, source.size).picture(&self.fast)
            }
            None => self.fast.clone(),
        };
        if let Some(focus) = &self.focus {
            picture = defocus::blur(&picture, &focus.radii(&self.range));
        }
        let gain = match &self.exposure {
            Exposure::Fixed(gain) => *gain,
            Exposure::Auto(metering) => exposure::metered(&picture, self.falloff.as_ref(), metering),
        };
        vignette::expose(&mut picture, self.falloff.as_ref(), gain);
        (picture, gain)
    }

    /// The exposed light of the reference, and its gain.
    fn reference(&self) -> (Rgb<f64>, f64) {
        let mut picture = match &self.source {
            Some(source) => {
                let planes = [0, 1, 2].map(|channel| {
                    let map = geometry::coordinates_reference(&self.lens, source, self.size, channel);
                    geometry::resample_reference(&self.exact.planes()[channel], &map)
                });
                Rgb::new(planes).unwrap()
            }
            None => self.exact.clone(),
        };
        if let Some(focus) = &self.focus {
            let radii = self.range.map(|&meters| focus.radius_px(f64::from(meters)));
            picture = defocus::blur_reference(&picture, &radii);
        }
        let factor = |x, y| self.falloff.map_or(1.0, |falloff| falloff.factor(x, y));
        let fallen = Rgb::from_fn(self.size.0, self.size.1, |x, y| {
            picture.pixel(x, y).map(|v| v * factor(x, y))
        });
        let gain = match &self.exposure {
            Exposure::Fixed(gain) => *gain,
            Exposure::Auto(metering) => exposure::metered_reference(&fallen, metering),
        };
        (fallen.map(|&v| v * gain), gain)
    }

    /// The bound of exposed light clipped at white, with a gain of at most `gain`.
    fn bound(&self, gain: f64) -> f64 {
        let lights = self.fast.planes().iter().flat_map(|plane| plane.data());
        let peak = f64::from(lights.fold(0.0f32, |peak, &v| peak.max(v)));
        let mut error = largest_difference(&self.exact, &self.fast, f64::INFINITY);
        if let Some(source) = &self.source {
            error += geometry::sampling_bound(source, peak, peak);
        }
        // Light after a stage is at most the error of the stage brighter.
        let peak = peak + error;
        if let Some(focus) = &self.focus {
            let ranges = || self.range.data().iter().map(|&meters| f64::from(meters));
            let nearest = ranges().fold(f64::INFINITY, f64::min);
            let is_hole = |meters: f64| !(meters.is_finite() && meters > 0.0);
            let farthest = if ranges().any(is_hole) {
                f64::INFINITY
            } else {
                ranges().fold(0.0, f64::max)
            };
            error += defocus::rounding_bound(focus.largest_px(nearest, farthest), peak);
        }
        let largest = self
            .falloff
            .map_or(1.0, |falloff| falloff.limits(self.size).largest);
        let error = error * largest;
        let exposed = match &self.exposure {
            Exposure::Fixed(gain) => gain * error,
            Exposure::Auto(metering) => {
                exposure::metered_slope(gain, metering, WHITE) * error
                    + exposure::luminance_rounding() * WHITE
            }
        };
        let peak = (gain * largest * (peak + error)).min(WHITE);
        exposed + vignette::rounding_bound(self.falloff.as_ref(), gain, peak)
    }

    /// The largest gain without metering.
    fn most_gain(&self) -> f64 {
        match self.exposure {
            Exposure::Fixed(gain) => gain,
            Exposure::Auto(_) => exposure::MOST_GAIN,
        }
    }
}

fn lens(dice: Dice, size: (usize, usize)) -> Lens {
    let focal_px = size.0 as f64 * dice.magnitude(20, 0.4, 4.0);
    let distortion = Distortion {
        k1: dice.uniform(21, -0.2, 0.3),
        k2: dice.uniform(22, -0.05, 0.05),
        p1: dice.uniform(23, -0.01, 0.01),
        ..Distortion::default()
    };
    let refractions = [
        PortRefraction::None,
        PortRefraction::Flat { index: [1.34; 3] },
        PortRefraction::Flat {
            index: [1.33, 1.34, 1.35],
        },
    ];
    let camera = Intrinsics::centered(focal_px, size.0, size.1);
    let bent = Lens {
        camera,
        distortion,
        refraction: refractions[dice.pick(24, 3)],
    };
    let plain = Lens {
        distortion: Distortion::default(),
        ..bent
    };
    if bent.check(size).is_ok() { bent } else { plain }
}

fn exposure_of(dice: Dice) -> Exposure {
    if dice.unit(30) < 0.5 {
        return Exposure::Fixed(dice.magnitude(31, 1e-2, 1e3));
    }
    Exposure::Auto(Metering {
        target: dice.magnitude(32, 0.05, 4.0),
        percentile: [0.0, 0.25, 0.5, 0.75, 0.95, 0.998, 1.0][dice.pick(33, 7)],
        lag_frames: 0.0,
    })
}

/// Constant ranges, steps, slopes, noise and holes.
fn range(dice: Dice, size: (usize, usize)) -> Plane<f32> {
    let [near, far] = [40, 41].map(|element| dice.magnitude(element, 0.1, 30.0));
    let kind = dice.pick(42, 5);
    Plane::from_fn(size.0, size.1, |x, y| {
        let sample = (100_000 + x + 512 * y) as u64;
        let share = match kind {
            0 => 0.0,
            1 => ((x + y) % 7 / 4) as f64,
            2 => (x + y) as f64 / (size.0 + size.1) as f64,
            3 if dice.unit(sample) < 0.1 => return f32::NAN,
            _ => dice.unit(sample),
        };
        (near + (far - near) * share) as f32
    })
}

/// The light of the reference, and that of the fast chain with an error.
fn lights(dice: Dice, size: (usize, usize)) -> (Rgb<f64>, Rgb<f32>) {
    let level = dice.magnitude(50, 1e-6, 3.0);
    let kind = dice.pick(51, 6);
    let bright = (dice.pick(52, size.0), dice.pick(53, size.1));
    let exact = Rgb::from_fn(size.0, size.1, |x, y| {
        [0, 1, 2].map(|channel| {
            let unit = dice.unit((200_000 + channel + 3 * (x + 2048 * y)) as u64);
            level
                * match kind {
                    // Steps, a single bright pixel, ties on both sides of a percentile, gradients, noise, uniform
                    // light.
                    0 => ((x / 3 + y / 2) % 2) as f64,
                    1 => f64::from((x, y) == bright),
                    2 if x % 4 == 0 => 0.5,
                    2 => 1.0,
                    3 => (x + y) as f64 / (size.0 + size.1) as f64,
                    4 => unit,
                    _ => 1.0 - 1e-6 * unit,
                }
        })
    });
    let error = [0.0, 1e-8, 1e-5][dice.pick(54, 3)] * level;
    let side = dice.pick(55, 3);
    let fast = Rgb::from_fn(size.0, size.1, |x, y| {
        let sign = match side {
            0 => 1.0,
            1 => -1.0,
            _ => dice.unit((x + 512 * y) as u64 + 900_000).round() * 2.0 - 1.0,
        };
        exact.pixel(x, y).map(|v| (v + sign * error).max(0.0) as f32)
    });
    (exact, fast)
}

/// The largest difference of light, both clipped at white.
fn largest_difference(exact: &Rgb<f64>, fast: &Rgb<f32>, white: f64) -> f64 {
    let planes = exact.planes().iter().zip(fast.planes());
    let pairs = planes.flat_map(|(exact, fast)| exact.data().iter().zip(fast.data()));
    let differences = pairs.map(|(e, &f)| (e.min(white) - f64::from(f).min(white)).abs());
    differences.fold(0.0, f64::max)
}

#[test]
fn no_exposed_light_errs_by_more_than_the_composed_bound() {
    let frames = std::env::var("FATHOM_ATTACK_FRAMES").ok();
    let frames = frames.map_or(FRAMES, |frames| frames.parse().unwrap());
    let mut ratios = Vec::new();
    for frame in 0..frames {
        let case = Case::new(frame);
        let ((exact, gain), (fast, fast_gain)) = (case.reference(), case.fast());
        let (error, metered) = (largest_difference(&exact, &fast, WHITE), gain.max(fast_gain));
        for gain in [metered, case.most_gain()] {
            let bound = case.bound(gain);
            assert!(error <= bound, "frame {frame}: {error:e} of {bound:e}");
        }
        if error > 0.0 {
            ratios.push(case.bound(metered) / error);
        }
    }
    ratios.sort_by(f64::total_cmp);
    let (tightest, median) = (ratios[0], ratios[ratios.len() / 2]);
    println!(
        "{} frames: bound/error at least {tightest:.3}, median {median:.2}",
        ratios.len()
    );
    assert!(median < 20.0, "{median}");
}
