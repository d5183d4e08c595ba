//! Linear light of sRGB codes.

use std::sync::LazyLock;

use imaging::transfer;

/// Linear light of each sRGB code.
pub(crate) static LINEAR: LazyLock<[f64; 256]> =
    LazyLock::new(|| std::array::from_fn(|code| transfer::decode(code as f64 / 255.0)));
