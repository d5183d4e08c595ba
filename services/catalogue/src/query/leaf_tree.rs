//! Reads the columns of a record from its JSON in one pass: looking up each column in a tree of values took a fifth of an import.

use std::collections::BTreeMap;
use std::fmt;

use serde::de::{DeserializeSeed, Deserializer, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};
use spec::{Leaf, LeafKind};

use crate::query::filter::{Bind, lowered};

/// The columns by their position in a record.
#[derive(Debug, Default)]
pub(crate) struct LeafTree {
    columns: usize,
    root: Node,
}

/// A place of a record.
#[derive(Debug, Default)]
struct Node {
    /// The columns that it fills.
    wanted: Vec<Wanted>,
    fields: BTreeMap<String, Node>,
    /// By position.
    items: Vec<Node>,
}

#[derive(Debug, Clone, Copy)]
struct Wanted {
    column: usize,
    kind: LeafKind,
    /// Whether it is used only if the primary position of the column is empty.
    is_second: bool,
}

impl LeafTree {
    pub(crate) fn new(leaves: &[Leaf]) -> Self {
        let mut root = Node::default();
        for (column, leaf) in leaves.iter().enumerate() {
            for (order, pointer) in leaf.pointers().enumerate() {
                let node = pointer.split('/').skip(1).fold(&mut root, Node::below);
                node.wanted.push(Wanted {
                    column,
                    kind: leaf.kind,
                    is_second: order > 0,
                });
            }
        }
        Self {
            columns: leaves.len(),
            root,
        }
    }

    /// The values of a record, column by column.
    pub(crate) fn read<'de, D: Deserializer<'de>>(&self, record: D) -> Result<Vec<Option<Bind>>, D::Error> {
        let mut found = vec![None; self.columns];
        let node = &self.root;
        At {
            node,
            found: &mut found,
        }
        .deserialize(record)?;
        Ok(found)
    }
}

impl Node {
    fn below(&mut self, part: &str) -> &mut Self {
        match part.parse::<usize>() {
            Ok(position) => {
                if self.items.len() <= position {
                    self.items.resize_with(position + 1, Self::default);
                }
                &mut self.items[position]
            }
            Err(_) => self.fields.entry(part.to_owned()).or_default(),
        }
    }
}

/// A position in the record, and the values so far.
struct At<'t, 'f> {
    node: &'t Node,
    found: &'f mut [Option<Bind>],
}

impl At<'_, '_> {
    /// Stores a value of the record in its columns.
    fn note(self, bind: impl Fn(LeafKind) -> Option<Bind>) {
        for wanted in &self.node.wanted {
            let place = &mut self.found[wanted.column];
            if !wanted.is_second || place.is_none() {
                *place = bind(wanted.kind);
            }
        }
    }
}

impl<'de> DeserializeSeed<'de> for At<'_, '_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for At<'_, '_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_bool<E: Error>(self, _: bool) -> Result<(), E> {
        Ok(())
    }

    fn visit_unit<E: Error>(self) -> Result<(), E> {
        Ok(())
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<(), E> {
        self.note(|kind| match kind {
            LeafKind::Number => Some(Bind::Number(number as f64)),
            LeafKind::Whole => Some(Bind::Whole(number)),
            LeafKind::Large => u64::try_from(number)
                .ok()
                .map(|number| Bind::Whole(lowered(number))),
            LeafKind::Text | LeafKind::Length => None,
        });
        Ok(())
    }

    fn visit_u64<E: Error>(self, number: u64) -> Result<(), E> {
        self.note(|kind| match kind {
            LeafKind::Number => Some(Bind::Number(number as f64)),
            LeafKind::Whole => i64::try_from(number).ok().map(Bind::Whole),
            LeafKind::Large => Some(Bind::Whole(lowered(number))),
            LeafKind::Text | LeafKind::Length => None,
        });
        Ok(())
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<(), E> {
        self.note(|kind| (kind == LeafKind::Number).then_some(Bind::Number(number)));
        Ok(())
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<(), E> {
        self.note(|kind| (kind == LeafKind::Text).then(|| Bind::Text(text.to_owned())));
        Ok(())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<(), A::Error> {
        let mut count = 0;
        loop {
            let item = match self.node.items.get(count) {
                Some(node) => items.next_element_seed(At {
                    node,
                    found: &mut *self.found,
                })?,
                None => items.next_element::<IgnoredAny>()?.map(drop),
            };
            if item.is_none() {
                break;
            }
            count += 1;
        }
        self.note(|kind| (kind == LeafKind::Length).then_some(Bind::Whole(count as i64)));
        Ok(())
    }

    fn visit_map<A: MapAccess<'de>>(self, mut fields: A) -> Result<(), A::Error> {
        while let Some(node) = fields.next_key_seed(Named(self.node))? {
            match node {
                Some(node) => fields.next_value_seed(At {
                    node,
                    found: &mut *self.found,
                })?,
                None => fields.next_value::<IgnoredAny>().map(drop)?,
            }
        }
        Ok(())
    }
}

/// Finds the place of a field by its name.
struct Named<'t>(&'t Node);

impl<'de, 't> DeserializeSeed<'de> for Named<'t> {
    type Value = Option<&'t Node>;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Self::Value, D::Error> {
        deserializer.deserialize_str(self)
    }
}

