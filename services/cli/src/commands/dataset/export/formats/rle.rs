//! Masks as runs, in the compressed form of the COCO tools: counts of pixels outside and inside of an object in turns, column by
//! column, each beyond the third less the one before the last, in digits of five bits.

use std::collections::BTreeMap;

use imaging::Plane;

/// The runs of every object of an instance mask, by its number; 0 is the background and has none.
pub(crate) fn runs_of(mask: &Plane<u16>) -> BTreeMap<u16, Runs> {
    let mut all: BTreeMap<u16, Runs> = BTreeMap::new();
    let mut run = (0, 0);
    let mut place = 0;
    for x in 0..mask.width() {
        for y in 0..mask.height() {
            let number = mask.pixel(x, y);
            if number != run.0 {
                close(&mut all, run, place);
                run = (number, place);
            }
            place += 1;
        }
    }
    close(&mut all, run, place);
    for runs in all.values_mut() {
        if runs.end < place {
            runs.counts.push(place - runs.end);
        }
    }
    all
}

fn close(all: &mut BTreeMap<u16, Runs>, (number, start): (u16, u64), end: u64) {
    if number == 0 || start == end {
        return;
    }
    let runs = all.entry(number).or_default();
    runs.counts.extend([start - runs.end, end - start]);
    runs.area += end - start;
    runs.end = end;
}

/// The runs of one object.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Runs {
    /// Pixels outside, inside, outside and so on.
    counts: Vec<u64>,
    /// Where the last run inside ends.
    end: u64,
    /// Pixels inside.
    pub(crate) area: u64,
}

impl Runs {
    /// The compressed form.
    pub(crate) fn compressed(&self) -> String {
        let mut text = String::new();
        for (index, &count) in self.counts.iter().enumerate() {
            let before = if index > 2 { self.counts[index - 2] } else { 0 };
            push_digits(&mut text, count as i64 - before as i64);
        }
        text
    }
}

/// The lowest five bits first; a sixth bit marks that more digits follow; offset by the character `0`. The last digit has the sign.
fn push_digits(text: &mut String, mut rest: i64) {
    loop {
        let digit = (rest & 0x1f) as u8;
        rest >>= 5;
        let is_last = if digit & 0x10 == 0 { rest == 0 } else { rest == -1 };
        text.push(char::from(b'0' + if is_last { digit } else { digit | 0x20 }));
        if is_last {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Decodes a compressed form like the COCO tools.
    fn read(text: &str) -> Vec<u64> {
        let mut counts: Vec<i64> = Vec::new();
        let mut bytes = text.bytes();
        while bytes.len() > 0 {
            let (mut value, mut shift) = (0i64, 0);
            loop {
                let digit = i64::from(bytes.next().unwrap() - b'0');
                value |= (digit & 0x1f) << shift;
                shift += 5;
                if digit & 0x20 == 0 {
                    if digit & 0x10 != 0 {
                        value |= -1 << shift;
                    }
                    break;
                }
            }
            if counts.len() > 2 {
                value += counts[counts.len() - 2];
            }
            counts.push(value);
        }
        counts.into_iter().map(|count| count as u64).collect()
    }

    #[test]
    fn runs_go_down_the_columns_and_cover_the_mask() {
        // Columns: 1 1 0 | 1 2 2 | 2 0 2.
        let columns = [[1, 1, 0], [1, 2, 2], [2, 0, 2]];
        let mask = Plane::from_fn(3, 3, |x, y| columns[x][y]);
        let all = runs_of(&mask);
        assert_eq!(all.keys().copied().collect::<Vec<_>>(), [1, 2]);
        assert_eq!((&all[&1].counts[..], all[&1].area), (&[0, 2, 1, 1, 5][..], 3));
        assert_eq!((&all[&2].counts[..], all[&2].area), (&[4, 3, 1, 1][..], 4));
    }

    #[test]
    fn the_compressed_form_is_that_of_the_coco_tools() {
        // pycocotools.mask.encode of the same masks.
        let half = Plane::from_fn(4, 2, |x, _| u16::from(x >= 2));
        assert_eq!(runs_of(&half)[&1].compressed(), "44");
        let corner = Plane::from_fn(40, 30, |x, y| u16::from(x > 7 && y > 11) * 9);
        let columns = "0".repeat(61);
        assert_eq!(runs_of(&corner)[&9].compressed(), format!("l7b0<{columns}"));
    }

    #[test]
    fn large_and_falling_counts_survive() {
        let mask = Plane::from_fn(300, 200, |x, y| u16::from((x * 7 + y * 13) % (50 + x) < 20) * 5);
        let runs = &runs_of(&mask)[&5];
        assert_eq!(read(&runs.compressed()), runs.counts);
        assert_eq!(runs.counts.iter().sum::<u64>(), 300 * 200);
    }
}
