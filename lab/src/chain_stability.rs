//! Failure modes of the chain: hostile frames, their measured figures, and the consequence for a user.
//!
//! Each finding is measured here, checked by a test of the same name and written into the documentation by the command line. No
//! figure on the page is typed by hand.

mod geometry;
mod numbers;
mod pictures;
mod shapes;
mod trial;

use std::fmt::Write as _;

use imaging::Rgb8;

pub use geometry::{a_cone_focuses_light, a_step_in_range, far_light_over_a_near_object, the_border};
pub use numbers::{
    a_tolerance_below_f32, bright_lamps, f32_against_f64, g_close_to_c, tiny_and_huge_spreads,
    very_short_and_very_long_ranges,
};
pub use shapes::{
    holes_of_every_kind, prime_sizes, radiance_that_is_no_number, single_pixels_and_lines, threads,
};

/// The limit of a figure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Limit {
    /// No more than this.
    AtMost(f64),
    /// At least this: the page shows a weakness and must be revised once it is fixed.
    AtLeast(f64),
}

/// One measured value.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// The measured quantity, with its unit.
    pub what: String,
    /// Its value.
    pub value: f64,
    /// Its limit.
    pub limit: Limit,
}

impl Figure {
    fn at_most(what: impl Into<String>, value: f64, limit: f64) -> Self {
        let (what, limit) = (what.into(), Limit::AtMost(limit));
        Self { what, value, limit }
    }

    fn at_least(what: impl Into<String>, value: f64, limit: f64) -> Self {
        let (what, limit) = (what.into(), Limit::AtLeast(limit));
        Self { what, value, limit }
    }

    /// Within its limit, and a number.
    #[must_use]
    pub fn holds(&self) -> bool {
        match self.limit {
            Limit::AtMost(limit) => self.value <= limit,
            Limit::AtLeast(limit) => self.value >= limit,
        }
    }
}

/// One experiment with its figures and their meaning.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// The test that checks it.
    pub test: &'static str,
    /// The experiment.
    pub tried: &'static str,
    /// The measurements.
    pub figures: Vec<Figure>,
    /// The consequence for a user.
    pub meaning: &'static str,
    /// Name, caption and picture, if a picture helps.
    pub picture: Option<(&'static str, &'static str, Rgb8)>,
}

impl Finding {
    /// Figures beyond their limits, as text.
    #[must_use]
    pub fn broken(&self) -> Vec<String> {
        let broken = self.figures.iter().filter(|figure| !figure.holds());
        broken
            .map(|f| format!("{}: {} is {:e}, limit {:?}", self.test, f.what, f.value, f.limit))
            .collect()
    }

    /// `depth step` for the test `depth_step`.
    #[must_use]
    pub fn title(&self) -> String {
        let mut title = self.test.replace('_', " ");
        if let Some(first) = title.get_mut(..1) {
            first.make_ascii_uppercase();
        }
        title
    }
}

/// Measures all findings, in the order of the page.
#[must_use]
pub fn findings() -> Vec<Finding> {
    vec![
        a_step_in_range(),
        far_light_over_a_near_object(),
        a_cone_focuses_light(),
        the_border(),
        tiny_and_huge_spreads(),
        g_close_to_c(),
        single_pixels_and_lines(),
        prime_sizes(),
        holes_of_every_kind(),
        radiance_that_is_no_number(),
        bright_lamps(),
        very_short_and_very_long_ranges(),
        f32_against_f64(),
        a_tolerance_below_f32(),
        threads(),
    ]
}

/// Writes the page in Markdown. `path` maps the name of a picture to its path.
#[must_use]
pub fn markdown(findings: &[Finding], about: &str, path: impl Fn(&str) -> String) -> String {
    let held = findings.iter().filter(|f| f.broken().is_empty()).count();
    let mut text = format!(
        "# Where the chain fails\n\nWritten by `fathom-lab stability --chain`; every section is the test of that name in \
         `lab/tests/chain_stability.rs`, which runs the same code against the limits in the tables. Errors are \
         the largest of a frame in linear light, against the f64 reference where nothing else is said. `≤` is a promise, `≥` \
         a weakness that is known.\n\n{about} {held} of {} hold.\n\n| what | worst figure | limit | holds |\n|---|---|---|---|\n",
        findings.len()
    );
    for finding in findings {
        let Some(worst) = finding.figures.first() else {
            continue;
        };
        let holds = if finding.broken().is_empty() {
            "yes"
        } else {
            "**no**"
        };
        let anchor = finding.test.replace('_', "-");
        let _ = writeln!(
            text,
            "| [{}](#{anchor}) | {}: {} | {} | {holds} |",
            finding.title(),
            worst.what,
            number(worst.value),
            limit(worst.limit)
        );
    }
    for finding in findings {
        let _ = write!(
            text,
            "\n## {}\n\n{}\n\n| figure | measured | limit |\n|---|---|---|\n",
            finding.title(),
            finding.tried
        );
        for figure in &finding.figures {
            let (value, limit) = (number(figure.value), limit(figure.limit));
            let _ = writeln!(text, "| {} | {value} | {limit} |", figure.what);
        }
        let _ = writeln!(text, "\n**For you:** {}", finding.meaning);
        if let Some((name, caption, _)) = &finding.picture {
            let _ = writeln!(text, "\n![{caption}]({})\n\n{caption}", path(name));
        }
    }
    text
}

fn limit(limit: Limit) -> String {
    match limit {
        Limit::AtMost(limit) => format!("≤ {}", number(limit)),
        Limit::AtLeast(limit) => format!("≥ {}", number(limit)),
    }
}

fn number(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        v if v < 0.01 || v >= 1e5 => format!("{value:.1e}"),
        v if v < 10.0 => format!("{value:.2}"),
        _ => format!("{value:.0}"),
    }
}
