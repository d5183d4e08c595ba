//! One picture being measured: what metrics share is made once, when the first of them asks.

use std::cell::{Cell, OnceCell};

use imaging::vectorized;
use imaging::{Plane, Rgb8, luma1000};

use crate::colors::Colors;
use crate::error::QualityError;
use crate::registry::{MetricId, registry};
use crate::{uciqe, uicm, uism};

/// A picture, the clean one where given, and what has been made from them so far.
pub(crate) struct Work<'a> {
    picture: &'a Rgb8,
    clean: Option<&'a Rgb8>,
    gray: OnceCell<Plane<u8>>,
    colors: OnceCell<Colors>,
    opponents: OnceCell<uicm::Opponents>,
    channels: OnceCell<[Plane<u8>; 3]>,
    sharpness: OnceCell<[f64; 3]>,
    colorfulness: OnceCell<uciqe::Terms>,
    values: Vec<Cell<Option<f64>>>,
}

impl<'a> Work<'a> {
    fn new(picture: &'a Rgb8, clean: Option<&'a Rgb8>) -> Self {
        Self {
            picture,
            clean,
            gray: OnceCell::new(),
            colors: OnceCell::new(),
            opponents: OnceCell::new(),
            channels: OnceCell::new(),
            sharpness: OnceCell::new(),
            colorfulness: OnceCell::new(),
            values: vec![Cell::new(None); registry().len()],
        }
    }

    pub(crate) fn picture(&self) -> &'a Rgb8 {
        self.picture
    }

    /// The clean picture, of the same size. Only metrics whose row says that they need it may ask.
    pub(crate) fn clean(&self) -> &'a Rgb8 {
        self.clean
            .expect("metrics that compare run only with a clean picture")
    }

    /// Interleaved codes of row `y`.
    pub(crate) fn picture_row(&self, y: usize) -> &'a [u8] {
        let stride = 3 * self.picture.width();
        &self.picture.data()[y * stride..][..stride]
    }

    pub(crate) fn gray(&self) -> &Plane<u8> {
        self.gray.get_or_init(|| gray(self.picture))
    }

    pub(crate) fn colors(&self) -> &Colors {
        self.colors.get_or_init(|| Colors::of(self.picture))
    }

    pub(crate) fn opponents(&self) -> &uicm::Opponents {
        self.opponents.get_or_init(|| uicm::Opponents::of(self.picture))
    }

    /// Red, green and blue apart.
    pub(crate) fn channels(&self) -> &[Plane<u8>; 3] {
        self.channels.get_or_init(|| {
            let mut channels =
                [0; 3].map(|_| Plane::filled(self.picture.width(), self.picture.height(), 0u8));
            let [r, g, b] = channels.each_mut().map(Plane::data_mut);
            vectorized!(split(self.picture.data(), r, g, b));
            channels
        })
    }

    /// EME of the three channels.
    pub(crate) fn sharpness(&self) -> &[f64; 3] {
        self.sharpness.get_or_init(|| uism::sharpness(self.channels()))
    }

    pub(crate) fn colorfulness(&self) -> &uciqe::Terms {
        self.colorfulness.get_or_init(|| uciqe::Terms::of(self.colors()))
    }

    /// A metric's value, computed once; other metrics may be made of it.
    pub(crate) fn value(&self, metric: MetricId) -> f64 {
        let cell = &self.values[metric.row()];
        cell.get().unwrap_or_else(|| {
            // Adding 0 turns -0 into +0 and leaves everything else.
            let value = (metric.info().compute)(self) + 0.0;
            cell.set(Some(value));
            value
        })
    }
}

/// `(299 R + 587 G + 114 B + 500) div 1000` of every pixel.
fn gray(picture: &Rgb8) -> Plane<u8> {
    let mut gray = Plane::filled(picture.width(), picture.height(), 0u8);
    vectorized!({
        for (gray, p) in gray.data_mut().iter_mut().zip(picture.data().chunks_exact(3)) {
            *gray = ((luma1000([p[0], p[1], p[2]]) + 500) / 1000) as u8;
        }
    });
    gray
}

#[inline(always)]
fn split(codes: &[u8], r: &mut [u8], g: &mut [u8], b: &mut [u8]) {
    for (((r, g), b), p) in r.iter_mut().zip(g).zip(b).zip(codes.chunks_exact(3)) {
        (*r, *g, *b) = (p[0], p[1], p[2]);
    }
}

/// Measures a picture, and returns the values in the order of the request. Pixels are 8-bit sRGB codes.
///
/// # Errors
/// [`QualityError`] when the picture has no pixel, when a metric compares and `clean` is `None`, or when `clean` has
/// another size.
pub fn measure(
    picture: &Rgb8,
    clean: Option<&Rgb8>,
    metrics: &[MetricId],
) -> Result<Vec<(MetricId, f64)>, QualityError> {
    let (width, height) = (picture.width(), picture.height());
    if width == 0 || height == 0 {
        return Err(QualityError::Empty { width, height });
    }
    if let Some(metric) = metrics.iter().find(|metric| metric.info().needs_reference) {
        let Some(clean) = clean else {
            return Err(QualityError::NoReference {
                metric: metric.to_string(),
            });
        };
        let (clean_width, clean_height) = (clean.width(), clean.height());
        if (clean_width, clean_height) != (width, height) {
            return Err(QualityError::Size {
                width,
                height,
                clean_width,
                clean_height,
            });
        }
    }
    let work = Work::new(picture, clean);
    Ok(metrics
        .iter()
        .map(|&metric| (metric, work.value(metric)))
        .collect())
}
