//! Renders frames with each choice, small against the truth and at full size against the clock.

use std::collections::BTreeSet;
use std::sync::Arc;

use cli::exit::Failure;
use cli::progress::Progress;
use optics::plan::Plan;
use rayon::prelude::*;
use renderer::{ComparableFrame, Engine, FrameTruth, SceneSource, Slot};
use spec::{Fidelity, Frame};

use super::choices::{Choices, list_running};
use super::clock::ThreadClock;
use super::point::{Distance, FramePoint, Point};
use super::size::PictureSize;
use super::variant::{Variant, list_fidelities};

/// Error of the median block of the truth, relative to the mean light.
const TARGET: f64 = 0.02;
/// Limit on the paths of a pixel. 2 % usually need fewer; rare bright light would need many times as many.
const MOST_PATHS: u64 = 1024;
/// Paths of the first round; rounds double them.
const FIRST_PATHS: u64 = 16;
/// Pixels that a thread traces at a time.
const CHUNK: usize = 64;
/// Columns of the small pictures unless given.
const COLUMNS: usize = 64;
/// Frames that take longer than this are timed at the small size.
const SLOW_MS: f64 = 10_000.0;
/// Frames that take less are rendered twice, and the shorter time counts: other programs only add to it.
const QUICK_MS: f64 = 1500.0;

/// The measured choices of a job.
pub(super) struct Measured {
    /// Indices of the frames.
    pub(super) frames: Vec<u64>,
    /// Size of the pictures compared with the truth.
    pub(super) size: PictureSize,
    /// Size of the timed pictures.
    pub(super) timed_size: PictureSize,
    /// Whether frames at full size took too long.
    pub(super) is_timed_small: bool,
    pub(super) truths: Vec<FrameTruth>,
    /// Fields on neither side of the comparison.
    pub(super) left_out: Vec<String>,
    /// Light that only one side has.
    pub(super) differences: Vec<&'static str>,
    /// The choices; that of the job is the first.
    pub(super) points: Vec<Point>,
}

/// A frame at full size and its comparable form.
struct Pair {
    full: Frame,
    small: Frame,
    comparable: ComparableFrame,
}

/// The inputs of a measurement.
pub(super) struct Measuring {
    slot: Slot,
    pairs: Vec<Pair>,
    size: PictureSize,
}

/// The plan of a frame, and its time if it was rendered.
struct TimedPlan {
    plan: Plan,
    ms: Option<f64>,
}

impl Measuring {
    /// Prepares frames of a job for pictures of this size.
    pub(super) fn new(
        engine: &Arc<Engine>,
        frames: &[Frame],
        size: Option<PictureSize>,
    ) -> Result<Self, Failure> {
        let size = size.unwrap_or_else(|| shrink(&frames[0]));
        let pairs = frames.iter().map(|frame| {
            let mut full = frame.clone();
            full.artifacts.retain(|kind| !kind.is_traced());
            let mut small = full.clone();
            (small.camera.width, small.camera.height) = (size.width, size.height);
            let comparable =
                ComparableFrame::new(frame, (size.width, size.height)).map_err(Failure::input)?;
            Ok(Pair {
                full,
                small,
                comparable,
            })
        });
        Ok(Self {
            slot: Slot::new(engine),
            pairs: pairs.collect::<Result<_, Failure>>()?,
            size,
        })
    }

    /// Traces the truth of each frame, then renders every choice.
    pub(super) fn run(mut self) -> Result<Measured, Failure> {
        let described = Variant {
            is_described: true,
            ..Variant::plain(self.pairs[0].full.fidelity)
        };
        // It also fills the caches.
        let is_timed_small = self.time(&described, 0, false)?.ms > Some(SLOW_MS);
        let variants = self.list_variants(described)?;
        let trace_steps = MOST_PATHS / FIRST_PATHS;
        let steps = self.pairs.len() as u64 * (trace_steps + variants.len() as u64);
        let mut progress = Progress::new("tradeoff", "steps", steps);
        let mut truths = Vec::new();
        for index in 0..self.pairs.len() {
            truths.push(self.trace(index, &mut progress, index as u64 * trace_steps)?);
        }
        let mut points: Vec<Point> = Vec::new();
        let mut known: Vec<Vec<Choices>> = Vec::new();
        let mut done = self.pairs.len() as u64 * trace_steps;
        for variant in variants {
            let (point, choices) = self.measure(&variant, is_timed_small, &truths)?;
            done += self.pairs.len() as u64;
            progress.set(done);
            match known.iter().position(|other| *other == choices) {
                Some(same) => points[same].same_as.push(variant),
                None => {
                    known.push(choices);
                    points.push(point);
                }
            }
        }
        progress.finish();
        Ok(self.finish(points, truths, is_timed_small))
    }

    fn finish(self, points: Vec<Point>, truths: Vec<FrameTruth>, is_timed_small: bool) -> Measured {
        let mut left_out: Vec<String> = Vec::new();
        for field in self.pairs.iter().flat_map(|pair| &pair.comparable.left_out) {
            if !left_out.contains(field) {
                left_out.push(field.clone());
            }
        }
        let differences: BTreeSet<&str> = truths
            .iter()
            .flat_map(|truth| truth.differences.clone())
            .collect();
        let camera = &self.pairs[0].full.camera;
        let full_size = PictureSize {
            width: camera.width,
            height: camera.height,
        };
        Measured {
            frames: self.pairs.iter().map(|pair| pair.full.index).collect(),
            size: self.size,
            timed_size: if is_timed_small { self.size } else { full_size },
            is_timed_small,
            truths,
            left_out,
            differences: differences.into_iter().collect(),
            points,
        }
    }

