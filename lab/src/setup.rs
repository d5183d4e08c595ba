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
    pub limits: Option<[f64; 2]>,
    /// Its meaning.
    pub about: &'static str,
}

impl Parameter {
    /// A number.
    #[must_use]
    pub const fn number(
        name: &'static str,
        default: &'static str,
        limits: [f64; 2],
        about: &'static str,
    ) -> Self {
        Self {
            name,
            default,
            limits: Some(limits),
            about,
        }
    }

    /// A text, empty unless set.
    #[must_use]
    pub const fn text(name: &'static str, about: &'static str) -> Self {
        Self {
            name,
            default: "",
            limits: None,
            about,
        }
    }

    /// What is wrong with a value.
    fn find_mistake(&self, value: &str) -> Option<String> {
        let [low, high] = self.limits?;
        let is_valid = value.parse().is_ok_and(|v: f64| (low..=high).contains(&v));
        (!is_valid).then(|| {
            format!(
                "`{}` is {value}; must be a number from {low} to {high}",
                self.name
            )
        })
    }
}

/// What an experiment measures.
#[derive(Debug, Clone)]
pub struct Setup {
    values: BTreeMap<&'static str, String>,
    /// Files named by the user.
    pub inputs: Vec<PathBuf>,
    /// Style networks and their runtime.
    pub styles: StyleArguments,
}

impl Setup {
    /// Checks all settings `NAME=VALUE` against the parameters of an experiment.
    ///
    /// # Errors
    /// All mistakes.
    pub fn new(
        parameters: &[Parameter],
        settings: &[String],
        inputs: Vec<PathBuf>,
        styles: StyleArguments,
    ) -> Result<Self, Failure> {
        let defaults = parameters
            .iter()
            .filter(|parameter| !parameter.default.is_empty());
        let mut values: BTreeMap<&str, String> = defaults
            .map(|parameter| (parameter.name, parameter.default.to_owned()))
            .collect();
        let mut mistakes = Vec::new();
        for setting in settings {
            let (name, value) = setting.split_once('=').unwrap_or((setting, ""));
            let Some(parameter) = parameters.iter().find(|parameter| parameter.name == name) else {
                let known: Vec<&str> = parameters.iter().map(|parameter| parameter.name).collect();
                mistakes.push(format!(
                    "`--set {setting}`: there is no parameter `{name}`; known: {}",
                    known.join(", ")
                ));
                continue;
            };
            match parameter.find_mistake(value) {
                Some(mistake) => mistakes.push(mistake),
                None => drop(values.insert(parameter.name, value.to_owned())),
            }
        }
        if mistakes.is_empty() {
            Ok(Self {
                values,
                inputs,
                styles,
            })
        } else {
            Err(Failure::BadInput(mistakes.join("\n")))
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
        if self.inputs.is_empty() {
            return Err(Failure::BadInput(format!(
                "no input; name {what} after the experiment"
            )));
        }
        Ok(&self.inputs)
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
        let read = |settings: &[&str]| {
            let settings: Vec<String> = settings.iter().map(|&setting| setting.to_owned()).collect();
            Setup::new(&parameters, &settings, Vec::new(), styles.clone())
        };
        let setup = read(&["family=water"]).unwrap();
        assert_eq!((setup.count("frames"), setup.text("family")), (8, Some("water")));
        let refused = read(&["frames=0", "seed=1"]).unwrap_err().to_string();
        assert!(
            refused.contains("`frames` is 0; must be a number from 1 to 100"),
            "{refused}"
        );
        assert!(refused.contains("known: frames, family"), "{refused}");
    }
}
