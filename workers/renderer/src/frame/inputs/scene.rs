//! The scene of a frame: rendered from a seed, uploaded, or read from local files.

use std::collections::BTreeMap;
use std::convert::Infallible;
use std::sync::Arc;

use camera::PartsError;
use camera::geometry::SourcePicture;
use imaging::Rgb8;
use imaging::codec::{self, Radiance};
use imaging::geometry::Intrinsics;
use optics::daylight::Bottom;
use optics::range::is_hole;
use optics::setting::View;
use scenes::uploaded;
use scenes::{CameraPath, CameraPose, LEAST_CLEARANCE_M, Labels, SceneError, World};
use serde_json::json;
use spec::{Classes, Frame, RangeKind, Scene, SceneFiles, SceneLighting};

use crate::error::RenderError;
use crate::source::{SceneBytes, SceneSource};

/// A validated scene.
pub(crate) struct Prepared {
    /// Radiance is finite and not negative.
    pub(crate) scene: scenes::Scene,
    /// The 8-bit codes that all of its radiance was decoded from; `None` if they are not known.
    pub(crate) codes: Option<Rgb8>,
    /// Focal length of the scene's camera if it has one, otherwise of the frame's camera, px.
    pub(crate) focal_px: f64,
    /// Horizontal field of view as it was given, degrees; `None` if the focal length was given.
    pub(crate) hfov_deg: Option<f64>,
    /// Samples of negative radiance that were set to 0.
    pub(crate) negative_radiance: u64,
    /// Pixels without a valid range; 0 without range.
    pub(crate) holes: u64,
    /// Pose of the camera, for procedural scenes and uploaded scenes with a pose.
    pub(crate) pose: Option<CameraPose>,
    /// The world of a procedural scene.
    pub(crate) world: Option<Arc<World>>,
    /// Its labels, if an artifact needs them.
    pub(crate) labels: Option<Labels>,
    /// Meanings of the label codes; fixed for procedural scenes.
    pub(crate) classes: Option<Classes>,
    /// SHA-256 of the input files.
    pub(crate) inputs: BTreeMap<String, String>,
}

impl Prepared {
    /// The view for resolving the setting.
    pub(crate) fn view(&self) -> View {
        let (width, height) = self.scene.radiance.size();
        View {
            size: (width, height),
            camera: self
                .scene
                .intrinsics
                .unwrap_or_else(|| Intrinsics::centered(self.focal_px, width, height)),
            world_from_camera: self.pose.map(|pose| pose.world_from_camera()),
            has_range: self.scene.range.is_some(),
            bottom: self.bottom(),
        }
    }

    /// The ground below the camera of a procedural scene.
    fn bottom(&self) -> Option<Bottom> {
        let below_m = self.pose?.world_from_camera()[2][3];
        let reflectance = self.world.as_ref()?.ground_reflectance();
        (below_m > 0.0).then_some(Bottom { below_m, reflectance })
    }
}

/// Prepares the scene of a frame. `view` overrides the frame's view when a procedural scene is rendered.
pub(crate) fn prepare(
    frame: &Frame,
    source: &SceneSource,
    view: Option<SourcePicture>,
) -> Result<Prepared, RenderError> {
    match (&frame.scene, source) {
        (Scene::Procedural { .. }, _) => Place::read(frame)?.prepare(frame, view, 0.0),
        (Scene::Uploaded { .. } | Scene::Collection { .. }, SceneSource::Uploaded(files)) => {
            from_files(frame, files)
        }
        (scene @ (Scene::Uploaded { .. } | Scene::Collection { .. }), SceneSource::Local) => {
            let id = scene.uploaded_id().unwrap_or_default().to_owned();
            Err(RenderError::NotHere { id })
        }
        (Scene::Files { .. }, _) => {
            let files = read(&frame.scene)?;
            let prepared = from_files(frame, &files)?;
            uploaded::check_objects(&prepared.scene, files.classes.as_ref())?;
            Ok(prepared)
        }
    }
}

/// Prepares a decoded picture in place of the frame's files.
pub(crate) fn prepare_picture(
    frame: &Frame,
    scene: scenes::Scene,
    pose: Option<CameraPose>,
) -> Result<Prepared, RenderError> {
    uploaded::check_objects(&scene, None)?;
    let hfov_deg = scene.intrinsics.is_none().then_some(frame.camera.hfov_deg);
    let prepared = Prepared {
        pose,
        hfov_deg,
        ..checked(frame, scene, BTreeMap::new())?
    };
    Ok(label(frame, prepared, None))
}

