//! Features whose patch is entirely inside a mask.

use imaging::Plane;

/// Sums of masked-out pixels above and to the left, for rectangles in constant time.
pub(crate) struct PatchMask {
    width: usize,
    height: usize,
    /// One more column and row than the mask.
    sums: Vec<u32>,
}

impl PatchMask {
    /// Pixels of value 0 are masked out.
    pub(crate) fn new(mask: &Plane<u8>) -> Self {
        let (width, height) = mask.size();
        let mut sums = vec![0; (width + 1) * (height + 1)];
        for y in 0..height {
            let (above, here) = sums[y * (width + 1)..].split_at_mut(width + 1);
            let mut row = 0;
            for (x, &code) in mask.row(y).iter().enumerate() {
                row += u32::from(code == 0);
                here[x + 1] = above[x + 1] + row;
            }
        }
        Self { width, height, sums }
    }

    /// Whether all pixels touched by the square from (left, top) to (right, bottom), in pixels, are inside the mask.
    pub(crate) fn contains(&self, [left, top, right, bottom]: [f64; 4]) -> bool {
        let [left, right] = [left.floor(), right.ceil()].map(|x| x.clamp(0.0, self.width as f64) as usize);
        let [top, bottom] = [top.floor(), bottom.ceil()].map(|y| y.clamp(0.0, self.height as f64) as usize);
        let sum = |x: usize, y: usize| self.sums[y * (self.width + 1) + x];
        sum(right, bottom) + sum(left, top) == sum(left, bottom) + sum(right, top)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_is_inside_if_it_touches_no_masked_pixel() {
        let mask = Plane::from_fn(8, 6, |x, y| if (x, y) == (5, 3) { 0 } else { 255 });
        let patches = PatchMask::new(&mask);
        assert!(patches.contains([0.0, 0.0, 5.0, 6.0]));
        assert!(!patches.contains([0.0, 0.0, 5.1, 6.0]));
        assert!(patches.contains([5.0, 0.0, 8.0, 3.0]));
        assert!(!patches.contains([5.9, 3.9, 9.0, 9.0]));
        assert!(patches.contains([6.0, 3.0, 8.0, 9.0]));
    }
}
