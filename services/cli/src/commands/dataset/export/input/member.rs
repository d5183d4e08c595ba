//! The frames of a shard.

use cli::exit::Failure;
use serde_json::{Map, Value};

use crate::commands::dataset::export::input::archive::Unpacked;
use crate::commands::dataset::export::input::frame::Place;

/// A frame of a shard.
pub(crate) struct Member {
    pub(crate) place: Place,
    /// The columns of its row.
    pub(crate) values: Map<String, Value>,
    /// One file for each kind, in their order.
    pub(crate) files: Vec<Unpacked>,
}

/// The frames of a shard in their order, some at a time, until there are none.
pub(crate) type Pull<'a> = dyn FnMut() -> Result<Vec<Member>, Failure> + 'a;
