//! Which form of the enhancement `ibla` runs.

use spec::Fidelity;

use super::Stage;
use super::line::{Line, with_errors};

/// A form of the method, which is a method of its own, too.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IblaForm {
    /// The method that is this form.
    pub method: &'static str,
    /// How far its results were measured to be from those of the exact form in linear light, 0 of that itself.
    pub distance: f64,
}

/// The form that runs.
#[derive(Debug, Clone, PartialEq)]
pub struct IblaStep {
    /// The method that is this form.
    pub method: &'static str,
    /// Why it is this one.
    why: String,
}

/// The fastest form whose distance is within the tolerance; the exact one where there is none. The distance is no bound: some frames
/// exceed it.
pub(super) fn choose(forms: &[IblaForm], fidelity: Fidelity) -> Option<Stage<IblaStep>> {
    let (exact, faster) = forms.split_first()?;
    let Fidelity::Tolerance(tolerance) = fidelity else {
        let why = "only a tolerance allows a faster form".to_owned();
        return Some(stage(exact, why, None));
    };
    let fits = |form: &&IblaForm| form.distance <= tolerance;
    Some(match faster.iter().rfind(fits) {
        Some(form) => stage(
            form,
            format!(
                "measured: {:.1e} from {} at most in 95 % of frames",
                form.distance, exact.method
            ),
            Some(tolerance),
        ),
        None => stage(exact, too_far(faster), None),
    })
}

fn stage(form: &IblaForm, why: String, share: Option<f64>) -> Stage<IblaStep> {
    Stage {
        form: IblaStep {
            method: form.method,
            why,
        },
        share,
        bound: None,
    }
}

fn too_far(faster: &[IblaForm]) -> String {
    let distances: Vec<String> = faster
        .iter()
        .map(|form| format!("{} {:.1e}", form.method, form.distance))
        .collect();
    format!("beyond the tolerance: {}", distances.join(", "))
}

pub(super) fn line(step: &Stage<IblaStep>) -> Line {
    Line {
        note: Some(step.form.why.clone()),
        ..with_errors("enhance.ibla", step.form.method, step)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FORMS: [IblaForm; 3] = [form("exact", 0.0), form("near", 0.015), form("far", 0.13)];

    const fn form(method: &'static str, distance: f64) -> IblaForm {
        IblaForm { method, distance }
    }

    #[test]
    fn a_tolerance_takes_the_fastest_form_within_it() {
        for (tolerance, method, note) in [
            (3e-4, "exact", "beyond the tolerance: near 1.5e-2, far 1.3e-1"),
            (0.0149, "exact", "beyond the tolerance: near 1.5e-2, far 1.3e-1"),
            (
                0.015,
                "near",
                "measured: 1.5e-2 from exact at most in 95 % of frames",
            ),
            (
                0.129,
                "near",
                "measured: 1.5e-2 from exact at most in 95 % of frames",
            ),
            (
                0.13,
                "far",
                "measured: 1.3e-1 from exact at most in 95 % of frames",
            ),
            (
                1.0,
                "far",
                "measured: 1.3e-1 from exact at most in 95 % of frames",
            ),
        ] {
            let stage = choose(&FORMS, Fidelity::Tolerance(tolerance)).unwrap();
            let line = line(&stage);
            assert_eq!((stage.form.method, line.variant), (method, method), "{tolerance}");
            assert_eq!(line.note.as_deref(), Some(note), "{tolerance}");
            assert_eq!(line.share, (method != "exact").then_some(tolerance));
            assert_eq!(line.bound, None);
        }
    }

    #[test]
    fn without_a_tolerance_the_exact_form_runs() {
        for fidelity in [
            Fidelity::REFERENCE,
            Fidelity::DISPLAY,
            Fidelity::NOISE,
            Fidelity::Terms(4),
        ] {
            let line = line(&choose(&FORMS, fidelity).unwrap());
            assert_eq!((line.variant, line.share), ("exact", None), "{fidelity:?}");
            assert_eq!(
                line.note.as_deref(),
                Some("only a tolerance allows a faster form")
            );
        }
    }

    #[test]
    fn a_frame_that_does_not_ask_for_it_has_no_line() {
        assert_eq!(choose(&[], Fidelity::Tolerance(1.0)), None);
    }
}
