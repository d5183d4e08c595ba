//! The site `paper` is the published chain: with the picture and the numbers of a reference vector it renders that vector.

use std::path::PathBuf;
use std::sync::Arc;

use fathom_tests::root;
use imaging::codec::{NpyValues, decode_npy, decode_picture};
use imaging::transfer::encode_rgb8;
use imaging::{Plane, Rgb};
use renderer::{Engine, Rendered};
use serde_json::{Value, json};
use spec::{Fidelity, Job, ScatterModel, SceneLighting};
use style::Library;

use crate::common::{file, installed_runtime, try_render};
use crate::onnx::Fixed;

/// The default fidelity `picture` allows an error of one code.
const MOST_APART: u8 = 1;
/// Share of the samples that may be one code apart, as the vectors allow for a tolerance of one code.
const MOST_DIFFERENT: f64 = 0.01;

struct Vector {
    folder: PathBuf,
    numbers: Value,
}

impl Vector {
    fn read(name: &str) -> Self {
        let folder = root().join("workers/optics/tests/vectors/chain").join(name);
        let text = std::fs::read_to_string(folder.join("params.json")).unwrap();
        let numbers = serde_json::from_str(&text).unwrap();
        Self { folder, numbers }
    }

    fn path(&self, array: &str) -> String {
        self.folder
            .join(format!("{array}.npy"))
            .to_str()
            .unwrap()
            .to_owned()
    }

    fn array(&self, name: &str) -> (Vec<usize>, Vec<f64>) {
        let array = decode_npy(&std::fs::read(self.path(name)).unwrap()).unwrap();
        let values = match array.values {
            NpyValues::F64(values) => values,
            NpyValues::F32(values) => values.into_iter().map(f64::from).collect(),
            NpyValues::U8(codes) => codes.into_iter().map(f64::from).collect(),
            NpyValues::U16(_) | NpyValues::Wide(_) => panic!("{name}: no vector has such a type"),
        };
        (array.shape, values)
    }

    /// The 8-bit codes of linear light, interleaved.
    fn codes_of_light(&self, name: &str) -> Vec<u8> {
        let (shape, values) = self.array(name);
        let plane = |channel: usize| {
            let samples = values.iter().skip(channel).step_by(3).map(|&light| light as f32);
            Plane::new(shape[1], shape[0], samples.collect()).unwrap()
        };
        let light = Rgb::new([0, 1, 2].map(plane)).unwrap();
        encode_rgb8(&light).0.data().to_vec()
    }

    /// The job: the site `paper` with the picture of this vector and its water. Fields of the site that the vector has no number
    /// for are removed.
    fn job(&self, picture: &str, model: &str) -> Value {
        let mut scatter = json!({"model": model, "spread_px_per_m": self.numbers["spread_px_per_m"]});
        if let Some(g) = self.numbers.get("G_per_m") {
            scatter["g_per_m"] = g.clone();
        }
        json!({
            "site": "paper", "camera": null, "metrics": [], "artifacts": ["rgb"],
            "scene": {"kind": "files", "rgb": self.path(picture), "range": self.path("range_m")},
            "water": {
                "optics": {
                    "preset": null, "veil_gain": null, "beam_attenuation_per_m": self.numbers["attenuation_per_m"],
                    "veiling_light": self.numbers["background"], "forward_scatter": scatter
                },
                "range_scale": 1, "style": null
            },
            "alpha": null, "lights": []
        })
    }

    /// The network whose output is the vector's `model_srgb`.
    fn style(&self) -> Vec<u8> {
        let (shape, values) = self.array("model_srgb");
        let planes = [0, 1, 2].map(|channel| values.iter().skip(channel).step_by(3));
        let samples: Vec<f32> = planes.into_iter().flatten().map(|&value| value as f32).collect();
        Fixed {
            width: shape[1],
            height: shape[0],
            samples: &samples,
        }
        .bytes()
    }

    /// The haze of the vector in the terms of a job.
    fn haze(&self) -> Value {
        let lights = self.numbers["lights"].as_array().unwrap().iter();
        lights
            .map(|light| {
                json!({
                    "kind": "haze", "x": light["position"][0], "y": light["position"][1], "size": light["size"],
                    "intensity": light["intensity"], "color": light["color"], "space": self.numbers["haze_space"]
                })
            })
            .collect()
    }
}

fn render(job: &Value, library: Library, model: ScatterModel) -> Rendered {
    let vocabulary = renderer::vocabulary(&library, true);
    let job =
        Job::parse(job.to_string().as_bytes(), &vocabulary).unwrap_or_else(|invalid| panic!("{invalid}"));
    let frame = job.resolve(0).unwrap();
    assert_eq!(frame.site.as_ref().unwrap().name, "paper");
    assert_eq!(
        (frame.fidelity, frame.scene.lighting()),
        (Fidelity::Picture, SceneLighting::InAir)
    );
    let scatter = frame
        .water
        .optics
        .as_ref()
        .and_then(|optics| optics.forward_scatter);
    assert_eq!(scatter.unwrap().model, model);
    let engine = Engine::new(library, installed_runtime().as_deref());
    try_render(&job, &Arc::new(engine)).unwrap()
}

fn assert_codes(rendered: &Rendered, expected: &[u8]) {
    let picture = decode_picture(file(rendered, "rgb")).unwrap().to_rgb8();
    assert_eq!(picture.data().len(), expected.len());
    let apart: Vec<u8> = picture
        .data()
        .iter()
        .zip(expected)
        .map(|(actual, expected)| actual.abs_diff(*expected))
        .collect();
    let different = apart.iter().filter(|apart| **apart > 0).count();
    let share = different as f64 / apart.len() as f64;
    println!("{:.2} % of the codes differ", 100.0 * share);
    assert!(
        apart.iter().all(|apart| *apart <= MOST_APART),
        "codes are {:?} apart",
        apart.iter().max()
    );
    assert!(share <= MOST_DIFFERENT, "{share}");
}

/// The scatter of the site, Eq. 8 and 9, on the vector of that stage.
#[test]
fn the_site_of_the_paper_renders_the_reference_vector_of_its_scatter() {
    let vector = Vector::read("06-simplified-pole");
    let job = vector.job("input_linear", "simplified");
    let rendered = render(&job, Library::embedded().unwrap(), ScatterModel::Simplified);
    assert_codes(&rendered, &vector.codes_of_light("output_linear"));
}

/// Water, style and haze, on the vector of the whole chain, which scatters by Eq. 3 to 6.
#[test]
fn the_site_of_the_paper_renders_the_reference_vector_of_the_whole_chain() {
    let vector = Vector::read("08-chain");
    let library = Library::embedded()
        .unwrap()
        .with_model("stand-in", vector.style(), None)
        .unwrap();
    let mut job = vector.job("input_srgb", "jaffe");
    job["water"]["style"] = json!("stand-in");
    job["alpha"] = vector.numbers["alpha"].clone();
    job["lights"] = vector.haze();
    let rendered = render(&job, library, ScatterModel::Jaffe);
    assert!(rendered.record.provenance.inputs.contains_key("style.stand-in"));
    let (_, codes) = vector.array("output_srgb");
    let codes: Vec<u8> = codes.into_iter().map(|code| code as u8).collect();
    assert_codes(&rendered, &codes);
}
