//! The enhancements of a frame.
//!
//! An enhancement is a chain of steps. It is written as the name of a method, `"hscm"`, as a method with parameters,
//! `{"method": "hscm", "cutoff": 16}`, or as several steps, `{"name": "mine", "steps": [{"gray_world": {}}, {"clahe":
//! {"clip": 2}}]}`.

pub(crate) mod mask;
pub(crate) mod mask_image;
pub(crate) mod parameters;

use serde::Deserialize;
use serde::de::{DeserializeOwned, Error};
use serde_json::{Map, Value};
use spec_derive::Described;

use crate::described::Described;
use crate::schema::{Field, Names, Presence, Shape, Variant, parse_default};
use mask::Mask;
use parameters::{
    Clahe, DarkChannel, EnhancerNetwork, Fusion, GrayWorld, Guided, Hscm, Ibla, Mlle, Rayleigh, Stretching,
};

/// One result of a frame, from its picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Enhancement {
    /// Name of its artifacts and metrics.
    pub name: String,
    /// The kept part of the picture.
    pub mask: Mask,
    /// Where metrics are measured.
    pub metrics_over: MetricsOver,
    /// At least one step, each on the result of the previous one.
    pub steps: Vec<Step>,
}

/// The measured part of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, Described)]
#[serde(rename_all = "snake_case")]
pub enum MetricsOver {
    /// The whole picture, before the mask.
    #[default]
    Picture,
    /// The part that the mask keeps.
    Mask,
}

/// Fields of every enhancement.
#[derive(Debug, Clone, Deserialize, Described)]
struct Shared {
    /// name of the artifact `enhanced.NAME` and of the metrics `NAME.METRIC`; that of the method unless given
    #[field(fixed, names = Enhancement)]
    name: Option<String>,
    /// the kept part; pixels outside are black
    #[field(default = "none")]
    mask: Mask,
    /// the measured part
    #[field(fixed, default = "picture")]
    metrics_over: MetricsOver,
}

/// Fields of a chain.
#[derive(Debug, Clone, Deserialize, Described)]
struct Chain {
    /// methods with their parameters, each on the result of the one before
    #[field(max = 8)]
    steps: Vec<Step>,
}

/// Artifact of the kept part, `enhanced.NAME.mask`.
pub const MASK_STEP: &str = "mask";
/// Results of the stages of HSCM, each an input of the next; the last one is merged with the chroma.
pub const HSCM_STEPS: [&str; 3] = ["homomorphic", "median", "contrast"];

const METHOD: &str = "method";
const CHAIN: &str = "chain";

/// Method of the user's networks, which has no defaults.
pub const NETWORK_METHOD: &str = "onnx";

/// Declares the methods: variant, name, parameters and meaning; the first ones have a default for every parameter.
macro_rules! methods {
    (@all $names:tt $($Method:ident $name:literal $Parameters:ident $about:literal;)*) => {
        /// A method with its parameters.
        #[derive(Debug, Clone, PartialEq, Deserialize, Described)]
        #[serde(rename_all = "snake_case")]
        pub enum Step {
            $(#[doc = $about] $Method($Parameters),)*
        }

        /// Names of the methods that need no parameters.
        pub const METHODS: &[&str] = &$names;

        impl Step {
            /// Name of the method.
            #[must_use]
            pub fn name(&self) -> &'static str {
                match self { $(Self::$Method(_) => $name,)* }
            }

            /// Short description and source.
            #[must_use]
            pub fn about(&self) -> &'static str {
                match self { $(Self::$Method(_) => $about,)* }
            }
        }

        impl Described for Enhancement {
            const NAME: &'static str = "Enhancement";
            const SHAPE: Shape = Shape::Either(
                Names::Method,
                &Shape::Tagged {
                    tag: METHOD,
                    presence: Presence::Default("\"chain\""),
                    options: &[
                        $(Variant {
                            name: $name,
                            fields: {
                                const ALL: [Field; Shared::FIELDS.len() + $Parameters::FIELDS.len()] =
                                    join(Shared::FIELDS, $Parameters::FIELDS);
                                &ALL
                            },
                            type_name: concat!(stringify!($Method), "Enhancement"),
                        },)*
                        Variant {
                            name: CHAIN,
                            fields: {
                                const ALL: [Field; Shared::FIELDS.len() + Chain::FIELDS.len()] =
                                    join(Shared::FIELDS, Chain::FIELDS);
                                &ALL
                            },
                            type_name: "ChainEnhancement",
                        },
                    ],
                },
            );
        }
    };
    (
        with_defaults { $($Method:ident $name:literal $Parameters:ident $about:literal;)* }
        with_parameters { $($rest:tt)* }
    ) => {
        methods! { @all [$($name),*] $($Method $name $Parameters $about;)* $($rest)* }
    };
}

