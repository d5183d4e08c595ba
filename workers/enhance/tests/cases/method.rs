//! Methods by the names of the vectors.

use enhance::Method;
use spec::{Ibla, IblaRefinement, Step};

/// The method whose results have this name in the vectors.
pub(crate) fn method(name: &str) -> Method {
    match name {
        "ibla_guided" => Method(Step::Ibla(Ibla {
            refine: IblaRefinement::Guided,
            ..Ibla::default()
        })),
        name => Method::parse(name).expect("a method"),
    }
}