/// Whether an artifact of the frame is made of labels.
pub(crate) fn needs_labels(frame: &Frame) -> bool {
    frame.artifacts.iter().any(spec::ArtifactKind::needs_labels)
}

/// A procedural world and the camera path in it.
pub(crate) struct Place {
    pub(crate) world: Arc<World>,
    path: Option<(CameraPath, usize)>,
}

impl Place {
    /// The world of a frame with a procedural scene.
    pub(crate) fn read(frame: &Frame) -> Result<Self, RenderError> {
        match &frame.scene {
            Scene::Procedural {
                family,
                seed,
                life,
                ground,
                ..
            } => Self::new(
                frame,
                World::filled(family, *seed, life.as_ref(), ground.as_ref())?,
            ),
            _ => Err(RenderError::Camera(PartsError::NoPath)),
        }
    }

    fn new(frame: &Frame, mut world: World) -> Result<Self, RenderError> {
        if let Some(view) = &frame.camera.view {
            world.set_view(view)?;
        }
        if let Some(depth_m) = frame.water.depth_m {
            world.raise_piles(highest_camera(frame, &world) + depth_m);
        }
        Self::with_world(frame, Arc::new(world))
    }

    /// The path of a frame in its world.
    pub(crate) fn with_world(frame: &Frame, world: Arc<World>) -> Result<Self, RenderError> {
        let Some(path) = frame.camera.path else {
            return Ok(Self { world, path: None });
        };
        let places = world.path(&path, frame.seed).map_err(RenderError::Path)?;
        world.check(&places)?;
        Ok(Self {
            world,
            path: Some((places, path.frame)),
        })
    }

    /// The pose `later` frames after the time of the frame: that of its path, or the scene's default pose. A right camera must
    /// stay clear of surfaces.
    pub(crate) fn pose_at(&self, frame: &Frame, later: f64) -> Result<CameraPose, RenderError> {
        let pose = match &self.path {
            Some((places, at)) => places.pose_at(*at as f64 + later),
            None => self.world.pose(),
        };
        if frame.right_m == 0.0 {
            return Ok(pose);
        }
        let right = pose.moved_right(frame.right_m);
        let clearance_m = self.world.clearance(right.position_m);
        if clearance_m < LEAST_CLEARANCE_M {
            return Err(RenderError::Scene(SceneError::View {
                field: "stereo.baseline_m",
                value: frame.right_m,
                clearance_m,
            }));
        }
        Ok(right)
    }

    /// The scene at that pose.
    pub(crate) fn prepare(
        &self,
        frame: &Frame,
        view: Option<SourcePicture>,
        later: f64,
    ) -> Result<Prepared, RenderError> {
        let pose = self.pose_at(frame, later)?;
        let (width, height) = (frame.camera.width, frame.camera.height);
        let SourcePicture { size, camera } = view.unwrap_or_else(|| SourcePicture {
            size: (width, height),
            camera: Intrinsics::centered(frame.camera.focal_px(width), width, height),
        });
        let (scene, labels) = if frame.scene.lighting() == SceneLighting::Water {
            let labeled = needs_labels(frame);
            self.world.render_reflectance(&pose, size, &camera, labeled)
        } else if needs_labels(frame) {
            let (scene, labels) = self.world.render_labeled(&pose, size, &camera);
            (scene, Some(labels))
        } else {
            (self.world.render(&pose, size, &camera), None)
        };
        let prepared = checked(frame, scene, BTreeMap::new())?;
        Ok(Prepared {
            pose: Some(pose),
            world: Some(Arc::clone(&self.world)),
            labels,
            ..prepared
        })
    }
}

/// Height of the camera of a frame, or of the higher end of its path, m.
fn highest_camera(frame: &Frame, world: &World) -> f64 {
    let path = frame.camera.path.and_then(|path| path.start.zip(path.end));
    match path {
        Some((start, end)) => start.position_m[2].max(end.position_m[2]),
        None => world.pose().position_m.z,
    }
}

