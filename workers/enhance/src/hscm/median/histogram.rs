//! Any odd side: a histogram of the window slides along each row, and the median follows it from one pixel to the
//! next (Huang, Yang and Tang 1979).

use imaging::Plane;

pub(super) fn median(picture: &Plane<u8>, window_px: usize) -> Plane<u8> {
    let (width, height) = picture.size();
    let radius = window_px / 2;
    let rank = (window_px * window_px / 2) as u16;
    let column_of = |x: usize| x.saturating_sub(radius).min(width - 1);
    let mut medians = Vec::with_capacity(width * height);
    for y in 0..height {
        let rows: Vec<&[u8]> = (y..=y + 2 * radius)
            .map(|row| picture.row(row.saturating_sub(radius).min(height - 1)))
            .collect();
        let mut window = Window {
            counts: [0; 256],
            median: 0,
            below: 0,
        };
        for x in 0..window_px {
            window.add(&rows, column_of(x));
        }
        medians.push(window.settle(rank));
        for x in 1..width {
            window.remove(&rows, column_of(x - 1));
            window.add(&rows, column_of(x + 2 * radius));
            medians.push(window.settle(rank));
        }
    }
    Plane::new(width, height, medians).expect("one median for each pixel")
}

struct Window {
    counts: [u16; 256],
    median: u8,
    /// Codes in the window that are less than `median`.
    below: u16,
}

impl Window {
    fn add(&mut self, rows: &[&[u8]], column: usize) {
        for row in rows {
            let code = row[column];
            self.counts[usize::from(code)] += 1;
            self.below += u16::from(code < self.median);
        }
    }

    fn remove(&mut self, rows: &[&[u8]], column: usize) {
        for row in rows {
            let code = row[column];
            self.counts[usize::from(code)] -= 1;
            self.below -= u16::from(code < self.median);
        }
    }

    /// Moves `median` to the code that has at most `rank` codes below it and more than `rank` up to itself.
    fn settle(&mut self, rank: u16) -> u8 {
        while self.below > rank {
            self.median -= 1;
            self.below -= self.counts[usize::from(self.median)];
        }
        while self.below + self.counts[usize::from(self.median)] <= rank {
            self.below += self.counts[usize::from(self.median)];
            self.median += 1;
        }
        self.median
    }
}
