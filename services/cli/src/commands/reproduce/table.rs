//! Table 1: the enhancement methods by five metrics, over simulated frames.

use std::time::Instant;

use cli::exit::Failure;
use imaging::{Raster, Rgb8};
use quality::MetricId;
use spec::Enhancement;

/// Columns of the published table, in its profile; the metrics of the usual profile follow.
pub(super) const METRICS: [&str; 5] = [
    "entropy_2d",
    "uicm@table1",
    "uism@table1",
    "uiconm@table1",
    "uiqm@table1",
];
/// The same metrics in the profile that other commands use by default, and the evenness of the illumination, the aim of HSCM.
pub(super) const USUAL_METRICS: [&str; 6] = ["entropy", "uicm", "uism", "uiconm", "uiqm", "light_uniformity"];

/// A row of the table.
pub(super) struct Method {
    pub(super) title: &'static str,
    /// Name of the enhancement; `None` for the frame itself.
    name: Option<&'static str>,
    pub(super) published: Option<Published>,
    /// Why the numbers differ, besides the frames.
    pub(super) differs: &'static str,
}

/// The published numbers of a method.
pub(super) struct Published {
    pub(super) seconds: f64,
    /// In the order of [`METRICS`].
    pub(super) means: [f64; 5],
    /// Standard deviation of the entropy, the only one published.
    pub(super) entropy_deviation: f64,
}

impl Method {
    const fn published(
        title: &'static str,
        name: &'static str,
        published: Published,
        differs: &'static str,
    ) -> Self {
        Self {
            title,
            name: Some(name),
            published: Some(published),
            differs,
        }
    }

    const fn added(title: &'static str, name: Option<&'static str>, differs: &'static str) -> Self {
        Self {
            title,
            name,
            published: None,
            differs,
        }
    }
}

const fn numbers(seconds: f64, entropy_deviation: f64, means: [f64; 5]) -> Published {
    Published {
        seconds,
        means,
        entropy_deviation,
    }
}

/// The methods of the published table in its order, and three that it lacks.
pub(super) const METHODS: [Method; 9] = [
    Method::published(
        "SUIR",
        "suir",
        numbers(7.08, 0.19, [10.14, 4.42, 2.45, -0.12, 1.02]),
        "No rounding to 8 bit between its steps",
    ),
    Method::published(
        "IBLA",
        "ibla",
        numbers(14.0, 0.43, [4.62, 5.59, 2.24, -0.65, 1.17]),
        "As its authors published it; the public collection takes a lamp for the water and blackens the picture, hence 4.62",
    ),
    Method::published(
        "ULAP",
        "ulap",
        numbers(1.01, 0.23, [10.49, 5.79, 2.62, -0.61, 1.29]),
        "Coefficients, factor and clamps of its authors, which the collection changes",
    ),
    Method::published(
        "RD",
        "rd",
        numbers(3.54, 0.14, [10.77, 5.29, 2.67, -0.55, 1.27]),
        "Nearly as in the collection",
    ),
    Method::published(
        "RGHS",
        "rghs",
        numbers(2.28, 0.13, [10.49, 3.94, 2.42, -0.63, 1.17]),
        "The collection replaces its stretch by the full range of each channel",
    ),
    Method::published(
        "HSCM",
        "hscm",
        numbers(0.33, 0.09, [10.42, 3.09, 2.56, -0.23, 1.05]),
        "Mirrored borders, a cutoff that is not rounded, and a limit in the logarithm; without the mask, as in the paper",
    ),
    Method::added("Frame", None, "Not in the published table"),
    Method::added("CLAHE", Some("clahe"), "Not in the published table"),
    Method::added("Gray world", Some("gray_world"), "Not in the published table"),
];

/// All values of one frame.
pub(super) struct FrameValues {
    /// One for each of [`METHODS`].
    methods: Vec<MethodValues>,
}

struct MethodValues {
    /// Of [`METRICS`], then of [`USUAL_METRICS`].
    values: Vec<f64>,
    seconds: f64,
    is_warned: bool,
}

