//! Groups of rows: by the values of columns and by bins of them.

mod coded;

use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

use crate::bins::Bins;
use crate::error::ColumnarError;
use crate::parts::Masked;
pub use coded::Cell;
use coded::Coded;

/// A grouping column, by its position among the columns of the query.
#[derive(Debug, Clone, Copy)]
pub struct GroupBy {
    /// The place.
    pub column: usize,
    /// Its bins; `None`: each value is a group.
    pub bins: Option<Bins>,
}

/// The group of a row that the query leaves out.
pub(crate) const NO_GROUP: u32 = u32::MAX;

/// Groups and which rows belong to them.
pub(crate) struct Grouped {
    pub(crate) keys: Vec<Vec<Cell>>,
    /// Part by part and row by row; empty for a part without rows, and without columns.
    pub(crate) groups: Vec<Vec<u32>>,
}

/// The groups that have rows, in no order; more than `most` are an error.
pub(crate) fn grouped(
    masked: &Masked<'_>,
    by: &[GroupBy],
    most: Option<usize>,
) -> Result<Grouped, ColumnarError> {
    let mut groups = vec![Vec::new(); masked.query.parts.len()];
    if by.is_empty() {
        // Without columns all rows are one group, unless there are none.
        let any = masked.source.files + masked.source.memory > 0;
        return Ok(Grouped {
            keys: vec![Vec::new(); usize::from(any)],
            groups,
        });
    }
    let known: Mutex<HashMap<Vec<Cell>, u32>> = Mutex::default();
    let place = |key: Vec<Cell>| {
        let mut known = known.lock().unwrap_or_else(PoisonError::into_inner);
        let next = known.len();
        let place = *known.entry(key).or_insert(next as u32);
        if let Some(most) = most.filter(|most| known.len() > *most) {
            return Err(ColumnarError::TooManyGroups(most));
        }
        Ok(place)
    };
    let passed = masked.pass(Vec::new, |all, rows| {
        let coded = by
            .iter()
            .map(|by| Ok(Coded::new(rows.column(by.column)?, by.bins)));
        let coded = coded.collect::<Result<Vec<_>, ColumnarError>>()?;
        let length = coded.first().map_or(0, |coded| coded.codes.len());
        let mut groups = vec![NO_GROUP; length];
        let mut places = Places::new(&coded, length);
        let mut failed = None;
        rows.visit(length, |at| {
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
        keys[place as usize] = key;
    }
    Ok(Grouped { keys, groups })
}

/// The groups of a part by the codes of its rows.
enum Places {
    /// Of each combination, and the combination of each row.
    Few(Vec<u32>, Vec<u32>),
    Many(HashMap<Vec<u32>, u32>),
}

impl Places {
    /// Most combinations for a table; clearing a larger one would take longer than a search.
    const FEW: usize = 1 << 16;

    fn new(coded: &[Coded], rows: usize) -> Self {
        let all = coded
            .iter()
            .try_fold(1_usize, |all, one| all.checked_mul(one.cells.len()));
        let Some(all) = all.filter(|all| *all <= Self::FEW) else {
            return Self::Many(HashMap::new());
        };
        let mut joined = vec![0; rows];
        for one in coded {
            one.codes.join(&mut joined, one.cells.len() as u32);
        }
        Self::Few(vec![NO_GROUP; all], joined)
    }

    #[inline]
    fn of_row(
        &mut self,
        coded: &[Coded],
        at: usize,
        place: impl Fn(Vec<Cell>) -> Result<u32, ColumnarError>,
    ) -> Result<u32, ColumnarError> {
        let key = || {
            let cells = coded
                .iter()
                .map(|one| one.cells[one.codes.of_row(at) as usize].clone());
            place(cells.collect())
        };
        match self {
            Self::Few(groups, joined) => {
                let group = &mut groups[joined[at] as usize];
                if *group == NO_GROUP {
                    *group = key()?;
                }
                Ok(*group)
            }
            Self::Many(groups) => {
                let codes: Vec<u32> = coded.iter().map(|one| one.codes.of_row(at)).collect();
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
