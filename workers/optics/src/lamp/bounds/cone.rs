//! The rays of a tile as a cone, and intervals of distance and angle between a lamp and a segment of them.

use imaging::vector::dot;

use crate::visible_bounds::Tile;

/// A margin for the rounding of f64 in angles, rad.
const ANGLE: f64 = 1e-7;

/// A cone that holds the rays of a tile.
#[derive(Clone, Copy)]
pub(super) struct Cone {
    pub(super) center: [f64; 3],
    /// Half its opening, rad.
    half: f64,
    /// Sine of the largest angle of a ray to the optical axis.
    pub(super) off_axis: f64,
}

impl Cone {
    pub(super) fn new(tile: &Tile) -> Self {
        let center = unit([0, 1].map(|i| 0.5 * (tile.low[i] + tile.high[i])));
        let corners = [tile.low[0], tile.high[0]]
            .into_iter()
            .flat_map(|x| [[x, tile.low[1]], [x, tile.high[1]]]);
        let half = corners.map(|corner| angle_between(unit(corner), center));
        let [_, most] = tile.stretch();
        Self {
            center,
            half: half.fold(0.0, f64::max) + ANGLE,
            off_axis: (1.0 - 1.0 / (most * most)).max(0.0).sqrt(),
        }
    }

    /// Longest difference of a unit vector along one of its rays from that of its center.
    pub(super) fn chord(&self) -> f64 {
        2.0 * (0.5 * self.half).sin()
    }
}

/// A lamp as the rays of a cone pass it.
#[derive(Clone, Copy)]
pub(super) struct Passing {
    /// Distance of the lamp from the camera, m.
    pub(super) away_m: f64,
    /// Least distance from the lamp, m.
    radius_m: f64,
    /// Cosines and sines of the least and the greatest angle between a ray and the lamp.
    cos: [f64; 2],
    sin: [f64; 2],
    /// Of the central ray: its direction, the range nearest to the lamp, and the vector there from the lamp.
    center: [f64; 3],
    central_m: f64,
    offset: [f64; 3],
    /// Distance of the ends of two unit vectors that are half the opening apart.
    chord: f64,
}

/// Intervals of distance and angle between a lamp and all points of a segment of the rays.
#[derive(Clone, Copy)]
pub(super) struct Segment {
    /// Least and greatest distance from the lamp, m.
    pub(super) near_m: f64,
    pub(super) far_m: f64,
    /// Least and greatest path from the lamp and on to the camera, m.
    pub(super) path_m: [f64; 2],
    /// Least and greatest direction from the lamp, as the angle to an axis.
    pub(super) to_axis: [f64; 2],
}

impl Passing {
    pub(super) fn new(cone: Cone, lamp: [f64; 3], radius_m: f64) -> Self {
        let away_m = dot(lamp, lamp).sqrt();
        let angle = if away_m > 0.0 {
            angle_between(lamp.map(|v| v / away_m), cone.center)
        } else {
            0.0
        };
        let angles = [
            (angle - cone.half).max(0.0),
            (angle + cone.half).min(std::f64::consts::PI),
        ];
        let central_m = dot(lamp, cone.center);
        Self {
            away_m,
            radius_m,
            cos: angles.map(f64::cos),
            sin: angles.map(f64::sin),
            center: cone.center,
            central_m,
            offset: [0, 1, 2].map(|i| central_m * cone.center[i] - lamp[i]),
            chord: cone.chord(),
        }
    }

    /// Least distance of the lamp from an endless ray, at least its radius, m.
    pub(super) fn beside_m(&self) -> f64 {
        let least = self.sin[0].min(self.sin[1]);
        (self.away_m * least).max(self.radius_m)
    }

    /// Greatest distance of the lamp from an endless ray, at least its radius, m.
    pub(super) fn most_beside_m(&self) -> f64 {
        let is_across = self.cos[1] <= 0.0 && self.cos[0] >= 0.0;
        let most = if is_across {
            1.0
        } else {
            self.sin[0].max(self.sin[1])
        };
        (self.away_m * most).max(self.radius_m)
    }

    /// Least and greatest range of the points closest to the lamp, negative behind the camera, m.
    pub(super) fn nearest_m(&self) -> [f64; 2] {
        [self.away_m * self.cos[1], self.away_m * self.cos[0]]
    }

