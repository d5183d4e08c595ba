//! Building blocks shared by methods. Each fast block has a reference selected by [`Variant`](crate::Variant); the
//! `agreement` tests compare the two.

mod blur;
mod extremum;
mod fill;
mod guided;
pub(crate) mod histogram;
mod light;
mod matting;
mod norm;
mod quadtree;
mod rank;
mod restore;
mod sums;
mod tails;

pub use blur::gaussian;
pub use extremum::{window_max, window_min};
pub use fill::filled;
pub use guided::{Guide, RADIUS_MAX, RADIUS_PX, REGULARIZATION, guided};
pub(crate) use light::extremes;
pub use light::{TOP_SHARE, brightest_of, distance_offset};
pub use matting::Matting;
pub(crate) use norm::distance_of;
pub use norm::{FLAT, normalized, range};
pub use quadtree::{QuadRegion, calmest, lowest};
pub use rank::largest;
pub use restore::{Veil, restore};
pub use tails::tails;
