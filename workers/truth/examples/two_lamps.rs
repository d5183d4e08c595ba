//! Time and errors of the truth of a frame at night: boxes in front of a wall in jerlov-1C, two spots of 35° next to the camera.
//!
//! ```sh
//! cargo run --release -p truth --example two_lamps -- 64
//! ```
//!
//! The argument is the number of paths of each pixel, a power of two from 32 on. Prints the CPU time, the error of the median block by order of scattering,
//! relative to the mean of each channel, and the CPU time that would bring the error of all light to 2 %.

use imaging::geometry::Intrinsics;
use imaging::rays::{Hit, Rays};
use imaging::vector::{DVec3, vec3};
use optics::lamp::FournierForand;
use truth::{
    Estimate, Goal, Lambertian, LightPart, PathBatch, Phase, PixelBlocks, SphereLamp, SurfaceMaterials,
    TracedScene, TurbidityField, WaterCoefficients, converge,
};

const SIZE: (usize, usize) = (96, 62);
/// Side of a block, pixels.
const BLOCK: usize = 8;
const TARGET: f64 = 0.02;
/// Low and high corner of each box, m. The first is the wall, which is also the ground.
const BOXES: [[[f64; 3]; 2]; 6] = [
    [[-20.0, -20.0, 4.5], [20.0, 20.0, 6.0]],
    [[-20.0, 1.4, 0.0], [20.0, 2.0, 6.0]],
    [[-1.6, -2.0, 2.6], [-1.2, 1.5, 3.0]],
    [[0.9, -2.0, 3.1], [1.3, 1.5, 3.5]],
    [[-2.5, -0.3, 2.7], [2.5, 0.0, 2.9]],
    [[0.1, 0.8, 1.8], [0.7, 1.5, 2.3]],
];

/// Solid boxes.
struct Boxes;

impl Rays for Boxes {
    fn hit(&self, origin: [f64; 3], direction: [f64; 3], from: f64, to: f64) -> Option<Hit> {
        let met = BOXES.iter().enumerate().filter_map(|(object, [low, high])| {
            let (mut enter, mut leave, mut facing) = (f64::NEG_INFINITY, f64::INFINITY, 0);
            for axis in 0..3 {
                let [a, b] = [low, high].map(|corner| (corner[axis] - origin[axis]) / direction[axis]);
                if a.min(b) > enter {
                    (enter, facing) = (a.min(b), axis);
                }
                leave = leave.min(a.max(b));
            }
            let mut normal = [0.0; 3];
            normal[facing] = -direction[facing].signum();
            (enter <= leave && enter >= from && enter <= to).then_some(Hit {
                distance: enter,
                normal,
                object: object as u32,
            })
        });
        met.min_by(|a, b| a.distance.total_cmp(&b.distance))
    }
}

fn scene() -> TracedScene<'static> {
    let water = [(0.366, 0.412), (0.099, 0.447), (0.159, 0.435)];
    let reflectances = [0.25, 0.35, 0.3, 0.3, 0.15, 0.5];
    TracedScene {
        rays: &Boxes,
        surfaces: SurfaceMaterials::ByObject(reflectances.map(Lambertian::gray).to_vec()),
        lamps: vec![spot([-0.6, -0.3, 0.1]), spot([0.6, -0.3, 0.1])],
        sea: None,
        water: water.map(|(absorption, scattering)| WaterCoefficients {
            absorption,
            scattering,
        }),
        phase: Phase::fournier_forand(FournierForand::of_backscatter(0.0183)),
        turbidity: TurbidityField::Even,
    }
}

fn spot(place: [f64; 3]) -> SphereLamp {
    let place = DVec3::from(place);
    SphereLamp {
        place,
        intensity: [8.0; 3],
        beam: Some((
            (vec3(0.0, 0.2, 3.0) + -place).normalized(),
            35f64.to_radians().cos(),
        )),
        radius_m: 0.02,
        disc_m: 0.02,
    }
}

fn main() {
    let argument = std::env::args().nth(1);
    let most_paths = argument.map_or(64, |text| text.parse().expect("a number of paths"));
    let scene = scene();
    let batch = PathBatch {
        camera: Intrinsics::centered(90.0, SIZE.0, SIZE.1),
        width: SIZE.0,
        frame: 0,
        stream: truth::stream(7),
    };
    let begin = cpu_seconds();
    // No error is 0, so all paths are traced.
    let goal = Goal {
        target: 0.0,
        block: BLOCK,
        most_paths,
    };
    let traced = converge(SIZE, &goal, |samples| {
        Some(batch.trace(&scene, 0..SIZE.0 * SIZE.1, &samples))
    });
    let estimate = traced.expect("paths").estimate;
    let seconds = cpu_seconds() - begin;
    println!(
        "{} paths: {seconds:.2} CPU s, {} cut",
        estimate.paths,
        estimate.cut()
    );
    for channel in 0..3 {
        let whole = estimate.whole(channel, LightPart::All);
        let parts = [
            LightPart::All,
            LightPart::Unscattered,
            LightPart::Single,
            LightPart::Multiple,
        ];
        let described = parts.map(|part| {
            let share = estimate.whole(channel, part).mean / whole.mean;
            let median = median_error(&estimate, channel, part) / whole.mean;
            format!("{part:?} {share:.3} ± {:.2} %", 100.0 * median)
        });
        let error = median_error(&estimate, channel, LightPart::All) / whole.mean;
        println!(
            "channel {channel}: mean {:.5e} ± {:.1e}; {}; {:.0} CPU s to {TARGET}",
            whole.mean,
            whole.error,
            described.join(", "),
            seconds * (error / TARGET).powi(2)
        );
    }
}

/// The error of the median block.
fn median_error(estimate: &Estimate, channel: usize, part: LightPart) -> f64 {
    let blocks = PixelBlocks {
        size: SIZE,
        side: BLOCK,
    };
    let errors = blocks
        .pixels()
        .map(|pixels| estimate.mean(&pixels, channel, part).error);
    let mut errors: Vec<f64> = errors.collect();
    errors.sort_by(f64::total_cmp);
    errors[errors.len() / 2]
}

/// Seconds of this thread on a CPU.
fn cpu_seconds() -> f64 {
    let text =
        std::fs::read_to_string("/proc/thread-self/schedstat").expect("Linux with scheduler statistics");
    let nanoseconds = text.split(' ').next().expect("the time on a CPU");
    nanoseconds.parse::<f64>().expect("a number") / 1e9
}
