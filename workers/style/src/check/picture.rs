//! Checks of enhancers and metrics.

use imaging::Rgb8;

use super::levels::Levels;
use super::unfit::{SIZES, Unfit};
use crate::library::StyleModel;
use crate::picture::PictureNetwork;
use crate::role::{ModelRole, SizeRule};
use crate::runtime::Runtime;

/// Side of the fields of the checkerboard.
const FIELD_PX: usize = 4;

/// Runs a network on test pictures of every kind and size.
pub(super) fn check(model: &StyleModel, runtime: &Runtime) -> Result<(), Unfit> {
    let mut network = runtime.picture_network(model)?;
    // A new session, as in another worker.
    let mut again = runtime.picture_network(model)?;
    let sizes = match model.card.picture_input().size {
        SizeRule::Fixed { width, height } => vec![(width, height)],
        SizeRule::Any | SizeRule::MultipleOf(_) => SIZES.to_vec(),
    };
    let mut defects = Vec::new();
    for size in sizes {
        match model.card.role {
            ModelRole::Metric => check_metric(&mut network, &mut again, size, &mut defects),
            ModelRole::Enhancer | ModelRole::Style => {
                check_enhancer(&mut network, &mut again, size, &mut defects);
            }
        }
    }
    match defects.len() {
        0 => Ok(()),
        1 => Err(defects.remove(0)),
        _ => Err(Unfit::Several(defects)),
    }
}

fn check_enhancer(
    network: &mut PictureNetwork,
    again: &mut PictureNetwork,
    (width, height): (usize, usize),
    defects: &mut Vec<Unfit>,
) {
    for (position, picture) in draw_pictures(width, height).iter().enumerate() {
        let values = match network.enhance_unclamped(picture) {
            Ok(values) => values,
            Err(error) => {
                // The same failure on every picture of a size is one defect.
                defects.push(error.into());
                return;
            }
        };
        // The ramp is the first picture.
        if position == 0 {
            defects.extend(find_level_defect(&values, (width, height)));
            if again.enhance_unclamped(picture).ok() != Some(values) {
                defects.push(Unfit::Drawn { width, height });
            }
        }
    }
}

/// A result of one value for a picture of all levels, or one mostly outside of 0 to 1. One pixel has one level.
fn find_level_defect(values: &[f32], (width, height): (usize, usize)) -> Option<Unfit> {
    let levels = Levels::measure(values.iter().copied());
    if width * height > 1 && levels.is_flat() {
        let value = levels.most;
        return Some(Unfit::Flat { value, width, height });
    }
    levels.is_mostly_outside.then_some(Unfit::Scale {
        least: levels.least,
        most: levels.most,
        width,
        height,
    })
}

fn check_metric(
    network: &mut PictureNetwork,
    again: &mut PictureNetwork,
    (width, height): (usize, usize),
    defects: &mut Vec<Unfit>,
) {
    let pictures = draw_pictures(width, height);
    let mut values = Vec::with_capacity(pictures.len());
    for picture in &pictures {
        match network.measure(picture) {
            Ok(value) => values.push(value),
            Err(error) => {
                defects.push(error.into());
                return;
            }
        }
    }
    let value = values[0];
    if again.measure(&pictures[0]).ok() != Some(value) {
        defects.push(Unfit::Drawn { width, height });
    } else if width * height > 1 && values.iter().all(|other| *other == value) {
        let known = defects
            .iter()
            .any(|defect| matches!(defect, Unfit::Indifferent { .. }));
        if !known {
            defects.push(Unfit::Indifferent { value });
        }
    }
}

/// A ramp of all levels, a checkerboard, black and white.
fn draw_pictures(width: usize, height: usize) -> [Rgb8; 4] {
    [
        Rgb8::from_fn(width, height, |x, y| {
            [level(x, width), level(y, height), level(x + y, width + height)]
        }),
        Rgb8::from_fn(width, height, |x, y| {
            let is_bright = (x / FIELD_PX + y / FIELD_PX).is_multiple_of(2);
            if is_bright { [230, 200, 180] } else { [20, 40, 60] }
        }),
        Rgb8::from_fn(width, height, |_, _| [0; 3]),
        Rgb8::from_fn(width, height, |_, _| [255; 3]),
    ]
}

fn level(position: usize, side: usize) -> u8 {
    (255 * position / side.max(2)) as u8
}
