//! How the accepted fields are described. `#[derive(Described)]` writes these values from a declaration.

mod names;
mod rule;

pub use names::Names;
pub use rule::Rule;
pub(crate) use rule::{TRACED, describe};

/// Most labels: each becomes a queryable column.
pub const MAX_LABELS: usize = 32;

/// Longest key of a label, in characters.
pub const MAX_LABEL_KEY: usize = 64;

/// Longest string of a label, in characters.
pub const MAX_LABEL_TEXT: usize = 256;

/// Beyond this, doubles skip whole numbers.
pub const EXACT: i128 = 1 << 53;

/// One field of an object.
#[derive(Debug, Clone, Copy)]
pub struct Field {
    /// Its key.
    pub name: &'static str,
    /// What may stand there.
    pub shape: Shape,
    /// What happens if it is absent.
    pub presence: Presence,
    /// Whether a law may stand in its place.
    pub laws: bool,
    /// Unit of its numbers.
    pub unit: Option<&'static str>,
    /// What it means, without its rules.
    pub doc: &'static str,
    /// What it must fit together with.
    pub rules: &'static [Rule],
    /// Name of the described type of its value, or of the elements of a list.
    pub type_name: Option<&'static str>,
}

impl Field {
    /// What it means and what it must fit together with, for documentation.
    #[must_use]
    pub fn meaning(&self) -> String {
        let rules = self.rules.iter().map(|rule| format!("; {rule}"));
        std::iter::once(self.doc.to_owned()).chain(rules).collect()
    }
}

/// What happens if a field is absent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Presence {
    /// It is an error.
    Required,
    /// It stays unknown, none, or is derived.
    Optional,
    /// This JSON text stands for it.
    Default(&'static str),
}

/// What may stand in a place.
#[derive(Debug, Clone, Copy)]
pub enum Shape {
    /// A finite number.
    Number(Range),
    /// A whole number, both ends included.
    Integer(i128, i128),
    /// A string.
    Text(Names),
    /// A list; with `distinct`, of strings that differ.
    List {
        /// What each element is.
        element: &'static Shape,
        /// Greatest length.
        max: usize,
        /// Whether no element may stand twice.
        distinct: bool,
    },
    /// Three numbers: R, G, B.
    Rgb(Range),
    /// Three numbers: x, y, z.
    Vector(Range),
    /// An object with these fields.
    Object(&'static [Field]),
    /// An object with exactly one of these fields.
    OneOf(&'static [Field]),
    /// An object whose field `tag` decides which others it has.
    Tagged {
        /// The deciding field; never a law.
        tag: &'static str,
        /// The tag if it is absent, or that it is required.
        presence: Presence,
        /// The kinds of object.
        options: &'static [Variant],
    },
    /// An object with these fields, or a string `s` short for `{field: s}`.
    Short(&'static str, &'static [Field]),
    /// A string, or an object.
    Either(Names, &'static Shape),
    /// True or false.
    Bool,
    /// The user's own scalars by name.
    Labels,
    /// A number, string or boolean.
    Scalar,
}

impl Shape {
    /// What must stand here, for messages: `a number`.
    #[must_use]
    pub fn describe(&self) -> &'static str {
        match self {
            Self::Number(_) => "a number",
            Self::Integer(..) => "a whole number",
            Self::Text(_) => "a string",
            Self::List { .. } => "a list",
            Self::Rgb(_) => "a list of three numbers, R, G, B",
            Self::Vector(_) => "a list of three numbers, x, y, z",
            Self::Object(_) | Self::OneOf(_) | Self::Tagged { .. } | Self::Labels => "an object",
            Self::Short(..) | Self::Either(..) => "a string or an object",
            Self::Bool => "true or false",
            Self::Scalar => "a number, string or boolean",
        }
    }

    /// Its limits, for people; empty where the fields below have their own.
    #[must_use]
    pub fn limit(&self) -> String {
        match self {
            Self::Number(range) => range.to_string(),
            Self::Rgb(range) | Self::Vector(range) => format!("each {range}"),
            Self::Integer(min, max) => format!("{min}..={max}"),
            Self::Text(names) => names.limit(),
            Self::List {
                element: Self::Text(names),
                max,
                ..
            } => {
                format!("at most {max} elements, all different, each {}", names.limit())
            }
            Self::List { max, .. } => format!("at most {max} elements"),
            Self::Short(field, _) => format!("a string is short for `{{\"{field}\": …}}`"),
            Self::Either(names, _) => format!("{} or an object", names.limit()),
            Self::OneOf(_) => "exactly one of its fields".to_owned(),
            Self::Labels => format!(
                "at most {MAX_LABELS} entries, names of 1 to {MAX_LABEL_KEY} of A-Z a-z 0-9 _ . -, \
                 numbers, booleans or strings of at most {MAX_LABEL_TEXT} characters"
            ),
            Self::Object(_) | Self::Tagged { .. } | Self::Bool | Self::Scalar => String::new(),
        }
    }
}

/// One kind of a tagged object.
#[derive(Debug, Clone, Copy)]
pub struct Variant {
    /// Value of the tag.
    pub name: &'static str,
    /// The other fields.
    pub fields: &'static [Field],
    /// Name of the type of such objects.
    pub type_name: &'static str,
}

/// An interval of numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Lower end.
    pub min: f64,
    /// Upper end, included.
    pub max: f64,
    /// Whether the lower end is excluded.
    pub above: bool,
}

impl Range {
    /// All finite numbers.
    pub const FINITE: Self = Self::within(-f64::MAX, f64::MAX);

    /// Both ends included.
    #[must_use]
    pub const fn within(min: f64, max: f64) -> Self {
        Self {
            min,
            max,
            above: false,
        }
    }

    /// Lower end excluded.
    #[must_use]
    pub const fn above(min: f64, max: f64) -> Self {
        Self {
            min,
            max,
            above: true,
        }
    }

    /// Whether the number lies within.
    #[must_use]
    pub fn holds(&self, number: f64) -> bool {
        number <= self.max
            && if self.above {
                number > self.min
            } else {
                number >= self.min
            }
    }
}

impl std::fmt::Display for Range {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match *self {
            Self::FINITE => f.write_str("any finite number"),
            Self {
                min,
                max,
                above: true,
            } => write!(f, "above {}, at most {}", plain(min), plain(max)),
            Self {
                min,
                max,
                above: false,
            } => write!(f, "{}..={}", plain(min), plain(max)),
        }
    }
}

fn plain(number: f64) -> String {
    if number != 0.0 && number.abs() < 1e-3 {
        format!("{number:e}")
    } else {
        number.to_string()
    }
}
