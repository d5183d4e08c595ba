//! Parsed faults.

use std::sync::atomic::{AtomicU64, Ordering};

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Action {
    Abort,
    Panic,
    Hang,
    Memory,
    Flag,
}

#[derive(Debug)]
enum When {
    Always,
    Nth { n: u64, passed: AtomicU64 },
    Frames { remainder: u64, modulus: Option<u64> },
}

#[derive(Debug)]
struct Fault {
    point: String,
    action: Action,
    when: When,
}

#[derive(Debug)]
pub(crate) struct Plan(Vec<Fault>);

impl Plan {
    /// Parses `POINT=ACTION[@N | #F | #R/M]`, separated by commas.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        text.split(',')
            .map(str::trim)
            .filter(|part| !part.is_empty())
            .map(parse_fault)
            .collect::<Result<_, _>>()
            .map(Self)
    }

    /// Returns the action for a passed point.
    pub(crate) fn passed(&self, point: &str, frame: Option<u64>) -> Option<Action> {
        let mut active = self
            .0
            .iter()
            .filter(|fault| fault.point == point && fault.when.is_now(frame));
        active.next().map(|fault| fault.action)
    }
}

impl When {
    fn is_now(&self, frame: Option<u64>) -> bool {
        match self {
            Self::Always => true,
            Self::Nth { n, passed } => passed.fetch_add(1, Ordering::SeqCst) + 1 == *n,
            Self::Frames { remainder, modulus } => {
                frame.is_some_and(|frame| modulus.map_or(frame, |modulus| frame % modulus) == *remainder)
            }
        }
    }
}

fn parse_fault(text: &str) -> Result<Fault, String> {
    parse_parts(text).ok_or_else(|| {
        format!("fault `{text}` is not POINT=ACTION, POINT=ACTION@N, POINT=ACTION#F or POINT=ACTION#R/M")
    })
}

fn parse_parts(text: &str) -> Option<Fault> {
    let (point, rest) = text.split_once('=')?;
    let (action, when) = if let Some((action, n)) = rest.split_once('@') {
        let (n, passed) = (n.parse().ok()?, AtomicU64::new(0));
        (action, When::Nth { n, passed })
    } else if let Some((action, frames)) = rest.split_once('#') {
        let (remainder, modulus) = match frames.split_once('/') {
            Some((remainder, modulus)) => (remainder.parse().ok()?, Some(modulus.parse().ok()?)),
            None => (frames.parse().ok()?, None),
        };
        if modulus == Some(0) {
            return None;
        }
        (action, When::Frames { remainder, modulus })
    } else {
        (rest, When::Always)
    };
    let action = match action {
        "abort" => Action::Abort,
        "panic" => Action::Panic,
        "hang" => Action::Hang,
        "memory" => Action::Memory,
        "flag" => Action::Flag,
        _ => return None,
    };
    Some(Fault {
        point: point.to_owned(),
        action,
        when,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fault_acts_only_on_the_passes_it_names() {
        let plan = Plan::parse("a=abort@3, b=flag#7 ,c=hang#1/4,d=panic").unwrap_or_else(|e| panic!("{e}"));
        let third: Vec<bool> = (0..4).map(|_| plan.passed("a", None).is_some()).collect();
        assert_eq!(third, [false, false, true, false]);
        assert_eq!(plan.passed("b", Some(7)), Some(Action::Flag));
        assert_eq!(plan.passed("b", Some(8)), None);
        assert_eq!(plan.passed("b", None), None);
        let hit: Vec<u64> = (0..10).filter(|&f| plan.passed("c", Some(f)).is_some()).collect();
        assert_eq!(hit, [1, 5, 9]);
        assert_eq!(plan.passed("d", Some(1)), Some(Action::Panic));
        assert_eq!(plan.passed("e", Some(1)), None);
    }

    #[test]
    fn malformed_faults_are_rejected() {
        for text in ["a", "a=burn", "a=abort@x", "a=abort#1/0", "=abort@"] {
            assert!(Plan::parse(text).is_err(), "{text}");
        }
        assert!(Plan::parse("").is_ok_and(|plan| plan.0.is_empty()));
    }
}
