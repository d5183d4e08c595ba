//! Numbers at the limits of f32.

use imaging::Plane;
use optics::attenuation::scattered_share;
use optics::plan::StageId;
use spec::{HoleRule, ScatterModel};

use super::finding::Finding;
use super::trial::{DEFAULT, PLENTY, ROUNDING, TOLERANCE, Trial, coastal, coastal_at};
use crate::statistics::largest;

const SIZE: (usize, usize) = (48, 32);
const RANGE_M: [f32; 2] = [0.5, 20.0];

/// Kernels far narrower than a pixel and far wider than the frame.
pub(super) fn measure_spreads() -> Finding {
    const SPREADS: [f64; 8] = [1e-9, 1e-6, 1e-3, 0.1, 1.0, 10.0, 1e3, 1e5];
    let [jaffe, simplified] = [ScatterModel::Jaffe, ScatterModel::Simplified].map(|model| {
        largest(SPREADS.map(|spread| Trial::on_slope(SIZE, RANGE_M, coastal(model, spread)).error(DEFAULT)))
    });
    let wide = Trial::on_slope(SIZE, RANGE_M, coastal(ScatterModel::Jaffe, 1e5));
    let scattered = wide.render(PLENTY).forward_scatter;
    let green = scattered.planes()[1].data().iter().copied();
    let (least, most) = (green.clone().fold(f32::MAX, f32::min), green.fold(0.0, f32::max));
    Finding::default()
        .at_most("error, jaffe", jaffe, TOLERANCE)
        .at_most("error, simplified", simplified, TOLERANCE)
        .at_most("unevenness at 1e5 px/m", f64::from(most / least) - 1.0, 0.02)
}

/// Forward scatter g below c by this excess in each channel.
fn trial_near_c(excess: f64) -> Trial {
    let g = [0.37, 0.12, 0.09].map(|c| c - excess);
    Trial::on_slope(SIZE, RANGE_M, coastal_at(Some(g), HoleRule::Background))
}

/// With almost no forward scatter, a difference of exponentials loses its digits.
pub(super) fn measure_cancellation() -> Finding {
    let c = 0.12f64;
    let excesses = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-7];
    let (mut ours, mut naive) = (0.0f64, 0.0f64);
    for excess in excesses {
        for z in [0.01f32, 0.1, 1.0, 10.0] {
            let g = c - excess;
            let exact = (-g * f64::from(z)).exp() * -(-excess * f64::from(z)).exp_m1();
            let shares = [
                scattered_share(g as f32, excess as f32, z),
                (-(g as f32) * z).exp() - (-(c as f32) * z).exp(),
            ];
            let [own, plain] = shares.map(|share| (f64::from(share) / exact - 1.0).abs());
            (ours, naive) = (ours.max(own), naive.max(plain));
        }
    }
    let errors = excesses.map(|excess| trial_near_c(excess.min(0.09)).error(DEFAULT));
    let plan = trial_near_c(0.0).plan(PLENTY);
    let skipped = (0..3).filter(|&channel| plan.variant(StageId::ForwardScatter(channel)).is_skipped());
    Finding::default()
        .at_most("relative error in f32", ours, 1e-6)
        .at_least("the same by plain subtraction", naive, 0.5)
        .at_most("error of frames", largest(errors), TOLERANCE)
        .at_least("channels skipped at G = c", skipped.count() as f64, 3.0)
}

/// Light far above 1.
pub(super) fn measure_bright_lamps() -> Finding {
    let (mut above, mut relative, mut bound) = (0.0f64, 0.0f64, 0.0);
    for peak in [1.0f32, 1e2, 1e4, 1e6] {
        let mut trial = Trial::on_slope(SIZE, RANGE_M, coastal(ScatterModel::Jaffe, 1.0));
        trial.radiance = trial.radiance.map(|&v| if v > 0.97 { peak } else { v });
        let plan = trial.plan(DEFAULT);
        bound = plan.error().bound_sample(f64::from(peak));
        above = above.max(trial.error(DEFAULT) / bound);
        relative = relative.max(trial.error(PLENTY) / f64::from(peak));
    }
    Finding::default()
        .at_most("error over the bound, peaks up to 1e6", above, 1.0)
        .at_most("error over the peak, 24 kernels", relative, ROUNDING)
        .at_least("bound for a peak of 1e6", bound, TOLERANCE)
}

/// From a millimeter to a thousand kilometers.
pub(super) fn measure_ranges() -> Finding {
    let ranges_m = [[0.001, 1e6], [1e5, 1e6], [1.0, 2.0]];
    let [widest, far, mut touching] =
        ranges_m.map(|range_m| Trial::on_slope(SIZE, range_m, coastal(ScatterModel::Jaffe, 1.0)));
    let error = widest.error(DEFAULT);
    let opaque = far.render(DEFAULT).scattered;
    let planes = opaque.planes().iter().zip([0.03f32, 0.12, 0.18]);
    let off = planes.flat_map(|(plane, veil)| plane.data().iter().map(move |v| f64::from((v - veil).abs())));
    touching.range = Plane::filled(SIZE.0, SIZE.1, 0.001);
    let seen = touching.render(DEFAULT).scattered;
    let pairs = seen.planes().iter().zip(touching.radiance.planes());
    let pairs = pairs.flat_map(|(a, b)| a.data().iter().zip(b.data()));
    let lost = largest(pairs.map(|(a, b)| f64::from((a - b).abs())));
    Finding::default()
        .at_most("error, 1 mm to 1000 km", error, TOLERANCE)
        .at_most("off the veil beyond 100 km", largest(off), 0.0)
        .at_most("light lost at 1 mm", lost, 1e-3)
}

/// The error of f32 alone: 24 kernels leave no error of interpolation.
pub(super) fn measure_rounding() -> Finding {
    let models = [ScatterModel::Jaffe, ScatterModel::Simplified, ScatterModel::None];
    let [jaffe, simplified, none] =
        models.map(|model| Trial::on_slope(SIZE, RANGE_M, coastal(model, 1.0)).error(PLENTY));
    Finding::default()
        .at_most("error, jaffe", jaffe, ROUNDING)
        .at_most("error, simplified", simplified, ROUNDING)
        .at_most("error, attenuation alone", none, ROUNDING / 2.0)
}

/// The tolerance is below the precision of f32.
pub(super) fn measure_tiny_tolerance() -> Finding {
    let trial = Trial::on_slope(SIZE, RANGE_M, coastal(ScatterModel::Jaffe, 1.0));
    let fidelity = spec::Fidelity::Tolerance(1e-9);
    let promise = trial.plan(fidelity).promise();
    let bound = promise.map_or(f64::NAN, |promise| promise.bound);
    Finding::default()
        .at_most("error over the bound", trial.error(fidelity) / bound, 1.0)
        .at_least("bound of the plan", bound, 1e-9)
}
