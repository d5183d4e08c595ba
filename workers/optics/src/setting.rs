//! Resolved environment of a frame: water, lamps, patches and snow in front of its camera, with all numbers known and no light
//! computed yet.

use imaging::geometry::Intrinsics;
use imaging::vector::dot;
use spec::{Beyond, Frame, Scene, SceneLighting, Snow};

use crate::daylight::Bottom;
use crate::daylight::{DaylightEffect, Gaze, SurfaceLight};
use crate::eye::Eye;
use crate::lamp::{GlowPhase, LAMP_RADIUS_M, Lamp, Lighting, Shadow};
use crate::medium::{Medium, Surroundings};
use crate::plan::StageId;
use crate::sediment::Clouds;
use crate::snow::{self, World};
use crate::turbidity::Field;
use crate::water::{Water, WaterError};

/// Properties of a scene that its environment depends on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// Columns and rows.
    pub size: (usize, usize),
    /// The camera.
    pub camera: Intrinsics,
    /// Rows of the matrix from camera axes to the world; `None` for a scene without pose, whose camera is at the origin.
    pub world_from_camera: Option<[[f64; 4]; 4]>,
    /// Whether the scene has a range; otherwise water is not rendered.
    pub has_range: bool,
    /// The bottom below the camera, where it is known.
    pub bottom: Option<Bottom>,
}

/// The surroundings of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    /// Columns and rows.
    pub size: (usize, usize),
    /// The camera and its pose.
    pub eye: Eye,
    /// Against gravity in its axes.
    pub up: [f64; 3],
    /// The water; `None` without optics or without range.
    pub water: Option<Water>,
    /// The water for a scene that is already lit: its ambient light is also applied to a scene with lamps.
    pub around: Option<Water>,
    /// Patches of turbidity in the axes of the world; `None` in even water.
    pub patches: Option<Field>,
    /// The lamps; `None` without lamps, or without range, since they need surfaces.
    pub lighting: Option<Lighting>,
    /// The snow; `None` without range, since its position would be undefined.
    pub snow: Option<Snow>,
    /// Which particles and patches of their seed.
    pub world: World,
    /// Clouds of sediment; `None` without range, since their position would be undefined.
    pub sediment: Option<Clouds>,
    /// Depth of the camera, m; `None` if it is not given.
    pub depth_m: Option<f64>,
}

/// Surroundings that cannot be.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SettingError {
    /// The water contradicts itself or lacks a number.
    #[error(transparent)]
    Water(WaterError),
    /// A number of lamps, snow or patches is beyond its limits.
    #[error("{field}: {beyond}")]
    Beyond {
        /// Its field in the description.
        field: &'static str,
        /// The number.
        beyond: Beyond,
    },
}

impl Setting {
    /// The surroundings of a frame whose scene is seen like this. Lamps, thrusters and the depth belong to the described camera,
    /// [`Frame::right_m`] to the left of this one.
    ///
    /// # Errors
    /// All errors of water, lamps, patches and snow together.
    pub fn resolve(frame: &Frame, view: &View) -> Result<Self, Vec<SettingError>> {
        let mut errors = Vec::new();
        let mut eye = Eye::at_origin(view.camera);
        eye.world_from_camera = view.world_from_camera.unwrap_or(eye.world_from_camera);
        let world = World {
            seed: frame.seed,
            index: frame.world_index(),
        };
        let named = |field: &'static str| move |beyond: Beyond| SettingError::Beyond { field, beyond };
        let lamps = Lamp::among(&frame.lights).unwrap_or_else(|beyond| {
            errors.extend(beyond.into_iter().map(named("lights")));
            Vec::new()
        });
        let lamps: Vec<Lamp> = lamps
            .into_iter()
            .map(|lamp| lamp.seen_from_right(frame.right_m))
            .collect();
        let rise_m = frame.right_m * eye.world_from_camera[2][0];
        let is_wet = view.has_range && frame.water.optics.is_some();
        let medium = Medium::choose(&frame.water, &Surroundings::of_frame(frame))
            .filter(|_| is_wet)
            .map(|medium| Medium {
                bottom: view.bottom,
                depth_m: medium.depth_m.map(|depth_m| (depth_m - rise_m).max(0.0)),
                ..medium
            });
        let resolve = if lamps.is_empty() {
            Water::resolve
        } else {
            Water::resolve_lit
        };
        let water = medium
            .as_ref()
            .map(|medium| resolve(medium, view.camera.focal_px));
        let water = water.and_then(|water| {
            let refused = |wrong: Vec<_>| errors.extend(wrong.into_iter().map(SettingError::Water));
            let water = water.map_err(refused).ok()?;
            let water = if frame.scene.lighting() == SceneLighting::Water {
                water.around_reflectance()
            } else {
                water
            };
            Some(match water.daylight() {
                Some(_) => water.seen_by(gaze_of(frame, view, &eye)),
                None => water,
            })
        });
        let patchy = frame
            .water
            .turbidity
            .filter(|patches| patches.contrast > 0.0 && is_wet);
        errors.extend(patchy.iter().flat_map(spec::beyond).map(named("turbidity")));
        let snow = frame.water.snow.filter(|_| view.has_range);
        errors.extend(snow.iter().flat_map(|snow| wrong(snow, view)).map(named("snow")));
        if !errors.is_empty() {
            return Err(errors);
        }
        let patches = patchy.map(|patches| Field::new(&patches, world));
        let sediment = frame.water.sediment.filter(|_| view.has_range);
        let knows_bottom = matches!(frame.scene, Scene::Procedural { .. });
        let up = up_of(frame, &eye);
        let shines = view.has_range && !lamps.is_empty();
        Ok(Self {
            size: view.size,
            lighting: shines.then(|| lighting(lamps, &eye, water.as_ref(), patches.as_ref())),
            around: water.as_ref().map(|water| {
                if shines || lights_surfaces(water) {
                    water.with_light_applied()
                } else {
                    water.clone()
                }
            }),
            sediment: sediment
                .map(|law| Clouds::new(&law, world, &eye, up, knows_bottom).seen_from_right(frame.right_m)),
            up,
            eye,
            water,
            patches,
            snow,
            world,
            depth_m: medium.and_then(|medium| medium.depth_m),
        })
    }