    /// Whether the lamp is behind the camera for all rays.
    pub(super) fn is_behind(&self) -> bool {
        self.cos[0] < 0.0
    }

    /// Range of the central ray at an angle about the lamp from its nearest point.
    pub(super) fn range_at(&self, angle: f64) -> f64 {
        let beside = dot(self.offset, self.offset).sqrt().max(self.radius_m);
        (self.central_m + beside * angle.tan()).max(0.0)
    }

    /// Angle about the lamp from the nearest point of the central ray to another one.
    pub(super) fn angle_at(&self, range_m: f64) -> f64 {
        let beside = dot(self.offset, self.offset).sqrt().max(self.radius_m);
        ((range_m - self.central_m) / beside).atan()
    }

    /// Least range, on any ray, of the point from which the direction to the lamp turns by this angle up to a range.
    ///
    /// On a ray that passes the lamp at the distance D and the range t it is `t + D (x − D tan a)/(D + x tan a)`, with x the range
    /// behind t. In D, and in t, this rises to one maximum, so the extreme rays bound it.
    pub(super) fn least_range_before(&self, range_m: f64, angle: f64) -> f64 {
        let tangent = angle.tan();
        let beside = [self.beside_m(), self.most_beside_m()];
        let ranges = beside.into_iter().flat_map(|beside| {
            self.nearest_m().map(|along| {
                let behind = range_m - along;
                let opened = beside + behind * tangent;
                if range_m.is_infinite() {
                    along + beside / tangent
                } else if opened <= 0.0 {
                    0.0
                } else {
                    along + beside * (behind - beside * tangent) / opened
                }
            })
        });
        ranges.fold(f64::INFINITY, f64::min).max(0.0)
    }

    /// Distance from the lamp at a range on the rays nearest to it (0) or farthest from it (1).
    fn distance(&self, range_m: f64, end: usize) -> f64 {
        if range_m.is_infinite() {
            return range_m;
        }
        let (along, beside) = (range_m - self.away_m * self.cos[end], self.away_m * self.sin[end]);
        (along * along + beside * beside).sqrt().max(self.radius_m)
    }

    /// Least and greatest distance from the lamp between two ranges, m.
    pub(super) fn distances(&self, [from, to]: [f64; 2]) -> [f64; 2] {
        let far = self.distance(from, 1).max(self.distance(to, 1));
        [self.least_distance([from, to]), far]
    }

    /// Least distance from the lamp between two ranges, m.
    pub(super) fn least_distance(&self, [from, to]: [f64; 2]) -> f64 {
        self.distance((self.away_m * self.cos[0]).clamp(from, to), 0)
    }

    /// Upper bound of `∫ dt/r²` of any ray between two ranges, with r the distance from the lamp, 1/m.
    pub(super) fn most_turned(&self, [from, to]: [f64; 2]) -> f64 {
        let near = self.least_distance([from, to]);
        let even = (to - from) / (near * near);
        let beside = self.beside_m();
        if beside <= self.radius_m {
            return even.min(std::f64::consts::PI / beside);
        }
        // The rays nearest to the lamp turn most.
        let (along, beside) = (self.away_m * self.cos[0], self.away_m * self.sin[0]);
        let angle = |range: f64| ((range - along) / beside).atan();
        even.min((angle(to) - angle(from)) / beside)
    }

    /// The part of the rays between two ranges; the second may be infinite. Angles are those to an axis, if one is given.
    pub(super) fn segment(&self, [from, to]: [f64; 2], axis: Option<[f64; 3]>) -> Segment {
        let [near_m, far_m] = self.distances([from, to]);
        Segment {
            near_m,
            far_m,
            path_m: [
                from + self.distance(from, 0),
                to + self.distance(to, 1) + self.radius_m,
            ],
            to_axis: axis.map_or([0.0; 2], |axis| {
                self.shrunk(self.angles_to(axis, [from, to]), near_m)
            }),
        }
    }

