//! Concrete and masonry: joints, pores, stains, cracks along level lines of noise, and spalls that expose rusting bars.

use imaging::vectorized;

use super::pattern::{Joints, boards, courses};
use super::surface::{Grain, Surface, SurfaceFinish, line};
use super::{JointPattern, Unroll, steel};
use crate::categories::Finding;
use crate::site::lanes::{LANES, floor, larger, load, mix, ramp};
use crate::site::lattice::NoiseSample;
use crate::site::noise::Octaves;

const DIRT: [f32; 3] = [0.62, 0.55, 0.42];
/// Fresh break: paler, in the colors of the aggregate.
const BROKEN: [f32; 3] = [0.30, 0.275, 0.235];
/// Half the width of the widest crack, m.
const CRACK_M: f32 = 0.0038;
/// Spacing and half thickness of reinforcement, m.
const BAR_PITCH_M: f32 = 0.16;
const BAR_M: f32 = 0.009;

impl SurfaceFinish {
    pub(super) fn concrete(&self, pattern: &JointPattern, grain: &Grain<'_>, surface: &mut Surface) {
        let mut joints = Joints::NONE;
        match pattern {
            JointPattern::Boards => vectorized!(boards(&mut joints, grain, self.direction)),
            JointPattern::Courses(pieces) => {
                let around = match pieces.unroll {
                    Unroll::Round { radius } => (std::f32::consts::TAU * radius / pieces.length).round(),
                    Unroll::Walls { .. } => 1e6,
                };
                vectorized!(courses(&mut joints, pieces, around, self.key, grain.points));
            }
        }
        let place = &grain.points.place;
        let pores = place.dots(24.0, 0.22, 0.5, self.key ^ 0x77);
        let cracks = place.noise(Octaves::even(0.9, 2, self.key ^ 0x3d));
        vectorized!(cast(self, &joints, &pores, &cracks, grain, surface));
    }
}

#[inline(always)]
fn cast(
    finish: &SurfaceFinish,
    joints: &Joints,
    pores: &NoiseSample,
    cracks: &NoiseSample,
    grain: &Grain<'_>,
    surface: &mut Surface,
) {
    let (base, wear, phase) = (finish.base, finish.wear, finish.direction);
    let Grain { points, broad, fine } = *grain;
    let (local, footprint, edge) = (points.local, points.place.footprint, points.edge);
    // Threshold of the noise for a spall.
    let spalling = 0.55 * wear - 0.14;
    for i in 0..LANES {
        let (speck, broad) = (fine.value[i], broad.value[i]);
        let field = cracks.value[i];
        let steep = load(&cracks.slope, i);
        let climb = larger(steep.length(), 0.2);
        let steep: [f32; 3] = steep.into();
        // A crack follows a level line where the broad noise allows it.
        let open = ramp(0.8 * broad + wear, -0.05, 0.25);
        let width = CRACK_M * (0.35 + 0.65 * open) * if open > 0.0 { 1.0 } else { 0.0 };
        let away = (field - 0.06 * speck).abs() / climb;
        let crack = open * line(away, width, footprint[i]);
        let broken = field + spalling + 0.12 * speck + 0.2 * edge[i];
        let spall = ramp(broken, 0.36, 0.43);
        let rim = 4.0 * spall * (1.0 - spall);
        // Deep spalls expose the bars.
        let along = local[2][i] / BAR_PITCH_M + phase;
        let bar_away = (along - floor(along + 0.5)).abs() * BAR_PITCH_M;
        let bar = ramp(broken, 0.47, 0.52) * line(bar_away, BAR_M, footprint[i]);
        let weep = ramp(broken, 0.2, 0.42) * 0.6;

        let stain = ramp(broad + wear, 0.1, 0.7);
        let joint = joints.joint[i];
        let shade = joints.tint[i] * (1.0 + 0.16 * broad + 0.2 * speck)
            - 0.45 * joint
            - 0.5 * pores.value[i] * (1.0 - spall)
            - 0.5 * joints.pocket[i];
        for c in 0..3 {
            let face = base[c] * larger(shade, 0.12) * mix(1.0, DIRT[c], larger(stain, weep));
            let stone = BROKEN[c] * (0.8 + 0.7 * speck + 0.25 * broad);
            let bared = mix(stone, steel::rust_albedo(c, 0.5 + 0.5 * speck), bar);
            surface.albedo[c][i] = mix(face, bared, spall) * (1.0 - 0.85 * crack);
        }
        let (grain, pit) = (0.003 + 0.009 * spall, 0.006 * (1.0 - spall));
        for axis in 0..3 {
            surface.slope[axis][i] = grain * fine.slope[axis][i] - pit * pores.slope[axis][i]
                + (1.0 - spall) * joints.slope[axis][i]
                - 0.7 * rim * steep[axis] / climb;
        }
        surface.gloss[i] = 0.03;
        let resolved = width > 0.1 * footprint[i];
        let cracked = (away < larger(width, 0.5 * footprint[i])) & resolved & (open > 0.5);
        let whole = 1.0 - spall;
        let findings = &mut surface.findings;
        findings[Finding::Spalling as usize][i] = spall;
        findings[Finding::Corrosion as usize][i] = bar;
        set_where(&mut findings[Finding::Crack as usize][i], whole, cracked);
        set_where(&mut findings[Finding::Joint as usize][i], whole, joint > 0.3);
    }
}

#[inline(always)]
fn set_where(finding: &mut f32, value: f32, condition: bool) {
    *finding = if condition { value } else { 0.0 };
}