    /// Disables an effect of lamps, daylight or objects in front of others.
    pub fn leave_out(&mut self, effect: StageId) {
        if effect == StageId::Occlusion {
            let waters = [&mut self.water, &mut self.around].into_iter().flatten();
            waters.for_each(|water| *water = water.without_layers());
        }
        if effect == StageId::LampShadows {
            for lamp in self.lighting.iter_mut().flat_map(|lighting| &mut lighting.lamps) {
                *lamp = lamp.with_shadow(Shadow::None, false);
            }
        }
        let effect = match effect {
            StageId::SunShadow => DaylightEffect::SunShadow,
            StageId::AmbientAccess => DaylightEffect::AmbientOcclusion,
            StageId::Caustics => DaylightEffect::Caustics,
            StageId::Shafts => DaylightEffect::Shafts,
            StageId::VeilOcclusion => DaylightEffect::VeilOcclusion,
            _ => return,
        };
        for water in [&mut self.water, &mut self.around].into_iter().flatten() {
            if let Some(daylight) = &mut water.daylight {
                daylight.leave_out(effect);
            }
        }
    }

    /// Beam attenuation of the water, 1/m; 0 without.
    #[must_use]
    pub fn attenuation(&self) -> [f64; 3] {
        self.water.as_ref().map_or([0.0; 3], Water::direct_attenuation)
    }

    /// Factor of daylight at a point in camera axes relative to the camera: `e^{−K_d Δh}` for the additional depth, with points
    /// above the surface clamped to it; 1 by night and if the decay is unknown.
    #[must_use]
    pub fn daylight_at(&self, place: [f64; 3]) -> [f64; 3] {
        let water = self.water.as_ref().filter(|water| water.daylight().is_some());
        let Some(diffuse) = water.and_then(Water::diffuse_attenuation) else {
            return [1.0; 3];
        };
        let rise = dot(self.up, place).min(self.depth_m.unwrap_or(f64::INFINITY));
        diffuse.map(|k| (k * rise).exp())
    }

    /// Factor of the scene's radiance in the light around it.
    #[must_use]
    pub fn gain(&self) -> [f64; 3] {
        self.water.as_ref().map_or([1.0; 3], Water::radiance_gain)
    }
}

/// Whether daylight is computed for each surface.
fn lights_surfaces(water: &Water) -> bool {
    let above = water.daylight();
    above.is_some_and(|daylight| daylight.surfaces() != SurfaceLight::None)
}

/// The view direction of the camera; in a known world, azimuths and positions are the world's.
fn gaze_of(frame: &Frame, view: &View, eye: &Eye) -> Gaze {
    let gaze = Gaze::new(view.camera, view.size, up_of(frame, eye));
    match view.world_from_camera {
        Some(_) => gaze.in_world(eye.turned([1.0, 0.0, 0.0]), eye.turned(eye.position())),
        None => gaze,
    }
}

/// Against gravity in camera axes: a procedural world has its z axis up; a picture has a given direction or is level.
fn up_of(frame: &Frame, eye: &Eye) -> [f64; 3] {
    match frame.scene {
        Scene::Procedural { .. } => eye.turned([0.0, 0.0, 1.0]),
        _ => frame.camera.up.unwrap_or([0.0, -1.0, 0.0]),
    }
}

fn wrong(snow: &Snow, view: &View) -> Vec<Beyond> {
    let mut beyond = snow::validate(snow);
    beyond.extend(snow::check_count(snow, snow::solid(&view.camera, view.size)).err());
    beyond
}

fn lighting(lamps: Vec<Lamp>, eye: &Eye, water: Option<&Water>, patches: Option<&Field>) -> Lighting {
    Lighting {
        lamps,
        radius_m: LAMP_RADIUS_M,
        camera: eye.camera,
        attenuation: water.map_or([0.0; 3], Water::direct_attenuation),
        scattering: water.and_then(Water::scattering).unwrap_or([0.0; 3]),
        absorption: water.and_then(Water::followed_absorption),
        phase: water.map_or(GlowPhase::henyey_greenstein(0.0), Water::glow_phase),
        patches: patches.map(|field| field.seen_from(eye)),
    }
}