methods! {
    with_defaults {
        Hscm "hscm" Hscm "homomorphic filter, spatial median, CLAHE and color merge";
        Clahe "clahe" Clahe "CLAHE of the luma, the chroma kept (Zuiderveld 1994)";
        GrayWorld "gray_world" GrayWorld "gray world: each channel scaled to the mean of all (Buchsbaum 1980)";
        Ulap "ulap" Guided "restoration by the underwater light attenuation prior (Song et al. 2018)";
        Suir "suir" Guided "blue-green dehazing and red correction (Li, Guo, Pang, Chen and Wang 2016)";
        Ibla "ibla" Ibla "restoration by blurriness and light absorption (Peng and Cosman 2017)";
        Rd "rd" Rayleigh "two pictures integrated by the Rayleigh distribution (Abdul Ghani and Mat Isa 2014)";
        Rghs "rghs" Stretching "relative global histogram stretching (Huang et al. 2018)";
        Dcp "dcp" DarkChannel "restoration by the dark channel prior (He, Sun and Tang 2011)";
        Udcp "udcp" DarkChannel "restoration by the dark channel of green and blue (Drews et al. 2016)";
        Fusion "fusion" Fusion "color balance and multi-scale fusion (Ancuti et al. 2018)";
        Mlle "mlle" Mlle "minimal color loss and locally adaptive contrast (Zhang et al. 2022)";
    }
    with_parameters {
        Onnx "onnx" EnhancerNetwork "a network of the user, on ONNX Runtime";
    }
}

const fn join<const N: usize>(shared: &[Field], own: &[Field]) -> [Field; N] {
    let mut all = [shared[0]; N];
    let mut position = 0;
    while position < N {
        all[position] = if position < shared.len() {
            shared[position]
        } else {
            own[position - shared.len()]
        };
        position += 1;
    }
    all
}

impl Enhancement {
    /// The method of this name with its defaults.
    #[must_use]
    pub fn of_method(name: &str) -> Option<Self> {
        let field = Step::FIELDS.iter().find(|field| field.name == name)?;
        let Shape::Object(fields) = field.shape else {
            return None;
        };
        let step = Map::from_iter([(name.to_owned(), defaults(fields).into())]);
        Some(Self::from(serde_json::from_value::<Step>(step.into()).ok()?))
    }

    /// Reads `{"method": …}` or `{"steps": […]}` with every default filled in.
    fn from_object(mut object: Map<String, Value>) -> Result<Self, serde_json::Error> {
        let method = object.remove(METHOD);
        let Shared {
            name,
            mask,
            metrics_over,
        } = take(&mut object, Shared::FIELDS)?;
        let method = method.as_ref().and_then(Value::as_str).unwrap_or(CHAIN);
        let steps = if method == CHAIN {
            take::<Chain>(&mut object, Chain::FIELDS)?.steps
        } else {
            let step = Map::from_iter([(method.to_owned(), object.into())]);
            vec![serde_json::from_value(step.into())?]
        };
        Ok(Self {
            name: name.unwrap_or_else(|| method.to_owned()),
            mask,
            metrics_over,
            steps,
        })
    }
}

/// A step alone, under the name of its method.
impl From<Step> for Enhancement {
    fn from(step: Step) -> Self {
        Self {
            name: step.name().to_owned(),
            mask: Mask::None,
            metrics_over: MetricsOver::Picture,
            steps: vec![step],
        }
    }
}

impl<'de> Deserialize<'de> for Enhancement {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        match Value::deserialize(deserializer)? {
            Value::String(name) => Self::of_method(&name)
                .ok_or_else(|| D::Error::custom(format!("`{name}` is not an enhancement method"))),
            Value::Object(object) => Self::from_object(object).map_err(D::Error::custom),
            _ => Err(D::Error::custom("an enhancement is a string or an object")),
        }
    }
}

/// Names of the intermediate results of an enhancement as written: stages of HSCM alone, positions in a chain.
pub(crate) fn steps_of(written: &Value) -> Vec<String> {
    let mut steps = vec![MASK_STEP.to_owned()];
    match written.get("steps").and_then(Value::as_array) {
        Some(chain) => steps.extend((1..chain.len()).map(|position| position.to_string())),
        None => {
            let method = written.get(METHOD).unwrap_or(written);
            if method == "hscm" {
                steps.extend(HSCM_STEPS.map(str::to_owned));
            }
        }
    }
    steps
}

