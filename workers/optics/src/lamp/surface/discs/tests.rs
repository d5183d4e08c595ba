use imaging::Plane;
use imaging::geometry::Intrinsics;
use imaging::rays::Hit;

use super::super::shade::LIT;
use super::*;
use crate::lamp::normals_of;

const WALL_M: f64 = 4.0;
/// Half the width of each post.
const POSTS: [([f64; 2], f64); 3] = [([-0.5, 2.0], 0.15), ([0.6, 3.0], 0.05), ([1.1, 3.7], 0.02)];
const LAMP: [f32; 3] = [0.8, -0.4, 0.3];

/// A wall, and square posts before it.
struct Posts;

impl Rays for Posts {
    fn hit(&self, origin: [f64; 3], direction: [f64; 3], from: f64, to: f64) -> Option<Hit> {
        let wall = ((WALL_M - origin[2]) / direction[2], [0.0, 0.0, -1.0]);
        let post = |([x, z], half): ([f64; 2], f64)| {
            let [begin, end] = [(0, x), (2, z)]
                .map(|(axis, middle): (usize, f64)| {
                    let meet = |side: f64| (middle + side - origin[axis]) / direction[axis];
                    let (one, other) = (meet(-half), meet(half));
                    [one.min(other), one.max(other)]
                })
                .into_iter()
                .reduce(|a, b| [a[0].max(b[0]), a[1].min(b[1])])?;
            (begin < end).then_some((begin, [0.0, 0.0, -1.0]))
        };
        let met = POSTS.into_iter().filter_map(post).chain([wall]);
        let met = met.filter(|(distance, _)| (from..=to).contains(distance));
        met.min_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(distance, normal)| Hit {
                distance,
                normal,
                object: 0,
            })
    }
}

/// Interpolated shares of the discs of all pixels, and exact shares of each pixel.
fn found_and_exact((width, height): (usize, usize), scattering: [f64; 3]) -> [Vec<[f32; 3]>; 2] {
    let camera = Intrinsics::centered(0.8 * width as f64, width, height);
    let range = Plane::from_fn(width, height, |x, y| {
        let ray = camera.ray(x as f64, y as f64);
        let direction = <[f64; 3]>::from(ray).map(|v| v / ray.length());
        Posts
            .hit([0.0; 3], direction, 0.0, 1e3)
            .map_or(f32::INFINITY, |hit| hit.distance as f32)
    });
    let normals = normals_of(&range, &camera);
    let lighting = Lighting {
        lamps: Vec::new(),
        attenuation: [0.4; 3],
        absorption: Some([0.1; 3]),
        scattering,
        phase: crate::lamp::GlowPhase::henyey_greenstein(0.9),
        radius_m: 0.02,
        camera,
        patches: None,
    };
    let (facing, seen) = (vec![LIT; width * height], vec![1.0; width * height]);
    let lit = LitSurfaces {
        surfaces: Surfaces {
            camera: &camera,
            range: &range,
            normals: &normals,
        },
        facing: &facing,
        seen: &seen,
    };
    let discs = Discs::new(&lighting, LAMP, &Posts, lit);
    let found = (0..height).flat_map(|y| {
        let row = discs.of_row(y);
        (0..width).map(|x| row.map(|lane| lane[x])).collect::<Vec<_>>()
    });
    let pixels: Vec<Cell> = (0..width * height)
        .map(|at| Cell {
            x: at % width,
            y: at / width,
            step: 1,
        })
        .collect();
    let [red, green, blue] = scattering.map(|b| {
        let mut search = Search::new(&lighting, (LAMP, b), &Posts, lit);
        search.look_from_corners(&pixels);
        search.shares
    });
    let exact = (0..red.len()).map(|at| [red[at], green[at], blue[at]]);
    [found.collect(), exact.collect()]
}

/// The mean difference is far below 0.143, the error of sixteen samples for the share of a disc, and hardly a pixel differs by more
/// than that.
#[test]
fn what_is_read_is_nearly_what_each_pixel_sees() {
    for scattering in [[0.41, 0.45, 0.43], [0.1, 0.9, 0.5]] {
        for size in [(1, 1), (9, 3), (203, 131), (641, 427)] {
            let [found, exact] = found_and_exact(size, scattering);
            let differences = || {
                let both = found.iter().flatten().zip(exact.iter().flatten());
                both.map(|(found, exact)| (found - exact).abs())
            };
            let count = (3 * size.0 * size.1) as f32;
            let mean = differences().sum::<f32>() / count;
            let wrong = differences().filter(|difference| *difference > 0.143).count() as f32 / count;
            assert!(
                mean < 0.015 && wrong < 0.02,
                "{size:?} {scattering:?}: {mean} {wrong}"
            );
            if size.0 > 100 {
                let hidden = exact.iter().flatten().filter(|share| **share < 0.5).count() as f32 / count;
                assert!(hidden > 0.03, "hardly anything is in shadow: {hidden}");
            }
        }
    }
}
