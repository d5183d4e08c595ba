//! Guarantees of labels, for every family.
#![allow(clippy::unwrap_used)]

use imaging::geometry::Intrinsics;
use imaging::vector::DVec3;
use scenes::categories::{CATEGORIES, Category, FINDINGS, Finding};
use scenes::{FAMILIES, Labels, Scene, SurfaceLabels, World};

const SEEDS: std::ops::Range<u64> = 0..24;
const SIZE: (usize, usize) = (193, 123);

fn labeled(family: &str, seed: u64, size: (usize, usize)) -> (Scene, Labels) {
    let world = World::new(family, seed).unwrap();
    world.render_labeled(&world.pose(), size, &lens(size))
}

fn surfaces(labels: &Labels) -> &SurfaceLabels {
    labels.surfaces.as_ref().unwrap()
}

fn lens((width, height): (usize, usize)) -> Intrinsics {
    Intrinsics::centered(0.6 * width as f64, width, height)
}

fn normal_at(labels: &Labels, x: usize, y: usize) -> DVec3 {
    [0, 1, 2]
        .map(|axis| f64::from(surfaces(labels).normals[axis].pixel(x, y)))
        .into()
}

fn every_frame(mut check: impl FnMut(&str, u64, &Scene, &Labels)) {
    for family in FAMILIES {
        for seed in SEEDS {
            let (scene, labels) = labeled(family, seed, SIZE);
            check(family, seed, &scene, &labels);
        }
    }
}

#[test]
fn labels_do_not_change_the_picture_and_have_its_size() {
    for family in FAMILIES {
        for size in [(1, 1), (7, 3), (97, 61)] {
            let world = World::new(family, 4).unwrap();
            let (scene, labels) = world.render_labeled(&world.pose(), size, &lens(size));
            assert_eq!(scene, world.render(&world.pose(), size, &lens(size)));
            assert!(surfaces(&labels).normals.iter().all(|plane| plane.size() == size));
            assert_eq!(
                (labels.semantics.size(), surfaces(&labels).findings.size()),
                (size, size)
            );
            assert_eq!(
                (surfaces(&labels).pose, surfaces(&labels).intrinsics),
                (world.pose(), lens(size))
            );
        }
    }
}

#[test]
fn boxes_are_the_extents_of_their_masks() {
    every_frame(|family, seed, scene, labels| {
        let mask = scene.instances.as_ref().unwrap();
        let most = mask.data().iter().copied().max().unwrap();
        let numbers: Vec<u16> = labels.instances.iter().map(|instance| instance.number).collect();
        let shown: Vec<u16> = (1..=most).filter(|number| mask.data().contains(number)).collect();
        assert_eq!(numbers, shown, "{family} {seed}");
        for instance in &labels.instances {
            let shows = |x: usize, y: usize| mask.pixel(x, y) == instance.number;
            let [left, top, right, bottom] = instance.bounds;
            let inside = (top..bottom).flat_map(|y| (left..right).map(move |x| (x, y)));
            assert_eq!(inside.filter(|&(x, y)| shows(x, y)).count(), instance.pixels);
            let all = mask
                .data()
                .iter()
                .filter(|&&number| number == instance.number)
                .count();
            assert_eq!(all, instance.pixels, "{family} {seed}: pixels outside the box");
            assert!((top..bottom).any(|y| shows(left, y)) && (top..bottom).any(|y| shows(right - 1, y)));
            assert!((left..right).any(|x| shows(x, top)) && (left..right).any(|x| shows(x, bottom - 1)));
        }
    });
}

#[test]
fn semantics_are_the_categories_of_the_instances() {
    let mut seen = [0usize; CATEGORIES.len()];
    every_frame(|_, _, scene, labels| {
        for (number, category) in scene
            .instances
            .as_ref()
            .unwrap()
            .data()
            .iter()
            .zip(labels.semantics.data())
        {
            let instance = labels
                .instances
                .iter()
                .find(|instance| instance.number == *number);
            let wanted = instance.map_or(Category::Background as u8, |instance| instance.class);
            assert_eq!(*category, wanted);
            assert_eq!(*number == 1, wanted == Category::Seabed as u8);
            seen[usize::from(*category)] += 1;
        }
    });
    let lives = [Category::Fauna, Category::Growth, Category::Bubble];
    for (category, name) in CATEGORIES {
        let is_seen = seen[*category as usize] > 0;
        assert_eq!(
            is_seen,
            !lives.contains(category),
            "{name}: an empty world has no life in it"
        );
    }
}

