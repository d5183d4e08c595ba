//! Groups of rows: by the values of columns and by bins of them.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use crate::bins::Bins;
use crate::column::{Column, Kind, NO_TEXT};
use crate::error::ColumnarError;
use crate::parts::Masked;

/// A column by which rows are grouped, by its place among the columns of the question.
#[derive(Debug, Clone, Copy)]
pub struct GroupBy {
    /// The place.
    pub column: usize,
    /// Its bins; `None`: each value is a group.
    pub bins: Option<Bins>,
}

/// What the rows of a group have in common in one column.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Cell {
    /// No value, or one that is not finite.
    Missing,
    /// A number by its bits; zero has no sign.
    Number(u64),
    /// The lower edge of a bin by its bits.
    Edge(u64),
    /// A whole number of this kind as it is held.
    Whole(i64),
    /// A large number as it is held.
    Large(i64),
    /// Yes or no.
    Flag(bool),
    /// A text.
    Text(Arc<str>),
}

/// The group of a row that does not count.
pub(crate) const NO_GROUP: u16 = u16::MAX;

/// Groups and which rows belong to them.
pub(crate) struct Grouped {
    pub(crate) keys: Vec<Vec<Cell>>,
    /// Part by part and row by row; empty for a part without rows, and without columns.
    pub(crate) groups: Vec<Vec<u16>>,
}

/// The groups that have rows, in no order.
pub(crate) fn grouped(masked: &Masked<'_>, by: &[GroupBy], most: usize) -> Result<Grouped, ColumnarError> {
    let mut groups = vec![Vec::new(); masked.question.parts.len()];
    if by.is_empty() {
        // Without columns all rows are one group, unless there are none.
        let any = masked.source.files + masked.source.memory > 0;
        return Ok(Grouped {
            keys: vec![Vec::new(); usize::from(any)],
            groups,
        });
    }
    let most = most.min(usize::from(NO_GROUP));
    let known: Mutex<HashMap<Vec<Cell>, u16>> = Mutex::default();
    let place = |key: Vec<Cell>| {
        let mut known = known.lock().unwrap_or_else(PoisonError::into_inner);
        let next = known.len();
        let place = *known.entry(key).or_insert(next as u16);
        if known.len() > most {
            return Err(ColumnarError::TooManyGroups(most));
        }
        Ok(place)
    };
    let passed = masked.pass(Vec::new, |all, rows| {
        let coded = by
            .iter()
            .map(|by| Ok(Coded::new(&*rows.column(by.column)?, by.bins)));
        let coded = coded.collect::<Result<Vec<_>, ColumnarError>>()?;
        let length = coded.first().map_or(0, |coded| coded.codes.len());
        let mut groups = vec![NO_GROUP; length];
        let mut places = Places::new(&coded);
        let mut failed = None;
        rows.each(length, |at| {
            if failed.is_none() {
                match places.of_row(&coded, at, place) {
                    Ok(group) => groups[at] = group,
                    Err(error) => failed = Some(error),
                }
            }
        });
        all.push((rows.at, groups));
        failed.map_or(Ok(()), Err)
    })?;
    for (at, of_part) in passed.into_iter().flatten() {
        groups[at] = of_part;
    }
    let known = known.into_inner().unwrap_or_else(PoisonError::into_inner);
    let mut keys = vec![Vec::new(); known.len()];
    for (key, place) in known {
        keys[usize::from(place)] = key;
    }
    Ok(Grouped { keys, groups })
}

/// A column as places in a list of what it has.
struct Coded {
    codes: Vec<u32>,
    cells: Vec<Cell>,
}

impl Coded {
    fn new(column: &Column, bins: Option<Bins>) -> Self {
        match (column, bins) {
            (Column::Texts { codes, texts }, _) => {
                let missing = texts.len() as u32;
                let code = |code: &u16| {
                    if *code == NO_TEXT {
                        missing
                    } else {
                        u32::from(*code)
                    }
                };
                let cells = texts.iter().map(|text| Cell::Text(Arc::clone(text)));
                Self {
                    codes: codes.iter().map(code).collect(),
                    cells: cells.chain([Cell::Missing]).collect(),
                }
            }
            (Column::Missing(rows), _) => Self {
                codes: vec![0; *rows],
                cells: vec![Cell::Missing],
            },
            (
                Column::Wholes {
                    kind,
                    values,
                    missing,
                },
                None,
            ) => {
                let cell = |at: usize| match kind {
                    _ if missing.get(at).copied().unwrap_or(false) => Cell::Missing,
                    Kind::Flag => Cell::Flag(values[at] != 0),
                    Kind::Large => Cell::Large(values[at]),
                    _ => Cell::Whole(values[at]),
                };
                let key = |at: usize| (values[at] as u64, missing.get(at).copied().unwrap_or(false));
                Self::of((0..values.len()).map(key), cell)
            }
            _ => {
                let numbers = column.numbers();
                let mut edges = Edges::new(bins);
                let value = |at: usize| match bins {
                    _ if !numbers[at].is_finite() => f64::NAN,
                    Some(_) => edges.lower(numbers[at]),
                    None => numbers[at] + 0.0,
                };
                let values: Vec<f64> = (0..numbers.len()).map(value).collect();
                let cell = |at: usize| match values[at].to_bits() {
                    _ if values[at].is_nan() => Cell::Missing,
                    bits if bins.is_some() => Cell::Edge(bits),
                    bits => Cell::Number(bits),
                };
                Self::of(values.iter().map(|value| (value.to_bits(), value.is_nan())), cell)
            }
        }
    }

