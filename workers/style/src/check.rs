//! Checks that an external model is usable, on frames that break networks.
//!
//! Time and memory are unlimited: run it in a separate process.

mod external;
mod levels;
mod picture;
mod size;
mod unfit;

use imaging::{Plane, Rgb};

use crate::library::StyleModel;
use crate::role::ModelRole;
use crate::runtime::{Runtime, RuntimeMissing};
use crate::session::{ModelInputs, Session};
use levels::Levels;
pub use unfit::Unfit;
use unfit::{SIZES, SMALL, USUAL};

/// Runs a model on frames of 1×1, of odd sides and of the usual size, on black, on white, and twice on the same. An enhancer or a
/// metric of one size runs on pictures of that size. `runtime` is called only if the model needs it.
///
/// # Errors
/// [`Unfit`]: the first defect of a style; every defect of an enhancer or a metric.
pub fn check(model: &StyleModel, runtime: impl Fn() -> Result<Runtime, RuntimeMissing>) -> Result<(), Unfit> {
    external::find_external(&model.onnx)?;
    size::check_size(&model.onnx)?;
    if model.card.role != ModelRole::Style {
        return picture::check(model, &runtime()?);
    }
    let mut first = open_session(model, &runtime)?;
    for size in SIZES {
        let styled = answer(&mut first, &ramp(size))?;
        if size == USUAL {
            check_levels(&styled)?;
        }
    }
    for level in [0.0, 1.0] {
        answer(&mut first, &Rgb::from_fn(SMALL.0, SMALL.1, |_, _| [level; 3]))?;
    }
    // A new session, as in another worker.
    let again = answer(&mut open_session(model, &runtime)?, &ramp(SMALL))?;
    if again == answer(&mut first, &ramp(SMALL))? {
        Ok(())
    } else {
        Err(Unfit::Random)
    }
}

/// Fails if a frame of all levels becomes one value, or if most of its samples are outside of 0 to 1.
fn check_levels(styled: &Rgb<f32>) -> Result<(), Unfit> {
    let planes = styled.planes().iter();
    let levels = Levels::measure(planes.flat_map(|plane| plane.data().iter().copied()));
    let (least, most) = (levels.least, levels.most);
    if levels.is_flat() {
        return Err(Unfit::Constant { value: most });
    }
    if levels.is_mostly_outside {
        return Err(Unfit::Saturated { least, most });
    }
    Ok(())
}

fn open_session(
    model: &StyleModel,
    runtime: &impl Fn() -> Result<Runtime, RuntimeMissing>,
) -> Result<Session, Unfit> {
    match Session::native(model) {
        Some(session) => Ok(session),
        None => Ok(runtime()?.session(model)?),
    }
}

/// A frame of all levels, red from left to right, green from top to bottom.
fn ramp((width, height): (usize, usize)) -> Rgb<f32> {
    Rgb::from_fn(width, height, |x, y| {
        [(x, width), (y, height), (x + y, width + height)]
            .map(|(position, side)| position as f32 / side.max(2) as f32)
    })
}

fn answer(session: &mut Session, frame: &Rgb<f32>) -> Result<Rgb<f32>, Unfit> {
    let (width, height) = frame.size();
    // Standard normal noise has few values beyond ±2; deterministic.
    let noise = Plane::from_fn(width, height, |x, y| ((x * 7 + y * 13) % 41) as f32 / 10.0 - 2.0);
    let range = Plane::from_fn(width, height, |x, y| (x + y) as f32 / (width + height) as f32);
    let beside = ModelInputs {
        noise: Some(&noise),
        range: Some(&range),
    };
    let styled = session.apply_unclamped(frame, beside)?;
    let mut samples = styled.planes().iter().flat_map(|plane| plane.data());
    match samples.find(|sample| !sample.is_finite()) {
        Some(&value) => Err(Unfit::NotFinite { value, width, height }),
        None => Ok(styled),
    }
}
