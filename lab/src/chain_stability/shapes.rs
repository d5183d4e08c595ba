//! Sizes, holes, threads.

use imaging::{Plane, Rgb};
use optics::chain::check_radiance;
use optics::forward_scatter::KernelCache;
use optics::medium::Medium;
use optics::water::Water;
use spec::{Fidelity, ForwardScatter, HoleRule, Optics, ScatterModel};

use super::trial::{TOLERANCE, Trial, noise, slope, water};
use super::{Figure, Finding, pictures};

const ASKED: Fidelity = Fidelity::Tolerance(TOLERANCE);

/// The largest error over sizes and both forms.
fn worst(sizes: &[(usize, usize)]) -> f64 {
    let models = [ScatterModel::Jaffe, ScatterModel::Simplified];
    let trials = sizes.iter().flat_map(|&size| {
        models.map(|model| Trial {
            radiance: noise(size, 1.0),
            range: slope(size, 0.5, 20.0),
            water: water(model, 1.0),
        })
    });
    trials.map(|trial| trial.error(ASKED)).fold(0.0, f64::max)
}

/// Frames one or a few pixels wide or high.
#[must_use]
pub fn single_pixels_and_lines() -> Finding {
    Finding {
        test: "single_pixels_and_lines",
        tried: "1×1, 1×2, 2×1, 1×97, 97×1, 2×2 and 3×1 pixels.",
        figures: vec![Figure::at_most(
            "error at tolerance 3e-4",
            worst(&[(1, 1), (1, 2), (2, 1), (1, 97), (97, 1), (2, 2), (3, 1)]),
            TOLERANCE,
        )],
        meaning: "The smallest frames work. In one pixel all spread light stays where it is.",
        picture: None,
    }
}

/// Sizes without a fast transform.
#[must_use]
pub fn prime_sizes() -> Finding {
    Finding {
        test: "prime_sizes",
        tried: "127×97, 61×53, 31×2, 17×13 and, beside them, 128×96 and 60×54.",
        figures: vec![
            Figure::at_most(
                "error, prime sides",
                worst(&[(127, 97), (61, 53), (31, 2), (17, 13)]),
                TOLERANCE,
            ),
            Figure::at_most("error, composite sides", worst(&[(128, 96), (60, 54)]), TOLERANCE),
        ],
        meaning: "Any size is as exact as any other. Sides with large prime factors cost more time; see the chart of cost \
                  against size.",
        picture: None,
    }
}

fn with_holes(rule: HoleRule) -> Water {
    let request = Medium {
        holes: rule,
        ..Optics {
            beam_attenuation_per_m: Some([0.37, 0.12, 0.09]),
            veiling_light: Some([0.03, 0.12, 0.18]),
            forward_scatter: Some(ForwardScatter {
                spread_px_per_m: Some([1.0; 3]),
                g_per_m: Some([0.13, 0.042, 0.0315]),
                ..ScatterModel::Jaffe.into()
            }),
            ..Optics::default()
        }
        .into()
    };
    Water::resolve(&request, 500.0).expect("a consistent water")
}

/// Invalid ranges.
#[must_use]
pub fn holes_of_every_kind() -> Finding {
    let size = (48, 32);
    let trial = |size: (usize, usize), rule, kind: f32| Trial {
        radiance: noise(size, 1.0),
        range: Plane::from_fn(size.0, size.1, |x, y| {
            let cell = size.0 / 9;
            let hole = (x / cell + y / cell).is_multiple_of(3);
            if hole {
                kind
            } else {
                slope(size, 1.0, 12.0).pixel(x, y)
            }
        }),
        water: with_holes(rule),
    };
    let kinds = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, -3.0, 5e-4];
    let images = kinds.map(|kind| trial(size, HoleRule::Background, kind).fast(ASKED).scattered);
    let bits = |image: &Rgb<f32>| -> Vec<u32> {
        image
            .planes()
            .iter()
            .flat_map(|plane| plane.data().iter().map(|v| v.to_bits()))
            .collect()
    };
    let first = bits(&images[0]);
    let differing = images
        .iter()
        .map(|image| bits(image).iter().zip(&first).filter(|(a, b)| a != b).count())
        .sum::<usize>();
    let no_number = images
        .iter()
        .flat_map(|image| image.planes())
        .flat_map(|plane| plane.data())
        .filter(|v| !v.is_finite())
        .count();
    let all = Trial {
        range: Plane::filled(size.0, size.1, f32::NAN),
        ..trial(size, HoleRule::Background, 0.0)
    };
    let errors =
        [HoleRule::Background, HoleRule::RangeM(8.0)].map(|rule| trial(size, rule, f32::NAN).error(ASKED));
    let shown = [HoleRule::Background, HoleRule::RangeM(3.0)].map(|rule| {
        let size = (240, 160);
        let radiance = Rgb::from_fn(size.0, size.1, |x, y| {
            [if (x / 8 + y / 8) % 2 == 0 { 0.9 } else { 0.3 }; 3]
        });
        let trial = Trial {
            radiance,
            ..trial(size, rule, f32::NAN)
        };
        trial.fast(ASKED).scattered
    });
    Finding {
        test: "holes_of_every_kind",
        tried: "A third of the pixels NaN, +∞, −∞, 0, negative or half a millimeter away, under both rules; and a frame of \
                nothing but holes.",
        figures: vec![
            Figure::at_most(
                "error at tolerance 3e-4",
                errors.into_iter().fold(0.0, f64::max),
                TOLERANCE,
            ),
            Figure::at_most("samples that are no number", no_number as f64, 0.0),
            Figure::at_most(
                "samples that differ between the kinds of hole",
                differing as f64,
                0.0,
            ),
            Figure::at_most("error of a frame of holes", all.error(ASKED), TOLERANCE),
        ],
        meaning: "A hole shows the veil of the water, with light of its neighbors scattered over it, and throws none itself. \
                  Where holes are failures of a sensor and not open water, give them a distance (`\"holes\": {\"range_m\": …}`) \
                  or refuse them.",
        picture: Some((
            "holes",
            "A third of the pixels without range: as background, and as if they were 3 m away.",
            pictures::row(&shown),
        )),
    }
}

