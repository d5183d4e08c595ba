//! Numbers of the classes of an export.

use std::collections::BTreeMap;

use cli::classes::Named;

/// The code of the background in every mask.
const NO_OBJECT: u8 = 0;
/// Numbers beyond every code, for classes whose code another class has.
const BEYOND: u64 = 256;

/// Classes in the order of their scenes, each with one number in all parts of an export.
#[derive(Debug, Default)]
pub(crate) struct ClassNumbers {
    /// Names with their numbers, in order.
    classes: Vec<(String, u64)>,
    places: BTreeMap<String, usize>,
}

impl ClassNumbers {
    /// Adds the classes of a scene. A class keeps its code, unless a class of another name has it.
    pub(crate) fn add(&mut self, scene: &Named) {
        for (code, name) in scene.iter().filter(|(code, _)| *code != NO_OBJECT) {
            if !self.places.contains_key(name) {
                self.insert(name, u64::from(*code));
            }
        }
    }

    /// The place of a class in the list, from 0; a name that no scene has is added.
    pub(crate) fn place(&mut self, name: &str) -> usize {
        match self.places.get(name) {
            Some(place) => *place,
            None => self.insert(name, BEYOND),
        }
    }

    /// The number of a class.
    pub(crate) fn number(&mut self, name: &str) -> u64 {
        let place = self.place(name);
        self.classes[place].1
    }

    /// All names with their numbers.
    pub(crate) fn all(&self) -> &[(String, u64)] {
        &self.classes
    }

    fn insert(&mut self, name: &str, wanted: u64) -> usize {
        let is_taken = |number: u64| self.classes.iter().any(|(_, taken)| *taken == number);
        let number = match is_taken(wanted) || wanted >= BEYOND {
            true => (BEYOND..).find(|number| !is_taken(*number)).unwrap_or(wanted),
            false => wanted,
        };
        self.classes.push((name.to_owned(), number));
        self.places.insert(name.to_owned(), self.classes.len() - 1);
        self.classes.len() - 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes_keep_their_codes_unless_another_class_has_them() {
        let scene = |classes: &[(u8, &str)]| -> Named {
            classes
                .iter()
                .map(|(code, name)| (*code, (*name).to_owned()))
                .collect()
        };
        let mut numbers = ClassNumbers::default();
        numbers.add(&scene(&[(0, "background"), (2, "pile"), (5, "plate")]));
        numbers.add(&scene(&[(1, "pile"), (2, "chain"), (3, "plate")]));
        let all: Vec<_> = numbers
            .all()
            .iter()
            .map(|(name, number)| (name.as_str(), *number))
            .collect();
        assert_eq!(all, [("pile", 2), ("plate", 5), ("chain", 256)]);
        assert_eq!((numbers.place("chain"), numbers.number("chain")), (2, 256));
        assert_eq!((numbers.number("buoy"), numbers.place("buoy")), (257, 3));
    }
}
