//! Parameters and inputs of an experiment.

use std::collections::BTreeMap;
use std::path::PathBuf;

use cli::exit::Failure;
use cli::styles::StyleArguments;

/// A parameter of an experiment, set with `--set NAME=VALUE`.
#[derive(Debug, Clone, Copy)]
pub struct Parameter {
    /// Its name.
    pub name: &'static str,
    /// Its value unless set; empty for none.
    pub default: &'static str,
    /// Smallest and largest number; `None` for text.
    limits: Option<[f64; 2]>,
    /// Its meaning.
    pub about: &'static str,
}

type Text = &'static str;

impl Parameter {
    /// A number.
    #[must_use]
    pub const fn number(name: Text, default: Text, limits: [f64; 2], about: Text) -> Self {
        let limits = Some(limits);
        Self {
            name,
            default,
            limits,
            about,
        }
    }

    /// A text, empty unless set.
    #[must_use]
    pub const fn text(name: Text, about: Text) -> Self {
        let (default, limits) = ("", None);
        Self {
            name,
            default,
            limits,
            about,
        }
    }
}

/// Parameters and files of an experiment.
#[derive(Debug, Clone)]
pub struct Setup {
    values: BTreeMap<&'static str, String>,
    /// Files named by the user.
    pub inputs: Vec<PathBuf>,
    /// Style networks and their runtime.
    pub styles: StyleArguments,
}

impl Setup {
    /// Default parameters without inputs.
    #[must_use]
    pub fn new(parameters: &[Parameter], styles: StyleArguments) -> Self {
        let all = parameters
            .iter()
            .map(|parameter| (parameter.name, parameter.default));
        let given = all.filter(|(_, default)| !default.is_empty());
        let values = given.map(|(name, default)| (name, default.to_owned())).collect();
        let inputs = Vec::new();
        Self {
            values,
            inputs,
            styles,
        }
    }

    /// Applies settings `NAME=VALUE` of the parameters of an experiment.
    ///
    /// # Errors
    /// All mistakes.
    pub fn set(&mut self, parameters: &[Parameter], settings: &[String]) -> Result<(), Failure> {
        let mut mistakes = Vec::new();
        for setting in settings {
            let (name, value) = setting.split_once('=').unwrap_or((setting, ""));
            match parameters.iter().find(|parameter| parameter.name == name) {
                None => {
                    let known: Vec<&str> = parameters.iter().map(|parameter| parameter.name).collect();
                    mistakes.push(format!(
                        "there is no parameter `{name}`; known: {}",
                        known.join(", ")
                    ));
                }
                Some(Parameter {
                    limits: Some([low, high]),
                    ..
                }) if !value.parse().is_ok_and(|v: f64| (*low..=*high).contains(&v)) => {
                    mistakes.push(format!(
                        "`{name}` is {value}; must be a number from {low} to {high}"
                    ));
                }
                Some(parameter) => drop(self.values.insert(parameter.name, value.to_owned())),
            }
        }
        match mistakes.as_slice() {
            [] => Ok(()),
            _ => Err(Failure::BadInput(mistakes.join("\n"))),
        }
    }

    /// A text parameter, if set.
    #[must_use]
    pub fn text(&self, name: &str) -> Option<&str> {
        self.values.get(name).map(String::as_str)
    }

    /// A number, if it has a value.
    #[must_use]
    pub fn optional_number(&self, name: &str) -> Option<f64> {
        self.text(name)?.parse().ok()
    }

    /// A number.
    ///
    /// # Panics
    /// The parameter has no value.
    #[must_use]
    pub fn number(&self, name: &str) -> f64 {
        self.optional_number(name).expect("a parameter with a default")
    }

    /// A count.
    ///
    /// # Panics
    /// As [`Setup::number`].
    #[must_use]
    pub fn count(&self, name: &str) -> usize {
        self.number(name) as usize
    }

    /// The inputs; an error without any.
    ///
    /// # Errors
    /// There is none.
    pub fn required_inputs(&self, what: &str) -> Result<&[PathBuf], Failure> {
        match self.inputs.as_slice() {
            [] => Err(Failure::BadInput(format!(
                "no input; name {what} after the experiment"
            ))),
            inputs => Ok(inputs),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_mistakes_are_reported_together() {
        let parameters = [
            Parameter::number("frames", "8", [1.0, 100.0], "frames"),
            Parameter::text("family", "only this family"),
        ];
        let styles = StyleArguments {
            styles: None,
            onnxruntime: None,
        };
        let mut setup = Setup::new(&parameters, styles);
        setup.set(&parameters, &["family=water".to_owned()]).unwrap();
        assert_eq!((setup.count("frames"), setup.text("family")), (8, Some("water")));
        let wrong = ["frames=0", "seed=1"].map(str::to_owned);
        let refused = setup.set(&parameters, &wrong).unwrap_err().to_string();
        assert!(
            refused.contains("`frames` is 0; must be a number from 1 to 100"),
            "{refused}"
        );
        assert!(refused.contains("known: frames, family"), "{refused}");
        assert!(setup.required_inputs("a job").is_err());
    }
}