impl<'t> Visitor<'_> for Named<'t> {
    type Value = Option<&'t Node>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a name")
    }

    fn visit_str<E: Error>(self, name: &str) -> Result<Self::Value, E> {
        Ok(self.0.fields.get(name))
    }
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};
    use spec::Leaves;

    use super::*;

    /// The reference: looks up each leaf in a tree of values.
    fn pointed(leaves: &[Leaf], record: &Value) -> Vec<Option<Bind>> {
        leaves
            .iter()
            .map(|leaf: &Leaf| {
                let value = leaf.find(record)?;
                match leaf.kind {
                    LeafKind::Number => value.as_f64().map(Bind::Number),
                    LeafKind::Whole => value.as_i64().map(Bind::Whole),
                    LeafKind::Large => value.as_u64().map(|number| Bind::Whole(lowered(number))),
                    LeafKind::Text => value.as_str().map(|text| Bind::Text(text.to_owned())),
                    LeafKind::Length => value.as_array().map(|items| Bind::Whole(items.len() as i64)),
                }
            })
            .collect()
    }

    #[test]
    fn one_pass_finds_what_the_pointers_find() {
        let leaves = Leaves::of_records().scalars;
        let tree = LeafTree::new(&leaves);
        let whole = serde_json::to_value(synthetic::record("job_a", 3)).unwrap();
        let mut records = vec![whole.clone()];
        let values = [
            json!(null),
            json!(true),
            json!(-3),
            json!(5),
            json!(u64::MAX),
            json!(0.25),
            json!("text"),
            json!([1, 2, 3, 4]),
            json!([]),
            json!({"preset": "a", "name": "b"}),
            json!({"name": "b"}),
            json!({"name": 1, "0": 2}),
        ];
        // Every kind of value at every position.
        for leaf in &leaves {
            for value in &values {
                let mut record = whole.clone();
                put(&mut record, &leaf.pointer, value.clone());
                records.push(record);
            }
        }
        for record in records {
            let expected = pointed(&leaves, &record);
            assert_eq!(tree.read(&record).unwrap(), expected, "{record}");
            let text = record.to_string();
            let read = tree.read(&mut serde_json::Deserializer::from_str(&text));
            assert_eq!(read.unwrap(), expected, "{text}");
        }
    }

    /// Puts a value at a pointer, and creates missing objects and triples above it.
    fn put(record: &mut Value, pointer: &str, value: Value) {
        let place = pointer.split('/').skip(1).fold(record, |place, part| {
            if let Ok(at) = part.parse::<usize>() {
                if !place.is_array() {
                    *place = json!([null, null, null]);
                }
                return &mut place[at];
            }
            if !place.is_object() {
                *place = json!({});
            }
            &mut place[part]
        });
        *place = value;
    }
}
