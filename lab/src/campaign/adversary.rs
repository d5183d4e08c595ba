//! Frames that are made against the bound of forward scatter, with widths, tolerance and target drawn from a seed.

#[path = "../../../workers/optics/tests/adversary/frames.rs"]
mod frames;

use imaging::random::Stream;
use spec::ScatterModel;

use super::cases::Case;
use frames::{Attack, Frame};

/// Most and least side of a frame, pixels.
const SIDES: (f64, f64) = (24.0, 80.0);

/// The adversarial frame of a seed; none where the plan of such a frame interpolates nothing.
pub(super) fn adversary(seed: u64) -> Option<Case> {
    let stream = Stream::stage(seed, "adversary");
    let unit = |what: u64| stream.unit(0, what);
    let side = |what: u64| (SIDES.0 + (SIDES.1 - SIDES.0) * unit(what)) as usize;
    let size = (side(0), side(1));
    let within = |what: u64, side: usize| (unit(what) * side as f64) as usize;
    let narrowest = 0.01 * 300f64.powf(unit(2));
    let attack = Attack {
        model: if unit(3) < 0.7 {
            ScatterModel::Jaffe
        } else {
            ScatterModel::Simplified
        },
        size,
        target: (within(4, size.0), within(5, size.1)),
        widths_px: (narrowest, narrowest * 3.0 * 3000f64.powf(unit(6))),
        tolerance: 10f64.powf(-1.5 - 3.0 * unit(7)),
        brighter: unit(8) < 0.5,
    };
    let Frame {
        radiance,
        range,
        water,
    } = attack.frame()?;
    let form = if attack.model == ScatterModel::Jaffe {
        "jaffe"
    } else {
        "simplified"
    };
    Some(Case {
        seed,
        about: format!("{form}, adversary, {}x{}", size.0, size.1),
        radiance,
        range,
        water,
        tolerance: attack.tolerance,
    })
}
