//! The values of a column in memory.

use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::Arc;

/// Stands where a text is missing.
pub(crate) const NO_TEXT: u16 = u16::MAX;
/// The offset of stored large numbers.
const OFFSET: i128 = 1 << 63;

/// The type of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A number.
    Number,
    /// A whole number with a sign.
    Whole,
    /// A whole number up to 2^64 − 1, held less 2^63.
    Large,
    /// Yes or no, held as 1 or 0.
    Flag,
    /// A text.
    Text,
}

/// The values of some rows.
#[derive(Debug, Clone, PartialEq)]
pub enum Column {
    /// No row has a value.
    Missing(usize),
    /// Doubles; NaN is a missing value, since no row has it as a value.
    Numbers(Vec<f64>),
    /// Whole numbers of this kind; `missing` is empty where every row has one.
    Wholes {
        /// Whole, large or flag.
        kind: Kind,
        /// As they are held; 0 where one is missing.
        values: Vec<i64>,
        /// Row by row, or empty.
        missing: Vec<bool>,
    },
    /// Texts by their position in a list; `u16::MAX` is a missing value.
    Texts {
        /// Row by row.
        codes: Vec<u16>,
        /// Each once.
        texts: Vec<Arc<str>>,
    },
}

impl Column {
    /// Rows.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::Missing(rows) => *rows,
            Self::Numbers(values) => values.len(),
            Self::Wholes { values, .. } => values.len(),
            Self::Texts { codes, .. } => codes.len(),
        }
    }

    /// Whether it has no rows.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Whether any row has another value; the order of the list of texts does not matter.
    #[must_use]
    pub fn is_other_than(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Texts { codes: one, texts }, Self::Texts { codes, texts: others }) => {
                one.len() != codes.len()
                    || one
                        .iter()
                        .zip(codes)
                        .any(|(one, other)| texts.get(usize::from(*one)) != others.get(usize::from(*other)))
            }
            (Self::Wholes { .. }, Self::Wholes { .. }) => self != other,
            (Self::Texts { .. }, _) | (_, Self::Texts { .. }) => !(self.is_void() && other.is_void()),
            _ => {
                let (one, other) = (self.numbers(), other.numbers());
                !one.iter()
                    .map(|value| value.to_bits())
                    .eq(other.iter().map(|value| value.to_bits()))
            }
        }
    }

    /// Approximate size in memory.
    pub(crate) fn bytes(&self) -> usize {
        match self {
            Self::Missing(_) => 0,
            Self::Numbers(values) => 8 * values.len(),
            Self::Wholes { values, missing, .. } => 8 * values.len() + missing.len(),
            Self::Texts { codes, texts } => {
                2 * codes.len() + texts.iter().map(|text| text.len() + 32).sum::<usize>()
            }
        }
    }

    /// Whether no row has a value.
    pub(crate) fn is_void(&self) -> bool {
        match self {
            Self::Missing(_) => true,
            Self::Numbers(values) => values.iter().all(|value| value.is_nan()),
            Self::Wholes { missing, .. } => !missing.is_empty() && missing.iter().all(|missing| *missing),
            Self::Texts { codes, .. } => codes.iter().all(|code| *code == NO_TEXT),
        }
    }

    /// The values as doubles, the nearest ones of large numbers; NaN for missing values and for texts.
    #[must_use]
    pub fn numbers(&self) -> Cow<'_, [f64]> {
        match self {
            Self::Numbers(values) => Cow::Borrowed(values),
            Self::Wholes {
                kind,
                values,
                missing,
            } => Cow::Owned(
                (0..values.len())
                    .map(|at: usize| match (missing.get(at), kind) {
                        (Some(true), _) => f64::NAN,
                        (_, Kind::Large) => raised(values[at]) as f64,
                        _ => values[at] as f64,
                    })
                    .collect(),
            ),
            Self::Missing(_) | Self::Texts { .. } => Cow::Owned(vec![f64::NAN; self.len()]),
        }
    }
}

/// The stored form of a large number.
#[must_use]
pub(crate) fn raised(held: i64) -> u64 {
    (i128::from(held) + OFFSET) as u64
}

/// A column that grows row by row.
#[derive(Debug)]
pub struct ColumnBuilder {
    column: Column,
    /// Places of texts.
    places: HashMap<Arc<str>, u16>,
}

impl ColumnBuilder {
    /// An empty column.
    #[must_use]
    pub fn new(kind: Kind) -> Self {
        let column = match kind {
            Kind::Number => Column::Numbers(Vec::new()),
            Kind::Whole | Kind::Large | Kind::Flag => Column::Wholes {
                kind,
                values: Vec::new(),
                missing: Vec::new(),
            },
            Kind::Text => Column::Texts {
                codes: Vec::new(),
                texts: Vec::new(),
            },
        };
        Self {
            column,
            places: HashMap::new(),
        }
    }

    /// Adds a number to a column of numbers.
    pub fn number(&mut self, value: Option<f64>) {
        if let Column::Numbers(values) = &mut self.column {
            values.push(value.unwrap_or(f64::NAN));
        }
    }

    /// Adds a whole number as it is held.
    pub fn whole(&mut self, value: Option<i64>) {
        if let Column::Wholes { values, missing, .. } = &mut self.column {
            if value.is_none() && missing.is_empty() {
                missing.resize(values.len(), false);
            }
            if value.is_none() || !missing.is_empty() {
                missing.push(value.is_none());
            }
            values.push(value.unwrap_or(0));
        }
    }

    /// Adds a known text by its position.
    pub(crate) fn code(&mut self, code: u16) {
        if let Column::Texts { codes, .. } = &mut self.column {
            codes.push(code);
        }
    }

    /// Adds a text to a column of at most 65 535 rows; returns its place.
    pub fn text(&mut self, value: Option<&str>) -> u16 {
        let mut added = NO_TEXT;
        if let Column::Texts { codes, texts } = &mut self.column {
            let code = value.map_or(NO_TEXT, |value| {
                if let Some(last) = codes.last().filter(|last| **last != NO_TEXT)
                    && *texts[usize::from(*last)] == *value
                {
                    return *last;
                }
                self.places.get(value).copied().unwrap_or_else(|| {
                    let text: Arc<str> = value.into();
                    texts.push(Arc::clone(&text));
                    let place = (texts.len() - 1) as u16;
                    self.places.insert(text, place);
                    place
                })
            });
            codes.push(code);
            added = code;
        }
        added
    }

    /// The column.
    #[must_use]
    pub fn build(self) -> Column {
        self.column
    }
}
