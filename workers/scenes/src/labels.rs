//! Labels of a frame: geometry, masks, boxes and findings, in the geometry of the picture.

use imaging::Plane;
use imaging::geometry::Intrinsics;
use spec::Classes;

use crate::CameraPose;
use crate::categories::Category;
use crate::classes::UNLABELED;
use crate::site::SurfaceRows;

/// Labels of a frame. All planes have the size of the frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Labels {
    /// Class code of each pixel; for procedural scenes the number of its [`Category`].
    pub semantics: Plane<u8>,
    /// All visible instances by number.
    pub instances: Vec<Instance>,
    /// `None` for uploaded scenes.
    pub surfaces: Option<SurfaceLabels>,
}

/// Surface labels of a procedural scene.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceLabels {
    /// Depth along the optical axis in meters: range times the cosine of the angle to it; infinite in open water.
    pub z_depth: Plane<f32>,
    /// Unit normals of the surfaces, without relief, in camera axes (right, down, ahead); they face the camera. Edges
    /// are rounded over a millimeter. Zero in open water.
    pub normals: [Plane<f32>; 3],
    /// [`crate::categories::Finding::bit`] of every finding of the pixel. A finding must cover more than half of the
    /// pixel; a crack only has to pass through it.
    pub findings: Plane<u8>,
    /// Camera pose.
    pub pose: CameraPose,
    /// Camera intrinsics.
    pub intrinsics: Intrinsics,
}

/// A visible object.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Instance {
    /// Number in the instance mask: in procedural scenes 1 for the ground, from 2 on for objects.
    pub number: u16,
    /// Code of its class in the semantic mask.
    pub class: u8,
    /// The smallest box of whole pixels around its visible part: left, top, and the first column and row beyond.
    pub bounds: [usize; 4],
    /// Number of its pixels.
    pub pixels: usize,
    /// For growth, the number of its host if that is visible.
    pub host: Option<u16>,
}

#[derive(Debug, Clone, Copy)]
pub(crate) struct InstanceInfo {
    pub(crate) category: Category,
    pub(crate) host: Option<u16>,
}

impl Labels {
    /// `shown` lists the instances from 1 on.
    pub(crate) fn procedural(
        surfaces: SurfaceRows,
        numbers: &Plane<u16>,
        shown: &[InstanceInfo],
        pose: CameraPose,
        intrinsics: Intrinsics,
    ) -> Self {
        let (width, height) = numbers.size();
        let plane = |data| Plane::new(width, height, data).expect("one sample for each pixel");
        let surfaces = SurfaceLabels {
            z_depth: plane(surfaces.z_depth),
            normals: surfaces.normals.map(plane),
            findings: Plane::new(width, height, surfaces.findings).expect("one mask for each pixel"),
            pose,
            intrinsics,
        };
        let mut labels = Self::of_mask(numbers, |number| shown[usize::from(number) - 1].category as u8);
        keep_hosts(&mut labels.instances, |number| {
            shown[usize::from(number) - 1].host
        });
        Self {
            surfaces: Some(surfaces),
            ..labels
        }
    }

    /// Labels after a geometric transformation of the picture, from the transformed planes. `numbers` is the
    /// transformed instance mask.
    #[must_use]
    pub fn moved(
        &self,
        numbers: &Plane<u16>,
        codes: impl Fn(&Plane<u8>) -> Plane<u8>,
        reals: impl Fn(&Plane<f32>) -> Plane<f32>,
    ) -> Self {
        let surfaces = self.surfaces.as_ref().map(|surfaces| SurfaceLabels {
            z_depth: reals(&surfaces.z_depth),
            normals: surfaces.normals.each_ref().map(&reals),
            findings: codes(&surfaces.findings),
            ..*surfaces
        });
        let mut instances = instances(numbers, |number| {
            self.instance(number)
                .map_or(UNLABELED.0, |instance| instance.class)
        });
        keep_hosts(&mut instances, |number| self.instance(number)?.host);
        Self {
            semantics: codes(&self.semantics),
            instances,
            surfaces,
        }
    }

    fn instance(&self, number: u16) -> Option<&Instance> {
        self.instances.iter().find(|instance| instance.number == number)
    }

