//! Top-k selection: rows in the order of a column, then of job and frame, from any rank on.
//!
//! Each row has a key of bits with the same order. A pass counts the rows by the first bits in which keys differ, further ones count the
//! chosen rows by the next bits, until few enough remain to be sorted; the last pass collects the rows that follow.

use std::collections::BTreeSet;
use std::sync::Arc;

use crate::column::{Column, NO_TEXT};
use crate::error::ColumnarError;
use crate::parts::{Masked, Query, Rows};

/// The columns of the query that give the order, by their places.
#[derive(Debug, Clone, Copy)]
pub struct Order {
    /// The column that comes first, and whether its largest value does; rows without a value come last.
    pub by: Option<(usize, bool)>,
    /// The job, a text.
    pub job: usize,
    /// The frame, a whole number.
    pub frame: usize,
}

/// The start of the selected rows.
#[derive(Debug, Clone, PartialEq)]
pub enum Start {
    /// After this many rows.
    Behind(u64),
    /// After a row: its value of the first column, its job and its frame.
    After(Option<Sorted>, String, i64),
}

/// A value of the ordering column.
#[derive(Debug, Clone, PartialEq)]
pub enum Sorted {
    /// Of a column of numbers.
    Number(f64),
    /// Of a column of whole numbers, as it is held.
    Whole(i64),
    /// Of a column of texts.
    Text(String),
}

/// Whether the value is missing, the value, the job, the frame, each as a number with the same order.
type Key = [u64; 4];

const FIRST: Key = [0; 4];
/// Bits per counting pass.
const DIGIT: u32 = 16;
/// Most keys to sort, 8 MB of them. In tests, few rows need every pass.
const FEW: u64 = if cfg!(test) { 4 } else { 1 << 18 };

/// Jobs and frames of `most` rows.
///
/// # Errors
/// Those of files.
pub fn top_k(
    query: &Query<'_>,
    order: &Order,
    start: &Start,
    most: usize,
) -> Result<Vec<(Arc<str>, i64)>, ColumnarError> {
    let masked = Masked::new(query)?;
    let keys = Keys::new(&masked, order)?;
    let first = match start {
        Start::Behind(0) => Some(FIRST),
        Start::Behind(rank) => select(&masked, &keys, *rank)?,
        Start::After(value, job, frame) => Some(keys.after(value.as_ref(), job, *frame)),
    };
    let Some(first) = first else {
        return Ok(Vec::new());
    };
    let found = smallest(&masked, &keys, &first, most)?;
    Ok(found
        .iter()
        .map(|key: &Key| (Arc::clone(&keys.jobs[key[2] as usize]), signed(key[3])))
        .collect())
}

/// Computes keys of rows; texts are ranked among all texts of their column.
struct Keys {
    order: Order,
    jobs: Vec<Arc<str>>,
    texts: Vec<Arc<str>>,
}

/// All texts of a column, sorted.
fn distinct_texts(masked: &Masked<'_>, column: usize) -> Result<Vec<Arc<str>>, ColumnarError> {
    let all = masked.pass(BTreeSet::new, |all, rows| {
        if let Column::Texts { texts, .. } = &*rows.column(column)? {
            all.extend(texts.iter().cloned());
        }
        Ok(())
    })?;
    let all: BTreeSet<_> = all.into_iter().flatten().collect();
    Ok(all.into_iter().collect())
}

/// The number of rows with a digit, over all threads.
fn total(counts: &[Vec<u64>], digit: usize) -> u64 {
    counts.iter().map(|counts| counts[digit]).sum()
}

impl Keys {
    fn new(masked: &Masked<'_>, order: &Order) -> Result<Self, ColumnarError> {
        Ok(Self {
            order: *order,
            jobs: distinct_texts(masked, order.job)?,
            texts: order
                .by
                .map_or_else(|| Ok(Vec::new()), |(place, _)| distinct_texts(masked, place))?,
        })
    }

