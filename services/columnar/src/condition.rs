//! Vectorized conditions over columns.

use std::cmp::Ordering;

use crate::column::{Column, NO_TEXT};

/// A condition that a row fulfills or not. A test of a missing value is not fulfilled, apart from [`Test::IsMissing`].
#[derive(Debug, Clone, PartialEq)]
pub enum Condition {
    /// All of them.
    All(Vec<Condition>),
    /// Any of them.
    Any(Vec<Condition>),
    /// Not this.
    Not(Box<Condition>),
    /// A test of a column.
    Test(String, Test),
}

/// A test of a value.
#[derive(Debug, Clone, PartialEq)]
pub enum Test {
    /// The value is missing.
    IsMissing,
    /// It compares so.
    Is(Sign, Value),
    /// It is one of these.
    In(Vec<Value>),
    /// The value is between these, both included.
    Between(Value, Value),
}

/// How two values compare.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Sign {
    Equal,
    Unequal,
    Below,
    Above,
    AtMost,
    AtLeast,
}

/// The constant of a comparison.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// A number.
    Number(f64),
    /// A whole number, as the column holds it.
    Whole(i64),
    /// A text.
    Text(String),
}

impl Value {
    /// As a number; NaN, to which nothing compares, for a text.
    fn number(&self) -> f64 {
        match self {
            Self::Number(number) => *number,
            Self::Whole(number) => *number as f64,
            Self::Text(_) => f64::NAN,
        }
    }

    /// How a whole number compares to this; `None` if it does not.
    fn order(&self, value: i64) -> Option<Ordering> {
        match self {
            Self::Whole(bound) => Some(value.cmp(bound)),
            Self::Number(bound) => compare(value, *bound),
            Self::Text(_) => None,
        }
    }

    fn is_text(&self, text: &str) -> bool {
        matches!(self, Self::Text(other) if other == text)
    }
}

fn test_each(values: &[f64], test: impl Fn(f64) -> bool) -> Vec<bool> {
    values.iter().map(|value| test(*value)).collect()
}

/// Which rows fulfill a condition.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Mask {
    None,
    All,
    Some(Vec<bool>),
}

/// Bounds of a column from the footer: the smallest and the largest value, and whether any is missing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Range {
    pub(crate) low: Bound,
    pub(crate) high: Bound,
    pub(crate) any_missing: bool,
}

impl Range {
    /// Whether no value of the range can equal this one.
    fn is_without(&self, value: &Value) -> bool {
        Test::Is(Sign::Above, value.clone()).holds_at(&self.low)
            || Test::Is(Sign::Below, value.clone()).holds_at(&self.high)
    }
}

/// An end of a range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Bound {
    Number(f64),
    Whole(i64),
}

impl Mask {
    pub(crate) fn from_rows(rows: Vec<bool>) -> Self {
        if rows.iter().all(|row| *row) {
            Self::All
        } else if rows.iter().any(|row| *row) {
            Self::Some(rows)
        } else {
            Self::None
        }
    }

    pub(crate) fn and(self, other: Self) -> Self {
        match (self, other) {
            (Self::None, _) | (_, Self::None) => Self::None,
            (Self::All, mask) | (mask, Self::All) => mask,
            (Self::Some(mut one), Self::Some(other)) => {
                one.iter_mut().zip(other).for_each(|(one, other)| *one &= other);
                Self::from_rows(one)
            }
        }
    }

    fn or(self, other: Self) -> Self {
        self.not().and(other.not()).not()
    }

    fn not(self) -> Self {
        match self {
            Self::None => Self::All,
            Self::All => Self::None,
            Self::Some(rows) => Self::Some(rows.into_iter().map(|row| !row).collect()),
        }
    }

    /// Rows that fulfill it.
    pub(crate) fn count(&self, rows: usize) -> usize {
        match self {
            Self::None => 0,
            Self::All => rows,
            Self::Some(mask) => mask.iter().filter(|row| **row).count(),
        }
    }
}

/// The source of the columns of some rows.
pub(crate) trait Columns {
    type Error;
    fn column(&self, name: &str) -> Result<std::sync::Arc<Column>, Self::Error>;
    fn range(&self, name: &str) -> Option<Range>;
}

