//! Reference vectors of truth: every folder `mc-…` under `tests/vectors/realism`, and under `realism/` of each path in
//! `FATHOM_GOLDEN_EXTRA`. Both sides have noise: values agree within four standard errors.

use std::path::{Path, PathBuf};

use crate::support::{Mean, Solids, TestSolid, along, radiance, scene, water};
use imaging::codec::{self, NpyValues};
use imaging::geometry::Intrinsics;
use imaging::vector::vec3;
use optics::lamp::FournierForand;
use serde_json::Value;
use truth::{Along, Lambertian, Phase, Sea, SphereLamp};

pub(crate) struct Case {
    folder: PathBuf,
    parameters: Value,
}

impl Case {
    pub(crate) fn read(folder: &Path) -> Self {
        let text = std::fs::read_to_string(folder.join("params.json")).expect("params.json");
        Self {
            folder: folder.to_owned(),
            parameters: serde_json::from_str(&text).expect("JSON"),
        }
    }

    pub(crate) fn number(&self, pointer: &str) -> f64 {
        let value = self.parameters.pointer(pointer).and_then(Value::as_f64);
        value.unwrap_or_else(|| panic!("{}: {pointer}", self.folder.display()))
    }

    pub(crate) fn triple(&self, pointer: &str) -> [f64; 3] {
        [0, 1, 2].map(|i| self.number(&format!("{pointer}/{i}")))
    }

    pub(crate) fn array(&self, name: &str) -> Vec<f64> {
        let bytes = std::fs::read(self.folder.join(format!("{name}.npy"))).expect("an array");
        match codec::decode_npy(&bytes).expect("NPY").values {
            NpyValues::F64(values) => values,
            _ => panic!("{name} is not f64"),
        }
    }

    fn phase(&self) -> Phase {
        Phase::fournier_forand(FournierForand {
            index: self.number("/phase_parameters/n"),
            slope: self.number("/phase_parameters/mu"),
        })
    }

    fn water(&self) -> truth::WaterCoefficients {
        water(self.number("/absorption"), self.number("/scattering"))
    }

    /// Checks means against an array and its standard errors.
    fn agrees(&self, means: &[Mean], name: &str, errors: &str) {
        let (values, errors) = (self.array(name), self.array(errors));
        assert_eq!(means.len(), values.len());
        let pairs = means.iter().zip(values.iter().zip(&errors));
        for (i, (mean, (value, error))) in pairs.clone().enumerate() {
            mean.agrees(*value, *error, &format!("{} {name} {i}", self.folder.display()));
        }
        let square = pairs.map(|(mean, (value, error))| {
            (mean.mean - value).powi(2) / (mean.error.powi(2) + error.powi(2)).max(1e-30)
        });
        let chi = square.sum::<f64>() / means.len() as f64;
        println!("   {} {name}: χ² {chi:.2}", self.folder.display());
    }
}

fn slab(case: &Case) {
    let (albedo, depth) = (case.number("/albedo"), case.number("/optical_thickness"));
    let solids = Solids(vec![TestSolid::Wall(-1e-9), TestSolid::Wall(depth)]);
    let sides = [0, 1].map(|side| {
        let mut materials = vec![Lambertian::BLACK; 2];
        materials[side] = Lambertian::glowing(1.0);
        let phase = Phase::henyey_greenstein(case.number("/g"));
        let scene = scene(&solids, materials, water(1.0 - albedo, albedo), phase);
        radiance(&scene, along([0.0, 0.0, 1.0]), 10 + side as u64, 50_000)
    });
    let direct = sides[1][0];
    case.agrees(&[sides[0][3], sides[1][3], direct], "mean", "standard_error");
}

fn pole(case: &Case) {
    let (near, far) = (case.number("/pole_z"), case.number("/wall_z"));
    let half = case.number("/pole_half_width_tan") * near;
    let solids = Solids(vec![TestSolid::Plate { z: near, half }, TestSolid::Wall(far)]);
    let places = case.array("tan_x");
    for (name, side) in [("near", 0), ("far", 1)] {
        let mut materials = vec![Lambertian::BLACK; 2];
        materials[side] = Lambertian::glowing(1.0);
        let scene = scene(&solids, materials, case.water(), case.phase());
        let ray = |(i, x): (usize, &f64)| radiance(&scene, along([*x, 0.0, 1.0]), i as u64, 20_000)[3];
        let means: Vec<Mean> = places.iter().enumerate().map(ray).collect();
        case.agrees(&means, name, &format!("{name}_se"));
    }
}

