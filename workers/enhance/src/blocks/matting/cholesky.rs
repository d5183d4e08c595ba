//! Cholesky factors of the matting system by nested dissection (George 1973) and fronts (Duff and Reid 1983).
//!
//! A rectangle of pixels is cut by a strip two pixels wide, the reach of the coefficients; its halves are cut
//! recursively down to small ones. A part is eliminated after the parts inside it. Its Schur complement is a dense
//! matrix over the surrounding pixels, which is added to the next larger part.

use imaging::Plane;

use super::front::Front;
use super::laplacian::Laplacian;
use super::windows::{RIM, STEPS};

/// Larger rectangles are cut.
const LEAF_PX: usize = 48;
/// Width of a cut: the reach of a coefficient.
const CUT_PX: usize = RIM;

/// `L` of `L Lᵀ = A`, part by part in the order of elimination.
pub(super) struct CholeskyFactor {
    width: usize,
    parts: Vec<Supernode>,
}

/// Pixels that are eliminated together.
struct Supernode {
    /// Positions of the pixels.
    own: Vec<usize>,
    /// Positions of the later pixels reached by their rows.
    ring: Vec<usize>,
    /// The columns of these pixels in `L`: first their rows, then those of `ring`; row-major.
    columns: Vec<f64>,
}

/// Columns `x.0..x.1` and rows `y.0..y.1`.
#[derive(Clone, Copy)]
struct Rectangle {
    x: (usize, usize),
    y: (usize, usize),
}

impl CholeskyFactor {
    /// Factors `L + λ E`.
    pub(super) fn new(laplacian: &Laplacian, closeness: f64) -> Self {
        let whole = Rectangle {
            x: (0, laplacian.width),
            y: (0, laplacian.height),
        };
        let mut elimination = Elimination {
            laplacian,
            closeness,
            places: vec![usize::MAX; laplacian.width * laplacian.height],
            parts: Vec::new(),
        };
        elimination.eliminate(whole);
        Self {
            width: laplacian.width,
            parts: elimination.parts,
        }
    }

    /// Solves `A x = b`.
    pub(super) fn solved(&self, mut b: Plane<f64>) -> Plane<f64> {
        debug_assert_eq!(b.width(), self.width);
        let x = b.data_mut();
        for part in &self.parts {
            part.forward(x);
        }
        for part in self.parts.iter().rev() {
            part.backward(x);
        }
        b
    }
}

struct Elimination<'l> {
    laplacian: &'l Laplacian,
    closeness: f64,
    /// Index of each pixel in the current front.
    places: Vec<usize>,
    parts: Vec<Supernode>,
}

/// The Schur complement of an eliminated rectangle over the surrounding pixels: the lower half of a dense matrix.
struct Remainder {
    ring: Vec<usize>,
    rows: Vec<f64>,
}

impl Elimination<'_> {
    fn eliminate(&mut self, rectangle: Rectangle) -> Remainder {
        let (own, halves) = rectangle.cut();
        let remainders: Vec<Remainder> = halves.into_iter().map(|half| self.eliminate(half)).collect();
        let (width, height) = (self.laplacian.width, self.laplacian.height);
        let own: Vec<usize> = own.pixels(width).collect();
        let ring: Vec<usize> = rectangle.ring(width, height);
        let mut front = Front::new(own.len(), ring.len());
        for (place, &pixel) in own.iter().chain(&ring).enumerate() {
            self.places[pixel] = place;
        }
        self.add_rows(&own, &mut front);
        for remainder in remainders {
            self.add_remainder(&remainder, &mut front);
        }
        for &pixel in own.iter().chain(&ring) {
            self.places[pixel] = usize::MAX;
        }
        front.eliminate();
        let (columns, rows) = front.into_parts();
        self.parts.push(Supernode {
            own,
            ring: ring.clone(),
            columns,
        });
        Remainder { ring, rows }
    }

    /// Adds the coefficients among the eliminated pixels, and from these to the ring. TileCoefficients of previously
    /// eliminated pixels were added with those.
    fn add_rows(&self, own: &[usize], front: &mut Front) {
        let width = self.laplacian.width;
        for (place, &pixel) in own.iter().enumerate() {
            let (x, y) = (pixel % width, pixel / width);
            let coefficients = self.laplacian.of_pixel(x, y);
            front.add(place, place, coefficients[0] + self.closeness);
            for ((columns, rows), coefficient) in STEPS.into_iter().zip(coefficients).skip(1) {
                // To the later pixel, and from the earlier one at the opposite step.
                if let Some(other) = self.place(x.wrapping_add_signed(columns), y + rows) {
                    front.add(place, other, coefficient);
                }
                let (earlier_x, earlier_y) = (x.wrapping_add_signed(-columns), y.wrapping_sub(rows));
                // Pairs of eliminated pixels were added above, from the earlier one.
                if let Some(other) = self
                    .place(earlier_x, earlier_y)
                    .filter(|&other| other >= own.len())
                {
                    let step = STEPS
                        .iter()
                        .position(|step| *step == (columns, rows))
                        .unwrap_or(0);
                    front.add(place, other, self.laplacian.of_pixel(earlier_x, earlier_y)[step]);
                }
            }
        }
    }

    /// Index of a pixel in the front; `None` outside of the picture or the front.
    fn place(&self, x: usize, y: usize) -> Option<usize> {
        if x >= self.laplacian.width || y >= self.laplacian.height {
            return None;
        }
        Some(self.places[y * self.laplacian.width + x]).filter(|&place| place != usize::MAX)
    }

    fn add_remainder(&self, remainder: &Remainder, front: &mut Front) {
        let count = remainder.ring.len();
        for (i, &pixel) in remainder.ring.iter().enumerate() {
            for (j, &other) in remainder.ring[..=i].iter().enumerate() {
                front.add(
                    self.places[pixel],
                    self.places[other],
                    remainder.rows[i * count + j],
                );
            }
        }
    }
}