impl Condition {
    /// The rows that fulfill it; columns are read only where their range leaves it open.
    pub(crate) fn mask<C: Columns>(&self, columns: &C) -> Result<Mask, C::Error> {
        match self {
            Self::All(all) => {
                let mut mask = Mask::All;
                for one in all {
                    if mask == Mask::None {
                        break;
                    }
                    mask = mask.and(one.mask(columns)?);
                }
                Ok(mask)
            }
            Self::Any(all) => {
                let mut mask = Mask::None;
                for one in all {
                    if mask == Mask::All {
                        break;
                    }
                    mask = mask.or(one.mask(columns)?);
                }
                Ok(mask)
            }
            Self::Not(one) => Ok(one.mask(columns)?.not()),
            Self::Test(name, test) => match columns.range(name).and_then(|range| test.of_range(&range)) {
                Some(mask) => Ok(mask),
                None => Ok(test.mask(&*columns.column(name)?)),
            },
        }
    }
}

impl Sign {
    fn holds(self, order: Option<Ordering>) -> bool {
        let Some(order) = order else { return false };
        match self {
            Self::Equal => order.is_eq(),
            Self::Unequal => order.is_ne(),
            Self::Below => order.is_lt(),
            Self::Above => order.is_gt(),
            Self::AtMost => order.is_le(),
            Self::AtLeast => order.is_ge(),
        }
    }
}

impl Test {
    fn mask(&self, column: &Column) -> Mask {
        match column {
            Column::Missing(_) if *self == Self::IsMissing => Mask::All,
            Column::Missing(_) => Mask::None,
            Column::Numbers(values) => Mask::from_rows(self.of_numbers(values)),
            Column::Wholes { values, missing, .. } => {
                let mut rows = self.of_wholes(values);
                for (row, missing) in rows.iter_mut().zip(missing) {
                    *row = if *missing { *self == Self::IsMissing } else { *row };
                }
                Mask::from_rows(rows)
            }
            Column::Texts { codes, texts } => {
                let holds: Vec<bool> = texts.iter().map(|text| self.of_text(text)).collect();
                Mask::from_rows(
                    codes
                        .iter()
                        .map(|code: &u16| match *code {
                            NO_TEXT => *self == Self::IsMissing,
                            code => holds[usize::from(code)],
                        })
                        .collect(),
                )
            }
        }
    }

    /// A separate loop for each test, so that each is vectorized; comparisons with NaN, a missing value, are false.
    fn of_numbers(&self, values: &[f64]) -> Vec<bool> {
        match self {
            Self::IsMissing => test_each(values, f64::is_nan),
            Self::In(all) => {
                let all: Vec<f64> = all.iter().map(Value::number).collect();
                test_each(values, |value| all.contains(&value))
            }
            Self::Between(low, high) => {
                let (low, high) = (low.number(), high.number());
                test_each(values, |value| (low <= value) & (value <= high))
            }
            Self::Is(sign, bound) => {
                let bound = bound.number();
                match sign {
                    Sign::Equal => test_each(values, |value| value == bound),
                    Sign::Unequal => test_each(values, |value| !value.is_nan() && value != bound),
                    Sign::Below => test_each(values, |value| value < bound),
                    Sign::Above => test_each(values, |value| value > bound),
                    Sign::AtMost => test_each(values, |value| value <= bound),
                    Sign::AtLeast => test_each(values, |value| value >= bound),
                }
            }
        }
    }

    fn of_wholes(&self, values: &[i64]) -> Vec<bool> {
        values.iter().map(|value| self.of_whole(*value)).collect()
    }

    fn of_whole(&self, value: i64) -> bool {
        match self {
            Self::IsMissing => false,
            Self::Is(sign, bound) => sign.holds(bound.order(value)),
            Self::In(all) => all.iter().any(|one| Sign::Equal.holds(one.order(value))),
            Self::Between(low, high) => {
                Sign::AtLeast.holds(low.order(value)) && Sign::AtMost.holds(high.order(value))
            }
        }
    }

