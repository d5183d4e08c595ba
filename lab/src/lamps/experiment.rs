//! Lamps in all waters as an experiment.

use cli::exit::Failure;

use super::cell::{Cell, Lamp, TruePhase, WATERS, measure};
use super::tables::tables;
use crate::parallel::run_all;
use crate::report::Report;
use crate::setup::{Parameter, Setup};

/// The parameters of the experiment.
pub const PARAMETERS: &[Parameter] = &[Parameter::number(
    "photons",
    "400000",
    [1600.0, 1e9],
    "photons of each lamp in water with b of 0.5 per meter and more; clearer water needs up to ten times as many",
)];
/// Water with a smaller scattering coefficient needs more photons, 1/m.
const THICK: f64 = 0.5;

/// Compares points and spots in six waters and two phase functions with Monte Carlo.
///
/// # Errors
/// None.
pub fn run(setup: &Setup) -> Result<Report, Failure> {
    let photons = setup.number("photons");
    // Clear water first, because it is slowest.
    let waters = 0..WATERS.len();
    let lamps: Vec<Lamp> = waters
        .flat_map(|water| [false, true].map(|is_spot| (water, is_spot)))
        .flat_map(|(water, is_spot)| {
            TruePhase::ALL.map(|phase| Lamp {
                water,
                is_spot,
                phase,
            })
        })
        .collect();
    let found = run_all(
        "lamps",
        None,
        &lamps,
        || (),
        |&lamp, ()| {
            let more = (THICK / WATERS[lamp.water].1.scattering).clamp(1.0, 10.0);
            measure(lamp, 0..(photons * more) as u64)
        },
    );
    let cells: Vec<Cell> = found.concat();
    let about = format!(
        "{photons} photons. Each entry is the truth over the chain with single scattering, and in brackets the chain with multiple \
         scattering over the truth, least and greatest of several positions; in Fournier-Forand water also the chain with that phase \
         function."
    );
    Ok(Report::new(about, tables(&cells)))
}
