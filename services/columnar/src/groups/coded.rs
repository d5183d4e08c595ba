//! Dictionary encoding of columns: equal values have equal codes.

use std::sync::Arc;

use crate::bins::Bins;
use crate::column::{Column, Kind};

/// A column as codes into a list of its values.
pub(super) struct Coded {
    pub(super) codes: Codes,
    pub(super) cells: Vec<Cell>,
}

/// The codes, row by row.
pub(super) enum Codes {
    /// The codes of a column of texts; the last one is that of a missing text.
    Texts(Arc<Column>, u32),
    Rows(Vec<u32>),
}

impl Codes {
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Texts(column, _) => column.len(),
            Self::Rows(codes) => codes.len(),
        }
    }

    #[inline]
    pub(super) fn of_row(&self, at: usize) -> u32 {
        match self {
            Self::Rows(codes) => codes[at],
            Self::Texts(column, missing) => match &**column {
                Column::Texts { codes, .. } => u32::from(codes[at]).min(*missing),
                _ => *missing,
            },
        }
    }

    /// Combines earlier codes with these, of which there are `count`.
    pub(super) fn join(&self, joined: &mut [u32], count: u32) {
        match self {
            Self::Rows(codes) => {
                for (joined, code) in joined.iter_mut().zip(codes) {
                    *joined = *joined * count + code;
                }
            }
            Self::Texts(column, missing) => {
                let Column::Texts { codes, .. } = &**column else {
                    return;
                };
                for (joined, code) in joined.iter_mut().zip(codes) {
                    *joined = *joined * count + u32::from(*code).min(*missing);
                }
            }
        }
    }
}

impl Coded {
    pub(super) fn new(column: Arc<Column>, bins: Option<Bins>) -> Self {
        match (&*column, bins) {
            (Column::Texts { texts, .. }, _) => {
                let cells = texts.iter().map(|text| Cell::Text(Arc::clone(text)));
                let cells: Vec<Cell> = cells.chain([Cell::Missing]).collect();
                Self {
                    codes: Codes::Texts(Arc::clone(&column), cells.len() as u32 - 1),
                    cells,
                }
            }
            (Column::Missing(rows), _) => Self {
                codes: Codes::Rows(vec![0; *rows]),
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
                Self::from_keys(
                    (0..values.len())
                        .map(|at: usize| (values[at] as u64, missing.get(at).copied().unwrap_or(false))),
                    cell,
                )
            }
            (_, Some(bins)) => Self::in_bins(&column.numbers(), bins),
            (_, None) => {
                let numbers = column.numbers();
                let value = |at: usize| {
                    if numbers[at].is_finite() {
                        numbers[at] + 0.0
                    } else {
                        f64::NAN
                    }
                };
                let cell = |at: usize| match value(at) {
                    value if value.is_nan() => Cell::Missing,
                    value => Cell::Number(value.to_bits()),
                };
                Self::from_keys(
                    (0..numbers.len()).map(|at: usize| (value(at).to_bits(), value(at).is_nan())),
                    cell,
                )
            }
        }
    }

    /// Encodes rows by keys: equal keys have equal cells.
    fn from_keys(keys: impl Iterator<Item = (u64, bool)>, cell: impl Fn(usize) -> Cell) -> Self {
        let (mut codes, mut cells) = (Vec::new(), Vec::new());
        let mut places = Table::default();
        for (at, key) in keys.enumerate() {
            let code = places.place(key, cells.len() as u32);
            if code as usize == cells.len() {
                cells.push(cell(at));
            }
            codes.push(code);
        }
        Self {
            codes: Codes::Rows(codes),
            cells,
        }
    }

    /// Rows by the bins of their numbers.
    fn in_bins(numbers: &[f64], bins: Bins) -> Self {
        let mut edges = Edges::new(bins);
        let codes = numbers.iter().map(|number| edges.code(*number)).collect();
        Self {
            codes: Codes::Rows(codes),
            cells: edges.cells,
        }
    }
}

/// A cache of bin edges and their codes: computing an edge takes several divisions, comparing with one takes none.
struct Edges {
    bins: Bins,
    known: Vec<(f64, f64, u32)>,
    places: Table,
    cells: Vec<Cell>,
}

impl Edges {
    const KNOWN: usize = 256;

    fn new(bins: Bins) -> Self {
        Self {
            bins,
            known: vec![(f64::INFINITY, f64::NEG_INFINITY, 0); Self::KNOWN],
            places: Table::default(),
            cells: Vec::new(),
        }
    }

    /// The place of the bin that holds a number, by [`Bins::lower_edge`].
    #[inline]
    fn code(&mut self, number: f64) -> u32 {
        let slot = self.bins.about(number) as usize % Self::KNOWN;
        let (low, high, code) = self.known[slot];
        if low <= number && number < high {
            return code;
        }
        self.found(number, slot)
    }

    fn found(&mut self, number: f64, slot: usize) -> u32 {
        if !number.is_finite() {
            return self.place((0, true), Cell::Missing);
        }
        let lower = self.bins.lower_edge(number);
        let code = self.place((lower.to_bits(), false), Cell::Edge(lower.to_bits()));
        if let Some(upper) = self.bins.upper_edge(lower) {
            self.known[slot] = (lower, upper, code);
        }
        code
    }

    fn place(&mut self, key: (u64, bool), cell: Cell) -> u32 {
        let code = self.places.place(key, self.cells.len() as u32);
        if code as usize == self.cells.len() {
            self.cells.push(cell);
        }
        code
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

/// The common value of a group's rows in one column.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn remembered_edges_are_those_that_are_computed() {
        for width in [0.1, 0.25, 3.0, 1e-20, 1e300, 0.007, 1.0 / 3.0] {
            let bins = Bins::new(width);
            let mut edges = Edges::new(bins);
            let mut numbers: Vec<f64> = (-3000..3000).map(|step| f64::from(step) * width / 7.0).collect();
            numbers.extend(
                [1e15, 0.1 + 0.2, 0.3, -1e13, 1e295, 7e15, 0.7].map(|number| number * width.min(1.0)),
            );
            for number in numbers {
                let code = edges.code(number) as usize;
                let expected = Cell::Edge(bins.lower_edge(number).to_bits());
                assert_eq!(edges.cells[code], expected, "{number} of {width}");
            }
        }
    }
}