    fn of_text(&self, text: &str) -> bool {
        match self {
            Self::Is(Sign::Equal, value) => value.is_text(text),
            Self::Is(Sign::Unequal, value) => !value.is_text(text),
            Self::In(all) => all.iter().any(|value| value.is_text(text)),
            Self::IsMissing | Self::Is(..) | Self::Between(..) => false,
        }
    }

    /// The mask where the ends of the range decide it: a test that holds at both ends of a range holds between them, unless it is
    /// one for single values.
    fn of_range(&self, range: &Range) -> Option<Mask> {
        let all = (!range.any_missing).then_some(Mask::All);
        match self {
            Self::IsMissing => (!range.any_missing).then_some(Mask::None),
            Self::In(values) => {
                let is_apart = values.iter().all(|value| range.is_without(value));
                is_apart.then_some(Mask::None)
            }
            Self::Is(Sign::Equal, value) => range.is_without(value).then_some(Mask::None),
            Self::Is(Sign::Unequal, value) => range.is_without(value).then_some(all)?,
            Self::Between(low, high) => {
                let is_apart = Self::Is(Sign::Below, low.clone()).holds_at(&range.high)
                    || Self::Is(Sign::Above, high.clone()).holds_at(&range.low);
                match (self.holds_at(&range.low), self.holds_at(&range.high)) {
                    _ if is_apart => Some(Mask::None),
                    (true, true) => all,
                    _ => None,
                }
            }
            Self::Is(..) => match (self.holds_at(&range.low), self.holds_at(&range.high)) {
                (true, true) => all,
                (false, false) => Some(Mask::None),
                _ => None,
            },
        }
    }

    fn holds_at(&self, bound: &Bound) -> bool {
        match *bound {
            Bound::Number(value) => self.of_numbers(&[value])[0],
            Bound::Whole(value) => self.of_whole(value),
        }
    }
}

/// Compares exactly, without rounding the whole number.
fn compare(whole: i64, number: f64) -> Option<Ordering> {
    const END: f64 = 9_223_372_036_854_775_808.0;
    if number.is_nan() {
        return None;
    }
    if number >= END {
        return Some(Ordering::Less);
    }
    if number < -END {
        return Some(Ordering::Greater);
    }
    let below = number.floor();
    let order = whole.cmp(&(below as i64));
    Some(if order.is_eq() && number > below {
        Ordering::Less
    } else {
        order
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_numbers_compare_exactly() {
        assert_eq!(compare(i64::MAX, i64::MAX as f64), Some(Ordering::Less));
        assert_eq!(compare(3, 3.5), Some(Ordering::Less));
        assert_eq!(compare(4, 3.5), Some(Ordering::Greater));
        assert_eq!(compare(-3, -3.5), Some(Ordering::Greater));
        assert_eq!(compare(i64::MIN, f64::NEG_INFINITY), Some(Ordering::Greater));
        assert_eq!(compare(0, -0.0), Some(Ordering::Equal));
    }

    #[test]
    fn a_range_never_decides_otherwise_than_the_values() {
        let number = |value: i64| Value::Number(value as f64);
        let mut tests = vec![Test::IsMissing];
        for bound in -1..6 {
            for sign in [
                Sign::Equal,
                Sign::Unequal,
                Sign::Below,
                Sign::Above,
                Sign::AtMost,
                Sign::AtLeast,
            ] {
                tests.push(Test::Is(sign, number(bound)));
                tests.push(Test::Is(sign, Value::Whole(bound)));
            }
            tests.push(Test::In(vec![number(bound), number(bound + 3)]));
            tests.extend((bound..7).map(|high| Test::Between(number(bound), number(high))));
        }
        for values in [vec![1, 2, 4], vec![2], vec![0, 4], vec![3, 3]] {
            let numbers = Column::Numbers(values.iter().map(|value| *value as f64).collect());
            let (low, high) = (values[0], values[values.len() - 1]);
            let range = Range {
                low: Bound::Number(low as f64),
                high: Bound::Number(high as f64),
                any_missing: false,
            };
            for test in &tests {
                if let Some(decided) = test.of_range(&range) {
                    assert_eq!(decided, test.mask(&numbers), "{test:?} of {values:?}");
                }
            }
        }
    }
}
