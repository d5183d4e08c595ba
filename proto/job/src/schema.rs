//! The schema of the accepted fields. `#[derive(Described)]` generates it.

mod names;
mod rule;

use serde_json::Value;

pub use names::Names;
pub use rule::Rule;
pub(crate) use rule::{TRACED, describe};

/// Maximum labels: each becomes a queryable column.
pub const MAX_LABELS: usize = 32;

/// Maximum length of a label's key, characters.
pub const MAX_LABEL_KEY: usize = 64;

/// Maximum length of a label's string, characters.
pub const MAX_LABEL_TEXT: usize = 256;

/// Largest magnitude up to which doubles represent every whole number.
pub const EXACT: i128 = 1 << 53;

/// One field of an object.
#[derive(Debug, Clone, Copy)]
pub struct Field {
    /// Key of the field.
    pub name: &'static str,
    /// Type and limits.
    pub shape: Shape,
    /// Meaning of absence.
    pub presence: Presence,
    /// Whether a distribution is allowed.
    pub laws: bool,
    /// Unit of its numbers.
    pub unit: Option<&'static str>,
    /// Meaning, without the rules.
    pub doc: &'static str,
    /// Rules across fields.
    pub rules: &'static [Rule],
    /// Name of the described type of its value, or of the elements of a list.
    pub type_name: Option<&'static str>,
}

impl Field {
    /// Meaning with the rules, for documentation.
    #[must_use]
    pub fn meaning(&self) -> String {
        let rules = self.rules.iter().map(|rule| format!("; {rule}"));
        std::iter::once(self.doc.to_owned()).chain(rules).collect()
    }
}

/// Meaning of an absent field.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Presence {
    /// An error.
    Required,
    /// Unknown, none, or derived.
    Optional,
    /// This JSON text.
    Default(&'static str),
}

/// The value of a default.
pub(crate) fn parse_default(text: &str) -> Value {
    serde_json::from_str(text).expect("the defaults of the table are JSON, a test reads them all")
}

/// Type and limits of a value.
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
        /// Shape of each element.
        element: &'static Shape,
        /// Maximum length.
        max: usize,
        /// Whether elements must differ.
        distinct: bool,
    },
    /// Three numbers: R, G, B.
    Rgb(Range),
    /// Three numbers: x, y, z.
    Vector(Range),
    /// Two whole numbers: across and down, both ends included.
    Pair(i128, i128),
    /// An object with these fields.
    Object(&'static [Field]),
    /// An object with exactly one of these fields.
    OneOf(&'static [Field]),
    /// An object whose field `tag` selects the other fields.
    Tagged {
        /// The selecting field; never a distribution.
        tag: &'static str,
        /// Default of the tag, or required.
        presence: Presence,
        /// Kinds of the object.
        options: &'static [Variant],
    },
    /// An object with these fields, or a string `s` short for `{field: s}`.
    Short(&'static str, &'static [Field]),
    /// A string, or an object.
    Either(Names, &'static Shape),
    /// True or false.
    Bool,
    /// User-defined scalars by name.
    Labels,
    /// A number, string or boolean.
    Scalar,
}

impl Shape {
    /// The expected value in messages: `a number`.
    #[must_use]
    pub fn describe(&self) -> &'static str {
        match self {
            Self::Number(_) => "a number",
            Self::Integer(..) => "a whole number",
            Self::Text(_) => "a string",
            Self::List { .. } => "a list",
            Self::Rgb(_) => "a list of three numbers (R, G, B)",
            Self::Vector(_) => "a list of three numbers (x, y, z)",
            Self::Pair(..) => "a list of two whole numbers (across, down)",
            Self::Object(_) | Self::OneOf(_) | Self::Tagged { .. } | Self::Labels => "an object",
            Self::Short(..) | Self::Either(..) => "a string or an object",
            Self::Bool => "true or false",
            Self::Scalar => "a number, string or boolean",
        }
    }

    /// The limits as text; empty if the nested fields have them.
    #[must_use]
    pub fn limit(&self) -> String {
        match self {
            Self::Number(range) => range.to_string(),
            Self::Rgb(range) | Self::Vector(range) => format!("each {range}"),
            Self::Integer(min, max) => format!("{min}..={max}"),
            Self::Pair(min, max) => format!("each {min}..={max}"),
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
    /// Other fields.
    pub fields: &'static [Field],
    /// Type name of such objects.
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

    /// An interval with both ends.
    #[must_use]
    pub const fn within(min: f64, max: f64) -> Self {
        Self {
            min,
            max,
            above: false,
        }
    }

    /// An interval without its lower end.
    #[must_use]
    pub const fn above(min: f64, max: f64) -> Self {
        Self {
            min,
            max,
            above: true,
        }
    }

    /// Whether the number is within the interval.
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