    /// Rows by what they have: equal keys have equal cells.
    fn of(keys: impl Iterator<Item = (u64, bool)>, cell: impl Fn(usize) -> Cell) -> Self {
        let (mut codes, mut cells) = (Vec::new(), Vec::new());
        let mut places = Table::default();
        for (at, key) in keys.enumerate() {
            let code = places.place(key, cells.len() as u32);
            if code as usize == cells.len() {
                cells.push(cell(at));
            }
            codes.push(code);
        }
        Self { codes, cells }
    }
}

/// Edges of bins that were found before: to find them takes several divisions, to compare with them none.
struct Edges {
    bins: Option<Bins>,
    known: Vec<(f64, f64)>,
}

impl Edges {
    const PLACES: usize = 256;

    fn new(bins: Option<Bins>) -> Self {
        Self {
            bins,
            known: vec![(f64::INFINITY, f64::NEG_INFINITY); Self::PLACES],
        }
    }

    /// [`Bins::lower_edge`].
    #[inline]
    fn lower(&mut self, number: f64) -> f64 {
        let Some(bins) = &self.bins else { return number };
        let known = &mut self.known[bins.about(number) as usize % Self::PLACES];
        if !(known.0 <= number && number < known.1) {
            let lower = bins.lower_edge(number);
            let Some(upper) = bins.upper_edge(lower) else {
                return lower;
            };
            *known = (lower, upper);
        }
        known.0
    }
}

/// Places of keys: open addressing, since a hash that withstands chosen keys took most of the time, and here a chosen key costs no more
/// than a look at each row of one file.
#[derive(Default)]
struct Table {
    slots: Vec<Option<((u64, bool), u32)>>,
    used: usize,
}

impl Table {
    /// The place of a key, which is `next` if it is new.
    #[inline]
    fn place(&mut self, key: (u64, bool), next: u32) -> u32 {
        if 2 * self.used >= self.slots.len() {
            self.grow();
        }
        let mask = self.slots.len() - 1;
        let mut at = Self::start(key, mask);
        loop {
            match self.slots[at] {
                Some((known, place)) if known == key => return place,
                Some(_) => at = (at + 1) & mask,
                None => {
                    self.slots[at] = Some((key, next));
                    self.used += 1;
                    return next;
                }
            }
        }
    }

    /// Knuth (1973), multiplicative hashing by the golden ratio.
    fn start(key: (u64, bool), mask: usize) -> usize {
        let mixed = (key.0 ^ (key.0 >> 32) ^ u64::from(key.1)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        (mixed >> 32) as usize & mask
    }

    fn grow(&mut self) {
        let before = std::mem::take(&mut self.slots);
        self.slots = vec![None; (2 * before.len()).max(64)];
        let mask = self.slots.len() - 1;
        for (key, place) in before.into_iter().flatten() {
            let mut at = Self::start(key, mask);
            while self.slots[at].is_some() {
                at = (at + 1) & mask;
            }
            self.slots[at] = Some((key, place));
        }
    }
}

/// The groups of a part by the codes of its rows.
enum Places {
    Few(Vec<u16>),
    Many(HashMap<Vec<u32>, u16>),
}

impl Places {
    /// So many combinations stand in a table; more would take longer to clear than to search.
    const FEW: usize = 1 << 16;

    fn new(coded: &[Coded]) -> Self {
        let all = coded
            .iter()
            .try_fold(1_usize, |all, one| all.checked_mul(one.cells.len()));
        match all.filter(|all| *all <= Self::FEW) {
            Some(all) => Self::Few(vec![NO_GROUP; all]),
            None => Self::Many(HashMap::new()),
        }
    }

    #[inline]
    fn of_row(
        &mut self,
        coded: &[Coded],
        at: usize,
        place: impl Fn(Vec<Cell>) -> Result<u16, ColumnarError>,
    ) -> Result<u16, ColumnarError> {
        let key = || {
            let cells = coded.iter().map(|one| one.cells[one.codes[at] as usize].clone());
            place(cells.collect())
        };
        match self {
            Self::Few(groups) => {
                let combined = coded.iter().fold(0, |combined, one| {
                    combined * one.cells.len() + one.codes[at] as usize
                });
                if groups[combined] == NO_GROUP {
                    groups[combined] = key()?;
                }
                Ok(groups[combined])
            }
            Self::Many(groups) => {
                let codes: Vec<u32> = coded.iter().map(|one| one.codes[at]).collect();
                if let Some(group) = groups.get(&codes) {
                    return Ok(*group);
                }
                let group = key()?;
                groups.insert(codes, group);
                Ok(group)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn remembered_edges_are_those_that_are_computed() {
        for width in [0.1, 0.25, 3.0, 1e-20, 1e300, 0.007, 1.0 / 3.0] {
            let bins = Bins::new(width);
            let mut edges = Edges::new(Some(bins));
            let mut numbers: Vec<f64> = (-3000..3000).map(|step| f64::from(step) * width / 7.0).collect();
            numbers.extend(
                [1e15, 0.1 + 0.2, 0.3, -1e13, 1e295, 7e15, 0.7].map(|number| number * width.min(1.0)),
            );
            for number in numbers {
                assert_eq!(
                    edges.lower(number).to_bits(),
                    bins.lower_edge(number).to_bits(),
                    "{number} of {width}"
                );
            }
        }
    }
}
