//! Every finding of the page on failure modes of the chain stays within its limits. The page is generated from the same
//! measurements.

#![allow(clippy::unwrap_used)]

use lab::chain_stability::{self as chain, Finding, findings, markdown};

fn holds(finding: &Finding) {
    assert!(!finding.figures.is_empty());
    assert!(finding.broken().is_empty(), "{:#?}", finding.broken());
}

macro_rules! holds {
    ($($name:ident)*) => {
        $(#[test]
        fn $name() {
            let finding = chain::$name();
            assert_eq!(finding.test, stringify!($name));
            holds(&finding);
        })*

        const TESTS: &[&str] = &[$(stringify!($name)),*];
    };
}

holds! {
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
fn every_finding_of_the_page_is_a_test_and_a_broken_one_is_marked() {
    let mut all = findings();
    let names: Vec<&str> = all.iter().map(|finding| finding.test).collect();
    assert_eq!(names, TESTS);
    let page = markdown(&all, "", |name| format!("{name}.png"));
    assert!(!page.contains("**no**") && page.contains("![A dark pole"));
    all[0].figures[0].value = 1.0;
    assert!(markdown(&all, "", str::to_owned).contains("**no**"));
}
