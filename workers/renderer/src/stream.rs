//! Frames of a running camera: arrays in, arrays out, and nothing is stored.

mod check;
mod deadline;
mod decode;
mod description;
mod error;
mod input;
mod output;

use std::sync::Arc;
use std::time::Instant;

use imaging::geometry::Intrinsics;
use spec::{ArtifactKind, Fidelity, FieldError, Frame, Invalid, Job};

use crate::engine::Engine;
use crate::error::RenderError;
use crate::inputs::scene::{Prepared, prepare_picture};
use crate::slot::{PlannedContents, Slot};
use crate::stopwatch::Stopwatch;
use check::{Checked, check_input};
use deadline::{Calibration, CalibrationPicture, CostModel, FRAMES, LEAST_MS, PlannedFrame};
use decode::{Decoder, read_codes};

pub use description::{StreamJob, StreamParts};
pub use error::{InputError, StreamError};
pub use input::{
    ChannelOrder, DepthSamples, PictureSamples, StreamDepth, StreamInput, StreamMask, StreamOptions,
    StreamPicture, Vary,
};
pub use output::StreamFrame;

/// Nanoseconds of a second.
const NS_PER_S: f64 = 1e9;

/// A job over the pictures of a camera. Kernels, style networks, camera maps and buffers persist between frames.
///
/// A frame is a function of the job, its input and its stamp: the random numbers of its stages belong to (job seed, stamp).
/// All frames share one world of particles and patches. With a pose they stay at their places in the world, without one
/// they move with the camera.
pub struct Stream {
    job: Job,
    options: StreamOptions,
    /// The frame whose values all frames have with [`Vary::Stream`].
    fixed: Frame,
    /// Whether the job gives a field of view, which the cameras of frames must not contradict.
    gives_hfov: bool,
    warnings: Vec<String>,
    /// `None` without a deadline.
    costs: Option<CostModel>,
    slot: Slot,
    decoder: Decoder,
    frames: u64,
}

impl Stream {
    /// Opens a stream. The pictures of the stream replace the scene of the job, which is therefore optional.
    ///
    /// # Errors
    /// All errors of the description.
    pub fn open(text: &[u8], options: StreamOptions, engine: &Arc<Engine>) -> Result<Self, Invalid> {
        let vocabulary = crate::vocabulary::vocabulary(&engine.library(), true);
        let parts = StreamParts {
            has_metrics: options.has_metrics,
            has_instances: false,
        };
        Self::with_job(StreamJob::read(text, parts, &vocabulary)?, options, engine)
    }

    /// Opens a stream of a checked job.
    ///
    /// # Errors
    /// The job has no frame, or the deadline contradicts it.
    pub fn with_job(job: StreamJob, options: StreamOptions, engine: &Arc<Engine>) -> Result<Self, Invalid> {
        let StreamJob {
            job,
            warnings,
            gives_hfov,
        } = job;
        let mut stream = Self {
            fixed: job.resolve_any(0)?,
            job,
            options,
            gives_hfov,
            warnings,
            costs: None,
            slot: Slot::new(engine),
            decoder: Decoder::default(),
            frames: 0,
        };
        if let Some(deadline_ms) = options.deadline_ms {
            check_deadline(deadline_ms, stream.fixed.fidelity)?;
            let costs = stream.calibrate(deadline_ms);
            stream.slot.set_costs(costs.scale().clone());
            stream.costs = Some(costs);
            if stream.options.vary == Vary::Stream {
                stream.slot.keep_effects();
            }
        }
        Ok(stream)
    }

    /// Calibrates the cost model of the job on this machine, first with the cheapest plan, then with all effects. If the pictures
    /// cannot be rendered, the costs of plans are used unchanged.
    fn calibrate(&mut self, deadline_ms: f64) -> CostModel {
        let picture = CalibrationPicture::new();
        let calibration = Calibration {
            cheap: self.render_calibration(&picture, Fidelity::BudgetMs(LEAST_MS)),
            full: self.render_calibration(&picture, Fidelity::Picture),
        };
        if calibration.cheap.is_empty() {
            let uncalibrated =
                "no frame could be timed for the deadline: expected costs are those of a usual machine";
            self.warnings.push(uncalibrated.to_owned());
        }
        self.frames = 0;
        CostModel::new(deadline_ms, &calibration)
    }

    /// The frames after the first, up to one that fails.
    fn render_calibration(&mut self, picture: &CalibrationPicture, fidelity: Fidelity) -> Vec<PlannedFrame> {
        let described = std::mem::replace(&mut self.fixed.fidelity, fidelity);
        let vary = std::mem::replace(&mut self.options.vary, Vary::Stream);
        if vary == Vary::Stream {
            self.slot.keep_effects();
        }
        let all = (0..FRAMES).map_while(|stamp_ns| self.render_planned(&picture.input(stamp_ns)).ok());
        let frames = all.skip(1).collect();
        self.fixed.fidelity = described;
        self.options.vary = vary;
        self.slot.choose_each_time();
        frames
    }

