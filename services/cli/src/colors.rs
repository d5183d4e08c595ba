//! Colors of classes, instances and findings, and a ramp for lengths.

use scenes::categories::FINDINGS;

/// Colors of the categories by number: a dark background, bright objects of inspections.
const CATEGORY_COLORS: [[u8; 3]; 21] = [
    [24, 38, 56],
    [176, 148, 104],
    [230, 159, 0],
    [204, 94, 0],
    [150, 74, 36],
    [130, 160, 190],
    [86, 180, 233],
    [240, 228, 66],
    [255, 105, 180],
    [120, 120, 130],
    [0, 158, 115],
    [160, 90, 210],
    [110, 130, 110],
    [214, 39, 40],
    [150, 160, 120],
    [255, 255, 255],
    [255, 150, 120],
    [60, 200, 60],
    [170, 240, 255],
    [0, 90, 255],
    [110, 60, 20],
];
/// Colors of the findings by their bits: crack, corrosion, spalling, joint, growth, coating damage.
const FINDING_COLORS: [[u8; 3]; 6] = [
    [255, 40, 40],
    [255, 140, 0],
    [250, 240, 60],
    [70, 150, 255],
    [60, 210, 90],
    [230, 90, 230],
];
/// Viridis (S. van der Walt, N. Smith, 2015) at equal steps, the far end first.
const RAMP: [[u8; 3]; 9] = [
    [68, 1, 84],
    [71, 45, 123],
    [59, 82, 139],
    [44, 114, 142],
    [33, 145, 140],
    [40, 174, 128],
    [94, 201, 98],
    [173, 220, 48],
    [253, 231, 37],
];

/// The color of a category; unknown numbers get colors like instances.
#[must_use]
pub fn category(number: u8) -> [u8; 3] {
    let known = CATEGORY_COLORS.get(usize::from(number));
    known.copied().unwrap_or_else(|| instance(number.into()))
}

/// The color of an instance, far in hue from that of its neighbors in number; 0 is the background.
#[must_use]
pub fn instance(number: u16) -> [u8; 3] {
    if number == 0 {
        return CATEGORY_COLORS[0];
    }
    // The golden angle: any run of numbers is spread over the circle.
    let hue = (f64::from(number) * 0.618_033_988_75).fract() * 6.0;
    let light = if number.is_multiple_of(2) { 235.0 } else { 175.0 };
    [5.0, 3.0, 1.0].map(|offset| {
        let place = (offset + hue) % 6.0;
        let share = place.min(4.0 - place).clamp(0.0, 1.0);
        (light * (1.0 - 0.75 * share)) as u8
    })
}

/// The color of the first finding of a pixel; `None` without findings.
#[must_use]
pub fn finding(bits: u8) -> Option<[u8; 3]> {
    let mut known = FINDINGS.iter().zip(FINDING_COLORS);
    known
        .find(|((finding, _), _)| bits & finding.bit() != 0)
        .map(|(_, color)| color)
}

/// The color of a share of a ramp, 0 at its near and bright end.
#[must_use]
pub fn ramp(share: f64) -> [u8; 3] {
    let place = (1.0 - share.clamp(0.0, 1.0)) * (RAMP.len() - 1) as f64;
    let low = (place as usize).min(RAMP.len() - 2);
    let part = place - low as f64;
    [0, 1, 2].map(|channel| {
        let (from, to) = (f64::from(RAMP[low][channel]), f64::from(RAMP[low + 1][channel]));
        (from + (to - from) * part).round() as u8
    })
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use scenes::categories::CATEGORIES;

    use super::*;

    #[test]
    fn every_category_and_finding_has_a_color_of_its_own() {
        assert_eq!(CATEGORIES.len(), CATEGORY_COLORS.len());
        assert_eq!(FINDINGS.len(), FINDING_COLORS.len());
        let categories: BTreeSet<_> = (0..=u8::MAX).map(category).take(CATEGORIES.len()).collect();
        assert_eq!(categories.len(), CATEGORIES.len());
        let found: BTreeSet<_> = FINDINGS
            .iter()
            .filter_map(|(found, _)| finding(found.bit()))
            .collect();
        assert_eq!((found.len(), finding(0)), (FINDINGS.len(), None));
    }

    #[test]
    fn neighbors_in_number_differ_clearly() {
        for number in 0..200 {
            let (one, next) = (instance(number), instance(number + 1));
            let apart: u32 = one.iter().zip(next).map(|(a, b)| u32::from(a.abs_diff(b))).sum();
            assert!(apart > 100, "{number}: {one:?} {next:?}");
        }
    }

    #[test]
    fn the_ramp_runs_from_bright_to_dark() {
        assert_eq!((ramp(0.0), ramp(1.0), ramp(7.0)), (RAMP[8], RAMP[0], RAMP[0]));
        let sum = |share: f64| ramp(share).iter().map(|&v| u32::from(v)).sum::<u32>();
        assert!((0..100).all(|step| sum(f64::from(step) / 100.0) >= sum(f64::from(step + 1) / 100.0)));
    }
}
