//! Stability and speed of style networks as experiments. The control is the network of fast neural style.

use cli::exit::Failure;
use style::{Library, Runtime, Session, StyleModel};

use super::johnson::johnson;
use super::speed::{SIZES, Speed};
use super::steadiness::{FLICKER_LIMIT, GAIN_LIMIT, LEVELS, MOVES, Steadiness};
use crate::plot::{Axis, Chart, Form, Lines, Series};
use crate::report::Report;
use crate::row;
use crate::setup::{Parameter, Setup};
use crate::table::{Table, format_number};

/// The parameters of the speed of style networks.
pub const SPEED_PARAMETERS: &[Parameter] = &[Parameter::number(
    "runs",
    "20",
    [1.0, 1000.0],
    "runs of each network; the fastest counts",
)];

fn other(error: impl Into<anyhow::Error>) -> Failure {
    Failure::Other(error.into())
}

fn load_runtime(setup: &Setup) -> Result<Runtime, Failure> {
    Runtime::load(setup.styles.onnxruntime.as_deref())
        .map_err(|missing| Failure::RuntimeMissing(missing.to_string()))
}

/// Models whose input is a picture without a range.
fn list_models(library: &Library) -> Vec<&StyleModel> {
    let models = library.names().into_iter().filter_map(|name| library.get(name));
    models.filter(|model| !model.card.takes_range).collect()
}

/// Measures the stability of every model and of the control.
///
/// # Errors
/// ONNX Runtime is missing, or a model cannot be run.
pub fn run_stability(setup: &Setup) -> Result<Report, Failure> {
    let (library, runtime) = (setup.styles.library()?, load_runtime(setup)?);
    let control = StyleModel::without_card("johnson", johnson(1));
    let mut measured = Vec::new();
    for model in list_models(&library).into_iter().chain([&control]) {
        let session = Session::native(model).map_or_else(|| runtime.session(model), Ok);
        measured.push(Steadiness::measure(&model.name, session.map_err(other)?).map_err(other)?);
    }
    let columns = [
        "model",
        "gain",
        "singular value",
        "flicker",
        "crop",
        "black becomes",
        "white becomes",
        "fails at",
    ];
    let mut table = Table::new("stability", columns);
    for model in &measured {
        let [black, white] = [model.black, model.white].map(|[r, g, b]| format!("{r:.2} {g:.2} {b:.2}"));
        let failed: Vec<String> = model.failed.iter().map(|(w, h)| format!("{w}×{h}")).collect();
        let failed = if failed.is_empty() {
            "none".to_owned()
        } else {
            failed.join(", ")
        };
        let (flicker, crop) = (model.moves[0].1, model.moves[MOVES.len() - 1].1);
        table.push(row![
            model.name,
            model.gain(),
            model.singular,
            flicker,
            crop,
            black,
            white,
            failed
        ]);
    }
    let mut report = Report::new(
        "Stability of style networks; see docs/science/enhancement-stability.md.".to_owned(),
        vec![table],
    );
    let last = LEVELS[LEVELS.len() - 1];
    let gains = measured.iter().map(|model| (&model.name, &model.gains)).collect();
    report.add_chart(
        "style-gain",
        draw(
            "Noise on flat frames",
            "noise, 1/255",
            "gain",
            gains,
            [(LEVELS[0], GAIN_LIMIT), (last, GAIN_LIMIT)],
        ),
    );
    let moves = measured.iter().map(|model| (&model.name, &model.moves)).collect();
    let axis = "root mean square change, of 255";
    report.add_chart(
        "style-flicker",
        draw(
            "Change of the same pixel when the frame moves",
            "move, pixels",
            axis,
            moves,
            [(1.0, FLICKER_LIMIT), (2.0, FLICKER_LIMIT)],
        ),
    );
    Ok(report)
}

/// Curves of all models, and the limit for our network.
fn draw(
    title: &str,
    x: &str,
    y: &str,
    curves: Vec<(&String, &Vec<(f64, f64)>)>,
    limit: [(f64, f64); 2],
) -> Chart {
    let series = curves.into_iter().map(|(name, points)| {
        // A logarithmic axis cannot show zero.
        let points = points.iter().copied().filter(|(_, y)| *y > 0.0);
        Series::new(name, points, Form::Joined)
    });
    Chart::Lines(Lines {
        title: title.to_owned(),
        x: Axis::logarithmic(x),
        y: Axis::logarithmic(y),
        series: series.chain([Series::new("limit", limit, Form::Line)]).collect(),
    })
}

/// Measures the time of the tiers of our network and of the control on ONNX Runtime.
///
/// # Errors
/// ONNX Runtime is missing, or a model cannot be run.
pub fn run_speed(setup: &Setup) -> Result<Report, Failure> {
    let (library, runtime) = (setup.styles.library()?, load_runtime(setup)?);
    let mut models = list_models(&library).into_iter();
    let model = models.find(|model| !model.needs_runtime());
    let model = model.ok_or_else(|| Failure::input("there is no style of our own network"))?;
    let control = StyleModel::without_card("johnson", johnson(1));
    let runs = setup.count("runs");
    let sizes = SIZES.map(|(width, height)| format!("{width}×{height}"));
    let mut table = Table::new(
        "milliseconds",
        ["network".to_owned()]
            .into_iter()
            .chain(sizes)
            .chain(["frames/s, 4 sessions".to_owned()]),
    );
    type Open<'a> = &'a dyn Fn() -> Option<Session>;
    let variants: [(&str, Open<'_>); 4] = [
        ("color table (`lut`)", &|| Session::table(model)),
        ("network (`net`)", &|| Session::native(model)),
        ("`net` on ONNX Runtime", &|| runtime.session(model).ok()),
        ("johnson", &|| runtime.session(&control).ok()),
    ];
    for (name, open) in variants {
        let speed = Speed::measure(open, runs).map_err(other)?;
        let Some(Speed { ms, frames_per_s }) = speed else {
            continue;
        };
        table.push(row![name, ms[0], ms[1], ms[2], format_number(frames_per_s)]);
    }
    Ok(Report::new(
        format!("One thread, the fastest of {runs} runs."),
        vec![table],
    ))
}