fn light_from_above(case: &Case) {
    let solids = Solids(Vec::new());
    let up = vec3(0.0, -1.0, 0.0);
    let mut scene = scene(&solids, Vec::new(), case.water(), case.phase());
    scene.sea = Some(Sea {
        up,
        depth_m: case.number("/depth_m"),
        sky: [1.0; 3],
        sun: None,
    });
    let ray = |(i, mu): (usize, &f64)| {
        let along = along([(1.0 - mu * mu).max(0.0).sqrt(), -mu, 0.0]);
        radiance(&scene, along, i as u64, 20_000)[3]
    };
    let means: Vec<Mean> = case.array("mu").iter().enumerate().map(ray).collect();
    case.agrees(&means, "radiance", "standard_error");
}

/// Side of the compared blocks, pixels. Single pixels have a heavy tail.
const BLOCK: usize = 6;

/// Pixels of each block of a frame. The last blocks of a row and of a column include the remainder of the sides.
fn blocks((width, height): (usize, usize)) -> Vec<Vec<usize>> {
    let edges = |side: usize| {
        let count = (side / BLOCK).max(1);
        (0..count).map(move |block| {
            let end = if block + 1 == count {
                side
            } else {
                (block + 1) * BLOCK
            };
            block * BLOCK..end
        })
    };
    let rows = edges(height).flat_map(|rows| edges(width).map(move |columns| (rows.clone(), columns)));
    rows.map(|(rows, columns)| {
        rows.flat_map(|y| columns.clone().map(move |x| y * width + x))
            .collect()
    })
    .collect()
}

/// Light of a part of a frame's pixels, stored with its standard errors.
struct Stored {
    values: Vec<f64>,
    errors: Vec<f64>,
}

impl Stored {
    /// Checks the mean of some pixels. Few paths miss the rare bright ones, so a share `tail` of the light is allowed
    /// in addition to noise.
    fn agrees(&self, ours: &[Mean], pixels: &[usize], tail: f64, what: &str) {
        let n = pixels.len() as f64;
        let sum = |value: &dyn Fn(usize) -> f64| pixels.iter().map(|&i| value(i)).sum::<f64>();
        let mean = Mean {
            mean: sum(&|i| ours[i].mean) / n,
            error: sum(&|i| ours[i].error.powi(2)).sqrt() / n,
        };
        let stored = sum(&|i| self.values[i]) / n;
        let error = sum(&|i| self.errors[i].powi(2)).sqrt() / n;
        println!("   {what}: {mean:?}, stored {stored:.6} ± {error:.6}");
        mean.agrees(stored, error.hypot((tail * stored).max(1e-6) / 4.0), what);
    }

    /// Checks all blocks of a frame, and the frame.
    fn agrees_by_blocks(&self, ours: &[Mean], size: (usize, usize), tail: f64, what: &str) {
        assert_eq!(
            [ours.len(), self.values.len(), self.errors.len()],
            [size.0 * size.1; 3]
        );
        for (block, pixels) in blocks(size).iter().enumerate() {
            self.agrees(ours, pixels, tail, &format!("{what} block {block}"));
        }
        let all: Vec<usize> = (0..ours.len()).collect();
        self.agrees(ours, &all, tail, &format!("{what} frame"));
    }
}

fn lamp_frame(case: &Case) {
    let size @ (width, height) = (case.number("/width") as usize, case.number("/height") as usize);
    let (low, high) = (case.triple("/box_lo"), case.triple("/box_hi"));
    let solids = Solids(vec![
        TestSolid::Wall(case.number("/wall_z")),
        TestSolid::Block { low, high },
    ]);
    let materials = vec![Lambertian::gray(case.number("/albedo")); 2];
    let mut scene = scene(&solids, materials, case.water(), case.phase());
    let axis = case.triple("/lamp/direction");
    scene.lamps = vec![SphereLamp {
        place: case.triple("/lamp/position_m").into(),
        intensity: [case.number("/lamp/intensity"); 3],
        beam: Some((axis.into(), case.number("/lamp/cone_deg").to_radians().cos())),
        radius_m: case.number("/lamp_radius_m"),
        disc_m: 0.0,
    }];
    let camera = Intrinsics::centered(case.number("/focal_px"), width, height);
    let pixel = |i: usize| {
        let along = Along {
            origin: vec3(0.0, 0.0, 0.0),
            direction: camera.ray((i % width) as f64, (i / width) as f64).normalized(),
        };
        radiance(&scene, along, i as u64, 2048)
    };
    let pixels: Vec<_> = (0..width * height).map(pixel).collect();
    for (name, part, tail) in [("order0", 0, 0.0), ("order1", 1, 0.1), ("total", 3, 0.1)] {
        let stored = Stored {
            values: case.array(name),
            errors: case.array(&format!("{name}_se")),
        };
        let ours: Vec<Mean> = pixels.iter().map(|parts| parts[part]).collect();
        stored.agrees_by_blocks(&ours, size, tail, name);
    }
}

