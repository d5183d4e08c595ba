//! The Monte Carlo truth of a frame's light, for the artifacts that need it.

use std::ops::Range;

use imaging::Rgb;
use optics::plan::{Stage, StageId, Variant};
use spec::truth::{TooMuch, seconds};
use spec::{FrameRecord, RaySource, TruthRecord};
use truth::{
    ChainLight, ConvergedTruth, Goal, PathBatch, PhaseModel, PixelSums, ReportRequest, Subject, TracedScene,
    TruthReport, converge,
};

use crate::context::FrameContext;
use crate::error::RenderError;
use crate::inputs::rays;
use crate::light::Light;

/// Options of a Monte Carlo trace.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Tracing {
    /// The accuracy goal.
    pub goal: Goal,
    /// The phase function of the water.
    pub law: PhaseModel,
    /// Seed of the paths.
    pub seed: u64,
    /// Name of the limit reported when tracing stops short of the goal.
    pub limit: &'static str,
}

/// Side of the blocks for measuring errors, px: smaller blocks need more paths, larger ones hide edges.
pub(crate) const BLOCK_PX: usize = 8;

/// Light of a frame by Monte Carlo, and its comparison with the chain.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Traced {
    /// The paths.
    pub truth: ConvergedTruth,
    /// The comparison with the chain.
    pub report: TruthReport,
    /// Whether daylight was traced.
    pub has_sea: bool,
}

/// Traces one round: some samples of every pixel of a scene, row by row. Returns `None` to stop.
pub type Round<'r> = &'r mut dyn FnMut(&PathBatch, &TracedScene<'_>, &Range<u64>) -> Option<Vec<PixelSums>>;

/// Whether an artifact needs the truth and the scene has a range.
pub(crate) fn is_asked(context: &FrameContext<'_>) -> bool {
    context.frame.is_traced() && context.prepared.scene.range.is_some()
}

/// Traces a frame and compares the chain's light with it.
pub(crate) fn run(
    context: &FrameContext<'_>,
    light: &Light,
    record: &mut FrameRecord,
) -> Result<Option<Traced>, RenderError> {
    let frame = context.frame;
    let (asked, most) = (frame.truth.unwrap_or_default(), most_paths(context)?);
    let tracing = Tracing {
        goal: Goal {
            target: asked.target,
            block: BLOCK_PX,
            most_paths: most.paths,
        },
        law: law(context),
        seed: frame.seed,
        limit: most.limit,
    };
    let pixels = pixels(context) as usize;
    let traced = trace(context, light, &tracing, &mut |shutter, scene, samples| {
        Some(shutter.trace(scene, 0..pixels, samples))
    })?;
    record.truth = traced.as_ref().map(|traced| summary(&traced.report));
    Ok(traced)
}

/// The phase function of a frame's water in its truth.
pub(crate) fn law(context: &FrameContext<'_>) -> PhaseModel {
    let optics = context.frame.water.optics.as_ref();
    let phase = optics.map(|optics| optics.phase).unwrap_or_default();
    PhaseModel::of_water(phase, context.setting.water.as_ref())
}

/// Traces a frame round by round. Returns `None` if the scene has no range or the first round was not traced.
pub(crate) fn trace(
    context: &FrameContext<'_>,
    light: &Light,
    tracing: &Tracing,
    round: Round<'_>,
) -> Result<Option<Traced>, RenderError> {
    let (frame, prepared) = (context.frame, context.prepared);
    let range = prepared.scene.range.as_ref();
    let Some((range, solids)) = range.zip(rays::scene_rays(frame, prepared)) else {
        return Ok(None);
    };
    let subject = Subject {
        frame,
        setting: &context.setting,
        radiance: &prepared.scene.radiance,
        range,
        ground: prepared.world.as_ref().map(|world| world.ground_reflectance()),
    };
    let scene = TracedScene::of_frame(&subject, &*solids, tracing.law.phase())?;
    let shutter = PathBatch {
        camera: context.setting.eye.camera,
        width: context.setting.size.0,
        frame: frame.index,
        stream: truth::stream(tracing.seed),
    };
    let truth = converge(context.setting.size, &tracing.goal, |samples| {
        round(&shutter, &scene, &samples)
    });
    let Some(truth) = truth else { return Ok(None) };
    let asked = ReportRequest {
        goal: tracing.goal,
        law: tracing.law,
        rays: match rays::source(frame, prepared) {
            RaySource::Scene => "scene",
            RaySource::Screen => "screen",
        },
        has_sea: scene.sea.is_some(),
        limit: tracing.limit,
    };
    let has_sea = asked.has_sea;
    let scattered = scattered(light, has_sea);
    let light = ChainLight {
        direct: &light.layers.direct,
        scattered: &scattered,
    };
    let report = TruthReport::new(&truth, &asked, &light, Some(range));
    Ok(Some(Traced {
        truth,
        report,
        has_sea,
    }))
}

/// The cost of the truth; `None` if no artifact needs it.
pub(crate) fn assess(context: &FrameContext<'_>) -> Option<Stage> {
    let has_range = context.prepared.scene.range.is_some();
    let most = most_paths(context)
        .ok()
        .filter(|_| has_range && context.frame.is_traced())?;
    Some(Stage {
        bound: None,
        cost_ms: Some(1e3 * seconds(pixels(context), most.paths)),
        note: Some(format!(
            "never chosen by a plan: an artifact asks for it; at most {} paths of each pixel and channel",
            most.paths
        )),
        ..Stage::new(StageId::Truth, Variant::Fast("monte_carlo"))
    })
}

/// A limit on the number of paths, and the field that sets it.
struct Most {
    paths: u64,
    limit: &'static str,
}

fn most_paths(context: &FrameContext<'_>) -> Result<Most, TooMuch> {
    let asked = context.frame.truth.unwrap_or_default();
    let (paths, by_budget) = asked.most_paths(pixels(context))?;
    let limit = if by_budget { "budget_s" } else { "paths_max" };
    Ok(Most { paths, limit })
}

fn pixels(context: &FrameContext<'_>) -> u64 {
    let (width, height) = context.setting.size;
    width as u64 * height as u64
}

/// The scattered light of the chain: of surfaces and lamps, and the veil if daylight is traced.
pub(crate) fn scattered(light: &Light, has_sea: bool) -> Rgb<f32> {
    let Light { layers, airlight, .. } = light;
    let added = if has_sea {
        Some(&layers.backscatter)
    } else {
        airlight.as_ref()
    };
    let Some(added) = added else {
        return layers.forward_scatter.clone();
    };
    let sample = |layer: &Rgb<f32>, i: usize, x, y| layer.planes()[i].pixel(x, y);
    Rgb::from_fn(added.width(), added.height(), |x, y| {
        [0, 1, 2].map(|i| sample(&layers.forward_scatter, i, x, y) + sample(added, i, x, y))
    })
}

fn summary(report: &TruthReport) -> TruthRecord {
    TruthRecord {
        paths: report.paths,
        ended_by: report.ended_by.to_owned(),
        cut: report.cut,
        median_error: report.block_error.map(|spread| spread.median),
        error_95: report.block_error.map(|spread| spread.percentile_95),
    }
}
