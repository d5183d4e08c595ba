//! Resolves a described camera to its parts with all numbers.

use imaging::geometry::Intrinsics;
use spec::{Camera, Exposure, Jpeg, Port, Tone, WhiteBalance};

use crate::defocus::Focus;
use crate::geometry::{Lens, STILL_PX, SourcePicture, sample_side};
use crate::preset;
use crate::sensor::SensorModel;
use crate::vignette::FallOff;

/// The parts of a camera, resolved for a picture; a pinhole without noise has none.
#[derive(Debug, Clone, PartialEq)]
pub struct Parts {
    /// Columns and rows of the camera's picture.
    pub size: (usize, usize),
    /// The lens behind its port, in air.
    pub lens: Lens,
    /// The picture in front of the lens; `None` if the camera shows it unchanged.
    pub source: Option<SourcePicture>,
    /// Whether distortion, port or supersampling are described.
    pub asks_geometry: bool,
    /// Defocus.
    pub focus: Option<Focus>,
    /// Fall-off towards the corners.
    pub falloff: Option<FallOff>,
    /// Brightness.
    pub exposure: Option<Exposure>,
    /// SensorModel.
    pub sensor: Option<SensorModel>,
    /// White balance.
    pub balance: Option<WhiteBalance>,
    /// Curve to codes.
    pub tone: Tone,
    /// Bits of the codes: 8 or 16.
    pub bits: u8,
    /// Compression.
    pub jpeg: Option<Jpeg>,
}

/// Input of a camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scenery {
    /// A scene rendered at the required size.
    Rendered,
    /// A picture with its intrinsics in water.
    Picture(Intrinsics, (usize, usize)),
}

/// A camera that cannot take a picture of such a scene.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PartsError {
    /// The lens folds.
    #[error(transparent)]
    Fold(#[from] crate::geometry::Fold),
    /// The source picture exceeds the size limits.
    #[error(
        "the lens covers a scene of more than {side} pixels a side or {pixels} pixels in all",
        side = imaging::codec::MAX_SIDE_PX, pixels = imaging::codec::MAX_PIXELS
    )]
    TooWide,
    /// A mosaic needs two by two pixels.
    #[error("a sensor with color filters needs at least 2×2 pixels")]
    TooSmall,
    /// A picture cannot be taken from several poses.
    #[error("only a procedural scene can be seen from several poses")]
    NoPath,
    /// The sensor is not in the table.
    #[error("the sensor is not known")]
    UnknownSensor,
    /// Codes have 8 or 16 bits.
    #[error("a picture's codes have 8 or 16 bits, not {0}")]
    Bits(u8),
    /// JPEG has 8 bits.
    #[error("a picture of {0} bits cannot be compressed: JPEG has 8")]
    DeepJpeg(u8),
    /// The black level is at or above the largest code.
    #[error("black is at {black}, but the largest code is {most}")]
    Black {
        /// Black level.
        black: u16,
        /// Largest code.
        most: f64,
    },
}

impl Parts {
    /// Resolves the parts of a camera for a scene, including its preset.
    ///
    /// # Errors
    /// [`PartsError`].
    pub fn resolve(camera: &Camera, scenery: Scenery) -> Result<Self, PartsError> {
        let camera = preset::complete(camera);
        let asks_geometry = camera.distortion.is_some()
            || matches!(camera.port, Some(Port::Flat { .. }))
            || camera.supersample > 1;
        let (size, air) = match scenery {
            Scenery::Rendered => {
                let (width, height) = (camera.width, camera.height);
                let focal_px = camera.focal_px(width);
                ((width, height), Intrinsics::centered(focal_px, width, height))
            }
            Scenery::Picture(water, size) => (size, water),
        };
        let mut lens = Lens::new(air, camera.distortion, camera.port);
        if let Scenery::Picture(..) = scenery {
            lens.camera.focal_px /= lens.magnification();
        }
        let source = if asks_geometry {
            source(&lens, size, &camera, scenery)?
        } else {
            None
        };
        let sensor = match &camera.sensor {
            Some(law) => Some(checked(
                preset::sensor(law, camera.exposure_s).ok_or(PartsError::UnknownSensor)?,
                size,
            )?),
            None => None,
        };
        Ok(Self {
            size,
            source,
            asks_geometry,
            focus: camera
                .defocus
                .map(|law| Focus::new(law, lens.camera.focal_px, camera.port)),
            falloff: camera.vignette.map(|law| FallOff::new(law, lens.camera, size)),
            exposure: camera.exposure,
            sensor,
            balance: camera.white_balance,
            tone: camera.tone,
            bits: checked_bits(&camera)?,
            jpeg: camera.jpeg,
            lens,
        })
    }

    /// Whether the camera has no parts.
    #[must_use]
    pub fn is_pinhole(&self) -> bool {
        !self.asks_geometry
            && self.focus.is_none()
            && self.falloff.is_none()
            && self.exposure.is_none()
            && self.is_electronic_free()
            && self.jpeg.is_none()
    }

    /// Whether exposed light is converted to codes by the sRGB curve only.
    fn is_electronic_free(&self) -> bool {
        self.sensor.is_none() && self.balance.is_none() && self.tone == Tone::Srgb && self.bits == 8
    }
}

fn checked_bits(camera: &Camera) -> Result<u8, PartsError> {
    match camera.bits {
        8 => Ok(8),
        16 if camera.jpeg.is_some() => Err(PartsError::DeepJpeg(16)),
        16 => Ok(16),
        other => Err(PartsError::Bits(other)),
    }
}

fn checked(sensor: SensorModel, (width, height): (usize, usize)) -> Result<SensorModel, PartsError> {
    if f64::from(sensor.black_dn) >= sensor.most_dn() {
        return Err(PartsError::Black {
            black: sensor.black_dn,
            most: sensor.most_dn(),
        });
    }
    if sensor.cfa != spec::Cfa::None && (width < 2 || height < 2) {
        return Err(PartsError::TooSmall);
    }
    Ok(sensor)
}

/// The picture in front of the lens; `None` if no pixel moves.
fn source(
    lens: &Lens,
    size: (usize, usize),
    camera: &Camera,
    scenery: Scenery,
) -> Result<Option<SourcePicture>, PartsError> {
    lens.check(size)?;
    let supersample = camera.supersample;
    match scenery {
        Scenery::Rendered if supersample == 1 && is_still(lens, lens.camera, size) => Ok(None),
        Scenery::Rendered => match SourcePicture::covering(lens, size, supersample) {
            Some(source) => Ok(Some(source)),
            None => Err(PartsError::TooWide),
        },
        Scenery::Picture(water, _) if is_still(lens, water, size) => Ok(None),
        Scenery::Picture(water, size) => Ok(Some(SourcePicture { size, camera: water })),
    }
}

/// Whether no border pixel moves; a lens moves those most.
fn is_still(lens: &Lens, pinhole: Intrinsics, (width, height): (usize, usize)) -> bool {
    sample_side(height, 32)
        .flat_map(|y| sample_side(width, 32).map(move |x| (x, y)))
        .all(|(x, y)| {
            let air = lens.camera.ray(x as f64, y as f64);
            let Some(ideal) = lens.undistorted(air.x, air.y) else {
                return false;
            };
            (0..3).all(|channel| {
                let (u, v) = lens.in_water(ideal, channel);
                let moved_x = (pinhole.cx + pinhole.focal_px * u - x as f64).abs();
                let moved_y = (pinhole.cy + pinhole.focal_px * v - y as f64).abs();
                moved_x.max(moved_y) <= STILL_PX
            })
        })
}