    /// Calls `visit` with the key of every row that counts.
    fn visit(&self, rows: &Rows<'_>, mut visit: impl FnMut(Key)) -> Result<(), ColumnarError> {
        let (jobs, frames) = (rows.column(self.order.job)?, rows.column(self.order.frame)?);
        let (Column::Texts { codes, texts }, Column::Wholes { values: frames, .. }) = (&*jobs, &*frames)
        else {
            return Ok(());
        };
        let jobs = places(texts, &self.jobs);
        let job = |at: usize| jobs.get(usize::from(codes[at])).copied().unwrap_or_default();
        let tail = |at: usize| (job(at), unsigned(frames[at]));
        let Some((place, descending)) = self.order.by else {
            rows.visit(frames.len(), |at| visit(key(None, false, tail(at))));
            return Ok(());
        };
        let count = frames.len();
        match &*rows.column(place)? {
            Column::Missing(_) => rows.visit(count, |at| visit(key(Some(None), descending, tail(at)))),
            Column::Numbers(values) => rows.visit(count, |at| {
                let value = (!values[at].is_nan()).then(|| ordered(values[at]));
                visit(key(Some(value), descending, tail(at)));
            }),
            Column::Wholes { values, missing, .. } => rows.visit(count, |at| {
                let is_missing = missing.get(at).copied().unwrap_or(false);
                let value = (!is_missing).then(|| unsigned(values[at]));
                visit(key(Some(value), descending, tail(at)));
            }),
            Column::Texts { codes, texts } => {
                let places = places(texts, &self.texts);
                rows.visit(count, |at| {
                    let value = (codes[at] != NO_TEXT).then(|| places[usize::from(codes[at])]);
                    visit(key(Some(value), descending, tail(at)));
                });
            }
        }
        Ok(())
    }

    /// The smallest key of a row after this one. A text that no row has is ranked between its neighbors.
    fn after(&self, value: Option<&Sorted>, job: &str, frame: i64) -> Key {
        let place_of_job = self.jobs.partition_point(|one| **one < *job);
        let is_job_known = self.jobs.get(place_of_job).is_some_and(|known| **known == *job);
        let mut tail = (place_of_job as u64, 0);
        if is_job_known {
            tail.1 = unsigned(frame).saturating_add(1);
        }
        let Some((_, descending)) = self.order.by else {
            return key(None, false, tail);
        };
        let value = value.map(|value| match value {
            Sorted::Number(number) => ordered(*number),
            Sorted::Whole(whole) => unsigned(*whole),
            Sorted::Text(text) => {
                let place = self.texts.partition_point(|one| **one < **text);
                if self.texts.get(place).is_none_or(|known| **known != **text) {
                    // The text at its place is greater: all of its rows follow, or none.
                    tail = if descending { (u64::MAX, u64::MAX) } else { (0, 0) };
                }
                place as u64
            }
        });
        key(Some(value), descending, tail)
    }
}

/// A key of an optional value, job and frame.
#[inline]
fn key(value: Option<Option<u64>>, descending: bool, (job, frame): (u64, u64)) -> Key {
    let (missing, value) = match value {
        None => (0, 0),
        Some(None) => (1, 0),
        Some(Some(value)) if descending => (0, !value),
        Some(Some(value)) => (0, value),
    };
    [missing, value, job, frame]
}

/// Places of a part's texts among all.
fn places(texts: &[Arc<str>], all: &[Arc<str>]) -> Vec<u64> {
    texts
        .iter()
        .map(|text: &Arc<str>| all.binary_search(text).unwrap_or_else(|place| place) as u64)
        .collect()
}

/// A whole number with a sign in the order of those without.
#[inline]
fn unsigned(whole: i64) -> u64 {
    (whole ^ i64::MIN) as u64
}

fn signed(ordered: u64) -> i64 {
    ordered as i64 ^ i64::MIN
}

/// A double in the order of whole numbers; the two zeros are the same.
#[inline]
fn ordered(number: f64) -> u64 {
    let bits = (number + 0.0).to_bits();
    if bits >> 63 == 1 { !bits } else { bits | 1 << 63 }
}

