//! A plan line by line, for people and records.

use serde::Serialize;

use super::{Form, GateStep, Plan, ScatterStep, Shadows, Stage, StyleStep, ibla};
use crate::layering::Layering;

/// One line of a plan. What is not known of a stage is left out.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Line {
    /// The stage, with the channel where it differs between channels.
    pub stage: &'static str,
    /// What is done.
    pub variant: &'static str,
    /// Kernels, lamps or lights, where there are some.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub terms: Option<usize>,
    /// The error in linear light that the stage is given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub share: Option<f64>,
    /// What it may add to the error of the picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bound: Option<f64>,
    /// How far its model was measured to be from radiative transfer, or that it was not measured; none of stages without a truth.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub model_error: Option<String>,
    /// Expected milliseconds on the processor that the cost model is measured on.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cost_ms: Option<f64>,
    /// What to know about it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
}

const SCATTER: [&str; 3] = ["forward_scatter.r", "forward_scatter.g", "forward_scatter.b"];

impl Plan {
    /// The plan line by line, in the order of the light.
    #[must_use]
    pub fn lines(&self) -> Vec<Line> {
        let cost = self.cost();
        let mut lines = vec![
            line("scene_light", &self.scene_light, "daylight"),
            line("turbidity", &self.turbidity, "closed_form"),
            line("lamps", &self.lamps, "f32"),
            line("attenuation", &self.attenuation, "f32"),
        ];
        lines.extend(
            SCATTER
                .into_iter()
                .zip(&self.scatter)
                .map(|(stage, step)| scatter(stage, step)),
        );
        lines.push(line("glow", &self.glow, "quadrature"));
        lines.push(line("snow", &self.snow, "discs"));
        lines.push(style(&self.style));
        lines.push(line("haze", &self.haze, "overlay"));
        lines.push(line("enhance", &self.enhance, "methods"));
        for (line, cost_ms) in lines.iter_mut().zip(cost) {
            line.cost_ms = cost_ms;
            line.model_error = self.model.of(line.stage).filter(|_| line.variant != "skip");
            if line.stage == "snow" && line.variant == "skip" && line.bound.is_some() {
                line.note = Some("expected pixels times contrast are within its share".to_owned());
            }
        }
        if let Some(gates) = &self.gates {
            let after = lines.iter().position(|line| line.stage == "attenuation");
            lines.insert(after.map_or(0, |at| at + 1), occlusion(gates));
        }
        for (stage, name, of) in [
            (&self.lamp_shadows, "lamp_shadows", "lamps"),
            (&self.glow_shadows, "glow_shadows", "glow"),
        ] {
            if let Some(stage) = stage {
                let after = lines.iter().position(|line| line.stage == of);
                lines.insert(after.map_or(0, |at| at + 1), self.shadows(name, stage));
            }
        }
        if let Some(clouds) = &self.sediment {
            let before = lines.iter().position(|line| line.stage == "snow");
            lines.insert(before.unwrap_or(lines.len()), self.sediment(clouds));
        }
        if let Some(veil) = &self.veil {
            let after = lines.iter().position(|line| line.stage == "attenuation");
            let own = Line {
                cost_ms: self.veil_cost_ms(),
                model_error: self.model.of("veil"),
                ..by_direction(veil)
            };
            lines.insert(after.map_or(0, |at| at + 1), own);
        }
        if let Some(above) = &self.above {
            let own = above.lines().into_iter().map(|line| Line {
                cost_ms: self.above_cost_ms(line.stage),
                model_error: self.model.of(line.stage).filter(|_| line.variant != "skip"),
                ..line
            });
            lines.splice(1..1, own);
        }
        lines.extend(self.ibla.as_ref().map(ibla::line));
        self.explain(&mut lines);
        lines
    }

    fn shadows(&self, name: &'static str, stage: &Stage<Shadows>) -> Line {
        let is_exact = self.glow.form == Form::Reference || self.lamps.form == Form::Reference;
        Line {
            terms: Some(stage.form.lamps),
            note: Some(stage.form.note()),
            cost_ms: (!is_exact).then(|| self.shadows_cost_ms(name, stage.form)),
            ..with_errors(
                name,
                if is_exact {
                    "reference"
                } else {
                    stage.form.variant()
                },
                stage,
            )
        }
    }