/// Removes these fields from an object and reads them.
fn take<T: DeserializeOwned>(
    object: &mut Map<String, Value>,
    fields: &[Field],
) -> Result<T, serde_json::Error> {
    let own = fields.iter().filter_map(|field| object.remove_entry(field.name));
    let own: Map<_, _> = own.collect();
    serde_json::from_value(own.into())
}

/// The default of each field that has one.
pub(crate) fn defaults(fields: &[Field]) -> Map<String, Value> {
    let given = fields.iter().filter_map(|field| match field.presence {
        Presence::Default(text) => Some((field.name.to_owned(), parse_default(text))),
        Presence::Required | Presence::Optional => None,
    });
    given.collect()
}

/// Implements `Default` by the defaults of the description.
macro_rules! by_description {
    ($($Parameters:ty),*) => {$(
        impl Default for $Parameters {
            fn default() -> Self {
                let fields = defaults(Self::FIELDS).into();
                serde_json::from_value(fields).expect("a test reads the defaults of every method")
            }
        }
    )*};
}

by_description!(
    Hscm,
    Clahe,
    DarkChannel,
    Fusion,
    GrayWorld,
    Guided,
    Ibla,
    Mlle,
    Rayleigh,
    Stretching
);

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn read(value: Value) -> Enhancement {
        serde_json::from_value(value).unwrap()
    }

    #[test]
    fn every_method_has_defaults() {
        for name in METHODS {
            let enhancement = Enhancement::of_method(name).unwrap();
            assert_eq!(
                (enhancement.name.as_str(), enhancement.steps[0].name()),
                (*name, *name)
            );
            assert_eq!(enhancement, read(json!(name)));
        }
        assert_eq!(Enhancement::of_method("chain"), None);
        assert_eq!(Enhancement::of_method(NETWORK_METHOD), None);
        assert_eq!((Hscm::default().cutoff, Hscm::default().tiles), (32.0, [8, 8]));
    }

    #[test]
    fn a_method_with_parameters_is_a_chain_of_one_step() {
        let mut fields = defaults(Hscm::FIELDS);
        fields.extend([
            ("method".to_owned(), json!("hscm")),
            ("name".to_owned(), json!("wide")),
            ("mask".to_owned(), json!("paper")),
            ("metrics_over".to_owned(), json!("mask")),
            ("cutoff".to_owned(), json!(16)),
        ]);
        let enhancement = read(fields.into());
        assert_eq!(enhancement.name, "wide");
        assert_eq!(enhancement.mask, Mask::Paper);
        assert_eq!(enhancement.metrics_over, MetricsOver::Mask);
        let expected = Hscm {
            cutoff: 16.0,
            ..Hscm::default()
        };
        assert_eq!(enhancement.steps, [Step::Hscm(expected)]);
    }

    #[test]
    fn a_network_is_a_method_with_a_model() {
        let alone = read(json!({
            "method": "onnx", "name": "mine", "model": "net", "mask": "paper", "metrics_over": "mask",
        }));
        let network = EnhancerNetwork {
            model: "net".to_owned(),
        };
        assert_eq!((alone.name.as_str(), alone.mask), ("mine", Mask::Paper));
        assert_eq!(alone.steps, [Step::Onnx(network.clone())]);
        let chain = read(json!({
            "method": "chain", "name": "mine", "mask": "none", "metrics_over": "picture",
            "steps": [{"gray_world": {}}, {"onnx": {"model": "net"}}],
        }));
        assert_eq!(chain.steps[1], Step::Onnx(network));
    }

    #[test]
    fn steps_keep_their_order() {
        let enhancement = read(json!({
            "method": "chain", "name": "mine", "mask": "none", "metrics_over": "picture",
            "steps": [{"gray_world": {}}, {"clahe": {"clip": 3, "tiles": [4, 2]}}],
        }));
        let names: Vec<_> = enhancement.steps.iter().map(Step::name).collect();
        assert_eq!(names, ["gray_world", "clahe"]);
        let Step::Clahe(clahe) = enhancement.steps[1] else {
            panic!("{enhancement:?}");
        };
        assert_eq!(
            clahe,
            Clahe {
                clip: 3.0,
                tiles: [4, 2]
            }
        );
    }
}
