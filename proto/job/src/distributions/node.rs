//! The checked description as a tree of constants and distributions.

mod draw;

use std::collections::BTreeMap;

use imaging::random::Stream;
use serde_json::Value;

/// A value of the checked description.
#[derive(Debug, Clone)]
pub(crate) enum Node {
    /// A scalar.
    Constant(Value),
    /// A list.
    List(Vec<Node>),
    /// An object with unique keys, sorted on output.
    Object(Vec<(String, Node)>),
    /// A distribution.
    Law(Box<LawNode>),
}

impl Node {
    /// The value with every distribution replaced by the result of `draw`.
    pub(crate) fn value(&self, draw: &impl Fn(&LawNode) -> Drawn) -> Value {
        self.with_laws(&|law| match draw(law) {
            Drawn::Number(number) => number,
            Drawn::One(position) => law.values()[position].value(draw),
        })
    }

    /// The canonical form, with distributions.
    pub(crate) fn canonical(&self) -> Value {
        self.with_laws(&LawNode::canonical)
    }

    /// The value with every outermost distribution replaced by `law_value`; keys sorted.
    fn with_laws(&self, law_value: &dyn Fn(&LawNode) -> Value) -> Value {
        match self {
            Self::Constant(value) => value.clone(),
            Self::List(items) => items.iter().map(|item| item.with_laws(law_value)).collect(),
            Self::Object(fields) => fields
                .iter()
                .map(|(key, node)| (key.clone(), node.with_laws(law_value)))
                .collect::<BTreeMap<_, _>>()
                .into_iter()
                .collect(),
            Self::Law(law) => law_value(law),
        }
    }

    /// The pointer of the field at `path` with distributions drawn by `draw`, or of its deepest existing parent.
    /// `pointer` is the location of this node.
    pub(crate) fn locate(&self, pointer: &str, path: &[&str], draw: &impl Fn(&LawNode) -> Drawn) -> String {
        if let Self::Law(law) = self
            && let Drawn::One(position) = draw(law)
        {
            return law.values()[position].locate(&format!("{pointer}/{}/{position}", law.key()), path, draw);
        }
        match path
            .split_first()
            .and_then(|(name, rest)| Some((name, self.get(name)?, rest)))
        {
            Some((name, node, rest)) => node.locate(&format!("{pointer}/{name}"), rest, draw),
            None => pointer.to_owned(),
        }
    }

    /// All distributions of this tree, including nested ones, outer before inner.
    pub(crate) fn laws(&self) -> Vec<&LawNode> {
        let mut found = Vec::new();
        self.visit(&mut |law| found.push(law));
        found
    }

    fn visit<'a>(&'a self, seen: &mut impl FnMut(&'a LawNode)) {
        match self {
            Self::Constant(_) => {}
            Self::List(items) => items.iter().for_each(|item| item.visit(seen)),
            Self::Object(fields) => fields.iter().for_each(|(_, node)| node.visit(seen)),
            Self::Law(law) => {
                seen(law);
                law.values().iter().for_each(|value| value.visit(seen));
            }
        }
    }

    /// Changes every distribution of this tree.
    pub(crate) fn change_laws(&mut self, change: &mut impl FnMut(&mut LawNode)) {
        match self {
            Self::Constant(_) => {}
            Self::List(items) => items.iter_mut().for_each(|item| item.change_laws(change)),
            Self::Object(fields) => fields.iter_mut().for_each(|(_, node)| node.change_laws(change)),
            Self::Law(law) => {
                change(law);
                law.values_mut()
                    .iter_mut()
                    .for_each(|value| value.change_laws(change));
            }
        }
    }

    /// The field of an object; `None` for other nodes.
    pub(crate) fn get(&self, name: &str) -> Option<&Self> {
        let Self::Object(fields) = self else { return None };
        fields.iter().find(|(key, _)| key == name).map(|(_, node)| node)
    }

    /// The possible values after expanding choices and grids, each with its pointer. `pointer` is the location of
    /// this node.
    pub(crate) fn alternatives(&self, pointer: &str) -> Vec<(String, &Self)> {
        match self {
            Self::Law(law) if !law.values().is_empty() => law
                .values()
                .iter()
                .enumerate()
                .flat_map(|(position, value): (usize, _)| {
                    Self::alternatives(value, &format!("{pointer}/{}/{position}", law.key()))
                })
                .collect(),
            _ => vec![(pointer.to_owned(), self)],
        }
    }

    /// The possible strings, each with its pointer.
    pub(crate) fn strings(&self, pointer: &str) -> Vec<(String, &str)> {
        self.alternatives(pointer)
            .into_iter()
            .filter_map(|(pointer, node)| match node {
                &Self::Constant(Value::String(ref text)) => Some((pointer, text.as_str())),
                _ => None,
            })
            .collect()
    }

    /// The possible strings of this tree.
    pub(crate) fn words(&self) -> Vec<&str> {
        match self {
            Self::Constant(value) => value.as_str().into_iter().collect(),
            Self::List(items) => items.iter().flat_map(Self::words).collect(),
            Self::Object(fields) => fields.iter().flat_map(|(_, node)| node.words()).collect(),
            Self::Law(law) => law.values().iter().flat_map(Self::words).collect(),
        }
    }

    /// The greatest possible number.
    pub(crate) fn greatest(&self) -> Option<f64> {
        self.numbers().into_iter().reduce(f64::max)
    }

    /// The least possible number.
    pub(crate) fn least(&self) -> Option<f64> {
        self.numbers().into_iter().reduce(f64::min)
    }

    /// Every possible number; for an interval its ends.
    fn numbers(&self) -> Vec<f64> {
        let values = self
            .alternatives("")
            .into_iter()
            .flat_map(|(_, node): (String, &Self)| match node {
                Self::Constant(value) => vec![value.clone()],
                Self::Law(law) => law.ends().map(Vec::from).unwrap_or_default(),
                _ => Vec::new(),
            });
        values.filter_map(|value| value.as_f64()).collect()
    }
}

/// Canonical form of a number field: always with a point or an exponent, and no negative zero.
pub(crate) fn float(number: f64) -> Value {
    Value::from(number + 0.0)
}

/// A distribution with its location.
#[derive(Debug, Clone)]
pub(crate) struct LawNode {
    /// JSON pointer of the distribution.
    pub(crate) pointer: String,
    /// Its random numbers.
    pub(crate) stream: Stream,
    /// The distribution itself.
    pub(crate) law: Law,
}

/// A distribution. The checker guarantees: ends in order and within the field's range, lists not empty, as many
/// weights as values, none negative, one positive.
#[derive(Debug, Clone)]
pub(crate) enum Law {
    /// One of the values. `weighted`: the weights were given explicitly.
    Choice {
        values: Vec<Node>,
        weights: Vec<f64>,
        weighted: bool,
    },
    /// Each value in turn, for `stride` frames each.
    Grid { values: Vec<Node>, stride: u64 },
    /// Between two ends.
    Uniform(f64, f64),
    /// Log-uniform between two ends.
    LogUniform(f64, f64),
    /// Whole numbers; `as_float` in a number field.
    Int { a: i64, b: i64, as_float: bool },
    /// Normal, clamped.
    Normal { mean: f64, sd: f64, clip: (f64, f64) },
}

/// A drawn value.
pub(crate) enum Drawn {
    /// The value at this position of [`LawNode::values`], which may contain distributions.
    One(usize),
    /// A number.
    Number(Value),
}
