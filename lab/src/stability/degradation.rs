//! Degradations of an underwater picture.

use imaging::random::Stream;
use imaging::{Rgb, Rgb8, codec, transfer};

/// A scene to degrade.
#[derive(Debug, Clone)]
pub(super) struct Specimen {
    /// The picture in clear air, which a perfect restoration would return.
    pub(super) clean: Rgb8,
    /// The same under water, before any degradation.
    pub(super) wet: Rgb8,
}

/// Steps of each degradation. The first leaves the picture unchanged.
pub(super) const LEVELS: usize = 8;

/// A degradation of the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Degradation {
    /// Gaussian noise on the codes; the level is its standard deviation.
    Noise,
    /// Veil: the level is the transmittance t in J·t + B·(1 − t), in linear light.
    Turbidity,
    /// Darkness: the level multiplies linear light.
    Darkness,
    /// A lamp at the lower edge: the level is the standard deviation of its airlight as a share of the height.
    Lamp,
    /// Absorbed red: the level multiplies it in linear light.
    Cast,
    /// A smaller picture: the level is its longer side in pixels.
    Size,
    /// JPEG: the level is its quality.
    Jpeg,
    /// Overexposure: the level multiplies linear light, which then clips.
    Saturation,
}

impl Degradation {
    /// All of them.
    pub(super) const ALL: [Self; 8] = [
        Self::Noise,
        Self::Turbidity,
        Self::Darkness,
        Self::Lamp,
        Self::Cast,
        Self::Size,
        Self::Jpeg,
        Self::Saturation,
    ];

    /// Its name in tables, with the unit of its levels, and their values.
    fn row(self) -> (&'static str, [f64; LEVELS]) {
        match self {
            Self::Noise => ("noise, codes", [0.0, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0]),
            Self::Turbidity => ("transmittance", [1.0, 0.7, 0.5, 0.3, 0.15, 0.07, 0.03, 0.0]),
            Self::Darkness => ("light left", [1.0, 0.5, 0.25, 0.12, 0.06, 0.03, 0.01, 0.0]),
            Self::Lamp => ("lamp, height", [0.0, 0.05, 0.1, 0.15, 0.2, 0.3, 0.45, 0.6]),
            Self::Cast => ("red left", [1.0, 0.8, 0.6, 0.4, 0.2, 0.1, 0.03, 0.0]),
            Self::Size => ("size, px", [4096.0, 160.0, 96.0, 48.0, 24.0, 8.0, 3.0, 1.0]),
            Self::Jpeg => ("JPEG quality", [100.0, 90.0, 75.0, 50.0, 30.0, 20.0, 10.0, 4.0]),
            Self::Saturation => ("overexposure", [1.0, 1.5, 2.0, 3.0, 4.0, 8.0, 16.0, 64.0]),
        }
    }

    pub(super) fn name(self) -> &'static str {
        self.row().0
    }

    pub(super) fn levels(self) -> [f64; LEVELS] {
        self.row().1
    }

    /// The clean and the degraded picture, in the same size.
    pub(super) fn apply(self, specimen: &Specimen, level: usize, number: u64) -> (Rgb8, Rgb8) {
        let value = self.levels()[level];
        let wet = &specimen.wet;
        let degraded = match self {
            Self::Noise => noisy(wet, value, number),
            Self::Turbidity => {
                let veil = mean(&transfer::decode_rgb8(wet)).map(|v| 1.5 * v + 0.02);
                in_light(wet, |_, _, light, c| {
                    light * value as f32 + veil[c] * (1.0 - value as f32)
                })
            }
            Self::Darkness | Self::Saturation => in_light(wet, |_, _, light, _| light * value as f32),
            Self::Lamp => lamp(wet, value),
            Self::Cast => in_light(wet, |_, _, light, c| light * [value as f32, 1.0, 1.0][c]),
            Self::Size => {
                let [clean, wet] = [&specimen.clean, wet].map(|one| codec::downscale(one, value as usize));
                return (clean, wet);
            }
            Self::Jpeg => encode_jpeg(wet, value as u8),
        };
        (specimen.clean.clone(), degraded)
    }
}

/// Maps linear light sample by sample: column, row, light, channel.
fn in_light(picture: &Rgb8, change: impl Fn(usize, usize, f32, usize) -> f32) -> Rgb8 {
    let light = transfer::decode_rgb8(picture);
    let changed = Rgb::from_fn(light.width(), light.height(), |x, y| {
        let sample = light.pixel(x, y);
        [0, 1, 2].map(|c| change(x, y, sample[c], c))
    });
    transfer::encode_rgb8(&changed).0
}

fn mean(light: &Rgb<f32>) -> [f32; 3] {
    light.planes().each_ref().map(|plane| {
        let sum: f64 = plane.data().iter().map(|&v| f64::from(v)).sum();
        (sum / plane.data().len() as f64) as f32
    })
}

fn lamp(picture: &Rgb8, sigma: f64) -> Rgb8 {
    if sigma == 0.0 {
        return picture.clone();
    }
    let (width, height) = (picture.width() as f64, picture.height() as f64);
    in_light(picture, |x, y, light, _| {
        let (dx, dy) = (x as f64 - width / 2.0, y as f64 - height);
        let glow = (-(dx * dx + dy * dy) / (2.0 * (sigma * height).powi(2))).exp() as f32;
        light + (1.0 - light) * glow
    })
}

fn noisy(picture: &Rgb8, sigma: f64, number: u64) -> Rgb8 {
    let stream = Stream::stage(number, "stability/noise");
    let data = picture.data().iter().enumerate().map(|(index, &code)| {
        // Box and Muller 1958.
        let (u, v) = (1.0 - stream.unit(0, index as u64), stream.unit(1, index as u64));
        let normal = (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos();
        (f64::from(code) + sigma * normal).round().clamp(0.0, 255.0) as u8
    });
    Rgb8::new(picture.width(), picture.height(), data.collect()).expect("as many samples as before")
}

/// A picture after JPEG; unchanged if it cannot be encoded.
fn encode_jpeg(picture: &Rgb8, quality: u8) -> Rgb8 {
    let coded = codec::encode_jpeg(picture, quality).ok();
    let decoded = coded.and_then(|bytes| codec::decode_picture(&bytes).ok());
    decoded.map_or_else(|| picture.clone(), |raster| raster.to_rgb8())
}
