//! The fixed vocabularies of labels. Append new entries at the end: numbers must not change.

/// Declares an enum with numbers and names, and the list of them in the order of their numbers.
macro_rules! vocabulary {
    ($(#[$about:meta])* $Name:ident, $(#[$all:meta])* $LIST:ident: $($(#[doc = $what:literal])+ $Entry:ident = $number:literal, $name:literal;)*) => {
        $(#[$about])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[repr(u8)]
        pub enum $Name {
            $($(#[doc = $what])+ $Entry = $number),*
        }

        $(#[$all])*
        pub const $LIST: &[($Name, &str)] = &[$(($Name::$Entry, $name)),*];

        impl $Name {
            /// The name that masks and tables use.
            #[must_use]
            pub fn name(self) -> &'static str {
                $LIST[self as usize].1
            }

            /// Short description.
            #[must_use]
            pub fn about(self) -> &'static str {
                match self { $(Self::$Entry => concat!($($what),+).trim_ascii()),* }
            }
        }
    };
}

vocabulary! {
    /// Kind of thing that a pixel of a procedural scene shows; its number is its value in the semantic mask.
    Category,
    /// All categories in the order of their numbers.
    CATEGORIES:
    /// Open water.
    Background = 0, "background";
    /// The seabed, or the mud on the floor of a shaft.
    Seabed = 1, "seabed";
    /// An upright pile, leg or post.
    Pile = 2, "pile";
    /// A slanted or level tube between piles.
    Brace = 3, "brace";
    /// A beam, girder or waling.
    Beam = 4, "beam";
    /// A plate or a wall of sheet piles.
    Plate = 5, "plate";
    /// A pipeline or service pipe.
    Pipe = 6, "pipe";
    /// A flange, valve, collar or clamp.
    Fitting = 7, "fitting";
    /// A sacrificial anode.
    Anode = 8, "anode";
    /// A block, saddle or bag that supports a pipe.
    Support = 9, "support";
    /// A ladder.
    Ladder = 10, "ladder";
    /// A bracket on a wall.
    Bracket = 11, "bracket";
    /// The lining of a shaft or tunnel.
    Lining = 12, "lining";
    /// A cable, hose or rope.
    Cable = 13, "cable";
    /// A natural stone.
    Stone = 14, "stone";
    /// Lost or broken things on the ground.
    Debris = 15, "debris";
    /// A free-swimming animal: fish, jellyfish.
    Fauna = 16, "fauna";
    /// Growth on a structure or stone: mussels, tube worms, weed.
    Growth = 17, "growth";
    /// A bubble of gas.
    Bubble = 18, "bubble";
    /// A buoy, float or sphere in the water.
    Buoy = 19, "buoy";
    /// A crate or frame that hangs in the water.
    Crate = 20, "crate";
}

vocabulary! {
    /// Inspection finding. A pixel can show several; bit `1 << number` of the findings mask marks each.
    Finding,
    /// All findings in the order of their bits.
    FINDINGS:
    /// A crack in concrete or masonry.
    Crack = 0, "crack";
    /// Rust.
    Corrosion = 1, "corrosion";
    /// Concrete that has broken off.
    Spalling = 2, "spalling";
    /// A joint between segments, blocks or boards, a field joint or a weld seam.
    Joint = 3, "joint";
    /// Dense biofouling.
    Growth = 4, "growth";
    /// Bare metal where a pipe has lost its coating.
    CoatingDamage = 5, "coating_damage";
}

impl Category {
    /// Whether it belongs to a structure, as opposed to nature or debris.
    pub(crate) fn is_structure(self) -> bool {
        !self.is_life() && !matches!(self, Self::Background | Self::Seabed | Self::Stone | Self::Debris)
    }

    /// Whether it is an animal, growth or a bubble: these neither block a camera nor cast contact shadows.
    #[must_use]
    pub fn is_life(self) -> bool {
        matches!(self, Self::Fauna | Self::Growth | Self::Bubble)
    }
}

impl Finding {
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
