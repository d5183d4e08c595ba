//! One enhancement outside a job: `hscm`, `hscm:cutoff=16,mask=paper`, or JSON as in a job.

use serde_json::{Map, Value};

use super::{Checker, Location};
use crate::described::Described;
use crate::enhancement::Enhancement;
use crate::invalid::{FieldError, Invalid};
use crate::json;
use crate::node::Node;
use crate::schema::Names;
use crate::vocabulary::Vocabulary;

impl Enhancement {
    /// Reads an enhancement for a picture, without networks of the user.
    ///
    /// # Errors
    /// As [`Enhancement::parse_with`].
    pub fn parse(text: &str) -> Result<Self, Invalid> {
        Self::parse_with(text, &Vocabulary::default())
    }

    /// Reads an enhancement for a picture with the networks of a vocabulary. Distributions are refused: they are drawn for the
    /// frames of a job.
    ///
    /// # Errors
    /// All errors of the fields, with pointers into the JSON form.
    pub fn parse_with(text: &str, vocabulary: &Vocabulary) -> Result<Self, Invalid> {
        let written = read(text)?;
        let mut checker = Checker::new(vocabulary, 0);
        let location = Location {
            pointer: String::new(),
            name: "enhancement".to_owned(),
        };
        let node = match (&written, Self::SHAPE) {
            (Value::String(name), _) => checker.check_text(&location, Names::Method, name),
            (written, shape) => checker.check(&location, &shape, false, written),
        };
        if let Some(node) = &node {
            checker.find_possible(&location, node);
            checker.check_enhancement_rules(node);
            for law in node.laws() {
                let message = "a distribution is drawn for each frame of a job; write one value";
                checker.refuse(|| FieldError::new(&law.pointer, message).limit("one value"));
            }
        }
        match (node, checker.errors.is_empty()) {
            (Some(node), true) => serde_json::from_value(node.canonical())
                .map_err(|error| Invalid(vec![FieldError::new("", error.to_string())])),
            _ => Err(Invalid(checker.errors)),
        }
    }
}

impl Checker<'_> {
    /// Checks the rules across the fields of an enhancement.
    fn check_enhancement_rules(&mut self, node: &Node) {
        let document = Node::Object(vec![("enhance".to_owned(), Node::List(vec![node.clone()]))]);
        let before = self.errors.len();
        self.check_rules(&super::present::Contents::read(&document));
        for error in &mut self.errors[before..] {
            error.pointer = error.pointer.trim_start_matches("/enhance/0").to_owned();
            error.message = error.message.replace("enhance[0]", "enhancement");
        }
    }
}

/// The written form as JSON.
fn read(text: &str) -> Result<Value, Invalid> {
    if text.trim_start().starts_with('{') {
        return json::read(text.as_bytes());
    }
    let Some((method, fields)) = text.split_once(':') else {
        return Ok(text.into());
    };
    let mut object = Map::from_iter([("method".to_owned(), method.into())]);
    for field in split_outside_brackets(fields) {
        let Some((name, value)) = field.split_once('=') else {
            let message = format!("`{field}` has no value; write METHOD:FIELD=VALUE,FIELD=VALUE");
            return Err(Invalid(vec![FieldError::new("", message)]));
        };
        let value = serde_json::from_str(value).unwrap_or_else(|_| value.into());
        if object.insert(name.to_owned(), value).is_some() {
            let message = format!("`{name}` is given twice");
            return Err(Invalid(vec![FieldError::new(&format!("/{name}"), message)]));
        }
    }
    Ok(object.into())
}

/// The parts between commas that are not inside `[…]` or `{…}`.
fn split_outside_brackets(text: &str) -> Vec<&str> {
    let (mut parts, mut depth, mut start) = (Vec::new(), 0_i32, 0);
    for (position, letter) in text.char_indices() {
        match letter {
            '[' | '{' => depth += 1,
            ']' | '}' => depth -= 1,
            ',' if depth == 0 => {
                parts.push(&text[start..position]);
                start = position + 1;
            }
            _ => {}
        }
    }
    parts.push(&text[start..]);
    parts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::enhancement::Step;
    use crate::enhancement::mask::Mask;
    use crate::vocabulary::KnownNetwork;

    fn errors(text: &str) -> Vec<(String, String)> {
        let Invalid(errors) = Enhancement::parse(text).unwrap_err();
        errors
            .into_iter()
            .map(|error| (error.pointer, error.message))
            .collect()
    }

    #[test]
    fn the_short_form_is_the_json_form() {
        let short = Enhancement::parse("hscm:cutoff=16,tiles=[4,2],mask=paper,median_px=3").unwrap();
        let long = Enhancement::parse(
            r#"{"method": "hscm", "cutoff": 16, "tiles": [4, 2], "mask": "paper", "median_px": 3}"#,
        );
        assert_eq!(short, long.unwrap());
        let Step::Hscm(hscm) = &short.steps[0] else {
            panic!("{short:?}");
        };
        assert_eq!((hscm.cutoff, hscm.tiles, hscm.median_px), (16.0, [4, 2], 3));
        assert_eq!(short.mask, Mask::Paper);
        assert_eq!(
            Enhancement::parse("rd").unwrap(),
            Enhancement::of_method("rd").unwrap()
        );
    }

    #[test]
    fn every_error_of_a_picture_is_that_of_a_job() {
        let found = errors("hscm:cutoff=0,median_px=4,gain_low=3,cut=1");
        let pointers: Vec<_> = found.iter().map(|(pointer, _)| pointer.as_str()).collect();
        assert_eq!(pointers, ["/cut", "/cutoff", "/gain_low", "/median_px"]);
        assert!(errors("hscn")[0].1.contains("is not a known enhancement method"));
        let grid = errors("hscm:grid=[8,8]");
        assert_eq!(
            (grid.len(), grid[0].0.as_str()),
            (1, "/grid"),
            "{grid:?}; not a distribution, but `tiles`"
        );
        assert!(errors("hscm:cutoff")[0].1.contains("has no value"));
        assert!(errors("hscm:cutoff=1,cutoff=2")[0].1.contains("twice"));
        assert!(
            errors(r#"{"method": "hscm", "cutoff": {"uniform": [1, 2]}}"#)[0]
                .1
                .contains("of a job")
        );
        assert!(
            errors(r#"{"steps": [{"clahe": {}}]}"#)[0]
                .1
                .contains("without a name")
        );
        assert!(!errors("{").is_empty());
    }

    #[test]
    fn a_network_is_named_by_its_name_or_its_digest() {
        let digest = "ab".repeat(32);
        let vocabulary = Vocabulary {
            styles: vec!["muddy".to_owned()],
            enhancers: vec![KnownNetwork {
                name: "mine".to_owned(),
                digest: digest.clone(),
                size: None,
            }],
            ..Vocabulary::default()
        };
        let parse = |text: &str| Enhancement::parse_with(text, &vocabulary);
        let by_name = parse("onnx:model=mine,mask=paper").unwrap();
        assert_eq!(by_name.name, "onnx");
        assert_eq!(
            by_name,
            parse(&format!("onnx:model={digest},mask=paper")).unwrap()
        );
        let Invalid(refused) = parse("onnx:model=muddy").unwrap_err();
        assert_eq!(refused[0].pointer, "/model");
        assert!(refused[0].message.contains("is a style; use it as `water.style`"));
        assert_eq!(refused[0].allowed, ["mine"]);
        for text in ["onnx", "onnx:mask=paper", "onnx:model=mine"] {
            let message = errors(text).remove(0).1;
            assert!(
                message.contains("model") || message.contains("--styles"),
                "{message}"
            );
        }
    }
}
