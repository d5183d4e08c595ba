use imaging::dct::Dct2;

use super::*;
use crate::kernel::Transfer;

/// Side of the mirror box, pixels.
const SIDE: usize = 32;

/// Sum of the absolute values of a filter on the mirror box, given on the grid of the cosine transform: the larger of those around a
/// corner and around the middle.
fn mass(filter: &[f64]) -> f64 {
    let mut transform = Dct2::new(SIDE, SIDE);
    let mut sums: f64 = 0.0;
    for at in [0, SIDE / 2 * SIDE + SIDE / 2] {
        let mut point = vec![0.0; SIDE * SIDE];
        point[at] = 1.0;
        transform.forward(&mut point);
        for (value, h) in point.iter_mut().zip(filter) {
            *value *= h;
        }
        transform.inverse(&mut point);
        sums = sums.max(point.iter().map(|v| v.abs()).sum());
    }
    sums
}

fn response(gate: &Gate) -> Vec<f64> {
    let [narrow, wide] = gate
        .gammas
        .map(|gamma| Transfer::behind_gates(gamma).grid(SIDE, SIDE));
    let pairs = narrow.iter().zip(&wide);
    pairs
        .map(|(n, v)| gate.direct + gate.spread[0] * n + gate.spread[1] * v)
        .collect()
}

fn gate(amplification: f64, gamma: f64, ratio: f64, wide: f64) -> Gate {
    let direct = (-amplification).exp();
    Gate {
        range_m: 1.0,
        direct,
        spread: [(1.0 - direct) * (1.0 - wide), (1.0 - direct) * wide],
        gammas: [gamma, ratio * gamma],
    }
}

/// Gates of a water that scatters only, with `amplification` attenuation lengths per meter.
fn passages(amplification: f64, gates: &[Gate]) -> Passages {
    Passages {
        gates: gates.iter().copied().map(Some).collect(),
        spread_attenuation: 0.0,
        direct_attenuation: amplification,
    }
}

const AMPLIFICATIONS: [f64; 7] = [0.1, 0.5, 2.0, 5.0, 9.0, 14.0, 20.0];

#[test]
fn filters_at_gates_sum_to_no_more_than_their_sharpness_allows() {
    let mut nearest = 0.0f64;
    for amplification in AMPLIFICATIONS {
        for gamma in [0.1, 0.5, 1.0, 3.0, 6.0] {
            for (ratio, wide) in [(1.0, 0.0), (5.0, 0.3), (20.0, 0.7), (20.0, 0.97)] {
                let gate = gate(amplification, gamma, ratio, wide);
                let Passage::Through(through) = passages(amplification, &[gate]).of_layer(1) else {
                    panic!("the gate is open");
                };
                let response = response(&gate);
                for kernel in [0, 1] {
                    for share in [0.0, 0.5, 1.0] {
                        let top = Transfer::behind_gates(share * gate.gammas[kernel]).grid(SIDE, SIDE);
                        let quotient: Vec<f64> = top.iter().zip(&response).map(|(h, a)| h / a).collect();
                        let (mass, gain) = (mass(&quotient), through.gain(kernel, share));
                        assert!(
                            mass <= gain * (1.0 + 1e-9),
                            "κ {amplification}, γ {gamma}, {ratio} times, share {wide}: {mass} above {gain}"
                        );
                        nearest = nearest.max(mass / gain);
                    }
                }
            }
        }
    }
    assert!(nearest > 0.8, "{nearest}");
}

#[test]
fn from_gate_to_gate_errors_grow_by_no_more_than_a_step() {
    for amplification in AMPLIFICATIONS {
        for gamma in [0.2, 1.0, 4.0] {
            for farther in [0.7, 0.95, 1.05, 1.5, 3.0] {
                let near = gate(amplification, gamma, 20.0, 0.7);
                let far = Gate {
                    range_m: farther,
                    ..gate(amplification * farther, gamma * farther, 20.0, 0.7)
                };
                let quotient: Vec<f64> = response(&far)
                    .iter()
                    .zip(response(&near))
                    .map(|(far, near)| far / near)
                    .collect();
                let passages = passages(amplification, &[near, far]);
                let (mass, step) = (
                    mass(&quotient),
                    passages.sharpness(&near) * passages.reverse(&near, &far),
                );
                assert!(
                    mass <= step * (1.0 + 1e-9),
                    "κ {amplification}, γ {gamma}, {farther}: {mass} above {step}"
                );
            }
        }
    }
}
