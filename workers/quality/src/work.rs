//! A picture being measured: results shared by metrics are computed once, on first use.

use std::any::{Any, TypeId};
use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;

use imaging::{Plane, Rgb8};

use crate::subject::Subject;

/// A picture, its other inputs, and the parts computed so far.
pub(crate) struct MetricInput<'a> {
    subject: Subject<'a>,
    parts: RefCell<HashMap<TypeId, Rc<dyn Any>>>,
}

/// A result shared by several metrics.
pub(crate) trait SharedPart: 'static {
    fn new(work: &MetricInput) -> Self;
}

impl<'a> MetricInput<'a> {
    pub(crate) fn new(subject: &Subject<'a>) -> Self {
        Self {
            subject: *subject,
            parts: RefCell::default(),
        }
    }

    pub(crate) fn subject(&self) -> &Subject<'a> {
        &self.subject
    }

    pub(crate) fn picture(&self) -> &'a Rgb8 {
        self.subject.picture
    }

    pub(crate) fn mask(&self) -> Option<&'a Plane<u8>> {
        self.subject.mask
    }

    /// The clean picture, of the same size. Only for metrics that declare `against_clean`.
    pub(crate) fn clean(&self) -> &'a Rgb8 {
        self.subject
            .clean
            .expect("metrics that compare run only with a clean picture")
    }

    /// Interleaved codes of row `y`.
    pub(crate) fn picture_row(&self, y: usize) -> &'a [u8] {
        let stride = 3 * self.picture().width();
        &self.picture().data()[y * stride..][..stride]
    }

    /// Returns a part, computing it on the first call.
    pub(crate) fn part<P: SharedPart>(&self) -> Rc<P> {
        let kind = TypeId::of::<P>();
        let known = self.parts.borrow().get(&kind).cloned();
        let part = known.unwrap_or_else(|| {
            let part: Rc<dyn Any> = Rc::new(P::new(self));
            self.parts.borrow_mut().insert(kind, Rc::clone(&part));
            part
        });
        part.downcast().expect("a part is stored by its type")
    }
}

/// Gray codes.
pub(crate) struct Gray(pub(crate) Plane<u8>);

impl SharedPart for Gray {
    fn new(work: &MetricInput) -> Self {
        Self(work.picture().to_gray8())
    }
}

/// Planes of red, green and blue.
pub(crate) struct ChannelPlanes(pub(crate) [Plane<u8>; 3]);

impl SharedPart for ChannelPlanes {
    fn new(work: &MetricInput) -> Self {
        Self(work.picture().to_planes())
    }
}
