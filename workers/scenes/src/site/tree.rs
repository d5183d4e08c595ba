//! Bounding-volume hierarchy of a site's solids for packets of shadow rays.

mod split;

use imaging::vector::Vec3;

use super::bounds::Bounds;
use super::solid::{Groups, ShadowPacket, Solid};
use split::split;

/// Boxes are enlarged by this, m: rounding can place a hit just outside of a box.
const MARGIN_M: f32 = 1e-3;
/// More solids than these are found faster by each packet of a batch than in a list for all of them.
const MOST_LISTED: usize = 24;
/// Solids per leaf.
const FEW: usize = 2;
/// Deeper than any tree of `u16` solid numbers: below [`UNEVEN_DEPTH`] nodes are halved.
const DEPTH: usize = 64;
/// Deeper nodes are divided into equal halves.
const UNEVEN_DEPTH: usize = 40;

pub(crate) struct Tree {
    nodes: Vec<TreeNode>,
    /// Solid numbers; those of a leaf are contiguous.
    order: Vec<u16>,
    /// Hollows have unbounded walls and no box.
    hollows: Vec<u16>,
    boxes: Vec<Bounds>,
}

struct TreeNode {
    bounds: Bounds,
    /// For a leaf, the index of its first solid; otherwise that of the right child. The left child follows its parent.
    first: usize,
    /// 0 for inner nodes.
    count: usize,
}

/// Shadow rays from one box to another. At any share of the length, all of them are inside the interpolated box.
#[derive(Clone, Copy)]
pub(crate) struct RayPacket {
    pub(crate) from: Bounds,
    pub(crate) to: Bounds,
}

impl RayPacket {
    /// A packet without rays.
    pub(crate) const EMPTY: Self = Self {
        from: Bounds::EMPTY,
        to: Bounds::EMPTY,
    };

    /// Both packets.
    pub(crate) fn union(&self, other: &Self) -> Self {
        Self {
            from: self.from.union(&other.from),
            to: self.to.union(&other.to),
        }
    }

    /// Smallest share of the length at which any ray can reach a box; `None` if the packet misses it.
    #[inline(always)]
    pub(crate) fn reaches(&self, other: &Bounds) -> Option<f32> {
        let ([from_low, from_high], [to_low, to_high]) = (self.from.ends(), self.to.ends());
        let [low, high] = other.ends();
        // Most boxes are outside the packet on some axis.
        let is_outside = |axis: usize| {
            (from_low[axis] > high[axis]) & (to_low[axis] >= high[axis])
                | (from_high[axis] < low[axis]) & (to_high[axis] <= low[axis])
        };
        if is_outside(0) | is_outside(1) | is_outside(2) {
            return None;
        }
        let (mut enter, mut leave) = (0.0f32, 1.0f32);
        for axis in 0..3 {
            // Both quantities change linearly and must be at most 0 inside the box.
            for (start, end) in [
                (from_low[axis] - high[axis], to_low[axis] - high[axis]),
                (low[axis] - from_high[axis], low[axis] - to_high[axis]),
            ] {
                let cross = start / (start - end);
                if start > 0.0 {
                    enter = enter.max(cross);
                } else if end > 0.0 {
                    leave = leave.min(cross);
                }
            }
        }
        (enter <= leave).then_some(enter)
    }
}

impl Tree {
    /// The first solid on a ray within `reach` meters along a unit vector, and its distance; `None` if there is none or
    /// the ground is nearer.
    pub(crate) fn first_met(
        &self,
        solids: &[Solid],
        from: Vec3,
        heading: Vec3,
        reach: f32,
    ) -> Option<(f32, u16)> {
        let ground = if heading.z < 0.0 {
            -from.z / heading.z
        } else {
            f32::INFINITY
        };
        let reach = reach.min(ground);
        let packet = RayPacket {
            from: Bounds::from_point(from),
            to: Bounds::from_point(from + heading * reach),
        };
        let mut nearest = (reach, None);
        self.search(&packet, |number| {
            let met = solids[usize::from(number)].enter(from, heading);
            if met < nearest.0 || (met == nearest.0 && nearest.1.is_some_and(|other| number < other)) {
                nearest = (met, Some(number));
            }
            nearest.0 / reach
        });
        nearest.1.map(|number| (nearest.0, number))
    }

    pub(crate) fn new(solids: &[Solid]) -> Self {
        let boxes: Vec<Bounds> = solids
            .iter()
            .map(|solid| Bounds::from_solid(solid).grown(MARGIN_M))
            .collect();
        let (hollows, mut order): (Vec<u16>, Vec<u16>) =
            (0..solids.len() as u16).partition(|&number| solids[usize::from(number)].is_hollow());
        let mut nodes = Vec::new();
        if !order.is_empty() {
            Growing {
                boxes: &boxes,
                nodes: &mut nodes,
            }
            .grow(&mut order, 0, 0);
        }
        Self {
            nodes,
            order,
            hollows,
            boxes,
        }
    }

