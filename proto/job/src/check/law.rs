//! Distributions: their syntax, and whether all their values are within the field's limits.

use imaging::random::Stream;
use serde_json::{Map, Value};

use super::{Checker, Location, whole};
use crate::json::describe;
use crate::law::{KEYS, companion};
use crate::node::{Law, LawNode, Node};
use crate::schema::{EXACT, Shape};

impl Checker<'_> {
    /// Checks the distribution marked by `key` for a field of this shape.
    pub(super) fn check_law(
        &mut self,
        location: &Location,
        shape: &Shape,
        key: &'static str,
        map: &Map<String, Value>,
    ) -> Option<Node> {
        if !self.check_keys(location, key, map) {
            return None;
        }
        let argument = &map[key];
        let law = match key {
            "choice" => self.check_choice(location, shape, argument, map.get("weights")),
            "grid" => self
                .check_alternatives(location, shape, key, argument)
                .map(|values| Law::Grid { values, stride: 1 }),
            "int" => self.check_int(location, shape, argument),
            _ => self.check_continuous(location, shape, key, argument, map.get("clip")),
        }?;
        let stream = Stream::law(self.seed, &location.pointer);
        Some(Node::Law(Box::new(LawNode {
            pointer: location.pointer.clone(),
            stream,
            law,
        })))
    }

    fn check_keys(&mut self, location: &Location, key: &'static str, map: &Map<String, Value>) -> bool {
        let allowed: Vec<_> = [Some(key), companion(key)].into_iter().flatten().collect();
        for (other, value) in map.iter().filter(|(other, _)| !allowed.contains(&other.as_str())) {
            self.refuse(|| {
                let message = if KEYS.contains(&other.as_str()) {
                    format!("{location} has two distributions, `{key}` and `{other}`; remove one")
                } else {
                    format!("{location} is a `{key}` distribution and cannot have `{other}`; remove it")
                };
                location
                    .field(other)
                    .error(message)
                    .value(value)
                    .allowed(&allowed, other)
            });
        }
        map.keys().all(|key| allowed.contains(&key.as_str()))
    }

    /// Adds an error; `message` follows the field's name.
    fn refuse_law(&mut self, location: &Location, value: &Value, message: &str) -> Option<Law> {
        self.refuse(|| location.error(format!("{location}: {message}")).value(value));
        None
    }

    fn check_choice(
        &mut self,
        location: &Location,
        shape: &Shape,
        argument: &Value,
        weights: Option<&Value>,
    ) -> Option<Law> {
        let values = self.check_alternatives(location, shape, "choice", argument);
        let count = argument.as_array().map_or(0, Vec::len);
        let weights = match weights {
            None => Some((vec![1.0; count], false)),
            Some(written) => self
                .check_weights(location, written, count)
                .map(|weights| (weights, true)),
        };
        let (values, (weights, weighted)) = values.zip(weights)?;
        Some(Law::Choice {
            values,
            weights,
            weighted,
        })
    }

    fn check_alternatives(
        &mut self,
        location: &Location,
        shape: &Shape,
        key: &str,
        argument: &Value,
    ) -> Option<Vec<Node>> {
        let Value::Array(items) = argument else {
            self.refuse_law(
                location,
                argument,
                &format!("`{key}` must be a list of values, but is {}", describe(argument)),
            );
            return None;
        };
        if items.is_empty() {
            self.refuse_law(
                location,
                argument,
                &format!("`{key}` is empty; must have at least one value"),
            );
            return None;
        }
        let nodes: Vec<_> = items
            .iter()
            .enumerate()
            .map(|(position, item)| self.check(&location.alternative(key, position), shape, true, item))
            .collect();
        nodes.into_iter().collect()
    }

    fn check_weights(&mut self, location: &Location, written: &Value, count: usize) -> Option<Vec<f64>> {
        let numbers = written
            .as_array()
            .and_then(|items| items.iter().map(Value::as_f64).collect::<Option<Vec<_>>>());
        let problem = match &numbers {
            None => format!(
                "`weights` must be a list of numbers, but is {}",
                describe(written)
            ),
            Some(list) if list.len() != count => format!(
                "`weights` has {} numbers; must have {count}, one per value",
                list.len()
            ),
            Some(list) if list.iter().any(|weight| *weight < 0.0) => {
                "`weights` has a negative number; must be 0 or more".to_owned()
            }
            Some(list) if list.iter().all(|weight| *weight == 0.0) => {
                "`weights` are all 0; at least one must be above 0".to_owned()
            }
            Some(list) if !list.iter().sum::<f64>().is_finite() => {
                "`weights` have an infinite sum; use smaller numbers".to_owned()
            }
            Some(_) => return numbers,
        };
        self.refuse_law(location, written, &problem);
        None
    }

    fn check_int(&mut self, location: &Location, shape: &Shape, argument: &Value) -> Option<Law> {
        let ends = match argument.as_array().map(Vec::as_slice) {
            Some([a, b]) => whole(a).zip(whole(b)),
            _ => None,
        };
        let Some((a, b)) = ends else {
            return self.refuse_law(location, argument, "`int` must be two whole numbers [a, b]");
        };
        if a > b {
            return self.refuse_law(location, argument, &format!("`int` has a = {a} above b = {b}"));
        }
        if a < -EXACT || b > EXACT || b - a >= EXACT {
            return self.refuse_law(
                location,
                argument,
                "`int` exceeds 2^53, the limit of exact whole numbers",
            );
        }
        for end in [a, b] {
            self.check_end(location, shape, "int", &Value::from(end as i64))?;
        }
        Some(Law::Int {
            a: a as i64,
            b: b as i64,
            as_float: matches!(shape, Shape::Number(_)),
        })
    }

    fn check_continuous(
        &mut self,
        location: &Location,
        shape: &Shape,
        key: &'static str,
        argument: &Value,
        clip: Option<&Value>,
    ) -> Option<Law> {
        if let Shape::Integer(..) = shape {
            let message = format!(
                "`{key}` yields fractions, but the field is a whole number; use `int`, `choice` or `grid`"
            );
            return self.refuse_law(location, argument, &message);
        }
        let Some((a, b)) = pair(argument) else {
            let form = if key == "normal" { "[mean, sd]" } else { "[a, b]" };
            return self.refuse_law(location, argument, &format!("`{key}` must be two numbers {form}"));
        };
        let (law, ends) = match key {
            "normal" if b < 0.0 => {
                return self.refuse_law(
                    location,
                    argument,
                    &format!("`normal` has sd = {b}; must be 0 or more"),
                );
            }
            "normal" => {
                let clip = self.check_clip(location, argument, clip)?;
                (Law::Normal { mean: a, sd: b, clip }, clip)
            }
            _ if a > b => {
                return self.refuse_law(location, argument, &format!("`{key}` has a = {a} above b = {b}"));
            }
            _ if !(b - a).is_finite() => {
                return self.refuse_law(
                    location,
                    argument,
                    &format!("`{key}` has an infinite width b - a; use a narrower interval"),
                );
            }
            "log_uniform" if a <= 0.0 => {
                return self.refuse_law(
                    location,
                    argument,
                    &format!("`log_uniform` has a = {a}; must be above 0"),
                );
            }
            "log_uniform" => (Law::LogUniform(a, b), (a, b)),
            _ => (Law::Uniform(a, b), (a, b)),
        };
        for end in [ends.0, ends.1] {
            self.check_end(
                location,
                shape,
                if key == "normal" { "clip" } else { key },
                &Value::from(end),
            )?;
        }
        Some(law)
    }

    fn check_clip(
        &mut self,
        location: &Location,
        normal: &Value,
        clip: Option<&Value>,
    ) -> Option<(f64, f64)> {
        let Some(written) = clip else {
            self.refuse_law(
                location,
                normal,
                "`normal` needs `clip`: [a, b], the limits of its values",
            );
            return None;
        };
        match pair(written) {
            Some((a, b)) if a <= b => Some((a, b)),
            Some((a, b)) => {
                self.refuse_law(location, written, &format!("`clip` has a = {a} above b = {b}"));
                None
            }
            None => {
                self.refuse_law(location, written, "`clip` must be two numbers [a, b]");
                None
            }
        }
    }

    /// Checks whether the end of a distribution's range is a valid value of the field.
    fn check_end(&mut self, location: &Location, shape: &Shape, key: &str, end: &Value) -> Option<()> {
        let fits = match shape {
            Shape::Scalar => true,
            Shape::Number(range) => end.as_f64().is_some_and(|number| range.holds(number)),
            Shape::Integer(min, max) => whole(end).is_some_and(|number| (*min..=*max).contains(&number)),
            other => {
                let message = format!(
                    "`{key}` yields a number, but the field must be {}",
                    other.describe()
                );
                self.refuse_law(location, end, &message);
                return None;
            }
        };
        if fits {
            return Some(());
        }
        let limit = shape.limit();
        let message = format!("{location}: `{key}` can yield {end}; must be {limit}");
        self.refuse(|| location.error(message).value(end).limit(limit));
        None
    }
}

fn pair(value: &Value) -> Option<(f64, f64)> {
    match value.as_array()?.as_slice() {
        [a, b] => a.as_f64().zip(b.as_f64()),
        _ => None,
    }
}