fn from_files(frame: &Frame, files: &SceneBytes) -> Result<Prepared, RenderError> {
    let pose = files.world_from_camera.as_ref().map(CameraPose::from_matrix);
    let prepared = Prepared {
        pose: pose.transpose().map_err(SceneError::Pose)?,
        hfov_deg: match files.intrinsics {
            Some(_) => files.hfov_deg,
            None => Some(frame.camera.hfov_deg),
        },
        ..decoded(frame, files)?
    };
    Ok(label(frame, prepared, files.classes.as_ref()))
}

/// Adds the labels of a mask if an artifact needs them.
fn label(frame: &Frame, prepared: Prepared, classes: Option<&Classes>) -> Prepared {
    let mask = prepared.scene.instances.as_ref().filter(|_| needs_labels(frame));
    let Some(mask) = mask else {
        return prepared;
    };
    let classes = classes.cloned().unwrap_or_default();
    Prepared {
        labels: Some(Labels::uploaded(mask, &classes)),
        classes: Some(classes),
        ..prepared
    }
}

fn decoded(frame: &Frame, files: &SceneBytes) -> Result<Prepared, RenderError> {
    let mut digests: BTreeMap<String, String> = files
        .named()
        .map(|(name, bytes)| (format!("scene.{name}"), spec::sha256(bytes)))
        .collect();
    if let Some(classes) = &files.classes {
        digests.insert(
            "scene.classes".to_owned(),
            spec::sha256(json!(classes).to_string()),
        );
    }
    if let Some(pose) = &files.world_from_camera {
        digests.insert("scene.pose".to_owned(), spec::sha256(json!(pose).to_string()));
    }
    let is_z_depth = files
        .range
        .as_ref()
        .is_some_and(|range| range.kind == RangeKind::ZDepth);
    if files.intrinsics.is_some() || !is_z_depth {
        return checked(frame, uploaded::decode(files)?, digests);
    }
    // Only z-depth is converted with the camera; to know the camera, the size must be known first.
    let intrinsics = Some(camera_of(frame, &files.rgb)?);
    let Ok(files) = files.try_map(|bytes| Ok::<_, Infallible>(bytes.as_slice()));
    let files = SceneFiles { intrinsics, ..files };
    checked(frame, uploaded::decode(&files)?, digests)
}

fn checked(
    frame: &Frame,
    mut scene: scenes::Scene,
    inputs: BTreeMap<String, String>,
) -> Result<Prepared, RenderError> {
    if faults::frame_point("scene.nan", frame.index) {
        scene.radiance.planes_mut()[0][0] = f32::NAN;
    }
    let negative_radiance = optics::chain::check_radiance(&mut scene.radiance)?;
    let holes = scene
        .range
        .as_ref()
        .map_or(0, |range| range.data().iter().filter(|&&z| is_hole(z)).count());
    let focal_px = match scene.intrinsics {
        Some(camera) => camera.focal_px,
        None => frame.camera.focal_px(scene.radiance.width()),
    };
    Ok(Prepared {
        scene,
        codes: None,
        focal_px,
        hfov_deg: None,
        negative_radiance,
        holes: holes as u64,
        pose: None,
        world: None,
        labels: None,
        classes: None,
        inputs,
    })
}

fn camera_of(frame: &Frame, rgb: &[u8]) -> Result<Intrinsics, RenderError> {
    let decoded = codec::decode_radiance(rgb).map_err(|reason| SceneError::File { field: "rgb", reason })?;
    let (width, height) = match &decoded {
        Radiance::Encoded(raster) => (raster.width(), raster.height()),
        Radiance::Linear(radiance) => radiance.size(),
    };
    Ok(Intrinsics::centered(frame.camera.focal_px(width), width, height))
}

fn read(scene: &Scene) -> Result<SceneBytes, RenderError> {
    let paths = scene
        .files()
        .ok_or_else(|| RenderError::NotHere { id: String::new() })?;
    let open = |path: &str| {
        std::fs::read(path).map_err(|source| RenderError::File {
            path: path.to_owned(),
            source,
        })
    };
    let mut files = paths.try_map(|path| open(path))?;
    if let Scene::Files {
        classes: Some(path), ..
    } = scene
    {
        let classes = scenes::classes::read(&open(path)?);
        files.classes = Some(classes.map_err(|wrong| SceneError::Objects {
            field: "classes",
            reason: wrong.to_string(),
        })?);
    }
    Ok(files)
}
