//! The tile of one depth in f64.

use imaging::Plane;
use imaging::fft::{self, Complex};

use super::Waves;
use crate::daylight::conditions::Blur;
use crate::daylight::model::REFRACTIVE_INDEX;

/// Rays along each side of a cell.
pub const RAYS_PER_CELL: usize = 2;

/// How rays are bent at the surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Refraction {
    /// By `(1 − 1/n)` times the slope, as the fast form has it.
    Small,
    /// By Snell's law, for light that falls straight down on the slope.
    Exact,
}

/// The tile at a depth in meters, rows along the second level axis: rays from `rays_per_cell` points along each side of a cell,
/// each distributed to the four cells around its end, blurred, at least 0 and scaled to a mean of 1.
#[must_use]
pub fn tile_reference(
    waves: &Waves,
    blur: &Blur,
    depth_m: f64,
    rays_per_cell: usize,
    refraction: Refraction,
) -> Plane<f64> {
    let (cells, side) = (waves.cells, rays_per_cell * waves.cells);
    let all = waves.all();
    let mut tile = vec![0.0; cells * cells];
    let each = 1.0 / (rays_per_cell * rays_per_cell) as f64;
    for j in 0..side {
        for i in 0..side {
            let place = [i, j].map(|at| (at as f64 + 0.5) * waves.tile_m / side as f64);
            let mut slope = [0.0; 2];
            for wave in &all {
                let [kx, ky] = wave.vector;
                let sine = (kx * place[0] + ky * place[1] + wave.phase).sin();
                slope[0] -= wave.amplitude * kx * sine;
                slope[1] -= wave.amplitude * ky * sine;
            }
            let aside = bent(slope, refraction);
            let cell = [0, 1].map(|axis| {
                let end = place[axis] + depth_m * aside[axis];
                (end / waves.tile_m * cells as f64 - 0.5).rem_euclid(cells as f64)
            });
            share_out(&mut tile, cells, cell, each);
        }
    }
    blurred(&mut tile, waves, blur, depth_m);
    normalized(&mut tile);
    Plane::new(cells, cells, tile).expect("a square of cells")
}

/// How far light that falls straight down goes aside in each meter, where the surface has this slope.
fn bent(slope: [f64; 2], refraction: Refraction) -> [f64; 2] {
    let small = 1.0 - 1.0 / REFRACTIVE_INDEX;
    match refraction {
        Refraction::Small => slope.map(|g| small * g),
        Refraction::Exact => {
            let steep = slope[0].hypot(slope[1]);
            if steep == 0.0 {
                return [0.0; 2];
            }
            let angle = steep.atan();
            let turned = angle - (angle.sin() / REFRACTIVE_INDEX).asin();
            slope.map(|g| turned.tan() * g / steep)
        }
    }
}

fn share_out(tile: &mut [f64], cells: usize, cell: [f64; 2], light: f64) {
    let first = cell.map(|at| at.floor());
    let [u, v] = [0, 1].map(|axis| cell[axis] - first[axis]);
    let [x, y] = first.map(|at| at as usize % cells);
    let (right, below) = ((x + 1) % cells, (y + 1) % cells);
    tile[y * cells + x] += light * (1.0 - u) * (1.0 - v);
    tile[y * cells + right] += light * u * (1.0 - v);
    tile[below * cells + x] += light * (1.0 - u) * v;
    tile[below * cells + right] += light * u * v;
}

fn blurred(tile: &mut [f64], waves: &Waves, blur: &Blur, depth_m: f64) {
    let cells = waves.cells;
    let ffts = fft::double(cells);
    let mut spectrum: Vec<Complex<f64>> = tile.iter().map(|&v| Complex::new(v, 0.0)).collect();
    let transposed = |from: &[Complex<f64>]| -> Vec<Complex<f64>> {
        let at = |i: usize| from[(i % cells) * cells + i / cells];
        (0..cells * cells).map(at).collect()
    };
    ffts.forward.process(&mut spectrum);
    spectrum = transposed(&spectrum);
    ffts.forward.process(&mut spectrum);
    let transfer = blur.at(depth_m);
    let frequency = |k: usize| k.min(cells - k) as f64 / waves.tile_m;
    for (i, value) in spectrum.iter_mut().enumerate() {
        let (a, b) = (frequency(i / cells), frequency(i % cells));
        *value *= transfer(a.hypot(b)) / (cells * cells) as f64;
    }
    ffts.inverse.process(&mut spectrum);
    spectrum = transposed(&spectrum);
    ffts.inverse.process(&mut spectrum);
    for (to, value) in tile.iter_mut().zip(&spectrum) {
        *to = value.re;
    }
}

fn normalized(tile: &mut [f64]) {
    tile.iter_mut().for_each(|v| *v = v.max(0.0));
    let mean = tile.iter().sum::<f64>() / tile.len() as f64;
    tile.iter_mut().for_each(|v| *v /= mean);
}
