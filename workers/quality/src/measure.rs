//! Measures a picture by any number of metrics.

use std::collections::BTreeMap;

use imaging::{Plane, Rgb8, cancel};

use crate::error::QualityError;
use crate::mask::select_pixels;
use crate::needs::Needs;
use crate::registry::{MetricFormula, MetricId};
use crate::subject::Subject;
use crate::work::MetricInput;

/// Measures a picture that is not compared with other frames, see [`measure_subject`].
///
/// # Errors
/// [`QualityError`] if the picture has no pixels, if a metric needs more than `clean` or `clean` is `None`, or if `clean`
/// has another size.
pub fn measure(
    picture: &Rgb8,
    clean: Option<&Rgb8>,
    metrics: &[MetricId],
) -> Result<Vec<(MetricId, f64)>, QualityError> {
    let subject = Subject {
        clean,
        ..Subject::new(picture)
    };
    measure_subject(&subject, metrics)
}

/// Measures a picture and returns the values in the order of the request, without those that are not defined for it:
/// metrics of previous frames in the first frame of a path, and the illumination residual under even light.
///
/// With a mask, statistics of pixels are over the counted pixels, metrics of blocks over the blocks entirely inside
/// (derivatives at their borders read the neighbors), `entropy_2d` over counted pixels and `ssim` over windows with a
/// counted center, both with all neighbors. Without a counted pixel, block or window they are 0.
///
/// # Errors
/// [`QualityError`] if the picture has no pixels, if an input of a metric is missing, or if one has another size.
pub fn measure_subject(
    subject: &Subject,
    metrics: &[MetricId],
) -> Result<Vec<(MetricId, f64)>, QualityError> {
    let (width, height) = (subject.picture.width(), subject.picture.height());
    if width == 0 || height == 0 {
        return Err(QualityError::Empty { width, height });
    }
    check_size(subject, "mask", subject.mask.map(Plane::size))?;
    for metric in metrics {
        check_needs(subject, *metric)?;
    }
    let picture = subject.mask.map(|mask| select_pixels(subject.picture, mask));
    let clean = subject
        .mask
        .and_then(|mask| Some(select_pixels(subject.clean?, mask)));
    let counted = picture.as_ref().map(|picture| Subject {
        clean: clean.as_ref(),
        ..Subject::new(picture)
    });
    let mut measurement = Measurement {
        whole: MetricInput::new(subject),
        counted: counted.as_ref().map(MetricInput::new),
        known: BTreeMap::new(),
    };
    let measured = metrics
        .iter()
        .filter_map(|&metric| Some((metric, measurement.value(metric)?)));
    Ok(measured.collect())
}

fn check_needs(subject: &Subject, metric: MetricId) -> Result<(), QualityError> {
    let needs = metric.info().needs;
    let is_present = match needs {
        Needs::Nothing => true,
        Needs::PictureInAir => {
            let size = subject.clean.map(|clean| (clean.width(), clean.height()));
            check_size(subject, "clean one", size)?;
            size.is_some()
        }
        Needs::PreviousFrames(_) => subject.sequence.is_some(),
        Needs::Illumination => {
            let size = subject.illumination.map(|illumination| illumination.size());
            check_size(subject, "illumination", size)?;
            size.is_some()
        }
    };
    if is_present {
        return Ok(());
    }
    Err(QualityError::Missing {
        metric: metric.to_string(),
        needs,
    })
}

fn check_size(
    subject: &Subject,
    other: &'static str,
    size: Option<(usize, usize)>,
) -> Result<(), QualityError> {
    let (width, height) = (subject.picture.width(), subject.picture.height());
    match size {
        Some((other_width, other_height)) if (other_width, other_height) != (width, height) => {
            Err(QualityError::Size {
                width,
                height,
                other,
                other_width,
                other_height,
            })
        }
        _ => Ok(()),
    }
}

/// A picture, the counted pixels of a masked one, and the values computed so far.
struct Measurement<'a> {
    whole: MetricInput<'a>,
    counted: Option<MetricInput<'a>>,
    known: BTreeMap<MetricId, Option<f64>>,
}

impl Measurement<'_> {
    /// A metric's value if it is defined, computed once: sums need it, too.
    fn value(&mut self, metric: MetricId) -> Option<f64> {
        if let Some(value) = self.known.get(&metric) {
            return *value;
        }
        cancel::check();
        let computed = match metric.info().compute {
            MetricFormula::Pixels(compute) => match &self.counted {
                Some(counted) if counted.picture().data().is_empty() => Some(0.0),
                Some(counted) => Some(compute(counted)),
                None => Some(compute(&self.whole)),
            },
            MetricFormula::Direct(compute) => Some(compute(&self.whole)),
            MetricFormula::Defined(compute) => compute(&self.whole),
            MetricFormula::Sum(terms) => terms
                .iter()
                .map(|(name, weight)| Some(weight * self.value(metric.sibling(name))?))
                .sum(),
        };
        // Adding 0 turns -0 into +0.
        let computed = computed.map(|value| value + 0.0);
        self.known.insert(metric, computed);
        computed
    }
}
