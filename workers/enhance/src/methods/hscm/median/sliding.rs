//! The median of a window of any side by a histogram that slides along each row (Huang, Yang and Tang 1979).

use imaging::Plane;

/// The median of each window of `side` × `side` pixels, `side` odd.
pub(super) fn median(picture: &Plane<u8>, side: usize) -> Plane<u8> {
    let (width, height) = picture.size();
    let radius = side / 2;
    let mut medians = Plane::filled(width, height, 0u8);
    for y in 0..height {
        let rows: Vec<&[u8]> = (y..y + side)
            .map(|row| picture.row(row.saturating_sub(radius).min(height - 1)))
            .collect();
        let mut window = Window::new((side * side / 2) as u32);
        for x in 0..side {
            window.add(&rows, x.saturating_sub(radius).min(width - 1));
        }
        let medians = medians.row_mut(y);
        for x in 0..width {
            medians[x] = window.median();
            window.remove(&rows, x.saturating_sub(radius));
            window.add(&rows, (x + radius + 1).min(width - 1));
        }
    }
    medians
}

/// The codes of a window.
struct Window {
    counts: [u32; 256],
    /// A code near the median, and the number of codes below it.
    code: usize,
    below: u32,
    /// Number of codes below the median in sorted order.
    middle: u32,
}

impl Window {
    fn new(middle: u32) -> Self {
        Self {
            counts: [0; 256],
            code: 0,
            below: 0,
            middle,
        }
    }

    fn add(&mut self, rows: &[&[u8]], column: usize) {
        for row in rows {
            let code = usize::from(row[column]);
            self.counts[code] += 1;
            self.below += u32::from(code < self.code);
        }
    }

    fn remove(&mut self, rows: &[&[u8]], column: usize) {
        for row in rows {
            let code = usize::from(row[column]);
            self.counts[code] -= 1;
            self.below -= u32::from(code < self.code);
        }
    }

    fn median(&mut self) -> u8 {
        while self.below > self.middle {
            self.code -= 1;
            self.below -= self.counts[self.code];
        }
        while self.below + self.counts[self.code] <= self.middle {
            self.below += self.counts[self.code];
            self.code += 1;
        }
        self.code as u8
    }
}