    /// The fidelity of the job, the others, and the job without each of its effects.
    fn list_variants(&mut self, described: Variant) -> Result<Vec<Variant>, Failure> {
        let mut planned_ms = None;
        let mut effects = BTreeSet::new();
        for pair in &self.pairs {
            let plan = self.slot.plan(&pair.full, &SceneSource::Local);
            effects.extend(list_running(&plan.map_err(Failure::input)?));
            let picture = with_fidelity(&pair.full, Fidelity::Picture);
            let plan = self
                .slot
                .plan(&picture, &SceneSource::Local)
                .map_err(Failure::input)?;
            planned_ms = plan.cost_ms().into_iter().chain(planned_ms).reduce(f64::max);
        }
        let mut variants = vec![described.clone()];
        variants.extend(list_fidelities(described.fidelity, planned_ms));
        variants.extend(effects.into_iter().map(|id| Variant {
            without: Some(id),
            is_described: false,
            ..described.clone()
        }));
        Ok(variants)
    }

    /// Traces a frame on all cores.
    fn trace(&mut self, index: usize, progress: &mut Progress, done: u64) -> Result<FrameTruth, Failure> {
        let comparable = &self.pairs[index].comparable;
        let pixels = self.size.width * self.size.height;
        let traced = self
            .slot
            .trace_truth(comparable, TARGET, MOST_PATHS, &mut |batch, scene, samples| {
                let chunks: Vec<usize> = (0..pixels).step_by(CHUNK).collect();
                let sums = chunks
                    .into_par_iter()
                    .flat_map_iter(|start| batch.trace(scene, start..(start + CHUNK).min(pixels), samples));
                let sums = sums.collect();
                progress.set(done + samples.end / FIRST_PATHS);
                Some(sums)
            });
        let traced = traced.map_err(Failure::input)?;
        traced.ok_or_else(|| anyhow::anyhow!("the truth has no first round").into())
    }

    /// Renders all frames with a choice.
    fn measure(
        &mut self,
        variant: &Variant,
        is_timed_small: bool,
        truths: &[FrameTruth],
    ) -> Result<(Point, Vec<Choices>), Failure> {
        let mut frames = Vec::new();
        let mut all_choices = Vec::new();
        for (index, truth) in truths.iter().enumerate() {
            let is_reference = variant.fidelity == Fidelity::Reference;
            let timed = match is_reference {
                true => self.plan_small(variant, index)?,
                false => self.time(variant, index, is_timed_small)?,
            };
            let choices = Choices::of_plan(variant, &timed.plan);
            self.slot.exclude(choices.left_out.clone());
            let comparable = &self.pairs[index].comparable;
            let comparable = ComparableFrame {
                frame: with_fidelity(&comparable.frame, choices.fidelity),
                left_out: Vec::new(),
            };
            let distance = self
                .slot
                .measure_distance(&comparable, truth)
                .map_err(Failure::input)?;
            frames.push(FramePoint {
                frame: self.pairs[index].full.index,
                ms: timed.ms,
                planned_ms: timed.plan.cost_ms().filter(|_| !is_timed_small),
                tolerance: timed.plan.tolerance.map(|tolerance| tolerance.absolute),
                effects: list_running(&timed.plan),
                distance: Distance {
                    bias: distance.bias,
                    rms: distance.rms,
                    codes: distance.codes,
                },
            });
            all_choices.push(choices);
        }
        self.slot.exclude(Vec::new());
        Ok((Point::new(variant.clone(), frames), all_choices))
    }

    /// Renders a frame with a choice. Its time is that of the shorter of two runs, unless it is slow.
    fn time(&mut self, variant: &Variant, index: usize, is_small: bool) -> Result<TimedPlan, Failure> {
        let pair = &self.pairs[index];
        let frame = with_fidelity(if is_small { &pair.small } else { &pair.full }, variant.fidelity);
        self.slot.exclude(variant.without.into_iter().collect());
        let timed = self.time_once(&frame)?;
        if timed.ms > Some(QUICK_MS) {
            return Ok(timed);
        }
        let again = self.time_once(&frame)?;
        Ok(if again.ms < timed.ms { again } else { timed })
    }

    /// The plan of a small frame: the reference at full size would take minutes.
    fn plan_small(&mut self, variant: &Variant, index: usize) -> Result<TimedPlan, Failure> {
        let frame = with_fidelity(&self.pairs[index].small, variant.fidelity);
        self.slot.exclude(Vec::new());
        let plan = self
            .slot
            .plan(&frame, &SceneSource::Local)
            .map_err(Failure::input)?;
        Ok(TimedPlan { plan, ms: None })
    }

    fn time_once(&mut self, frame: &Frame) -> Result<TimedPlan, Failure> {
        let clock = ThreadClock::start();
        let plan = self.slot.render_for_plan(frame, &SceneSource::Local);
        let ms = clock.ms();
        Ok(TimedPlan {
            plan: plan.map_err(Failure::input)?,
            ms: Some(ms),
        })
    }
}

fn with_fidelity(frame: &Frame, fidelity: Fidelity) -> Frame {
    Frame {
        fidelity,
        ..frame.clone()
    }
}

/// The usual small size in the shape of a frame.
fn shrink(frame: &Frame) -> PictureSize {
    let (width, height) = (frame.camera.width, frame.camera.height);
    let columns = COLUMNS.min(width);
    PictureSize {
        width: columns,
        height: (columns * height).div_ceil(width).clamp(1, height),
    }
}
