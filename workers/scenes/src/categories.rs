//! What labels can say: the fixed lists of categories and findings. New entries go to the end, so that numbers keep their meaning.

/// Kind of thing that a pixel of a procedural scene shows; its number is its value in the semantic mask.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(u8)]
pub enum Category {
    /// Nothing is met: open water.
    Background = 0,
    /// The seabed, or the mud on the floor of a shaft.
    Seabed = 1,
    /// An upright pile, leg or post.
    Pile = 2,
    /// A slanted or level tube between piles.
    Brace = 3,
    /// A beam, girder or waling.
    Beam = 4,
    /// A plate or a wall of sheet piles.
    Plate = 5,
    /// A pipe that carries something.
    Pipe = 6,
    /// A flange, valve, collar or clamp.
    Fitting = 7,
    /// A sacrificial anode.
    Anode = 8,
    /// What a pipe lies on: blocks, saddles, bags.
    Support = 9,
    /// A ladder.
    Ladder = 10,
    /// A bracket on a wall.
    Bracket = 11,
    /// The lining of a shaft or tunnel.
    Lining = 12,
    /// A cable or hose.
    Cable = 13,
    /// A natural stone.
    Stone = 14,
    /// Lost or broken things on the ground.
    Debris = 15,
}

/// All categories with the names that masks and tables use, in the order of their numbers.
pub const CATEGORIES: &[(Category, &str)] = &[
    (Category::Background, "background"),
    (Category::Seabed, "seabed"),
    (Category::Pile, "pile"),
    (Category::Brace, "brace"),
    (Category::Beam, "beam"),
    (Category::Plate, "plate"),
    (Category::Pipe, "pipe"),
    (Category::Fitting, "fitting"),
    (Category::Anode, "anode"),
    (Category::Support, "support"),
    (Category::Ladder, "ladder"),
    (Category::Bracket, "bracket"),
    (Category::Lining, "lining"),
    (Category::Cable, "cable"),
    (Category::Stone, "stone"),
    (Category::Debris, "debris"),
];

impl Category {
    /// The name in [`CATEGORIES`].
    #[must_use]
    pub fn name(self) -> &'static str {
        CATEGORIES[self as usize].1
    }
}

/// What an inspection looks for. A pixel can show several; bit `1 << number` of the findings mask says whether it shows one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(u8)]
pub enum Finding {
    /// A crack in concrete or masonry.
    Crack = 0,
    /// Rust.
    Corrosion = 1,
    /// Concrete that has broken off.
    Spalling = 2,
    /// A joint between segments, blocks or boards, a field joint or a weld seam.
    Joint = 3,
    /// Dense biofouling.
    Growth = 4,
    /// Coating that is gone from a pipe.
    CoatingDamage = 5,
}

/// All findings with the names that masks and tables use, in the order of their bits.
pub const FINDINGS: &[(Finding, &str)] = &[
    (Finding::Crack, "crack"),
    (Finding::Corrosion, "corrosion"),
    (Finding::Spalling, "spalling"),
    (Finding::Joint, "joint"),
    (Finding::Growth, "growth"),
    (Finding::CoatingDamage, "coating_damage"),
];

impl Finding {
    /// The name in [`FINDINGS`].
    #[must_use]
    pub fn name(self) -> &'static str {
        FINDINGS[self as usize].1
    }

    /// The bit of this finding in the findings mask.
    #[must_use]
    pub fn bit(self) -> u8 {
        1 << self as u8
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_place_in_a_list_is_the_number() {
        assert!(CATEGORIES.iter().enumerate().all(|(i, (c, _))| *c as usize == i));
        assert!(FINDINGS.iter().enumerate().all(|(i, (f, _))| *f as usize == i));
        assert_eq!(
            (Category::Debris.name(), Finding::Growth.name()),
            ("debris", "growth")
        );
    }
}
