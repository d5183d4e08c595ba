//! Names of enhancements, and the artifacts that belong to them.

use std::collections::BTreeSet;

use serde_json::{Map, Value};

use crate::artifact::ArtifactKind;
use crate::check::{Checker, Location, find_lists};
use crate::enhancement::parameters::Ibla;
use crate::enhancement::{defaults, steps_of};
use crate::invalid::FieldError;
use crate::node::Node;
use crate::schema::{Field, Shape};

/// An enhancement that a frame can have.
pub(crate) struct Possible<'a> {
    pointer: String,
    name: &'a str,
    /// Names of its intermediate results.
    steps: Vec<String>,
}

impl Checker<'_> {
    /// Names differ in every frame; a chain has a name and steps; requested artifacts belong to an enhancement.
    pub(crate) fn check_enhance(&mut self, document: &Node) {
        if document.get("enhance").is_none() {
            return;
        }
        let mut certain: Option<BTreeSet<String>> = None;
        for (location, items) in find_lists(document, "enhance") {
            let mut seen = BTreeSet::new();
            let mut kinds = BTreeSet::new();
            for (position, item) in items.iter().enumerate() {
                let possible = self.find_possible(&location.item(position), item);
                for Possible { pointer, name, .. } in &possible {
                    if seen.contains(name) {
                        let message = format!(
                            "{} can be \"{name}\", which the list already contains; give one of them another `name`",
                            location.item(position)
                        );
                        self.refuse(|| FieldError::new(pointer, message).value(&Value::from(*name)));
                    }
                }
                seen.extend(possible.iter().map(|one| one.name));
                kinds.extend(certain_kinds(&possible));
            }
            certain = Some(match certain {
                Some(before) => before.intersection(&kinds).cloned().collect(),
                None => kinds,
            });
        }
        self.check_enhanced(document, &certain.unwrap_or_default());
        self.check_mask_sizes(document);
    }

    /// Rejects the field `grid` of parameters with `tiles`, and returns the other fields. As a distribution, `grid` has no
    /// fields next to it, and its values are objects with parameters.
    pub(crate) fn refuse_misnamed_tiles(
        &mut self,
        location: &Location,
        shape: &Shape,
        map: &Map<String, Value>,
    ) -> Option<Value> {
        let mut rest = map.clone();
        let grid = rest.remove("grid")?;
        let values = grid.as_array().map_or(&[][..], Vec::as_slice);
        let is_distribution = rest.is_empty() && !values.is_empty() && values.iter().all(Value::is_object);
        let fields = list_parameters(shape, map);
        if is_distribution || !fields.iter().any(|field| field.name == "tiles") {
            return None;
        }
        self.refuse(|| {
            let message = format!("{location} has no field `grid` for the tiles of CLAHE across and down");
            let names = fields.iter().map(|field| field.name);
            let mut error = location
                .field("grid")
                .error(message)
                .value(&grid)
                .allowed(names, "grid");
            error.did_you_mean = Some("tiles".to_owned());
            error
        });
        Some(Value::Object(rest))
    }

    /// Every enhancement that an element of `enhance` can be.
    pub(crate) fn find_possible<'a>(&mut self, location: &Location, item: &'a Node) -> Vec<Possible<'a>> {
        let mut possible = Vec::new();
        for (pointer, node) in item.alternatives(&location.pointer) {
            match find_name(node) {
                Some(name) => possible.push(Possible {
                    pointer,
                    name,
                    steps: steps_of(&node.canonical()),
                }),
                None => {
                    let message = format!(
                        "{location} is a chain without a name: add `name`, which its artifacts and metrics carry"
                    );
                    self.refuse(|| FieldError::new(&pointer, message).limit("required"));
                }
            }
            self.check_metrics_over(location, node);
            self.check_refinement(location, node);
            if let Some(Node::List(steps)) = node.get("steps")
                && steps.is_empty()
            {
                let message = format!("{location}.steps is empty: add a method, such as {{\"clahe\": {{}}}}");
                self.refuse(|| location.field("steps").error(message).limit("1 to 8 steps"));
            }
        }
        possible
    }

    /// Metrics over a mask need one.
    fn check_metrics_over(&mut self, location: &Location, node: &Node) {
        let is_word = |field: &str, word: &str| {
            let values = node.get(field).map(|node| node.strings("")).unwrap_or_default();
            values.iter().any(|(_, text)| *text == word)
        };
        if is_word("metrics_over", "mask") && is_word("mask", "none") {
            let location = location.field("metrics_over");
            let message =
                format!("{location} is \"mask\", but the mask can be \"none\": add a `mask`, or remove it");
            self.refuse(|| location.error(message).value(&Value::from("mask")));
        }
    }

    /// The guided filter has no effect on a refinement by matting.
    fn check_refinement(&mut self, location: &Location, node: &Node) {
        let steps = match node.get("steps") {
            Some(Node::List(steps)) => steps.iter().filter_map(|step| step.get("ibla")).collect(),
            _ => vec![node],
        };
        for step in steps {
            let refine = step
                .get("refine")
                .map(|refine| refine.strings(""))
                .unwrap_or_default();
            let is_unused = !refine.is_empty() && refine.iter().all(|(_, word)| *word == "matting");
            let defaults = defaults(Ibla::FIELDS);
            for field in ["guide_radius_px", "guide_eps"].into_iter().filter(|_| is_unused) {
                let given = step.get(field).and_then(Node::greatest);
                if given != defaults[field].as_f64() {
                    let location = location.field(field);
                    let message = format!(
                        "{location} has no effect with `refine` \"matting\": use \"guided\", or remove it"
                    );
                    self.refuse(|| location.error(message));
                }
            }
        }
    }

    /// Requested results of enhancements that some frame does not have.
    fn check_enhanced(&mut self, document: &Node, certain: &BTreeSet<String>) {
        for (location, items) in find_lists(document, "artifacts") {
            for (position, item) in items.iter().enumerate() {
                for (pointer, text) in item.strings(&location.item(position).pointer) {
                    let kind = ArtifactKind::parse(text);
                    let Some((name, step)) = kind.as_ref().and_then(ArtifactKind::enhancement) else {
                        continue;
                    };
                    let has_name = certain.contains(name);
                    if certain.contains(text.trim_start_matches("enhanced.")) {
                        continue;
                    }
                    self.refuse(|| {
                        let message = match step {
                            Some(step) if has_name => {
                                format!(
                                    "the artifact \"{text}\" needs a step `{step}`, which \"{name}\" lacks"
                                )
                            }
                            _ => format!(
                                "the artifact \"{text}\" needs \"{name}\" in `enhance` of every frame"
                            ),
                        };
                        let prefix = format!("{name}.");
                        let kinds = certain
                            .iter()
                            .filter(|kind| !has_name || kind.starts_with(&prefix));
                        let kinds: Vec<_> = kinds.map(|kind| format!("enhanced.{kind}")).collect();
                        let error = FieldError::new(&pointer, message).value(&Value::from(text));
                        if kinds.is_empty() {
                            error
                        } else {
                            error.allowed(kinds, text)
                        }
                    });
                }
            }
        }
    }
}