    /// Lists the solids with boxes that a packet may reach, without hollows. Returns whether they are few.
    pub(crate) fn list_few(&self, packet: &RayPacket, found: &mut Vec<u16>) -> bool {
        found.clear();
        self.search_boxes(packet, 1.0, |number| {
            found.push(number);
            if found.len() > MOST_LISTED { -1.0 } else { 1.0 }
        });
        found.len() <= MOST_LISTED
    }

    /// [`Tree::occlude`] for a packet that reaches no other solids than the listed ones and hollows.
    #[inline(always)]
    pub(crate) fn occlude_listed(
        &self,
        solids: &[Solid],
        (listed, hull): (&[u16], &RayPacket),
        run: &mut ShadowPacket,
    ) {
        for &number in &self.hollows {
            solids[usize::from(number)].occlude(run, Groups::ALL);
        }
        for &number in listed {
            let bounds = &self.boxes[usize::from(number)];
            if hull.reaches(bounds).is_none() {
                continue;
            }
            let reaching = run.reach(bounds, Groups::ALL);
            if !reaching.is_empty() {
                solids[usize::from(number)].occlude(run, reaching);
            }
        }
    }

    /// Marks the rays of a packet that a solid occludes. `hull` contains all of them.
    #[inline(always)]
    pub(crate) fn occlude(&self, solids: &[Solid], hull: &RayPacket, run: &mut ShadowPacket) {
        for &number in &self.hollows {
            solids[usize::from(number)].occlude(run, Groups::ALL);
        }
        if self.nodes.is_empty() {
            return;
        }
        let (mut stack, mut height) = ([(0usize, Groups::ALL); DEPTH], 1);
        while height > 0 {
            height -= 1;
            let (position, groups) = stack[height];
            let node = &self.nodes[position];
            // Most nodes are outside of the hull, and it is cheaper to test than the rays.
            if hull.reaches(&node.bounds).is_none() {
                continue;
            }
            let groups = run.reach(&node.bounds, groups);
            if groups.is_empty() {
                continue;
            }
            if node.count == 0 {
                stack[height] = (node.first, groups);
                stack[height + 1] = (position + 1, groups);
                height += 2;
                continue;
            }
            for &number in &self.order[node.first..node.first + node.count] {
                let reaching = if node.count == 1 {
                    groups
                } else {
                    run.reach(&self.boxes[usize::from(number)], groups)
                };
                if !reaching.is_empty() {
                    solids[usize::from(number)].occlude(run, reaching);
                }
            }
        }
    }

    /// Calls `meet` for every solid that may block a ray of the packet. It returns the share of the length beyond which
    /// hits no longer matter; a negative value ends the search.
    pub(crate) fn search(&self, packet: &RayPacket, mut meet: impl FnMut(u16) -> f32) {
        let mut within = 1.0;
        for &number in &self.hollows {
            within = meet(number);
        }
        self.search_boxes(packet, within, meet);
    }

    /// [`Tree::search`] without hollows, up to a share of the length.
    fn search_boxes(&self, packet: &RayPacket, mut within: f32, mut meet: impl FnMut(u16) -> f32) {
        if self.nodes.is_empty() {
            return;
        }
        let (mut stack, mut height) = ([0usize; DEPTH], 1);
        while height > 0 {
            height -= 1;
            let position = stack[height];
            let node = &self.nodes[position];
            if !packet.reaches(&node.bounds).is_some_and(|share| share <= within) {
                continue;
            }
            if node.count == 0 {
                stack[height] = node.first;
                stack[height + 1] = position + 1;
                height += 2;
                continue;
            }
            for &number in &self.order[node.first..node.first + node.count] {
                let bounds = &self.boxes[usize::from(number)];
                if node.count == 1 || packet.reaches(bounds).is_some_and(|share| share <= within) {
                    within = meet(number);
                    if within < 0.0 {
                        return;
                    }
                }
            }
        }
    }
}

/// A tree under construction.
struct Growing<'a> {
    boxes: &'a [Bounds],
    nodes: &'a mut Vec<TreeNode>,
}

impl Growing<'_> {
    /// Adds the subtree of some solids at a depth; `first` is the index of the first one in the overall order.
    fn grow(&mut self, order: &mut [u16], first: usize, depth: usize) {
        let boxes = self.boxes;
        let bounds = order
            .iter()
            .map(|&number| &boxes[usize::from(number)])
            .fold(boxes[usize::from(order[0])], |all, bounds| all.union(bounds));
        let node = self.nodes.len();
        let count = if order.len() <= FEW { order.len() } else { 0 };
        self.nodes.push(TreeNode { bounds, first, count });
        if count > 0 {
            return;
        }
        let half = split(boxes, order, depth < UNEVEN_DEPTH);
        let (left, right) = order.split_at_mut(half);
        self.grow(left, first, depth + 1);
        self.nodes[node].first = self.nodes.len();
        self.grow(right, first + half, depth + 1);
    }
}
