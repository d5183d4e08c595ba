//! Distributions: their syntax, and whether all their values are within the field's limits.

use imaging::random::Stream;
use serde_json::{Map, Value};

use super::{Checker, Place, whole};
use crate::invalid::FieldError;
use crate::json::describe;
use crate::law::{KEYS, companion};
use crate::node::{Law, LawNode, Node};
use crate::schema::{EXACT, Shape};

impl Checker<'_> {
    /// Checks the distribution marked by `key` for a field of this shape.
    pub(super) fn law(
        &mut self,
        at: &Place,
        shape: &Shape,
        key: &'static str,
        map: &Map<String, Value>,
    ) -> Option<Node> {
        if !self.keys_are_right(at, key, map) {
            return None;
        }
        let argument = &map[key];
        let law = match key {
            "choice" => self.choice(at, shape, argument, map.get("weights")),
            "grid" => self
                .alternatives(at, shape, key, argument)
                .map(|values| Law::Grid { values, stride: 1 }),
            "int" => self.int(at, shape, argument),
            _ => self.continuous(at, shape, key, argument, map.get("clip")),
        }?;
        let stream = Stream::law(self.seed, &at.pointer);
        Some(Node::Law(Box::new(LawNode {
            pointer: at.pointer.clone(),
            stream,
            law,
        })))
    }

    fn keys_are_right(&mut self, at: &Place, key: &'static str, map: &Map<String, Value>) -> bool {
        let allowed: Vec<_> = [Some(key), companion(key)].into_iter().flatten().collect();
        for (other, value) in map.iter().filter(|(other, _)| !allowed.contains(&other.as_str())) {
            self.refuse(|| {
                let message = if KEYS.contains(&other.as_str()) {
                    format!("{at} holds two distributions, `{key}` and `{other}`")
                } else {
                    format!("{at} is a distribution, `{key}`, and cannot hold `{other}` too")
                };
                FieldError::new(&at.field(other).pointer, message)
                    .value(value)
                    .allowed(&allowed, other)
            });
        }
        map.keys().all(|key| allowed.contains(&key.as_str()))
    }

    /// Adds an error; `message` follows the field's name.
    fn bad_law(&mut self, at: &Place, value: &Value, message: &str) -> Option<Law> {
        self.refuse(|| FieldError::new(&at.pointer, format!("{at}: {message}")).value(value));
        None
    }

    fn choice(
        &mut self,
        at: &Place,
        shape: &Shape,
        argument: &Value,
        weights: Option<&Value>,
    ) -> Option<Law> {
        let values = self.alternatives(at, shape, "choice", argument);
        let count = argument.as_array().map_or(0, Vec::len);
        let weights = match weights {
            None => Some((vec![1.0; count], false)),
            Some(written) => self.weights(at, written, count).map(|weights| (weights, true)),
        };
        let (values, (weights, weighted)) = values.zip(weights)?;
        Some(Law::Choice {
            values,
            weights,
            weighted,
        })
    }

    fn alternatives(&mut self, at: &Place, shape: &Shape, key: &str, argument: &Value) -> Option<Vec<Node>> {
        let Value::Array(items) = argument else {
            self.bad_law(
                at,
                argument,
                &format!("`{key}` must be a list of values, but is {}", describe(argument)),
            );
            return None;
        };
        if items.is_empty() {
            self.bad_law(
                at,
                argument,
                &format!("`{key}` is empty, it needs at least one value"),
            );
            return None;
        }
        let nodes: Vec<_> = items
            .iter()
            .enumerate()
            .map(|(position, item)| self.node(&at.alternative(key, position), shape, true, item))
            .collect();
        nodes.into_iter().collect()
    }

    fn weights(&mut self, at: &Place, written: &Value, count: usize) -> Option<Vec<f64>> {
        let numbers = written
            .as_array()
            .and_then(|items| items.iter().map(Value::as_f64).collect::<Option<Vec<_>>>());
        let problem = match &numbers {
            None => format!(
                "`weights` must be a list of numbers, but is {}",
                describe(written)
            ),
            Some(list) if list.len() != count => format!("{} weights for {count} values", list.len()),
            Some(list) if list.iter().any(|weight| *weight < 0.0) => {
                "a weight is negative, the limit is 0".to_owned()
            }
            Some(list) if list.iter().all(|weight| *weight == 0.0) => "all weights are 0".to_owned(),
            Some(list) if !list.iter().sum::<f64>().is_finite() => {
                "the sum of the weights is not finite".to_owned()
            }
            Some(_) => return numbers,
        };
        self.bad_law(at, written, &problem);
        None
    }

    fn int(&mut self, at: &Place, shape: &Shape, argument: &Value) -> Option<Law> {
        let ends = match argument.as_array().map(Vec::as_slice) {
            Some([a, b]) => whole(a).zip(whole(b)),
            _ => None,
        };
        let Some((a, b)) = ends else {
            return self.bad_law(at, argument, "`int` must be two whole numbers [a, b]");
        };
        if a > b {
            return self.bad_law(at, argument, &format!("`int` has a = {a} above b = {b}"));
        }
        if a < -EXACT || b > EXACT || b - a >= EXACT {
            return self.bad_law(
                at,
                argument,
                "`int` is wider than 2^53, beyond which doubles skip numbers",
            );
        }
        for end in [a, b] {
            self.check_end(at, shape, "int", &Value::from(end as i64))?;
        }
        Some(Law::Int {
            a: a as i64,
            b: b as i64,
            as_float: matches!(shape, Shape::Number(_)),
        })
    }

    fn continuous(
        &mut self,
        at: &Place,
        shape: &Shape,
        key: &'static str,
        argument: &Value,
        clip: Option<&Value>,
    ) -> Option<Law> {
        if let Shape::Integer(..) = shape {
            let message =
                format!("`{key}` yields fractions, but whole numbers stand here: use int, choice or grid");
            return self.bad_law(at, argument, &message);
        }
        let Some((a, b)) = pair(argument) else {
            let form = if key == "normal" { "[mean, sd]" } else { "[a, b]" };
            return self.bad_law(at, argument, &format!("`{key}` must be two numbers {form}"));
        };
        let (law, ends) = match key {
            "normal" if b < 0.0 => {
                return self.bad_law(
                    at,
                    argument,
                    &format!("`normal` has sd = {b}, the limit is 0 or more"),
                );
            }
            "normal" => {
                let clip = self.clip(at, argument, clip)?;
                (Law::Normal { mean: a, sd: b, clip }, clip)
            }
            _ if a > b => return self.bad_law(at, argument, &format!("`{key}` has a = {a} above b = {b}")),
            _ if !(b - a).is_finite() => {
                return self.bad_law(at, argument, &format!("`{key}` is wider than doubles reach"));
            }
            "log_uniform" if a <= 0.0 => {
                return self.bad_law(
                    at,
                    argument,
                    &format!("`log_uniform` has a = {a}, it must be above 0"),
                );
            }
            "log_uniform" => (Law::LogUniform(a, b), (a, b)),
            _ => (Law::Uniform(a, b), (a, b)),
        };
        for end in [ends.0, ends.1] {
            self.check_end(
                at,
                shape,
                if key == "normal" { "clip" } else { key },
                &Value::from(end),
            )?;
        }
        Some(law)
    }

    fn clip(&mut self, at: &Place, normal: &Value, clip: Option<&Value>) -> Option<(f64, f64)> {
        let Some(written) = clip else {
            self.bad_law(
                at,
                normal,
                "`normal` needs `clip`: [a, b], the ends of what it may yield",
            );
            return None;
        };
        match pair(written) {
            Some((a, b)) if a <= b => Some((a, b)),
            Some((a, b)) => {
                self.bad_law(at, written, &format!("`clip` has a = {a} above b = {b}"));
                None
            }
            None => {
                self.bad_law(at, written, "`clip` must be two numbers [a, b]");
                None
            }
        }
    }

    /// Checks whether the end of a distribution's range is a valid value of the field.
    fn check_end(&mut self, at: &Place, shape: &Shape, key: &str, end: &Value) -> Option<()> {
        let fits = match shape {
            Shape::Scalar => true,
            Shape::Number(range) => end.as_f64().is_some_and(|number| range.holds(number)),
            Shape::Integer(min, max) => whole(end).is_some_and(|number| (*min..=*max).contains(&number)),
            other => {
                let message = format!("`{key}` yields a number, but this must be {}", other.describe());
                self.bad_law(at, end, &message);
                return None;
            }
        };
        if fits {
            return Some(());
        }
        let limit = shape.limit();
        let message = format!("{at}: `{key}` can yield {end}, the limit is {limit}");
        self.refuse(|| FieldError::new(&at.pointer, message).value(end).limit(limit));
        None
    }
}

fn pair(value: &Value) -> Option<(f64, f64)> {
    match value.as_array()?.as_slice() {
        [a, b] => a.as_f64().zip(b.as_f64()),
        _ => None,
    }
}
