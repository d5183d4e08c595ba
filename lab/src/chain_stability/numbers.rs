//! Numbers at the limits of f32.

use imaging::Plane;
use optics::attenuation::scattered_share;
use optics::plan::StageId;
use spec::{Fidelity, ScatterModel};

use super::trial::{PLENTY, ROUNDING, TOLERANCE, Trial, from, noise, slope, water};
use super::{Figure, Finding, pictures};

const SIZE: (usize, usize) = (48, 32);

/// Kernels far narrower than a pixel and far wider than the frame.
#[must_use]
pub fn tiny_and_huge_spreads() -> Finding {
    const SPREADS: [f64; 8] = [1e-9, 1e-6, 1e-3, 0.1, 1.0, 10.0, 1e3, 1e5];
    let trial = |model, spread| Trial {
        radiance: noise(SIZE, 1.0),
        range: slope(SIZE, 0.5, 20.0),
        water: water(model, spread),
    };
    let worst = |model| {
        let errors = SPREADS.map(|spread| trial(model, spread).error(Fidelity::Tolerance(TOLERANCE)));
        errors.into_iter().fold(0.0, f64::max)
    };
    let flat = trial(ScatterModel::Jaffe, 1e5).fast(PLENTY).forward_scatter;
    let green = flat.planes()[1].data();
    let (least, most) = green.iter().fold((f32::MAX, 0.0f32), |(least, most), &v| {
        (least.min(v), most.max(v))
    });
    let shown = (320, 200);
    let shown = [0.01, 1.0, 10.0, 1e5].map(|spread| {
        let trial = Trial {
            radiance: noise(shown, 1.0),
            range: slope(shown, 0.5, 20.0),
            water: water(ScatterModel::Simplified, spread),
        };
        trial.fast(Fidelity::Tolerance(TOLERANCE)).scattered
    });
    Finding {
        test: "tiny_and_huge_spreads",
        tried: "Noise on a slope from 0.5 to 20 m with spreads from 1e-9 to 1e5 pixels per meter, the most that a job may ask for.",
        figures: vec![
            Figure::at_most(
                "error at tolerance 3e-4, jaffe",
                worst(ScatterModel::Jaffe),
                TOLERANCE,
            ),
            Figure::at_most(
                "error at tolerance 3e-4, simplified",
                worst(ScatterModel::Simplified),
                TOLERANCE,
            ),
            Figure::at_most(
                "unevenness of the spread light at 1e5 px/m: largest over smallest, less 1",
                f64::from(most / least) - 1.0,
                0.02,
            ),
        ],
        meaning: "Any spread can be asked for. Kernels wider than four times the longer side of the frame are cut there: the \
                  light is then even over the frame, and a wider one would change nothing.",
        picture: Some((
            "spreads",
            "Noise under water, simplified form: 0.01, 1, 10 and 1e5 pixels per meter.",
            pictures::row(&shown),
        )),
    }
}

/// With almost no forward scatter, a difference of exponentials loses its digits.
#[must_use]
pub fn g_close_to_c() -> Finding {
    let c = 0.12f64;
    let meters = [0.01f32, 0.1, 1.0, 10.0];
    let excesses = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-7];
    let (mut ours, mut naive) = (0.0f64, 0.0f64);
    for excess in excesses {
        for z in meters {
            let g = c - excess;
            let exact = (-g * f64::from(z)).exp() * -(-excess * f64::from(z)).exp_m1();
            let relative = |share: f32| (f64::from(share) / exact - 1.0).abs();
            ours = ours.max(relative(scattered_share(g as f32, excess as f32, z)));
            naive = naive.max(relative((-(g as f32) * z).exp() - (-(c as f32) * z).exp()));
        }
    }
    let trial = |excess: f64| Trial {
        radiance: noise(SIZE, 1.0),
        range: slope(SIZE, 0.5, 20.0),
        water: from(
            [0.37 - excess, 0.12 - excess, 0.09 - excess],
            ScatterModel::Jaffe,
            [1.0; 3],
        ),
    };
    let errors = excesses.map(|excess| trial(excess.min(0.09)).error(Fidelity::Tolerance(TOLERANCE)));
    let equal = trial(0.0);
    let plan = equal.plan(PLENTY);
    let skipped = (0..3).all(|channel| plan.variant(StageId::ForwardScatter(channel)).is_skipped());
    Finding {
        test: "g_close_to_c",
        tried: "The share of the light that arrives scattered, e^{−GZ} − e^{−cZ}, for c − G from 0.1 down to 1e-7 per meter and \
                ranges from a centimeter to ten meters; then frames with such G, and with G = c.",
        figures: vec![
            Figure::at_most("relative error of the share in f32", ours, 1e-6),
            Figure::at_least("the same by plain subtraction", naive, 0.5),
            Figure::at_most(
                "error of frames at tolerance 3e-4",
                errors.into_iter().fold(0.0, f64::max),
                TOLERANCE,
            ),
            Figure::at_least(
                "channels skipped at G = c, of 3",
                if skipped { 3.0 } else { 0.0 },
                3.0,
            ),
        ],
        meaning: "G may come as near to c as one likes: nothing cancels, and at G = c forward scatter is left out at no cost.",
        picture: None,
    }
}