    /// Least and greatest angle between an axis and the directions from the lamp to the rays between two ranges.
    fn angles_to(&self, axis: [f64; 3], [from, to]: [f64; 2]) -> [f64; 2] {
        const ALL: [f64; 2] = [0.0, std::f64::consts::PI];
        let way = |range: f64| [0, 1, 2].map(|i| self.offset[i] + (range - self.central_m) * self.center[i]);
        let length = |v: [f64; 3]| dot(v, v).sqrt();
        let begin = way(from);
        let end = if to.is_infinite() { self.center } else { way(to) };
        // Of the central ray.
        let beside = length(way(self.central_m.clamp(from, to)));
        let slant = (1.0 + self.away_m / beside).min(to / beside);
        let turned = self.chord * slant;
        let lengths = [begin, end].map(length);
        if turned >= 0.9 || lengths[0] <= 0.0 || lengths[1] <= 0.0 {
            return ALL;
        }
        let ends = [begin.map(|v| v / lengths[0]), end.map(|v| v / lengths[1])];
        let middle = [0, 1, 2].map(|i| ends[0][i] + ends[1][i]);
        let middle_length = length(middle);
        if middle_length < 0.1 {
            return ALL;
        }
        let angle = angle_between(middle.map(|v| v / middle_length), axis);
        let apart = 0.5 * angle_between(ends[0], ends[1]) + turned.asin() + ANGLE;
        [
            (angle - apart).max(0.0),
            (angle + apart).min(std::f64::consts::PI),
        ]
    }

    /// Widens an interval of angles to an axis by the shrinking of cosines for rays within the radius of the lamp.
    fn shrunk(&self, [least, most]: [f64; 2], near_m: f64) -> [f64; 2] {
        if self.beside_m() > self.radius_m {
            return [least, most];
        }
        let share = self.radius_m / near_m;
        let kept = (1.0 - share * share).max(0.0).sqrt();
        let turned = |angle: f64| (kept * angle.cos()).acos();
        [least.min(turned(least)), most.max(turned(most))]
    }

    /// Largest and least cosine of the scattering angle between two ranges.
    pub(super) fn scattering_cosines(&self, [from, to]: [f64; 2]) -> [f64; 2] {
        let cosine = |range: f64, cos: f64, beside: f64| {
            if range.is_infinite() {
                return -1.0;
            }
            let along = self.away_m * cos - range;
            along / (along * along + beside * beside).sqrt().max(1e-300)
        };
        let at_ends = |range: f64| {
            [0, 1].map(|end| {
                cosine(
                    range,
                    self.cos[end],
                    (self.away_m * self.sin[end]).max(self.radius_m),
                )
            })
        };
        let [first, second] = at_ends(from);
        let mut most = first.max(second);
        // Behind the lamp the scattering angle is least if the directions to the camera and to the lamp are perpendicular.
        let critical = self.away_m / from.max(1e-300);
        if critical < 1.0 && critical < self.cos[0] && critical > self.cos[1] {
            let beside = self.away_m * (1.0 - critical * critical).sqrt();
            most = most.max(cosine(from, critical, beside.max(self.radius_m)));
        }
        // Within the radius of the lamp the distance from the ray is the radius.
        let grazing = self.radius_m / self.away_m.max(1e-300);
        if grazing < 1.0 && grazing > self.sin[0].min(self.sin[1]) {
            let cos = (1.0 - grazing * grazing).sqrt();
            let inside = [cos, -cos]
                .into_iter()
                .filter(|cos| *cos < self.cos[0] && *cos > self.cos[1]);
            most = inside.fold(most, |most, cos| most.max(cosine(from, cos, self.radius_m)));
        }
        let [third, fourth] = at_ends(to);
        [most, third.min(fourth).min(most)]
    }
}

fn unit([x, y]: [f64; 2]) -> [f64; 3] {
    let length = (x * x + y * y + 1.0).sqrt();
    [x / length, y / length, 1.0 / length]
}

/// The angle between two unit vectors.
pub(super) fn angle_between(a: [f64; 3], b: [f64; 3]) -> f64 {
    let way = [0, 1, 2].map(|i| a[i] - b[i]);
    let chord = dot(way, way).sqrt();
    if chord < 1.4 {
        2.0 * (0.5 * chord).asin()
    } else {
        let sum = [0, 1, 2].map(|i| a[i] + b[i]);
        std::f64::consts::PI - 2.0 * (0.5 * dot(sum, sum).sqrt()).min(1.0).asin()
    }
}