    /// Warnings about the job.
    #[must_use]
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Rendered frames so far: the stamp of the next frame if its input has none.
    #[must_use]
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// Renders a frame. After an error the stream continues with the next frame.
    ///
    /// # Errors
    /// [`StreamError::Input`] lists the errors of the input; [`StreamError::Render`] otherwise.
    pub fn render(&mut self, input: &StreamInput<'_>) -> Result<StreamFrame, StreamError> {
        Ok(self.render_planned(input)?.frame)
    }

    fn render_planned(&mut self, input: &StreamInput<'_>) -> Result<PlannedFrame, StreamError> {
        let begun = Instant::now();
        let mut watch = Stopwatch::start();
        let checked = check_input(input, self.gives_hfov, &self.fixed.camera).map_err(StreamError::Input)?;
        let frame = self.describe_frame(input, &checked)?;
        let decoded = watch.time("scene", || {
            let (width, height) = input.picture.size;
            let described = Intrinsics::centered(frame.camera.focal_px(width), width, height);
            self.decoder.decode(input, &checked.camera.unwrap_or(described))
        });
        let mut scene = decoded.map_err(|error| StreamError::Input(vec![error]))?;
        scene.intrinsics = checked.camera;
        let prepared = watch.time("scene", || prepare_picture(&frame, scene, checked.pose))?;
        let prepared = Prepared {
            codes: read_codes(&input.picture),
            ..prepared
        };
        let PlannedContents { contents, costs } = self
            .slot
            .guard(&frame, |slot| slot.contents_of(&frame, &prepared, watch))?;
        self.decoder.recycle(prepared.scene);
        self.frames += 1;
        let mut record = contents.record;
        if let Some(model) = &self.costs {
            model.correct_warnings(&mut record, &costs, input.picture.size);
        }
        let frame = StreamFrame {
            artifacts: contents.artifacts,
            record,
            elapsed_ms: begun.elapsed().as_secs_f64() * 1e3,
        };
        Ok(PlannedFrame { frame, costs })
    }

    /// The frame of an input: its distributions, stamp and artifacts.
    fn describe_frame(&self, input: &StreamInput<'_>, checked: &Checked) -> Result<Frame, RenderError> {
        let stamp_ns = input.stamp_ns.unwrap_or(self.frames);
        let mut frame = match self.options.vary {
            Vary::Stream => self.fixed.clone(),
            Vary::Frame => self.job.resolve_any(stamp_ns).map_err(RenderError::Resolve)?,
        };
        frame.index = stamp_ns;
        frame.stream_s = Some(stamp_ns as f64 / NS_PER_S);
        if let Some(pose) = &checked.pose {
            // The axes of the world in those of the camera; z is up.
            let up = frame
                .camera
                .up
                .unwrap_or([pose.right.z, pose.down.z, pose.ahead.z]);
            frame.camera.up = Some(up);
        }
        if let Some(costs) = &self.costs {
            frame.fidelity = Fidelity::BudgetMs(costs.budget_ms(input.picture.size));
        }
        list_artifacts(&mut frame, input.depth.is_some());
        Ok(frame)
    }
}

/// Rejects a deadline that is not positive and finite, or whose job chooses the accuracy.
fn check_deadline(deadline_ms: f64, fidelity: Fidelity) -> Result<(), Invalid> {
    let mut errors = Vec::new();
    if !(deadline_ms.is_finite() && deadline_ms > 0.0) {
        let message = format!("`deadline_ms` is {deadline_ms}; must be above 0 and finite");
        errors.push(FieldError::new("", message));
    }
    if fidelity != Fidelity::Picture {
        let message =
            "`fidelity` is given, but `deadline_ms` of the stream chooses the accuracy; remove one of them";
        errors.push(FieldError::new("/fidelity", message));
    }
    if errors.is_empty() {
        Ok(())
    } else {
        Err(Invalid(errors))
    }
}

/// Adds the artifacts that every frame of a stream has.
fn list_artifacts(frame: &mut Frame, has_range: bool) {
    let mut added = vec![ArtifactKind::Rgb];
    added.extend(has_range.then_some(ArtifactKind::Range));
    let enhancements = frame.enhance.iter();
    added.extend(enhancements.map(|enhancement| ArtifactKind::Enhanced(enhancement.name.clone())));
    for kind in added {
        if !frame.artifacts.contains(&kind) {
            frame.artifacts.push(kind);
        }
    }
}
