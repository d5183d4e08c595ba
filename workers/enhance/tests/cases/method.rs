//! Methods by the names of the vectors.

use enhance::Method;
use spec::IblaRefinement;

/// The method whose results have this name in the vectors.
pub(crate) fn method(name: &str) -> Method {
    match name {
        "ibla_guided" => Method::ibla(IblaRefinement::Guided),
        name => Method::parse(name).expect("a method"),
    }
}