/// Invalid radiance.
#[must_use]
pub fn radiance_that_is_no_number() -> Finding {
    let size = (13, 7);
    let refused = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY]
        .into_iter()
        .filter(|bad| {
            let mut radiance = noise(size, 1.0);
            radiance.planes_mut()[2][40] = *bad;
            check_radiance(&mut radiance)
                .is_err_and(|error| error.to_string().contains("channel B of pixel (1, 3)"))
        });
    let mut negative = noise(size, 1.0).map(|&v| v - 0.5);
    let below = negative
        .planes()
        .iter()
        .flat_map(|p| p.data())
        .filter(|v| **v < 0.0)
        .count();
    let counted = check_radiance(&mut negative).unwrap_or(0);
    Finding {
        test: "radiance_that_is_no_number",
        tried: "NaN, +∞ and −∞ in one sample; half of the samples negative.",
        figures: vec![
            Figure::at_least("refused with the pixel named, of 3", refused.count() as f64, 3.0),
            Figure::at_most(
                "negative samples that were not counted",
                below as f64 - counted as f64,
                0.0,
            ),
        ],
        meaning: "One bad sample would destroy a whole frame in the transform; the frame fails instead, and the error names the \
                  first such pixel. Negative light becomes 0, and the record says how often.",
        picture: None,
    }
}

/// The same frames rendered by one thread and by several.
#[must_use]
pub fn threads() -> Finding {
    const FRAMES: usize = 8;
    let frame = |index: usize| {
        let size = (20 + 7 * index, 41);
        Trial {
            radiance: noise(size, 1.0),
            range: slope(size, 0.5, 5.0 + index as f32),
            water: water(ScatterModel::Jaffe, 1.0),
        }
    };
    let alone: Vec<Rgb<f32>> = (0..FRAMES)
        .map(|index| frame(index).fast(ASKED).scattered)
        .collect();
    let mut differing = 0;
    for threads in [2, 4, 8] {
        let images: Vec<(usize, Rgb<f32>)> = std::thread::scope(|scope| {
            let work = |thread: usize| {
                let mut cache = KernelCache::new();
                // Each thread renders the frames in another order, with the buffers of its previous frame.
                let mut take = |step: usize| {
                    let index = (step * 3 + thread) % FRAMES;
                    let layers = frame(index).with(ASKED, &mut cache);
                    let image = layers.scattered.clone();
                    cache.recycle(layers);
                    (index, image)
                };
                (0..FRAMES).map(&mut take).collect::<Vec<_>>()
            };
            let handles: Vec<_> = (0..threads).map(|t| scope.spawn(move || work(t))).collect();
            handles
                .into_iter()
                .flat_map(|handle| handle.join().unwrap_or_default())
                .collect()
        });
        differing += threads * FRAMES
            - images
                .iter()
                .filter(|(index, image)| *image == alone[*index])
                .count();
    }
    Finding {
        test: "threads",
        tried: "Eight frames of different sizes on 1, 2, 4 and 8 threads, each thread in another order with one cache for all.",
        figures: vec![Figure::at_most(
            "pictures that differ in any bit",
            differing as f64,
            0.0,
        )],
        meaning: "Threads work on different frames and share nothing: a job gives the same bytes with any number of slots.",
        picture: None,
    }
}
