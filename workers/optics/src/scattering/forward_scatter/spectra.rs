//! Folded planes and their spectra.

use imaging::Plane;
use imaging::dct::Folding;
use imaging::fft::Complex;

use super::KernelCache;
use super::decimation::line;

/// The planes of some spectra.
pub(super) fn back(spectra: &[Vec<f32>], size: (usize, usize), cache: &mut KernelCache) -> Vec<Plane<f32>> {
    let (width, height) = size;
    let folding = Folding::new(width, height);
    let mut planes = Vec::new();
    for spectra in spectra.chunks(2) {
        let mut data: Vec<_> = spectra
            .iter()
            .map(|_| cache.buffers.take(width * height))
            .collect();
        cache.transform(size).inverse(
            |p, column| {
                let (one, other) = (&spectra[0], &spectra[spectra.len() - 1]);
                let band = line(p, height);
                let values = one[band.clone()].iter().zip(&other[band]);
                column
                    .iter_mut()
                    .zip(values)
                    .for_each(|(to, (&one, &other))| *to = Complex::new(one, other));
            },
            width,
            |place, row| {
                let pixels = line(folding.row(place), width);
                for (part, data) in data.iter_mut().enumerate() {
                    let positive = |value: Complex<f32>| if part == 0 { value.re } else { value.im }.max(0.0);
                    folding.unfold_row(row, positive, &mut data[pixels.clone()]);
                }
            },
        );
        let plane = |data| Plane::new(width, height, data).expect("the size of the source");
        planes.extend(data.into_iter().map(plane));
    }
    planes
}

/// Back in row-major order. The truth is never negative, so the clamp can only bring the result nearer.
pub(super) fn unfolded(
    folded: &[f32],
    (width, height): (usize, usize),
    cache: &mut KernelCache,
) -> Plane<f32> {
    let folding = Folding::new(width, height);
    let mut data = cache.buffers.take(folded.len());
    for (place, row) in folded.chunks_exact(width.max(1)).enumerate() {
        folding.unfold_row(
            row,
            |value| value.max(0.0),
            &mut data[line(folding.row(place), width)],
        );
    }
    Plane::new(width, height, data).expect("the size of the image")
}

pub(super) fn zeros(count: usize, (width, height): (usize, usize), cache: &mut KernelCache) -> Vec<Vec<f32>> {
    let zeros = |_| {
        let mut zeros = cache.buffers.take(width * height);
        zeros.fill(0.0);
        zeros
    };
    (0..count).map(zeros).collect()
}
