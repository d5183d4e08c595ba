//! Named random numbers. A frame is drawn from them alone, so a search can change some and keep the others.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

use imaging::random::Stream;

/// The number that selects the first choice and makes every chance true.
pub(super) const FIRST: f64 = 0.0;
/// The number that selects the last choice and makes every chance false.
pub(super) const LAST: f64 = 1.0;

/// Source of the random numbers of a frame. Two families share no numbers.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Source {
    /// Name of the family.
    pub(super) family: &'static str,
    pub(super) seed: u64,
    /// Earlier draws of this seed with contradictory descriptions.
    pub(super) attempt: u64,
    /// Numbers set by a search.
    pub(super) turned: BTreeMap<String, f64>,
}

impl Source {
    pub(super) fn new(family: &'static str, seed: u64) -> Self {
        let (attempt, turned) = (0, BTreeMap::new());
        Self {
            family,
            seed,
            attempt,
            turned,
        }
    }
}

/// The random numbers of one frame.
#[derive(Debug)]
pub(super) struct Knobs {
    source: Source,
    used: RefCell<BTreeSet<String>>,
}

impl Knobs {
    pub(super) fn new(source: &Source) -> Self {
        Self {
            source: source.clone(),
            used: RefCell::default(),
        }
    }

    /// Sets numbers, unless a search has set them.
    pub(super) fn hold(&mut self, held: &[(&str, f64)]) {
        for &(name, value) in held {
            self.source.turned.entry(name.to_owned()).or_insert(value);
        }
    }

    /// Sets the number that selects one of `names`, restricted to `choices`.
    pub(super) fn hold_one(&mut self, held: &str, names: &[&str], choices: &[&str]) {
        let chosen = self.pick(&format!("{held}.choice"), choices);
        let place = names.iter().position(|name| name == chosen).unwrap_or(0);
        self.hold(&[(held, (place as f64 + 0.5) / names.len() as f64)]);
    }

    /// Names of the numbers drawn until now.
    pub(super) fn names(&self) -> Vec<String> {
        self.used.borrow().iter().cloned().collect()
    }

    /// The seed of the frame.
    pub(super) fn seed(&self) -> u64 {
        self.source.seed
    }

    /// The stream of random numbers for a purpose.
    pub(super) fn stream(&self, purpose: &str) -> Stream {
        Stream::stage(self.source.seed, &format!("{}.{purpose}", self.source.family))
    }

    /// From 0 to 1.
    pub(super) fn unit(&self, name: &str) -> f64 {
        self.used.borrow_mut().insert(name.to_owned());
        match self.source.turned.get(name) {
            Some(&turned) => turned,
            None => self.stream(name).unit(self.source.attempt, 0),
        }
    }

    /// Uniform between two numbers.
    pub(super) fn within(&self, name: &str, least: f64, most: f64) -> f64 {
        least + (most - least) * self.unit(name)
    }

    /// Log-uniform between two numbers.
    pub(super) fn log(&self, name: &str, least: f64, most: f64) -> f64 {
        least * (most / least).powf(self.unit(name))
    }

    /// A uniform integer from `least` to `most`.
    pub(super) fn whole(&self, name: &str, least: usize, most: usize) -> usize {
        least + (((most - least + 1) as f64 * self.unit(name)) as usize).min(most - least)
    }

    /// True in this share of all frames.
    pub(super) fn chance(&self, name: &str, share: f64) -> bool {
        self.unit(name) < share
    }

    /// One of several.
    pub(super) fn pick<'a, T>(&self, name: &str, choices: &'a [T]) -> &'a T {
        &choices[self.whole(name, 0, choices.len() - 1)]
    }

    /// [`Knobs::log`] of three channels.
    pub(super) fn log_rgb(&self, name: &str, least: f64, most: f64) -> [f64; 3] {
        ["r", "g", "b"].map(|channel| self.log(&format!("{name}.{channel}"), least, most))
    }

    /// [`Knobs::within`] of three channels or axes.
    pub(super) fn within_rgb(&self, name: &str, least: f64, most: f64) -> [f64; 3] {
        ["r", "g", "b"].map(|channel| self.within(&format!("{name}.{channel}"), least, most))
    }
}
