//! Paging parameters of simple lists.

use serde::Deserialize;
use utoipa::IntoParams;

/// Page selection.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(crate) struct Paging {
    /// Rows of the page, 1..=1000.
    #[param(default = 100, minimum = 1, maximum = 1000)]
    pub(crate) limit: Option<u32>,
    /// `next_cursor` of the previous page.
    pub(crate) cursor: Option<String>,
}
