//! The family `structure`: piles, braced legs, pipelines, plates and beams on a rippled seabed, as found under a jetty
//! or next to a platform. Six kinds of site, each with independent choices.

mod build;

use imaging::vector::vec3;

use crate::site::Site;
use crate::site::builder::{Heights, SiteBuilder, SiteView};
use crate::site::chance::Choices;
use crate::site::pose::{UP, ZERO, up};

pub(crate) fn site(seed: u64, burial: Option<f32>) -> Site {
    let dice = Choices::new(seed, "structure");
    let mut builder = SiteBuilder::new(seed, "structure");
    let kind = dice.count(0, 0, 5);
    let build::ViewTarget {
        target,
        distance,
        top,
    } = match kind {
        0 => builder.single_pile(),
        1 => builder.pile_row(),
        2 => builder.braced_legs(),
        3 => builder.pipeline(burial),
        4 => builder.plate_wall(),
        _ => builder.frame_of_beams(),
    };
    let nearby = vec3(0.0, -0.4, 0.0);
    builder.stones(dice.count(1, 4, 14), nearby, [3.4, 2.2], [0.05, 0.42]);
    builder.debris(dice.count(10, 1, 5), nearby, [3.0, 2.2]);
    for i in 0..dice.count(11, 1, 4) {
        let ground = builder.dice_for("ground").object(i);
        let place = ground.point_in(0, [-6.0, -1.0, 0.0], [6.0, 9.0, 0.0]);
        let radius = ground.uniform(2, 1.0, 3.5);
        builder.mound(place, radius, radius * ground.uniform(3, 0.06, 0.13));
    }
    let distance = distance * dice.uniform(2, 0.8, 1.35);
    let azimuth = dice.uniform(3, -0.9, 0.9);
    let side = vec3(libm::sinf(azimuth), -libm::cosf(azimuth), 0.0);
    let lift = dice.uniform(4, -0.12, 0.45) * distance;
    let eye = target + side * distance + up(lift);
    let eye = vec3(eye.x, eye.y, eye.z.max(0.5));
    let aim = target + vec3(dice.uniform(5, -0.2, 0.2), 0.0, dice.uniform(6, -0.15, 0.1)) * distance;
    let aim = if aim == eye { ZERO } else { aim };
    builder.site(&SiteView {
        eye,
        target: aim,
        travel: (aim - eye).cross(UP).normalized() * (0.7 * distance),
        roll: dice.uniform(7, -0.09, 0.09),
        lamp_m: (aim - eye).length() * dice.uniform(8, 0.85, 1.25),
        ambient: dice.uniform(9, 0.08, 0.35),
        floor: 0.0,
        heights: Heights::Camera([0.5, (0.65 * top).max(1.5)]),
        stretch: [0.85, 1.9],
        turn_deg: 15.0,
        least_structure: 0.08,
    })
}
