//! Every finding of docs/science/stability.md stays within its limits.

use lab::chain::FINDINGS;

macro_rules! findings {
    ($($name:ident)*) => {
        $(#[test]
        fn $name() {
            let (_, measure) = FINDINGS.iter().find(|(name, _)| *name == stringify!($name)).expect("a finding");
            let finding = measure();
            assert!(!finding.figures.is_empty());
            assert!(finding.figures.iter().all(|figure| figure.is_within()), "{:#?}", finding.figures);
        })*

        const TESTS: &[&str] = &[$(stringify!($name)),*];
    };
}

findings! {
    a_step_in_range
    far_light_over_a_near_object
    a_cone_focuses_light
    the_border
    tiny_and_huge_spreads
    g_close_to_c
    single_pixels_and_lines
    prime_sizes
    holes_of_every_kind
    radiance_that_is_no_number
    bright_lamps
    very_short_and_very_long_ranges
    f32_against_f64
    a_tolerance_below_f32
    threads
}

#[test]
fn every_finding_has_a_test() {
    let names = FINDINGS.map(|(name, _)| name);
    assert_eq!(names, TESTS);
}

#[test]
fn a_figure_beyond_its_limit_is_found() {
    let mut figure = FINDINGS[3].1().figures.remove(0);
    assert!(figure.is_within());
    figure.value = f64::NAN;
    assert!(!figure.is_within());
    figure.value = 1.0;
    assert!(!figure.is_within());
}