#[test]
fn blocks_cover_frames_of_any_size_once() {
    for (size, count) in [
        ((24, 18), 12),
        ((20, 16), 6),
        ((6, 6), 1),
        ((4, 3), 1),
        ((13, 5), 2),
    ] {
        let blocks = blocks(size);
        assert_eq!(blocks.len(), count, "{size:?}");
        let mut all: Vec<usize> = blocks.into_iter().flatten().collect();
        all.sort_unstable();
        assert_eq!(all, (0..size.0 * size.1).collect::<Vec<_>>(), "{size:?}");
    }
    let blocks = blocks((20, 16));
    assert_eq!((blocks[0][6], blocks[0].len()), (20, 36));
    assert_eq!((blocks[5][0], blocks[5].len()), (6 * 20 + 12, 80));
}

#[test]
fn frames_of_20_by_16_agree_by_blocks_and_a_wrong_corner_does_not() {
    const SIZE: (usize, usize) = (20, 16);
    let even = |mean: f64| vec![Mean { mean, error: 1e-3 }; SIZE.0 * SIZE.1];
    let stored = Stored {
        values: vec![0.5; SIZE.0 * SIZE.1],
        errors: vec![1e-3; SIZE.0 * SIZE.1],
    };
    stored.agrees_by_blocks(&even(0.5), SIZE, 0.0, "even");
    let mut wrong = even(0.5);
    wrong[SIZE.0 * SIZE.1 - 1].mean = 0.7;
    let checked = std::panic::catch_unwind(|| stored.agrees_by_blocks(&wrong, SIZE, 0.0, "corner"));
    assert!(checked.is_err(), "the last pixel belongs to no block");
}

fn cases() -> Vec<PathBuf> {
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/vectors");
    let extra = std::env::var("FATHOM_GOLDEN_EXTRA").unwrap_or_default();
    let extra = extra
        .split(':')
        .filter(|path| !path.is_empty())
        .map(PathBuf::from);
    let mut found = Vec::new();
    for place in std::iter::once(own)
        .chain(extra)
        .map(|place| place.join("realism"))
    {
        let entries =
            std::fs::read_dir(&place).unwrap_or_else(|error| panic!("{}: {error}", place.display()));
        let folders = entries.map(|entry| entry.expect("a readable folder").path());
        found.extend(folders.filter(|path| {
            let name = path.file_name().and_then(std::ffi::OsStr::to_str);
            name.is_some_and(|name| name.starts_with("mc-"))
        }));
    }
    found.sort();
    found
}

fn pass(kind: &str, check: fn(&Case)) {
    let all = cases().into_iter().map(|folder| Case::read(&folder));
    let of_kind: Vec<Case> = all.filter(|case| case.parameters["kind"] == kind).collect();
    assert!(!of_kind.is_empty(), "no case of kind {kind}");
    of_kind.iter().for_each(check);
}

#[test]
fn golden_slabs_pass() {
    pass("slab", slab);
}

#[test]
fn golden_poles_pass() {
    pass("pole", pole);
}

#[test]
fn golden_light_from_above_passes() {
    pass("light from above", light_from_above);
}

#[test]
fn golden_lamp_frames_pass() {
    pass("lamp frame", lamp_frame);
}

#[test]
fn golden_cases_are_all_of_a_known_kind() {
    const KINDS: [&str; 4] = ["slab", "pole", "light from above", "lamp frame"];
    for folder in cases() {
        let kind = Case::read(&folder).parameters["kind"].clone();
        assert!(
            KINDS.iter().any(|known| kind == *known),
            "{}: {kind}",
            folder.display()
        );
    }
}
