//! Labels as the camera sees them: mapped through the lens, or assembled from several poses in bands of rows.

use std::ops::Range;

use camera::geometry::Sampling;
use imaging::Plane;
use scenes::Labels;

use super::scene::Prepared;

/// The labels of a picture that differs from the scene's.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Seen {
    pub(crate) range: Option<Plane<f32>>,
    pub(crate) instances: Option<Plane<u16>>,
    pub(crate) labels: Option<Labels>,
}

impl Seen {
    /// The labels of a scene seen through a lens; unchanged without a map.
    pub(crate) fn new(prepared: &Prepared, sampling: Option<&Sampling>) -> Self {
        let scene = &prepared.scene;
        let Some(sampling) = sampling else {
            return Self {
                range: scene.range.clone(),
                instances: scene.instances.clone(),
                labels: prepared.labels.clone(),
            };
        };
        let instances = scene.instances.as_ref().map(|numbers| sampling.labels(numbers));
        let labels = prepared.labels.as_ref().zip(instances.as_ref());
        let labels = labels.map(|(labels, numbers)| {
            labels.moved(
                numbers,
                |codes| sampling.labels(codes),
                |reals| sampling.labels(reals),
            )
        });
        Self {
            range: scene.range.as_ref().map(|range| sampling.labels(range)),
            labels,
            instances,
        }
    }

    /// Replaces these rows by those of another pose.
    pub(crate) fn take_rows(&mut self, other: &Self, rows: &Range<usize>) {
        copy(self.range.as_mut(), other.range.as_ref(), rows);
        copy(self.instances.as_mut(), other.instances.as_ref(), rows);
        let (Some(labels), Some(others)) = (self.labels.as_mut(), other.labels.as_ref()) else {
            return;
        };
        copy(Some(&mut labels.semantics), Some(&others.semantics), rows);
        if let (Some(surfaces), Some(others)) = (labels.surfaces.as_mut(), others.surfaces.as_ref()) {
            copy(Some(&mut surfaces.z_depth), Some(&others.z_depth), rows);
            copy(Some(&mut surfaces.findings), Some(&others.findings), rows);
            for (own, other) in surfaces.normals.iter_mut().zip(&others.normals) {
                copy(Some(own), Some(other), rows);
            }
        }
        for instance in &others.instances {
            if !labels.instances.iter().any(|own| own.number == instance.number) {
                labels.instances.push(*instance);
            }
        }
    }

    /// Recomputes the boxes from the current instance mask.
    pub(crate) fn find_boxes(&mut self) {
        if let (Some(labels), Some(numbers)) = (&self.labels, &self.instances) {
            self.labels = Some(labels.moved(numbers, Plane::clone, Plane::clone));
        }
    }
}

fn copy<T: Copy>(own: Option<&mut Plane<T>>, other: Option<&Plane<T>>, rows: &Range<usize>) {
    if let (Some(own), Some(other)) = (own, other) {
        for row in rows.clone() {
            own.row_mut(row).copy_from_slice(other.row(row));
        }
    }
}
