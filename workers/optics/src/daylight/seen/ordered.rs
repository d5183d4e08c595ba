//! Tracing in the order of directions. Rays about uneven normals leave a neighborhood in all directions; packets of such rays would
//! meet every solid of a scene.

use imaging::rays::{Rays, ShadowRays};

/// Cells of direction along each axis of the octahedral map.
const CELLS: usize = 16;

/// Traces rays in packets of similar directions. The results are those of [`Rays::trace_shadow_rays`] in the given order.
pub(super) fn trace_by_direction(rays: &dyn Rays, ways: &ShadowRays, clear: &mut Vec<bool>) {
    let order = sort_by_direction(ways);
    let sorted = ShadowRays {
        from: ways.from.each_ref().map(|axis| gather(axis, &order)),
        to: ways.to.each_ref().map(|axis| gather(axis, &order)),
    };
    let mut sorted_clear = vec![false; ways.len()];
    rays.trace_shadow_rays(&sorted, &mut sorted_clear);
    clear.clear();
    clear.resize(ways.len(), false);
    for (&ray, is_clear) in order.iter().zip(sorted_clear) {
        clear[ray as usize] = is_clear;
    }
}

fn gather(values: &[f32], order: &[u32]) -> Vec<f32> {
    order.iter().map(|&ray| values[ray as usize]).collect()
}

/// Indices of the rays by the cell of their direction; within a cell in the given order.
fn sort_by_direction(ways: &ShadowRays) -> Vec<u32> {
    let cells: Vec<u16> = (0..ways.len()).map(|ray| cell_of(ways, ray)).collect();
    let mut starts = [0u32; CELLS * CELLS + 1];
    for &cell in &cells {
        starts[usize::from(cell) + 1] += 1;
    }
    for cell in 0..CELLS * CELLS {
        starts[cell + 1] += starts[cell];
    }
    let mut order = vec![0u32; cells.len()];
    for (ray, &cell) in cells.iter().enumerate() {
        let next = &mut starts[usize::from(cell)];
        order[*next as usize] = ray as u32;
        *next += 1;
    }
    order
}

/// The cell of a ray's direction on the octahedral map (Cigolle et al. 2014), row by row, alternate rows backwards.
fn cell_of(ways: &ShadowRays, ray: usize) -> u16 {
    let [x, y, z] = [0, 1, 2].map(|axis| ways.to[axis][ray] - ways.from[axis][ray]);
    let length = (x.abs() + y.abs() + z.abs()).max(f32::MIN_POSITIVE);
    let (x, y) = (x / length, y / length);
    let (x, y) = if z < 0.0 {
        ((1.0 - y.abs()).copysign(x), (1.0 - x.abs()).copysign(y))
    } else {
        (x, y)
    };
    // A saturating cast: NaN is cell 0.
    let [column, row] = [x, y].map(|v| ((0.5 * v + 0.5) * CELLS as f32) as usize);
    let [column, row] = [column, row].map(|cell| cell.min(CELLS - 1));
    let column = if row % 2 == 0 { column } else { CELLS - 1 - column };
    (row * CELLS + column) as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rays_about(count: usize) -> ShadowRays {
        let mut ways = ShadowRays::default();
        for k in 0..count {
            let angle = 2.4 * k as f32;
            let height = 1.0 - 2.0 * (k as f32 + 0.5) / count as f32;
            let across = (1.0 - height * height).sqrt();
            ways.push([0.0; 3], [across * angle.cos(), across * angle.sin(), height]);
        }
        ways
    }

    #[test]
    fn every_ray_has_one_position() {
        let mut order = sort_by_direction(&rays_about(1000));
        order.sort_unstable();
        assert!(order.iter().enumerate().all(|(at, &ray)| at as u32 == ray));
    }

    #[test]
    fn rays_of_one_packet_have_similar_directions() {
        let ways = rays_about(8192);
        let order = sort_by_direction(&ways);
        let direction = |ray: u32| [0, 1, 2].map(|axis| ways.to[axis][ray as usize]);
        let mut angles = Vec::new();
        for packet in order.chunks(64) {
            let first = direction(packet[0]);
            let cosines = packet.iter().map(|&ray| {
                let other = direction(ray);
                (0..3).map(|axis| first[axis] * other[axis]).sum::<f32>()
            });
            angles.push(cosines.fold(1.0, f32::min).clamp(-1.0, 1.0).acos());
        }
        angles.sort_by(f32::total_cmp);
        let median = angles[angles.len() / 2];
        // Two cells wide; rays of all directions are up to 3.14 apart.
        assert!(median < 0.6, "{median}");
    }

    #[test]
    fn rays_of_one_direction_keep_their_order() {
        let mut ways = ShadowRays::default();
        (0..100).for_each(|k| ways.push([k as f32, 0.0, 0.0], [k as f32, 1.0, 2.0]));
        assert!(
            sort_by_direction(&ways)
                .iter()
                .enumerate()
                .all(|(at, &ray)| at as u32 == ray)
        );
    }
}