/// Light far above 1.
#[must_use]
pub fn bright_lamps() -> Finding {
    let mut figures = Vec::new();
    let mut above = 0.0f64;
    let mut relative = 0.0f64;
    let mut bound_at_most = 0.0;
    for peak in [1.0f32, 1e2, 1e4, 1e6] {
        let trial = Trial {
            radiance: noise(SIZE, 1.0).map(|&v| if v > 0.97 { peak } else { v }),
            range: slope(SIZE, 0.5, 20.0),
            water: water(ScatterModel::Jaffe, 1.0),
        };
        let plan = trial.plan(Fidelity::Tolerance(TOLERANCE));
        let bounds = plan.errors().map(|error| error.bound_sample(f64::from(peak)));
        let bound = bounds.into_iter().fold(0.0, f64::max);
        let error = trial.error(Fidelity::Tolerance(TOLERANCE));
        above = above.max(error / bound);
        relative = relative.max(trial.error(PLENTY) / f64::from(peak));
        bound_at_most = bound;
    }
    figures.push(Figure::at_most(
        "error over the plan's bound, peaks up to 1e6",
        above,
        1.0,
    ));
    figures.push(Figure::at_most(
        "error with 24 kernels over the peak",
        relative,
        ROUNDING,
    ));
    figures.push(Figure::at_least(
        "bound that the plan states for a peak of 1e6 and a tolerance of 3e-4",
        bound_at_most,
        TOLERANCE,
    ));
    Finding {
        test: "bright_lamps",
        tried: "Specks of radiance 1, 100, 1e4 and 1e6 among light below 1.",
        figures,
        meaning: "Bright light is spread as exactly as f32 can, two parts in a million of its peak. Where that is more than the \
                  tolerance, the plan says so in its bound; it does not promise what it cannot keep.",
        picture: None,
    }
}

/// From a millimeter to a thousand kilometers.
#[must_use]
pub fn very_short_and_very_long_ranges() -> Finding {
    let trial = |nearest, farthest| Trial {
        radiance: noise(SIZE, 1.0),
        range: slope(SIZE, nearest, farthest),
        water: water(ScatterModel::Jaffe, 1.0),
    };
    let opaque = trial(1e5, 1e6).fast(Fidelity::Tolerance(TOLERANCE)).scattered;
    let veil = [0.03f32, 0.12, 0.18];
    let planes = opaque.planes().iter().zip(veil);
    let off = planes.flat_map(|(plane, veil)| plane.data().iter().map(move |v| f64::from((v - veil).abs())));
    let touching = Trial {
        range: Plane::filled(SIZE.0, SIZE.1, 0.001),
        ..trial(1.0, 2.0)
    };
    let seen = touching.fast(Fidelity::Tolerance(TOLERANCE)).scattered;
    let pairs = seen.planes().iter().zip(touching.radiance.planes());
    let lost = pairs.flat_map(|(a, b)| {
        a.data()
            .iter()
            .zip(b.data())
            .map(|(a, b)| f64::from((a - b).abs()))
    });
    Finding {
        test: "very_short_and_very_long_ranges",
        tried: "Slopes from 1 mm to 1000 km, a wall at 1 mm, and a scene between 100 and 1000 km.",
        figures: vec![
            Figure::at_most(
                "error at tolerance 3e-4, 1 mm to 1000 km",
                trial(0.001, 1e6).error(Fidelity::Tolerance(TOLERANCE)),
                TOLERANCE,
            ),
            Figure::at_most(
                "difference from the veil beyond 100 km",
                off.fold(0.0, f64::max),
                0.0,
            ),
            Figure::at_most("light lost at 1 mm", lost.fold(0.0, f64::max), 1e-3),
        ],
        meaning: "Transmittance may underflow to 0, which is right: what is out of sight shows the veil, to the last bit.",
        picture: None,
    }
}

/// The error of f32 alone.
#[must_use]
pub fn f32_against_f64() -> Finding {
    let trial = |model| Trial {
        radiance: noise(SIZE, 1.0),
        range: slope(SIZE, 0.5, 20.0),
        water: water(model, 1.0),
    };
    let error = |model| trial(model).error(PLENTY);
    Finding {
        test: "f32_against_f64",
        tried: "24 kernels, so that no error of interpolation is left; light up to 1.",
        figures: vec![
            Figure::at_most("error, jaffe", error(ScatterModel::Jaffe), ROUNDING),
            Figure::at_most("error, simplified", error(ScatterModel::Simplified), ROUNDING),
            Figure::at_most(
                "error, attenuation alone",
                error(ScatterModel::None),
                ROUNDING / 2.0,
            ),
        ],
        meaning: "f32 takes a few parts in ten million: a hundredth of the default tolerance. No job gains by f64; the reference \
                  is there to prove that.",
        picture: None,
    }
}

/// The tolerance is below the precision of f32.
#[must_use]
pub fn a_tolerance_below_f32() -> Finding {
    let trial = Trial {
        radiance: noise(SIZE, 1.0),
        range: slope(SIZE, 0.5, 20.0),
        water: water(ScatterModel::Jaffe, 1.0),
    };
    let asked = Fidelity::Tolerance(1e-9);
    let bound = trial
        .plan(asked)
        .promise()
        .map_or(f64::NAN, |promise| promise.bound);
    Finding {
        test: "a_tolerance_below_f32",
        tried: "A tolerance of 1e-9.",
        figures: vec![
            Figure::at_most("error over the stated bound", trial.error(asked) / bound, 1.0),
            Figure::at_least("bound that the plan states", bound, 1e-9),
        ],
        meaning: "The plan takes many kernels and states a bound above the tolerance: read `promise` in the record, not the \
                  tolerance that was asked for. The `reference` fidelity is the way to more, for small frames.",
        picture: None,
    }
}
