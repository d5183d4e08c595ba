//! Random numbers by name. A frame is drawn from them alone, so that a search can turn some and leave the others.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

use imaging::random::Stream;

/// What the random numbers of a frame follow from.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Setting {
    pub(super) seed: u64,
    /// A description that contradicts itself is drawn again: how often.
    pub(super) attempt: u64,
    /// Numbers that replace drawn ones.
    pub(super) turned: BTreeMap<String, f64>,
}

/// The random numbers of one frame.
#[derive(Debug)]
pub(super) struct Knobs {
    setting: Setting,
    used: RefCell<BTreeSet<String>>,
}

impl Knobs {
    pub(super) fn new(setting: &Setting) -> Self {
        Self {
            setting: setting.clone(),
            used: RefCell::default(),
        }
    }

    /// Replaces numbers of these names, except those that are replaced already.
    pub(super) fn hold(&mut self, held: &[(&str, f64)]) {
        for &(name, value) in held {
            self.setting.turned.entry(name.to_owned()).or_insert(value);
        }
    }

    /// The names of all numbers that were drawn.
    pub(super) fn names(&self) -> Vec<String> {
        self.used.borrow().iter().cloned().collect()
    }

    /// The seed of the frame.
    pub(super) fn seed(&self) -> u64 {
        self.setting.seed
    }

    /// Numbers by pixel, apart from those with names.
    pub(super) fn noise(&self, purpose: &str) -> Stream {
        Stream::stage(self.setting.seed, purpose)
    }

    /// From 0 to 1.
    pub(super) fn unit(&self, name: &str) -> f64 {
        self.used.borrow_mut().insert(name.to_owned());
        let Setting {
            seed,
            attempt,
            turned,
        } = &self.setting;
        let drawn = || Stream::stage(*seed, name).unit(*attempt, 0);
        turned.get(name).copied().unwrap_or_else(drawn)
    }

    /// Evenly between two numbers.
    pub(super) fn within(&self, name: &str, least: f64, most: f64) -> f64 {
        least + (most - least) * self.unit(name)
    }

    /// With an evenly distributed logarithm.
    pub(super) fn log(&self, name: &str, least: f64, most: f64) -> f64 {
        least * (most / least).powf(self.unit(name))
    }

    /// A whole number from `least` to `most`.
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
