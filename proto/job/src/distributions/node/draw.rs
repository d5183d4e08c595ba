//! A distribution in a description: its values and its extremes.

use serde_json::{Value, json};

use super::{Drawn, Law, LawNode, Node, float};
use crate::law;

impl LawNode {
    /// Draws the value for a frame.
    pub(crate) fn draw(&self, index: u64) -> Drawn {
        let unit = self.stream.unit(index, 0);
        match &self.law {
            Law::Choice { weights, .. } => Drawn::One(law::choice(unit, weights)),
            Law::Grid { values, stride } => Drawn::One((index / stride % values.len() as u64) as usize),
            Law::Uniform(a, b) => Drawn::Number(float(law::uniform(unit, *a, *b))),
            Law::LogUniform(a, b) => Drawn::Number(float(law::log_uniform(unit, *a, *b))),
            Law::Int { a, b, as_float } => Drawn::Number(whole(law::int(unit, *a, *b), *as_float)),
            Law::Normal {
                mean,
                sd,
                clip: (low, high),
            } => Drawn::Number(float(law::normal(unit, *mean, *sd, *low, *high))),
        }
    }

    /// The number of extremes: the values of a choice or grid, the two ends of an interval.
    pub(crate) fn extreme_count(&self) -> usize {
        self.ends().map_or(self.values().len(), |ends| ends.len())
    }

    /// The extreme with this number, below [`Self::extreme_count`].
    pub(crate) fn extreme(&self, position: usize) -> Drawn {
        match self.ends() {
            Some(ends) => Drawn::Number(ends[position].clone()),
            None => Drawn::One(position),
        }
    }

    /// The lower and the upper end of an interval.
    pub(crate) fn ends(&self) -> Option<[Value; 2]> {
        match self.law {
            Law::Uniform(a, b) | Law::LogUniform(a, b) | Law::Normal { clip: (a, b), .. } => {
                Some([a, b].map(float))
            }
            Law::Int { a, b, as_float } => Some([a, b].map(|end| whole(end, as_float))),
            Law::Choice { .. } | Law::Grid { .. } => None,
        }
    }

    /// The values of a choice or grid; empty for other distributions.
    pub(crate) fn values(&self) -> &[Node] {
        match &self.law {
            Law::Choice { values, .. } | Law::Grid { values, .. } => values,
            _ => &[],
        }
    }

    /// The values of a choice or grid; empty for other distributions.
    pub(crate) fn values_mut(&mut self) -> &mut [Node] {
        match &mut self.law {
            Law::Choice { values, .. } | Law::Grid { values, .. } => values,
            _ => &mut [],
        }
    }

    /// The key that marks the distribution.
    pub(crate) fn key(&self) -> &'static str {
        match self.law {
            Law::Choice { .. } => "choice",
            Law::Grid { .. } => "grid",
            Law::Uniform(..) => "uniform",
            Law::LogUniform(..) => "log_uniform",
            Law::Int { .. } => "int",
            Law::Normal { .. } => "normal",
        }
    }

    /// The distribution as written.
    pub(crate) fn canonical(&self) -> Value {
        let key = self.key();
        let list = self.values().iter().map(Node::canonical).collect::<Value>();
        match &self.law {
            Law::Choice {
                weights,
                weighted: true,
                ..
            } => json!({key: list, "weights": floats(weights)}),
            Law::Choice { .. } | Law::Grid { .. } => json!({key: list}),
            Law::Uniform(a, b) | Law::LogUniform(a, b) => json!({key: floats(&[*a, *b])}),
            Law::Int { a, b, .. } => json!({key: [a, b]}),
            Law::Normal {
                mean,
                sd,
                clip: (low, high),
            } => {
                json!({key: floats(&[*mean, *sd]), "clip": floats(&[*low, *high])})
            }
        }
    }
}

fn floats(numbers: &[f64]) -> Value {
    numbers.iter().map(|number| float(*number)).collect()
}

fn whole(number: i64, as_float: bool) -> Value {
    if as_float {
        float(number as f64)
    } else {
        number.into()
    }
}