#[test]
fn normals_are_unit_vectors_that_face_the_camera() {
    every_frame(|family, seed, scene, labels| {
        let range = scene.range.as_ref().unwrap();
        let lens = lens(SIZE);
        for y in 0..SIZE.1 {
            for x in 0..SIZE.0 {
                let n = normal_at(labels, x, y);
                let length = n.length();
                if range.pixel(x, y).is_infinite() {
                    assert_eq!(length, 0.0);
                    continue;
                }
                assert!(
                    (length - 1.0).abs() < 1e-4,
                    "{family} {seed} ({x}, {y}): {length}"
                );
                let toward = -n.dot(lens.ray(x as f64, y as f64));
                assert!(toward > -1e-3, "{family} {seed} ({x}, {y}): {toward}");
            }
        }
    });
}

/// Range differences over a pixel: exact for planes, and curvature adds little this close.
#[test]
fn normals_agree_with_the_range() {
    let (mut good, mut all) = (0usize, 0usize);
    every_frame(|_, _, scene, labels| {
        let (range, mask) = (scene.range.as_ref().unwrap(), scene.instances.as_ref().unwrap());
        let lens = lens(SIZE);
        let point =
            |x: usize, y: usize| lens.ray(x as f64, y as f64).normalized() * f64::from(range.pixel(x, y));
        for y in (1..SIZE.1 - 1).step_by(3) {
            for x in (1..SIZE.0 - 1).step_by(3) {
                let neighbors = [(x - 1, y), (x + 1, y), (x, y - 1), (x, y + 1)];
                if mask.pixel(x, y) == 0
                    || neighbors
                        .iter()
                        .any(|&(a, b)| mask.pixel(a, b) != mask.pixel(x, y))
                {
                    continue;
                }
                let along = point(x + 1, y) - point(x - 1, y);
                let down = point(x, y + 1) - point(x, y - 1);
                let alike = down.cross(along).normalized().dot(normal_at(labels, x, y));
                all += 1;
                good += usize::from(alike > 0.95);
            }
        }
    });
    // The rest is where parts of one object meet.
    assert!(all > 20_000 && good as f64 > 0.96 * all as f64, "{good} of {all}");
}

#[test]
fn depth_is_range_times_the_cosine_to_the_axis() {
    every_frame(|_, _, scene, labels| {
        let lens = lens(SIZE);
        for y in (0..SIZE.1).step_by(5) {
            for x in (0..SIZE.0).step_by(5) {
                let depth = f64::from(surfaces(labels).z_depth.pixel(x, y));
                let range = f64::from(scene.range.as_ref().unwrap().pixel(x, y));
                let wanted = range / lens.ray(x as f64, y as f64).length();
                assert!(depth == wanted || (depth - wanted).abs() < 1e-5 * wanted);
            }
        }
    });
}

#[test]
fn findings_lie_on_objects_that_can_have_them_and_every_one_occurs() {
    let mut seen = vec![0usize; FINDINGS.len()];
    every_frame(|family, seed, _, labels| {
        for (bits, category) in surfaces(labels)
            .findings
            .data()
            .iter()
            .zip(labels.semantics.data())
        {
            let bare = [Category::Background, Category::Seabed].map(|category| category as u8);
            assert!(*bits == 0 || !bare.contains(category), "{family} {seed}");
            assert!(usize::from(*bits) < 1 << FINDINGS.len());
            if *category == Category::Anode as u8 {
                assert_eq!(bits & Finding::Crack.bit(), 0);
            }
            for (finding, _) in FINDINGS {
                seen[*finding as usize] += usize::from(bits & finding.bit() != 0);
            }
        }
    });
    for (finding, name) in FINDINGS {
        println!("{name}: {} pixels", seen[*finding as usize]);
        assert!(seen[*finding as usize] > 500, "{name} hardly occurs");
    }
}