/// The declared parameters of a method: of a step of a chain, or of the method that an object names.
fn list_parameters(shape: &Shape, map: &Map<String, Value>) -> &'static [Field] {
    match shape {
        Shape::Object(fields) => fields,
        Shape::Either(_, object) => list_parameters(object, map),
        Shape::Tagged { tag, options, .. } => {
            let name = map.get(*tag).and_then(Value::as_str);
            let option = options.iter().find(|option| Some(option.name) == name);
            option.map_or(&[], |option| option.fields)
        }
        _ => &[],
    }
}

/// The kinds, without `enhanced.`, of an element that has one name in every frame.
fn certain_kinds(possible: &[Possible<'_>]) -> Vec<String> {
    let Some((first, others)) = possible.split_first() else {
        return Vec::new();
    };
    if others.iter().any(|other| other.name != first.name) {
        return Vec::new();
    }
    let in_all = first.steps.iter();
    let in_all = in_all.filter(|step| others.iter().all(|other| other.steps.contains(step)));
    let steps = in_all.map(|step| format!("{}.{step}", first.name));
    std::iter::once(first.name.to_owned()).chain(steps).collect()
}

/// The names of all enhancements that a frame can have.
pub(crate) fn names_in(document: &Node) -> BTreeSet<String> {
    let lists = find_lists(document, "enhance");
    let items = lists.iter().flat_map(|(_, items)| items.iter());
    let possible = items.flat_map(|item| item.alternatives(""));
    possible
        .filter_map(|(_, node)| find_name(node))
        .map(str::to_owned)
        .collect()
}

/// The name of an enhancement: given, or that of its method.
fn find_name(enhancement: &Node) -> Option<&str> {
    match enhancement {
        Node::Constant(name) => name.as_str(),
        enhancement => {
            let named = ["name", "method"]
                .iter()
                .find_map(|field| match enhancement.get(field) {
                    Some(Node::Constant(name)) => name.as_str(),
                    _ => None,
                });
            named.filter(|name| *name != "chain" || enhancement.get("name").is_some())
        }
    }
}
