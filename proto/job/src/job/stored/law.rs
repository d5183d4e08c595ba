//! Reads stored distributions. Only the form is checked, so that drawing cannot fail.

use imaging::random::Stream;
use serde_json::{Map, Value};

use super::{Reader, damage};
use crate::check::whole;
use crate::invalid::Invalid;
use crate::law;
use crate::node::{Law, LawNode, Node};
use crate::schema::{EXACT, Shape};

impl Reader {
    pub(super) fn read_law(
        &self,
        pointer: &str,
        shape: &Shape,
        key: &'static str,
        map: &Map<String, Value>,
    ) -> Result<Node, Invalid> {
        let known = [Some(key), law::companion(key)];
        let malformed = || damage(pointer, &format!("is not a `{key}` distribution"));
        if map.keys().any(|other| !known.contains(&Some(other.as_str()))) {
            return Err(malformed());
        }
        let argument = &map[key];
        let law = match key {
            "choice" | "grid" => {
                let items = argument.as_array().filter(|items| !items.is_empty());
                let values =
                    self.read_items(&format!("{pointer}/{key}"), shape, items.ok_or_else(malformed)?)?;
                match key {
                    "grid" => Some(Law::Grid { values, stride: 1 }),
                    _ => read_choice(values, map.get("weights")),
                }
            }
            "int" => read_ends(argument, whole)
                .filter(|(a, b)| a.abs() <= EXACT && b.abs() <= EXACT && b - a < EXACT)
                .map(|(a, b)| Law::Int {
                    a: a as i64,
                    b: b as i64,
                    as_float: matches!(shape, Shape::Number(_)),
                }),
            "normal" => read_normal(argument, map.get("clip")),
            "log_uniform" => read_ends(argument, Value::as_f64).map(|(a, b)| Law::LogUniform(a, b)),
            _ => read_ends(argument, Value::as_f64).map(|(a, b)| Law::Uniform(a, b)),
        };
        let law = law.ok_or_else(malformed)?;
        let stream = Stream::law(self.seed, pointer);
        let pointer = pointer.to_owned();
        Ok(Node::Law(Box::new(LawNode { pointer, stream, law })))
    }
}

fn read_choice(values: Vec<Node>, weights: Option<&Value>) -> Option<Law> {
    let weighted = weights.is_some();
    let weights = match weights {
        None => vec![1.0; values.len()],
        Some(written) => {
            let weights: Vec<f64> = written
                .as_array()?
                .iter()
                .map(Value::as_f64)
                .collect::<Option<_>>()?;
            let is_usable = weights.len() == values.len() && weights.iter().all(|weight| *weight >= 0.0);
            let total: f64 = weights.iter().sum();
            (is_usable && total > 0.0 && total.is_finite()).then_some(weights)?
        }
    };
    Some(Law::Choice {
        values,
        weights,
        weighted,
    })
}

fn read_normal(argument: &Value, clip: Option<&Value>) -> Option<Law> {
    let (mean, sd) = read_pair(argument, Value::as_f64)?;
    let clip = read_ends(clip?, Value::as_f64)?;
    (sd >= 0.0).then_some(Law::Normal { mean, sd, clip })
}

/// Two ends in order.
fn read_ends<T: PartialOrd>(value: &Value, read: impl Fn(&Value) -> Option<T>) -> Option<(T, T)> {
    read_pair(value, read).filter(|(a, b)| a <= b)
}

fn read_pair<T>(value: &Value, read: impl Fn(&Value) -> Option<T>) -> Option<(T, T)> {
    match value.as_array()?.as_slice() {
        [a, b] => read(a).zip(read(b)),
        _ => None,
    }
}
