//! Positions of labels next to points, so that none covers another or a point.

/// Size of a character of the charts' font, px.
const CHARACTER: (f64, f64) = (7.9, 13.0);
/// Space between a point and its label.
const GAP_PX: f64 = 8.0;
/// Candidate baselines below a point, px, in the order of preference.
const BASELINES: [f64; 12] = [
    -6.0, 16.0, -20.0, 30.0, -34.0, 44.0, -48.0, 58.0, -62.0, 72.0, 86.0, 100.0,
];
/// Radius of a point.
const POINT_PX: f64 = 4.0;

/// A rectangle: left, top, right and bottom.
#[derive(Debug, Clone, Copy)]
struct Area {
    left: f64,
    top: f64,
    right: f64,
    bottom: f64,
}

impl Area {
    fn meets(&self, other: &Self) -> bool {
        self.left < other.right
            && other.left < self.right
            && self.top < other.bottom
            && other.top < self.bottom
    }
}

/// The occupied areas of a chart.
pub(super) struct Labels {
    taken: Vec<Area>,
    top: f64,
    bottom: f64,
}

impl Labels {
    /// A chart between two rows with these points.
    pub(super) fn new(points: impl Iterator<Item = (f64, f64)>, (bottom, top): (f64, f64)) -> Self {
        let taken = points.map(|(x, y)| Area {
            left: x - POINT_PX,
            top: y - POINT_PX,
            right: x + POINT_PX,
            bottom: y + POINT_PX,
        });
        Self {
            taken: taken.collect(),
            top,
            bottom,
        }
    }

    /// The start of the baseline of a label next to a point: the nearest free position, or the usual one in a full chart.
    pub(super) fn place(&mut self, (x, y): (f64, f64), text: &str) -> (f64, f64) {
        let width = CHARACTER.0 * text.chars().count() as f64;
        let mut sides = BASELINES.into_iter().flat_map(|below| {
            let row = y + below;
            [(x + GAP_PX, row), (x - GAP_PX - width, row)]
        });
        let position = sides
            .find(|side| self.is_free(&outline(*side, width)))
            .unwrap_or((x + GAP_PX, y + BASELINES[0]));
        self.taken.push(outline(position, width));
        position
    }

    /// Whether an area is inside the chart and free.
    fn is_free(&self, area: &Area) -> bool {
        let is_inside = area.top >= self.top - CHARACTER.1 && area.bottom <= self.bottom;
        is_inside && !self.taken.iter().any(|other| other.meets(area))
    }
}

/// The area of a text on a baseline.
fn outline((left, row): (f64, f64), width: f64) -> Area {
    Area {
        left,
        top: row - 10.0,
        right: left + width,
        bottom: row + 3.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_of_close_points_do_not_meet() {
        let points = [(100.0, 200.0), (104.0, 200.0), (108.0, 201.0), (112.0, 200.0)];
        let mut labels = Labels::new(points.into_iter(), (400.0, 40.0));
        let areas = points.map(|point| outline(labels.place(point, "0.001"), 5.0 * CHARACTER.0));
        for (index, area) in areas.iter().enumerate() {
            assert!(
                areas[index + 1..].iter().all(|other| !area.meets(other)),
                "{areas:?}"
            );
        }
        assert_eq!(labels.place((300.0, 100.0), "a"), (308.0, 94.0));
    }
}