/// Enhances a frame by each method and measures the results without a mask.
///
/// # Errors
/// A method fails, or a metric does not exist.
pub(super) fn measure_frame(frame: &Rgb8) -> Result<FrameValues, Failure> {
    let metrics = METRICS
        .iter()
        .chain(&USUAL_METRICS)
        .map(|name| MetricId::parse(name));
    let metrics: Option<Vec<MetricId>> = metrics.collect();
    let metrics = metrics.ok_or_else(|| anyhow::anyhow!("an unknown metric"))?;
    let raster = Raster::from(frame.clone());
    let methods = METHODS.iter().map(|method| {
        let begun = Instant::now();
        let (result, is_warned) = match method.name {
            None => (frame.clone(), false),
            Some(name) => {
                let enhancement = Enhancement::of_method(name);
                let enhancement = enhancement.ok_or_else(|| anyhow::anyhow!("no method `{name}`"))?;
                let outcome = enhance::enhance(&enhancement, &raster, &[], &mut enhance::refuse_network);
                let outcome = outcome.map_err(Failure::input)?;
                (outcome.unmasked.to_rgb8(), !outcome.warnings.is_empty())
            }
        };
        let seconds = begun.elapsed().as_secs_f64();
        let measured = quality::measure(&result, None, &metrics).map_err(Failure::input)?;
        let values = measured.into_iter().map(|(_, value)| value).collect();
        Ok(MethodValues {
            values,
            seconds,
            is_warned,
        })
    });
    Ok(FrameValues {
        methods: methods.collect::<Result<_, Failure>>()?,
    })
}

/// Mean and standard deviation over the frames.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Spread {
    pub(super) mean: f64,
    pub(super) deviation: f64,
}

impl Spread {
    fn new(values: &[f64]) -> Self {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        Self {
            mean,
            deviation: (squares / (count - 1.0).max(1.0)).sqrt(),
        }
    }
}

/// A method over all frames.
pub(super) struct Summary {
    /// One for each of [`METRICS`].
    pub(super) published_profile: Vec<Spread>,
    /// One for each of [`USUAL_METRICS`].
    pub(super) usual_profile: Vec<Spread>,
    /// Seconds a frame on one thread.
    pub(super) seconds: Spread,
    /// Number of frames with a warning.
    pub(super) warned: usize,
}

/// The summaries of [`METHODS`] over at least one frame.
pub(super) fn summarize(frames: &[FrameValues]) -> Vec<Summary> {
    let methods = 0..METHODS.len();
    methods
        .map(|method| {
            summarize_method(
                &frames
                    .iter()
                    .map(|frame| &frame.methods[method])
                    .collect::<Vec<_>>(),
            )
        })
        .collect()
}

fn summarize_method(frames: &[&MethodValues]) -> Summary {
    let metrics = 0..METRICS.len() + USUAL_METRICS.len();
    let spreads = metrics.map(|metric| {
        Spread::new(
            &frames
                .iter()
                .map(|frame| frame.values[metric])
                .collect::<Vec<_>>(),
        )
    });
    let mut published_profile: Vec<Spread> = spreads.collect();
    Summary {
        usual_profile: published_profile.split_off(METRICS.len()),
        published_profile,
        seconds: Spread::new(&frames.iter().map(|frame| frame.seconds).collect::<Vec<_>>()),
        warned: frames.iter().filter(|frame| frame.is_warned).count(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_uiqm_is_the_sum_of_the_published_columns() {
        for method in &METHODS {
            let Some(Published {
                means: [_, uicm, uism, uiconm, uiqm],
                ..
            }) = method.published
            else {
                continue;
            };
            let sum = 0.037_128_12 * uicm + 0.333_45 * uism - 0.341_44 * uiconm;
            assert!((sum - uiqm).abs() < 0.01, "{}: {sum} {uiqm}", method.title);
        }
    }

    #[test]
    fn every_cell_is_finite_and_enhancing_changes_it() {
        let frames = [0u8, 90].map(|shift| {
            let frame = Rgb8::from_fn(64, 48, |x, y| {
                [(3 * x) as u8, (2 * y) as u8 + shift, (x + y) as u8]
            });
            measure_frame(&frame).unwrap()
        });
        let summaries = summarize(&frames);
        assert_eq!(summaries.len(), METHODS.len());
        for summary in &summaries {
            let spreads = summary.published_profile.iter().chain(&summary.usual_profile);
            assert_eq!(spreads.clone().count(), METRICS.len() + USUAL_METRICS.len());
            assert!(
                spreads
                    .clone()
                    .all(|spread| spread.mean.is_finite() && spread.deviation.is_finite())
            );
        }
        assert_ne!(summaries[5].published_profile, summaries[6].published_profile);
    }

    #[test]
    fn a_spread_is_that_of_a_sample() {
        assert_eq!(
            Spread::new(&[1.0, 3.0]),
            Spread {
                mean: 2.0,
                deviation: 2f64.sqrt()
            }
        );
        assert_eq!(
            Spread::new(&[7.0]),
            Spread {
                mean: 7.0,
                deviation: 0.0
            }
        );
    }
}
