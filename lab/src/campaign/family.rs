//! Families of frames.

use cli::exit::Failure;

use super::case::Case;
use super::knobs::Knobs;
use super::{directed, random};

/// A kind of frames: its name on the command line, and how one is drawn.
pub(super) type Family = (&'static str, fn(&mut Knobs) -> Case);

/// All families: random frames in water, pictures, procedural scenes and sequences, then frames directed against single bounds.
const FAMILIES: [Family; 10] = [
    ("water", random::draw_water_alone),
    ("pictures", random::draw_uploaded),
    ("procedural", random::draw_procedural),
    ("sequences", random::draw_sequence),
    ("scatter", directed::draw_scattered),
    ("metering", directed::draw_metered),
    ("points", directed::draw_points),
    ("defocus", directed::draw_defocused),
    ("lamps", directed::draw_lit),
    ("lens", directed::draw_lens),
];
/// Random families in the order of a campaign; frequent ones are listed several times.
const RANDOM: [usize; 8] = [1, 2, 0, 1, 3, 1, 2, 1];
const DIRECTED: [usize; 6] = [4, 5, 6, 7, 8, 9];

/// The random or the directed families in the order of a campaign; with a name, only that family.
///
/// # Errors
/// Unknown family.
pub(super) fn list_families(is_directed: bool, only: Option<&str>) -> Result<Vec<Family>, Failure> {
    if let Some(unknown) = only.filter(|only| FAMILIES.iter().all(|(name, _)| name != only)) {
        let known = FAMILIES.map(|(name, _)| name).join(", ");
        return Err(Failure::BadInput(format!(
            "`family` is {unknown}; must be one of {known}"
        )));
    }
    let order = if is_directed { &DIRECTED[..] } else { &RANDOM };
    let mut families: Vec<Family> = order.iter().map(|&index| FAMILIES[index]).collect();
    if let Some(only) = only {
        families.retain(|(name, _)| *name == only);
        families.truncate(1);
    }
    Ok(families)
}