    /// Labels derived from the instance mask of an uploaded scene. Objects without a class are [`UNLABELED`].
    #[must_use]
    pub fn uploaded(numbers: &Plane<u16>, classes: &Classes) -> Self {
        Self::of_mask(numbers, |number| classes.class_of(number).unwrap_or(UNLABELED.0))
    }

    fn of_mask(numbers: &Plane<u16>, class_of: impl Fn(u16) -> u8) -> Self {
        let instances = instances(numbers, class_of);
        let mut codes = vec![Category::Background as u8; table_length(numbers)];
        for instance in &instances {
            codes[usize::from(instance.number)] = instance.class;
        }
        Self {
            semantics: numbers.map(|&number| codes[usize::from(number)]),
            instances,
            surfaces: None,
        }
    }
}

/// Sets the hosts of instances; invisible hosts are dropped.
fn keep_hosts(instances: &mut [Instance], host_of: impl Fn(u16) -> Option<u16>) {
    let numbers: Vec<u16> = instances.iter().map(|instance| instance.number).collect();
    for instance in instances {
        instance.host = host_of(instance.number).filter(|host| numbers.binary_search(host).is_ok());
    }
}

/// All object numbers of a mask, ascending.
pub(crate) fn objects(numbers: &Plane<u16>) -> Vec<u16> {
    let mut seen = vec![false; table_length(numbers)];
    numbers
        .data()
        .iter()
        .for_each(|&number| seen[usize::from(number)] = true);
    (0..=u16::MAX)
        .zip(seen)
        .skip(1)
        .filter_map(|(number, seen)| seen.then_some(number))
        .collect()
}

/// Length of a table indexed by object number.
fn table_length(numbers: &Plane<u16>) -> usize {
    numbers
        .data()
        .iter()
        .max()
        .map_or(1, |&most| usize::from(most) + 1)
}

fn instances(numbers: &Plane<u16>, class_of: impl Fn(u16) -> u8) -> Vec<Instance> {
    let (width, height) = numbers.size();
    let mut found = vec![([width, height, 0, 0], 0); table_length(numbers)];
    for (y, row) in numbers.data().chunks_exact(width.max(1)).enumerate() {
        let mut left = 0;
        for run in row.chunk_by(|a, b| a == b) {
            let right = left + run.len();
            if run[0] != 0 {
                let (bounds, pixels) = &mut found[usize::from(run[0])];
                let [x0, y0, x1, y1] = *bounds;
                *bounds = [x0.min(left), y0.min(y), x1.max(right), y1.max(y + 1)];
                *pixels += run.len();
            }
            left = right;
        }
    }
    let seen = (0..=u16::MAX).zip(found).filter(|(_, (_, pixels))| *pixels > 0);
    seen.map(|(number, (bounds, pixels))| Instance {
        number,
        class: class_of(number),
        bounds,
        pixels,
        host: None,
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use spec::{SceneCategory, Segment};

    #[test]
    fn an_uploaded_mask_gets_the_classes_that_came_with_it() {
        let mask = Plane::new(4, 2, vec![0, 7, 7, 300, 0, 7, 0, 65535]).unwrap();
        let pile = SceneCategory {
            id: 2,
            name: "pile".to_owned(),
        };
        let segments = [7, 65535].map(|id| Segment { id, category_id: 2 });
        let classes = Classes {
            categories: vec![pile],
            segments_info: segments.into(),
        };
        let labels = Labels::uploaded(&mask, &classes);
        assert_eq!(labels.semantics.data(), &[0, 2, 2, 255, 0, 2, 0, 2]);
        let found: Vec<_> = labels
            .instances
            .iter()
            .map(|i| (i.number, i.class, i.bounds, i.pixels))
            .collect();
        let expected = [
            (7, 2, [1, 0, 3, 2], 3),
            (300, 255, [3, 0, 4, 1], 1),
            (65535, 2, [3, 1, 4, 2], 1),
        ];
        assert_eq!(found, expected);
        assert_eq!(objects(&mask), [7, 300, 65535]);
        assert_eq!(objects(&Plane::filled(2, 2, 0)), [0_u16; 0]);
    }
}
