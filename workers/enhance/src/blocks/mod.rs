//! Building blocks shared by methods. Each fast block has a reference selected by [`Variant`](crate::Variant); the
//! `agreement` tests compare the two.

mod binomial;
mod blur;
mod extremum;
mod fill;
mod guided;
pub(crate) mod histogram;
pub(crate) mod lab;
mod light;
mod matting;
mod mean;
mod norm;
mod quadtree;
mod rank;
mod restore;
mod sums;
mod tails;

pub use binomial::{binomial, binomial_exact};
pub(crate) use binomial::{blend_rows, blurred_row, weighted};
pub use blur::gaussian;
pub use extremum::{window_max, window_min};
pub use fill::filled;
pub use guided::{Guide, RADIUS_MAX, RADIUS_PX, REGULARIZATION, guided};
pub(crate) use light::extremes;
pub use light::{TOP_SHARE, brightest_of, distance_offset};
pub use matting::Matting;
pub use mean::window_mean;
pub(crate) use norm::distance_of;
pub use norm::{FLAT, normalized, range};
pub use quadtree::{QuadRegion, calmest, lowest};
pub use rank::largest;
pub use restore::{Veil, dehaze, restore};
pub use tails::tails;