/// The key of a rank; `None` beyond the last row.
fn select(masked: &Masked<'_>, keys: &Keys, rank: u64) -> Result<Option<Key>, ColumnarError> {
    let extents = masked.pass(
        || (0, [u64::MAX; 4], FIRST),
        |(count, low, high), rows| {
            keys.visit(rows, |key| {
                *count += 1;
                *low = key.min(*low);
                *high = key.max(*high);
            })
        },
    )?;
    let all = extents.into_iter();
    let (mut count, mut low, mut high) = all
        .reduce(|one, other| (one.0 + other.0, one.1.min(other.1), one.2.max(other.2)))
        .unwrap_or((0, FIRST, FIRST));
    if rank >= count {
        return Ok(None);
    }
    let mut rank = rank;
    while count > FEW && low != high {
        let bit = highest_difference(&low, &high);
        let counts = masked.pass(
            || vec![0_u64; 1 << DIGIT],
            |counts, rows| {
                keys.visit(rows, |key| {
                    if low <= key && key <= high {
                        counts[digit(&key, bit)] += 1;
                    }
                })
            },
        )?;
        let mut chosen = 0;
        count = total(&counts, chosen);
        while count <= rank {
            rank -= count;
            chosen += 1;
            count = total(&counts, chosen);
        }
        (low, high) = with_digit(&low, bit, chosen as u64);
    }
    let gathered = masked.pass(Vec::new, |gathered, rows| {
        keys.visit(rows, |key| {
            if low <= key && key <= high {
                gathered.push(key);
            }
        })
    })?;
    let mut gathered = gathered.concat();
    let (_, found, _) = gathered.select_nth_unstable(rank as usize);
    Ok(Some(*found))
}

/// The `most` smallest keys from one on, in order.
fn smallest(masked: &Masked<'_>, keys: &Keys, first: &Key, most: usize) -> Result<Vec<Key>, ColumnarError> {
    let most = most.max(1);
    let found = masked.pass(
        || (Vec::with_capacity(2 * most), [u64::MAX; 4]),
        |(found, last), rows| {
            keys.visit(rows, |key| {
                if key < *first || key > *last {
                    return;
                }
                found.push(key);
                if found.len() == 2 * most {
                    *last = *found.select_nth_unstable(most - 1).1;
                    found.truncate(most);
                }
            })
        },
    )?;
    let mut found: Vec<Key> = found.into_iter().flat_map(|(found, _)| found).collect();
    found.sort_unstable();
    found.truncate(most);
    Ok(found)
}

/// Position of the highest bit in which two keys differ.
fn highest_difference(one: &Key, other: &Key) -> u32 {
    let word = (0..4).find(|&word| one[word] != other[word]).unwrap_or(3);
    64 * word as u32 + (one[word] ^ other[word]).leading_zeros()
}

/// The bits of a key from one on; behind the last there are zeros.
#[inline]
fn digit(key: &Key, at: u32) -> usize {
    let (word, bit) = ((at / 64) as usize, at % 64);
    let next = key.get(word + 1).copied().unwrap_or_default();
    let pair = u128::from(key[word]) << 64 | u128::from(next);
    (pair >> (128 - DIGIT - bit)) as usize & ((1 << DIGIT) - 1)
}

/// The least and the greatest key that begins as this one does and then has a digit.
fn with_digit(key: &Key, at: u32, digit: u64) -> (Key, Key) {
    let (mut low, mut high) = (*key, *key);
    for bit in at..256 {
        let (word, mask) = ((bit / 64) as usize, 1 << (63 - bit % 64));
        let is_set = bit - at < DIGIT && digit >> (DIGIT - 1 - (bit - at)) & 1 == 1;
        let is_open = bit - at >= DIGIT;
        low[word] = if is_set {
            low[word] | mask
        } else {
            low[word] & !mask
        };
        high[word] = if is_set || is_open {
            high[word] | mask
        } else {
            high[word] & !mask
        };
    }
    (low, high)
}

#[cfg(test)]
mod tests;
