//! The measured choices of fidelity and effects, and the line of a job for each.

use optics::plan::StageId;
use serde_json::{Value, json};
use spec::Fidelity;

/// Tolerances, linear light.
const TOLERANCES: [f64; 6] = [0.1, 0.03, 0.01, 0.003, 0.001, 0.0003];
/// Budgets as shares of the planned cost of the default fidelity.
const BUDGET_SHARES: [f64; 7] = [0.85, 0.7, 0.55, 0.4, 0.3, 0.2, 0.1];
/// Numbers of kernels.
const TERMS: [usize; 3] = [2, 4, 8];

/// The kind of a choice: one color of the chart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Picture,
    Tolerance,
    Budget,
    Terms,
    Reference,
    Without,
}

impl Kind {
    pub(super) const ALL: [Self; 6] = [
        Self::Picture,
        Self::Tolerance,
        Self::Budget,
        Self::Terms,
        Self::Reference,
        Self::Without,
    ];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Picture => "picture",
            Self::Tolerance => "tolerance",
            Self::Budget => "budget_ms",
            Self::Terms => "terms",
            Self::Reference => "reference",
            Self::Without => "without an effect",
        }
    }
}

/// A choice of fidelity, possibly without one effect.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Variant {
    pub(super) fidelity: Fidelity,
    /// The effect that is left out in addition to those of the fidelity.
    pub(super) without: Option<StageId>,
    /// Whether it is the fidelity of the job.
    pub(super) is_described: bool,
}

impl Variant {
    /// A fidelity with all of its effects.
    pub(super) fn plain(fidelity: Fidelity) -> Self {
        Self {
            fidelity,
            without: None,
            is_described: false,
        }
    }

    pub(super) fn kind(&self) -> Kind {
        match self.fidelity {
            _ if self.without.is_some() => Kind::Without,
            Fidelity::Picture => Kind::Picture,
            Fidelity::Tolerance(_) => Kind::Tolerance,
            Fidelity::BudgetMs(_) => Kind::Budget,
            Fidelity::Terms(_) => Kind::Terms,
            Fidelity::Reference => Kind::Reference,
        }
    }

    /// The value of the field `fidelity`; null for a choice that no job can make.
    pub(super) fn value(&self) -> Value {
        match self.fidelity {
            _ if self.without.is_some() => Value::Null,
            Fidelity::Picture => json!("picture"),
            Fidelity::Reference => json!("reference"),
            Fidelity::Tolerance(tolerance) => json!({"tolerance": tolerance}),
            Fidelity::Terms(terms) => json!({"terms": terms}),
            Fidelity::BudgetMs(budget_ms) => json!({"budget_ms": shorten(budget_ms)}),
        }
    }

    /// The line to write in a job, or the missing effect.
    pub(super) fn name(&self) -> String {
        match self.without {
            Some(id) => format!("without {}", id.name()),
            None => format!("\"fidelity\": {}", self.value().to_string().replace(':', ": ")),
        }
    }

    /// A short name next to a point of the chart; empty if the legend is enough.
    pub(super) fn label(&self) -> String {
        match (self.without, self.fidelity) {
            (Some(id), _) => id.name().to_owned(),
            (_, Fidelity::Picture | Fidelity::Reference) => String::new(),
            (_, Fidelity::Tolerance(tolerance)) => tolerance.to_string(),
            (_, Fidelity::Terms(terms)) => terms.to_string(),
            (_, Fidelity::BudgetMs(budget_ms)) => budget_ms.to_string(),
        }
    }
}

/// The fidelities to measure besides that of the job, for a planned cost of the default in ms.
pub(super) fn list_fidelities(described: Fidelity, planned_ms: Option<f64>) -> Vec<Variant> {
    let tolerances = TOLERANCES.map(Fidelity::Tolerance).into_iter();
    let budgets = planned_ms.into_iter().flat_map(|planned_ms| {
        let budgets = BUDGET_SHARES.map(|share| Fidelity::BudgetMs(round(share * planned_ms)));
        budgets
            .into_iter()
            .filter(|budget| *budget != Fidelity::BudgetMs(0.0))
    });
    let fidelities = [Fidelity::Picture].into_iter().chain(tolerances).chain(budgets);
    let fidelities = fidelities.chain(TERMS.map(Fidelity::Terms));
    let fidelities = fidelities.chain([Fidelity::Reference]);
    let others = fidelities.filter(|fidelity| *fidelity != described);
    others.map(Variant::plain).collect()
}

/// Two significant digits.
fn round(ms: f64) -> f64 {
    if ms <= 0.0 {
        return 0.0;
    }
    let unit = 10_f64.powf(ms.log10().floor() - 1.0);
    let rounded = (ms / unit).round() * unit;
    // Removes the binary rest of the unit.
    (rounded * 1e6).round() / 1e6
}

/// A whole number without a decimal point.
fn shorten(number: f64) -> Value {
    if number.fract() == 0.0 && number < 1e15 {
        json!(number as u64)
    } else {
        json!(number)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_fidelity_is_a_line_that_a_job_accepts() {
        let variants = list_fidelities(Fidelity::Picture, Some(187.3));
        assert!(
            variants
                .iter()
                .all(|variant| variant.fidelity != Fidelity::Picture)
        );
        assert!(
            variants
                .iter()
                .any(|variant| variant.name() == "\"fidelity\": {\"budget_ms\": 160}")
        );
        let vocabulary = renderer::vocabulary(&style::Library::embedded().unwrap(), true);
        for variant in variants {
            let job = format!("{{\"site\": \"tank\", {}}}", variant.name());
            let job = spec::Job::parse(job.as_bytes(), &vocabulary).unwrap();
            assert_eq!(job.resolve(0).unwrap().fidelity, variant.fidelity);
        }
    }

    #[test]
    fn an_effect_alone_cannot_be_written() {
        let variant = Variant {
            without: Some(StageId::LampShadows),
            ..Variant::plain(Fidelity::Picture)
        };
        assert_eq!(
            (variant.value(), variant.name().as_str()),
            (Value::Null, "without lamp_shadows")
        );
    }

    #[test]
    fn budgets_have_two_digits() {
        assert_eq!([187.3, 9.46, 0.123].map(round), [190.0, 9.5, 0.12]);
    }
}
