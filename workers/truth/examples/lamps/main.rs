//! The light of lamps in six waters, on walls and in the water: Monte Carlo against the chain, as docs/science/truth-lamps.md shows.
//!
//! ```sh
//! cargo run --release -p truth --example lamps -- 400000
//! ```
//!
//! The argument is the number of photons of each lamp in water with b of 0.5 per meter and more; clearer water needs up to ten times as
//! many. The second table has every cell.

mod cell;
mod model;
mod tables;

use std::sync::atomic::{AtomicUsize, Ordering};

use cell::{Cell, Lamp, TruePhase, WATERS, measure};

/// Water with a smaller scattering coefficient needs more photons, 1/m.
const THICK: f64 = 0.5;

fn main() {
    let photons: f64 = std::env::args()
        .nth(1)
        .map_or(400_000.0, |text| text.parse().expect("a number of photons"));
    let mut lamps = Vec::new();
    // Clear water first, because it is slowest.
    for water in 0..WATERS.len() {
        for is_spot in [false, true] {
            lamps.extend(TruePhase::ALL.map(|phase| Lamp {
                water,
                is_spot,
                phase,
            }));
        }
    }
    let cells = measure_all(&lamps, photons);
    println!("{}\n{}", tables::summarize(&cells), tables::list(&cells));
}

/// Measures the lamps on all cores. The cells are in the order of the lamps.
fn measure_all(lamps: &[Lamp], photons: f64) -> Vec<Cell> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let next = AtomicUsize::new(0);
    let mut measured: Vec<(usize, Vec<Cell>)> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads)
            .map(|_| scope.spawn(|| measure_next(lamps, photons, &next)))
            .collect();
        let workers = workers.into_iter();
        workers
            .flat_map(|worker| worker.join().expect("a lamp does not panic"))
            .collect()
    });
    measured.sort_by_key(|(number, _)| *number);
    measured.into_iter().flat_map(|(_, cells)| cells).collect()
}

/// Measures the remaining lamps one after the other.
fn measure_next(lamps: &[Lamp], photons: f64, next: &AtomicUsize) -> Vec<(usize, Vec<Cell>)> {
    let mut measured = Vec::new();
    loop {
        let number = next.fetch_add(1, Ordering::Relaxed);
        let Some(&lamp) = lamps.get(number) else {
            return measured;
        };
        let more = (THICK / WATERS[lamp.water].1.scattering).clamp(1.0, 10.0);
        measured.push((number, measure(lamp, 0..(photons * more) as u64)));
    }
}
