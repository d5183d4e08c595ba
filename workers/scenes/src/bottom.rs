//! Effects of current and grain size on the bottom: scour pits around feet and a second scale of texture.

use imaging::vector::{Vec3, vec3};
use spec::Ground;

use crate::categories::Category;
use crate::site::Site;
use crate::site::finish::Material;
use crate::site::pits::{Pit, depth};
use crate::site::pose::up;
use crate::site::solid::{Solid, SolidShape};

/// Limit on pits per site: every ray is tested against each.
const MOST_PITS: usize = 8;
/// Width of a pit next to its foot divided by its depth: steeper sand slides.
const SLOPE: f32 = 2.5;
/// Wider feet (walls) get no pit, m.
const WIDEST_M: f32 = 3.0;

struct Foot {
    place: Vec3,
    diameter: f32,
    solid: usize,
}

/// Applies the description of the bottom.
pub(crate) fn dig(site: &mut Site, ground: &Ground) {
    let grain = ground.grain as f32;
    let objects = site.objects.iter_mut();
    let of_grains =
        objects.filter(|object| matches!(object.finish.material, Material::Sand | Material::Stone));
    of_grains.for_each(|object| object.finish.grain = grain);
    if ground.scour > 0.0 {
        scour(site, ground.scour as f32);
    }
}

/// Digs a pit around the nearest feet, `depth` diameters deep. Currents dig 1.3 diameters around piles on average (Sumer and
/// Fredsøe 2002).
fn scour(site: &mut Site, share: f32) {
    let target = site.target.as_f32();
    let mut feet: Vec<Foot> = (0..site.solids.len())
        .filter_map(|solid| foot(site, solid))
        .collect();
    feet.sort_by(|a, b| horizontal_square(a.place - target).total_cmp(&horizontal_square(b.place - target)));
    let mut pits: Vec<Pit> = Vec::new();
    for foot in &feet {
        let deep = share * foot.diameter;
        let pit = Pit::new(foot.place, 0.5 * foot.diameter + SLOPE * deep, deep);
        let is_separate = pits
            .iter()
            .all(|other| (other.place - pit.place).length() > 0.6 * (other.radius + pit.radius));
        if pits.len() < MOST_PITS && is_separate {
            pits.push(pit);
        }
    }
    let deepest = pits
        .iter()
        .map(|pit| pit.depth(pit.place.x, pit.place.y))
        .fold(0.0, f32::max);
    for foot in &feet {
        lengthen(&mut site.solids[foot.solid], deepest + 0.3);
    }
    // Objects in the scour area drop into the pit.
    for solid in &mut site.solids {
        let category = site.objects[usize::from(solid.object)].category;
        if matches!(category, Category::Stone | Category::Debris | Category::Cable)
            && solid.pose.origin.z < 1.0
        {
            let place = solid.pose.origin;
            solid.pose.origin = place - up(depth(&pits, place.x, place.y));
        }
    }
    // Remove mounds cut by a pit.
    site.solids
        .retain(|solid| !(solid.object == 0 && is_cut(solid, &pits)));
    site.pits = pits;
}

/// The foot of an upright tube or block that stands in or on the ground.
fn foot(site: &Site, number: usize) -> Option<Foot> {
    let solid = &site.solids[number];
    let category = site.objects[usize::from(solid.object)].category;
    let stands = matches!(
        category,
        Category::Pile | Category::Support | Category::Beam | Category::Brace | Category::Fitting
    );
    let axis = solid.pose.axes[2];
    if !stands || axis.z.abs() < 0.7 {
        return None;
    }
    let origin = solid.pose.origin;
    let (low, diameter) = match solid.shape {
        SolidShape::Tube(tube) => {
            let end = origin + axis * tube.length;
            (if axis.z > 0.0 { origin } else { end }, 2.0 * tube.radius)
        }
        SolidShape::SolidBox(block) => (origin - up(block.half.z), 2.0 * block.half.x.max(block.half.y)),
        _ => return None,
    };
    let place = low + axis * (-low.z / axis.z);
    (low.z < 0.06 && diameter < WIDEST_M).then_some(Foot {
        place: vec3(place.x, place.y, 0.0),
        diameter,
        solid: number,
    })
}

fn lengthen(solid: &mut Solid, by: f32) {
    let axis = solid.pose.axes[2];
    match &mut solid.shape {
        SolidShape::Tube(tube) => {
            tube.length += by;
            if axis.z > 0.0 {
                solid.pose.origin = solid.pose.origin - axis * by;
            }
        }
        SolidShape::SolidBox(block) => {
            block.half.z += 0.5 * by;
            solid.pose.origin = solid.pose.origin - up(0.5 * by);
        }
        _ => {}
    }
}

fn is_cut(mound: &Solid, pits: &[Pit]) -> bool {
    let SolidShape::Ellipsoid(ball) = mound.shape else {
        return false;
    };
    let (center, radius) = (mound.pose.origin, ball.radii.x);
    let wide = (radius * radius - center.z * center.z).max(0.0).sqrt();
    pits.iter().any(|pit| {
        let away = pit.place - vec3(center.x, center.y, 0.0);
        away.length() < pit.radius + wide
    })
}

fn horizontal_square(v: Vec3) -> f32 {
    v.x * v.x + v.y * v.y
}
