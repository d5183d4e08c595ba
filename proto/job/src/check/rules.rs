//! Rules across fields, as declared in the schema; see [`Rule`].

use super::Checker;
use super::present::{Contents, Present, top_of};
use crate::invalid::{FieldError, quote};
use crate::node::Node;
use crate::schema::{Rule, TRACED, describe};

impl Checker<'_> {
    /// Checks the rules of every given field. Rules that involve an invalid field are skipped.
    pub(super) fn check_rules(&mut self, contents: &Contents<'_>) {
        let wrong: Vec<_> = self.errors.iter().map(|error| error.pointer.clone()).collect();
        for present in contents.fields.iter().filter(|present| present.is_given()) {
            let situation = Situation {
                present,
                contents,
                wrong: &wrong,
            };
            for rule in present.field.rules {
                if let Some(message) = situation.find_problem(rule) {
                    self.refuse(|| {
                        FieldError::new(&present.location.pointer, message)
                            .value(&present.node.canonical())
                            .limit(rule.to_string())
                    });
                }
            }
        }
    }
}

/// A field under check.
struct Situation<'a> {
    present: &'a Present<'a>,
    contents: &'a Contents<'a>,
    /// Pointers of the errors so far.
    wrong: &'a [String],
}

impl Situation<'_> {
    /// Describes how the field breaks this rule.
    fn find_problem(&self, rule: &Rule) -> Option<String> {
        let Present {
            location,
            object,
            node,
            ..
        } = self.present;
        let subject = match node {
            Node::Constant(value) => format!("{location} is {}", quote(value)),
            _ => format!("{location} is given"),
        };
        match rule {
            Rule::Needs(paths) => (!paths.iter().any(|path| self.is_given(path))).then(|| {
                let remedy = if paths.len() == 1 { "it" } else { "one of them" };
                format!(
                    "{subject}, but needs {}: add {remedy}, or remove {location}",
                    self.name(paths)
                )
            }),
            Rule::NeedsAlways(path) => (!self.is_wrong(path) && !self.contents.is_certain(path))
                .then(|| format!("{subject}, but {rule}: change the others, or remove {location}")),
            Rule::Excludes(paths) => paths.iter().find(|path| self.has(path)).map(|path| {
                format!(
                    "{subject}, which cannot be combined with {}; remove one of them",
                    self.name(&[path])
                )
            }),
            Rule::Untraced(reason) => TRACED.iter().find(|path| self.is_given(path)).map(|path| {
                format!(
                    "{subject}, which cannot be combined with {}: {reason}; remove one of them",
                    describe(&[path])
                )
            }),
            Rule::Below(path) => {
                let (value, limit) = (node.greatest()?, object.get(path)?.least()?);
                (value >= limit).then(|| {
                    format!(
                        "{location} is {value}; must be below {}, which is {limit}",
                        self.name(&[path])
                    )
                })
            }
            Rule::AtMost(path) => {
                let (value, limit) = (node.greatest()?, object.get(path)?.least()?);
                (value > limit).then(|| {
                    format!(
                        "{location} is {value}; must be at most {}, which is {limit}",
                        self.name(&[path])
                    )
                })
            }
            Rule::Odd => has_even(node).then(|| {
                format!(
                    "{location} can be even, {}; must be odd: a window has a middle",
                    quote(&node.canonical())
                )
            }),
            Rule::Differs(path) => (object.get(path)?.canonical() == node.canonical()).then(|| {
                format!(
                    "{location} is the same as {}: change one of them",
                    self.name(&[path])
                )
            }),
            Rule::NonZero => is_zero(node).then(|| {
                format!("{location} is [0, 0, 0], which has no direction: its length must be above 0")
            }),
        }
    }

    /// Whether a field of the same object, or a path of the same frame, is given, valid or not.
    fn is_given(&self, path: &str) -> bool {
        self.is_wrong(path)
            || if is_sibling(path) {
                self.present.object.get(path).is_some()
            } else {
                self.contents.has_given(path, self.own_branch())
            }
    }

    /// Whether it is present, given or by default.
    fn has(&self, path: &str) -> bool {
        if is_sibling(path) {
            self.present.object.get(path).is_some()
        } else {
            self.contents.has(path, self.own_branch())
        }
    }

    /// Whether the field at this path has errors.
    fn is_wrong(&self, path: &str) -> bool {
        let pointer = if is_sibling(path) {
            let (parent, _) = self.present.location.pointer.rsplit_once('/').unwrap_or_default();
            format!("{parent}/{path}")
        } else {
            format!("/{}", top_of(path))
        };
        self.wrong.iter().any(|error| error.starts_with(&pointer))
    }

    /// The names of these fields in messages; siblings by their whole paths.
    fn name(&self, paths: &[&str]) -> String {
        let parent = self.present.location.name.rsplit_once('.');
        let names: Vec<_> = paths
            .iter()
            .map(|path: &&str| match parent {
                Some((parent, _)) if is_sibling(path) => format!("{parent}.{path}"),
                _ => (*path).to_owned(),
            })
            .collect();
        describe(&names)
    }

    fn own_branch(&self) -> Option<(&str, usize)> {
        Some((top_of(&self.present.location.name), self.present.branch))
    }
}

fn is_sibling(path: &str) -> bool {
    !path.contains('.')
}

/// Whether a whole number can be even; an interval of several numbers has an even one.
fn has_even(number: &Node) -> bool {
    number.alternatives("").into_iter().any(|(_, node)| {
        let (least, greatest) = (node.least(), node.greatest());
        least != greatest || least.is_some_and(|number| number % 2.0 == 0.0)
    })
}

/// Whether a list contains only the constant 0.
fn is_zero(list: &Node) -> bool {
    matches!(list, Node::List(axis) if axis.iter().all(|node: &Node| matches!(node, Node::Constant(value) if value.as_f64() == Some(0.0))))
}