    fn sediment(&self, clouds: &Stage) -> Line {
        let note = match clouds.form {
            Form::Skip => Some("no cloud is in view that hides more than its share"),
            Form::Fast => Some("what lies between the rays it follows is not bounded"),
            Form::Reference => None,
        };
        Line {
            note: note.map(str::to_owned),
            cost_ms: self.sediment_cost_ms(),
            model_error: self.model.of("sediment").filter(|_| clouds.form != Form::Skip),
            ..line("sediment", clouds, "rays")
        }
    }

    /// Says of the stage with the largest bound why all of them exceed the tolerance.
    fn explain(&self, lines: &mut [Line]) {
        let Some(reason) = &self.exceeds else { return };
        let before_style = lines
            .iter_mut()
            .filter(|line| line.stage != "style" && line.bound.is_some());
        if let Some(largest) =
            before_style.max_by(|a, b| a.bound.partial_cmp(&b.bound).unwrap_or(std::cmp::Ordering::Equal))
        {
            largest.note = Some(format!("exceeds the tolerance: {reason}"));
        }
    }
}

impl Serialize for Plan {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.lines().serialize(serializer)
    }
}

fn line(stage: &'static str, step: &Stage, fast: &'static str) -> Line {
    let variant = match step.form {
        Form::Skip => "skip",
        Form::Fast => fast,
        Form::Reference => "reference",
    };
    with_errors(stage, variant, step)
}

fn scatter(stage: &'static str, step: &Stage<ScatterStep>) -> Line {
    let variant = match &step.form {
        ScatterStep::Skip => "skip",
        ScatterStep::Pointwise => "pointwise",
        ScatterStep::Interpolated(_) | ScatterStep::Layered(_) => "chebyshev",
        ScatterStep::Reference => "reference",
    };
    Line {
        terms: step.form.terms(),
        ..with_errors(stage, variant, step)
    }
}

fn by_direction(step: &Stage) -> Line {
    let skipped = "a constant veil differs by no more than its share";
    Line {
        note: (step.form == Form::Skip).then(|| skipped.to_owned()),
        variant: match step.form {
            Form::Skip => "constant",
            Form::Fast => "by_direction",
            Form::Reference => "reference",
        },
        ..line("veil", step, "by_direction")
    }
}

fn occlusion(step: &Stage<GateStep>) -> Line {
    let (variant, note) = match &step.form {
        GateStep::Skip if step.bound.is_some() => (
            "skip",
            "the light that gates would stop is within its share".to_owned(),
        ),
        GateStep::Skip => ("skip", "nothing hides anything".to_owned()),
        GateStep::Reference => ("reference", String::new()),
        GateStep::Gated(layering) => {
            let gates: Vec<String> = layering
                .gates_m
                .iter()
                .map(|gate| format!("{gate:.3} m"))
                .collect();
            let note = format!("gates at {}", gates.join(", "));
            ("gated", note)
        }
    };
    Line {
        terms: step.form.layering().map(Layering::count),
        note: Some(note).filter(|note| !note.is_empty()),
        ..with_errors("occlusion", variant, step)
    }
}

fn style(step: &Stage<StyleStep>) -> Line {
    let (variant, note) = match step.form {
        StyleStep::Skip => ("skip", None),
        StyleStep::Network | StyleStep::RangeNetwork => (
            "network",
            Some("its gain is not known: the bounds hold up to its input"),
        ),
        StyleStep::Table => (
            "table",
            Some("bound: its distance from the network on the same input"),
        ),
    };
    Line {
        note: note.map(str::to_owned),
        ..with_errors("style", variant, step)
    }
}

pub(super) fn with_errors<F>(stage: &'static str, variant: &'static str, step: &Stage<F>) -> Line {
    Line {
        stage,
        variant,
        terms: None,
        share: step.share,
        bound: step.bound,
        model_error: None,
        cost_ms: None,
        note: None,
    }
}