impl Rectangle {
    /// The pixels to eliminate last, and the rectangles on both sides of them. A small rectangle is eliminated whole,
    /// others are cut across the longer side.
    fn cut(self) -> (Self, Vec<Self>) {
        let (width, height) = (self.x.1 - self.x.0, self.y.1 - self.y.0);
        if width * height <= LEAF_PX || width.max(height) < 2 * CUT_PX + 1 {
            return (self, Vec::new());
        }
        if width >= height {
            let [first, cut, second] = split(self.x).map(|x| Self { x, ..self });
            (cut, vec![first, second])
        } else {
            let [first, cut, second] = split(self.y).map(|y| Self { y, ..self });
            (cut, vec![first, second])
        }
    }

    fn pixels(self, width: usize) -> impl Iterator<Item = usize> {
        (self.y.0..self.y.1).flat_map(move |y| (self.x.0..self.x.1).map(move |x| y * width + x))
    }

    /// Positions of the surrounding pixels within the reach of coefficients.
    fn ring(self, width: usize, height: usize) -> Vec<usize> {
        let [x, y] = [(self.x, width), (self.y, height)]
            .map(|((start, end), side)| (start.saturating_sub(RIM), (end + RIM).min(side)));
        Self { x, y }
            .pixels(width)
            .filter(|pixel| {
                !((self.x.0..self.x.1).contains(&(pixel % width))
                    && (self.y.0..self.y.1).contains(&(pixel / width)))
            })
            .collect()
    }
}

impl Supernode {
    fn row(&self, row: usize) -> &[f64] {
        &self.columns[row * self.own.len()..][..self.own.len()]
    }

    /// Solves `L y = b` for these rows, and subtracts from the later ones.
    fn forward(&self, x: &mut [f64]) {
        let mut y: Vec<f64> = self.own.iter().map(|&pixel| x[pixel]).collect();
        for i in 0..y.len() {
            let row = self.row(i);
            let taken: f64 = row[..i].iter().zip(&y).map(|(l, y)| l * y).sum();
            y[i] = (y[i] - taken) / row[i];
        }
        for (i, &pixel) in self.ring.iter().enumerate() {
            let row = self.row(self.own.len() + i);
            x[pixel] -= row.iter().zip(&y).map(|(l, y)| l * y).sum::<f64>();
        }
        self.store(x, &y);
    }

    /// Solves `Lᵀ x = y` for these columns; later pixels must be known.
    fn backward(&self, x: &mut [f64]) {
        let mut y: Vec<f64> = self.own.iter().map(|&pixel| x[pixel]).collect();
        for (i, &pixel) in self.ring.iter().enumerate() {
            let known = x[pixel];
            for (y, l) in y.iter_mut().zip(self.row(self.own.len() + i)) {
                *y -= l * known;
            }
        }
        for i in (0..y.len()).rev() {
            let row = self.row(i);
            y[i] /= row[i];
            let known = y[i];
            for (y, l) in y[..i].iter_mut().zip(row) {
                *y -= l * known;
            }
        }
        self.store(x, &y);
    }

    fn store(&self, x: &mut [f64], y: &[f64]) {
        for (&pixel, &value) in self.own.iter().zip(y) {
            x[pixel] = value;
        }
    }
}

/// A side before, inside and after its cut.
fn split((start, end): (usize, usize)) -> [(usize, usize); 3] {
    let cut = start + (end - start - CUT_PX) / 2;
    [(start, cut), (cut, cut + CUT_PX), (cut + CUT_PX, end)]
}
