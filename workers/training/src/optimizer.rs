//! Adam (Kingma and Ba 2015) with a learning rate that rises for a tenth of the steps and then falls along a cosine.

use style::net::layer::Weights;

const PEAK: f64 = 2e-3;
/// Ratios of the peak rate to the first and to the last.
const FIRST: f64 = 25.0;
const LAST: f64 = 250_000.0;
const WARM_UP: f64 = 0.1;
const BETAS: [f64; 2] = [0.9, 0.999];
const EPSILON: f64 = 1e-8;
/// Longer gradients are scaled down.
const LONGEST: f64 = 1.0;

/// Moments of the gradient and the number of completed steps.
pub(crate) struct Adam {
    moments: Vec<[f64; 2]>,
    done: usize,
}

impl Adam {
    pub(crate) fn new(count: usize) -> Self {
        Self {
            moments: vec![[0.0; 2]; count],
            done: 0,
        }
    }

    pub(crate) fn done(&self) -> usize {
        self.done
    }

    /// Performs one of `steps` steps down a gradient.
    pub(crate) fn step(&mut self, weights: &mut Weights, gradient: Weights, steps: usize) {
        let squares = gradient
            .values()
            .iter()
            .map(|&value| f64::from(value) * f64::from(value));
        let length = squares.sum::<f64>().sqrt();
        let scale = if length > LONGEST { LONGEST / length } else { 1.0 };
        let rate = rate(self.done, steps);
        self.done += 1;
        let corrections = BETAS.map(|beta| 1.0 - libm::pow(beta, self.done as f64));
        let pairs = weights.values_mut().iter_mut().zip(gradient.values());
        for ((weight, &value), moments) in pairs.zip(&mut self.moments) {
            let value = f64::from(value) * scale;
            for ((moment, power), beta) in moments.iter_mut().zip([value, value * value]).zip(BETAS) {
                *moment = beta * *moment + (1.0 - beta) * power;
            }
            let (mean, square) = (moments[0] / corrections[0], moments[1] / corrections[1]);
            *weight = (f64::from(*weight) - rate * mean / (square.sqrt() + EPSILON)) as f32;
        }
    }
}

fn rate(step: usize, steps: usize) -> f64 {
    let position = step as f64 / steps.max(2).saturating_sub(1) as f64;
    let (start, end, share) = if position < WARM_UP {
        (PEAK / FIRST, PEAK, position / WARM_UP)
    } else {
        (PEAK, PEAK / LAST, (position - WARM_UP) / (1.0 - WARM_UP))
    };
    end + (start - end) / 2.0 * (1.0 + libm::cos(std::f64::consts::PI * share.clamp(0.0, 1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rate_rises_to_its_peak_and_falls_to_nothing() {
        let rates: Vec<f64> = (0..101).map(|step| rate(step, 101)).collect();
        assert!((rates[0] - PEAK / FIRST).abs() < 1e-12 && (rates[100] - PEAK / LAST).abs() < 1e-12);
        assert!((rates[10] - PEAK).abs() < 1e-12);
        assert!(rates[..11].is_sorted() && rates[10..].is_sorted_by(|a, b| a >= b));
    }

    #[test]
    fn it_finds_the_bottom_of_a_bowl() {
        let mut weights = Weights::zeros(false);
        let mut adam = Adam::new(weights.values().len());
        for _ in 0..1000 {
            let gradient = weights.map(|&value: &f32| value - 0.25);
            adam.step(&mut weights, gradient, 1000);
        }
        assert!(weights.values().iter().all(|value| (value - 0.25).abs() < 0.01));
    }
}
